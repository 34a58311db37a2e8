// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_ZeroSetContactsWorker_h
#define hyperpatch_ZeroSetContactsWorker_h

#include <array>
#include <cstddef>
#include <vector>

/// Sides of parts of zero sets that coincide in space. Private to ZeroSetGroup.

namespace hyperpatch
{

/// A side of a part, to be compared with others.
struct ZeroSetSide
{
  int Part, Side;
  /// Values of the two parameters along it, in [0, 1], at which it is sampled; with some that are
  /// not symmetric.
  static constexpr std::array<double, 4> Places{ 0.0, 0.3, 0.7, 1.0 };
  static constexpr std::size_t Size = Places.size() * Places.size();
  std::array<std::array<double, 3>, Size> Samples; ///< the lower direction fastest
};

/// Two sides that are the same.
struct ZeroSetContact
{
  int Part, Side, OtherPart, OtherSide;
  std::array<int, 3> Axis; ///< the other's direction of each of ours
  std::array<bool, 3> Same;
};

/// Pairs of sides whose samples coincide. Sides that are collapsed have none.
[[nodiscard]] std::vector<ZeroSetContact> FindContacts(
  const std::vector<ZeroSetSide>& sides, double distance);

}

#endif
