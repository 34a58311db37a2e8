// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_NumberingWorker_h
#define hyperpatch_NumberingWorker_h

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace hyperpatch
{

/// Numbers keys 0, 1, 2 ... in the order in which they come. An open table: looking one up is what
/// much of the time of a fine zero set would go into with a standard map.
class Numbering
{
public:
  using Key = std::array<int, 4>;

  Numbering() { this->Clear(); }

  void Clear()
  {
    this->Keys.clear();
    this->Slots.assign(64, -1);
  }
  [[nodiscard]] std::size_t Count() const { return this->Keys.size(); }

  /// The number of the key, and whether it is new.
  std::pair<std::int64_t, bool> Number(const Key& key)
  {
    std::size_t slot = this->SlotOf(key);
    if (this->Slots[slot] >= 0)
    {
      return { this->Slots[slot], false };
    }
    const auto number = static_cast<std::int32_t>(this->Keys.size());
    this->Keys.push_back(key);
    this->Slots[slot] = number;
    if (2 * this->Keys.size() > this->Slots.size())
    {
      this->Slots.assign(2 * this->Slots.size(), -1);
      for (std::size_t k = 0; k < this->Keys.size(); ++k)
      {
        this->Slots[this->SlotOf(this->Keys[k])] = static_cast<std::int32_t>(k);
      }
    }
    return { number, true };
  }

  /// The number of the key, -1 if it has none.
  [[nodiscard]] std::int64_t Find(const Key& key) const { return this->Slots[this->SlotOf(key)]; }

private:
  /// The slot with the key, or the empty one where it belongs.
  [[nodiscard]] std::size_t SlotOf(const Key& key) const
  {
    const std::uint64_t first = Pair(key[0], key[1]);
    const std::uint64_t second = Pair(key[2], key[3]);
    std::uint64_t hash = (first ^ second * 0x9E3779B97F4A7C15u) * 0xD6E8FEB86659FD93u;
    hash = (hash ^ hash >> 32) * 0xD6E8FEB86659FD93u;
    const std::size_t mask = this->Slots.size() - 1;
    auto slot = static_cast<std::size_t>(hash >> 20) & mask;
    while (this->Slots[slot] >= 0)
    {
      // In two words: the comparison of the arrays is a call.
      const Key& there = this->Keys[static_cast<std::size_t>(this->Slots[slot])];
      if (Pair(there[0], there[1]) == first && Pair(there[2], there[3]) == second)
      {
        break;
      }
      slot = (slot + 1) & mask;
    }
    return slot;
  }
  [[nodiscard]] static std::uint64_t Pair(int a, int b)
  {
    return std::uint64_t{ static_cast<std::uint32_t>(a) } << 32 | static_cast<std::uint32_t>(b);
  }

  std::vector<Key> Keys;
  std::vector<std::int32_t> Slots; ///< a power of two, at most half full
};

}

#endif
