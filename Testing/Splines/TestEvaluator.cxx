// SPDX-License-Identifier: BSD-3-Clause
#include "Error.h"
#include "Evaluator.h"
#include "EvaluatorKernel.h"
#include "RefinementEvaluation.h"
#include "Splines/Models.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <complex>
#include <cstdlib>
#include <limits>
#include <string>

using namespace hyperpatch;

namespace
{

constexpr double Eps = std::numeric_limits<double>::epsilon();
constexpr double NaN = std::numeric_limits<double>::quiet_NaN();

// Evaluators that are made during the life of one of these use the named instruction set.
class UseInstructionSet
{
public:
  explicit UseInstructionSet(const char* name) { ::setenv("HYPERPATCH_INSTRUCTION_SET", name, 1); }
  ~UseInstructionSet() { ::unsetenv("HYPERPATCH_INSTRUCTION_SET"); }
  UseInstructionSet(const UseInstructionSet&) = delete;
  UseInstructionSet& operator=(const UseInstructionSet&) = delete;
};

class EvaluatorWith : public testing::TestWithParam<const char*>
{
  UseInstructionSet Use{ GetParam() };
};

std::vector<const char*> InstructionSets()
{
  const EvaluatorKernels* kernels[3];
  std::vector<const char*> names;
  for (int i = 0, count = AvailableEvaluatorKernels(kernels); i < count; ++i)
  {
    names.push_back(kernels[i]->Name);
  }
  return names;
}

INSTANTIATE_TEST_SUITE_P(EveryInstructionSet, EvaluatorWith, testing::ValuesIn(InstructionSets()),
  [](const testing::TestParamInfo<const char*>& test) { return std::string(test.param); });

// m x n, 3m x n and 6m x n.
struct Results
{
  Eigen::MatrixXd Values;
  Eigen::MatrixXd First;
  Eigen::MatrixXd Second;
};

Results EvaluateAll(const Evaluator& evaluator, const Eigen::Matrix3Xd& parameters)
{
  const Eigen::Index m = evaluator.Components();
  const Eigen::Index n = parameters.cols();
  Results r{ Eigen::MatrixXd(m, n), Eigen::MatrixXd(3 * m, n), Eigen::MatrixXd(6 * m, n) };
  evaluator.EvaluateWithSecondDerivatives(static_cast<std::size_t>(n), parameters.data(),
    r.Values.data(), r.First.data(), r.Second.data());
  return r;
}

// The values, first and second derivatives by another road: the basis functions in complex
// arithmetic, their first derivatives from the next lower degree, the second derivatives from a
// complex step (Squire & Trapp 1998), which has no cancellation.
using Complex = std::complex<double>;

void ComplexBasis(const KnotVector& knots, Complex t, std::vector<Complex>* rows)
{
  const int p = knots.Degree();
  const int span = knots.FindSpan(t.real());
  std::vector<Complex> lower;
  std::vector<Complex> n(1, 1.0);
  for (int r = 1; r <= p; ++r)
  {
    lower = n;
    n.assign(static_cast<std::size_t>(r) + 1, 0.0);
    for (int j = 0; j < r; ++j)
    {
      const double low = knots[span + j + 1 - r];
      const double high = knots[span + j + 1];
      n[static_cast<std::size_t>(j)] +=
        (high - t) / (high - low) * lower[static_cast<std::size_t>(j)];
      n[static_cast<std::size_t>(j) + 1] =
        (t - low) / (high - low) * lower[static_cast<std::size_t>(j)];
    }
  }
  rows[0] = n;
  rows[1].assign(n.size(), 0.0);
  for (int j = 0; j < p; ++j)
  {
    const Complex slope =
      p / (knots[span + j + 1] - knots[span + j + 1 - p]) * lower[static_cast<std::size_t>(j)];
    rows[1][static_cast<std::size_t>(j)] -= slope;
    rows[1][static_cast<std::size_t>(j) + 1] += slope;
  }
}

// m x 4: value, d/du, d/dv, d/dw, each with an infinitesimal imaginary step in one direction.
Eigen::MatrixXcd ComplexPoint(
  const Spline& spline, const Eigen::MatrixXd& points, std::array<Complex, 3> t)
{
  std::vector<Complex> basis[3][2];
  std::array<int, 3> first;
  for (int d = 0; d < 3; ++d)
  {
    const auto i = static_cast<std::size_t>(d);
    const KnotVector& k = spline.Knots(d);
    t[i].real(std::clamp(t[i].real(), k.First(), k.Last()));
    first[i] = k.FindSpan(t[i].real()) - k.Degree();
    ComplexBasis(k, t[i], basis[d]);
  }
  const std::array<int, 3> size = spline.Sizes();
  Eigen::MatrixXcd sums = Eigen::MatrixXcd::Zero(points.rows(), 4);
  for (std::size_t c = 0; c < basis[2][0].size(); ++c)
  {
    for (std::size_t b = 0; b < basis[1][0].size(); ++b)
    {
      for (std::size_t a = 0; a < basis[0][0].size(); ++a)
      {
        const Eigen::Index i = first[0] + static_cast<int>(a) +
          size[0] * (first[1] + static_cast<int>(b) + size[1] * (first[2] + static_cast<int>(c)));
        for (int r = 0; r < 4; ++r)
        {
          sums.col(r) +=
            basis[0][r == 1][a] * basis[1][r == 2][b] * basis[2][r == 3][c] * points.col(i);
        }
      }
    }
  }
  if (!spline.IsRational())
  {
    return sums;
  }
  const Eigen::Index m = spline.Components();
  Eigen::MatrixXcd result(m, 4);
  result.col(0) = sums.col(0).head(m) / sums(m, 0);
  for (int r = 1; r < 4; ++r)
  {
    result.col(r) = (sums.col(r).head(m) - result.col(0) * sums(m, r)) / sums(m, 0);
  }
  return result;
}

Results ComplexResults(const Spline& spline, const Eigen::Matrix3Xd& parameters)
{
  constexpr double step = 1e-40;
  constexpr int column[3][3] = { { 0, 1, 2 }, { 1, 3, 4 }, { 2, 4, 5 } };
  const Eigen::Index m = spline.Components();
  const Eigen::Index n = parameters.cols();
  const Eigen::MatrixXd points = spline.Homogeneous();
  Results r{ Eigen::MatrixXd(m, n), Eigen::MatrixXd(3 * m, n), Eigen::MatrixXd(6 * m, n) };
  for (Eigen::Index q = 0; q < n; ++q)
  {
    for (int j = 0; j < 3; ++j)
    {
      std::array<Complex, 3> t{ parameters(0, q), parameters(1, q), parameters(2, q) };
      t[static_cast<std::size_t>(j)].imag(step);
      const Eigen::MatrixXcd point = ComplexPoint(spline, points, t);
      r.Values.col(q) = point.col(0).real();
      r.First.col(q).segment(j * m, m) = point.col(0).imag() / step;
      for (int i = 0; i <= j; ++i)
      {
        r.Second.col(q).segment(column[i][j] * m, m) = point.col(i + 1).imag() / step;
      }
    }
  }
  return r;
}

// Random points, and every combination of a few breaks.
Eigen::Matrix3Xd SomeParameters(std::mt19937& random, const Spline& spline, int count)
{
  Eigen::Matrix3Xd parameters(3, count);
  for (int q = 0; q < count; ++q)
  {
    for (int d = 0; d < 3; ++d)
    {
      const KnotVector& k = spline.Knots(d);
      const std::vector<double> breaks = k.Breaks();
      std::uniform_real_distribution<double> inside(k.First(), k.Last());
      parameters(d, q) = random() % 4 == 0 ? breaks[random() % breaks.size()] : inside(random);
    }
  }
  return parameters;
}

// Splines of all kinds. Every second one has the same degree in all directions.
std::vector<Spline> SomeSplines()
{
  std::mt19937 random(7);
  std::vector<Spline> splines;
  for (int i = 0; i < 96; ++i)
  {
    std::array<int, 3> degrees;
    for (int& degree : degrees)
    {
      degree = i % 2 == 0 ? i / 2 % 7 : static_cast<int>(random() % (i % 4 == 1 ? 6 : 16));
    }
    std::array<KnotVector, 3> knots;
    for (std::size_t d = 0; d < 3; ++d)
    {
      const int p = degrees[d];
      if (p > 0)
      {
        // Without clamping, p repeated knots must not cover the domain.
        const bool clamped = p > 5 || random() % 2 == 0;
        const int size = (clamped ? p + 1 : 2 * p) + static_cast<int>(random() % 5);
        knots[d] = models::RandomKnots(random, p, size, clamped);
      }
    }
    splines.push_back(
      models::RandomSpline(random, knots, 1 + static_cast<int>(random() % 7), random() % 2 == 0));
  }
  return splines;
}

testing::Message NameOf(const Spline& spline)
{
  const std::array<int, 3> p = spline.Degrees();
  return testing::Message() << "degrees " << p[0] << ' ' << p[1] << ' ' << p[2] << ", components "
                            << spline.Components() << ", rational " << spline.IsRational();
}

int SumOfDegrees(const Spline& spline)
{
  const std::array<int, 3> p = spline.Degrees();
  return p[0] + p[1] + p[2];
}

// Bound of a derivative of the basis: every differentiation multiplies by at most 2 p over the
// smallest support of a function of the next lower degree, here at least 0.2, the smallest step of
// RandomKnots.
double Slope(const KnotVector& knots)
{
  return 2.0 * knots.Degree() / 0.2;
}

// Rounding of a sum of products of three basis functions: each has a relative error of a few eps
// per degree; weights in [0.5, 2] multiply the error of a quotient by up to 4, of its derivatives
// by up to 4 each more.
double ValueTolerance(const Spline& spline)
{
  return (spline.IsRational() ? 4.0 : 1.0) * 4.0 * (SumOfDegrees(spline) + 1) * Eps;
}

void ExpectNear(const Spline& spline, const Results& actual, const Results& expected)
{
  const double growth = spline.IsRational() ? 8.0 : 1.0;
  const Eigen::Index m = spline.Components();
  const double tolerance = ValueTolerance(spline);
  for (Eigen::Index q = 0; q < actual.Values.cols(); ++q)
  {
    ASSERT_LE((actual.Values - expected.Values).col(q).cwiseAbs().maxCoeff(), tolerance);
    for (int i = 0, r = 0; i < 3; ++i)
    {
      const double first = growth * Slope(spline.Knots(i));
      ASSERT_LE((actual.First - expected.First).col(q).segment(i * m, m).cwiseAbs().maxCoeff(),
        first * tolerance);
      for (int j = i; j < 3; ++j, ++r)
      {
        ASSERT_LE((actual.Second - expected.Second).col(q).segment(r * m, m).cwiseAbs().maxCoeff(),
          first * growth * Slope(spline.Knots(j)) * tolerance);
      }
    }
  }
}

bool Same(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b)
{
  return a.rows() == b.rows() && a.cols() == b.cols() && (a.array() == b.array()).all();
}

}

