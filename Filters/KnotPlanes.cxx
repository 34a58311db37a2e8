// SPDX-License-Identifier: BSD-3-Clause
#include "KnotPlanes.h"

#include "ModelExchange.h"
#include "Operators.h"

#include <algorithm>

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

/// The plane between the end of a part of a patch and a layer, where they have one in common.
void AddCommonPart(
  const Patch& patch, const Patch& above, std::size_t direction, std::vector<KnotPlane>& planes)
{
  const Spline& geometry = patch.Body.Geometry();
  std::array<int, 3> begin{};
  std::array<int, 3> end{};
  bool meet = true;
  for (std::size_t d = 0; d < 3; ++d)
  {
    const auto own = static_cast<int>(geometry.Knots()[d].Spans().size());
    const auto other = static_cast<int>(above.Body.Geometry().Knots()[d].Spans().size());
    begin[d] = std::max(patch.FirstSpan[d], above.FirstSpan[d]);
    end[d] = std::min(patch.FirstSpan[d] + own, above.FirstSpan[d] + other);
    meet =
      meet && (d == direction ? patch.FirstSpan[d] + own == above.FirstSpan[d] : begin[d] < end[d]);
  }
  if (!meet)
  {
    return;
  }
  const auto last = static_cast<int>(geometry.Knots()[direction].Spans().size()) - 1;
  std::array<int, 3> first = begin;
  first[direction] = patch.FirstSpan[direction] + last;
  planes.push_back(
    { &patch, Overlap(LayerOf(geometry, direction, last), patch.FirstSpan, begin, end, direction),
      Overlap(above.Body.Geometry(), above.FirstSpan, begin, end, direction),
      static_cast<int>(direction), first, {} });
}

}

std::vector<KnotPlane> FindKnotPlanes(const hyperpatch::MultiPatch& model,
  const std::function<std::vector<double>(const std::vector<double>&)>& allGather)
{
  std::vector<KnotPlane> planes;
  for (std::size_t d = 0; d < 3; ++d)
  {
    // Layers above the begin of parts of patches, which other ranks may have the lower side of.
    hyperpatch::MultiPatch layers;
    for (const Patch& patch : model.Patches)
    {
      if (!IsVolume(patch))
      {
        continue;
      }
      const Spline& geometry = patch.Body.Geometry();
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
        layers.Patches.push_back(
          { patch.Id, hyperpatch::Aggregate(LayerOf(geometry, d, 0)), patch.FirstSpan });
      }
    }
    const hyperpatch::MultiPatch everywhere =
      ModelExchange::UnpackModel(allGather(ModelExchange::Pack(layers)));
    for (const Patch& above : everywhere.Patches)
    {
      for (const Patch& patch : model.Patches)
      {
        if (patch.Id == above.Id && IsVolume(patch) && !patch.IsDomainFace[2 * d + 1])
        {
          AddCommonPart(patch, above, d, planes);
        }
      }
    }
  }
  return planes;
}
