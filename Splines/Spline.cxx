// SPDX-License-Identifier: BSD-3-Clause
#include "Spline.h"

#include "Error.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <type_traits>
#include <utility>

namespace hyperpatch
{

namespace
{

template <typename Matrix>
SharedColumns Share(Matrix&& matrix)
{
  const auto owner = std::make_shared<const std::decay_t<Matrix>>(std::forward<Matrix>(matrix));
  return { { owner, owner->data() }, owner->rows(), owner->cols() };
}

SharedColumns ShareWeights(Eigen::VectorXd&& weights)
{
  SharedColumns columns = Share(std::move(weights));
  std::swap(columns.Rows, columns.Columns);
  return columns;
}

bool AreFinite(const double* numbers, Eigen::Index count)
{
  // 0 times what is not finite is NaN. Four sums, so that none waits for another.
  std::array<double, 4> sums{};
  Eigen::Index i = 0;
  for (; i + 4 <= count; i += 4)
  {
    for (std::size_t s = 0; s < sums.size(); ++s)
    {
      sums[s] += 0.0 * numbers[i + static_cast<Eigen::Index>(s)];
    }
  }
  for (; i < count; ++i)
  {
    sums[0] += 0.0 * numbers[i];
  }
  return sums[0] + sums[1] + sums[2] + sums[3] == 0.0;
}

/// For comparisons: what is shared is equal.
bool AreEqual(const SharedColumns& a, const SharedColumns& b)
{
  return a.Rows == b.Rows && a.Columns == b.Columns &&
    (a.Data == b.Data || std::equal(a.Data.get(), a.Data.get() + a.Size(), b.Data.get()));
}

}

Spline::Spline(
  std::array<KnotVector, 3> knots, Eigen::MatrixXd coefficients, Eigen::VectorXd weights)
  : Spline(std::move(knots), Share(std::move(coefficients)), ShareWeights(std::move(weights)))
{
}

Spline::Spline(std::array<KnotVector, 3> knots, SharedColumns coefficients, SharedColumns weights)
  : K(std::move(knots))
  , C(std::move(coefficients))
  , W(std::move(weights))
{
  if (this->W.Columns == 0)
  {
    this->W = {};
  }
  Eigen::Index expected = 1;
  for (const KnotVector& k : this->K)
  {
    expected *= k.Size();
  }
  if (this->C.Columns != expected)
  {
    throw Error(std::to_string(this->C.Columns) + " control points do not fill the lattice " +
      std::to_string(this->K[0].Size()) + " x " + std::to_string(this->K[1].Size()) + " x " +
      std::to_string(this->K[2].Size()) + " of the knot vectors");
  }
  if (this->C.Rows < 1)
  {
    throw Error("a spline needs at least one component");
  }
  if (this->W.Columns != 0 && this->W.Size() != expected)
  {
    throw Error(std::to_string(this->W.Columns) + " weights for " + std::to_string(expected) +
      " control points");
  }
  if (!AreFinite(this->C.Data.get(), this->C.Size()))
  {
    Eigen::Index first = 0;
    while (this->Coefficients().col(first).allFinite())
    {
      ++first;
    }
    throw Error("control point " + std::to_string(first) + " has a coordinate that is not finite");
  }
  const auto isWeight = [](double w) { return w > 0.0; };
  const double* const end = this->W.Data.get() + this->W.Size();
  if (!std::all_of(this->W.Data.get(), end, isWeight) ||
    !AreFinite(this->W.Data.get(), this->W.Size()))
  {
    const double* const wrong = std::find_if(
      this->W.Data.get(), end, [&isWeight](double w) { return !isWeight(w) || !std::isfinite(w); });
    throw Error("weight " + std::to_string(wrong - this->W.Data.get()) + " is " +
      std::to_string(*wrong) + "; weights must be positive and finite");
  }
}

Spline Spline::FromHomogeneous(std::array<KnotVector, 3> knots, const Eigen::MatrixXd& homogeneous)
{
  const Eigen::Index m = homogeneous.rows() - 1;
  Eigen::VectorXd weights = homogeneous.row(m).transpose();
  Eigen::MatrixXd points = homogeneous.topRows(m);
  for (Eigen::Index i = 0; i < points.cols(); ++i)
  {
    points.col(i) /= weights[i];
  }
  return Spline(std::move(knots), std::move(points), std::move(weights));
}

int Spline::Dimension() const
{
  return static_cast<int>(std::count_if(
    this->K.begin(), this->K.end(), [](const KnotVector& k) { return k.Degree() > 0; }));
}

std::array<int, 3> Spline::Degrees() const
{
  return { this->K[0].Degree(), this->K[1].Degree(), this->K[2].Degree() };
}

std::array<int, 3> Spline::Sizes() const
{
  return { this->K[0].Size(), this->K[1].Size(), this->K[2].Size() };
}

Eigen::MatrixXd Spline::Homogeneous() const
{
  if (!this->IsRational())
  {
    return this->Coefficients();
  }
  Eigen::MatrixXd homogeneous(this->C.Rows + 1, this->C.Columns);
  homogeneous.topRows(this->C.Rows) =
    this->Coefficients().array().rowwise() * this->Weights().transpose().array();
  homogeneous.bottomRows(1) = this->Weights().transpose();
  return homogeneous;
}

Eigen::VectorXd Spline::Evaluate(double u, double v, double w) const
{
  const double parameters[3] = { u, v, w };
  int first[3];
  double basis[3][MaxDegree + 1];
  for (int d = 0; d < 3; ++d)
  {
    const KnotVector& k = this->Knots(d);
    const double t = std::clamp(parameters[d], k.First(), k.Last());
    const int span = k.FindSpan(t);
    first[d] = span - k.Degree();
    k.BasisFunctions(span, t, basis[d]);
  }
  const auto size = this->Sizes();
  const auto points = this->Coefficients();
  const auto weights = this->Weights();
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(points.rows());
  double denominator = 0.0;
  for (int c = 0; c <= this->K[2].Degree(); ++c)
  {
    for (int b = 0; b <= this->K[1].Degree(); ++b)
    {
      const Eigen::Index row =
        size[0] * (first[1] + b + static_cast<Eigen::Index>(size[1]) * (first[2] + c));
      for (int a = 0; a <= this->K[0].Degree(); ++a)
      {
        const Eigen::Index i = row + first[0] + a;
        const double n =
          basis[0][a] * basis[1][b] * basis[2][c] * (this->IsRational() ? weights[i] : 1.0);
        sum += n * points.col(i);
        denominator += n;
      }
    }
  }
  return this->IsRational() ? Eigen::VectorXd(sum / denominator) : sum;
}

bool operator==(const Spline& a, const Spline& b)
{
  return a.K == b.K && AreEqual(a.C, b.C) && AreEqual(a.W, b.W);
}

bool SharesBasis(const Spline& a, const Spline& b)
{
  const auto left = a.Weights();
  const auto right = b.Weights();
  return a.Knots() == b.Knots() && left.size() == right.size() &&
    (left.data() == right.data() || left == right);
}

}