TEST_P(EvaluatorWith, QuarterTubeKeepsItsRadius)
{
  const Evaluator evaluator(models::QuarterTube());
  std::mt19937 random(3);
  const Eigen::Matrix3Xd parameters = SomeParameters(random, models::QuarterTube(), 2000);
  const Results r = EvaluateAll(evaluator, parameters);
  for (Eigen::Index q = 0; q < parameters.cols(); ++q)
  {
    const double radius = 1.0 + parameters(0, q);
    ASSERT_NEAR(r.Values.col(q).head<2>().norm(), radius, 1e-14);
    ASSERT_NEAR(r.Values(2, q), parameters(2, q), 1e-15);
    // Radial, tangential, axial.
    ASSERT_NEAR(r.First.col(q).head<2>().norm(), 1.0, 1e-14);
    ASSERT_NEAR(r.First.col(q).segment<2>(3).dot(r.Values.col(q).head<2>()), 0.0, 1e-13);
    ASSERT_NEAR(r.First(8, q), 1.0, 1e-14);
  }
}

TEST_P(EvaluatorWith, AgreesWithComplexArithmetic)
{
  std::mt19937 random(11);
  for (const Spline& spline : SomeSplines())
  {
    SCOPED_TRACE(NameOf(spline));
    const Eigen::Matrix3Xd parameters = SomeParameters(random, spline, 12);
    ExpectNear(
      spline, EvaluateAll(Evaluator(spline), parameters), ComplexResults(spline, parameters));
    if (HasFatalFailure())
    {
      return;
    }
  }
}

