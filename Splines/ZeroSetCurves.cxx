// SPDX-License-Identifier: BSD-3-Clause
#include "ZeroSetWorker.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace hyperpatch
{

namespace
{

constexpr std::int64_t MostCurvePoints = 4096;

}

bool ZeroSet::Worker::FollowCurves()
{
  this->Snap();
  return this->FindCurves();
}

bool ZeroSet::Worker::FindCurves()
{
  const auto count = static_cast<Index>(this->Curves.size());
  const std::vector<Index> kept = this->FindKept();
  constexpr Index Grain = 64;
  std::vector<Samples> found(static_cast<std::size_t>((count + Grain - 1) / Grain));
  const bool finished = this->Parallel(count, Grain,
    [&](Index begin, Index end)
    { this->Bend(begin, end, kept, found[static_cast<std::size_t>(begin / Grain)]); });
  if (!finished)
  {
    return false;
  }
  Index total = this->Shared.Count();
  std::vector<Index> start;
  for (const Samples& samples : found)
  {
    start.push_back(total);
    total += samples.Count();
  }
  this->Shared.Resize(*this, total);
  this->Before = Round();
  return this->Parallel(count, Grain,
    [&](Index begin, Index end)
    {
      const auto chunk = static_cast<std::size_t>(begin / Grain);
      this->Copy(found[chunk], 0, this->Shared, start[chunk], found[chunk].Count());
      for (Index c = begin; c < end; ++c)
      {
        this->Curves[static_cast<std::size_t>(c)].First += start[chunk];
      }
    });
}

std::vector<ZeroSet::Worker::Index> ZeroSet::Worker::FindKept() const
{
  std::vector<Index> kept(this->Curves.size(), -1);
  const auto isSame = [this](Index now, Index before)
  {
    return this->Shared.Parameters.col(now) == this->Before.Shared.Parameters.col(before) &&
      this->Shared.Points.col(now) == this->Before.Shared.Points.col(before);
  };
  const auto compare = [&](std::size_t i)
  {
    const int face = this->AtNode[i / 6].Faces[i % 6];
    const int faceBefore = this->Before.AtNode[i / 6].Faces[i % 6];
    if (face < 0 || faceBefore < 0)
    {
      return;
    }
    const auto [first, count] = this->CurvesOfFace[static_cast<std::size_t>(face)];
    const auto [firstBefore, countBefore] =
      this->Before.CurvesOfFace[static_cast<std::size_t>(faceBefore)];
    for (Index c = first; c < first + count; ++c)
    {
      const Curve& curve = this->Curves[static_cast<std::size_t>(c)];
      for (Index b = firstBefore; b < firstBefore + countBefore; ++b)
      {
        const Curve& before = this->Before.Curves[static_cast<std::size_t>(b)];
        if (this->CurveOf[static_cast<std::size_t>(c)] == c &&
          this->Before.CurveOf[static_cast<std::size_t>(b)] == b &&
          curve.Heights == before.Heights && curve.EdgeAxis == before.EdgeAxis &&
          curve.HasTwin == before.HasTwin && isSame(curve.From, before.From) &&
          isSame(curve.To, before.To))
        {
          kept[static_cast<std::size_t>(c)] = b;
        }
      }
    }
  };
  this->Parallel(6 * static_cast<Index>(this->Before.AtNode.size()), 64 * Batch,
    [&compare](Index begin, Index end)
    {
      for (Index i = begin; i < end; ++i)
      {
        compare(static_cast<std::size_t>(i));
      }
    });
  return kept;
}

void ZeroSet::Worker::Bend(Index begin, Index end, const std::vector<Index>& kept, Samples& found)
{
  const auto n = static_cast<std::size_t>(end - begin);
  const auto curve = [this, begin](std::size_t k) -> Curve&
  { return this->Curves[static_cast<std::size_t>(begin) + k]; };
  std::vector<std::size_t> open;
  std::vector<Samples> done(n); // inner points of curves that are finished
  for (std::size_t k = 0; k < n; ++k)
  {
    const Index before = kept[static_cast<std::size_t>(begin) + k];
    if (before >= 0)
    {
      const Curve& same = this->Before.Curves[static_cast<std::size_t>(before)];
      curve(k).Measured = same.Measured;
      curve(k).HasFailed = same.HasFailed;
      done[k].Resize(*this, same.Count);
      this->Copy(this->Before.Shared, same.First, done[k], 0, same.Count);
    }
    else if (this->CurveOf[static_cast<std::size_t>(begin) + k] == begin + static_cast<Index>(k))
    {
      open.push_back(k);
    }
  }
  // The axis along which points of the chord are moved onto the surface: in the face itself where
  // that is one of the domain or a crease; one in which the surface is a graph, if there is one,
  // best in the face; of those the steepest at the ends.
  std::vector<int> axisOf(n);
  {
    Eigen::Matrix3Xd ends(3, 2 * static_cast<Index>(open.size()));
    for (std::size_t o = 0; o < open.size(); ++o)
    {
      ends.col(static_cast<Index>(2 * o)) = this->Shared.Parameters.col(curve(open[o]).From);
      ends.col(static_cast<Index>(2 * o + 1)) = this->Shared.Parameters.col(curve(open[o]).To);
    }
    std::vector<double> values(2 * open.size());
    Eigen::Matrix3Xd g(3, ends.cols());
    this->Field.EvaluateWithGradient(2 * open.size(), ends.data(), values.data(), g.data());
    for (std::size_t o = 0; o < open.size(); ++o)
    {
      const std::size_t k = open[o];
      const auto i = static_cast<Index>(2 * o);
      double best = -1.0;
      const unsigned normal = 1u << curve(k).Normal;
      const unsigned possible = ~((curve(k).IsOnCrease ? normal : 0u) |
        (curve(k).EdgeAxis >= 0 ? 1u << curve(k).EdgeAxis : 0u));
      const unsigned graphs = curve(k).Heights & possible;
      const unsigned directions = (graphs & ~normal) != 0 ? graphs & ~normal
        : graphs != 0                                     ? graphs
                                                          : possible;
      for (const int d : this->Axes)
      {
        if ((directions >> d & 1u) == 0)
        {
          continue;
        }
        const double product = g(d, i) * g(d, i + 1);
        const double steep =
          product > 0.0 ? std::min(std::abs(g(d, i)), std::abs(g(d, i + 1))) * this->Scale[d] : 0.0;
        if (steep > best)
        {
          best = steep;
          axisOf[k] = d;
        }
      }
    }
  }
  // The chord from end to end, measured where a curve that bends to both sides is seen too.
  std::vector<Index> offset(n, 0);
  std::vector<Index> wanted(n, 0);
  std::vector<double> errors(n, 0.0);
  Samples samples;
  samples.Resize(*this, 0);
  this->MeasureCurves(begin, open, offset, wanted, samples, axisOf, { 0.25, 0.5, 0.75 }, errors);
  std::vector<std::size_t> next;
  for (const std::size_t k : open)
  {
    // Twins need a point inside: there is a piece of the surface between them.
    if (errors[k] > 1.0 || curve(k).HasTwin)
    {
      wanted[k] =
        std::max<Index>(1, static_cast<Index>(std::ceil(std::sqrt(std::min(errors[k], 1e6)))) - 1);
      next.push_back(k);
    }
  }
  open = std::move(next);
  std::vector<int> axes;
  std::vector<char> projected;
  constexpr int Rounds = 6;
  for (int round = 0; round < Rounds && !open.empty(); ++round)
  {
    Index total = 0;
    for (const std::size_t k : open)
    {
      offset[k] = total;
      total += wanted[k];
    }
    samples.Resize(*this, total);
    axes.resize(static_cast<std::size_t>(total));
    for (const std::size_t k : open)
    {
      const Eigen::Vector3d a = this->Shared.Parameters.col(curve(k).From);
      const Eigen::Vector3d b = this->Shared.Parameters.col(curve(k).To);
      for (Index i = 0; i < wanted[k]; ++i)
      {
        const double t = static_cast<double>(i + 1) / static_cast<double>(wanted[k] + 1);
        for (int d = 0; d < 3; ++d)
        {
          // Where both ends have the same bits, so has what is between.
          samples.Parameters(d, offset[k] + i) = a[d] == b[d] ? a[d] : (1.0 - t) * a[d] + t * b[d];
        }
        axes[static_cast<std::size_t>(offset[k] + i)] = axisOf[k];
      }
    }
    this->Project(samples.Parameters, axes, std::nullopt, projected);
    for (const std::size_t k : open)
    {
      for (Index i = 0; i < wanted[k] && curve(k).EdgeAxis >= 0; ++i)
      {
        // An edge is where it is.
        samples.Parameters(axisOf[k], offset[k] + i) =
          this->Shared.Parameters(axisOf[k], curve(k).From);
        projected[static_cast<std::size_t>(offset[k] + i)] = 1;
      }
    }
    this->Evaluate(samples, 0, total);
    this->MeasureCurves(begin, open, offset, wanted, samples, axisOf, { 0.5 }, errors);
    next.clear();
    for (const std::size_t k : open)
    {
      bool valid = true;
      for (Index i = 0; i < wanted[k]; ++i)
      {
        valid = valid && projected[static_cast<std::size_t>(offset[k] + i)] != 0;
      }
      if (valid && errors[k] > 1.1 && wanted[k] < MostCurvePoints && round + 1 < Rounds)
      {
        const double more = 1.05 * std::sqrt(std::min(errors[k], 64.0));
        wanted[k] = std::min(MostCurvePoints,
          static_cast<Index>(std::ceil(static_cast<double>(wanted[k] + 1) * more)) - 1);
        next.push_back(k);
      }
      else if (valid)
      {
        done[k].Resize(*this, wanted[k]);
        this->Copy(samples, offset[k], done[k], 0, wanted[k]);
      }
      else
      {
        curve(k).HasFailed = true;
      }
    }
    open = std::move(next);
  }
  Index total = 0;
  for (std::size_t k = 0; k < n; ++k)
  {
    curve(k).First = total;
    curve(k).Count = done[k].Count();
    total += done[k].Count();
  }
  found.Resize(*this, total);
  for (std::size_t k = 0; k < n; ++k)
  {
    this->Copy(done[k], 0, found, curve(k).First, done[k].Count());
  }
}

void ZeroSet::Worker::Project(Eigen::Matrix3Xd& parameters, const std::vector<int>& axes,
  const std::optional<Range>& within, std::vector<char>& projected) const
{
  const Index count = parameters.cols();
  projected.assign(static_cast<std::size_t>(count), 0);
  std::vector<Index> open(static_cast<std::size_t>(count));
  for (Index i = 0; i < count; ++i)
  {
    open[static_cast<std::size_t>(i)] = i;
    double& x = parameters(axes[static_cast<std::size_t>(i)], i);
    x = within ? std::min(std::max(x, within->Low), within->High) : x;
  }
  // Newton's steps, between brackets where there are any.
  std::vector<Range> brackets(within ? open.size() : 0, within.value_or(Range()));
  Eigen::Matrix3Xd at(3, count);
  Eigen::Matrix3Xd gradients(3, count);
  std::vector<double> values(static_cast<std::size_t>(count));
  constexpr int Most = 12;
  for (int iteration = 0; iteration < Most && !open.empty(); ++iteration)
  {
    for (std::size_t k = 0; k < open.size(); ++k)
    {
      at.col(static_cast<Index>(k)) = parameters.col(open[k]);
    }
    this->Field.EvaluateWithGradient(open.size(), at.data(), values.data(), gradients.data());
    std::size_t kept = 0;
    for (std::size_t k = 0; k < open.size(); ++k)
    {
      const Index i = open[k];
      const int axis = axes[static_cast<std::size_t>(i)];
      const double slope = gradients(axis, static_cast<Index>(k));
      double& x = parameters(axis, i);
      const double before = x;
      const double step = values[k] != 0.0 ? values[k] / slope : 0.0;
      // The next step would be smaller than round-off: quadratic convergence.
      const bool isLast = std::abs(step) <= 1e-9 * (this->High[axis] - this->Low[axis]);
      x = before - step;
      if (within && !isLast)
      {
        Range& bracket = brackets[static_cast<std::size_t>(i)];
        (step > 0.0 ? bracket.High : bracket.Low) = before;
        x = x > bracket.Low && x < bracket.High ? x : 0.5 * (bracket.Low + bracket.High);
      }
      x = std::min(std::max(x, this->Low[axis]), this->High[axis]);
      if (isLast)
      {
        projected[static_cast<std::size_t>(i)] = 1;
      }
      else if (std::isfinite(x))
      {
        open[kept++] = i;
      }
      else
      {
        x = before;
      }
    }
    open.resize(kept);
  }
}

}
