// SPDX-License-Identifier: BSD-3-Clause
#include "vtkNURBSZeroSetAlgorithm.h"

#include "Measures.h"
#include "NURBSMeshOutput.h"
#include "ZeroSetGroup.h"

#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkIdTypeArray.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"

#include <utility>

VTK_ABI_NAMESPACE_BEGIN

void vtkNURBSZeroSetAlgorithm::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "MergePoints: " << (this->MergePoints ? "on" : "off") << "\n";
}

vtkNURBSZeroSetAlgorithm::vtkNURBSZeroSetAlgorithm() = default;
vtkNURBSZeroSetAlgorithm::~vtkNURBSZeroSetAlgorithm() = default;

void vtkNURBSZeroSetAlgorithm::ModelChanged()
{
  this->Superclass::ModelChanged();
  this->Prepared.clear();
}

const std::vector<vtkNURBSZeroSetAlgorithm::PreparedPatch>& vtkNURBSZeroSetAlgorithm::Prepare(
  const hyperpatch::MultiPatch& model)
{
  if (this->Prepared.empty())
  {
    this->Interfaces = model.Interfaces;
    for (const hyperpatch::Patch& patch : model.Patches)
    {
      // The model outlives what is kept of it: ModelChanged() comes first.
      this->Prepared.push_back(
        { std::shared_ptr<const hyperpatch::Patch>(&patch, [](const hyperpatch::Patch*) {}),
          std::make_shared<const hyperpatch::PreparedAggregate>(patch.Body),
          hyperpatch::Handedness(patch) < 0 ? -1 : 1 });
    }
  }
  return this->Prepared;
}

void vtkNURBSZeroSetAlgorithm::Draw(const std::vector<Task>& tasks,
  const AbsoluteTolerances& tolerances, NURBSMeshOutput& output, vtkFieldData* fieldData)
{
  std::vector<hyperpatch::ZeroSetGroup::Member> members;
  for (const Task& task : tasks)
  {
    hyperpatch::ZeroSetOptions options;
    options.Tolerance = tolerances.Position;
    options.AttributeTolerances = tolerances.Of(*task.On.Patch);
    if (task.Constant >= 0)
    {
      options.AttributeTolerances[static_cast<std::size_t>(task.Constant)] = 0.0;
    }
    options.Handedness = task.On.Handedness;
    members.push_back(
      { task.On.Patch.get(), task.On.Body, task.Field.get(), task.Value, std::move(options) });
  }
  hyperpatch::ZeroSetGroup group(members, this->Interfaces,
    { this->GetController() ? this->GetController()->GetLocalProcessId() : 0,
      [this](const std::vector<double>& records) { return this->AllGather(records); } },
    this->KernelParallelFor());
  group.Extract([this](double begin, double end) { this->SetProgressRange(begin, end); });

  const hyperpatch::ZeroSetCertificate certificate = group.Certificate();
  const std::size_t before = output.NumberOfBlocks();
  for (std::size_t i = 0; i < tasks.size(); ++i)
  {
    const hyperpatch::ZeroSetMesh& mesh = group.Mesh(i);
    output.AddPoints(
      *tasks[i].On.Patch, mesh.Parameters, mesh.Points, mesh.Normals, mesh.Attributes);
    const Eigen::Vector3i firstSpan(tasks[i].On.Patch->FirstSpan.data());
    output.AddCells(
      *tasks[i].On.Patch, mesh.Cells, mesh.Elements.colwise() + firstSpan, { { tasks[i].Value } });
  }
  if (this->MergePoints)
  {
    output.MergePoints(before);
  }

  const auto addCount = [fieldData](const char* name, std::int64_t value)
  {
    vtkNew<vtkIdTypeArray> array;
    array->SetName(name);
    array->InsertNextValue(static_cast<vtkIdType>(value));
    fieldData->AddArray(array);
  };
  const auto addNumber = [fieldData](const char* name, double value)
  {
    vtkNew<vtkDoubleArray> array;
    array->SetName(name);
    array->InsertNextValue(value);
    fieldData->AddArray(array);
  };
  addCount("CertifiedCells", certificate.CertifiedCells);
  addCount("UndecidedCells", certificate.UndecidedCells);
  addNumber("LargestResidual", certificate.LargestResidual);
  addNumber("LargestError", certificate.LargestError);
  addCount("ToleranceReached", certificate.ToleranceReached ? 1 : 0);
  addCount("OpenEdgesOnBoundary", certificate.OpenEdgesOnBoundary);
  addCount("OpenEdgesOnInterfaces", certificate.OpenEdgesOnInterfaces);
  addCount("OpenEdgesInside", certificate.OpenEdgesInside);
  if (!certificate.ToleranceReached && certificate.LargestError <= tolerances.Position &&
    certificate.LargestAttributeError <= 1.0)
  {
    vtkWarningMacro("the limit of refinement was reached with "
      << certificate.UndecidedCells
      << " cells in which a zero could neither be seen nor excluded (UndecidedCells)");
  }
  else if (!certificate.ToleranceReached)
  {
    vtkWarningMacro(
      "the limit of refinement was reached before the tolerance: the measured error is "
      << certificate.LargestError << " where " << tolerances.Position
      << " was asked for (attributes: " << certificate.LargestAttributeError
      << " times their tolerance)");
  }
}

VTK_ABI_NAMESPACE_END
