// SPDX-License-Identifier: BSD-3-Clause
#include "Bernstein.h"
#include "DeterminantBatchWorker.h"
#include "ExactPolynomial.h"
#include "ValidityTest.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

// Determinants, their bounds and verdicts against integers of 1024 bits: nothing here is rounded.

using namespace hyperpatch;

namespace
{

using Degrees = std::array<int, 3>;

Eigen::Index Count(const Degrees& p)
{
  return static_cast<Eigen::Index>(p[0] + 1) * (p[1] + 1) * (p[2] + 1);
}

/// Bezier points of a volume that is near a lattice, flat in one direction or crooked, near the
/// origin or far from it: homogeneous, with `rows` coordinates.
Eigen::MatrixXd RandomPoints(std::mt19937& random, const Degrees& p, int rows, int kind)
{
  std::uniform_real_distribution<double> move(-1.0, 1.0);
  const double noise = kind % 2 == 0 ? 0.4 : 1.5;
  const double flat = kind / 2 % 2 == 0 ? 1.0 : 1e-6;
  const double far = kind / 4 % 2 == 0 ? 0.0 : 512.0;
  Eigen::MatrixXd points(rows, Count(p));
  for (Eigen::Index n = 0; n < points.cols(); ++n)
  {
    Eigen::Vector3d x(static_cast<double>(n % (p[0] + 1)),
      static_cast<double>(n / (p[0] + 1) % (p[1] + 1)),
      static_cast<double>(n / (p[0] + 1) / (p[1] + 1)));
    x += noise * Eigen::Vector3d(move(random), move(random), move(random));
    x[2] *= flat;
    x.array() += far;
    const double weight = rows == 4 ? std::exp(1.5 * move(random)) : 1.0;
    points.col(n).head<3>() = weight * x;
    if (rows == 4)
    {
      points(3, n) = weight;
    }
  }
  return points.unaryExpr([](double value) { return exact::Rounded(value); });
}

/// Every coefficient is as near to that of exact arithmetic as the bound says.
/// \param shift the truth is multiplied by 2^shift
void ExpectWithin(const Degrees& degrees, const Eigen::VectorXd& coefficients, double bound,
  const exact::Polynomial& truth, int shift)
{
  ASSERT_EQ(degrees, truth.Degrees);
  const exact::Polynomial computed(degrees, coefficients, shift);
  const exact::Integer allowed = exact::Integer::FromDouble(bound, shift);
  truth.ForAll(
    [&](int i, int j, int k)
    {
      const std::size_t at = truth.Index(i, j, k);
      const exact::Integer error = computed.Scaled[at] - truth.Scaled[at];
      const exact::Integer limit = allowed * truth.Binomials(i, j, k);
      ASSERT_TRUE(-limit <= error && error <= limit) << i << ' ' << j << ' ' << k;
    });
}

const std::vector<Degrees> Shapes{ { 1, 1, 1 }, { 2, 1, 1 }, { 2, 2, 2 }, { 1, 3, 2 },
  { 3, 3, 3 } };

}

TEST(ExactDeterminant, IntegersAreExact)
{
  using exact::Integer;
  // (2^300 + 1)(2^300 - 1) = 2^600 - 1, and signs.
  const Integer power = Integer::FromDouble(std::ldexp(1.0, 300), 0);
  const Integer one(1);
  EXPECT_EQ((power + one) * (power - one), power * power - one);
  EXPECT_EQ((power + one) * (one - power), one - power * power);
  EXPECT_EQ(Integer::FromDouble(-0.375, 3), Integer(-3));
  EXPECT_EQ(Integer::FromDouble(std::ldexp(0.1, 400), 60).Sign(), 1);
  EXPECT_TRUE(Integer(-5) < Integer(3) && !(Integer(3) < Integer(-5)));
  EXPECT_THROW((void)Integer::FromDouble(0.375, 2), std::domain_error);
  EXPECT_THROW((void)(power * power * power * power), std::overflow_error);
}