TEST_P(EvaluatorWith, AgreesWithSplineAndRefinement)
{
  std::mt19937 random(12);
  for (const Spline& spline : SomeSplines())
  {
    const Eigen::Matrix3Xd parameters = SomeParameters(random, spline, 12);
    const Results r = EvaluateAll(Evaluator(spline), parameters);
    const double tolerance = ValueTolerance(spline);
    const Eigen::Index m = spline.Components();
    for (Eigen::Index q = 0; q < parameters.cols(); ++q)
    {
      const Eigen::Vector3d t = parameters.col(q);
      const Eigen::VectorXd value = spline.Evaluate(t[0], t[1], t[2]);
      ASSERT_LE((r.Values.col(q) - value).cwiseAbs().maxCoeff(), tolerance);
      const PointWithPartials reference = EvaluateByRefinement(spline, t[0], t[1], t[2]);
      ASSERT_LE((r.Values.col(q) - reference.Value).cwiseAbs().maxCoeff(), tolerance);
      for (int d = 0; d < 3; ++d)
      {
        // The reference divides a difference of control points by the distance to the next knot.
        const KnotVector& k = spline.Knots(d);
        const double high = k[k.FindSpan(t[d]) + 1];
        const double distance = t[d] < high ? high - t[d] : 0.2;
        const double slope = Slope(k) + 2.0 * k.Degree() / distance;
        ASSERT_LE(
          (r.First.col(q).segment(d * m, m) - reference.Partials.col(d)).cwiseAbs().maxCoeff(),
          (spline.IsRational() ? 8.0 : 1.0) * slope * tolerance);
      }
    }
  }
}

