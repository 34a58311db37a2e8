// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_ScalarFieldWorker_h
#define hyperpatch_ScalarFieldWorker_h

#include "ControlBounds.h"
#include "Spline.h"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <limits>
#include <vector>

/// What the fields share; private to them.

namespace hyperpatch::field
{

/// Points are worked on in chunks of this size, with scratch made once per call.
inline constexpr std::size_t Chunk = 256;

inline constexpr double UnitRoundoff = std::numeric_limits<double>::epsilon();

/// The parameters between which the spline is one polynomial.
[[nodiscard]] std::array<std::vector<double>, 3> BreaksOf(const Spline& spline);

/// Interior knots that occur at least degree - `smoothness` times.
[[nodiscard]] std::array<std::vector<double>, 3> KnotsNoSmootherThan(
  const Spline& spline, int smoothness);

/// The knot span of each direction that holds the box.
[[nodiscard]] std::array<int, 3> SpansAround(const Spline& spline, const ParameterBox& box);

/// Calls visit(i) for the columns of the control points that reach the element of those spans.
template <typename Visit>
void ForControlWindow(const Spline& spline, const std::array<int, 3>& spans, Visit&& visit)
{
  const auto p = spline.Degrees();
  const auto n = spline.Sizes();
  for (int k = spans[2] - p[2]; k <= spans[2]; ++k)
  {
    for (int j = spans[1] - p[1]; j <= spans[1]; ++j)
    {
      const Eigen::Index row = n[0] * (j + static_cast<Eigen::Index>(n[1]) * k);
      for (int i = spans[0] - p[0]; i <= spans[0]; ++i)
      {
        visit(row + i);
      }
    }
  }
}

/// Homogeneous components of the spline on a box, each as a polynomial on the unit cube.
struct BezierBox
{
  Eigen::MatrixXd Points;
  double Error; ///< bound of the rounding error of each number
};

/// The box lies between knots.
[[nodiscard]] BezierBox OnBezierBox(const Spline& spline, const ParameterBox& box);

/// How many ulp of its largest control point a value may be off.
[[nodiscard]] double Operations(const Spline& spline);

}

#endif