TEST(ExactDeterminant, PolynomialCoefficientsAreWithinTheirBound)
{
  constexpr int shift = 3 * exact::PointShift;
  std::mt19937 random(1);
  for (const Degrees& p : Shapes)
  {
    DeterminantBatch batch(p);
    for (int kind = 0; kind < 8; ++kind)
    {
      const Eigen::MatrixXd points = RandomPoints(random, p, 3, kind);
      const exact::Polynomial truth = exact::Determinant(p, points);
      const Bernstein j = JacobianDeterminant(points, p, false);
      ExpectWithin(j.Degrees(), j.Coefficients(), j.RoundingBound(), truth, shift);

      const double* from = points.data();
      batch(1, &from);
      Eigen::VectorXd coefficients(j.Coefficients().size());
      batch.Copy(0, coefficients.data());
      ExpectWithin(j.Degrees(), coefficients, batch.Error(0, 0.0), truth, shift);
    }
  }
}

TEST(ExactDeterminant, RationalCoefficientsAreWithinTheirBound)
{
  constexpr int shift = 4 * exact::PointShift;
  std::mt19937 random(2);
  for (const Degrees& p : Shapes)
  {
    for (int kind = 0; kind < (p[0] * p[1] * p[2] < 20 ? 8 : 2); ++kind)
    {
      const Eigen::MatrixXd points = RandomPoints(random, p, 4, kind);
      const Bernstein j = JacobianDeterminant(points, p, true);
      ExpectWithin(j.Degrees(), j.Coefficients(), j.RoundingBound(),
        exact::HomogeneousDeterminant(p, points), shift);
    }
  }
}

// Verdicts, witnesses and enclosures of the least and greatest det J against its exact values on a
// grid: W^4 det J / W^4, both integers.
TEST(ExactDeterminant, VerdictsAndBoundsHoldTheExactValues)
{
  constexpr int steps = 4;
  std::mt19937 random(3);
  int verdicts[2] = { 0, 0 };
  for (int round = 0; round < 60; ++round)
  {
    const Degrees p = Shapes[static_cast<std::size_t>(round % 4)];
    const bool rational = round % 3 != 0;
    const Eigen::MatrixXd points = RandomPoints(random, p, rational ? 4 : 3, round % 8);
    exact::Polynomial j =
      rational ? exact::HomogeneousDeterminant(p, points) : exact::Determinant(p, points);
    exact::Polynomial w4({ 0, 0, 0 });
    w4.Scaled[0] = exact::Integer(1);
    if (rational)
    {
      const exact::Polynomial w(p, points.row(3).transpose(), exact::PointShift);
      w4 = w * w * w * w;
    }
    // det J 2^shift = at steps^-extra of these.
    const int shift = rational ? 0 : 3 * exact::PointShift;
    const auto power = [](int exponent)
    {
      exact::Integer result(1);
      for (; exponent > 0; --exponent)
      {
        result = result * exact::Integer(steps);
      }
      return result;
    };
    const int degreeJ = j.Degrees[0] + j.Degrees[1] + j.Degrees[2];
    const int degreeW = w4.Degrees[0] + w4.Degrees[1] + w4.Degrees[2];

    ValidityOptions options;
    options.Tolerance = round % 2 == 0 ? 0.01 : 0.0;
    ValidityTest test(p, rational, options);
    ElementValidity result;
    test(1, points.data(), nullptr, &result);
    verdicts[0] += result.Verdict > 0;
    verdicts[1] += result.Verdict < 0;
    for (int n = 0; n < (steps + 1) * (steps + 1) * (steps + 1); ++n)
    {
      const std::array<int, 3> at{ n % (steps + 1), n / (steps + 1) % (steps + 1),
        n / (steps + 1) / (steps + 1) };
      const bool isInside =
        std::all_of(at.begin(), at.end(), [](int t) { return t > 0 && t < steps; });
      // value / weight is det J times 2^shift.
      const exact::Integer value = j.At(at, steps) * power(std::max(0, degreeW - degreeJ));
      const exact::Integer weight = w4.At(at, steps) * power(std::max(0, degreeJ - degreeW));
      if (result.Verdict > 0 && isInside)
      {
        ASSERT_EQ(value.Sign(), result.Sign) << round;
      }
      if (result.Minimum)
      {
        const auto bound = [&](double number)
        { return exact::Integer::FromDouble(number, shift + 120) * weight; };
        const exact::Integer scaled = value * exact::Integer::FromDouble(1.0, 120);
        ASSERT_TRUE(bound(result.Minimum->Low) <= scaled) << round;
        ASSERT_TRUE(scaled <= bound(result.Maximum->High)) << round;
      }
    }
  }
  EXPECT_GT(verdicts[0], 10);
  EXPECT_GT(verdicts[1], 10);
}
