// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_testing_GridTopology_h
#define hyperpatch_testing_GridTopology_h

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>
#include <vector>

/// The topology of surfaces, counted without drawing them.
namespace topology
{

/// What two surfaces must share to be the same, up to bending.
struct Invariants
{
  long Euler = 0;
  long Components = 0;
  long BoundaryLoops = 0;

  friend bool operator==(const Invariants& a, const Invariants& b)
  {
    return a.Euler == b.Euler && a.Components == b.Components && a.BoundaryLoops == b.BoundaryLoops;
  }
  friend bool operator!=(const Invariants& a, const Invariants& b) { return !(a == b); }
};

/// Disjoint sets of the numbers 0 .. count - 1.
class Sets
{
public:
  explicit Sets(std::size_t count)
    : Parent(count)
  {
    std::iota(this->Parent.begin(), this->Parent.end(), std::size_t{ 0 });
  }
  std::size_t Find(std::size_t i)
  {
    while (this->Parent[i] != i)
    {
      i = this->Parent[i] = this->Parent[this->Parent[i]];
    }
    return i;
  }
  void Join(std::size_t a, std::size_t b) { this->Parent[this->Find(a)] = this->Find(b); }

private:
  std::vector<std::size_t> Parent;
};

/// The surface between positive and negative nodes of a grid of n nodes per direction, u fastest,
/// whose cells are cut into six tetrahedra each (Kuhn). It has a vertex on each edge between nodes
/// that differ, an edge in each triangle and a face in each tetrahedron in which some do.
inline Invariants OfGrid(const std::vector<char>& isPositive, std::size_t n)
{
  // The edges from a node lead to those at its upper side: offset bits 1 .. 7.
  const auto offset = [n](unsigned bits)
  { return (bits & 1u) + n * ((bits >> 1 & 1u) + n * (bits >> 2 & 1u)); };
  const auto isCut = [&](std::size_t a, std::size_t b) { return isPositive[a] != isPositive[b]; };
  const auto edge = [&](std::size_t node, unsigned from, unsigned to)
  { return 7 * (node + offset(from)) + (to ^ from) - 1; };
  Invariants result;
  Sets parts(7 * n * n * n);
  Sets loops(7 * n * n * n);
  std::vector<char> isVertex(7 * n * n * n, 0);
  std::vector<char> isOnLoop(7 * n * n * n, 0);
  static constexpr std::array<std::array<unsigned, 2>, 6> Paths{ { { 1, 3 }, { 1, 5 }, { 2, 3 },
    { 2, 6 }, { 4, 5 }, { 4, 6 } } };
  // A triangle of nodes at offsets from < middle < to, bit by bit.
  const auto addTriangle =
    [&](std::size_t node, unsigned from, unsigned middle, unsigned to, bool isBoundary)
  {
    std::array<std::size_t, 2> cut{};
    std::size_t count = 0;
    const std::array<std::array<unsigned, 2>, 3> sides{ { { from, middle }, { middle, to },
      { from, to } } };
    for (const auto& side : sides)
    {
      if (isCut(node + offset(side[0]), node + offset(side[1])))
      {
        cut[count++] = edge(node, side[0], side[1]);
      }
    }
    if (count == 2)
    {
      // Each inner triangle is seen by two tetrahedra.
      result.Euler -= isBoundary ? 2 : 1;
      parts.Join(cut[0], cut[1]);
      for (const std::size_t e : cut)
      {
        isVertex[e] = 1;
        isOnLoop[e] = static_cast<char>(isOnLoop[e] != 0 || isBoundary);
      }
      if (isBoundary)
      {
        loops.Join(cut[0], cut[1]);
      }
    }
  };
  for (std::size_t k = 0; k + 1 < n; ++k)
  {
    for (std::size_t j = 0; j + 1 < n; ++j)
    {
      for (std::size_t i = 0; i + 1 < n; ++i)
      {
        const std::size_t node = i + n * (j + n * k);
        int positive = 0;
        for (unsigned c = 0; c < 8; ++c)
        {
          positive += isPositive[node + offset(c)];
        }
        if (positive == 0 || positive == 8)
        {
          continue;
        }
        const unsigned atLow = (i == 0 ? 1u : 0u) | (j == 0 ? 2u : 0u) | (k == 0 ? 4u : 0u);
        const unsigned atHigh =
          (i + 2 == n ? 1u : 0u) | (j + 2 == n ? 2u : 0u) | (k + 2 == n ? 4u : 0u);
        for (const auto& [p, q] : Paths)
        {
          const bool isFace = isCut(node, node + offset(p)) || isCut(node, node + offset(q)) ||
            isCut(node, node + offset(7));
          result.Euler += isFace ? 2 : 0; // halved below, as edges are
          // In the boundary where all three nodes have the same bit at that end.
          addTriangle(node, 0, p, q, (atLow & ~q) != 0);
          addTriangle(node, 0, p, 7, false);
          addTriangle(node, 0, q, 7, false);
          addTriangle(node, p, q, 7, (atHigh & p) != 0);
        }
      }
    }
  }
  result.Euler /= 2;
  for (std::size_t e = 0; e < isVertex.size(); ++e)
  {
    result.Euler += isVertex[e];
    result.Components += isVertex[e] != 0 && parts.Find(e) == e ? 1 : 0;
    result.BoundaryLoops += isOnLoop[e] != 0 && loops.Find(e) == e ? 1 : 0;
  }
  return result;
}

}

#endif
