// SPDX-License-Identifier: BSD-3-Clause
#include "vtkNURBSZeroSetAlgorithm.h"

#include "ArrayNames.h"
#include "FieldNumbers.h"
#include "Measures.h"
#include "NURBSMeshOutput.h"
#include "ZeroSetGroup.h"

#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"

#include <array>
#include <map>
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

const hyperpatch::PreparedAggregate* vtkNURBSZeroSetAlgorithm::PreparedBody(
  const hyperpatch::MultiPatch& model, std::size_t patch)
{
  return this->Prepare(model)[patch].Body.get();
}

void vtkNURBSZeroSetAlgorithm::Draw(const std::vector<Task>& tasks,
  const AbsoluteTolerances& tolerances, NURBSMeshOutput& output, vtkFieldData* fieldData)
{
  // Several fields of one value on a patch are surfaces of their own.
  constexpr int MostValues = 1 << 20;
  std::map<std::pair<const hyperpatch::Patch*, int>, int> fieldsOf;
  std::vector<hyperpatch::ZeroSetGroup::Member> members;
  for (const Task& task : tasks)
  {
    const int field = fieldsOf[{ task.On.Patch.get(), task.Value }]++;
    hyperpatch::ZeroSetOptions options;
    options.Tolerance = tolerances.Position;
    options.AttributeTolerances = tolerances.Of(*task.On.Patch);
    if (task.Constant >= 0)
    {
      options.AttributeTolerances[static_cast<std::size_t>(task.Constant)] = 0.0;
    }
    options.Handedness = task.On.Handedness;
    options.Abort = this->KernelAbort();
    members.push_back({ task.On.Patch.get(), task.On.Body, task.Field.get(),
      task.Value + MostValues * field, std::move(options) });
  }
  const int rank = this->GetController() ? this->GetController()->GetLocalProcessId() : 0;
  hyperpatch::ZeroSetGroup group(members, this->Interfaces,
    { rank, [this](const std::vector<double>& records) { return this->AllGather(records); } },
    this->KernelParallelFor());
  group.Extract([this](double begin, double end) { this->SetProgressRange(begin, end); });

  std::vector<hyperpatch::ZeroSetMesh> surfaces;
  for (std::size_t i = 0; i < tasks.size(); ++i)
  {
    surfaces.push_back(group.TakeMesh(i));
  }
  this->Change(tasks, surfaces);
  const std::size_t before = output.NumberOfBlocks();
  for (std::size_t i = 0; i < tasks.size(); ++i)
  {
    hyperpatch::ZeroSetMesh& mesh = surfaces[i];
    output.AddPoints(*tasks[i].On.Patch, std::move(mesh.Parameters), std::move(mesh.Points),
      std::move(mesh.Normals), std::move(mesh.Attributes));
    const Eigen::Vector3i firstSpan(tasks[i].On.Patch->FirstSpan.data());
    output.AddCells(*tasks[i].On.Patch, std::move(mesh.Cells), mesh.Elements.colwise() + firstSpan,
      { { tasks[i].Value } });
  }
  if (this->MergePoints)
  {
    output.MergePoints(before, [this] { this->ReportProgress(0.0); });
  }

  const hyperpatch::ZeroSetCertificate certificate = group.TotalCertificate();
  FieldNumbers::AddCount(fieldData, hyperpatch::names::CertifiedCells, certificate.CertifiedCells);
  FieldNumbers::AddCount(fieldData, hyperpatch::names::UndecidedCells, certificate.UndecidedCells);
  FieldNumbers::AddNumber(
    fieldData, hyperpatch::names::LargestResidual, certificate.LargestResidual);
  FieldNumbers::AddNumber(fieldData, hyperpatch::names::LargestError, certificate.LargestError);
  FieldNumbers::AddCount(
    fieldData, hyperpatch::names::ToleranceReached, certificate.ToleranceReached ? 1 : 0);
  FieldNumbers::AddCount(
    fieldData, hyperpatch::names::OpenEdgesOnBoundary, certificate.OpenEdgesOnBoundary);
  FieldNumbers::AddCount(
    fieldData, hyperpatch::names::OpenEdgesOnInterfaces, certificate.OpenEdgesOnInterfaces);
  FieldNumbers::AddCount(
    fieldData, hyperpatch::names::OpenEdgesInside, certificate.OpenEdgesInside);
  vtkNew<vtkDoubleArray> boxes;
  boxes->SetName(hyperpatch::names::UndecidedBoxes);
  boxes->SetNumberOfComponents(7);
  static constexpr std::array<const char*, 7> Components{ "PatchId", "u least", "u greatest",
    "v least", "v greatest", "w least", "w greatest" };
  for (std::size_t c = 0; c < Components.size(); ++c)
  {
    boxes->SetComponentName(static_cast<vtkIdType>(c), Components[c]);
  }
  for (std::size_t i = 0; i < tasks.size(); ++i)
  {
    for (const hyperpatch::ParameterBox& box : group.UndecidedBoxes(i))
    {
      const auto& [low, high] = box;
      boxes->InsertNextTuple(std::array<double, 7>{ static_cast<double>(tasks[i].On.Patch->Id),
        low[0], high[0], low[1], high[1], low[2], high[2] }
                               .data());
    }
  }
  fieldData->AddArray(boxes);
  if (rank > 0)
  {
    return;
  }
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

void vtkNURBSZeroSetAlgorithm::Change(
  const std::vector<Task>& /*tasks*/, std::vector<hyperpatch::ZeroSetMesh>& /*surfaces*/)
{
}

VTK_ABI_NAMESPACE_END
