// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_TessellationWorker_h
#define hyperpatch_TessellationWorker_h

#include "Aggregate.h"
#include "ChordBound.h"
#include "ElementAxis.h"
#include "Evaluator.h"
#include "Tessellation.h"

#include <Eigen/Core>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

/// What the files of Tessellation.h share: Tessellation.cxx puts the sides of a patch together,
/// TessellationLayout.cxx finds how fine each element of a side has to be, TessellationFace.cxx
/// makes its points and triangles, TessellationSolid.cxx the hexahedra.

namespace hyperpatch::tessellation
{

using Id = std::int64_t;

// Keeps counts from flipping by round-off.
inline constexpr double Slack = 1e-9;
// How often pieces are halved to tighten their bounds: along edges, on faces, in volumes.
inline constexpr int Halvings[3] = { 2, 2, 1 };
// Below this part of the size of the coordinates, points coincide.
inline constexpr double Coincident = 1e-14;

/// The edge curve of an element: its bend, and whether the field does not change along it.
struct EdgeBend
{
  double UU = 0.0;
  bool Constant = false;
};

/// Segments, rounded up; `limited` becomes true where that is more than the maximum.
int Count(double segments, int maximum, bool& limited);

/// Geometry and attributes of a volume, face or curve, and the fields whose error is bounded.
struct Domain
{
  /// A spline of which one or more fields are bounded.
  struct Measured
  {
    std::size_t Index; ///< into Splines
    ChordBound::Norm Norm;
    double Tolerance;
    double Size; ///< of its coefficients
  };

  std::vector<Spline> Splines; ///< geometry first
  std::array<ElementAxis, 3> Axes;
  std::vector<Measured> Fields;
  std::size_t NumberOfBounds = 0; ///< per element: the geometry, and components of attributes

  Domain(std::vector<Spline> splines, const TessellationOptions& options);
  /// Bezier points of a field on a cell.
  void Extract(const Measured& field, std::array<int, 3> cell, Eigen::MatrixXd& points) const;
  /// Bends of an edge curve, from its Bezier points; writes one per bound of the field.
  void BoundEdge(
    const Measured& field, const Eigen::MatrixXd& points, ChordBound& bound, EdgeBend* bends) const;
  /// Index of a cell's knot span of the geometry, in the whole patch.
  [[nodiscard]] Eigen::Vector3i Element(std::array<int, 3> cell, std::array<int, 3> first) const;
};

/// \throws Error as TessellateBoundary
void Check(const Patch& patch, int handedness, const TessellationOptions& options);
/// Of the patch: those in which its geometry has a degree.
std::vector<int> DirectionsWithDegree(const Spline& geometry);
/// Geometry first.
std::vector<Spline> SplinesOf(const Aggregate& body);

/// How much a piece of a field bends, in its own tolerances: linear interpolation on a parameter
/// triangle with legs h_u, h_v is within the tolerance if h_u^2 UU + 2 h_u h_v UV + h_v^2 VV <= 1.
struct Bend
{
  double UU = 0.0;
  double UV = 0.0;
  double VV = 0.0;

  [[nodiscard]] Bend Swapped() const { return { this->VV, this->UV, this->UU }; }
  [[nodiscard]] bool Fits(double hu, double hv) const
  {
    return hu * hu * this->UU + 2.0 * hu * hv * this->UV + hv * hv * this->VV <= 1.0 + Slack;
  }
  /// The largest h_v for this h_u and a right side of `budget` (left of which h_u^2 UU is taken
  /// already); 0 if there is none.
  [[nodiscard]] double Height(double hu, double budget) const
  {
    if (budget <= 0.0)
    {
      return 0.0;
    }
    const double b = this->UV * hu;
    const double denominator = b + std::sqrt(b * b + this->VV * budget);
    return denominator > 0.0 ? budget / denominator : std::numeric_limits<double>::infinity();
  }
};

/// Points of the inner grid of an element in one direction, at t = First .. Last of the element.
struct Row
{
  int Points = 0; ///< 0: no inner grid
  double First = 0.0;
  double Last = 0.0;

  [[nodiscard]] double At(int i) const
  {
    return this->Points == 1 ? this->First
                             : this->First + (this->Last - this->First) * i / (this->Points - 1);
  }
};

struct ElementLayout
{
  /// 2: inner grid and four strips. 0 or 1: the two edges along u or v are merged directly.
  int Kind = 2;
  std::array<Row, 2> Rows;

