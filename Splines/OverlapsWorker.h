// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_OverlapsWorker_h
#define hyperpatch_OverlapsWorker_h

#include <Eigen/Core>

#include <array>
#include <vector>

namespace hyperpatch
{

/// Internal to the intersection tests: the pairs (a, b), a < b, of boxes that overlap or touch, in
/// ascending order, by a tree of boxes.
/// \param low, high 3 x n
[[nodiscard]] std::vector<std::array<int, 2>> FindOverlaps(
  const Eigen::Matrix3Xd& low, const Eigen::Matrix3Xd& high);

}

#endif
