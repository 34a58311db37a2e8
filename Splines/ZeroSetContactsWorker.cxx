// SPDX-License-Identifier: BSD-3-Clause
#include "ZeroSetContactsWorker.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace hyperpatch
{

namespace
{

constexpr int Count = static_cast<int>(ZeroSetSide::Places.size());
constexpr int Last = Count - 1;

std::size_t Index(int i)
{
  return static_cast<std::size_t>(i);
}

Eigen::Vector3d Sample(const ZeroSetSide& side, int i, int j)
{
  return Eigen::Vector3d(side.Samples[Index(i + Count * j)].data());
}

/// Whether all samples coincide along one of the directions.
bool IsCollapsed(const ZeroSetSide& side, double distance)
{
  std::array<bool, 2> collapsed{ true, true };
  for (int i = 0; i < Count; ++i)
  {
    for (int j = 0; j < Count; ++j)
    {
      const Eigen::Vector3d x = Sample(side, i, j);
      collapsed[0] = collapsed[0] && (x - Sample(side, 0, j)).norm() <= distance;
      collapsed[1] = collapsed[1] && (x - Sample(side, i, 0)).norm() <= distance;
    }
  }
  return collapsed[0] || collapsed[1];
}

/// How `two` lies on `one`: the first direction is flipped by 1, the second by 2, both are swapped
/// by 4.
bool Coincide(const ZeroSetSide& one, const ZeroSetSide& two, int code, double distance)
{
  for (int j = 0; j < Count; ++j)
  {
    for (int i = 0; i < Count; ++i)
    {
      const int a = code & 1 ? Last - i : i;
      const int b = code & 2 ? Last - j : j;
      const Eigen::Vector3d x = code & 4 ? Sample(two, b, a) : Sample(two, a, b);
      if (!((Sample(one, i, j) - x).norm() <= distance))
      {
        return false;
      }
    }
  }
  return true;
}

/// The directions along a side.
std::array<int, 2> Along(int side)
{
  return { side / 2 == 0 ? 1 : 0, side / 2 == 2 ? 1 : 2 };
}

ZeroSetContact MakeContact(const ZeroSetSide& one, const ZeroSetSide& two, int code)
{
  ZeroSetContact contact{ one.Part, one.Side, two.Part, two.Side, {}, {} };
  contact.Axis[Index(one.Side / 2)] = two.Side / 2;
  for (std::size_t d = 0; d < 2; ++d)
  {
    const auto along = Index(Along(one.Side)[d]);
    contact.Axis[along] = Along(two.Side)[code & 4 ? 1 - d : d];
    contact.Same[along] = (code >> d & 1) == 0;
  }
  return contact;
}

}

std::vector<ZeroSetContact> FindContacts(const std::vector<ZeroSetSide>& sides, double distance)
{
  // By the cells of a grid that the mean of the corners is in or near to.
  const double cell = 4.0 * std::max(distance, std::numeric_limits<double>::min());
  const auto keyOf = [cell](const Eigen::Vector3d& x) -> std::array<double, 3> {
    return { std::floor(x[0] / cell), std::floor(x[1] / cell), std::floor(x[2] / cell) };
  };
  std::map<std::array<double, 3>, std::vector<const ZeroSetSide*>> open;
  std::vector<ZeroSetContact> contacts;
  for (const ZeroSetSide& side : sides)
  {
    if (IsCollapsed(side, distance))
    {
      continue;
    }
    const Eigen::Vector3d mean = 0.25 *
      (Sample(side, 0, 0) + Sample(side, Last, 0) + Sample(side, 0, Last) +
        Sample(side, Last, Last));
    const auto meet = [&]
    {
      for (int corner = 0; corner < 8; ++corner)
      {
        const Eigen::Vector3d sign(
          corner & 1 ? 1.0 : -1.0, corner & 2 ? 1.0 : -1.0, corner & 4 ? 1.0 : -1.0);
        const auto near = open.find(keyOf(mean + distance * sign));
        if (near == open.end())
        {
          continue;
        }
        for (auto other = near->second.begin(); other != near->second.end(); ++other)
        {
          for (int code = 0; code < 8; ++code)
          {
            if (Coincide(**other, side, code, distance))
            {
              contacts.push_back(MakeContact(**other, side, code));
              near->second.erase(other);
              return true;
            }
          }
        }
      }
      return false;
    };
    if (!meet())
    {
      open[keyOf(mean)].push_back(&side);
    }
  }
  return contacts;
}

}
