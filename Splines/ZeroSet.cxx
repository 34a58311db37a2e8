// SPDX-License-Identifier: BSD-3-Clause
#include "ZeroSet.h"

#include "ZeroSetWorker.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace hyperpatch
{

namespace
{

/// Breaks of several bases as one ascending list; those that differ by round-off count as one.
std::vector<double> MergeBreaks(std::vector<double> all)
{
  std::sort(all.begin(), all.end());
  const double same = 1e-12 * (all.back() - all.front());
  std::vector<double> merged{ all.front() };
  for (double b : all)
  {
    if (b - merged.back() > same)
    {
      merged.push_back(b);
    }
  }
  merged.back() = all.back();
  return merged;
}

}

void ZeroSetCertificate::Add(const ZeroSetCertificate& other)
{
  this->CrossedCells += other.CrossedCells;
  this->UndecidedCells += other.UndecidedCells;
  this->LargestResidual = std::max(this->LargestResidual, other.LargestResidual);
  this->LargestError = std::max(this->LargestError, other.LargestError);
  this->LargestAttributeError = std::max(this->LargestAttributeError, other.LargestAttributeError);
  this->ToleranceReached = this->ToleranceReached && other.ToleranceReached;
}

ZeroSet::Worker::Worker(std::shared_ptr<const PreparedAggregate> prepared, const ScalarField& field,
  ZeroSetOptions options)
  : Prepared(std::move(prepared))
  , Body(this->Prepared->Body())
  , Field(field)
  , Options(std::move(options))
  , Geometry(this->Prepared->Geometry()->Evaluator())
{
  const Aggregate& body = this->Body;
  std::array<std::vector<double>, 3> breaks = field.Breaks();
  const auto add = [&breaks](const Spline& spline)
  {
    for (std::size_t d = 0; d < 3; ++d)
    {
      const std::vector<double> more = spline.Knots()[d].Breaks();
      breaks[d].insert(breaks[d].end(), more.begin(), more.end());
    }
  };
  add(body.Geometry());
  for (const auto& attribute : this->Prepared->Attributes())
  {
    this->Attributes.push_back(&attribute->Evaluator());
    add(attribute->Spline());
  }
  for (int d = 0; d < 3; ++d)
  {
    const auto D = static_cast<std::size_t>(d);
    const KnotVector& knots = body.Geometry().Knots(d);
    this->Grid.Breaks[D] = MergeBreaks(breaks[D]);
    if (knots.Degree() > 0)
    {
      this->Axes.push_back(d);
      this->Grid.Counts[D].assign(this->Grid.Breaks[D].size() - 1, 1);
      this->Creases[D] = knots.Creases();
      this->Creases[D].push_back(knots.First());
      this->Creases[D].push_back(knots.Last());
    }
  }
  this->Options.AttributeTolerances.resize(body.Attributes().size(), 0.0);
  if (this->Options.FeatureSize <= 0.0)
  {
    this->Options.FeatureSize = 16.0 * this->Options.Tolerance;
  }
  this->Wanted = this->Grid.Counts;
}

bool ZeroSet::Worker::Parallel(
  Index count, Index grain, const std::function<void(Index, Index)>& body)
{
  // Chunks begin at multiples of the grain whatever the threads do: some results go by chunk.
  this->Options.For(static_cast<std::ptrdiff_t>((count + grain - 1) / grain), 1,
    [this, &body, count, grain](std::ptrdiff_t begin, std::ptrdiff_t end)
    {
      for (Index c = begin; c < end && !this->Options.Abort(); ++c)
      {
        body(c * grain, std::min(count, (c + 1) * grain));
      }
    });
  return !this->Options.Abort();
}

void ZeroSet::Worker::MakeLines()
{
  for (std::size_t d = 0; d < 3; ++d)
  {
    this->Lines[d].clear();
    this->IntervalOfLine[d].clear();
    const std::vector<double>& breaks = this->Grid.Breaks[d];
    const std::vector<int>& counts = this->Grid.Counts[d];
    for (std::size_t b = 0; b < counts.size(); ++b)
    {
      for (int i = 0; i < counts[b]; ++i)
      {
        const double t = static_cast<double>(i) / counts[b];
        this->Lines[d].push_back(i == 0 ? breaks[b] : breaks[b] + t * (breaks[b + 1] - breaks[b]));
        this->IntervalOfLine[d].push_back(static_cast<int>(b));
      }
    }
    this->Lines[d].push_back(counts.empty() ? breaks.front() : breaks.back());
    this->IntervalOfLine[d].push_back(std::max(0, static_cast<int>(counts.size()) - 1));
    this->Counts[d] = static_cast<Index>(this->Lines[d].size());
  }
}

bool ZeroSet::Worker::Extract()
{
  this->Certificate = ZeroSetCertificate();
  this->Wanted = this->Grid.Counts;
  this->MakeLines();
  if (!this->FindCrossings() || !this->FindVertices() || !this->EvaluateVertices())
  {
    return false;
  }
  this->MakeCells();
  this->DropUnusedPoints();
  if (!this->MeasureErrors())
  {
    return false;
  }
  // Where the surface is not smooth no refinement helps: stop before memory does.
  double growth = 1.0;
  for (int d : this->Axes)
  {
    const auto D = static_cast<std::size_t>(d);
    const auto sum = [](const std::vector<int>& counts)
    { return std::accumulate(counts.begin(), counts.end(), 0.0); };
    growth *= sum(this->Wanted[D]) / sum(this->Grid.Counts[D]);
  }
  const double surface = std::pow(growth, 1.0 - 1.0 / static_cast<double>(this->Axes.size()));
  const auto cells = static_cast<double>(
    this->Certificate.CrossedCells + this->Certificate.UndecidedCells - this->Sampled);
  const bool tooMany = cells * surface > this->Options.MaximumCells ||
    static_cast<double>(this->Sampled) * growth > 8.0 * this->Options.MaximumCells;
  if (tooMany && this->Wanted != this->Grid.Counts)
  {
    this->Wanted = this->Grid.Counts;
    this->Certificate.ToleranceReached = false;
  }
  return true;
}

ZeroSet::ZeroSet(const Aggregate& body, const ScalarField& field, ZeroSetOptions options)
  : ZeroSet(std::make_shared<const PreparedAggregate>(body), field, std::move(options))
{
}

ZeroSet::ZeroSet(
  std::shared_ptr<const PreparedAggregate> body, const ScalarField& field, ZeroSetOptions options)
  : W(std::make_unique<Worker>(std::move(body), field, std::move(options)))
{
}

ZeroSet::~ZeroSet() = default;

const CellGrid& ZeroSet::Grid() const
{
  return this->W->Grid;
}

std::array<std::vector<int>, 3>& ZeroSet::Wanted()
{
  return this->W->Wanted;
}

bool ZeroSet::Refine()
{
  const bool changed = this->W->Grid.Counts != this->W->Wanted;
  this->W->Grid.Counts = this->W->Wanted;
  return changed;
}

bool ZeroSet::Extract()
{
  return this->W->Extract();
}

const ZeroSetMesh& ZeroSet::Mesh() const
{
  return this->W->Mesh;
}

const ZeroSetCertificate& ZeroSet::Certificate() const
{
  return this->W->Certificate;
}

}
