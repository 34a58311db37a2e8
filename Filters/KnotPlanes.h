// SPDX-License-Identifier: BSD-3-Clause
#ifndef KnotPlanes_h
#define KnotPlanes_h

#include "Aggregate.h"
#include "JacobianCrease.h"

#include <array>
#include <functional>
#include <vector>

/// A C0 knot plane of a patch, or a part of one, with what lies on both sides of it. Private to
/// this module.
struct KnotPlane
{
  const hyperpatch::Patch* Patch; ///< that draws it: the part below
  hyperpatch::Spline Below;       ///< one span thick
  hyperpatch::Spline Above;
  int Direction;
  std::array<int, 3> FirstSpan; ///< of Below in the whole patch
  hyperpatch::JacobianCrease Mesh;
};

/// The C0 knot planes inside the patches here, and those on which a part of a patch here ends and
/// another begins, wherever that is. All ranks must call it.
/// \param allGather the records of all ranks, in order
[[nodiscard]] std::vector<KnotPlane> FindKnotPlanes(const hyperpatch::MultiPatch& model,
  const std::function<std::vector<double>(const std::vector<double>&)>& allGather);

#endif
