// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_JacobianCrease_h
#define hyperpatch_JacobianCrease_h

#include "Spline.h"

#include <Eigen/Core>

#include <cstdint>

namespace hyperpatch
{

/// The part of a C0 knot plane across which det J jumps from one sign to the other. Joy &
/// Duchaineau's theorem 4.1 asks for a C1 map: at such a plane a volume can fold back without a
/// zero of det J, and this part, together with the sheets det J = 0 of both sides, which end on its
/// border, is the fold.
struct JacobianCrease
{
  Eigen::Matrix3Xd Parameters;
  Eigen::Matrix3Xd Points;  ///< exact for their parameters
  Eigen::Matrix3Xd Normals; ///< unit; from the side where det J < 0 to the other, in parameters
  /// Point indices, counter-clockwise around the normals.
  Eigen::Matrix<std::int64_t, 3, Eigen::Dynamic> Triangles;
  Eigen::Matrix3Xi Elements; ///< per triangle: the non-empty span of `below`, counted from 0

  double LargestError = 0.0; ///< physical distance, measured at midpoints of edges
  /// Cells without a piece whose bounds do not exclude one. Where the map is smooth across the
  /// plane but for its speed these are the cells around det J = 0, which is there on both sides.
  std::int64_t UndecidedCells = 0;
  /// Some of these are wider than the feature size: a finer grid may decide them.
  bool HasWideUndecidedCells = false;
};

/// Extracts that part on a grid. Every element of the plane in which both signs are not certainly
/// equal is divided into subdivision^2 cells; cells that the Bernstein coefficients of det J on
/// either side do not decide are cut along the zeros of both determinants, found on edges to
/// round-off. Equal subdivisions on all planes leave no cracks between elements and between parts
/// of a plane.
///
/// \param below, above volumes with three coordinates that end, and begin, on the plane with the
/// same face (one span thick is enough) \param direction whose knot it is \param subdivision a
/// power of two \param featureSize of undecided cells that want a finer grid \throws Error if the
/// volumes do not meet in the direction, or the subdivision is no power of two
[[nodiscard]] JacobianCrease ExtractJacobianCrease(
  const Spline& below, const Spline& above, int direction, int subdivision, double featureSize);

}

#endif
