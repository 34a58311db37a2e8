// SPDX-License-Identifier: BSD-3-Clause
#include "ScalarField.h"

#include "BezierExtractor.h"
#include "Error.h"
#include "JacobianSign.h"

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

/// Interior knots that occur at least degree - `smoothness` times.
std::array<std::vector<double>, 3> KnotsNoSmootherThan(const Spline& spline, int smoothness)
{
  std::array<std::vector<double>, 3> knots;
  for (std::size_t d = 0; d < 3; ++d)
  {
    const KnotVector& k = spline.Knots()[d];
    const std::vector<double> breaks = k.Breaks();
    for (std::size_t b = 1; b + 1 < breaks.size(); ++b)
    {
      if (k.Multiplicity(breaks[b]) >= k.Degree() - smoothness)
      {
        knots[d].push_back(breaks[b]);
      }
    }
  }
  return knots;
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

/// How many ulp of its largest control point a value may be off.
double Operations(const Spline& spline)
{
  const auto p = spline.Degrees();
  return 4.0 + 2.0 * (p[0] + p[1] + p[2]);
}

/// The value, or 0 where it is no more than the rounding error of a point of that many operations.
double ValueOrZero(const Quadric& q, const double* x, double operations)
{
  const double value = q.Value(x);
  return std::abs(value) <= UnitRoundoff * operations * q.Terms(x) ? 0.0 : value;
}

/// The determinant, or 0 where it is no more than the rounding error of its columns.
double DeterminantOrZero(const Eigen::Matrix3d& J, double operations)
{
  const double value = J.determinant();
  const double noise =
    UnitRoundoff * operations * J.col(0).norm() * J.col(1).norm() * J.col(2).norm();
  return std::abs(value) <= noise ? 0.0 : value;
}

}

ScalarField::~ScalarField() = default;

bool ScalarField::Restrict(const ParameterBox& box, BoxSpline& f) const
{
  const std::array<std::vector<double>, 3> breaks = this->Breaks();
  for (std::size_t d = 0; d < 3; ++d)
  {
    const auto next = std::upper_bound(breaks[d].begin(), breaks[d].end(), box.Low[d]);
    if (next != breaks[d].end() && *next < box.High[d])
    {
      return false;
    }
  }
  const std::optional<Bernstein> polynomial = this->OnBox(box);
  if (polynomial)
  {
    f.Assign(*polynomial);
  }
  return polynomial.has_value();
}

bool ScalarField::Excludes(const ParameterBox& /*box*/) const
{
  return false;
}

void ScalarField::Snap(std::size_t /*count*/, double* /*points*/) const {}

//------------------------------------------------------------------------------------------------
double Quadric::Value(const double* x) const
{
  const Eigen::Index m = this->b.size();
  const auto y = [this, x](Eigen::Index i)
  { return this->Origin.size() > 0 ? x[i] - this->Origin[i] : x[i]; };
  double sum = this->c;
  for (Eigen::Index i = 0; i < m; ++i)
  {
    double factor = this->b[i];
    for (Eigen::Index j = 0; j < m && !this->IsLinear(); ++j)
    {
      factor += this->A(i, j) * y(j);
    }
    sum += factor * y(i);
  }
  return sum;
}

double Quadric::Terms(const double* x) const
{
  const Eigen::Index m = this->b.size();
  const bool shifted = this->Origin.size() > 0;
  double sum = std::abs(this->c);
  for (Eigen::Index i = 0; i < m; ++i)
  {
    double slope = std::abs(this->b[i]);
    for (Eigen::Index j = 0; j < m && !this->IsLinear(); ++j)
    {
      slope += 2.0 * std::abs(this->A(i, j) * (shifted ? x[j] - this->Origin[j] : x[j]));
    }
    // A difference from the origin is as uncertain as what it is the difference of.
    sum += slope * (shifted ? std::abs(x[i]) + std::abs(this->Origin[i]) : std::abs(x[i]));
  }
  return sum;
}

void Quadric::Gradient(const double* x, double* gradient) const
{
  const Eigen::Index m = this->b.size();
  for (Eigen::Index i = 0; i < m; ++i)
  {
    gradient[i] = this->b[i];
    for (Eigen::Index j = 0; j < m && !this->IsLinear(); ++j)
    {
      const double y = this->Origin.size() > 0 ? x[j] - this->Origin[j] : x[j];
      gradient[i] += 2.0 * this->A(i, j) * y;
    }
  }
}

