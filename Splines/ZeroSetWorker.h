// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_ZeroSetWorker_h
#define hyperpatch_ZeroSetWorker_h

#include "MarchingCells.h"
#include "ZeroSet.h"

/// The inside of ZeroSet, private to the three files that hold it: ZeroSetSearch.cxx finds crossed
/// cells and vertices, ZeroSetMesh.cxx makes the mesh, ZeroSetError.cxx measures it.

namespace hyperpatch
{

class ZeroSet::Worker
{
public:
  using Index = std::int64_t;
  using Cell = std::array<int, 3>; ///< indices of its low corner among the grid lines

  Worker(std::shared_ptr<const PreparedAggregate> body, const ScalarField& field,
    ZeroSetOptions options);

  bool Extract();

  CellGrid Grid;
  std::array<std::vector<int>, 3> Wanted;
  ZeroSetMesh Mesh;
  ZeroSetCertificate Certificate;

private:
  /// Points per call of a field or evaluator.
  static constexpr Index Batch = 512;

  /// A crossed edge of a cell, or the corner that stands for it where f is exactly zero there.
  struct Crossing
  {
    Index Key; ///< 4 * corner + axis; axis 3 for the corner itself
    double Low;
    double High; ///< f at both ends
  };

  /// A cell with pieces of the surface.
  struct CrossedCell
  {
    Cell At;
    unsigned Positive; ///< sign bits of its corners
    unsigned Zero;     ///< bits of corners where f is exactly zero
  };

  /// What a chunk of elements found.
  struct Found
  {
    std::vector<CrossedCell> Crossed;
    std::vector<Crossing> Crossings;
    Index Undecided = 0;
    double LargestValue = 0.0;
    std::vector<Cell> Wide;           ///< undecided cells that are wider than the feature size
    std::vector<CrossedCell> Touched; ///< no sign change, but corners where f is zero
    Index Sampled = 0;                ///< cells of a field without bounds
  };

  void MakeLines();
  /// Calls body(begin, end) in parallel and stops early when aborted.
  bool Parallel(Index count, Index grain, const std::function<void(Index, Index)>& body);

  // Steps of Extract(), in order.
  bool FindCrossings();
  void SearchElements(const Cell& low, const Cell& high, Found& found) const;
  void SearchElement(const Cell& element, const ParameterBox& box, Found& found) const;
  void SearchBox(
    Cell low, Cell high, const Bernstein& f, std::vector<Cell>& cells, Found& found) const;
  void SignCells(const std::vector<Cell>& cells, bool certified, Found& found) const;
  /// Whether a zero in a cell can neither be excluded nor shows as a sign change at corners.
  [[nodiscard]] bool IsUndecided(const Bernstein& f) const;
  [[nodiscard]] bool IsExcluded(const Bernstein& f, int depth) const;
  bool FindVertices();
  bool EvaluateVertices();
  void MakeCells();
  void Triangulate(const std::vector<Index>& ring, const std::vector<CellEdge>& edges,
    std::vector<std::array<Index, 3>>& triangles) const;
  /// Where the surface only touches a corner there is a vertex but no cell.
  void DropUnusedPoints();
  bool MeasureErrors();
  void MeasureCells(Index begin, Index end, ZeroSetCertificate& certificate,
    std::array<std::vector<int>, 3>& wanted) const;

  [[nodiscard]] Index Corner(const Cell& at) const
  {
    return at[0] + this->Counts[0] * (at[1] + this->Counts[1] * static_cast<Index>(at[2]));
  }
  [[nodiscard]] Cell CornerOfKey(Index key) const;
  /// Whether the mesh has a vertex in a corner of the cell where f is zero.
  [[nodiscard]] bool IsDrawn(const CrossedCell& touched) const;
  [[nodiscard]] double Line(int direction, int i) const
  {
    return this->Lines[static_cast<std::size_t>(direction)][static_cast<std::size_t>(i)];
  }
  [[nodiscard]] double Width(const Cell& at) const;
  /// Intervals of the grid (between breaks) that hold a cell.
  [[nodiscard]] int Interval(int direction, int line) const
  {
    return this
      ->IntervalOfLine[static_cast<std::size_t>(direction)][static_cast<std::size_t>(line)];
  }
  void Want(
    const Cell& at, double factor, std::array<std::vector<int>, 3>& wanted, bool& reached) const;

  std::shared_ptr<const PreparedAggregate> Prepared;
  const Aggregate& Body;
  const ScalarField& Field;
  ZeroSetOptions Options;
  const Evaluator& Geometry;
  std::vector<const Evaluator*> Attributes;
  std::vector<int> Axes; ///< the directions that are there
  std::array<std::vector<double>, 3> Lines;
  std::array<std::vector<int>, 3> IntervalOfLine;
  std::array<std::vector<double>, 3> Creases; ///< parameters where mesh edges follow the geometry
  std::array<Index, 3> Counts{};              ///< of lines

  std::vector<CrossedCell> Crossed;
  std::vector<Crossing> Vertices; ///< unique, sorted by key
  std::vector<Cell> CellOfPiece;  ///< per mesh cell
  double LargestValue = 0.0;
  Index Sampled = 0;
};

}

#endif