TEST_P(EvaluatorWith, ReproducesOneAndTheParameter)
{
  std::mt19937 random(13);
  for (int p = 1; p <= MaxDegree; ++p)
  {
    const KnotVector knots = models::RandomKnots(random, p, 2 * p + 3, p % 2 == 0);
    Eigen::MatrixXd points(2, knots.Size());
    for (int i = 0; i < knots.Size(); ++i)
    {
      double greville = 0.0;
      for (int j = 1; j <= p; ++j)
      {
        greville += knots[i + j] / p;
      }
      points.col(i) << 1.0, greville;
    }
    for (int direction = 0; direction < 3; ++direction)
    {
      std::array<KnotVector, 3> all;
      all[static_cast<std::size_t>(direction)] = knots;
      const Spline spline(all, points);
      const Eigen::Matrix3Xd parameters = SomeParameters(random, spline, 20);
      const Results r = EvaluateAll(Evaluator(spline), parameters);
      // Each basis function has a relative error of a few eps per degree. The coefficients of the
      // second component are as large as the last knot.
      const double tolerance = 4.0 * (p + 1) * Eps;
      const double scale = knots[knots.Size() + p];
      for (Eigen::Index q = 0; q < parameters.cols(); ++q)
      {
        ASSERT_NEAR(r.Values(0, q), 1.0, tolerance);
        ASSERT_NEAR(r.Values(1, q), parameters(direction, q), scale * tolerance);
        ASSERT_NEAR(r.First(2 * direction, q), 0.0, Slope(knots) * tolerance);
        ASSERT_NEAR(r.First(2 * direction + 1, q), 1.0, Slope(knots) * scale * tolerance);
      }
    }
  }
}

TEST_P(EvaluatorWith, BatchesAndGridsAgreeBitwise)
{
  std::mt19937 random(14);
  for (const Spline& spline : SomeSplines())
  {
    SCOPED_TRACE(NameOf(spline));
    const Evaluator evaluator(spline);
    const Eigen::Matrix3Xd some = SomeParameters(random, spline, 5);
    std::array<std::vector<double>, 3> lists;
    for (std::size_t d = 0; d < 3; ++d)
    {
      lists[d].assign(some.row(static_cast<Eigen::Index>(d)).begin(),
        some.row(static_cast<Eigen::Index>(d)).end() - static_cast<int>(d));
      std::sort(lists[d].begin(), lists[d].end());
    }
    Eigen::Matrix3Xd parameters(3, 5 * 4 * 3);
    Eigen::Index q = 0;
    for (double w : lists[2])
    {
      for (double v : lists[1])
      {
        for (double u : lists[0])
        {
          parameters.col(q++) << u, v, w;
        }
      }
    }
    const Results batch = EvaluateAll(evaluator, parameters);
    const Eigen::Index m = spline.Components();

    Eigen::MatrixXd values(m, q);
    Eigen::MatrixXd first(3 * m, q);
    evaluator.EvaluateGrid(lists, values.data());
    ASSERT_TRUE(Same(values, batch.Values));
    values.setZero();
    evaluator.EvaluateGrid(lists, values.data(), first.data());
    ASSERT_TRUE(Same(values, batch.Values));
    ASSERT_TRUE(Same(first, batch.First));

    evaluator.Evaluate(static_cast<std::size_t>(q), parameters.data(), values.data());
    ASSERT_TRUE(Same(values, batch.Values));
    evaluator.EvaluateWithDerivatives(
      static_cast<std::size_t>(q), parameters.data(), values.data(), first.data());
    ASSERT_TRUE(Same(values, batch.Values));
    ASSERT_TRUE(Same(first, batch.First));
    for (Eigen::Index i = 0; i < q; ++i)
    {
      const Results one = EvaluateAll(evaluator, parameters.col(i));
      ASSERT_TRUE(Same(one.Values, batch.Values.col(i)));
      ASSERT_TRUE(Same(one.First, batch.First.col(i)));
      ASSERT_TRUE(Same(one.Second, batch.Second.col(i)));
    }
  }
}

