// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_JacobianRounding_h
#define hyperpatch_JacobianRounding_h

#include "Spline.h"

#include <Eigen/Core>

#include <array>
#include <vector>

namespace hyperpatch
{

/// How far a Jacobian determinant may be off by the rounding of the derivatives it is made of.
///
/// A derivative is a sum in which control points cancel: where they are equal, as on a collapsed
/// face, nothing but the rounding of control points times p / (k_{i+p} - k_i) is left of it, which
/// its own size does not tell.
class JacobianRounding
{
public:
  /// \param geometry a volume
  explicit JacobianRounding(const Spline& geometry);

  /// A bound of the error of det J, of a matrix that Evaluator gave at a point of the domain.
  [[nodiscard]] double Bound(const Eigen::Matrix3d& J, const double* parameters) const;
  /// The largest such bound for this matrix at any point; cheaper.
  [[nodiscard]] double LargestBound(const Eigen::Matrix3d& J) const;

private:
  /// Of one direction: by knot span, how much larger a derivative's terms are than a value's, and
  /// how large values' terms are on that slab.
  struct Slabs
  {
    KnotVector Knots;
    std::vector<double> Factor, Magnitude;
    double LargestFactor = 0.0;
  };

  [[nodiscard]] double BoundOf(const Eigen::Matrix3d& J, const Eigen::Vector3d& terms) const;

  std::array<Slabs, 3> Directions;
  double LargestMagnitude = 0.0;
  double Operations;
};

}

#endif
