// SPDX-License-Identifier: BSD-3-Clause
#include "JacobianField.h"

#include "Error.h"
#include "JacobianSign.h"
#include "ScalarFieldWorker.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

namespace hyperpatch
{

using field::BezierBox;
using field::BreaksOf;
using field::Chunk;
using field::KnotsNoSmootherThan;
using field::OnBezierBox;
using field::SpansAround;
using field::UnitRoundoff;

namespace
{

/// The determinant less a value, or 0 where that is no more than its rounding error.
double DifferenceOrZero(const Eigen::Matrix3d& J, double value, const JacobianRounding& rounding,
  const double* parameters)
{
  const double difference = J.determinant() - value;
  const double certain = std::abs(difference) - UnitRoundoff * std::abs(value);
  // The bound for the whole patch decides nearly always.
  return certain > rounding.LargestBound(J) || certain > rounding.Bound(J, parameters) ? difference
                                                                                       : 0.0;
}

}

JacobianField::JacobianField(std::shared_ptr<const PreparedSpline> geometry, double value)
  : S(std::move(geometry))
  , Rounding(this->S->Spline())
  , Value(value)
{
  if (this->S->Spline().Components() != 3 || this->S->Spline().Dimension() != 3)
  {
    throw hyperpatch::Error("the Jacobian determinant needs a volume with three coordinates");
  }
}

JacobianField::JacobianField(const Spline& geometry, double value)
  : JacobianField(std::make_shared<const PreparedSpline>(geometry), value)
{
}

void JacobianField::Evaluate(std::size_t count, const double* parameters, double* values) const
{
  std::vector<double> points(3 * std::min(count, Chunk));
  std::vector<double> derivatives(9 * std::min(count, Chunk));
  for (std::size_t first = 0; first < count; first += Chunk)
  {
    const std::size_t n = std::min(Chunk, count - first);
    this->S->Evaluator().EvaluateWithDerivatives(
      n, parameters + 3 * first, points.data(), derivatives.data());
    for (std::size_t i = 0; i < n; ++i)
    {
      values[first + i] =
        DifferenceOrZero(Eigen::Map<const Eigen::Matrix3d>(derivatives.data() + 9 * i), this->Value,
          this->Rounding, parameters + 3 * (first + i));
    }
  }
}

void JacobianField::EvaluateWithGradient(
  std::size_t count, const double* parameters, double* values, double* gradients) const
{
  std::vector<double> points(3 * std::min(count, Chunk));
  std::vector<double> derivatives(9 * std::min(count, Chunk));
  std::vector<double> seconds(18 * std::min(count, Chunk));
  // Where the second derivative by directions a and b stands in the evaluator's output.
  static constexpr int Place[3][3] = { { 0, 1, 2 }, { 1, 3, 4 }, { 2, 4, 5 } };
  for (std::size_t first = 0; first < count; first += Chunk)
  {
    const std::size_t n = std::min(Chunk, count - first);
    this->S->Evaluator().EvaluateWithSecondDerivatives(
      n, parameters + 3 * first, points.data(), derivatives.data(), seconds.data());
    for (std::size_t i = 0; i < n; ++i)
    {
      const Eigen::Map<const Eigen::Matrix3d> J(derivatives.data() + 9 * i);
      const Eigen::Map<const Eigen::Matrix<double, 3, 6>> H(seconds.data() + 18 * i);
      values[first + i] =
        DifferenceOrZero(J, this->Value, this->Rounding, parameters + 3 * (first + i));
      for (int d = 0; d < 3; ++d)
      {
        double sum = 0.0;
        for (int column = 0; column < 3; ++column)
        {
          Eigen::Matrix3d replaced = J;
          replaced.col(column) = H.col(Place[column][d]);
          sum += replaced.determinant();
        }
        gradients[3 * (first + i) + static_cast<std::size_t>(d)] = sum;
      }
    }
  }
}

std::array<std::vector<double>, 3> JacobianField::Breaks() const
{
  return BreaksOf(this->S->Spline());
}

std::array<std::vector<double>, 3> JacobianField::Creases() const
{
  return KnotsNoSmootherThan(this->S->Spline(), 1);
}

bool JacobianField::Excludes(const ParameterBox& box) const
{
  const int sign = JacobianSign(this->S->Spline(), box);
  return sign != 0 && sign * this->Value <= 0.0;
}

std::optional<Bernstein> JacobianField::OnBox(const ParameterBox& box) const
{
  const BezierBox bezier = OnBezierBox(this->S->Spline(), box);
  const auto degrees = this->S->Spline().Degrees();
  const bool rational = this->S->Spline().IsRational();
  Bernstein determinant = JacobianDeterminant(bezier.Points, degrees, rational, bezier.Error);
  if (this->Value == 0.0)
  {
    return determinant;
  }
  // The determinant is that of the map from the unit cube.
  double scaled = this->Value;
  for (std::size_t d = 0; d < 3; ++d)
  {
    scaled *= box.High[d] - box.Low[d];
  }
  const Bernstein value(
    { 0, 0, 0 }, Eigen::VectorXd::Constant(1, scaled), 8.0 * UnitRoundoff * std::abs(scaled));
  if (!rational)
  {
    return determinant - value;
  }
  const Bernstein weight(degrees, bezier.Points.row(3).transpose(), bezier.Error);
  const Bernstein square = weight * weight;
  return determinant - value * (square * square);
}

bool JacobianField::Restrict(const ParameterBox& box, BoxSpline& f) const
{
  const Spline& geometry = this->S->Spline();
  const std::array<int, 3> spans = SpansAround(geometry, box);
  ParameterBox element{};
  int greatest = 0;
  for (std::size_t d = 0; d < 3; ++d)
  {
    const KnotVector& knots = geometry.Knots()[d];
    element.Low[d] = knots[spans[d]];
    element.High[d] = knots[spans[d] + 1];
    if (box.Low[d] < element.Low[d] || element.High[d] < box.High[d])
    {
      return false;
    }
    greatest = std::max(greatest, knots.Degree());
  }
  // A knot vector has no more degrees; such elements are computed for every box.
  if ((geometry.IsRational() ? 4 * greatest : 3 * greatest) > MaxDegree)
  {
    return this->ScalarField::Restrict(box, f);
  }
  const auto polynomial = this->Polynomials.Find(spans,
    [&]() -> ElementPolynomial
    {
      const Bernstein values = *this->OnBox(element);
      std::array<KnotVector, 3> knots;
      for (std::size_t d = 0; d < 3; ++d)
      {
        const int degree = values.Degrees()[d];
        knots[d] = KnotVector::Uniform(degree, degree + 1, element.Low[d], element.High[d]);
      }
      return { Spline(std::move(knots), values.Coefficients().transpose()),
        values.RoundingBound() };
    });
  const auto coefficients = polynomial->Values.Coefficients(); // a view
  f.Restrict(
    polynomial->Values, box, [&coefficients](Eigen::Index i) { return coefficients(0, i); });
  f.AddNoise(polynomial->Error);
  return true;
}

}
