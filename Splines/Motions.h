// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_Motions_h
#define hyperpatch_Motions_h

#include "Spline.h"

#include <Eigen/Core>

namespace hyperpatch
{

/// A motion is a curve of affine maps: a Spline of one direction, on [0, 1], whose 12 components
/// are the matrix [A | t] column by column. Moved by it, a point x draws the curve A(w) x + t(w); a
/// section of any kind draws a spline of one more direction whose control points are those of the
/// motion applied to those of the section (see Sweep). All motions here begin with the identity.
/// Angles are in degrees, and multiples of 90 are exact to the bit.

/// Along a vector. \throws Error if it is zero or not finite
[[nodiscard]] Spline Translation(const Eigen::Vector3d& vector);

/// Along a curve, parallel to itself: by C(w) - C(0), exactly.
/// \throws Error if the path is no curve of three coordinates
[[nodiscard]] Spline Translation(const Spline& path);

/// About an axis, exactly (rational quadratic arcs of at most 90 degrees; The NURBS Book, section
/// 7.3). \throws Error if the axis is zero, or the angle zero or beyond a full turn
[[nodiscard]] Spline Rotation(
  const Eigen::Vector3d& point, const Eigen::Vector3d& axis, double angle);

/// A screw: about an axis and along it at once. It is not rational, so this is an approximation, a
/// C1 cubic. Points at most `radius` away from the axis stay within `tolerance` of the true path at
/// every parameter: cubic Hermite interpolation over an angle d errs by at most radius d^4 / 384.
/// \param rise along the axis, positive in its direction
/// \throws Error if the axis or the angle is zero, or radius or tolerance not positive
[[nodiscard]] Spline Screw(const Eigen::Vector3d& point, const Eigen::Vector3d& axis, double angle,
  double rise, double radius, double tolerance);

/// Along a curve, turning with it: at each parameter of at least `sections` ones the motion is
/// exactly that of a rotation-minimising frame (double reflection; Wang, Juettler, Zheng & Liu,
/// ACM TOG 27(1), 2008), turned on about the tangent by `twist` times the parameter. In between it
/// is interpolated in the basis of the path, raised to degree 3 and refined; the point where the
/// path begins follows it exactly.
/// \throws Error if the path is no curve of three coordinates, has a corner or comes to rest,
/// there are fewer than 2 sections, or the twist is not finite
[[nodiscard]] Spline FollowPath(const Spline& path, double twist, int sections);

}

#endif
