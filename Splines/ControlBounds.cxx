// SPDX-License-Identifier: BSD-3-Clause
#include "ControlBounds.h"

#include "Range.h"

#include <algorithm>
#include <cmath>

namespace hyperpatch
{

namespace
{

std::size_t Count(const std::array<int, 3>& size)
{
  return static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) *
    static_cast<std::size_t>(size[2]);
}

void Join(std::size_t count, const double* low, const double* high, double* toLow, double* toHigh)
{
  for (std::size_t c = 0; c < count; ++c)
  {
    toLow[c] = std::min(toLow[c], low[c]);
    toHigh[c] = std::max(toHigh[c], high[c]);
  }
}

/// Bounds of items of so many numbers each, over the items that each block looks at.
/// \param windows per block, the first item and the last
/// \param low, high blocks x count numbers; low and high of the items may be the same
void Reduce(const std::vector<std::array<int, 2>>& windows, std::size_t count,
  const double* itemLow, const double* itemHigh, double* low, double* high)
{
  for (const auto& [begin, end] : windows)
  {
    const std::size_t first = count * static_cast<std::size_t>(begin);
    std::copy_n(itemLow + first, count, low);
    std::copy_n(itemHigh + first, count, high);
    for (int i = begin + 1; i <= end; ++i)
    {
      const std::size_t at = count * static_cast<std::size_t>(i);
      Join(count, itemLow + at, itemHigh + at, low, high);
    }
    low += count;
    high += count;
  }
}

}

SpanBlock SpansOf(const Spline& spline, const ParameterBox& box)
{
  SpanBlock block{};
  for (std::size_t d = 0; d < 3; ++d)
  {
    const KnotVector& knots = spline.Knots()[d];
    const std::vector<int>& all = knots.Spans();
    const auto place = [&all](int span)
    { return static_cast<int>(std::lower_bound(all.begin(), all.end(), span) - all.begin()); };
    block.First[d] = place(knots.FindSpan(box.Low[d]));
    block.Last[d] = place(knots.FindSpan(box.High[d]));
    // A box that ends on a knot does not reach the span behind it.
    if (block.Last[d] > block.First[d] &&
      knots[all[static_cast<std::size_t>(block.Last[d])]] >= box.High[d])
    {
      --block.Last[d];
    }
  }
  return block;
}

ControlBounds::ControlBounds(const Spline& spline)
  : S(&spline)
{
  const auto m = static_cast<std::size_t>(spline.Components());
  std::array<int, 3> size{};
  std::array<std::vector<std::array<int, 2>>, 3> windows;
  for (std::size_t d = 0; d < 3; ++d)
  {
    const KnotVector& knots = spline.Knots()[d];
    const std::vector<int>& spans = knots.Spans();
    for (std::size_t first = 0; first < spans.size(); first += Leaf)
    {
      const std::size_t last = std::min(first + Leaf, spans.size()) - 1;
      windows[d].push_back({ spans[first] - knots.Degree(), spans[last] });
    }
    size[d] = static_cast<int>(windows[d].size());
  }
  const auto empty = [m](const std::array<int, 3>& blocks)
  {
    return Level{ blocks, std::vector<double>(m * Count(blocks), INFINITY),
      std::vector<double>(m * Count(blocks), -INFINITY) };
  };
  this->Levels.push_back(empty(size));
  Level& leaves = this->Levels.front();
  // Planes of the lattice become one for each layer of blocks, their rows one for each row, and
  // these the blocks themselves.
  const auto n = spline.Sizes();
  const std::size_t row = m * static_cast<std::size_t>(n[0]);
  const std::size_t plane = row * static_cast<std::size_t>(n[1]);
  const std::size_t rows = row * windows[1].size();
  std::vector<double> planeLow(plane);
  std::vector<double> planeHigh(plane);
  std::vector<double> rowLow(rows);
  std::vector<double> rowHigh(rows);
  const double* points = spline.Coefficients().data();
  std::size_t b = 0;
  for (const std::array<int, 2>& layer : windows[2])
  {
    Reduce({ layer }, plane, points, points, planeLow.data(), planeHigh.data());
    Reduce(windows[1], row, planeLow.data(), planeHigh.data(), rowLow.data(), rowHigh.data());
    for (std::size_t j = 0; j < rows; j += row)
    {
      Reduce(windows[0], m, &rowLow[j], &rowHigh[j], &leaves.Low[b], &leaves.High[b]);
      b += m * windows[0].size();
    }
  }
  while (Count(this->Levels.back().Size) > 1)
  {
    const Level& fine = this->Levels.back();
    Level coarse =
      empty({ (fine.Size[0] + 1) / 2, (fine.Size[1] + 1) / 2, (fine.Size[2] + 1) / 2 });
    b = 0;
    for (int k = 0; k < fine.Size[2]; ++k)
    {
      for (int j = 0; j < fine.Size[1]; ++j)
      {
        for (int i = 0; i < fine.Size[0]; ++i, ++b)
        {
          const auto to = static_cast<std::size_t>(i / 2 +
            coarse.Size[0] * (j / 2 + static_cast<std::ptrdiff_t>(coarse.Size[1]) * (k / 2)));
          Join(m, &fine.Low[m * b], &fine.High[m * b], &coarse.Low[m * to], &coarse.High[m * to]);
        }
      }
    }
    this->Levels.push_back(std::move(coarse));
  }
}

