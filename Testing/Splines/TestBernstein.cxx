// SPDX-License-Identifier: BSD-3-Clause
#include "Bernstein.h"
#include "BezierExtractor.h"
#include "Error.h"
#include "Evaluator.h"
#include "Splines/Models.h"

#include <Eigen/LU>
#include <gtest/gtest.h>

#include <functional>
#include <limits>

using namespace hyperpatch;

namespace
{

constexpr double Epsilon = std::numeric_limits<double>::epsilon();

Bernstein RandomPolynomial(std::mt19937& random, std::array<int, 3> degrees)
{
  std::uniform_real_distribution<double> value(-1.0, 1.0);
  Eigen::VectorXd c((degrees[0] + 1) * (degrees[1] + 1) * (degrees[2] + 1));
  for (double& x : c)
  {
    x = value(random);
  }
  return Bernstein(degrees, c);
}

/// Coefficients that are small integers: products of a few of them are exact in 64 bits.
Eigen::MatrixXd RandomIntegers(std::mt19937& random, int rows, int columns, int low, int high)
{
  std::uniform_int_distribution<int> value(low, high);
  Eigen::MatrixXd m(rows, columns);
  for (double& x : m.reshaped())
  {
    x = value(random);
  }
  return m;
}

void ForRandomPoints(std::mt19937& random, const std::function<void(double, double, double)>& body)
{
  std::uniform_real_distribution<double> parameter(0.0, 1.0);
  for (int i = 0; i < 20; ++i)
  {
    const double u = parameter(random);
    const double v = parameter(random);
    body(u, v, parameter(random));
  }
}

/// de Casteljau in extended precision.
long double EvaluateLong(const std::array<int, 3>& degrees, std::vector<long double> c,
  const std::array<long double, 3>& parameters)
{
  int stride = 1;
  for (std::size_t d = 0; d < 3; ++d)
  {
    const int n = degrees[d] + 1;
    for (int line = 0; line < static_cast<int>(c.size()) / n; ++line)
    {
      // Directions before d are already contracted into column 0 of their lines.
      long double* values = c.data() + line / stride * stride * n + line % stride;
      for (int r = n - 1; r > 0; --r)
      {
        for (int i = 0; i < r; ++i)
        {
          values[i * stride] =
            (1 - parameters[d]) * values[i * stride] + parameters[d] * values[(i + 1) * stride];
        }
      }
    }
    stride *= n;
  }
  return c[0];
}

/// Value (index 0) and the three first derivatives in extended precision.
std::array<long double, 4> JetLong(const std::array<int, 3>& degrees,
  const Eigen::RowVectorXd& coefficients, const std::array<long double, 3>& parameters)
{
  const std::vector<long double> c(coefficients.begin(), coefficients.end());
  std::array<long double, 4> jet{ EvaluateLong(degrees, c, parameters) };
  int stride = 1;
  for (std::size_t d = 0; d < 3; ++d)
  {
    const int n = degrees[d] + 1;
    std::array<int, 3> lower = degrees;
    --lower[d];
    std::vector<long double> difference;
    for (int i = 0; i < static_cast<int>(c.size()); ++i)
    {
      if (i / stride % n < n - 1)
      {
        const auto k = static_cast<std::size_t>(i);
        difference.push_back((n - 1) * (c[k + static_cast<std::size_t>(stride)] - c[k]));
      }
    }
    jet[d + 1] = EvaluateLong(lower, difference, parameters);
    stride *= n;
  }
  return jet;
}

/// det[X_u X_v X_w X] (rational) or det[P_u P_v P_w] in extended precision.
long double JacobianLong(const Eigen::MatrixXd& points, const std::array<int, 3>& degrees,
  const std::array<long double, 3>& parameters)
{
  Eigen::Matrix<long double, 4, 4> m = Eigen::Matrix<long double, 4, 4>::Identity();
  for (Eigen::Index r = 0; r < points.rows(); ++r)
  {
    const auto jet = JetLong(degrees, points.row(r), parameters);
    m.row(r) << jet[1], jet[2], jet[3], jet[0];
  }
  if (points.rows() == 3)
  {
    m.col(3) << 0, 0, 0, 1;
  }
  return m.determinant();
}

}

