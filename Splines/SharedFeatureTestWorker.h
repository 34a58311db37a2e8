// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_SharedFeatureTestWorker_h
#define hyperpatch_SharedFeatureTestWorker_h

#include "BezierPieceWorker.h"
#include "Cone.h"
#include "ContactWorker.h"

#include <vector>

namespace hyperpatch
{

/// Internal to the intersection tests: whether one vector of each of up to three cones are always
/// linearly independent.
[[nodiscard]] bool AreIndependent(const std::vector<Cone>& cones);

/// Whether two pieces that share a feature meet at it only, up to points that are one because an
/// edge is collapsed: the test of pairs that IntersectionTest describes.
/// \param mayVanish derivatives may be zero somewhere on a or b
[[nodiscard]] bool MeetOnlyAt(
  const SharedFeature& feature, const BezierPiece& a, const BezierPiece& b, bool mayVanish);

}

#endif
