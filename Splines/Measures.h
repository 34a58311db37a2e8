// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_Measures_h
#define hyperpatch_Measures_h

#include "Aggregate.h"

namespace hyperpatch
{

/// 1 or -1: the sign of det J on average, estimated as the sum of det J at the centre times the
/// volume over the elements, or over 8 x 8 x 8 blocks of them where there are more. 0 if the spline
/// is no volume in space, or the sum is 0 to rounding (1e-13 of what it could be).
[[nodiscard]] int Handedness(const Spline& geometry);

/// The same of the whole patch that this is a part of.
[[nodiscard]] int Handedness(const Patch& patch);

/// Bounds of the control points of all geometries, which contain the model (convex hull property):
/// low and high of x, y, z. Coordinates that a geometry does not have are 0; low > high if there
/// are no patches.
struct Bounds
{
  std::array<double, 3> Low;
  std::array<double, 3> High;
};
[[nodiscard]] Bounds ControlPointBounds(const MultiPatch& model);

}

#endif