void ControlBounds::Window(
  const std::array<int, 3>& first, const std::array<int, 3>& last, double* low, double* high) const
{
  const auto m = static_cast<std::size_t>(this->S->Components());
  const auto n = this->S->Sizes();
  std::array<int, 3> begin{};
  std::array<int, 3> end{};
  for (std::size_t d = 0; d < 3; ++d)
  {
    const KnotVector& knots = this->S->Knots()[d];
    begin[d] = knots.Spans()[static_cast<std::size_t>(first[d])] - knots.Degree();
    end[d] = knots.Spans()[static_cast<std::size_t>(last[d])];
  }
  for (int k = begin[2]; k <= end[2]; ++k)
  {
    for (int j = begin[1]; j <= end[1]; ++j)
    {
      const std::ptrdiff_t row = n[0] * (j + static_cast<std::ptrdiff_t>(n[1]) * k);
      const double* point =
        this->S->Coefficients().data() + static_cast<std::ptrdiff_t>(m) * (row + begin[0]);
      if (m == 1)
      {
        const Range range = RangeOf(point, end[0] - begin[0] + 1);
        *low = std::min(*low, range.Low);
        *high = std::max(*high, range.High);
        continue;
      }
      for (int i = begin[0]; i <= end[0]; ++i, point += m)
      {
        Join(m, point, point, low, high);
      }
    }
  }
}

void ControlBounds::Find(const ParameterBox& box, double* low, double* high) const
{
  const auto m = static_cast<std::size_t>(this->S->Components());
  std::fill_n(low, m, INFINITY);
  std::fill_n(high, m, -INFINITY);
  const auto [first, last] = SpansOf(*this->S, box);
  int widest = 1;
  for (std::size_t d = 0; d < 3; ++d)
  {
    widest = std::max(widest, last[d] - first[d] + 1);
  }
  // Numbers in a row are gone through faster than blocks are found.
  if (widest <= (m == 1 ? 8 : 2))
  {
    this->Window(first, last, low, high);
    return;
  }
  // The level on which the box is about two blocks wide.
  std::size_t l = 0;
  int block = Leaf;
  while (2 * block < widest && l + 1 < this->Levels.size())
  {
    block *= 2;
    ++l;
  }
  const Level& level = this->Levels[l];
  for (int k = first[2] / block; k <= last[2] / block; ++k)
  {
    for (int j = first[1] / block; j <= last[1] / block; ++j)
    {
      for (int i = first[0] / block; i <= last[0] / block; ++i)
      {
        const auto b = static_cast<std::size_t>(
          i + level.Size[0] * (j + static_cast<std::ptrdiff_t>(level.Size[1]) * k));
        Join(m, &level.Low[m * b], &level.High[m * b], low, high);
      }
    }
  }
}

}
