// SPDX-License-Identifier: BSD-3-Clause
#include "ControlBounds.h"

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

void Join(std::size_t m, const double* low, const double* high, double* toLow, double* toHigh)
{
  for (std::size_t c = 0; c < m; ++c)
  {
    toLow[c] = std::min(toLow[c], low[c]);
    toHigh[c] = std::max(toHigh[c], high[c]);
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
  std::array<int, 3> spans{};
  std::array<int, 3> size{};
  for (std::size_t d = 0; d < 3; ++d)
  {
    spans[d] = static_cast<int>(spline.Knots()[d].Spans().size());
    size[d] = (spans[d] + Leaf - 1) / Leaf;
  }
  const auto empty = [m](const std::array<int, 3>& blocks)
  {
    return Level{ blocks, std::vector<double>(m * Count(blocks), INFINITY),
      std::vector<double>(m * Count(blocks), -INFINITY) };
  };
  this->Levels.push_back(empty(size));
  Level& leaves = this->Levels.front();
  std::size_t b = 0;
  for (int k = 0; k < size[2]; ++k)
  {
    for (int j = 0; j < size[1]; ++j)
    {
      for (int i = 0; i < size[0]; ++i, ++b)
      {
        const std::array<int, 3> first{ Leaf * i, Leaf * j, Leaf * k };
        std::array<int, 3> last{};
        for (std::size_t d = 0; d < 3; ++d)
        {
          last[d] = std::min(first[d] + Leaf, spans[d]) - 1;
        }
        this->Window(first, last, &leaves.Low[m * b], &leaves.High[m * b]);
      }
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
  if (widest <= 2)
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
