// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_JacobianTree_h
#define hyperpatch_JacobianTree_h

#include "Cone.h"
#include "ControlBounds.h"
#include "Spline.h"

#include <array>
#include <cstddef>
#include <functional>
#include <vector>

namespace hyperpatch
{

/// What bounds det J on a cell of a JacobianTree.
enum class JacobianBound
{
  Cones,              ///< Cu . (Cv x Cw), as in the paper: of the directions of the derivatives
  ConesInThreeOrders, ///< the best of Cu . (Cv x Cw), Cv . (Cw x Cu), Cw . (Cu x Cv)
  Bernstein           ///< Bernstein coefficients of det J
};

struct JacobianTreeOptions
{
  JacobianBound Bound = JacobianBound::Cones;
  /// No cell is split whose interval is narrower: for cones of the product of unit vectors, from -1
  /// to 1; for Bernstein coefficients as a fraction of the greatest magnitude on the whole domain.
  double MinimumWidth = 0.02;
  /// No cell is split when so many are in the queue.
  std::size_t MaximumCells = 900;
  /// Called after every split with the number of cells in the queue; true ends the work early.
  std::function<bool(std::size_t)> Abort = [](std::size_t) { return false; };
};

/// The adaptive subdivision of Joy & Duchaineau, Boundary Determination for Trivariate Solids,
/// Pacific Graphics 1999, section 6: cells of the parameter domain in which det J may vanish.
///
/// The cell whose interval is the widest is split first, at its centre, across the direction in
/// which the gradient of det J varies most (width of its interval times edge length; all three
/// directions are compared). A child whose interval excludes 0 is discarded. The binary tree of all
/// cells is kept.
///
/// Where the paper is silent or wrong: cones know when they say nothing (cells with a derivative
/// that turns by 90 degrees, or that vanishes, stay); a child's interval is cut with its parent's,
/// which also holds, so that the widest interval never grows; the factor L of an interval takes the
/// least length of a derivative along the axis of its cone instead of the least control vector,
/// which is no bound. Rational volumes: derivatives as in JacobianSign.h; the gradient, which
/// decides nothing but the direction of cuts, is that of the control points without weights.
class JacobianTree
{
public:
  struct Cell
  {
    ParameterBox Box;
    Interval Bound;  ///< of det J in the sense of MinimumWidth
    int Parent = -1; ///< index of a cell
    int Axis = -1;   ///< direction that it is split across, -1 for leaves
    std::array<int, 2> Children{ -1, -1 };
    bool Discarded = false; ///< det J certainly does not vanish
  };

  /// The queue before a split: FIGURE 12 of the paper draws Width.
  struct Step
  {
    double Width;      ///< of the interval that is the widest
    std::size_t Cells; ///< in the queue
  };

  /// \param geometry a volume with three coordinates, C1 (between C0 knot planes)
  /// \throws Error if it is none, or the minimal width is negative or NaN
  JacobianTree(const Spline& geometry, const JacobianTreeOptions& options = {});

  /// All cells, parents before their children; the first is the domain.
  [[nodiscard]] const std::vector<Cell>& Cells() const { return this->C; }
  /// The leaves in which det J may vanish, ascending.
  [[nodiscard]] const std::vector<int>& Queue() const { return this->Q; }
  /// One per split, and the queue at the end.
  [[nodiscard]] const std::vector<Step>& Steps() const { return this->S; }

private:
  std::vector<Cell> C;
  std::vector<int> Q;
  std::vector<Step> S;
};

}

#endif