TEST_P(EvaluatorWith, WritesNothingBesideItsOutput)
{
  std::mt19937 random(15);
  for (const Spline& spline : SomeSplines())
  {
    const Evaluator evaluator(spline);
    const auto m = static_cast<std::size_t>(spline.Components());
    const Eigen::Matrix3Xd parameters = SomeParameters(random, spline, 2);
    std::vector<double> values(2 * m + 8, -7.0);
    std::vector<double> first(6 * m + 8, -7.0);
    std::vector<double> second(12 * m + 8, -7.0);
    evaluator.EvaluateWithSecondDerivatives(
      2, parameters.data(), values.data(), first.data(), second.data());
    EXPECT_EQ(std::count(values.end() - 8, values.end(), -7.0), 8);
    EXPECT_EQ(std::count(first.end() - 8, first.end(), -7.0), 8);
    EXPECT_EQ(std::count(second.end() - 8, second.end(), -7.0), 8);
  }
}

TEST_P(EvaluatorWith, InstructionSetsAgree)
{
  std::mt19937 random(16);
  for (const Spline& spline : SomeSplines())
  {
    const Eigen::Matrix3Xd parameters = SomeParameters(random, spline, 12);
    const Results r = EvaluateAll(Evaluator(spline), parameters);
    const UseInstructionSet use("baseline");
    ExpectNear(spline, r, EvaluateAll(Evaluator(spline), parameters));
    if (HasFatalFailure())
    {
      return;
    }
  }
}

TEST_P(EvaluatorWith, ParametersOutsideMoveToTheBorder)
{
  std::mt19937 random(17);
  for (const Spline& spline : SomeSplines())
  {
    const Evaluator evaluator(spline);
    Eigen::Matrix3Xd outside(3, 4);
    Eigen::Matrix3Xd border(3, 4);
    for (int d = 0; d < 3; ++d)
    {
      const double first = spline.Knots(d).First();
      const double last = spline.Knots(d).Last();
      outside.row(d) << first - 1.0, last + 1.0, -std::numeric_limits<double>::infinity(),
        std::numeric_limits<double>::infinity();
      border.row(d) << first, last, first, last;
    }
    const Results a = EvaluateAll(evaluator, outside);
    const Results b = EvaluateAll(evaluator, border);
    ASSERT_TRUE(Same(a.Values, b.Values) && Same(a.First, b.First) && Same(a.Second, b.Second));
  }
}

TEST_P(EvaluatorWith, ClampedEndsAreControlPointsExactly)
{
  std::mt19937 random(18);
  for (int p = 1; p <= 9; ++p)
  {
    const KnotVector knots = models::RandomKnots(random, p, p + 3, true);
    const Spline spline = models::RandomSpline(random, { knots, knots, knots }, 3, false);
    const Evaluator evaluator(spline);
    Eigen::Vector3d value;
    const Eigen::Vector3d first(knots.First(), knots.First(), knots.First());
    evaluator.Evaluate(1, first.data(), value.data());
    EXPECT_EQ(value, spline.Coefficients().col(0));
    const Eigen::Vector3d last(knots.Last(), knots.Last(), knots.Last());
    evaluator.Evaluate(1, last.data(), value.data());
    EXPECT_EQ(value, spline.Coefficients().rightCols<1>());
  }
}

TEST_P(EvaluatorWith, CreasesGiveTheRightLimit)
{
  // |t - 1| on [0, 2].
  const Spline spline(
    { KnotVector(1, { 0, 0, 1, 2, 2 }), KnotVector(), KnotVector() }, Eigen::RowVector3d(1, 0, 1));
  Eigen::Matrix3Xd parameters = Eigen::Matrix3Xd::Zero(3, 4);
  parameters.row(0) << 0.0, std::nextafter(1.0, 0.0), 1.0, 2.0;
  const Results r = EvaluateAll(Evaluator(spline), parameters);
  EXPECT_EQ(r.First.row(0), Eigen::RowVector4d(-1, -1, 1, 1));
}

