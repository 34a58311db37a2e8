// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_CollapsedSidesWorker_h
#define hyperpatch_CollapsedSidesWorker_h

#include "Spline.h"

#include <Eigen/Core>

#include <array>

namespace hyperpatch
{

/// The sides and edges of a patch that are collapsed along some of their directions, to a line or a
/// point (the axis of a cylinder, the centre and the poles of a ball): parameters that differ in
/// these directions alone are one point there, which is free in them.
///
/// Sides of the domain are bits, u0 u1 v0 v1 w0 w1; directions are bits. Of the parameters that are
/// one point those at the low end of the domain stand for it.
class CollapsedSides
{
public:
  CollapsedSides() = default;
  /// From control points and weights, so that it holds for all points of a side.
  /// \param distance points nearer to each other are the same
  CollapsedSides(const Spline& geometry, double distance);

  [[nodiscard]] bool IsAny() const { return this->Table.back() != 0; }
  /// The directions in which all points in these sides are free.
  [[nodiscard]] unsigned Free(unsigned sides) const { return this->Table[sides]; }
  /// The sides that a point lies in, both ends of the directions in which it is free among them.
  [[nodiscard]] unsigned SidesOf(const Eigen::Vector3d& u) const;

  /// Whether a cell must not reach from one end of the domain to the other: points at both would be
  /// free alike, and what lies between them would not be known.
  [[nodiscard]] bool NeedsMiddle(int direction) const;

private:
  std::array<unsigned char, 64> Table{};
  Eigen::Vector3d Low, High; ///< the domain
};

}

#endif
