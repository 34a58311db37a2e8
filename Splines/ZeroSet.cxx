// SPDX-License-Identifier: BSD-3-Clause
#include "ZeroSet.h"

#include "ZeroSetWorker.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace hyperpatch
{

namespace
{

/// A break of several bases; `IsCrease` if any of them is only C0 there.
struct Break
{
  double At;
  bool IsCrease;
};

/// Breaks that differ by round-off count as one.
void Merge(std::vector<Break>& all)
{
  std::sort(all.begin(), all.end(), [](const Break& a, const Break& b) { return a.At < b.At; });
  const double same = 1e-12 * (all.back().At - all.front().At);
  const double last = all.back().At;
  std::size_t kept = 0;
  for (const Break& b : all)
  {
    if (kept > 0 && b.At - all[kept - 1].At <= same)
    {
      all[kept - 1].IsCrease = all[kept - 1].IsCrease || b.IsCrease;
    }
    else
    {
      all[kept++] = b;
    }
  }
  all.resize(kept);
  all.back().At = last;
}

}

void ZeroSetCertificate::Add(const ZeroSetCertificate& other)
{
  this->CertifiedCells += other.CertifiedCells;
  this->UndecidedCells += other.UndecidedCells;
  this->LargestResidual = std::max(this->LargestResidual, other.LargestResidual);
  this->LargestError = std::max(this->LargestError, other.LargestError);
  this->LargestAttributeError = std::max(this->LargestAttributeError, other.LargestAttributeError);
  this->ToleranceReached = this->ToleranceReached && other.ToleranceReached;
  this->OpenEdgesOnBoundary += other.OpenEdgesOnBoundary;
  this->OpenEdgesOnInterfaces += other.OpenEdgesOnInterfaces;
  this->OpenEdgesInside += other.OpenEdgesInside;
}

ZeroSet::Worker::Worker(std::shared_ptr<const PreparedAggregate> prepared, const ScalarField& field,
  ZeroSetOptions options)
  : Prepared(std::move(prepared))
  , Body(this->Prepared->Body())
  , Field(field)
  , Options(std::move(options))
  , Geometry(this->Prepared->Geometry()->Evaluator())
{
  this->Options.AttributeTolerances.resize(this->Body.Attributes().size(), 0.0);
  std::array<std::vector<Break>, 3> breaks;
  const auto add = [&breaks](const Spline& spline)
  {
    for (std::size_t d = 0; d < 3; ++d)
    {
      for (const double b : spline.Knots()[d].Breaks())
      {
        breaks[d].push_back({ b, false });
      }
      for (const double c : spline.Knots()[d].Creases())
      {
        breaks[d].push_back({ c, true });
      }
    }
  };
  const Spline& geometry = this->Body.Geometry();
  add(geometry);
  for (std::size_t a = 0; a < this->Prepared->Attributes().size(); ++a)
  {
    const auto& attribute = this->Prepared->Attributes()[a];
    this->Attributes.push_back(&attribute->Evaluator());
    if (this->Options.AttributeTolerances[a] > 0.0)
    {
      add(attribute->Spline());
    }
  }
  const std::array<std::vector<double>, 3> creases = field.Creases();
  const std::array<std::vector<double>, 3> own = field.Breaks();
  for (std::size_t d = 0; d < 3; ++d)
  {
    for (const double b : own[d])
    {
      breaks[d].push_back({ b, false });
    }
    for (const double c : creases[d])
    {
      breaks[d].push_back({ c, true });
    }
  }

  // Lengths of the lines through the middle of the domain.
  for (int d = 0; d < 3; ++d)
  {
    const KnotVector& knots = geometry.Knots(d);
    this->Low[d] = knots.First();
    this->High[d] = knots.Last();
  }
  for (int d = 0; d < 3; ++d)
  {
    if (geometry.Knots(d).Degree() == 0)
    {
      continue;
    }
    this->Axes.push_back(d);
    constexpr int Steps = 8;
    Eigen::Matrix3Xd parameters(3, Steps + 1);
    Eigen::MatrixXd points(geometry.Components(), Steps + 1);
    for (int i = 0; i <= Steps; ++i)
    {
      parameters.col(i) = 0.5 * (this->Low + this->High);
      parameters(d, i) = this->Low[d] + i * (this->High[d] - this->Low[d]) / Steps;
    }
    this->Geometry.Evaluate(Steps + 1, parameters.data(), points.data());
    double& sum = this->Lengths[static_cast<std::size_t>(d)];
    for (int i = 1; i <= Steps; ++i)
    {
      sum += (points.col(i) - points.col(i - 1)).norm();
    }
    this->DomainWidth = std::max(this->DomainWidth, sum);
  }
  for (int d = 0; d < 3; ++d)
  {
    const auto D = static_cast<std::size_t>(d);
    if (geometry.Knots(d).Degree() == 0)
    {
      this->Lines[D] = CellLines(this->Low[d]);
      continue;
    }
    Merge(breaks[D]);
    breaks[D].front().At = this->Low[d];
    breaks[D].back().At = this->High[d];
    std::vector<double> at;
    std::vector<bool> isCrease;
    for (const Break& b : breaks[D])
    {
      at.push_back(b.At);
      isCrease.push_back(b.IsCrease);
    }
    this->BreakAt[D] = std::move(at);
    this->IsCreaseAt[D] = std::move(isCrease);
  }
}

double ZeroSet::Worker::RootsFor(double length, double shortest)
{
  return length > 0.0 ? std::min(LargestAspect, length / shortest) : 1.0;
}

void ZeroSet::Worker::SetLines(std::array<CellLines, 3> lines)
{
  this->Lines = std::move(lines);
  this->Scale = this->High - this->Low;
  this->AreLinesTurned = false;
  for (const int d : this->Axes)
  {
    const CellLines& own = this->Lines[static_cast<std::size_t>(d)];
    this->Scale[d] /= own.NumberOfRoots();
    this->AreLinesTurned = this->AreLinesTurned != own.IsMirrored();
  }
}

bool ZeroSet::Worker::Parallel(
  Index count, Index grain, const std::function<void(Index, Index)>& body) const
{
  // Chunks begin at multiples of the grain whatever the threads do: some results go by chunk.
  // Many go to a thread at once where there are many: handing one out takes a while.
  constexpr Index Shares = 256;
  const Index chunks = (count + grain - 1) / grain;
  this->Options.For(static_cast<std::ptrdiff_t>(chunks),
    static_cast<std::ptrdiff_t>(std::max<Index>(1, chunks / Shares)),
    [this, &body, count, grain](std::ptrdiff_t begin, std::ptrdiff_t end)
    {
      for (Index c = begin; c < end && !this->Options.Abort(); ++c)
      {
        body(c * grain, std::min(count, (c + 1) * grain));
      }
    });
  return !this->Options.Abort();
}

bool ZeroSet::Worker::Extract()
{
  // Root cells that are about cubes.
  double shortest = INFINITY;
  for (const double length : this->Lengths)
  {
    shortest = length > 0.0 ? std::min(shortest, length) : shortest;
  }
  std::array<CellLines, 3> lines = this->Lines;
  for (const int d : this->Axes)
  {
    const auto D = static_cast<std::size_t>(d);
    const int roots = static_cast<int>(RootsFor(this->Lengths[D], shortest) + 0.5);
    lines[D] = CellLines(this->BreakAt[D], this->IsCreaseAt[D], roots);
  }
  this->SetLines(std::move(lines));
  const auto finish = [this]
  { return this->FindValues() && this->TraceFaces() && this->FollowCurves() && this->Fill(); };
  bool finished = this->Search() && finish();
  for (int round = 0; round < MostRefinements && finished && this->Refine(); ++round)
  {
    finished = finish();
  }
  if (!finished || !this->Assemble())
  {
    return false;
  }
  for (const auto& edge : this->OpenEdges)
  {
    ++(this->SidesOf(edge) != 0 ? this->Certificate.OpenEdgesOnBoundary
                                : this->Certificate.OpenEdgesInside);
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

const std::vector<ParameterBox>& ZeroSet::UndecidedBoxes() const
{
  return this->W->UndecidedBoxes;
}

}