TEST(Bernstein, AlgebraAgreesWithPointwiseEvaluation)
{
  std::mt19937 random(1);
  for (int round = 0; round < 30; ++round)
  {
    const auto degree = [&random] { return static_cast<int>(random() % 7); };
    const Bernstein f = RandomPolynomial(random, { degree(), degree(), degree() });
    const Bernstein g = RandomPolynomial(random, { degree(), degree(), degree() });
    const Bernstein sum = f + g;
    const Bernstein difference = f - g;
    const Bernstein product = f * g;
    const Bernstein scaled = -2.5 * f;
    const int direction = round % 3;
    const Bernstein elevated = f.Elevate(direction, 15);
    const double t = 0.3;
    const auto parts = f.Split(direction, t);
    // Evaluation rounds about 2 (degree + 1) times per direction, at values up to 2.5.
    const double tolerance = 2.5 * 2 * 3 * 16 * Epsilon;
    ForRandomPoints(random,
      [&](double u, double v, double w)
      {
        const double fp = f(u, v, w);
        const double gp = g(u, v, w);
        EXPECT_NEAR(sum(u, v, w), fp + gp, tolerance);
        EXPECT_NEAR(difference(u, v, w), fp - gp, tolerance);
        EXPECT_NEAR(product(u, v, w), fp * gp, tolerance);
        EXPECT_NEAR(scaled(u, v, w), -2.5 * fp, tolerance);
        EXPECT_NEAR(elevated(u, v, w), fp, tolerance);
        std::array<double, 3> at{ u, v, w };
        double& x = at[static_cast<std::size_t>(direction)];
        const bool second = x > t;
        x = second ? (x - t) / (1 - t) : x / t;
        // Parameters are rounded as well, and slopes are up to 2 degree.
        EXPECT_NEAR(parts[second ? 1 : 0](at[0], at[1], at[2]), fp, 2 * tolerance);
      });
  }
}

TEST(Bernstein, ProductRuleHolds)
{
  std::mt19937 random(2);
  const Bernstein f = RandomPolynomial(random, { 3, 2, 4 });
  const Bernstein g = RandomPolynomial(random, { 2, 5, 1 });
  for (int d = 0; d < 3; ++d)
  {
    const Bernstein zero = (f * g).Derivative(d) - (f.Derivative(d) * g + f * g.Derivative(d));
    EXPECT_LE(std::max(zero.Max(), -zero.Min()), zero.RoundingBound());
    // The bound is no excuse: it is small itself.
    EXPECT_LT(zero.RoundingBound(), 1e-12);
  }
}

TEST(Bernstein, DerivativeOfDegreeZeroIsZero)
{
  std::mt19937 random(3);
  const Bernstein zero = RandomPolynomial(random, { 2, 0, 1 }).Derivative(1);
  EXPECT_EQ(zero.Min(), 0.0);
  EXPECT_EQ(zero.Max(), 0.0);
}

TEST(Bernstein, CoefficientsBoundTheValues)
{
  std::mt19937 random(4);
  Bernstein f = RandomPolynomial(random, { 4, 3, 5 });
  const double corner = f.Coefficients()[0];
  EXPECT_EQ(f(0, 0, 0), corner);
  // Subdivision tightens the hull and never loses a value.
  for (int level = 0; level < 6; ++level)
  {
    ForRandomPoints(random,
      [&f](double u, double v, double w)
      {
        EXPECT_GE(f(u, v, w), f.Min() - 50 * Epsilon);
        EXPECT_LE(f(u, v, w), f.Max() + 50 * Epsilon);
      });
    const Bernstein half = f.Split(level % 3)[level % 2];
    EXPECT_LE(half.Max(), f.Max() + half.RoundingBound());
    EXPECT_GE(half.Min(), f.Min() - half.RoundingBound());
    f = half;
  }
}

TEST(Bernstein, ElevationAndSplitCommute)
{
  std::mt19937 random(5);
  const Bernstein f = RandomPolynomial(random, { 3, 2, 2 });
  const Bernstein zero = f.Elevate(0, 9).Split(0, 0.25)[1] - f.Split(0, 0.25)[1].Elevate(0, 9);
  EXPECT_LE(std::max(zero.Max(), -zero.Min()), zero.RoundingBound());
}

