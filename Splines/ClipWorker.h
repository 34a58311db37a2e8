// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_ClipWorker_h
#define hyperpatch_ClipWorker_h

#include "BendBounds.h"
#include "Clip.h"
#include "Range.h"
#include "SimplexCutWorker.h"
#include "SimplexRefinementWorker.h"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace hyperpatch
{

/// One patch of a ClipGroup. Steps return false if aborted. Private to Clip*.cxx.
class ClipWorker
{
public:
  ClipWorker(const ClipGroup::Member& member, std::shared_ptr<BendBounds> bends,
    const CollapsedSides& collapsed);

  // Clip.cxx: simplices are refined. ClipFields.cxx: where they lie; ClipErrors.cxx: how wrong they
  // are; ClipShapes.cxx: how they are shaped.

  /// Finds the elements that may have to be kept, and the nodes at their corners.
  bool Begin();
  /// Evaluates new nodes.
  bool Evaluate();
  bool Triangulate();
  /// Marks edges of new cells that have to be halved.
  bool Mark();
  bool Halve();
  /// Marks edges of cells with a cut that misses the tolerance, or of which the curvature of the
  /// geometry turned parts over.
  bool MarkBadCuts();

  // ClipCut.cxx: they are cut.

  bool BeginCut();
  [[nodiscard]] SimplexCut& Pieces() { return *this->P; }
  /// The point of a node, -1 if there is none.
  [[nodiscard]] SimplexCut::Index PointOf(int node) const
  {
    return this->PointOfNode[static_cast<std::size_t>(node)];
  }
  bool Assemble();

  [[nodiscard]] const ClipGroup::Member& Member() const { return this->M; }
  [[nodiscard]] const std::shared_ptr<BendBounds>& Bends() const { return this->B; }
  [[nodiscard]] SimplexRefinement& Mesh() { return *this->Simplices; }
  [[nodiscard]] const Eigen::Vector3d& Point(int node) const
  {
    return this->Points[static_cast<std::size_t>(node)];
  }
  /// A point on an interface is that of one of the sides; the number decides between points that
  /// coincide, and is the same on both sides.
  void SetPoint(int node, const Eigen::Vector3d& x, std::int64_t number);
  /// Nodes of the least rank come first in the division of elements: the number of directions in
  /// which a node is free, or one on the other side of an interface.
  [[nodiscard]] int Rank(int node) const { return this->Ranks[static_cast<std::size_t>(node)]; }
  void SetRank(int node, int rank) { this->Ranks[static_cast<std::size_t>(node)] = rank; }
  /// Nodes in the middle of edges to be halved.
  [[nodiscard]] const std::vector<int>& Marked() const { return this->MarkedNodes; }
  /// False if it was marked before.
  bool MarkNode(int node);
  [[nodiscard]] bool WasCapped() const { return this->IsCapped; }

  ClipMesh Result;

private:
  using Cell = SimplexRefinement::Cell;

  /// What bounds tell about a field in the box around a cell.
  enum class Verdict : unsigned
  {
    Open,  ///< nothing
    Sheet, ///< the zero set is certainly one sheet
    Lost   ///< nothing, and smaller boxes will not tell more
  };
  /// Where a cell certainly lies (or where samples say so, of a field without bounds).
  enum class Side : unsigned
  {
    Unknown,
    Inside,
    Outside
  };
  /// Four bits of Cell::State per field.
  [[nodiscard]] static Side SideOf(unsigned state, std::size_t field)
  {
    return static_cast<Side>(state >> (4 * field) & 3u);
  }
  [[nodiscard]] static Verdict VerdictOf(unsigned state, std::size_t field)
  {
    return static_cast<Verdict>(state >> (4 * field + 2) & 3u);
  }
  static void Set(unsigned& state, std::size_t field, Side side, Verdict verdict)
  {
    state &= ~(15u << (4 * field));
    state |= (static_cast<unsigned>(side) | static_cast<unsigned>(verdict) << 2) << (4 * field);
  }
  [[nodiscard]] bool IsDecided(unsigned state) const;
  [[nodiscard]] bool IsDropped(unsigned state) const;
  /// Some of the parameters at which a node that is free is the same point.
  [[nodiscard]] std::vector<Eigen::Vector3d> ParametersOf(int node) const;
  /// Also by the values at corners.
  [[nodiscard]] bool IsDroppedByCorners(const Cell& cell) const;

  /// The box of elements [first, last) and those in it, unless all are on the other side.
  bool AddElements(const std::array<int, 3>& first, const std::array<int, 3>& last, unsigned state);
  bool EvaluateValues();
  /// Of a field that is not one value at a node that is free: it counts as 0 there, so that the cut
  /// goes through the node.
  [[nodiscard]] bool HasBothSigns(std::size_t field, int node) const;
  /// Asks for the values at nodes of cells that are not decided.
  void WantValues(const Cell& cell);
  /// The verdict in the last box: cells that have it in common come one after the other.
  struct Decision
  {
    ParameterBox Box;
    bool IsZero = true;
    Verdict Found = Verdict::Open;
    BoxSpline Scratch;
  };
  void Decide(Cell& cell, std::size_t field, std::optional<Decision>& last) const;
  /// Once more in a box at collapsed sides, if f is 0 there: by what is left of f without the zeros
  /// there.
  void DecideBesidesPoles(const ScalarField& field, Decision& decision) const;
  bool DropCells();

  /// Errors of linear interpolation in a cell by their tolerances, the largest and those at the
  /// middles of edges.
  struct Error
  {
    double Largest = 0.0;
    std::array<double, 6> Edges{};

    void Add(double largest, const std::array<double, 6>& edges);
    void Add(const Error& other) { this->Add(other.Largest, other.Edges); }
  };
  /// What bounds tell about interpolation in a cell.
  struct Bound
  {
    bool IsCertain = true; ///< all errors are within the tolerances
    bool IsCoarse = false; ///< the cell is too large for its errors to be measured
    double Position = 0.0; ///< of errors, by their tolerances
    double Attribute = 0.0;
    std::array<double, 6> Edges{};
  };
  [[nodiscard]] Bound BoundError(const Cell& cell) const;
  [[nodiscard]] Error PositionError(const Cell& cell) const;
  [[nodiscard]] Error AttributeError(const Cell& cell) const;
  /// How much attributes differ at the corners, as they are not one value where a side is
  /// collapsed; by their tolerances.
  [[nodiscard]] double Jump(const Cell& cell) const;
  void FindJump(std::size_t node);
  [[nodiscard]] Error CutError(const Cell& cell, std::size_t field) const;
  /// Whether a cell has no positive volume though the geometry there is regular.
  [[nodiscard]] bool IsTurnedOver(const Cell& cell) const;
  /// Whether smaller cells will have positive volume: the geometry is neither turned over nor about
  /// to degenerate at its corners and in the middle, and the cell is not far below the tolerance.
  [[nodiscard]] bool IsRegular(const Cell& cell) const;
  /// Whether the geometry is turned over at one of its corners or in the middle.
  [[nodiscard]] bool IsFolded(const Cell& cell) const;
  /// Of det J there, by its sign in the patch and in homogeneous coordinates.
  [[nodiscard]] Range Jacobians(const Cell& cell) const;
  template <typename PointOfCorner>
  [[nodiscard]] static double SixVolumes(const PointOfCorner& at)
  {
    return (at(1) - at(0)).cross(at(2) - at(0)).dot(at(3) - at(0));
  }
  /// Whether a cell has no extent in space: two corners coincide, or a face is flat to round-off,
  /// as where a side of the patch is collapsed.
  template <typename PointOfCorner>
  [[nodiscard]] bool Vanishes(const PointOfCorner& at) const
  {
    const int dimension = this->Simplices->Dimension();
    double longest = 0.0;
    bool vanishes = false;
    for (int i = 0; i <= dimension; ++i)
    {
      for (int j = i + 1; j <= dimension; ++j)
      {
        const double length = (at(i) - at(j)).norm();
        longest = std::max(longest, length);
        vanishes = vanishes || length <= 1e-14 * this->DomainWidth;
      }
    }
    for (int left = 0; left <= 3 && dimension == 3 && !vanishes; ++left)
    {
      const int a = left == 0 ? 1 : 0;
      const int b = left <= 1 ? 2 : 1;
      const int c = left <= 2 ? 3 : 2;
      vanishes = (at(b) - at(a)).cross(at(c) - at(a)).norm() <= 1e-12 * longest * longest;
    }
    return vanishes;
  }
  /// What has to be done with a new cell: edges to be halved, one bit each, or Measure.
  [[nodiscard]] unsigned char Plan(const Cell& cell) const;
  static constexpr unsigned char Measure = 1 << 7;
  /// The edges of a cell with middles that have to be halved.
  [[nodiscard]] unsigned char EdgesToHalve(const Cell& cell) const;
  [[nodiscard]] double Width(const Cell& cell) const;
  [[nodiscard]] unsigned char LongestEdge(const Cell& cell) const;
  /// How far the middles of edges are from the geometry.
  [[nodiscard]] std::array<double, 6> Bends(const Cell& cell) const;
  /// What turned over a cell of three dimensions.
  [[nodiscard]] unsigned char MostBentEdge(const Cell& cell) const;
  /// Of a cell with a corner at a pole: edges that are seen from there at a wide angle, which no
  /// smaller cell sees at a narrower one as long as they are not halved.
  [[nodiscard]] unsigned char EdgesBentAtPole(const Cell& cell) const;
  void MarkEdges(const Cell& cell, unsigned char edges);
  [[nodiscard]] SimplexRefinement::Before Order() const;
  [[nodiscard]] double LengthAround(int middle) const;
  [[nodiscard]] static std::size_t Corner(const Cell& cell, int c)
  {
    return static_cast<std::size_t>(cell.Corners[static_cast<std::size_t>(c)]);
  }
  [[nodiscard]] static std::size_t Middle(const Cell& cell, int e)
  {
    return static_cast<std::size_t>(cell.Middles[static_cast<std::size_t>(e)]);
  }
  [[nodiscard]] static std::size_t End(const Cell& cell, int e, int end)
  {
    return Corner(cell, SimplexRefinement::Edges[e][end]);
  }
  /// Calls body(begin, end) for all cells.
  bool ForCells(const std::function<void(std::size_t, std::size_t)>& body);

  /// Triangles (segments of a surface) of the cut.
  struct Facet
  {
    double Error;     ///< distance from f = 0 of its middle and those of its edges
    std::size_t Cell; ///< that it was cut from
  };
  [[nodiscard]] std::vector<Facet> CutFacets() const;
  /// Per cell, the largest distance of its pieces' edges from the geometry: points of the cells at
  /// the cut have been moved.
  [[nodiscard]] std::vector<double> PieceErrors() const;
  void Certify(ZeroSetCertificate& certificate) const;

  /// The share of a tolerance that is aimed at: it is measured at a few points only.
  static constexpr double Target = 0.85;
  static constexpr double CutTarget = 0.95; ///< of parts of cells
  /// Cells of a field without bounds are this share of the patch's diagonal at most.
  static constexpr int SampledDivisions = 16;
  static constexpr std::ptrdiff_t Grain = 128;
  /// Cells between two questions whether to abort.
  static constexpr std::size_t Step = 1 << 14;
  static constexpr int BoxStep = 256; ///< the same of boxes of elements

  ClipGroup::Member M;
  std::shared_ptr<BendBounds> B;
  std::array<std::vector<double>, 3> Lines; ///< between elements
  std::vector<double> Tolerances;           ///< per bend
  bool HasSampledFields = false;
  double DomainWidth = 0.0;
  bool IsCapped = false;

  int Boxes = 0; ///< of elements that were looked at
  CollapsedSides Collapsed;
  std::vector<int> Roots;           ///< elements that may be kept
  std::vector<unsigned> RootStates; ///< as Cell::State
  std::optional<SimplexRefinement> Simplices;
  std::vector<char> IsNew; ///< per cell
  std::vector<unsigned char> Plans;
  std::int64_t Sampled = 0; ///< cells that were decided by samples

  // Per node.
  std::vector<Eigen::Vector3d> Points;
  std::vector<std::int64_t> Numbers;           ///< see SetPoint()
  std::vector<int> Ranks;                      ///< of nodes of the grid
  std::vector<double> Jumps;                   ///< see Jump()
  std::vector<std::vector<double>> Values;     ///< per field; NaN: not asked for
  std::vector<std::vector<double>> Attributes; ///< per attribute: components x nodes, or none
  std::vector<char> IsMarked;
  std::vector<char> IsWanted;
  std::vector<int> Wanted; ///< nodes whose values are to be found
  std::vector<int> MarkedNodes;

  /// Parameters of C0 knot planes and the ends of the domain.
  std::array<std::vector<double>, 3> Creases;
  std::vector<char> IsCut;                    ///< per cell
  std::vector<SimplexCut::Index> PointOfNode; ///< -1: not in a cell that may be cut
  std::optional<SimplexCut> P;
  std::vector<char> IsShared; ///< per node: on an interface
};

}

#endif
