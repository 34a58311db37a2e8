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
#include <functional>
#include <map>
#include <utility>

VTK_ABI_NAMESPACE_BEGIN

void vtkNURBSZeroSetAlgorithm::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
}

namespace
{

/// A side of a part: the label of its task, patch, direction across, parameter there, and the range
/// of the two other directions. Parts that meet have the same.
constexpr std::size_t SideKeyLength = 8;
using SideKey = std::array<double, SideKeyLength>;

SideKey KeyOf(const hyperpatch::Patch& patch, int value, int side)
{
  const auto& knots = patch.Body.Geometry().Knots();
  const auto d = static_cast<std::size_t>(side / 2);
  const hyperpatch::KnotVector& b = knots[d == 0 ? 1 : 0];
  const hyperpatch::KnotVector& c = knots[d == 2 ? 1 : 2];
  return { static_cast<double>(value), static_cast<double>(patch.Id), static_cast<double>(d),
    side % 2 == 0 ? knots[d].First() : knots[d].Last(), b.First(), b.Last(), c.First(), c.Last() };
}

bool IsPart(const hyperpatch::Patch& patch)
{
  return patch.WholeSpans[0] > 0;
}

bool IsCut(const hyperpatch::Patch& patch, int side)
{
  return IsPart(patch) && !patch.IsDomainFace[static_cast<std::size_t>(side)];
}

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
    for (std::size_t side = 0; side < options.GoesOn.size(); ++side)
    {
      options.GoesOn[side] = !task.On.Patch->IsDomainFace[side];
    }
    if (together)
    {
      options.For = this->KernelParallelFor();
    }
    zeroSets.push_back(
      std::make_unique<hyperpatch::ZeroSet>(task.On.Body, *task.Field, std::move(options)));
  }

  const auto forAll = [&](const std::function<void(hyperpatch::ZeroSet&)>& work)
  {
    if (together)
    {
      for (const auto& zeroSet : zeroSets)
      {
        work(*zeroSet);
      }
      return;
    }
    this->ParallelFor(static_cast<vtkIdType>(zeroSets.size()), 1,
      [&](vtkIdType begin, vtkIdType end)
      {
        for (vtkIdType i = begin; i < end; ++i)
        {
          work(*zeroSets[static_cast<std::size_t>(i)]);
        }
      });
  };
  this->AgreeOnRoots(tasks, zeroSets);
  this->SetProgressRange(0.0, 0.3);
  forAll([](hyperpatch::ZeroSet& zeroSet) { zeroSet.Search(); });
  this->ExchangeNodes(tasks, zeroSets);
  this->SetProgressRange(0.3, 0.8);
  forAll([](hyperpatch::ZeroSet& zeroSet) { zeroSet.Finish(); });
  this->SetProgressRange(0.8, 1.0);
  std::vector<char> refined(zeroSets.size(), 1);
  for (int round = 0; round < hyperpatch::ZeroSet::MostRefinements; ++round)
  {
    for (std::size_t i = 0; i < zeroSets.size(); ++i)
    {
      refined[i] = !this->GetAbortExecute() && zeroSets[i]->Refine() ? 1 : 0;
    }
    if (!this->AnyRank(std::find(refined.begin(), refined.end(), 1) != refined.end()))
    {
      break;
    }
    this->ExchangeNodes(tasks, zeroSets);
    forAll([](hyperpatch::ZeroSet& zeroSet) { zeroSet.Finish(); });
  }

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
  addCount("CertifiedCells", certificate.CertifiedCells);
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

void vtkNURBSZeroSetAlgorithm::AgreeOnRoots(
  const std::vector<Task>& tasks, const ZeroSets& zeroSets)
{
  // Parts of a patch with the same range in a direction have the same root boxes in it.
  using Range = std::array<double, 5>;
  const auto keyOf = [&tasks](std::size_t i, std::size_t d)
  {
    const hyperpatch::KnotVector& knots = tasks[i].On.Patch->Body.Geometry().Knots()[d];
    return Range{ static_cast<double>(tasks[i].Value), static_cast<double>(tasks[i].On.Patch->Id),
      static_cast<double>(d), knots.First(), knots.Last() };
  };
  std::vector<double> records;
  for (std::size_t i = 0; i < tasks.size(); ++i)
  {
    for (std::size_t d = 0; d < 3 && IsPart(*tasks[i].On.Patch); ++d)
    {
      const Range key = keyOf(i, d);
      records.insert(records.end(), key.begin(), key.end());
      records.push_back(zeroSets[i]->Roots()[d]);
    }
  }
  records = this->AllGather(records);
  std::map<Range, int> roots;
  for (std::size_t r = 0; r < records.size(); r += 6)
  {
    Range key{};
    std::copy_n(&records[r], key.size(), key.begin());
    int& count = roots[key];
    count = std::max(count, static_cast<int>(records[r + 5]));
  }
  for (std::size_t i = 0; i < tasks.size(); ++i)
  {
    if (IsPart(*tasks[i].On.Patch))
    {
      zeroSets[i]->SetRoots(
        { roots[keyOf(i, 0)], roots[keyOf(i, 1)], roots[keyOf(i, 2)] }, { false, false, false });
    }
  }
}

void vtkNURBSZeroSetAlgorithm::ExchangeNodes(
  const std::vector<Task>& tasks, const ZeroSets& zeroSets)
{
  // Until nobody learns anything new: news travel around edges, from part to part.
  for (bool news = true; this->AnyRank(news);)
  {
    news = false;
    std::vector<double> records;
    for (std::size_t i = 0; i < tasks.size(); ++i)
    {
      const hyperpatch::Patch& patch = *tasks[i].On.Patch;
      for (int side = 0; side < hyperpatch::NumberOfSides; ++side)
      {
        if (!IsCut(patch, side))
        {
          continue;
        }
        const auto nodes = zeroSets[i]->NodesOn(side);
        const SideKey key = KeyOf(patch, tasks[i].Value, side);
        records.insert(records.end(), key.begin(), key.end());
        records.push_back(static_cast<double>(nodes.size()));
        for (const auto& node : nodes)
        {
          records.insert(
            records.end(), { static_cast<double>(node[0]), static_cast<double>(node[1]) });
        }
      }
    }
    records = this->AllGather(records);
    std::map<SideKey, std::vector<std::array<int, 2>>> nodesOf;
    for (std::size_t r = 0; r < records.size();)
    {
      SideKey key{};
      std::copy_n(&records[r], SideKeyLength, key.begin());
      r += SideKeyLength;
      auto& nodes = nodesOf[key];
      for (auto left = static_cast<std::size_t>(records[r++]); left > 0; --left, r += 2)
      {
        nodes.push_back({ static_cast<int>(records[r]), static_cast<int>(records[r + 1]) });
      }
    }
    for (std::size_t i = 0; i < tasks.size(); ++i)
    {
      const hyperpatch::Patch& patch = *tasks[i].On.Patch;
      for (int side = 0; side < hyperpatch::NumberOfSides; ++side)
      {
        if (IsCut(patch, side))
        {
          news = zeroSets[i]->AddNodes(side, nodesOf[KeyOf(patch, tasks[i].Value, side)]) || news;
        }
      }
    }
  }
}

VTK_ABI_NAMESPACE_END