TEST(Bernstein, RoundingBoundCoversProductsOfIntegers)
{
  // Binomially scaled integer coefficients multiply without rounding: (a^ * b^)_k is exact, and its
  // quotient by C(p + q, k) is known to half an ulp in extended precision.
  std::mt19937 random(6);
  for (int p : { 2, 9, 30, 60 })
  {
    const Eigen::VectorXd a = RandomIntegers(random, p + 1, 1, -1000, 1000);
    const Eigen::VectorXd b = RandomIntegers(random, p + 1, 1, -1000, 1000);
    const Bernstein product = Bernstein({ p, 0, 0 }, a) * Bernstein({ p, 0, 0 }, b);
    std::vector<std::vector<long double>> c(2 * p + 1, std::vector<long double>(2 * p + 1, 1.0L));
    for (int n = 1; n <= 2 * p; ++n)
    {
      for (int k = 1; k < n; ++k)
      {
        c[n][k] = c[n - 1][k - 1] + c[n - 1][k];
      }
    }
    for (int k = 0; k <= 2 * p; ++k)
    {
      long double sum = 0;
      for (int i = std::max(0, k - p); i <= std::min(k, p); ++i)
      {
        sum += c[p][i] * a[i] * c[p][k - i] * b[k - i];
      }
      EXPECT_LE(std::abs(static_cast<double>(product.Coefficients()[k] - sum / c[2 * p][k])),
        product.RoundingBound());
    }
    EXPECT_LT(product.RoundingBound(), 1e6 * 500 * Epsilon);
  }
}

TEST(Bernstein, RefusesWhatDoesNotFit)
{
  EXPECT_THROW(Bernstein({ -1, 0, 0 }, Eigen::VectorXd(0)), Error);
  EXPECT_THROW(Bernstein({ 128, 0, 0 }, Eigen::VectorXd::Zero(129)), Error);
  EXPECT_THROW(Bernstein({ 1, 1, 1 }, Eigen::VectorXd::Zero(7)), Error);
  const Bernstein f({ 100, 0, 0 }, Eigen::VectorXd::Zero(101));
  EXPECT_THROW(static_cast<void>(f * f), Error);
  EXPECT_THROW(static_cast<void>(f.Elevate(0, 99)), Error);
  EXPECT_THROW(static_cast<void>(f.Elevate(0, 128)), Error);
  EXPECT_THROW(static_cast<void>(f.Split(0, 1.5)), Error);
  EXPECT_THROW(static_cast<void>(f.Split(0, NAN)), Error);
}

TEST(JacobianDeterminant, AgreesWithTheEvaluatorsDerivatives)
{
  std::mt19937 random(7);
  for (int round = 0; round < 40; ++round)
  {
    const bool rational = round % 2 == 1;
    std::array<KnotVector, 3> knots;
    for (KnotVector& k : knots)
    {
      const int degree = 1 + static_cast<int>(random() % 4);
      k = models::RandomKnots(random, degree, degree + 3, random() % 2 == 0);
    }
    const Spline spline = models::RandomSpline(random, knots, 3, rational);
    const Evaluator evaluator(spline);
    std::array<int, 3> spans;
    double volume = 1.0;
    std::array<double, 3> low;
    std::array<double, 3> length;
    for (std::size_t d = 0; d < 3; ++d)
    {
      spans[d] = static_cast<int>(random() % knots[d].Spans().size());
      const int s = knots[d].Spans()[static_cast<std::size_t>(spans[d])];
      low[d] = knots[d][s];
      length[d] = knots[d][s + 1] - knots[d][s];
      volume *= length[d];
    }
    Eigen::MatrixXd points;
    BezierExtractor(spline).Extract(spans, points);
    const Bernstein j = JacobianDeterminant(points, spline.Degrees(), rational);
    for (std::size_t d = 0; d < 3; ++d)
    {
      const int p = knots[d].Degree();
      EXPECT_EQ(j.Degrees()[d], rational ? 4 * p - 2 : 3 * p - 1);
    }
    Bernstein weight({ 0, 0, 0 }, Eigen::VectorXd::Ones(1));
    if (rational)
    {
      weight = Bernstein(spline.Degrees(), points.row(3).transpose());
    }
    const double scale = std::max(j.Max(), -j.Min());
    ForRandomPoints(random,
      [&](double u, double v, double w)
      {
        const double parameters[3] = { low[0] + u * length[0], low[1] + v * length[1],
          low[2] + w * length[2] };
        double value[3];
        Eigen::Matrix3d derivatives;
        evaluator.EvaluateWithDerivatives(1, parameters, value, derivatives.data());
        EXPECT_NEAR(j(u, v, w), derivatives.determinant() * volume * std::pow(weight(u, v, w), 4),
          2000 * Epsilon * scale);
      });
  }
}