Quadric ComponentEquals(const Spline& attribute, int component, double value)
{
  if (component < 0 || component >= attribute.Components())
  {
    throw hyperpatch::Error("component " + std::to_string(component) +
      " is not one of the attribute's " + std::to_string(attribute.Components()));
  }
  return { Eigen::MatrixXd(), Eigen::VectorXd::Unit(attribute.Components(), component), -value,
    Eigen::VectorXd() };
}

Quadric MagnitudeEquals(const Spline& attribute, double value)
{
  const Eigen::Index m = attribute.Components();
  return { Eigen::MatrixXd::Identity(m, m), Eigen::VectorXd::Zero(m),
    value < 0.0 ? 1.0 : -value * value, Eigen::VectorXd() };
}

QuadricField::QuadricField(
  std::shared_ptr<const PreparedSpline> spline, Quadric quadric, bool isPhysical)
  : S(std::move(spline))
  , Q(std::move(quadric))
  , Physical(isPhysical)
{
  const Eigen::Index m = this->S->Spline().Components();
  if (this->Q.b.size() != m || (this->Q.Origin.size() != 0 && this->Q.Origin.size() != m) ||
    (!this->Q.IsLinear() && (this->Q.A.rows() != m || this->Q.A.cols() != m)))
  {
    throw hyperpatch::Error("the quadric is not one of " + std::to_string(m) + " components");
  }
}

QuadricField::QuadricField(const Spline& spline, Quadric quadric, bool isPhysical)
  : QuadricField(std::make_shared<const PreparedSpline>(spline), std::move(quadric), isPhysical)
{
}

void QuadricField::Evaluate(std::size_t count, const double* parameters, double* values) const
{
  const double operations = Operations(this->S->Spline());
  const auto m = static_cast<std::size_t>(this->S->Spline().Components());
  std::vector<double> points(m * std::min(count, Chunk));
  for (std::size_t first = 0; first < count; first += Chunk)
  {
    const std::size_t n = std::min(Chunk, count - first);
    this->S->Evaluator().Evaluate(n, parameters + 3 * first, points.data());
    for (std::size_t i = 0; i < n; ++i)
    {
      values[first + i] = ValueOrZero(this->Q, points.data() + m * i, operations);
    }
  }
}

void QuadricField::EvaluateWithGradient(
  std::size_t count, const double* parameters, double* values, double* gradients) const
{
  const double operations = Operations(this->S->Spline());
  const auto m = static_cast<std::size_t>(this->S->Spline().Components());
  std::vector<double> points(m * std::min(count, Chunk));
  std::vector<double> derivatives(3 * points.size());
  std::vector<double> g(m);
  for (std::size_t first = 0; first < count; first += Chunk)
  {
    const std::size_t n = std::min(Chunk, count - first);
    this->S->Evaluator().EvaluateWithDerivatives(
      n, parameters + 3 * first, points.data(), derivatives.data());
    for (std::size_t i = 0; i < n; ++i)
    {
      const double* x = points.data() + m * i;
      values[first + i] = ValueOrZero(this->Q, x, operations);
      this->Q.Gradient(x, g.data());
      for (std::size_t d = 0; d < 3; ++d)
      {
        double sum = 0.0;
        for (std::size_t c = 0; c < m; ++c)
        {
          sum += g[c] * derivatives[3 * m * i + m * d + c];
        }
        gradients[3 * (first + i) + d] = sum;
      }
    }
  }
}

std::array<std::vector<double>, 3> QuadricField::Breaks() const
{
  return BreaksOf(this->S->Spline());
}

std::array<std::vector<double>, 3> QuadricField::Creases() const
{
  return KnotsNoSmootherThan(this->S->Spline(), 0);
}

