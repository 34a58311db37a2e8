// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_SimplexRefinementWorker_h
#define hyperpatch_SimplexRefinementWorker_h

#include "CollapsedSidesWorker.h"
#include "FreeParametersWorker.h"
#include "NumberingWorker.h"

#include <Eigen/Core>

#include <array>
#include <functional>
#include <utility>
#include <vector>

namespace hyperpatch
{

/// A conforming mesh of simplices (segments, triangles or tetrahedra) over cells of a grid of
/// parameters, refined by halving edges: all simplices around an edge are bisected with it, so that
/// no node hangs, whichever edges are chosen.
///
/// Which simplices there are follows from an order of nodes that the caller gives. Meshes on both
/// sides of a face have the same simplices on it if they have the same order of its nodes, and the
/// same edges of it are halved.
///
/// Where a side of the grid is collapsed all parameters that are one point are one node, which has
/// no parameters of its own in the directions in which it is free: on an edge or in a simplex they
/// follow from the other corners. Simplices of which two corners are one node are left out.
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
    std::array<int, 6> Middles{ -1, -1, -1, -1, -1, -1 }; ///< all -1 if not asked for
    int Root = 0;                                         ///< number of the grid cell
    unsigned State = 0;                                   ///< the caller's; parts inherit it
  };
  using Before = std::function<bool(int, int)>; ///< of two nodes
  using Abort = std::function<bool()>;

  /// \param lines of the grid, ascending; 2 for a direction that is not there
  /// \param isThere the directions that the simplices have
  /// \param roots the cells of the grid to be filled, their numbers (u fastest)
  /// \param collapsed the sides of the grid that are
  SimplexRefinement(const std::array<std::vector<double>, 3>& lines,
    const std::array<bool, 3>& isThere, const std::vector<int>& roots,
    const CollapsedSides& collapsed);

  /// Divides the grid cells; there is no simplex before. Every face of the grid gets the diagonals
  /// from its first node in the order. The corners of simplices have positive orientation in the
  /// parameters. \returns false if aborted
  bool Triangulate(const std::vector<int>& roots, const std::vector<unsigned>& states,
    const Before& isBefore, const Abort& abort);

  [[nodiscard]] int Dimension() const { return this->D; }
  [[nodiscard]] std::vector<Cell>& Cells() { return this->C; }
  [[nodiscard]] const std::vector<Cell>& Cells() const { return this->C; }
  [[nodiscard]] int NumberOfNodes() const { return static_cast<int>(this->Nodes.size()); }
  /// At the low end of the grid in directions in which the node is free.
  [[nodiscard]] const Eigen::Vector3d& Parameter(int node) const
  {
    return this->Nodes[static_cast<std::size_t>(node)];
  }
  /// Bits: the directions in which a node is free.
  [[nodiscard]] unsigned Free(int node) const
  {
    if (!this->HasPoles)
    {
      return 0;
    }
    const Eigen::Vector3d& weights = this->Weights[static_cast<std::size_t>(node)];
    return (weights[0] == 0.0 ? 1u : 0u) | (weights[1] == 0.0 ? 2u : 0u) |
      (weights[2] == 0.0 ? 4u : 0u);
  }
  [[nodiscard]] FreeParameters At(int node) const
  {
    const auto n = static_cast<std::size_t>(node);
    return { this->Nodes[n], this->HasPoles ? this->Weights[n] : Eigen::Vector3d::Ones() };
  }
  /// Of the corners of a simplex.
  [[nodiscard]] std::array<FreeParameters, 4> Parameters(const Cell& cell) const;
  /// Bits: the sides of the grid that a node lies in.
  [[nodiscard]] unsigned Sides(int node) const
  {
    return this->SideBits[static_cast<std::size_t>(node)];
  }
  /// The nodes that one lies in the middle of; -1 twice if it is one of the grid.
  [[nodiscard]] const std::array<int, 2>& Ends(int node) const
  {
    return this->EndsOf[static_cast<std::size_t>(node)];
  }
  /// Where three lines of the grid meet in a corner of a cell: their numbers.
  [[nodiscard]] const std::vector<std::array<int, 3>>& GridPlaces() const { return this->Places; }
  /// The node at three lines, -1 if it belongs to no cell.
  [[nodiscard]] int GridNode(const std::array<int, 3>& lines) const
  {
    const std::int64_t place = this->Corners.Find({ lines[0], lines[1], lines[2], 0 });
    return place < 0 ? -1 : this->NodeAt[static_cast<std::size_t>(place)];
  }

  /// The node in the middle of two; made if it is new.
  int Middle(int a, int b);
  /// The same, -1 if it has not been made.
  [[nodiscard]] int FindMiddle(int a, int b) const;
  /// Gives a cell its middles.
  void FindMiddles(Cell& cell);

  /// Halves edges, the first ones in the order of their middles first.
  /// \param isHalved per node, whether it is the middle of an edge to be halved
  /// \param isNew per cell, set: those that were bisected, in their old places and at the end
  /// \returns false if aborted
  bool Refine(const std::vector<char>& isHalved, const Before& isBefore, std::vector<char>& isNew,
    const Abort& abort);

private:
  /// A corner of a grid cell: its lines and its node.
  using GridCorner = std::pair<std::array<int, 3>, int>;

  /// The node at three lines; made if it is new.
  int AddGridNode(const std::array<std::vector<double>, 3>& lines, const std::array<int, 3>& at,
    const CollapsedSides& collapsed);
  void AddSimplices(const std::vector<GridCorner>& corners, std::array<GridCorner, 4>& chain,
    int depth, const Before& isBefore, const Cell& like);

  int D = 0;
  std::array<bool, 3> IsThere;
  std::array<int, 3> Size{ 1, 1, 1 }; ///< grid cells
  std::vector<Cell> C;
  std::vector<Eigen::Vector3d> Nodes;
  bool HasPoles = false;
  std::vector<Eigen::Vector3d> Weights; ///< of nodes, where there are poles
  std::vector<unsigned char> SideBits;
  std::vector<std::array<int, 2>> EndsOf;
  std::vector<std::array<int, 3>> Places;
  std::vector<int> NodeAt; ///< per place
  Numbering Corners;       ///< places by their lines
  Numbering MiddleOf;      ///< by the two ends of an edge
  std::vector<int> MiddleNode;
};

}

#endif
