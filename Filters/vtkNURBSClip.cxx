// SPDX-License-Identifier: BSD-3-Clause
#include "vtkNURBSClip.h"

#include "Aggregate.h"
#include "ArrayNames.h"
#include "BendBounds.h"
#include "Clip.h"
#include "Error.h"
#include "FieldChoice.h"
#include "FieldNumbers.h"
#include "FunctionFields.h"
#include "Measures.h"
#include "NURBSMeshOutput.h"

#include "vtkDataObject.h"
#include "vtkImplicitFunction.h"
#include "vtkInformation.h"
#include "vtkMultiProcessController.h"
#include "vtkObjectFactory.h"
#include "vtkType.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <exception>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

VTK_ABI_NAMESPACE_BEGIN
vtkStandardNewMacro(vtkNURBSClip);

/// What depends on patches and on which attributes have tolerances, in the order of the model.
struct vtkNURBSClip::KeptBends
{
  std::vector<std::shared_ptr<hyperpatch::BendBounds>> OfPatch;
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
  this->Bends.reset();
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

  if (!this->Bends)
  {
    this->Bends = std::make_unique<KeptBends>();
    this->Bends->OfPatch.resize(model.Patches.size());
  }
  std::vector<hyperpatch::ClipGroup::Member> members;
  std::vector<std::size_t> patches;
  hyperpatch::ClipGroup::Kept kept;
  for (std::size_t p = 0; p < model.Patches.size(); ++p)
  {
    const hyperpatch::Patch& patch = model.Patches[p];
    hyperpatch::ClipGroup::Member member{ &patch,
      std::make_shared<const hyperpatch::PreparedAggregate>(patch.Body), {}, {} };
    if (function)
    {
      member.Fields = function->At(*member.Body, 0.0);
    }
    else if (auto field = choice.At(*member.Body, this->Value))
    {
      member.Fields.push_back(std::move(field));
    }
    if (member.Fields.empty())
    {
      continue;
    }
    hyperpatch::ClipOptions& options = member.Options;
    options.Tolerance = tolerances.Position;
    options.AttributeTolerances = tolerances.Of(patch);
    options.KeepInside = this->Invert;
    options.Handedness = hyperpatch::Handedness(patch) < 0 ? -1 : 1;
    options.Abort = this->KernelAbort();
    members.push_back(std::move(member));
    patches.push_back(p);
    kept.push_back(this->Bends->OfPatch[p]);
  }
  // One rank must not leave alone: the others would wait for its numbers.
  std::optional<hyperpatch::ClipGroup> group;
  std::exception_ptr failure;
  try
  {
    group.emplace(members, model.Interfaces, this->KernelParallelFor(), kept);
    for (std::size_t i = 0; i < patches.size(); ++i)
    {
      this->Bends->OfPatch[patches[i]] = group->Bends()[i];
    }
    group->Extract();
  }
  catch (...)
  {
    failure = std::current_exception();
  }
  if (this->AnyRank(failure != nullptr))
  {
    if (failure)
    {
      std::rethrow_exception(failure);
    }
    return;
  }

  NURBSMeshOutput mesh(tolerances.Components, {});
  hyperpatch::ZeroSetCertificate certificate;
  vtkIdType openFaces = 0;
  {
    // Of all ranks.
    const hyperpatch::ZeroSetCertificate own = group->Certificate();
    constexpr std::size_t Size = 7;
    const std::vector<double> records = this->AllGather(
      { static_cast<double>(own.CertifiedCells), static_cast<double>(own.UndecidedCells),
        own.LargestResidual, own.LargestError, own.LargestAttributeError,
        own.ToleranceReached ? 1.0 : 0.0, static_cast<double>(group->OpenFacesOnInterfaces()) });
    for (std::size_t r = 0; r < records.size(); r += Size)
    {
      hyperpatch::ZeroSetCertificate one;
      one.CertifiedCells = static_cast<std::int64_t>(records[r]);
      one.UndecidedCells = static_cast<std::int64_t>(records[r + 1]);
      one.LargestResidual = records[r + 2];
      one.LargestError = records[r + 3];
      one.LargestAttributeError = records[r + 4];
      one.ToleranceReached = records[r + 5] != 0.0;
      certificate.Add(one);
      openFaces += static_cast<vtkIdType>(records[r + 6]);
    }
  }
  for (std::size_t i = 0; i < members.size(); ++i)
  {
    this->ReportProgress(0.0);
    const hyperpatch::Patch& patch = *members[i].On;
    hyperpatch::ClipMesh part = std::move(group->Mesh(i));
    const Eigen::Vector3i firstSpan(patch.FirstSpan.data());
    mesh.AddPoints(patch, std::move(part.Parameters), std::move(part.Points), Eigen::Matrix3Xd(),
      std::move(part.Attributes));
    mesh.AddCells(patch, std::move(part.Cells), part.Elements.colwise() + firstSpan, {});
  }
  this->ReportProgress(0.0);
  group.reset();
  this->ReportProgress(0.0);
  const int rank = this->GetController() ? this->GetController()->GetLocalProcessId() : 0;
  vtkFieldData* numbers = output->GetFieldData();
  FieldNumbers::AddCount(numbers, hyperpatch::names::CertifiedCells, certificate.CertifiedCells);
  FieldNumbers::AddCount(numbers, hyperpatch::names::UndecidedCells, certificate.UndecidedCells);
  FieldNumbers::AddNumber(numbers, hyperpatch::names::LargestResidual, certificate.LargestResidual);
  FieldNumbers::AddNumber(numbers, hyperpatch::names::LargestError, certificate.LargestError);
  FieldNumbers::AddCount(numbers, hyperpatch::names::OpenFacesOnInterfaces, openFaces);
  FieldNumbers::AddCount(
    numbers, hyperpatch::names::ToleranceReached, certificate.ToleranceReached ? 1 : 0);
  if (!certificate.ToleranceReached && rank == 0)
  {
    vtkWarningMacro("the limit of refinement was reached before the tolerance: "
                    "the error, bounded or measured, is "
      << certificate.LargestError << " where " << tolerances.Position
      << " was asked for (attributes: " << certificate.LargestAttributeError
      << " times their tolerance); " << certificate.UndecidedCells << " cells are undecided");
  }
  mesh.Fill(vtkUnstructuredGrid::SafeDownCast(output), this->KernelParallelFor());
}

VTK_ABI_NAMESPACE_END