std::optional<Bernstein> QuadricField::OnBox(const ParameterBox& box) const
{
  const Spline& spline = this->S->Spline();
  const BezierBox bezier = OnBezierBox(spline, box);
  const Eigen::MatrixXd& points = bezier.Points;
  const auto degrees = spline.Degrees();
  const bool rational = spline.IsRational();
  const int m = spline.Components();
  // Around the middle of the control points, so that far-away models do not lose digits.
  const Eigen::VectorXd centre = points.topRows(m).rowwise().sum() /
    (rational ? points.row(m).sum() : static_cast<double>(points.cols()));
  Eigen::VectorXd slope(m);
  this->Q.Gradient(centre.data(), slope.data());
  const double value = this->Q.Value(centre.data());

  // The linear part, b . (X - c W) + q(c) W. Each coefficient is a short sum, right to a few ulp of
  // its terms besides what the points bring along. Decisions here and at corners must not
  // contradict each other, so the bound is no less than what Evaluate() takes for 0.
  const double largestWeight = rational ? points.row(m).maxCoeff() : 1.0;
  double terms = this->Q.Terms(centre.data());
  Eigen::VectorXd point(m);
  for (Eigen::Index i = 0; i < points.cols(); ++i)
  {
    point = points.col(i).head(m) / (rational ? points(m, i) : 1.0);
    terms = std::max(terms, this->Q.Terms(point.data()));
  }
  double shift = std::abs(value);
  for (int c = 0; c < m; ++c)
  {
    shift += std::abs(slope[c]) *
      (points.row(c).cwiseAbs().maxCoeff() + std::abs(centre[c]) * largestWeight);
  }
  const double noise = UnitRoundoff * (Operations(spline) + 4 * (m + 2)) * terms * largestWeight;
  const double error = bezier.Error *
      (slope.cwiseAbs().sum() + slope.cwiseAbs().dot(centre.cwiseAbs()) + std::abs(value)) +
    UnitRoundoff * 4 * (m + 2) * shift + noise;
  Eigen::VectorXd coefficients = points.topRows(m).transpose() * slope;
  const double constant = value - slope.dot(centre);
  if (rational)
  {
    coefficients += constant * points.row(m).transpose();
  }
  else
  {
    coefficients.array() += constant;
  }
  const Bernstein linear(degrees, std::move(coefficients), error);
  if (this->Q.IsLinear())
  {
    return linear;
  }

  const Bernstein weight = rational ? Bernstein(degrees, points.row(m).transpose(), bezier.Error)
                                    : Bernstein(degrees, Eigen::VectorXd::Ones(points.cols()));
  std::vector<Bernstein> x;
  for (int c = 0; c < m; ++c)
  {
    x.push_back(Bernstein(degrees, points.row(c).transpose(), bezier.Error) - centre[c] * weight);
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
  return Bernstein(sum.Degrees(), sum.Coefficients(), sum.RoundingBound() + noise * largestWeight);
}

bool QuadricField::Restrict(const ParameterBox& box, BoxSpline& f) const
{
  if (!this->Q.IsLinear())
  {
    return ScalarField::Restrict(box, f);
  }
  // Larger ones take longer than what they save.
  constexpr double LargestWindow = 2000.0;
  const Spline& spline = this->S->Spline();
  if (BoxSpline::WindowVolume(spline, box) > LargestWindow)
  {
    return false;
  }
  const int m = spline.Components();
  double terms = 0.0;
  double largestWeight = 1.0;
  const bool rational = spline.IsRational();
  const double* points = spline.Coefficients().data();
  const auto coefficient = [&](Eigen::Index i)
  {
    const double* x = points + m * i;
    const double weight = rational ? spline.Weights()[i] : 1.0;
    terms = std::max(terms, this->Q.Terms(x));
    largestWeight = std::max(largestWeight, weight);
    return weight * this->Q.Value(x);
  };
  f.Restrict(spline, box, coefficient);
  f.AddNoise(UnitRoundoff * (Operations(spline) + 4 * (m + 2)) * terms * largestWeight);
  return true;
}

bool QuadricField::Excludes(const ParameterBox& box) const
{
  const int m = this->S->Spline().Components();
  std::array<double, 3 * 16> fixed;
  std::vector<double> grown;
  double* bounds = fixed.data();
  if (m > 16)
  {
    grown.resize(3 * static_cast<std::size_t>(m));
    bounds = grown.data();
  }
  Eigen::Map<Eigen::VectorXd> centre(bounds, m);
  Eigen::Map<Eigen::VectorXd> half(bounds + m, m);
  Eigen::Map<Eigen::VectorXd> slope(bounds + 2 * m, m);
  this->S->Bounds().Find(box, centre.data(), half.data());
  for (int i = 0; i < m; ++i)
  {
    const double low = centre[i];
    const double high = half[i];
    centre[i] = 0.5 * (low + high);
    half[i] = 0.5 * (high - low);
  }
  const double value = this->Q.Value(centre.data());
  this->Q.Gradient(centre.data(), slope.data());
  double reach = 0.0;
  for (int i = 0; i < m; ++i)
  {
    reach += std::abs(slope[i]) * half[i];
    for (int j = 0; j < m && !this->Q.IsLinear(); ++j)
    {
      reach += std::abs(this->Q.A(i, j)) * half[i] * half[j];
    }
  }
  // The sums are short, right to a few ulp of their terms, and Evaluate() takes a little more for
  // 0.
  const double error = UnitRoundoff * (Operations(this->S->Spline()) + 4 * (m + 2)) * 2.0 *
    (this->Q.Terms(centre.data()) + reach);
  if (std::abs(value) > reach + error)
  {
    return true;
  }
  // On one element the hull of a linear function is tighter than that of the bounding box.
  const Spline& spline = this->S->Spline();
  const std::array<int, 3> spans = SpansAround(spline, box);
  for (std::size_t d = 0; d < 3; ++d)
  {
    const KnotVector& knots = spline.Knots()[d];
    if (!this->Q.IsLinear() || box.Low[d] < knots[spans[d]] || box.High[d] > knots[spans[d] + 1])
    {
      return false;
    }
  }
  double least = INFINITY;
  double most = -INFINITY;
  ForControlWindow(spline, spans,
    [this, &spline, &least, &most](Eigen::Index i)
    {
      const double f = this->Q.Value(spline.Coefficients().col(i).data());
      least = std::min(least, f);
      most = std::max(most, f);
    });
  return least > error || most < -error;
}

void QuadricField::Snap(std::size_t count, double* points) const
{
  const auto m = static_cast<std::size_t>(this->S->Spline().Components());
  if (!this->Physical)
  {
    return;
  }
  std::vector<double> gradient(m);
  for (std::size_t i = 0; i < count; ++i)
  {
    double* x = points + 3 * i;
    this->Q.Gradient(x, gradient.data());
    double square = 0.0;
    for (const double g : gradient)
    {
      square += g * g;
    }
    const double step = square > 0.0 ? this->Q.Value(x) / square : 0.0;
    for (std::size_t c = 0; c < m; ++c)
    {
      x[c] -= step * gradient[c];
    }
  }
}

//------------------------------------------------------------------------------------------------
JacobianField::JacobianField(std::shared_ptr<const PreparedSpline> geometry)
  : S(std::move(geometry))
{
  if (this->S->Spline().Components() != 3 || this->S->Spline().Dimension() != 3)
  {
    throw hyperpatch::Error("the Jacobian determinant needs a volume with three coordinates");
  }
}

JacobianField::JacobianField(const Spline& geometry)
  : JacobianField(std::make_shared<const PreparedSpline>(geometry))
{
}

void JacobianField::Evaluate(std::size_t count, const double* parameters, double* values) const
{
  const double operations = Operations(this->S->Spline());
  std::vector<double> points(3 * std::min(count, Chunk));
  std::vector<double> derivatives(9 * std::min(count, Chunk));
  for (std::size_t first = 0; first < count; first += Chunk)
  {
    const std::size_t n = std::min(Chunk, count - first);
    this->S->Evaluator().EvaluateWithDerivatives(
      n, parameters + 3 * first, points.data(), derivatives.data());
    for (std::size_t i = 0; i < n; ++i)
    {
      values[first + i] = DeterminantOrZero(
        Eigen::Map<const Eigen::Matrix3d>(derivatives.data() + 9 * i), operations);
    }
  }
}

void JacobianField::EvaluateWithGradient(
  std::size_t count, const double* parameters, double* values, double* gradients) const
{
  const double operations = Operations(this->S->Spline());
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
      values[first + i] = DeterminantOrZero(J, operations);
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
  return JacobianSign(this->S->Spline(), box) != 0;
}

std::optional<Bernstein> JacobianField::OnBox(const ParameterBox& box) const
{
  const BezierBox bezier = OnBezierBox(this->S->Spline(), box);
  return JacobianDeterminant(
    bezier.Points, this->S->Spline().Degrees(), this->S->Spline().IsRational(), bezier.Error);
}

//------------------------------------------------------------------------------------------------
SampledField::SampledField(std::shared_ptr<const PreparedSpline> geometry, Function function)
  : S(std::move(geometry))
  , G(std::move(function))
{
  if (this->S->Spline().Components() != 3)
  {
    throw hyperpatch::Error("a function on physical space needs a geometry with three coordinates");
  }
}

SampledField::SampledField(const Spline& geometry, Function function)
  : SampledField(std::make_shared<const PreparedSpline>(geometry), std::move(function))
{
}

void SampledField::Evaluate(std::size_t count, const double* parameters, double* values) const
{
  std::vector<double> points(3 * std::min(count, Chunk));
  for (std::size_t first = 0; first < count; first += Chunk)
  {
    const std::size_t n = std::min(Chunk, count - first);
    this->S->Evaluator().Evaluate(n, parameters + 3 * first, points.data());
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
    this->S->Evaluator().EvaluateWithDerivatives(
      n, parameters + 3 * first, points.data(), derivatives.data());
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
  return BreaksOf(this->S->Spline());
}

std::array<std::vector<double>, 3> SampledField::Creases() const
{
  return KnotsNoSmootherThan(this->S->Spline(), 0);
}

std::optional<Bernstein> SampledField::OnBox(const ParameterBox& /*box*/) const
{
  return std::nullopt;
}

}
