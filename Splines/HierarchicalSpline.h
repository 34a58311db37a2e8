// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_HierarchicalSpline_h
#define hyperpatch_HierarchicalSpline_h

#include "Spline.h"

#include <array>
#include <vector>

namespace hyperpatch
{

/// A box of elements (knot spans) of one level of a hierarchical spline.
struct HierarchicalBox
{
  int Level = 0;
  std::array<int, 3> Begin{};
  std::array<int, 3> End{}; ///< one behind the last element
};

/// The largest lattice that FlattenHierarchicalSpline makes.
inline constexpr long long MaxFlattenedSize = 1LL << 22;

/// A hierarchical spline as the tensor-product spline of its finest level, the same map.
///
/// Level l + 1 halves every span of level l. The domain of level l is what boxes of that level or a
/// finer one cover (of level 0, all). A basis function is active where its support lies in the
/// domain of its level and not in that of the next (Kraft 1997); with truncation, the part that a
/// coarse function shares with functions whose support lies in the next domain is taken from it
/// (Giannelli, Juettler and Speleers, THB-splines, 2012, definition 4).
/// \param base knots of level 0
/// \param coefficients m x number of active functions, level by level, u fastest in each
/// \param truncated true for THB-splines, false for HB-splines
/// \throws Error if a box is outside its level, if the number of coefficients is not that of the
/// active functions, or if the finest lattice has more than MaxFlattenedSize control points
[[nodiscard]] Spline FlattenHierarchicalSpline(const std::array<KnotVector, 3>& base,
  const std::vector<HierarchicalBox>& boxes, const Eigen::MatrixXd& coefficients, bool truncated);

}

#endif
