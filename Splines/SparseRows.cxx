// SPDX-License-Identifier: BSD-3-Clause
#include "SparseRows.h"

#include <algorithm>

namespace hyperpatch
{

SparseRows SparseRows::Collocation(const KnotVector& knots, const std::vector<double>& sites)
{
  SparseRows rows;
  double values[MaxDegree + 1];
  for (const double site : sites)
  {
    const double at = std::clamp(site, knots.First(), knots.Last());
    const int span = knots.FindSpan(at);
    knots.BasisFunctions(span, at, values);
    rows.Append(values, values + knots.Degree() + 1, span - knots.Degree());
  }
  return rows;
}

void SparseRows::Append(const double* begin, const double* end, int column)
{
  while (begin != end && *begin == 0.0)
  {
    ++begin;
    ++column;
  }
  while (end != begin && end[-1] == 0.0)
  {
    --end;
  }
  this->Runs.push_back({ column, static_cast<int>(end - begin), this->Values.size() });
  this->Values.insert(this->Values.end(), begin, end);
}

void SparseRows::Multiply(int row, std::ptrdiff_t lines, const double* source, double* target) const
{
  // Parts that stay in the first level cache while all terms are added.
  constexpr std::ptrdiff_t part = 1024;
  const Row run = (*this)[row];
  for (std::ptrdiff_t begin = 0; begin < lines; begin += part)
  {
    const std::ptrdiff_t count = std::min(part, lines - begin);
    double* const sum = target + begin;
    std::fill_n(sum, count, 0.0);
    for (int i = 0; i < run.Count; ++i)
    {
      const double a = run.Values[i];
      const double* __restrict term = source + (run.First + i) * lines + begin;
      for (std::ptrdiff_t l = 0; l < count; ++l)
      {
        sum[l] += a * term[l];
      }
    }
  }
}

}
