// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_ClipSeamsWorker_h
#define hyperpatch_ClipSeamsWorker_h

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <unordered_map>
#include <utility>
#include <vector>

namespace hyperpatch
{

/// Internal to ClipGroup. Which points (or nodes) of the members are the same: pairs on joints, and
/// the classes that they make.
class Seams
{
public:
  explicit Seams(std::size_t joints)
    : Partners(joints)
    , Seen(joints)
  {
  }

  /// The point on the other side of a joint, -1 if none is known.
  [[nodiscard]] int Partner(std::size_t joint, std::size_t side, int point) const
  {
    const auto& partners = this->Partners[joint][side];
    const auto found = partners.find(point);
    return found == partners.end() ? -1 : found->second;
  }
  void Link(std::size_t joint, const std::array<std::size_t, 2>& members, int a, int b)
  {
    if (!this->Partners[joint][0].emplace(a, b).second)
    {
      return;
    }
    this->Partners[joint][1].emplace(b, a);
    const std::size_t i = this->Find(this->Number(members[0], a));
    const std::size_t j = this->Find(this->Number(members[1], b));
    // The older one leads: what was taken from it stays.
    this->Parents[std::max(i, j)] = std::min(i, j);
  }
  /// Calls visit(point, point) for all pairs on a joint.
  template <typename Visit>
  void ForPairs(std::size_t joint, const Visit& visit) const
  {
    std::vector<std::pair<int, int>> pairs(
      this->Partners[joint][0].begin(), this->Partners[joint][0].end());
    std::sort(pairs.begin(), pairs.end());
    for (const auto& [a, b] : pairs)
    {
      visit(a, b);
    }
  }
  /// Points from here on have not been looked at yet.
  [[nodiscard]] int& FirstUnseen(std::size_t joint, std::size_t side)
  {
    return this->Seen[joint][side];
  }
  /// Calls visit(member, point, leading member, its point, number of the class).
  template <typename Visit>
  void ForAll(const Visit& visit)
  {
    for (std::size_t i = 0; i < this->All.size(); ++i)
    {
      const std::size_t first = this->Find(i);
      visit(this->All[i].first, this->All[i].second, this->All[first].first,
        this->All[first].second, first);
    }
  }

private:
  std::size_t Number(std::size_t member, int point)
  {
    const auto [found, isNew] = this->Numbers.try_emplace({ member, point }, this->All.size());
    if (isNew)
    {
      this->All.emplace_back(member, point);
      this->Parents.push_back(this->Parents.size());
    }
    return found->second;
  }
  std::size_t Find(std::size_t i)
  {
    while (this->Parents[i] != i)
    {
      this->Parents[i] = this->Parents[this->Parents[i]];
      i = this->Parents[i];
    }
    return i;
  }

  std::vector<std::array<std::unordered_map<int, int>, 2>> Partners;
  std::vector<std::array<int, 2>> Seen;
  std::map<std::pair<std::size_t, int>, std::size_t> Numbers;
  std::vector<std::pair<std::size_t, int>> All;
  std::vector<std::size_t> Parents;
};

}

#endif
