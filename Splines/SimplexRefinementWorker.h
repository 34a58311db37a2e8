// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_SimplexRefinementWorker_h
#define hyperpatch_SimplexRefinementWorker_h

#include "NumberingWorker.h"

#include <Eigen/Core>

#include <array>
#include <vector>

namespace hyperpatch
{

/// A conforming mesh of simplices (segments, triangles or tetrahedra) over a grid of parameters,
/// refined by halving edges: all simplices around an edge are bisected with it, so that no node
/// hangs, whichever edges are chosen.
///
/// Every grid cell is split along its diagonal from the corner with even line numbers, so that
/// neighbors are mirror images.
class SimplexRefinement
{
public:
  /// Pairs of corners, in the order of Cell::Middles.
  static constexpr int Edges[6][2] = { { 0, 1 }, { 0, 2 }, { 1, 2 }, { 0, 3 }, { 1, 3 }, { 2, 3 } };
  /// The number of edges of a simplex of that dimension; they come first in Edges.
  [[nodiscard]] static int NumberOfEdges(int dimension) { return dimension * (dimension + 1) / 2; }

  /// Nodes are corners of simplices and middles of their edges.
  struct Cell
  {
    std::array<int, 4> Corners{ -1, -1, -1, -1 };
    std::array<int, 6> Middles{ -1, -1, -1, -1, -1, -1 };
    int Root = 0;       ///< the grid cell, u fastest
    unsigned State = 0; ///< the caller's; parts inherit it
  };

  /// \param lines of the grid, ascending; 2 for a direction that is not there
  /// \param isThere the directions that the simplices have. The corners of each have positive
  /// orientation in them
  SimplexRefinement(
    const std::array<std::vector<double>, 3>& lines, const std::array<bool, 3>& isThere);

  [[nodiscard]] int Dimension() const { return this->D; }
  [[nodiscard]] std::vector<Cell>& Cells() { return this->C; }
  [[nodiscard]] const std::vector<Cell>& Cells() const { return this->C; }
  [[nodiscard]] int NumberOfNodes() const { return static_cast<int>(this->Nodes.size()); }
  [[nodiscard]] const Eigen::Vector3d& Parameter(int node) const
  {
    return this->Nodes[static_cast<std::size_t>(node)];
  }

  /// Halves edges.
  /// \param isHalved per node, whether it is the middle of an edge to be halved
  /// \param length of the edge around a node, in which order a cell's edges are halved: long ones
  /// first
  /// \param isNew per cell, set: those that were bisected, in their old places and at the end
  void Refine(
    const std::vector<char>& isHalved, const std::vector<double>& length, std::vector<char>& isNew);

private:
  void FindMiddles(Cell& cell);

  int D = 0;
  std::vector<Cell> C;
  std::vector<Eigen::Vector3d> Nodes;
  Numbering MiddleOf; ///< by the two ends of an edge
  std::vector<int> MiddleNode;
};

}

#endif
