// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_Validity_h
#define hyperpatch_Validity_h

#include "Parallel.h"
#include "Spline.h"
#include "ValidityTest.h"

#include <cstddef>
#include <vector>

namespace hyperpatch
{

struct PatchValidity
{
  /// 1, or -1 for a left-handed patch: Handedness(), and where that is 0 the sign of the first
  /// element that is decided.
  int Handedness = 0;
  /// Of which handedness bounds of scaled Jacobians keep to their tolerance; 0: of both.
  int ScaledHandedness = 0;
  /// One per element (non-empty knot span), u fastest. With respect to the patch's own knots.
  std::vector<ElementValidity> Elements;
  /// How many of them were tested; the others were known before.
  std::size_t Tested = 0;
};

/// What TestValidity() has told of a volume before its control points were edited.
struct KnownValidity
{
  const Spline* Geometry;
  /// Obtained with the same options.
  const PatchValidity* Validity;
};

/// Tests the elements of a volume. Left-handed patches are valid; an element whose sign is not the
/// patch's gets verdict -1, with a witness.
/// \param handedness of the whole patch, where the geometry is a part of it; 0: found here
/// \param known if given, only the elements that an edited control point or weight reaches are
/// tested again
/// \throws Error if the geometry is not a volume of three coordinates, or an option is out of range
[[nodiscard]] PatchValidity TestValidity(const Spline& geometry,
  const ValidityOptions& options = {}, const ParallelFor& parallelFor = SerialFor,
  int handedness = 0, const KnownValidity* known = nullptr);

/// Which elements (non-empty knot spans, u fastest) of a spline are not bitwise those that it had
/// before: all of them if knots, sizes or rationality have changed, otherwise those that an edited
/// control point or weight reaches.
[[nodiscard]] std::vector<bool> ChangedElements(const Spline& before, const Spline& after);

}

#endif
