// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_Spline_h
#define hyperpatch_Spline_h

#include "KnotVector.h"

#include <Eigen/Core>

#include <array>
#include <memory>

namespace hyperpatch
{

/// Columns of numbers that have owners elsewhere, such as an array of a data set. Nobody changes
/// them while this is there.
struct SharedColumns
{
  std::shared_ptr<const double> Data;
  Eigen::Index Rows = 0;
  Eigen::Index Columns = 0;

  [[nodiscard]] Eigen::Index Size() const { return this->Rows * this->Columns; }
};

/// A tensor-product spline of one, two or three parametric dimensions with any number of
/// components, polynomial or rational: a curve, surface or volume, or a field on one.
///
/// There are always three knot vectors; a direction that is not there has degree 0 and one control
/// point. Control points are *projected* (not multiplied by their weights), u fastest: control
/// point (i, j, k) is column i + nu (j + nv k). A value type, validated at construction; copies
/// share their numbers.
class Spline
{
public:
  /// \param knots one knot vector per direction
  /// \param coefficients m x (nu nv nw), columns are control points, u fastest
  /// \param weights nu nv nw positive numbers, or empty for a polynomial spline
  /// \throws Error on sizes that do not fit, numbers that are not finite, weights that are not
  /// positive.
  Spline(std::array<KnotVector, 3> knots, Eigen::MatrixXd coefficients,
    Eigen::VectorXd weights = Eigen::VectorXd());

  /// The same of numbers that are not copied: m rows of coefficients, one row of weights or none.
  Spline(std::array<KnotVector, 3> knots, SharedColumns coefficients, SharedColumns weights);

  /// From homogeneous control points (w x, w, last row the weight), the inverse of Homogeneous().
  [[nodiscard]] static Spline FromHomogeneous(
    std::array<KnotVector, 3> knots, const Eigen::MatrixXd& homogeneous);

  /// Number of parametric directions that are there: 1 curve, 2 surface, 3 volume.
  [[nodiscard]] int Dimension() const;
  [[nodiscard]] int Components() const { return static_cast<int>(this->C.Rows); }
  [[nodiscard]] bool IsRational() const { return this->W.Columns > 0; }

  [[nodiscard]] const std::array<KnotVector, 3>& Knots() const { return this->K; }
  [[nodiscard]] const KnotVector& Knots(int direction) const
  {
    return this->K[static_cast<std::size_t>(direction)];
  }
  [[nodiscard]] std::array<int, 3> Degrees() const;
  [[nodiscard]] std::array<int, 3> Sizes() const;
  /// Product of Sizes().
  [[nodiscard]] Eigen::Index NumberOfControlPoints() const { return this->C.Columns; }

  /// m x (nu nv nw), projected.
  [[nodiscard]] Eigen::Map<const Eigen::MatrixXd> Coefficients() const&
  {
    return { this->C.Data.get(), this->C.Rows, this->C.Columns };
  }
  /// nu nv nw weights, empty when polynomial.
  [[nodiscard]] Eigen::Map<const Eigen::VectorXd> Weights() const&
  {
    return { this->W.Data.get(), this->W.Columns };
  }
  ///@{
  /// Of a spline that goes at once: copies.
  [[nodiscard]] Eigen::MatrixXd Coefficients() const&& { return this->Coefficients(); }
  [[nodiscard]] Eigen::VectorXd Weights() const&& { return this->Weights(); }
  ///@}
  /// (m + 1) x (nu nv nw): columns (w x, w) when rational; the coefficients themselves otherwise.
  [[nodiscard]] Eigen::MatrixXd Homogeneous() const;

  /// The value at one point (m numbers); parameters outside the domain are moved to its border.
  /// For many points use Evaluator.
  [[nodiscard]] Eigen::VectorXd Evaluate(double u, double v = 0.0, double w = 0.0) const;

  friend bool operator==(const Spline& a, const Spline& b);
  friend bool operator!=(const Spline& a, const Spline& b) { return !(a == b); }

private:
  std::array<KnotVector, 3> K;
  SharedColumns C, W;
};

/// True where both have the same knots and weights: one basis serves both.
[[nodiscard]] bool SharesBasis(const Spline& a, const Spline& b);

}

#endif
