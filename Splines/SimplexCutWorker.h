// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_SimplexCutWorker_h
#define hyperpatch_SimplexCutWorker_h

#include "FreeParametersWorker.h"
#include "NumberingWorker.h"
#include "Parallel.h"
#include "Prepared.h"
#include "ScalarField.h"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace hyperpatch
{

/// Simplices over the parameter domain of a patch (points, segments, triangles or tetrahedra) that
/// are cut along the zero sets of fields, one field after the other.
///
/// Which side a simplex is on is read off its corners: it must be small enough for that. New points
/// lie on edges, where the field is 0 to round-off; on an edge that lies on the zero sets of
/// earlier fields they stay on those too, so that the line in which two zero sets meet is met by
/// both. A simplex is bisected at its new points in an order that depends on the points alone:
/// simplices that share a face cut it alike, and what was conforming stays so. Orientations stay.
///
/// Points from which the zero set is nearer than a quarter of their shortest edge may be moved onto
/// it along an edge instead, so that no thin parts are cut off (Labelle & Shewchuk, Isosurface
/// stuffing, SIGGRAPH 2007).
class SimplexCut
{
public:
  using Index = std::int64_t;

  struct Cell
  {
    /// Points; as many as the dimension asks for are used.
    std::array<Index, 4> Corners;
    std::int64_t Origin; ///< a number of the caller's, which parts inherit
    /// Bit k: the part is where field k is positive.
    unsigned Outside = 0;
  };

  /// \param dimension of the simplices, 0..3
  /// \throws Error if there are more than MaximumFields
  SimplexCut(std::shared_ptr<const PreparedAggregate> body,
    std::vector<std::shared_ptr<const ScalarField>> fields, int dimension);
  static constexpr int MaximumFields = 8;

  /// \param point physical
  /// \param on bit k: the point lies on the zero set of field k
  /// \param fixed bit d: parameter d must stay if the point is moved; Immovable: it may not be
  Index AddPoint(const FreeParameters& parameter, const Eigen::Vector3d& point, unsigned on = 0,
    unsigned fixed = Immovable);
  static constexpr unsigned Immovable = 8;
  void AddCell(const Cell& cell) { this->C.push_back(cell); }

  /// Cuts all cells along the zero set of a field. Those that lose their extent, since all points
  /// lie on it now, are left out.
  /// \param keepOutside whether to keep the parts where the field is positive
  /// \returns false if aborted
  bool Cut(
    int field, bool keepOutside, const ParallelFor& parallel, const std::function<bool()>& abort);

  ///@{
  /// The steps of Cut(), between which points and values may be changed, so that simplices of
  /// several objects are cut alike where they meet. False if aborted.
  bool FindValues(int field, const ParallelFor& parallel, const std::function<bool()>& abort);
  bool FindPoints(const ParallelFor& parallel, const std::function<bool()>& abort);
  bool Split(bool keepOutside, const std::function<bool()>& abort);
  ///@}
  /// Of the field that is cut along now, per point.
  [[nodiscard]] double Value(Index point) const
  {
    return this->Values[static_cast<std::size_t>(point)];
  }
  void SetValue(Index point, double value)
  {
    this->Values[static_cast<std::size_t>(point)] = value;
  }
  void SetPoint(Index point, const Eigen::Vector3d& x)
  {
    this->X[static_cast<std::size_t>(point)] = x;
  }
  [[nodiscard]] Index FirstNewPoint() const { return this->FirstNew; }
  /// The new point between two others, -1 if there is none.
  [[nodiscard]] Index PointBetween(Index a, Index b) const
  {
    const Index number = this->CutEdges.Find(KeyOf(a, b));
    return number < 0 ? -1 : this->FirstNew + number;
  }

  [[nodiscard]] const std::vector<Cell>& Cells() const { return this->C; }
  [[nodiscard]] const std::vector<Eigen::Vector3d>& Parameters() const { return this->U; }
  [[nodiscard]] FreeParameters At(Index point) const
  {
    const auto p = static_cast<std::size_t>(point);
    return { this->U[p], this->Weights[p] };
  }
  [[nodiscard]] const std::vector<Eigen::Vector3d>& Points() const { return this->X; }
  /// Per point, bit k: it lies on the zero set of field k.
  [[nodiscard]] const std::vector<unsigned>& On() const { return this->OnField; }
  /// The points that a new point lies between, those of the caller: twice itself.
  [[nodiscard]] const std::vector<std::array<Index, 2>>& Between() const { return this->Ends; }
  /// The largest |f| left at a new point, relative to |f| at the ends of its edge.
  [[nodiscard]] double LargestResidual() const { return this->Residual; }

private:
  [[nodiscard]] static Numbering::Key KeyOf(Index a, Index b)
  {
    return { static_cast<int>(std::min(a, b)), static_cast<int>(std::max(a, b)), 0, 0 };
  }
  [[nodiscard]] int Sign(Index point) const
  {
    const double v = this->Value(point);
    return v < 0.0 ? -1 : v > 0.0 ? 1 : 0;
  }
  /// Calls visit(a, b) for the edges of a cell with a change of sign.
  template <typename Visit>
  void ForCutEdges(const Cell& cell, const Visit& visit) const
  {
    for (std::size_t i = 0; i <= static_cast<std::size_t>(this->Dimension); ++i)
    {
      for (std::size_t j = i + 1; j <= static_cast<std::size_t>(this->Dimension); ++j)
      {
        if (this->Sign(cell.Corners[i]) * this->Sign(cell.Corners[j]) < 0)
        {
          visit(cell.Corners[i], cell.Corners[j]);
        }
      }
    }
  }
  /// In which the ends of an edge differ.
  [[nodiscard]] std::array<bool, 3> DirectionsOf(const std::array<Index, 2>& edge) const;
  void Bisect(const Cell& cell, const std::vector<Index>& order, std::vector<Cell>& parts) const;
  void FindRoots(const std::vector<std::array<Index, 2>>& edges, const ParallelFor& parallel);
  void MovePoints();
  void Correct(unsigned on, const std::array<bool, 3>& isFree, Eigen::Vector3d& u) const;

  std::shared_ptr<const PreparedAggregate> Body;
  std::vector<std::shared_ptr<const ScalarField>> Fields;
  int Dimension;
  Eigen::Vector3d Low, High; ///< the domain
  std::vector<Eigen::Vector3d> U, Weights, X;
  bool HasPoles = false; ///< weights that are not 1
  std::vector<unsigned> OnField;
  std::vector<unsigned> Fixed;
  std::vector<char> WasMoved;
  std::vector<std::array<Index, 2>> Ends;
  std::vector<Cell> C;
  double Residual = 0.0;

  // Of the field that is cut along now.
  int Field = 0;
  std::vector<double> Values;
  Index FirstNew = 0; ///< point
  Numbering CutEdges; ///< by their points, in the order of the new points
};

}

#endif
