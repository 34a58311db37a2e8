// SPDX-License-Identifier: BSD-3-Clause
#include "RefinementEvaluation.h"

#include <algorithm>

namespace hyperpatch
{

namespace
{

// Two rows of the refinement matrix, as weights of control points First, First + 1, ...
struct StackedKnots
{
  int First;
  /// D_{mu-k+1}, the point on the curve.
  Eigen::VectorXd Point;
  /// D_{mu-k+2}, or D_{mu-k} at the end of the domain.
  Eigen::VectorXd Neighbour;
  /// The derivative is Factor (Neighbour - Point).
  double Factor;
};

// The paper's triangle, from level `level` down: the row of one new control point. The levels are
// those of de Boor's algorithm, last first; `first + index` names the point within its level.
Eigen::VectorXd RefinementRow(
  const KnotVector& knots, int first, int inserted, double t, int level, int index)
{
  const int p = knots.Degree();
  Eigen::VectorXd alpha = Eigen::VectorXd::Zero(inserted + 1);
  alpha[index] = 1.0;
  for (int r = level; r >= 1; --r)
  {
    Eigen::VectorXd next = Eigen::VectorXd::Zero(inserted + 1);
    for (int j = r; j <= inserted; ++j)
    {
      if (alpha[j] != 0.0)
      {
        const double low = knots[first + j];
        const double gamma = (t - low) / (knots[first + j + p - r + 1] - low);
        next[j] += gamma * alpha[j];
        next[j - 1] += (1.0 - gamma) * alpha[j];
      }
    }
    alpha = next;
  }
  return alpha;
}

StackedKnots StackKnots(const KnotVector& knots, double t)
{
  t = std::clamp(t, knots.First(), knots.Last());
  const int p = knots.Degree();
  const int span = knots.FindSpan(t);
  if (p == 0)
  {
    const Eigen::VectorXd one = Eigen::VectorXd::Ones(1);
    return { span, one, one, 0.0 };
  }
  // Knots that are already there need not be inserted, but at least one is.
  const int present = t == knots[span] ? std::min(knots.Multiplicity(t), p - 1) : 0;
  const int inserted = p - present;
  const int first = span - p;

  // The new point is a convex combination of its two neighbours, the first level of the triangle.
  const Eigen::VectorXd left = RefinementRow(knots, first, inserted, t, inserted - 1, inserted - 1);
  const Eigen::VectorXd right = RefinementRow(knots, first, inserted, t, inserted - 1, inserted);
  const double low = knots[span - present];
  const double high = knots[span + 1];
  const double gamma = (t - low) / (high - low);
  const Eigen::VectorXd point = (1.0 - gamma) * left + gamma * right;
  if (t < high)
  {
    return { first, point, right, p / (high - t) };
  }
  return { first, point, left, p / (low - t) };
}

// One entry of A_w (x)^2 (A_v (x)^1 (A_u (x)^0 P^w)): a homogeneous control point of the refined
// volume, its weight last.
Eigen::VectorXd RefinedPoint(const Spline& spline, const std::array<StackedKnots, 3>& stacked,
  const std::array<const Eigen::VectorXd*, 3>& rows)
{
  const std::array<int, 3> size = spline.Sizes();
  const Eigen::Index m = spline.Components();
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(m + 1);
  for (Eigen::Index c = 0; c < rows[2]->size(); ++c)
  {
    for (Eigen::Index b = 0; b < rows[1]->size(); ++b)
    {
      for (Eigen::Index a = 0; a < rows[0]->size(); ++a)
      {
        const Eigen::Index i = stacked[0].First + a +
          size[0] * (stacked[1].First + b + size[1] * (stacked[2].First + c));
        const double weight = spline.IsRational() ? spline.Weights()[i] : 1.0;
        const double alpha = (*rows[0])[a] * (*rows[1])[b] * (*rows[2])[c] * weight;
        sum.head(m) += alpha * spline.Coefficients().col(i);
        sum[m] += alpha;
      }
    }
  }
  return sum;
}

}

PointWithPartials EvaluateByRefinement(const Spline& spline, double u, double v, double w)
{
  const std::array<StackedKnots, 3> stacked{ StackKnots(spline.Knots(0), u),
    StackKnots(spline.Knots(1), v), StackKnots(spline.Knots(2), w) };
  const std::array<const Eigen::VectorXd*, 3> centre{ &stacked[0].Point, &stacked[1].Point,
    &stacked[2].Point };
  const Eigen::Index m = spline.Components();
  const Eigen::VectorXd point = RefinedPoint(spline, stacked, centre);
  PointWithPartials result{ point.head(m), Eigen::MatrixXd(m, 3) };
  if (spline.IsRational())
  {
    result.Value /= point[m];
  }
  for (std::size_t d = 0; d < 3; ++d)
  {
    std::array<const Eigen::VectorXd*, 3> rows = centre;
    rows[d] = &stacked[d].Neighbour;
    const Eigen::VectorXd neighbour = RefinedPoint(spline, stacked, rows);
    const auto column = static_cast<Eigen::Index>(d);
    if (spline.IsRational())
    {
      result.Partials.col(column) = stacked[d].Factor * neighbour[m] / point[m] *
        (neighbour.head(m) / neighbour[m] - result.Value);
    }
    else
    {
      result.Partials.col(column) = stacked[d].Factor * (neighbour.head(m) - result.Value);
    }
  }
  return result;
}

}
