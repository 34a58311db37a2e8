// SPDX-License-Identifier: BSD-3-Clause
#include "KnotPlanes.h"

#include "Operators.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace
{

using hyperpatch::KnotVector;
using hyperpatch::Patch;
using hyperpatch::Spline;

/// The layer of spans `at` of a direction.
Spline LayerOf(const Spline& spline, std::size_t direction, int at)
{
  std::array<int, 3> begin{};
  std::array<int, 3> end{};
  for (std::size_t d = 0; d < 3; ++d)
  {
    end[d] = static_cast<int>(spline.Knots()[d].Spans().size());
  }
  begin[direction] = at;
  end[direction] = at + 1;
  return hyperpatch::RestrictToSpans(spline, begin, end);
}

/// A layer of spans above the begin of a part of a patch, as another rank sees it.
struct Layer
{
  int PatchId;
  std::size_t Direction;
  std::array<int, 3> FirstSpan;
  Spline Geometry;
};

void Write(const Layer& layer, std::vector<double>& records)
{
  const auto add = [&records](double value) { records.push_back(value); };
  add(layer.PatchId);
  add(static_cast<double>(layer.Direction));
  for (std::size_t d = 0; d < 3; ++d)
  {
    add(layer.FirstSpan[d]);
    add(layer.Geometry.Knots()[d].Degree());
    add(static_cast<double>(layer.Geometry.Knots()[d].Knots().size()));
  }
  add(layer.Geometry.IsRational() ? 1.0 : 0.0);
  for (const KnotVector& knots : layer.Geometry.Knots())
  {
    records.insert(records.end(), knots.Knots().begin(), knots.Knots().end());
  }
  const auto append = [&records](const auto& matrix)
  { records.insert(records.end(), matrix.data(), matrix.data() + matrix.size()); };
  append(layer.Geometry.Coefficients());
  append(layer.Geometry.Weights());
}

Layer Read(const std::vector<double>& records, std::size_t& at)
{
  const auto next = [&records, &at]() { return records[at++]; };
  const auto nextInteger = [&next]() { return static_cast<int>(next()); };
  const int patchId = nextInteger();
  const int direction = nextInteger();
  std::array<int, 3> firstSpan{};
  std::array<int, 3> degrees{};
  std::array<int, 3> lengths{};
  Eigen::Index points = 1;
  for (std::size_t d = 0; d < 3; ++d)
  {
    firstSpan[d] = nextInteger();
    degrees[d] = nextInteger();
    lengths[d] = nextInteger();
    points *= lengths[d] - degrees[d] - 1;
  }
  const bool rational = next() != 0.0;
  std::array<KnotVector, 3> knots;
  for (std::size_t d = 0; d < 3; ++d)
  {
    std::vector<double> values(static_cast<std::size_t>(lengths[d]));
    std::generate(values.begin(), values.end(), next);
    knots[d] = KnotVector(degrees[d], std::move(values), hyperpatch::Smoothness::Discontinuous);
  }
  Eigen::MatrixXd coefficients(3, points);
  std::generate_n(coefficients.data(), coefficients.size(), next);
  Eigen::VectorXd weights(rational ? points : 0);
  std::generate_n(weights.data(), weights.size(), next);
  return { patchId, static_cast<std::size_t>(direction), firstSpan,
    Spline(std::move(knots), std::move(coefficients), std::move(weights)) };
}

bool IsVolume(const Patch& patch)
{
  return patch.Body.Geometry().Dimension() == 3 && patch.Body.Geometry().Components() == 3;
}

/// The part of a layer on spans [begin, end) of the whole patch along the plane.
Spline Overlap(const Spline& layer, const std::array<int, 3>& firstSpan,
  const std::array<int, 3>& begin, const std::array<int, 3>& end, std::size_t direction)
{
  std::array<int, 3> low{};
  std::array<int, 3> high{};
  for (std::size_t d = 0; d < 3; ++d)
  {
    low[d] = d == direction ? 0 : begin[d] - firstSpan[d];
    high[d] = d == direction ? 1 : end[d] - firstSpan[d];
  }
  return hyperpatch::RestrictToSpans(layer, low, high);
}

}

std::vector<KnotPlane> FindKnotPlanes(const hyperpatch::MultiPatch& model,
  const std::function<std::vector<double>(const std::vector<double>&)>& allGather)
{
  std::vector<KnotPlane> planes;
  std::vector<double> records;
  for (const Patch& patch : model.Patches)
  {
    const Spline& geometry = patch.Body.Geometry();
    if (!IsVolume(patch))
    {
      continue;
    }
    for (std::size_t d = 0; d < 3; ++d)
    {
      const KnotVector& knots = geometry.Knots()[d];
      const std::vector<double> breaks = knots.Breaks();
      for (const double crease : knots.Creases())
      {
        const auto at =
          static_cast<int>(std::lower_bound(breaks.begin(), breaks.end(), crease) - breaks.begin());
        std::array<int, 3> first = patch.FirstSpan;
        first[d] += at - 1;
        planes.push_back({ &patch, LayerOf(geometry, d, at - 1), LayerOf(geometry, d, at),
          static_cast<int>(d), first, {} });
      }
      // The knots of a part go on beyond its cuts, so that a crease there still shows.
      if (!patch.IsDomainFace[2 * d] && knots.Multiplicity(knots.First()) >= knots.Degree())
      {
        Write({ patch.Id, d, patch.FirstSpan, LayerOf(geometry, d, 0) }, records);
      }
    }
  }
  records = allGather(records);
  for (std::size_t at = 0; at < records.size();)
  {
    const Layer above = Read(records, at);
    const std::size_t d = above.Direction;
    for (const Patch& patch : model.Patches)
    {
      const Spline& geometry = patch.Body.Geometry();
      if (patch.Id != above.PatchId || !IsVolume(patch) || patch.IsDomainFace[2 * d + 1])
      {
        continue;
      }
      std::array<int, 3> begin{};
      std::array<int, 3> end{};
      bool meet = true;
      for (std::size_t e = 0; e < 3; ++e)
      {
        const auto own = static_cast<int>(geometry.Knots()[e].Spans().size());
        const auto other = static_cast<int>(above.Geometry.Knots()[e].Spans().size());
        begin[e] = std::max(patch.FirstSpan[e], above.FirstSpan[e]);
        end[e] = std::min(patch.FirstSpan[e] + own, above.FirstSpan[e] + other);
        meet =
          meet && (e == d ? patch.FirstSpan[e] + own == above.FirstSpan[e] : begin[e] < end[e]);
      }
      if (!meet)
      {
        continue;
      }
      const auto last = static_cast<int>(geometry.Knots()[d].Spans().size()) - 1;
      std::array<int, 3> first = begin;
      first[d] = patch.FirstSpan[d] + last;
      planes.push_back({ &patch,
        Overlap(LayerOf(geometry, d, last), patch.FirstSpan, begin, end, d),
        Overlap(above.Geometry, above.FirstSpan, begin, end, d), static_cast<int>(d), first, {} });
    }
  }
  return planes;
}
