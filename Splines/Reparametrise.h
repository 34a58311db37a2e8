// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_Reparametrise_h
#define hyperpatch_Reparametrise_h

#include "Aggregate.h"

#include <functional>
#include <vector>

namespace hyperpatch
{

/// Operators that leave the shape as it is and change how it is parametrised: bitwise the same
/// control points and weights, in another order or over other knots.

/// The same spline over [first, last] in one direction (a linear change of its parameter).
/// \throws Error if the interval is empty or not finite
[[nodiscard]] Spline ScaleDomain(
  const Spline& spline, int direction, double first = 0.0, double last = 1.0);

/// The same spline run through backwards in one direction, on the same domain.
[[nodiscard]] Spline ReverseDirection(const Spline& spline, int direction);

/// The same spline with two directions exchanged. It changes the handedness of a volume, as
/// ReverseDirection does.
[[nodiscard]] Spline SwapDirections(const Spline& spline, int direction1, int direction2);

/// Geometry and attributes, each after a function that keeps their domains alike.
[[nodiscard]] Aggregate Apply(
  const Aggregate& aggregate, const std::function<Spline(const Spline&)>& function);

/// Both operators on all patches of a model, whose interfaces and boundaries follow.
/// \throws Error if a patch is only a part of one
[[nodiscard]] MultiPatch ReverseDirection(MultiPatch model, int direction);
[[nodiscard]] MultiPatch SwapDirections(MultiPatch model, int direction1, int direction2);

/// The same splines over one basis: on the domain of the first, clamped, of the greatest degree and
/// with the knots of all, in each direction (The NURBS Book, section 8.4); all rational if one is.
/// Knots closer than 1e-12 of the domain are one. The maps stay the same, to round-off.
/// \throws Error if they have different numbers of components, or none is there
[[nodiscard]] std::vector<Spline> MakeCompatible(const std::vector<Spline>& splines);

}

#endif