TEST(JacobianDeterminant, RoundingBoundCoversExtendedPrecision)
{
  std::mt19937 random(8);
  for (int round = 0; round < 20; ++round)
  {
    const bool rational = round % 2 == 1;
    const std::array<int, 3> degrees{ 1 + round % 3, 1 + round / 3 % 3, 2 };
    const int n = (degrees[0] + 1) * (degrees[1] + 1) * (degrees[2] + 1);
    // Far from the origin, where determinants of homogeneous columns cancel.
    Eigen::MatrixXd points = RandomIntegers(random, rational ? 4 : 3, n, 1000, 1010);
    if (rational)
    {
      points.row(3) = RandomIntegers(random, 1, n, 1, 4);
      points.topRows(3).array().rowwise() *= points.row(3).array();
    }
    const Bernstein j = JacobianDeterminant(points, degrees, rational);
    EXPECT_LT(j.RoundingBound(), (rational ? 1e-8 : 1e-11) * std::max(j.Max(), -j.Min()));
    const std::vector<long double> c(j.Coefficients().begin(), j.Coefficients().end());
    ForRandomPoints(random,
      [&](double u, double v, double w)
      {
        const std::array<long double, 3> at{ u, v, w };
        // Values are convex combinations of coefficients, so that the bound holds for them too.
        const long double error =
          EvaluateLong(j.Degrees(), c, at) - JacobianLong(points, degrees, at);
        EXPECT_LE(std::abs(static_cast<double>(error)), j.RoundingBound());
      });
  }
}

TEST(JacobianDeterminant, BoundCoversErrorsOfThePoints)
{
  std::mt19937 random(9);
  const double error = 1e-6;
  for (bool rational : { false, true })
  {
    Eigen::MatrixXd points = RandomIntegers(random, rational ? 4 : 3, 18, 1, 5);
    const Bernstein exact = JacobianDeterminant(points, { 2, 1, 2 }, rational);
    points += error * RandomIntegers(random, rational ? 4 : 3, 18, -1, 1);
    const Bernstein moved = JacobianDeterminant(points, { 2, 1, 2 }, rational, error);
    const double distance = (moved.Coefficients() - exact.Coefficients()).lpNorm<Eigen::Infinity>();
    EXPECT_LE(distance, moved.RoundingBound() + exact.RoundingBound());
    EXPECT_GT(distance, exact.RoundingBound());
  }
}

TEST(JacobianDeterminant, IsOneForTheUnitCube)
{
  Eigen::MatrixXd points(3, 8);
  for (int i = 0; i < 8; ++i)
  {
    points.col(i) << i % 2, i / 2 % 2, i / 4;
  }
  const Bernstein j = JacobianDeterminant(points, { 1, 1, 1 }, false);
  EXPECT_EQ(j.Min(), 1.0);
  EXPECT_EQ(j.Max(), 1.0);
}

TEST(JacobianDeterminant, OfTheSweptHalfCylinderChangesSignAtOneHalf)
{
  const Spline spline = models::SweptHalfCylinder();
  Eigen::MatrixXd points;
  BezierExtractor(spline).Extract({ 0, 0, 0 }, points);
  const Bernstein j = JacobianDeterminant(points, spline.Degrees(), true);
  const auto parts = j.Split(0, 0.5);
  // The plane u = 1/2 itself is zero to the bound, everything on either side has one sign.
  const auto isOnPlane = [&j](Eigen::Index i, int column)
  { return i % (j.Degrees()[0] + 1) == column; };
  double before = 0.0;
  double after = 0.0;
  for (Eigen::Index i = 0; i < j.Coefficients().size(); ++i)
  {
    const double first = parts[0].Coefficients()[i];
    const double second = parts[1].Coefficients()[i];
    if (isOnPlane(i, j.Degrees()[0]))
    {
      EXPECT_LE(std::abs(first), parts[0].RoundingBound());
    }
    else
    {
      EXPECT_GT(std::abs(first), parts[0].RoundingBound());
      EXPECT_GE(first * before, 0.0);
      before = first;
    }
    if (isOnPlane(i, 0))
    {
      EXPECT_LE(std::abs(second), parts[1].RoundingBound());
    }
    else
    {
      EXPECT_GT(std::abs(second), parts[1].RoundingBound());
      EXPECT_GE(second * after, 0.0);
      after = second;
    }
  }
  EXPECT_LT(before * after, 0.0);
}

TEST(JacobianDeterminant, RefusesWhatIsNoVolume)
{
  EXPECT_THROW(
    static_cast<void>(JacobianDeterminant(Eigen::MatrixXd(3, 4), { 1, 1, 0 }, false)), Error);
  EXPECT_THROW(
    static_cast<void>(JacobianDeterminant(Eigen::MatrixXd(3, 8), { 1, 1, 1 }, true)), Error);
  EXPECT_THROW(
    static_cast<void>(JacobianDeterminant(Eigen::MatrixXd(3, 7), { 1, 1, 1 }, false)), Error);
}