  [[nodiscard]] Id NumberOfPoints() const
  {
    return static_cast<Id>(this->Rows[0].Points) * this->Rows[1].Points;
  }
};

/// One side of a patch: a surface in directions A and B.
class Face
{
public:
  /// \param outward the sign of P_a x P_b in the normal \param element span of the missing
  /// direction \param fixed its parameter
  Face(std::vector<Spline> splines, int missing, double fixed, int element, double outward,
    int side, std::array<int, 3> firstSpan, const TessellationOptions& options);

  SurfaceMesh Tessellate();

private:
  // Numbering: cells u fastest; corners likewise; edges along u (Nu x (Nv + 1)), then those along v
  // ((Nu + 1) x Nv).
  [[nodiscard]] std::size_t Cell(int i, int j) const
  {
    return static_cast<std::size_t>(i) + static_cast<std::size_t>(this->Nu) * j;
  }
  [[nodiscard]] std::size_t EdgeU(int i, int j) const { return this->Cell(i, j); }
  [[nodiscard]] std::size_t EdgeV(int i, int j) const
  {
    return this->Cell(0, this->Nv + 1) + i + static_cast<std::size_t>(this->Nu + 1) * j;
  }
  [[nodiscard]] std::size_t NumberOfCells() const { return this->Cell(0, this->Nv); }
  [[nodiscard]] std::size_t NumberOfEdges() const { return this->EdgeV(0, this->Nv); }
  [[nodiscard]] Id Corner(int i, int j) const { return i + static_cast<Id>(this->Nu + 1) * j; }
  [[nodiscard]] std::array<int, 3> Triple(int i, int j) const
  {
    std::array<int, 3> cell{};
    cell[this->A] = i;
    cell[this->B] = j;
    return cell;
  }
  /// The edges of a cell: v low, v high, u low, u high.
  [[nodiscard]] std::array<std::size_t, 4> Edges(int i, int j) const
  {
    return { this->EdgeU(i, j), this->EdgeU(i, j + 1), this->EdgeV(i, j), this->EdgeV(i + 1, j) };
  }
  template <typename Body>
  void ForCells(const Body& body) const
  {
    this->Options.For(static_cast<std::ptrdiff_t>(this->NumberOfCells()), 32,
      [&](std::ptrdiff_t begin, std::ptrdiff_t end) { body(begin, end); });
  }

  // TessellationLayout.cxx
  void MeasureBends();
  /// Whether merging the two edges along u directly (v if swapped) is enough.
  [[nodiscard]] bool CanMergeEdges(
    std::size_t cell, std::size_t low, std::size_t high, bool swapped) const;
  ElementLayout LayOutCell(int i, int j, bool& limited) const;
  void LayOut();

  // TessellationFace.cxx
  void PlacePoints();
  /// Point k of an edge of a cell, from its first to its last corner.
  [[nodiscard]] Id OnEdge(int i, int j, std::size_t which, int k) const;
  void Triangulate();
  void DrawKnotLines();
  /// P_a x P_b from the derivatives at a point (3 vectors of m numbers).
  [[nodiscard]] Eigen::Vector3d Cross(const double* derivatives) const;
  /// The normal where tangents vanish or are parallel: from a little inside the element.
  [[nodiscard]] Eigen::Vector3d LimitNormal(
    const Evaluator& evaluator, const Eigen::Vector3d& parameters, double small) const;
  void EvaluatePoints();
  void DropCollapsed();

  Domain D;
  const TessellationOptions& Options;
  std::size_t A;
  std::size_t B;
  std::size_t Missing;
  double Fixed;
  double Outward;
  int Side;
  std::array<int, 3> FirstSpan;
  int Nu;
  int Nv;
  std::vector<Bend> CellBends;     // per cell and bound
  std::vector<EdgeBend> EdgeBends; // per edge and bound
  std::vector<int> EdgeSegments;
  std::vector<ElementLayout> Layouts;
  std::vector<Id> FirstOnEdge;
  std::vector<Id> FirstInside;
  std::vector<Id> FirstTriangle;
  SurfaceMesh Mesh;
};

}

#endif
