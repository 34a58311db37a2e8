// SPDX-License-Identifier: BSD-3-Clause
#include "MarchingCells.h"

#include <array>
#include <map>
#include <utility>

namespace hyperpatch
{

namespace
{

using Key = std::pair<int, int>; // corner and axis of an edge

Key EdgeBetween(int a, int b)
{
  const int difference = a ^ b;
  return { a & b, difference == 1 ? 0 : difference == 2 ? 1 : 2 };
}

/// For each run of positive corners along the ring of a face, the edge where the run ends and the
/// one where it begins.
std::vector<std::pair<Key, Key>> RunsOfFace(const std::array<int, 4>& ring, unsigned positive)
{
  const auto isPositive = [&](int i) { return (positive >> ring[(i + 4) % 4] & 1u) != 0; };
  std::vector<std::pair<Key, Key>> runs;
  for (int begin = 0; begin < 4; ++begin)
  {
    if (!isPositive(begin) || isPositive(begin - 1))
    {
      continue;
    }
    int end = begin;
    while (isPositive(end + 1))
    {
      ++end;
    }
    // A positive run that is cut off from the other by the two corners between them.
    runs.emplace_back(EdgeBetween(ring[end % 4], ring[(end + 1) % 4]),
      EdgeBetween(ring[(begin + 3) % 4], ring[begin]));
  }
  return runs;
}

CellPieces PiecesOfCube(unsigned positive)
{
  // Corner rings of the six faces, counter-clockwise from outside.
  static constexpr std::array<std::array<int, 4>, 6> Faces = { { { 0, 4, 6, 2 }, { 1, 3, 7, 5 },
    { 0, 1, 5, 4 }, { 2, 6, 7, 3 }, { 0, 2, 3, 1 }, { 4, 5, 7, 6 } } };
  std::map<Key, Key> next;
  for (const auto& ring : Faces)
  {
    for (const auto& [last, first] : RunsOfFace(ring, positive))
    {
      next[last] = first;
    }
  }
  CellPieces pieces;
  while (!next.empty())
  {
    std::vector<CellEdge> polygon;
    for (auto at = next.begin(); at != next.end();)
    {
      polygon.push_back({ at->first.first, at->first.second });
      const Key to = at->second;
      next.erase(at);
      at = next.find(to);
    }
    pieces.push_back(std::move(polygon));
  }
  return pieces;
}

CellPieces PiecesOfSquare(unsigned positive)
{
  CellPieces pieces;
  for (const auto& [last, first] : RunsOfFace({ 0, 1, 3, 2 }, positive))
  {
    pieces.push_back({ { last.first, last.second }, { first.first, first.second } });
  }
  return pieces;
}

CellPieces PiecesOfInterval(unsigned positive)
{
  return positive == 1 || positive == 2 ? CellPieces{ { { 0, 0 } } } : CellPieces{};
}

template <std::size_t Cases>
std::array<CellPieces, Cases> MakeTable(CellPieces (*pieces)(unsigned))
{
  std::array<CellPieces, Cases> table;
  for (unsigned c = 0; c < Cases; ++c)
  {
    table[c] = pieces(c);
  }
  return table;
}

}

const CellPieces& PiecesOfCell(int axes, unsigned positive)
{
  static const auto Intervals = MakeTable<4>(PiecesOfInterval);
  static const auto Squares = MakeTable<16>(PiecesOfSquare);
  static const auto Cubes = MakeTable<256>(PiecesOfCube);
  return axes == 3 ? Cubes[positive] : axes == 2 ? Squares[positive] : Intervals[positive];
}

}