TEST_P(EvaluatorWith, NaNInAnyParameterGivesNaN)
{
  for (const Spline& spline : SomeSplines())
  {
    const Evaluator evaluator(spline);
    for (int d = 0; d < 3; ++d)
    {
      Eigen::Matrix3Xd parameters = Eigen::Matrix3Xd::Zero(3, 1);
      parameters(d, 0) = NaN;
      const Results r = EvaluateAll(evaluator, parameters);
      ASSERT_TRUE(r.Values.array().isNaN().all());
      std::array<std::vector<double>, 3> lists{ { { 0.0 }, { 0.0 }, { 0.0 } } };
      lists[static_cast<std::size_t>(d)][0] = NaN;
      Eigen::VectorXd values(spline.Components());
      evaluator.EvaluateGrid(lists, values.data());
      ASSERT_TRUE(values.array().isNaN().all());
    }
  }
}

TEST_P(EvaluatorWith, FindsSpansOfVeryUnevenKnots)
{
  std::vector<double> knots{ 0, 0, 0 };
  for (int i = -250; i <= 0; ++i)
  {
    knots.push_back(std::ldexp(1.0, i));
  }
  knots.insert(knots.end(), 2, 1.0);
  const KnotVector uneven(2, knots);
  std::mt19937 random(19);
  const Spline spline =
    models::RandomSpline(random, { uneven, KnotVector(), KnotVector() }, 1, false);
  const Evaluator evaluator(spline);
  for (int i = -255; i <= 1; ++i)
  {
    for (double t : { std::ldexp(1.0, i), std::ldexp(1.3, i), std::ldexp(1.9, i) })
    {
      const double parameters[3] = { t, 0.5, 0.5 };
      double value;
      evaluator.Evaluate(1, parameters, &value);
      ASSERT_NEAR(value, spline.Evaluate(t)[0], ValueTolerance(spline));
    }
  }
}

TEST(Evaluator, LargeLatticesAgreeWithTheDefinition)
{
  // More than 2 MiB of homogeneous points.
  std::mt19937 random(8);
  const std::array<KnotVector, 3> knots{ KnotVector::Uniform(3, 50), KnotVector::Uniform(2, 45),
    KnotVector::Uniform(1, 40) };
  const Spline spline = models::RandomSpline(random, knots, 3, true);
  const Evaluator evaluator(spline);
  const double scale = spline.Coefficients().cwiseAbs().maxCoeff();
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int i = 0; i < 100; ++i)
  {
    const Eigen::Vector3d u(unit(random), unit(random), i == 0 ? 1.0 : unit(random));
    Eigen::Vector3d x;
    evaluator.Evaluate(1, u.data(), x.data());
    // A sum of 24 terms.
    EXPECT_LE((x - spline.Evaluate(u[0], u[1], u[2])).cwiseAbs().maxCoeff(),
      100.0 * std::numeric_limits<double>::epsilon() * scale);
  }
}

TEST(Evaluator, ManyComponents)
{
  std::mt19937 random(20);
  const KnotVector knots = models::RandomKnots(random, 3, 6, true);
  for (int m : { 31, 100, 257 })
  {
    for (bool rational : { false, true })
    {
      const Spline spline = models::RandomSpline(random, { knots, knots, knots }, m, rational);
      const Eigen::Matrix3Xd parameters = SomeParameters(random, spline, 3);
      ExpectNear(
        spline, EvaluateAll(Evaluator(spline), parameters), ComplexResults(spline, parameters));
    }
  }
}

TEST(Evaluator, RefusesAnUnknownInstructionSet)
{
  const UseInstructionSet use("abacus");
  try
  {
    const Evaluator evaluator(models::QuarterTube());
    FAIL() << "no error";
  }
  catch (const Error& error)
  {
    EXPECT_NE(std::string(error.what()).find("\"abacus\""), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("baseline"), std::string::npos);
  }
}

TEST(Evaluator, EmptyBatchesAndGridsAreFine)
{
  const Evaluator evaluator(models::QuarterTube());
  evaluator.Evaluate(0, nullptr, nullptr);
  evaluator.EvaluateGrid({ { { 0.5 }, {}, { 0.5 } } }, nullptr);
}
