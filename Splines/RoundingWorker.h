// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_RoundingWorker_h
#define hyperpatch_RoundingWorker_h

#include <limits>

/// Internal: what a priori rounding bounds are made of (Higham 2002, section 3.1).
namespace hyperpatch::rounding
{

/// Unit roundoff.
inline constexpr double U = std::numeric_limits<double>::epsilon() / 2;

/// Covers a handful of roundings of the bounds' own arithmetic.
inline constexpr double Outward = 1.0 + 32 * U;

/// The relative error of that many roundings in a row.
inline double Gamma(double operations)
{
  return operations * U / (1.0 - operations * U);
}

}

#endif
