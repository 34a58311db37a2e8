// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_Interfaces_h
#define hyperpatch_Interfaces_h

#include "Aggregate.h"

#include <array>
#include <optional>
#include <vector>

namespace hyperpatch
{

/// An interface in G+Smo's convention from its parts: direction d of patch 1 runs along
/// `direction[d]` of patch 2, the same way where `same[d]`. The entries of the direction across the
/// interface are filled in here: the side's direction maps to the other side's, and they run the
/// same way if one side is a first and the other a last one.
/// \param side1, side2 0..5; the result counts sides from 1
[[nodiscard]] Interface MakeInterface(int patch1, int side1, int patch2, int side2,
  std::array<int, 3> direction, std::array<bool, 3> same);

/// The interface of two sides whose control points and weights coincide, if they do.
///
/// All control points of one side, taken in one of the 8 orientations (2 for a surface's edges),
/// must lie within `distance` of those of the other, with weights equal to 1e-6 relative, the same
/// degrees, and knots that agree to 1e-6 of the domain after scaling. A side that collapses to a
/// curve or point has no orientation and gives none.
/// \param side1, side2 0..5, of directions that are there
[[nodiscard]] std::optional<Interface> MatchSides(
  const Patch& patch1, int side1, const Patch& patch2, int side2, double distance);

/// All pairs of sides that coincide in the sense of MatchSides, for models whose file has no
/// topology. A side takes part in at most one interface: where more than two coincide, they are
/// paired in the order of the patches. Cuts inside a patch (IsDomainFace false) take no part.
/// Linear in the number of patches (sides are hashed by the mean of their corners).
/// \param relativeTolerance of control points, a fraction of the diagonal of all control points'
/// bounds; 1e-9 to 1e-6 is usual
/// \throws Error if the tolerance is not in [0, 1).
[[nodiscard]] std::vector<Interface> FindInterfaces(
  const MultiPatch& model, double relativeTolerance);

}

#endif
