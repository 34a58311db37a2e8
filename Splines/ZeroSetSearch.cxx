// SPDX-License-Identifier: BSD-3-Clause
#include "ZeroSetWorker.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace hyperpatch
{

namespace
{

/// A cell with more edges of tolerance length than this across, or more in all, is halved: one
/// metric does not fit a large one.
constexpr double MostAcross = 24.0;
constexpr double MostInside = 100.0;

/// Still less where the surface may stand nearly upright over its plane: then the metric varies.
constexpr double LeastSteepness = 0.2;
constexpr double MostAcrossFlat = 4.0;
constexpr double MostInsideFlat = 6.0;

/// A box no wider than so many tolerances never has so many edges in it.
constexpr double SurelySmall = 100.0;
constexpr double SurelySmallFlat = 10.0;

/// Boxes of a field without bounds are halved down to this share of the domain's diagonal.
constexpr int SampledDivisions = 32;

}

struct ZeroSet::Worker::Visited
{
  std::vector<Box> Next; ///< parts of those that were halved
  std::vector<Leaf> Leaves;
  std::vector<Box> Undecided; ///< narrow enough to be counted
  bool IsCapped = false;      ///< do not halve what is not certified
};

ParameterBox ZeroSet::Worker::Parameters(const Box& box) const
{
  ParameterBox parameters{};
  for (int d = 0; d < 3; ++d)
  {
    const auto D = static_cast<std::size_t>(d);
    const bool isThere = this->Lines[D].Length() > 0;
    const double a = this->Line(d, box.Low[D]);
    const double b = isThere ? this->Line(d, box.Low[D] + box.Size) : this->High[d];
    parameters.Low[D] = std::min(a, b);
    parameters.High[D] = std::max(a, b);
  }
  return parameters;
}

double ZeroSet::Worker::Width(const Box& box) const
{
  const ParameterBox p = this->Parameters(box);
  const int m = this->Geometry.Components();
  Eigen::Matrix<double, 3, 8> corners;
  for (int c = 0; c < 8; ++c)
  {
    for (int d = 0; d < 3; ++d)
    {
      const auto D = static_cast<std::size_t>(d);
      corners(d, c) = c >> d & 1 ? p.High[D] : p.Low[D];
    }
  }
  std::array<double, 24> points{};
  this->Geometry.Evaluate(8, corners.data(), points.data());
  const Eigen::Map<const Eigen::MatrixXd> x(points.data(), m, 8);
  return (x.rowwise().maxCoeff() - x.rowwise().minCoeff()).norm();
}

unsigned ZeroSet::Worker::FindFlat(const Box& box, const BoxSpline& f, bool& touches) const
{
  // The negative side of a zero face draws it. A positive one has to where there is no other side,
  // and nobody may where the other is positive too.
  unsigned flat = 0;
  const ParameterBox p = this->Parameters(box);
  for (const int d : this->Axes)
  {
    const auto D = static_cast<std::size_t>(d);
    const CellLines& lines = this->Lines[D];
    for (const bool high : { false, true })
    {
      const int line = box.Low[D] + (high ? box.Size : 0);
      std::array<Part, 3> part{ Part::Whole, Part::Whole, Part::Whole };
      const bool atHigh = high != lines.IsMirrored();
      part[D] = atHigh ? Part::High : Part::Low;
      if (!lines.IsCrease(line) || !f.Vanishes(part) ||
        f.Values({ Part::Whole, Part::Whole, Part::Whole }).High <= -f.Values(part).Low)
      {
        continue;
      }
      if (line == 0 || line == lines.Length())
      {
        flat |= this->GoesOn(d, line) ? 0u : 1u << (2 * d + (high ? 1 : 0));
        continue;
      }
      // The next root cell is the nearest that there can be on the other side.
      Eigen::Vector3d other(p.Low.data());
      other = 0.5 * (other + Eigen::Vector3d(p.High.data()));
      other[d] =
        0.5 * (this->Line(d, line) + this->Line(d, line + (high ? 1 : -1) * CellLines::RootSize));
      double value = 0.0;
      this->Field.Evaluate(1, other.data(), &value);
      touches = touches || value > 0.0;
    }
  }
  return flat;
}

bool ZeroSet::Worker::IsTooLarge(const Box& box, const Height& height) const
{
  if (this->Axes.size() < 3 || box.Size == 1)
  {
    return false;
  }
  const ParameterBox p = this->Parameters(box);
  const Eigen::Vector3d low(p.Low.data());
  const Eigen::Vector3d width = Eigen::Vector3d(p.High.data()) - low;
  const bool isSteep = height.Steepness >= LeastSteepness;
  const Eigen::Vector3d speed =
    Eigen::Vector3d(this->Lengths.data()).cwiseQuotient(this->High - this->Low);
  if (!this->HasAttributes() &&
    width.cwiseProduct(speed).norm() <=
      (isSteep ? SurelySmall : SurelySmallFlat) * this->Options.Tolerance)
  {
    return false;
  }
  const std::optional<Shape> shape = this->Probe(low + 0.5 * width, width, height.Axis);
  if (!shape)
  {
    return false;
  }
  const double h = shape->Centre[shape->Axis] - low[shape->Axis];
  if (h < -0.25 * width[shape->Axis] || h > 1.25 * width[shape->Axis])
  {
    return false;
  }
  const double a = std::sqrt(shape->Metric(0, 0)) * width[shape->A];
  const double b = std::sqrt(shape->Metric(1, 1)) * width[shape->B];
  const double inside =
    std::sqrt(std::max(0.0, shape->Metric.determinant())) * width[shape->A] * width[shape->B];
  return std::max(a, b) > (isSteep ? MostAcross : MostAcrossFlat) ||
    inside > (isSteep ? MostInside : MostInsideFlat);
}

void ZeroSet::Worker::Halve(const Box& box, std::vector<Box>& parts) const
{
  const int half = box.Size / 2;
  for (int c = 0; c < 1 << this->Axes.size(); ++c)
  {
    Box part{ box.Low, half };
    for (std::size_t a = 0; a < this->Axes.size(); ++a)
    {
      part.Low[static_cast<std::size_t>(this->Axes[a])] += (c >> a & 1) * half;
    }
    parts.push_back(part);
  }
}

void ZeroSet::Worker::Visit(const Box& box, BoxSpline& f, Visited& visited) const
{
  const ParameterBox parameters = this->Parameters(box);
  if (this->Field.Excludes(parameters))
  {
    return;
  }
  const bool known = this->Field.Restrict(parameters, f);
  bool halve = !known;
  Height height;
  if (known)
  {
    constexpr std::array<Part, 3> Everywhere{ Part::Whole, Part::Whole, Part::Whole };
    if (!f.Values(Everywhere).Contains(0.0))
    {
      return;
    }
    if (f.Vanishes(Everywhere) || f.IsLostInNoise())
    {
      visited.Undecided.push_back(box);
      visited.Leaves.push_back({ box, false, -1, true, 0 });
      return;
    }
    height = this->FindHeight(box, f);
    halve = height.Axis < 0 || this->IsTooLarge(box, height);
  }
  if (halve && height.Axis < 0 &&
    (box.Size == 1 || visited.IsCapped || this->Width(box) <= this->Options.Tolerance))
  {
    visited.Undecided.push_back(box);
    halve = false;
  }
  if (!halve)
  {
    bool touches = false;
    const unsigned flat = height.Axis >= 0 ? this->FindFlat(box, f, touches) : 0;
    if (touches)
    {
      visited.Undecided.push_back(box);
    }
    visited.Leaves.push_back(
      { box, height.Axis >= 0 && !touches, height.Axis, height.Rises, flat });
    return;
  }
  this->Halve(box, visited.Next);
}

void ZeroSet::Worker::VisitSampled(const Box& box, Visited& visited) const
{
  // Nothing bounds f: 3 x 3 x 3 samples and their gradients have to do.
  const ParameterBox p = this->Parameters(box);
  Eigen::Matrix<double, 3, 27> parameters;
  for (int i = 0; i < 27; ++i)
  {
    const std::array<int, 3> at{ i % 3, i / 3 % 3, i / 9 };
    for (int d = 0; d < 3; ++d)
    {
      const auto D = static_cast<std::size_t>(d);
      parameters(d, i) = p.Low[D] + 0.5 * at[D] * (p.High[D] - p.Low[D]);
    }
  }
  std::array<double, 27> values{};
  Eigen::Matrix<double, 3, 27> gradients;
  this->Field.EvaluateWithGradient(27, parameters.data(), values.data(), gradients.data());
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  const bool crosses = *low <= 0.0 && *high >= 0.0;
  Height height{ -1, true, 1.0 };
  double steepest = 0.0;
  for (const int d : this->Axes)
  {
    const auto D = static_cast<std::size_t>(d);
    const double least = gradients.row(d).cwiseAbs().minCoeff() * (p.High[D] - p.Low[D]);
    const bool rises = gradients.row(d).minCoeff() > 0.0 || gradients.row(d).maxCoeff() < 0.0;
    if (rises && least > steepest)
    {
      steepest = least;
      height.Axis = d;
      height.Rises = gradients(d, 0) > 0.0;
    }
  }
  const double width = this->Width(box);
  const double coarse = this->DomainWidth / SampledDivisions;
  const bool canHalve = box.Size > 1 && !visited.IsCapped && width > this->Options.Tolerance;
  const bool halve =
    canHalve && (crosses ? height.Axis < 0 || this->IsTooLarge(box, height) : width > coarse);
  if (!halve)
  {
    visited.Undecided.push_back(box);
    if (crosses)
    {
      visited.Leaves.push_back({ box, false, height.Axis, height.Rises, 0 });
    }
    return;
  }
  this->Halve(box, visited.Next);
}

void ZeroSet::Worker::SearchRoots(const Node& low, const Node& high, std::vector<Box>& found) const
{
  ParameterBox box{};
  std::size_t widest = 0;
  for (int d = 0; d < 3; ++d)
  {
    const auto D = static_cast<std::size_t>(d);
    const bool isThere = this->Lines[D].Length() > 0;
    const double a = this->Line(d, CellLines::RootSize * low[D]);
    const double b = isThere ? this->Line(d, CellLines::RootSize * high[D]) : this->High[d];
    box.Low[D] = std::min(a, b);
    box.High[D] = std::max(a, b);
    widest = high[D] - low[D] > high[widest] - low[widest] ? D : widest;
  }
  if (high[widest] - low[widest] <= 1)
  {
    Box root{ low, CellLines::RootSize };
    for (std::size_t d = 0; d < 3; ++d)
    {
      root.Low[d] = this->Lines[d].Length() > 0 ? low[d] * CellLines::RootSize : 0;
    }
    found.push_back(root);
    return;
  }
  if (this->Field.Excludes(box))
  {
    return;
  }
  Node middle = high;
  middle[widest] = (low[widest] + high[widest]) / 2;
  this->SearchRoots(low, middle, found);
  Node begin = low;
  begin[widest] = middle[widest];
  this->SearchRoots(begin, high, found);
}

bool ZeroSet::Worker::Search()
{
  this->Undecided.clear();
  this->WasCapped = false;
  this->Nodes.Clear();
  this->NodeAt.clear();
  this->NodeValues.clear();
  this->Halved.clear();
  this->HalvedKeys.Clear();
  this->Before = Round();
  this->Vertices.clear();
  this->Curves.clear();
  this->CornersOf.clear();
  this->Leaves.clear();
  this->Pieces.clear();
  std::vector<Box> open;
  {
    Node last{ 1, 1, 1 };
    for (const int d : this->Axes)
    {
      const auto D = static_cast<std::size_t>(d);
      last[D] = this->Lines[D].NumberOfRoots();
    }
    this->SearchRoots({ 0, 0, 0 }, last, open);
  }
  return this->SearchBoxes(std::move(open)) && this->UncoverBulges();
}

bool ZeroSet::Worker::SearchBoxes(std::vector<Box> open)
{
  const bool sampled = !this->Field.HasBounds();
  // Chunks are small: boxes differ much in what they cost.
  constexpr Index Grain = 8;
  while (!open.empty())
  {
    const auto count = static_cast<Index>(open.size());
    const bool capped = static_cast<double>(count) > 0.1 * this->Options.MaximumCells;
    std::vector<Visited> chunks(static_cast<std::size_t>((count + Grain - 1) / Grain));
    const bool finished = this->Parallel(count, Grain,
      [&](Index begin, Index end)
      {
        thread_local BoxSpline f;
        Visited& visited = chunks[static_cast<std::size_t>(begin / Grain)];
        visited.IsCapped = capped;
        for (Index i = begin; i < end; ++i)
        {
          const Box& box = open[static_cast<std::size_t>(i)];
          if (sampled)
          {
            this->VisitSampled(box, visited);
          }
          else
          {
            this->Visit(box, f, visited);
          }
        }
      });
    if (!finished)
    {
      return false;
    }
    open.clear();
    for (Visited& chunk : chunks)
    {
      open.insert(open.end(), chunk.Next.begin(), chunk.Next.end());
      this->Leaves.insert(this->Leaves.end(), chunk.Leaves.begin(), chunk.Leaves.end());
      this->Undecided.insert(this->Undecided.end(), chunk.Undecided.begin(), chunk.Undecided.end());
    }
    this->WasCapped = this->WasCapped || capped;
  }
  this->CollectNodes();
  return true;
}

std::vector<ZeroSet::Worker::Box> ZeroSet::Worker::TakeApart(const std::vector<char>& isTaken)
{
  std::size_t kept = 0;
  std::vector<Box> halved;
  this->Pieces.resize(this->Leaves.size());
  for (std::size_t i = 0; i < this->Leaves.size(); ++i)
  {
    if (isTaken[i] != 0)
    {
      this->Halve(this->Leaves[i].At, halved);
      continue;
    }
    if (kept != i)
    {
      this->Leaves[kept] = this->Leaves[i];
      this->Pieces[kept] = std::move(this->Pieces[i]);
      this->CornersOf[kept] = this->CornersOf[i];
    }
    ++kept;
  }
  this->Leaves.resize(kept);
  this->Pieces.resize(kept);
  this->CornersOf.resize(kept);
  return halved;
}

bool ZeroSet::Worker::Refine()
{
  this->Pieces.resize(this->Leaves.size());
  std::vector<char> isTaken(this->Leaves.size());
  for (std::size_t i = 0; i < this->Leaves.size(); ++i)
  {
    const Box& box = this->Leaves[i].At;
    isTaken[i] = box.Size > 1 && !this->Pieces[i].IsWithinTolerance &&
      this->Width(box) > this->Options.Tolerance;
  }
  std::vector<Box> halved = this->TakeApart(isTaken);
  return !halved.empty() && this->SearchBoxes(std::move(halved)) && this->UncoverBulges();
}

}
