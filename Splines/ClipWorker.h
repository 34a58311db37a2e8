// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_ClipWorker_h
#define hyperpatch_ClipWorker_h

#include "Clip.h"
#include "SimplexCut.h"
#include "SimplexRefinementWorker.h"

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace hyperpatch
{

/// The inside of Clip(), in the order of the work. Private to Clip*.cxx.
class ClipWorker
{
public:
  ClipWorker(const Patch& patch, std::shared_ptr<const PreparedAggregate> body,
    std::vector<std::shared_ptr<const ScalarField>> fields, const ClipOptions& options);

  /// False if aborted.
  bool Run();
  [[nodiscard]] ClipMesh Assemble();

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
  [[nodiscard]] static Side SideOf(const Cell& cell, std::size_t field)
  {
    return static_cast<Side>(cell.State >> (4 * field) & 3u);
  }
  [[nodiscard]] static Verdict VerdictOf(const Cell& cell, std::size_t field)
  {
    return static_cast<Verdict>(cell.State >> (4 * field + 2) & 3u);
  }

  bool Refine();
  bool Cut();
  /// Halves cells with a cut that misses the tolerance, or of which the curvature of the geometry
  /// turned parts over. False if there are none.
  bool HalveBadCuts();
  void Halve(const std::vector<unsigned char>& edges);
  void EvaluateNodes();
  void Decide();
  void Decide(Cell& cell, std::size_t field, BoxSpline& f) const;
  /// By what is certain; `byCorners` also by the values at corners.
  [[nodiscard]] bool IsDropped(const Cell& cell, bool byCorners) const;

  /// Errors of linear interpolation in a cell by their tolerances, the largest and those at the
  /// middles of edges.
  struct Error
  {
    double Largest = 0.0;
    std::array<double, 6> Edges{};

    void Add(double largest, const std::array<double, 6>& edges);
    void Add(const Error& other) { this->Add(other.Largest, other.Edges); }
  };
  [[nodiscard]] Error PositionError(const Cell& cell) const;
  [[nodiscard]] Error AttributeError(const Cell& cell) const;
  [[nodiscard]] Error CutError(const Cell& cell, std::size_t field) const;
  /// The edges that have to be halved, one bit each.
  [[nodiscard]] unsigned char EdgesToHalve(const Cell& cell) const;
  [[nodiscard]] double Width(const Cell& cell) const;
  [[nodiscard]] unsigned char LongestEdge(const Cell& cell) const;
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
  /// Triangles (segments of a surface) of the cut.
  struct Facet
  {
    double Error;     ///< distance of its middle from f = 0
    std::size_t Cell; ///< that it was cut from
  };
  [[nodiscard]] std::vector<Facet> CutFacets() const;

  /// The share of a tolerance that is aimed at: it is measured at a few points only.
  static constexpr double Target = 0.85;
  /// Cells of a field without bounds are this share of the patch's diagonal at most.
  static constexpr int SampledDivisions = 16;
  static constexpr std::ptrdiff_t Grain = 128;

  const Patch& P;
  std::shared_ptr<const PreparedAggregate> Body;
  std::vector<std::shared_ptr<const ScalarField>> Fields;
  const ClipOptions& Options;
  SolidGrid Grid;
  std::optional<SimplexRefinement> Mesh;
  double DomainWidth = 0.0;
  bool WasCapped = false;

  // Per node.
  std::vector<double> Lengths; ///< of the edge that it is the middle of
  std::vector<Eigen::Vector3d> Points;
  std::vector<std::vector<double>> Values;     ///< per field
  std::vector<std::vector<double>> Attributes; ///< per attribute: components x nodes

  std::vector<char> IsNew;  ///< per cell
  std::int64_t Sampled = 0; ///< cells that were decided by samples
  /// Parameters of C0 knot planes and the ends of the domain.
  std::array<std::vector<double>, 3> Creases;
  std::optional<SimplexCut> Pieces;
};

}

#endif
