// SPDX-License-Identifier: BSD-3-Clause
#include "QuadricField.h"

#include "Error.h"
#include "ScalarFieldWorker.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace hyperpatch
{

using field::BezierBox;
using field::BreaksOf;
using field::Chunk;
using field::ForControlWindow;
using field::KnotsNoSmootherThan;
using field::OnBezierBox;
using field::Operations;
using field::SpansAround;
using field::UnitRoundoff;

namespace
{

/// The value, or 0 where it is no more than the rounding error of a point of that many operations.
double ValueOrZero(const Quadric& q, const double* x, double operations)
{
  double terms = 0.0;
  const double value = q.Value(x, terms);
  return std::abs(value) <= UnitRoundoff * operations * terms ? 0.0 : value;
}

/// Value() of a linear quadric of so many components, with Terms().
template <int Components>
class LinearValue
{
public:
  explicit LinearValue(const Quadric& q)
    : C(q.c)
    , B(q.b)
    , Origin(Vector::Zero())
  {
    if (q.Origin.size() > 0)
    {
      this->Origin = q.Origin;
    }
  }
  double operator()(const double* x, double& terms) const
  {
    double sum = this->C;
    terms = std::abs(sum);
    for (int i = 0; i < Components; ++i)
    {
      sum += this->B[i] * (x[i] - this->Origin[i]);
      terms += std::abs(this->B[i]) * (std::abs(x[i]) + std::abs(this->Origin[i]));
    }
    return sum;
  }

private:
  using Vector = Eigen::Matrix<double, Components, 1>;
  double C;
  Vector B, Origin;
};

bool IsInOneElement(const Spline& spline, const ParameterBox& box)
{
  const std::array<int, 3> spans = SpansAround(spline, box);
  for (std::size_t d = 0; d < 3; ++d)
  {
    const KnotVector& knots = spline.Knots()[d];
    if (box.Low[d] < knots[spans[d]] || box.High[d] > knots[spans[d] + 1])
    {
      return false;
    }
  }
  return true;
}

/// Bounds of the magnitudes of the derivatives in a direction, with respect to the unit cube, of
/// each component of w (x - centre) on the box, and of w in the end: those of the control points
/// of the derivative.
Eigen::VectorXd LargestDerivatives(
  const Spline& spline, const ParameterBox& box, int direction, const Eigen::VectorXd& centre)
{
  const auto d = static_cast<std::size_t>(direction);
  const int m = spline.Components();
  const auto n = spline.Sizes();
  const std::ptrdiff_t stride = d == 0 ? 1
    : d == 1                           ? n[0]
                                       : static_cast<std::ptrdiff_t>(n[0]) * n[1];
  const KnotVector& knots = spline.Knots(direction);
  const int p = knots.Degree();
  const SpanBlock block = SpansOf(spline, box);
  std::array<int, 3> first{};
  std::array<int, 3> last{};
  for (std::size_t e = 0; e < 3; ++e)
  {
    const KnotVector& k = spline.Knots()[e];
    first[e] = k.Spans()[static_cast<std::size_t>(block.First[e])] - k.Degree();
    last[e] = k.Spans()[static_cast<std::size_t>(block.Last[e])];
  }
  Eigen::VectorXd largest = Eigen::VectorXd::Zero(m + 1);
  const auto& x = spline.Coefficients();
  const double width = box.High[d] - box.Low[d];
  for (int k = first[2]; k <= last[2] - (d == 2 ? 1 : 0); ++k)
  {
    for (int j = first[1]; j <= last[1] - (d == 1 ? 1 : 0); ++j)
    {
      for (int i = first[0]; i <= last[0] - (d == 0 ? 1 : 0); ++i)
      {
        const int at = d == 0 ? i : d == 1 ? j : k;
        const double reach = knots[at + p + 1] - knots[at + 1];
        if (reach <= 0.0)
        {
          continue;
        }
        const Eigen::Index here = i + n[0] * (j + static_cast<Eigen::Index>(n[1]) * k);
        const Eigen::Index next = here + stride;
        const double a = spline.IsRational() ? spline.Weights()[here] : 1.0;
        const double b = spline.IsRational() ? spline.Weights()[next] : 1.0;
        const double factor = p * width / reach;
        for (int c = 0; c < m; ++c)
        {
          largest[c] = std::max(largest[c],
            factor * std::abs(b * (x(c, next) - centre[c]) - a * (x(c, here) - centre[c])));
        }
        largest[m] = std::max(largest[m], factor * std::abs(b - a));
      }
    }
  }
  return largest;
}

}

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

std::optional<Quadric> QuadricFromValues(const std::function<double(const Eigen::Vector3d&)>& value,
  bool isLinear, const Eigen::Vector3d& centre, double size)
{
  const auto at = [&](const Eigen::Vector3d& offset) { return value(centre + size * offset); };
  // q(centre + size y) = y' A y + b . y + c
  const Eigen::Matrix3d unit = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b;
  const double c = at(Eigen::Vector3d::Zero());
  for (int i = 0; i < 3; ++i)
  {
    const double plus = at(unit.col(i));
    const double minus = at(-unit.col(i));
    b[i] = 0.5 * (plus - minus);
    A(i, i) = 0.5 * (plus + minus) - c;
  }
  for (int i = 0; i < 3; ++i)
  {
    for (int j = 0; j < i; ++j)
    {
      const double both = at(unit.col(i) + unit.col(j));
      A(i, j) = A(j, i) = 0.5 * (both - c - b[i] - b[j] - A(i, i) - A(j, j));
    }
  }
  if (!A.allFinite() || !b.allFinite() || !std::isfinite(c))
  {
    return std::nullopt;
  }
  return Quadric{ isLinear ? Eigen::MatrixXd() : Eigen::MatrixXd(A / (size * size)), b / size, c,
    centre };
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
  if (this->Q.IsLinear())
  {
    this->Q.Gradient(nullptr, g.data());
  }
  for (std::size_t first = 0; first < count; first += Chunk)
  {
    const std::size_t n = std::min(Chunk, count - first);
    this->S->Evaluator().EvaluateWithDerivatives(
      n, parameters + 3 * first, points.data(), derivatives.data());
    for (std::size_t i = 0; i < n; ++i)
    {
      const double* x = points.data() + m * i;
      values[first + i] = ValueOrZero(this->Q, x, operations);
      if (!this->Q.IsLinear())
      {
        this->Q.Gradient(x, g.data());
      }
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
  // Larger ones take longer than what they save.
  constexpr double LargestWindow = 2000.0;
  const Spline& spline = this->S->Spline();
  if (!this->Q.IsLinear() && IsInOneElement(spline, box))
  {
    return ScalarField::Restrict(box, f);
  }
  const int m = spline.Components();
  double terms = 0.0;
  double largestWeight = 1.0;
  const bool rational = spline.IsRational();
  const double* points = spline.Coefficients().data();
  const double* weights = rational ? spline.Weights().data() : nullptr;
  const auto restrictTimesWeight = [&](const auto& value)
  {
    const auto coefficient = [&](Eigen::Index i)
    {
      const double weight = weights ? weights[i] : 1.0;
      double own = 0.0;
      const double found = value(points + m * i, own);
      terms = std::max(terms, own);
      largestWeight = std::max(largestWeight, weight);
      return weight * found;
    };
    if (!f.Restrict(spline, box, coefficient, LargestWindow))
    {
      return false;
    }
    f.AddNoise(UnitRoundoff * (Operations(spline) + 4 * (m + 2)) * terms * largestWeight);
    return true;
  };
  if (this->Q.IsLinear())
  {
    return m == 1 ? restrictTimesWeight(LinearValue<1>(this->Q))
      : m == 3
      ? restrictTimesWeight(LinearValue<3>(this->Q))
      : restrictTimesWeight([this](const double* x, double& own) { return this->Q.Value(x, own); });
  }

  // q is the linear function that touches it in the middle of the box's bounds, and a rest.
  Eigen::VectorXd low(m);
  Eigen::VectorXd high(m);
  this->S->Bounds().Find(box, low.data(), high.data());
  const Eigen::VectorXd centre = 0.5 * (low + high);
  const Eigen::VectorXd half = 0.5 * (high - low);
  Eigen::VectorXd slope(m);
  this->Q.Gradient(centre.data(), slope.data());
  const double constant = this->Q.Value(centre.data());
  const bool isDone = restrictTimesWeight(
    [&](const double* x, double& own)
    {
      own = this->Q.Terms(x);
      return constant + slope.dot(Eigen::Map<const Eigen::VectorXd>(x, m) - centre);
    });
  if (!isDone)
  {
    return false;
  }
  // With y = x - centre the rest is y' A y, its derivative 2 y' A y_u. Where rational, both times
  // W: W y_u = Y_u - W_u y for the homogeneous Y.
  const Eigen::MatrixXd A = this->Q.A.cwiseAbs();
  const Eigen::VectorXd reach = A * half;
  const double rest = half.dot(reach);
  std::array<double, 3> slack{};
  for (int d = 0; d < 3; ++d)
  {
    const Eigen::VectorXd steps = LargestDerivatives(spline, box, d, centre);
    const double W = rational ? steps[m] : 0.0;
    slack[static_cast<std::size_t>(d)] = 2.0 * reach.dot(steps.head(m) + W * half) + W * rest;
  }
  f.Widen(largestWeight * rest, slack);
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
  // On one element the hull of a linear function of several components is tighter than that of the
  // bounding box.
  const Spline& spline = this->S->Spline();
  if (m == 1 || !this->Q.IsLinear() || !IsInOneElement(spline, box))
  {
    return false;
  }
  double least = INFINITY;
  double most = -INFINITY;
  ForControlWindow(spline, SpansAround(spline, box),
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

}
