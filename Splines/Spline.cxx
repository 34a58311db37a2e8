// SPDX-License-Identifier: BSD-3-Clause
#include "Spline.h"

#include "Error.h"

#include <algorithm>
#include <string>
#include <utility>

namespace hyperpatch
{

Spline::Spline(
  std::array<KnotVector, 3> knots, Eigen::MatrixXd coefficients, Eigen::VectorXd weights)
  : K(std::move(knots))
  , C(std::move(coefficients))
  , W(std::move(weights))
{
  Eigen::Index expected = 1;
  for (const KnotVector& k : this->K)
  {
    expected *= k.Size();
  }
  if (this->C.cols() != expected)
  {
    throw Error(std::to_string(this->C.cols()) + " control points do not fill the lattice " +
      std::to_string(this->K[0].Size()) + " x " + std::to_string(this->K[1].Size()) + " x " +
      std::to_string(this->K[2].Size()) + " of the knot vectors");
  }
  if (this->C.rows() < 1)
  {
    throw Error("a spline needs at least one component");
  }
  if (this->W.size() != 0 && this->W.size() != expected)
  {
    throw Error(std::to_string(this->W.size()) + " weights for " + std::to_string(expected) +
      " control points");
  }
  if (!this->C.allFinite())
  {
    for (Eigen::Index i = 0; i < expected; ++i)
    {
      if (!this->C.col(i).allFinite())
      {
        throw Error("control point " + std::to_string(i) + " has a coordinate that is not finite");
      }
    }
  }
  for (Eigen::Index i = 0; i < this->W.size(); ++i)
  {
    if (!std::isfinite(this->W[i]) || this->W[i] <= 0.0)
    {
      throw Error("weight " + std::to_string(i) + " is " + std::to_string(this->W[i]) +
        "; weights must be positive and finite");
    }
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
    return this->C;
  }
  Eigen::MatrixXd homogeneous(this->C.rows() + 1, this->C.cols());
  homogeneous.topRows(this->C.rows()) = this->C.array().rowwise() * this->W.transpose().array();
  homogeneous.bottomRows(1) = this->W.transpose();
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
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(this->C.rows());
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
          basis[0][a] * basis[1][b] * basis[2][c] * (this->IsRational() ? this->W[i] : 1.0);
        sum += n * this->C.col(i);
        denominator += n;
      }
    }
  }
  return this->IsRational() ? Eigen::VectorXd(sum / denominator) : sum;
}

bool SharesBasis(const Spline& a, const Spline& b)
{
  return a.Knots() == b.Knots() && a.Weights().size() == b.Weights().size() &&
    a.Weights() == b.Weights();
}

}
