// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_Range_h
#define hyperpatch_Range_h

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace hyperpatch
{

/// Least and greatest value of something; an enclosure.
struct Range
{
  double Low;
  double High;

  [[nodiscard]] bool Contains(double x) const { return this->Low <= x && x <= this->High; }
};

/// The range of value(0) .. value(count - 1), empty (infinity, -infinity) for none.
template <typename Value>
[[nodiscard]] Range RangeOf(std::ptrdiff_t count, const Value& value)
{
  // Four at a time, so that none waits for another.
  constexpr std::ptrdiff_t Lanes = 4;
  double low[Lanes] = { INFINITY, INFINITY, INFINITY, INFINITY };
  double high[Lanes] = { -INFINITY, -INFINITY, -INFINITY, -INFINITY };
  std::ptrdiff_t i = 0;
  for (; i + Lanes <= count; i += Lanes)
  {
    for (std::ptrdiff_t l = 0; l < Lanes; ++l)
    {
      const double x = value(i + l);
      low[l] = std::min(low[l], x);
      high[l] = std::max(high[l], x);
    }
  }
  for (; i < count; ++i)
  {
    const double x = value(i);
    low[0] = std::min(low[0], x);
    high[0] = std::max(high[0], x);
  }
  return { std::min(std::min(low[0], low[1]), std::min(low[2], low[3])),
    std::max(std::max(high[0], high[1]), std::max(high[2], high[3])) };
}

/// The range of the numbers.
[[nodiscard]] inline Range RangeOf(const double* numbers, std::ptrdiff_t count)
{
  return RangeOf(count, [numbers](std::ptrdiff_t i) { return numbers[i]; });
}

/// The least range that holds both.
[[nodiscard]] inline Range Union(const Range& a, const Range& b)
{
  return { std::min(a.Low, b.Low), std::max(a.High, b.High) };
}

}

#endif
