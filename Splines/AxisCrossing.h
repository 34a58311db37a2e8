// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_AxisCrossing_h
#define hyperpatch_AxisCrossing_h

#include "Spline.h"

#include <Eigen/Core>

#include <optional>

namespace hyperpatch
{

/// Where a section that is to be revolved crosses the axis; what it draws would overlap itself
/// there at any angle. Touching is no crossing.
///
/// A section in a plane through the axis: if it has points on both sides, by more than 1e-9 of its
/// greatest distance from the axis. The convex hull property decides; what passes is nowhere beyond
/// the axis by more than twice that.
///
/// Any other surface: if the axis passes through it in a point inside. Pieces whose control points
/// lie on one side of some plane through the axis have none; in the others Newton's method looks
/// for one, down to 1/1024 of the domain. (A curve out of a plane meets the axis in single points
/// only.)
///
/// \param section a curve or surface of three coordinates in its first directions
/// \param axis not zero
/// \throws Error if the section lies on the axis
[[nodiscard]] std::optional<Eigen::Vector3d> FindAxisCrossing(
  const Spline& section, const Eigen::Vector3d& point, const Eigen::Vector3d& axis);

}

#endif
