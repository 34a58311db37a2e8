// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_ElementAxis_h
#define hyperpatch_ElementAxis_h

#include "Spline.h"

#include <vector>

namespace hyperpatch
{

/// The cells of one direction between the common breaks of several splines, in which each of them
/// is one polynomial.
struct ElementAxis
{
  std::vector<double> Breaks;
  std::vector<bool> IsKnot;            ///< per break: the first spline has it
  std::vector<std::vector<int>> Spans; ///< per spline and cell: index into its Knots(d).Spans()

  [[nodiscard]] int Cells() const { return static_cast<int>(this->Breaks.size()) - 1; }
  [[nodiscard]] double At(int cell, double t) const
  {
    const auto c = static_cast<std::size_t>(cell);
    return t >= 1.0 ? this->Breaks[c + 1]
                    : this->Breaks[c] + t * (this->Breaks[c + 1] - this->Breaks[c]);
  }
  [[nodiscard]] int Find(double u) const;
};

/// \param splines of the same domain, to 1e-12 of its length; that of the first is taken \param
/// more parameters at which to divide besides
[[nodiscard]] ElementAxis MakeElementAxis(
  const std::vector<const Spline*>& splines, int direction, const std::vector<double>& more = {});

}

#endif
