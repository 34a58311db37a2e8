// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_Operators_h
#define hyperpatch_Operators_h

#include "Aggregate.h"

#include <array>
#include <vector>

namespace hyperpatch
{

/// Operators that leave the map unchanged (to round-off), or that take an exact part or derivative
/// of it. Directions are 0, 1, 2 (u, v, w); sides are 0..5 (u first, u last, v first, ...).

/// The same spline with knots inserted in one direction (Oslo algorithm).
/// \param knots ascending, inside the domain (at its ends up to multiplicity degree + 1, which
/// clamps an unclamped spline); the interior multiplicity may reach the degree
/// \throws Error otherwise
[[nodiscard]] Spline InsertKnots(
  const Spline& spline, int direction, const std::vector<double>& knots);

/// The same spline with the degree of one direction raised by `times`; every break keeps its
/// smoothness (blossom of the raised polynomial; Ramshaw 1987). All weights are convex, so that
/// nothing cancels. \throws Error beyond MaxDegree, or if `times` is negative
[[nodiscard]] Spline ElevateDegree(const Spline& spline, int direction, int times = 1);

/// Splits every span into `pieces` equal ones, in each direction that is there (degree 1 or more).
/// \throws Error if `pieces` has a number less than 1
[[nodiscard]] Spline RefineUniformly(const Spline& spline, std::array<int, 3> pieces);

/// Makes both ends of every direction clamped.
[[nodiscard]] Spline Clamp(const Spline& spline);

/// The spline on a block of knot spans, a slice of its arrays: nothing is recomputed, and inside
/// the block the result is bitwise the same map. Spans are non-empty ones, counted from 0.
/// \param begin, end half-open range of spans per direction
/// \throws Error if a range is empty or has spans that do not exist
[[nodiscard]] Spline RestrictToSpans(
  const Spline& spline, std::array<int, 3> begin, std::array<int, 3> end);

/// The spline on a parameter box inside its domain, clamped to it (knot insertion, then slice).
/// \throws Error if the box is empty or not inside the domain
[[nodiscard]] Spline RestrictToBox(
  const Spline& spline, std::array<double, 3> low, std::array<double, 3> high);

/// One face of a volume, end of a surface or curve: the direction of the side becomes one that is
/// not there (degree 0), the two others stay where they are. A direction that is not there has two
/// equal faces, the spline itself. \throws Error if there is no such side
[[nodiscard]] Spline ExtractFace(const Spline& spline, int side);

/// The iso-parametric face at any value of one direction; at a discontinuous break the limit from
/// above. \throws Error if the value is outside the domain
[[nodiscard]] Spline ExtractIsoparametric(const Spline& spline, int direction, double value);

/// The derivative of a polynomial spline (control points p (P_{i+1} - P_i) / (k_{i+p+1} -
/// k_{i+1})). At a break that was C0 the result is discontinuous. A direction of degree 0 gives
/// zero. \throws Error if rational: differentiate its homogeneous form (AsPolynomial), or see
/// RationalDerivative.
[[nodiscard]] Spline Derivative(const Spline& spline, int direction);

/// The homogeneous control points of a rational spline as a polynomial one of m + 1 components.
[[nodiscard]] Spline AsPolynomial(const Spline& spline);

/// The exact derivative of a rational spline, as a rational spline in Bezier form: numerator
/// X' W - X W', denominator W^2, degrees twice those of the input. (Projecting the derivative of
/// the homogeneous form by its own weight is wrong.) A polynomial spline gives Derivative().
/// \throws Error if twice a degree exceeds MaxDegree
[[nodiscard]] Spline RationalDerivative(const Spline& spline, int direction);

/// Inserts knots until every break has multiplicity degree: one Bezier element per span, control
/// points shared by neighbours. Discontinuous breaks (multiplicity degree + 1) stay.
[[nodiscard]] Spline ToBezier(const Spline& spline);

/// The parts of a patch's geometry and attributes on a block of the geometry's knot spans, for work
/// in pieces. Attributes are sliced where the block ends at breaks of theirs, else cut by knot
/// insertion. FirstSpan, WholeSpans, IsDomainFace and WholeHandedness of the result continue those
/// of the input.
[[nodiscard]] Patch RestrictPatch(
  const Patch& patch, std::array<int, 3> begin, std::array<int, 3> end);

}

#endif
