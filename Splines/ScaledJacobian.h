// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_ScaledJacobian_h
#define hyperpatch_ScaledJacobian_h

#include "Cone.h"

#include <Eigen/Core>

#include <array>

namespace hyperpatch
{

/// Enclosures of the least and the greatest scaled Jacobian of an element, in [-1, 1].
struct ScaledJacobian
{
  Interval Minimum;
  Interval Maximum;
  /// Boxes that it took; at the limit the enclosures are right, but wider than the tolerance.
  int Boxes;

  /// Of the least one, times the handedness.
  [[nodiscard]] Interval Least(int handedness) const
  {
    return handedness < 0 ? Interval{ -this->Maximum.High, -this->Maximum.Low } : this->Minimum;
  }
};

/// Bounds det(P_u, P_v, P_w) / (|P_u| |P_v| |P_w|) on a Bezier volume: from outside by the triple
/// product of the cones of the derivatives, from inside by values at corners, halved where they are
/// too far apart. Rounding is included. Where a derivative vanishes the quotient is not defined:
/// there the enclosure is of the values around.
///
/// \param homogeneousBezierPoints 3 or 4 x product of (degrees + 1), as BezierExtractor gives them
/// \param tolerance how far apart the ends of either enclosure may be
/// \param handedness 1: the enclosure of the least value is wanted, that of the greatest may be
/// wider; -1: the other way round; 0: both are wanted
/// \param pointError bound of the error that each number of the points already has
/// \throws Error if the points do not fit the degrees, a weight is not positive, or the tolerance
/// is not positive
[[nodiscard]] ScaledJacobian BoundScaledJacobian(const Eigen::MatrixXd& homogeneousBezierPoints,
  std::array<int, 3> degrees, double tolerance = 0.05, int handedness = 0, int maxBoxes = 1000,
  double pointError = 0.0);

}

#endif
