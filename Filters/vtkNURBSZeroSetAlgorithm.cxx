// SPDX-License-Identifier: BSD-3-Clause
#include "vtkNURBSZeroSetAlgorithm.h"

#include "Measures.h"
#include "NURBSMeshOutput.h"
#include "ZeroSet.h"

#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkIdTypeArray.h"
#include "vtkNew.h"

#include <algorithm>
#include <array>
#include <utility>

VTK_ABI_NAMESPACE_BEGIN

void vtkNURBSZeroSetAlgorithm::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
}

namespace
{

/// A grid interval as five numbers, so that ranks can tell each other: value, patch, direction,
/// first parameter, count.
constexpr std::size_t RecordLength = 5;

using IntervalKey = std::array<double, 4>;

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
  // Few tasks: the loops inside each use the threads. Many: they are dealt out whole.
  const bool together = tasks.size() < 8;
  std::vector<std::unique_ptr<hyperpatch::ZeroSet>> zeroSets;
  for (const Task& task : tasks)
  {
    hyperpatch::ZeroSetOptions options;
    options.Tolerance = tolerances.Position;
    options.AttributeTolerances = tolerances.Of(*task.On.Patch);
    options.Handedness = task.On.Handedness;
    if (together)
    {
      options.For = this->KernelParallelFor();
    }
    zeroSets.push_back(
      std::make_unique<hyperpatch::ZeroSet>(task.On.Body, *task.Field, std::move(options)));
  }

  double progress = 0.0;
  std::vector<bool> stale(tasks.size(), true);
  while (this->AnyRank(std::find(stale.begin(), stale.end(), true) != stale.end()))
  {
    // Every round is the costlier half of what is left.
    const double next = progress + 0.5 * (1.0 - progress);
    this->SetProgressRange(progress, next);
    progress = next;
    if (together)
    {
      for (std::size_t i = 0; i < tasks.size(); ++i)
      {
        if (stale[i])
        {
          zeroSets[i]->Extract();
        }
      }
    }
    else
    {
      this->ParallelFor(static_cast<vtkIdType>(tasks.size()), 1,
        [&zeroSets, &stale](vtkIdType begin, vtkIdType end)
        {
          for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
          {
            if (stale[i])
            {
              zeroSets[i]->Extract();
            }
          }
        });
    }

    // Parts of one patch take the larger counts of all its parts: no crack where they meet.
    std::vector<double> records;
    for (std::size_t i = 0; i < tasks.size(); ++i)
    {
      const hyperpatch::CellGrid& grid = zeroSets[i]->Grid();
      const auto& wanted = zeroSets[i]->Wanted();
      for (std::size_t d = 0; d < 3; ++d)
      {
        for (std::size_t b = 0; b < wanted[d].size(); ++b)
        {
          records.insert(records.end(),
            { static_cast<double>(tasks[i].Value), static_cast<double>(tasks[i].On.Patch->Id),
              static_cast<double>(d), grid.Breaks[d][b], static_cast<double>(wanted[d][b]) });
        }
      }
    }
    records = this->AllGather(records);
    std::map<IntervalKey, int> counts;
    for (std::size_t r = 0; r < records.size(); r += RecordLength)
    {
      int& count = counts[{ records[r], records[r + 1], records[r + 2], records[r + 3] }];
      count = std::max(count, static_cast<int>(records[r + 4]));
    }
    for (std::size_t i = 0; i < tasks.size(); ++i)
    {
      const hyperpatch::CellGrid& grid = zeroSets[i]->Grid();
      auto& wanted = zeroSets[i]->Wanted();
      for (std::size_t d = 0; d < 3; ++d)
      {
        for (std::size_t b = 0; b < wanted[d].size(); ++b)
        {
          wanted[d][b] = counts.at(
            { static_cast<double>(tasks[i].Value), static_cast<double>(tasks[i].On.Patch->Id),
              static_cast<double>(d), grid.Breaks[d][b] });
        }
      }
      stale[i] = zeroSets[i]->Refine();
    }
  }
  this->SetProgressRange(progress, 1.0);

  hyperpatch::ZeroSetCertificate certificate;
  for (std::size_t i = 0; i < tasks.size(); ++i)
  {
    const hyperpatch::ZeroSetMesh& mesh = zeroSets[i]->Mesh();
    certificate.Add(zeroSets[i]->Certificate());
    output.AddPoints(
      *tasks[i].On.Patch, mesh.Parameters, mesh.Points, mesh.Normals, mesh.Attributes);
    const Eigen::Vector3i firstSpan(tasks[i].On.Patch->FirstSpan.data());
    output.AddCells(
      *tasks[i].On.Patch, mesh.Cells, mesh.Elements.colwise() + firstSpan, { { tasks[i].Value } });
    zeroSets[i].reset();
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
  addCount("CrossedCells", certificate.CrossedCells);
  addCount("UndecidedCells", certificate.UndecidedCells);
  addNumber("LargestResidual", certificate.LargestResidual);
  addNumber("LargestError", certificate.LargestError);
  addCount("ToleranceReached", certificate.ToleranceReached ? 1 : 0);
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
