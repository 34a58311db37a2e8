// SPDX-License-Identifier: BSD-3-Clause
#include "vtkNURBSClip.h"

#include "Aggregate.h"
#include "Clip.h"
#include "Error.h"
#include "FieldChoice.h"
#include "FieldNumbers.h"
#include "FunctionFields.h"
#include "Measures.h"
#include "NURBSMeshOutput.h"
#include "Tessellation.h"

#include "vtkDataObject.h"
#include "vtkImplicitFunction.h"
#include "vtkInformation.h"
#include "vtkObjectFactory.h"
#include "vtkType.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

VTK_ABI_NAMESPACE_BEGIN
vtkStandardNewMacro(vtkNURBSClip);

struct vtkNURBSClip::KeptGrids
{
  struct Kept
  {
    std::vector<double> Tolerances; ///< those of the grid; empty: there is none yet
    hyperpatch::SolidGrid Grid;
  };
  std::vector<Kept> OfPatch; ///< in the order of the model
};

vtkNURBSClip::vtkNURBSClip() = default;
vtkNURBSClip::~vtkNURBSClip() = default;

void vtkNURBSClip::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "ClipFunction: " << this->ClipFunction.Get() << "\n";
  os << indent << "ClipBy: " << this->ClipBy << "\n";
  os << indent << "Component: " << this->Component << "\n";
  os << indent << "Value: " << this->Value << "\n";
  os << indent << "Invert: " << (this->Invert ? "on" : "off") << "\n";
}

vtkMTimeType vtkNURBSClip::GetMTime()
{
  const vtkMTimeType own = this->Superclass::GetMTime();
  return this->ClipFunction ? std::max(own, this->ClipFunction->GetMTime()) : own;
}

void vtkNURBSClip::SetClipFunction(vtkImplicitFunction* function)
{
  if (this->ClipFunction != function)
  {
    this->ClipFunction = function;
    this->Modified();
  }
}

vtkImplicitFunction* vtkNURBSClip::GetClipFunction()
{
  return this->ClipFunction;
}

int vtkNURBSClip::OutputType() const
{
  return VTK_UNSTRUCTURED_GRID;
}

void vtkNURBSClip::ModelChanged()
{
  this->Superclass::ModelChanged();
  this->Grids.reset();
}

