// SPDX-License-Identifier: BSD-3-Clause
#include "ScalarField.h"

#include "BezierExtractor.h"
#include "Error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

namespace hyperpatch
{

namespace
{

/// Points are worked on in chunks of this size, with scratch made once per call.
constexpr std::size_t Chunk = 256;

constexpr double UnitRoundoff = std::numeric_limits<double>::epsilon();

std::array<std::vector<double>, 3> BreaksOf(const Spline& spline)
{
  return { spline.Knots(0).Breaks(), spline.Knots(1).Breaks(), spline.Knots(2).Breaks() };
}

/// The knot span of each direction that holds the box.
std::array<int, 3> SpansAround(const Spline& spline, const ParameterBox& box)
{
  std::array<int, 3> spans{};
  for (std::size_t d = 0; d < 3; ++d)
  {
    spans[d] = spline.Knots()[d].FindSpan(0.5 * (box.Low[d] + box.High[d]));
  }
  return spans;
}

/// Calls visit(i) for the columns of the control points that reach the element of those spans.
template <typename Visit>
void ForControlWindow(const Spline& spline, const std::array<int, 3>& spans, Visit&& visit)
{
  const auto p = spline.Degrees();
  const auto n = spline.Sizes();
  for (int k = spans[2] - p[2]; k <= spans[2]; ++k)
  {
    for (int j = spans[1] - p[1]; j <= spans[1]; ++j)
    {
      const Eigen::Index row = n[0] * (j + static_cast<Eigen::Index>(n[1]) * k);
      for (int i = spans[0] - p[0]; i <= spans[0]; ++i)
      {
        visit(row + i);
      }
    }
  }
}

/// Homogeneous components of the spline on a box, each as a polynomial on the unit cube.
struct BezierBox
{
  Eigen::MatrixXd Points;
  double Error; ///< bound of the rounding error of each number
};

BezierBox OnBezierBox(const Spline& spline, const ParameterBox& box)
{
  const std::array<int, 3> knots = SpansAround(spline, box);
  std::array<int, 3> spans{};
  int operations = 6;
  for (std::size_t d = 0; d < 3; ++d)
  {
    const std::vector<int>& all = spline.Knots()[d].Spans();
    spans[d] = static_cast<int>(std::lower_bound(all.begin(), all.end(), knots[d]) - all.begin());
    operations += 6 * spline.Knots()[d].Degree();
  }
  BezierBox result;
  BezierExtractor(spline).Extract(spans, box.Low, box.High, result.Points);
  // Weights of blossoms inside a span are sums of positive terms of degree factors, five roundings
  // each; they sum to 1 (Higham 2002, section 3.1).
  double largest = 0.0;
  ForControlWindow(spline, knots,
    [&spline, &largest](Eigen::Index i)
    {
      const double weight = spline.IsRational() ? spline.Weights()[i] : 1.0;
      const double magnitude = spline.Coefficients().col(i).cwiseAbs().maxCoeff();
      largest =
        std::max(largest, weight * (spline.IsRational() ? std::max(1.0, magnitude) : magnitude));
    });
  result.Error = UnitRoundoff * operations * largest;
  return result;
}

/// w (values - offset) as coefficients of a polynomial field, and what rounding did to them.
PolynomialField Weighted(
  const Spline& spline, const Eigen::RowVectorXd& values, double offset, int operations)
{
  Eigen::MatrixXd coefficients = values.array() - offset;
  double largest = values.cwiseAbs().maxCoeff() + std::abs(offset);
  if (spline.IsRational())
  {
    coefficients.array() *= spline.Weights().transpose().array();
    largest *= spline.Weights().maxCoeff();
  }
  return PolynomialField(
    Spline(spline.Knots(), std::move(coefficients)), UnitRoundoff * operations * largest);
}

}

ScalarField::~ScalarField() = default;

bool ScalarField::Excludes(const ParameterBox& /*box*/) const
{
  return false;
}

void ScalarField::Snap(std::size_t /*count*/, double* /*points*/) const {}

//------------------------------------------------------------------------------------------------
PolynomialField::PolynomialField(Spline polynomial, double coefficientError)
  : F(std::move(polynomial))
  , CoefficientError(coefficientError)
  , E(this->F)
{
  if (this->F.Components() != 1 || this->F.IsRational())
  {
    throw Error("a polynomial field has one component and no weights");
  }
}

void PolynomialField::Evaluate(std::size_t count, const double* parameters, double* values) const
{
  this->E.Evaluate(count, parameters, values);
}

void PolynomialField::EvaluateWithGradient(
  std::size_t count, const double* parameters, double* values, double* gradients) const
{
  this->E.EvaluateWithDerivatives(count, parameters, values, gradients);
}

std::array<std::vector<double>, 3> PolynomialField::Breaks() const
{
  return BreaksOf(this->F);
}

std::optional<Bernstein> PolynomialField::OnBox(const ParameterBox& box) const
{
  const BezierBox bezier = OnBezierBox(this->F, box);
  return Bernstein(
    this->F.Degrees(), bezier.Points.row(0).transpose(), bezier.Error + this->CoefficientError);
}

bool PolynomialField::Excludes(const ParameterBox& box) const
{
  double low = INFINITY;
  double high = -INFINITY;
  ForControlWindow(this->F, SpansAround(this->F, box),
    [this, &low, &high](Eigen::Index i)
    {
      const double value = this->F.Coefficients()(0, i);
      low = std::min(low, value);
      high = std::max(high, value);
    });
  return low > this->CoefficientError || high < -this->CoefficientError;
}

PolynomialField AttributeField(const Spline& attribute, int component, double value)
{
  if (component < 0 || component >= attribute.Components())
  {
    throw Error("component " + std::to_string(component) + " is not one of the attribute's " +
      std::to_string(attribute.Components()));
  }
  return Weighted(attribute, attribute.Coefficients().row(component), value, 2);
}

//------------------------------------------------------------------------------------------------
PlaneField::PlaneField(const Spline& geometry, const Quadric& plane)
  : PolynomialField(Weighted(geometry,
      plane.b.head(geometry.Components()).transpose() * geometry.Coefficients(), -plane.c, 8))
  , Q(plane)
{
}

namespace
{

/// One Newton step towards q = 0 along the gradient: exact for a plane, quadratic otherwise.
void SnapToQuadric(const Quadric& q, std::size_t count, double* points)
{
  for (std::size_t i = 0; i < count; ++i)
  {
    Eigen::Map<Eigen::Vector3d> x(points + 3 * i);
    const Eigen::Vector3d gradient = q.Gradient(x);
    const double square = gradient.squaredNorm();
    if (square > 0.0)
    {
      x -= gradient * (q(x) / square);
    }
  }
}

}

void PlaneField::Snap(std::size_t count, double* points) const
{
  SnapToQuadric(this->Q, count, points);
}

//------------------------------------------------------------------------------------------------
QuadricField::QuadricField(const Spline& spline, const Quadric& quadric, bool isPhysical)
  : S(spline)
  , Q(quadric)
  , Physical(isPhysical)
  , E(spline)
{
  if (spline.Components() > 3)
  {
    throw Error("a quadric needs a spline of at most three components");
  }
}

void QuadricField::Evaluate(std::size_t count, const double* parameters, double* values) const
{
  const auto m = static_cast<std::size_t>(this->S.Components());
  std::vector<double> points(m * std::min(count, Chunk));
  for (std::size_t first = 0; first < count; first += Chunk)
  {
    const std::size_t n = std::min(Chunk, count - first);
    this->E.Evaluate(n, parameters + 3 * first, points.data());
    for (std::size_t i = 0; i < n; ++i)
    {
      Eigen::Vector3d x = Eigen::Vector3d::Zero();
      std::copy_n(points.data() + m * i, m, x.data());
      values[first + i] = this->Q(x);
    }
  }
}

void QuadricField::EvaluateWithGradient(
  std::size_t count, const double* parameters, double* values, double* gradients) const
{
  const auto m = static_cast<std::size_t>(this->S.Components());
  std::vector<double> points(m * std::min(count, Chunk));
  std::vector<double> derivatives(3 * points.size());
  for (std::size_t first = 0; first < count; first += Chunk)
  {
    const std::size_t n = std::min(Chunk, count - first);
    this->E.EvaluateWithDerivatives(n, parameters + 3 * first, points.data(), derivatives.data());
    for (std::size_t i = 0; i < n; ++i)
    {
      Eigen::Vector3d x = Eigen::Vector3d::Zero();
      std::copy_n(points.data() + m * i, m, x.data());
      values[first + i] = this->Q(x);
      const Eigen::Vector3d g = this->Q.Gradient(x);
      for (std::size_t d = 0; d < 3; ++d)
      {
        double sum = 0.0;
        for (std::size_t c = 0; c < m; ++c)
        {
          sum += g[static_cast<Eigen::Index>(c)] * derivatives[3 * m * i + m * d + c];
        }
        gradients[3 * (first + i) + d] = sum;
      }
    }
  }
}

std::array<std::vector<double>, 3> QuadricField::Breaks() const
{
  return BreaksOf(this->S);
}

std::optional<Bernstein> QuadricField::OnBox(const ParameterBox& box) const
{
  const BezierBox bezier = OnBezierBox(this->S, box);
  const Eigen::MatrixXd& points = bezier.Points;
  const auto degrees = this->S.Degrees();
  const int m = this->S.Components();
  // Around the middle of the control points, so that far-away models do not lose digits.
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (int c = 0; c < m; ++c)
  {
    centre[c] =
      this->S.IsRational() ? points.row(c).sum() / points.row(m).sum() : points.row(c).mean();
  }
  const Eigen::Vector3d b = this->Q.Gradient(centre);
  const double c0 = this->Q(centre);
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(points.cols());
  const Bernstein weight = this->S.IsRational()
    ? Bernstein(degrees, points.row(m).transpose(), bezier.Error)
    : Bernstein(degrees, ones);
  std::vector<Bernstein> x;
  for (int c = 0; c < m; ++c)
  {
    x.push_back(Bernstein(degrees, points.row(c).transpose(), bezier.Error) - centre[c] * weight);
  }
  Bernstein linear = c0 * weight;
  for (int c = 0; c < m; ++c)
  {
    linear = linear + b[c] * x[static_cast<std::size_t>(c)];
  }
  Bernstein sum = linear * weight;
  for (int r = 0; r < m; ++r)
  {
    for (int c = 0; c <= r; ++c)
    {
      const double a = r == c ? this->Q.A(r, r) : this->Q.A(r, c) + this->Q.A(c, r);
      if (a != 0.0)
      {
        sum = sum + a * (x[static_cast<std::size_t>(r)] * x[static_cast<std::size_t>(c)]);
      }
    }
  }
  return sum;
}

bool QuadricField::Excludes(const ParameterBox& box) const
{
  Eigen::Vector3d low = Eigen::Vector3d::Constant(INFINITY);
  Eigen::Vector3d high = -low;
  const int m = this->S.Components();
  ForControlWindow(this->S, SpansAround(this->S, box),
    [this, m, &low, &high](Eigen::Index i)
    {
      low.head(m) = low.head(m).cwiseMin(this->S.Coefficients().col(i));
      high.head(m) = high.head(m).cwiseMax(this->S.Coefficients().col(i));
    });
  low.tail(3 - m).setZero();
  high.tail(3 - m).setZero();
  const Eigen::Vector3d centre = 0.5 * (low + high);
  const Eigen::Vector3d half = 0.5 * (high - low);
  const double value = this->Q(centre);
  const double reach =
    this->Q.Gradient(centre).cwiseAbs().dot(half) + half.dot(this->Q.A.cwiseAbs() * half);
  // The sums above are short: a few ulp of their terms.
  return std::abs(value) > reach * (1.0 + 1e-14) + 1e-14 * std::abs(this->Q.c);
}

void QuadricField::Snap(std::size_t count, double* points) const
{
  if (this->Physical)
  {
    SnapToQuadric(this->Q, count, points);
  }
}

//------------------------------------------------------------------------------------------------
JacobianField::JacobianField(const Spline& geometry)
  : S(geometry)
  , E(geometry)
{
  if (geometry.Components() != 3 || geometry.Dimension() != 3)
  {
    throw Error("the Jacobian determinant needs a volume with three coordinates");
  }
}

void JacobianField::Evaluate(std::size_t count, const double* parameters, double* values) const
{
  std::vector<double> points(3 * std::min(count, Chunk));
  std::vector<double> derivatives(9 * std::min(count, Chunk));
  for (std::size_t first = 0; first < count; first += Chunk)
  {
    const std::size_t n = std::min(Chunk, count - first);
    this->E.EvaluateWithDerivatives(n, parameters + 3 * first, points.data(), derivatives.data());
    for (std::size_t i = 0; i < n; ++i)
    {
      values[first + i] =
        Eigen::Map<const Eigen::Matrix3d>(derivatives.data() + 9 * i).determinant();
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
    this->E.EvaluateWithSecondDerivatives(
      n, parameters + 3 * first, points.data(), derivatives.data(), seconds.data());
    for (std::size_t i = 0; i < n; ++i)
    {
      const Eigen::Map<const Eigen::Matrix3d> J(derivatives.data() + 9 * i);
      const Eigen::Map<const Eigen::Matrix<double, 3, 6>> H(seconds.data() + 18 * i);
      values[first + i] = J.determinant();
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
  return BreaksOf(this->S);
}

std::optional<Bernstein> JacobianField::OnBox(const ParameterBox& box) const
{
  const BezierBox bezier = OnBezierBox(this->S, box);
  return JacobianDeterminant(bezier.Points, this->S.Degrees(), this->S.IsRational(), bezier.Error);
}

//------------------------------------------------------------------------------------------------
SampledField::SampledField(const Spline& geometry, Function function)
  : S(geometry)
  , G(std::move(function))
  , E(geometry)
{
  if (geometry.Components() != 3)
  {
    throw Error("a function on physical space needs a geometry with three coordinates");
  }
}

void SampledField::Evaluate(std::size_t count, const double* parameters, double* values) const
{
  std::vector<double> points(3 * std::min(count, Chunk));
  for (std::size_t first = 0; first < count; first += Chunk)
  {
    const std::size_t n = std::min(Chunk, count - first);
    this->E.Evaluate(n, parameters + 3 * first, points.data());
    this->G(n, points.data(), values + first, nullptr);
  }
}

void SampledField::EvaluateWithGradient(
  std::size_t count, const double* parameters, double* values, double* gradients) const
{
  std::vector<double> points(3 * std::min(count, Chunk));
  std::vector<double> derivatives(3 * points.size());
  std::vector<double> physical(points.size());
  for (std::size_t first = 0; first < count; first += Chunk)
  {
    const std::size_t n = std::min(Chunk, count - first);
    this->E.EvaluateWithDerivatives(n, parameters + 3 * first, points.data(), derivatives.data());
    this->G(n, points.data(), values + first, physical.data());
    for (std::size_t i = 0; i < n; ++i)
    {
      const Eigen::Map<const Eigen::Matrix3d> J(derivatives.data() + 9 * i);
      const Eigen::Map<const Eigen::Vector3d> g(physical.data() + 3 * i);
      Eigen::Map<Eigen::Vector3d>(gradients + 3 * (first + i)) = J.transpose() * g;
    }
  }
}

std::array<std::vector<double>, 3> SampledField::Breaks() const
{
  return BreaksOf(this->S);
}

std::optional<Bernstein> SampledField::OnBox(const ParameterBox& /*box*/) const
{
  return std::nullopt;
}

}
