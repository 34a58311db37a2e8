// SPDX-License-Identifier: BSD-3-Clause
#include "ElementAxis.h"

#include <algorithm>
#include <cstddef>

namespace hyperpatch
{

int ElementAxis::Find(double u) const
{
  const auto next = std::upper_bound(this->Breaks.begin() + 1, this->Breaks.end() - 1, u);
  return static_cast<int>(next - this->Breaks.begin()) - 1;
}

ElementAxis MakeElementAxis(
  const std::vector<const Spline*>& splines, int direction, const std::vector<double>& more)
{
  ElementAxis axis;
  const std::vector<double> knots = splines[0]->Knots(direction).Breaks();
  // Domains may differ by this much; breaks that do are the same.
  const double tolerance = 1e-12 * (knots.back() - knots.front());
  axis.Breaks = knots;
  const auto add = [&axis, tolerance](const std::vector<double>& breaks)
  {
    for (const double knot : breaks)
    {
      const auto near = std::lower_bound(axis.Breaks.begin(), axis.Breaks.end(), knot - tolerance);
      if (near != axis.Breaks.end() && near != axis.Breaks.begin() && *near > knot + tolerance)
      {
        axis.Breaks.insert(near, knot);
      }
    }
  };
  for (std::size_t s = 1; s < splines.size(); ++s)
  {
    add(splines[s]->Knots(direction).Breaks());
  }
  add(more);
  for (const double knot : axis.Breaks)
  {
    axis.IsKnot.push_back(std::binary_search(knots.begin(), knots.end(), knot));
  }
  for (const Spline* spline : splines)
  {
    const KnotVector& k = spline->Knots(direction);
    std::vector<int>& spans = axis.Spans.emplace_back();
    for (int cell = 0; cell < axis.Cells(); ++cell)
    {
      const int span = k.FindSpan(axis.At(cell, 0.5));
      const auto at = std::lower_bound(k.Spans().begin(), k.Spans().end(), span);
      spans.push_back(static_cast<int>(at - k.Spans().begin()));
    }
  }
  return axis;
}

}