void vtkNURBSClip::Execute(const hyperpatch::MultiPatch& model, vtkDataObject* output)
{
  vtkInformation* array = this->GetInputArrayInformation(0);
  const char* chosen = array ? array->Get(vtkDataObject::FIELD_NAME()) : nullptr;
  const FieldChoice choice{ this->ClipBy, chosen ? chosen : "", this->Component };
  const AbsoluteTolerances tolerances = this->FindTolerances(model);
  std::optional<FunctionFields> function;
  if (this->ClipFunction)
  {
    function.emplace(this->ClipFunction, model);
  }
  else
  {
    choice.Check(tolerances.Components);
    if (!std::isfinite(this->Value))
    {
      throw hyperpatch::Error("the value to clip at is not a finite number");
    }
  }

  struct Part
  {
    const hyperpatch::Patch* On;
    KeptGrids::Kept* Kept;
    std::shared_ptr<const hyperpatch::PreparedAggregate> Body;
    std::vector<std::shared_ptr<const hyperpatch::ScalarField>> Fields;
    hyperpatch::ClipMesh Mesh;
  };
  std::vector<Part> parts;
  if (!this->Grids)
  {
    this->Grids = std::make_unique<KeptGrids>();
    this->Grids->OfPatch.resize(model.Patches.size());
  }
  for (std::size_t p = 0; p < model.Patches.size(); ++p)
  {
    const hyperpatch::Patch& patch = model.Patches[p];
    Part part{ &patch, &this->Grids->OfPatch[p],
      std::make_shared<const hyperpatch::PreparedAggregate>(patch.Body), {}, {} };
    if (function)
    {
      part.Fields = function->At(*part.Body, 0.0);
    }
    else if (auto field = choice.At(*part.Body, this->Value))
    {
      part.Fields.push_back(std::move(field));
    }
    if (!part.Fields.empty())
    {
      parts.push_back(std::move(part));
    }
  }
  const auto clip = [&](Part& part, const hyperpatch::ParallelFor& loop)
  {
    hyperpatch::ClipOptions options;
    options.Tolerance = tolerances.Position;
    options.AttributeTolerances = tolerances.Of(*part.On);
    options.KeepInside = this->Invert;
    options.Handedness = hyperpatch::Handedness(*part.On) < 0 ? -1 : 1;
    options.For = loop;
    std::vector<double> own = options.AttributeTolerances;
    own.push_back(options.Tolerance);
    if (part.Kept->Tolerances != own)
    {
      hyperpatch::TessellationOptions grid;
      grid.Tolerance = options.Tolerance;
      grid.AttributeTolerances = options.AttributeTolerances;
      grid.For = loop;
      part.Kept->Tolerances.clear();
      part.Kept->Grid = hyperpatch::MakeSolidGrid(*part.On, grid);
      part.Kept->Tolerances = std::move(own);
    }
    options.Grid = &part.Kept->Grid;
    part.Mesh = hyperpatch::Clip(*part.On, part.Body, part.Fields, options);
  };
  // Few patches: the loops inside use the threads. Many: they are dealt out whole.
  if (parts.size() < 8)
  {
    for (std::size_t i = 0; i < parts.size(); ++i)
    {
      const auto count = static_cast<double>(parts.size());
      this->SetProgressRange(static_cast<double>(i) / count, static_cast<double>(i + 1) / count);
      clip(parts[i], this->KernelParallelFor());
    }
  }
  else
  {
    this->ParallelFor(static_cast<vtkIdType>(parts.size()), 1,
      [&](vtkIdType begin, vtkIdType end)
      {
        for (vtkIdType i = begin; i < end; ++i)
        {
          clip(parts[static_cast<std::size_t>(i)], hyperpatch::SerialFor);
        }
      });
  }

  NURBSMeshOutput mesh(tolerances.Components, {});
  hyperpatch::ZeroSetCertificate certificate;
  for (Part& part : parts)
  {
    certificate.Add(part.Mesh.Certificate);
    const hyperpatch::Patch& patch = *part.On;
    const Eigen::Vector3i firstSpan(patch.FirstSpan.data());
    mesh.AddPoints(
      patch, part.Mesh.Parameters, part.Mesh.Points, Eigen::Matrix3Xd(), part.Mesh.Attributes);
    mesh.AddCells(patch, part.Mesh.Cells, part.Mesh.Elements.colwise() + firstSpan, {});
    part.Mesh = {};
  }
  vtkFieldData* numbers = output->GetFieldData();
  FieldNumbers::AddCount(numbers, "CertifiedCells", certificate.CertifiedCells);
  FieldNumbers::AddCount(numbers, "UndecidedCells", certificate.UndecidedCells);
  FieldNumbers::AddNumber(numbers, "LargestResidual", certificate.LargestResidual);
  FieldNumbers::AddNumber(numbers, "LargestError", certificate.LargestError);
  FieldNumbers::AddCount(numbers, "ToleranceReached", certificate.ToleranceReached ? 1 : 0);
  if (!certificate.ToleranceReached)
  {
    vtkWarningMacro(
      "the limit of refinement was reached before the tolerance: the measured error is "
      << certificate.LargestError << " where " << tolerances.Position
      << " was asked for (attributes: " << certificate.LargestAttributeError
      << " times their tolerance); " << certificate.UndecidedCells << " cells are undecided");
  }
  mesh.Fill(vtkUnstructuredGrid::SafeDownCast(output));
}

VTK_ABI_NAMESPACE_END
