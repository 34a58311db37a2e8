// SPDX-License-Identifier: BSD-3-Clause
#include "Bernstein.h"
#include "Error.h"
#include "Evaluator.h"
#include "Operators.h"
#include "Splines/Models.h"
#include "Splines/ValidityModels.h"
#include "Validity.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include <cstdint>
#include <limits>

using namespace hyperpatch;

namespace
{

constexpr double Epsilon = std::numeric_limits<double>::epsilon();

ValidityOptions SignsOnly()
{
  ValidityOptions options;
  options.Tolerance = 0.0;
  return options;
}

double JacobianAt(const Spline& spline, const std::array<double, 3>& parameters)
{
  double value[3];
  Eigen::Matrix3d derivatives;
  Evaluator(spline).EvaluateWithDerivatives(1, parameters.data(), value, derivatives.data());
  return derivatives.determinant();
}

/// Both witnesses have the signs that they are said to have.
void ExpectWitnesses(const Spline& spline, const ElementValidity& element)
{
  ASSERT_TRUE(element.Positive && element.Negative);
  EXPECT_GT(JacobianAt(spline, *element.Positive), 0.0);
  EXPECT_LT(JacobianAt(spline, *element.Negative), 0.0);
}

ElementValidity Tested(const Spline& bezier, const ValidityOptions& options)
{
  ValidityTest test(bezier.Degrees(), bezier.IsRational(), options);
  ElementValidity result;
  const Eigen::MatrixXd points = bezier.Homogeneous();
  test(1, points.data(), nullptr, &result);
  return result;
}

}

TEST(Validity, RefutesCondeAndTorresTheorem)
{
  for (double epsilon : { 0.0, 0.001 })
  {
    const Spline spline = models::OrderedButInvalid(epsilon);
    for (const ValidityOptions& options : { SignsOnly(), ValidityOptions() })
    {
      const PatchValidity patch = TestValidity(spline, options);
      ASSERT_EQ(patch.Elements.size(), 1u);
      EXPECT_EQ(patch.Elements[0].Verdict, -1);
      ExpectWitnesses(spline, patch.Elements[0]);
    }
    const ElementValidity element = TestValidity(spline).Elements[0];
    // Exact values at (1/2, 1/2, 0) and (1/2, 1/2, 1) for epsilon = 0.
    EXPECT_LE(element.Minimum->Low, -1675.0 / 3 + 1);
    EXPECT_GE(element.Maximum->High, 16618.0);
    if (epsilon == 0.0)
    {
      EXPECT_NEAR(JacobianAt(spline, { 0.5, 0.5, 0.0 }), -1675.0 / 3, 1e-9);
    }
  }
}

TEST(Validity, IsLocalContiguousElementsThatCrossAreEachValid)
{
  const Spline spline = models::CrossingNeighbours();
  const PatchValidity patch = TestValidity(spline);
  ASSERT_EQ(patch.Elements.size(), 2u);
  EXPECT_EQ(patch.Handedness, 1);
  EXPECT_EQ(patch.Elements[0].Verdict, 1);
  EXPECT_EQ(patch.Elements[1].Verdict, 1);
}

TEST(Validity, FindsTheFoldOfTheSweptHalfCylinder)
{
  const Spline spline = models::SweptHalfCylinder();
  const PatchValidity patch = TestValidity(spline);
  ASSERT_EQ(patch.Elements.size(), 1u);
  EXPECT_EQ(patch.Elements[0].Verdict, -1);
  ExpectWitnesses(spline, patch.Elements[0]);
  EXPECT_EQ(patch.Handedness, 0);
}

TEST(Validity, TellsTheHalvesOfTheSweptHalfCylinderApart)
{
  // Cut at the fold: det J is 0 on the common face only, and the handedness of the halves differs.
  const Spline spline = InsertKnots(models::SweptHalfCylinder(), 0, { 0.5, 0.5, 0.5 });
  for (const ValidityOptions& options : { SignsOnly(), ValidityOptions() })
  {
    const PatchValidity patch = TestValidity(spline, options);
    ASSERT_EQ(patch.Elements.size(), 2u);
    EXPECT_EQ(patch.Elements[0].Sign, 1);
    EXPECT_EQ(patch.Elements[1].Sign, -1);
    EXPECT_EQ(patch.Elements[0].Degenerate, 1u << 1);
    EXPECT_EQ(patch.Elements[1].Degenerate, 1u << 0);
    EXPECT_EQ(patch.Handedness, 1);
    EXPECT_EQ(patch.Elements[0].Verdict, 1);
    EXPECT_EQ(patch.Elements[1].Verdict, -1);
    ASSERT_TRUE(patch.Elements[1].Negative);
    EXPECT_LT(JacobianAt(spline, *patch.Elements[1].Negative), 0.0);
  }
}

TEST(Validity, BoundsHoldTheExtremesToTheTolerance)
{
  // (u^2 + u, v^2 + v, w) on knots scaled by 2, 3 and 5: det J = (2u + 1)(2v + 1) / 30.
  Spline spline = models::BezierVolume({ 2, 2, 1 },
    [](int i, int j, int k)
    {
      const double q[3] = { 0.0, 0.5, 2.0 };
      return Eigen::Vector3d(q[i], q[j], k);
    });
  spline = Spline({ KnotVector::Uniform(2, 3, 0, 2), KnotVector::Uniform(2, 3, 1, 4),
                    KnotVector::Uniform(1, 2, 0, 5) },
    spline.Coefficients());
  const ElementValidity element = TestValidity(spline).Elements[0];
  EXPECT_EQ(element.Verdict, 1);
  EXPECT_EQ(element.Sign, 1);
  EXPECT_LE(element.Minimum->Low, 1.0 / 30);
  EXPECT_GE(element.Minimum->High, 1.0 / 30);
  EXPECT_LE(element.Maximum->Low, 9.0 / 30);
  EXPECT_GE(element.Maximum->High, 9.0 / 30);
  // Both are at corners, where coefficients are values.
  EXPECT_NEAR(element.Minimum->Low, element.Minimum->High, 1e-13);
  EXPECT_NEAR(element.Maximum->Low, element.Maximum->High, 1e-13);
}

TEST(Validity, BoundsOfRandomVolumesHoldDenseSamples)
{
  std::mt19937 random(1);
  for (int round = 0; round < 40; ++round)
  {
    std::array<KnotVector, 3> knots;
    for (KnotVector& k : knots)
    {
      const int degree = 1 + static_cast<int>(random() % 3);
      k = models::RandomKnots(random, degree, degree + 2, true);
    }
    const Spline spline = models::RandomSpline(random, knots, 3, round % 2 == 0);
    ValidityOptions options;
    options.Tolerance = 0.05;
    options.MaxBoxes = 20000;
    const PatchValidity patch = TestValidity(spline, options);
    std::size_t e = 0;
    const auto breaks = [&knots](int d) { return knots[static_cast<std::size_t>(d)].Breaks(); };
    for (std::size_t k = 0; k + 1 < breaks(2).size(); ++k)
    {
      for (std::size_t j = 0; j + 1 < breaks(1).size(); ++j)
      {
        for (std::size_t i = 0; i + 1 < breaks(0).size(); ++i, ++e)
        {
          const ElementValidity& element = patch.Elements[e];
          const double scale = std::max(element.Maximum->High, -element.Minimum->Low);
          EXPECT_LE(element.Minimum->High - element.Minimum->Low, 0.05 * scale);
          EXPECT_LE(element.Maximum->High - element.Maximum->Low, 0.05 * scale);
          const Evaluator evaluator(spline);
          double low = INFINITY;
          double high = -INFINITY;
          for (int q = 0; q < 125; ++q)
          {
            // Inside the element: at breaks the evaluator may be in the next one.
            const std::size_t at[3] = { i, j, k };
            const int number[3] = { q % 5, q / 5 % 5, q / 25 };
            double parameters[3];
            for (int d = 0; d < 3; ++d)
            {
              const std::vector<double> b = breaks(d);
              parameters[d] = b[at[d]] + (b[at[d] + 1] - b[at[d]]) * (number[d] + 0.5) / 5;
            }
            double value[3];
            Eigen::Matrix3d derivatives;
            evaluator.EvaluateWithDerivatives(1, parameters, value, derivatives.data());
            low = std::min(low, derivatives.determinant());
            high = std::max(high, derivatives.determinant());
          }
          EXPECT_LE(element.Minimum->Low, low + 100 * Epsilon * scale);
          EXPECT_GE(element.Maximum->High, high - 100 * Epsilon * scale);
          if (low < 0.0 && high > 0.0)
          {
            EXPECT_EQ(element.Verdict, -1);
            ExpectWitnesses(spline, element);
          }
        }
      }
    }
    EXPECT_EQ(e, patch.Elements.size());
  }
}

TEST(Validity, CoefficientsOfIntegersAreWithinTheRoundingBound)
{
  // At depth 0 the outer bounds are the extreme coefficients and the rounding bound. The scaled
  // coefficients of integers are integers, here below 2^63.
  std::mt19937 random(2);
  std::uniform_int_distribution<int> coordinate(-50, 50);
  ValidityOptions options;
  options.MaxDepth = 0;
  for (const std::array<int, 3>& p :
    { std::array<int, 3>{ 1, 1, 1 }, { 2, 1, 3 }, { 3, 3, 3 }, { 4, 2, 1 }, { 6, 1, 2 } })
  {
    for (int round = 0; round < 5; ++round)
    {
      const Spline spline = models::BezierVolume(p,
        [&](int i, int j, int k)
        {
          return Eigen::Vector3d(
            30 * i + coordinate(random), 30 * j + coordinate(random), 30 * k + coordinate(random));
        });
      using Integers = std::vector<std::int64_t>;
      const auto binomial = [](int n, int k)
      {
        std::int64_t b = 1;
        for (int i = 1; i <= k; ++i)
        {
          b = b * (n - k + i) / i;
        }
        return b;
      };
      const auto scales = [&](const std::array<int, 3>& q)
      {
        Integers result;
        for (int k = 0; k <= q[2]; ++k)
        {
          for (int j = 0; j <= q[1]; ++j)
          {
            for (int i = 0; i <= q[0]; ++i)
            {
              result.push_back(binomial(q[0], i) * binomial(q[1], j) * binomial(q[2], k));
            }
          }
        }
        return result;
      };
      const auto derivative = [&](int component, std::size_t d)
      {
        std::array<int, 3> q = p;
        --q[d];
        Integers result = scales(q);
        const int stride = d == 0 ? 1 : d == 1 ? p[0] + 1 : (p[0] + 1) * (p[1] + 1);
        for (int i = 0; i < static_cast<int>(result.size()); ++i)
        {
          const int u = i % (q[0] + 1);
          const int v = i / (q[0] + 1) % (q[1] + 1);
          const int w = i / (q[0] + 1) / (q[1] + 1);
          const int from = u + (p[0] + 1) * (v + (p[1] + 1) * w);
          const auto& c = spline.Coefficients();
          result[static_cast<std::size_t>(i)] *=
            p[d] * static_cast<int>(c(component, from + stride) - c(component, from));
        }
        return std::make_pair(q, result);
      };
      using Polynomial = std::pair<std::array<int, 3>, Integers>;
      const auto product = [](const Polynomial& a, const Polynomial& b)
      {
        const std::array<int, 3> q{ a.first[0] + b.first[0], a.first[1] + b.first[1],
          a.first[2] + b.first[2] };
        Integers result(static_cast<std::size_t>((q[0] + 1) * (q[1] + 1) * (q[2] + 1)));
        const auto split = [](std::size_t i, const std::array<int, 3>& n)
        {
          const int index = static_cast<int>(i);
          return std::array<int, 3>{ index % (n[0] + 1), index / (n[0] + 1) % (n[1] + 1),
            index / (n[0] + 1) / (n[1] + 1) };
        };
        for (std::size_t i = 0; i < a.second.size(); ++i)
        {
          for (std::size_t j = 0; j < b.second.size(); ++j)
          {
            const auto s = split(i, a.first);
            const auto t = split(j, b.first);
            result[static_cast<std::size_t>(
              s[0] + t[0] + (q[0] + 1) * (s[1] + t[1] + (q[1] + 1) * (s[2] + t[2])))] +=
              a.second[i] * b.second[j];
          }
        }
        return Polynomial(q, result);
      };
      const std::array<int, 3> q{ 3 * p[0] - 1, 3 * p[1] - 1, 3 * p[2] - 1 };
      const Integers unscale = scales(q);
      Integers sum(unscale.size());
      for (int c = 0; c < 3; ++c)
      {
        const int c1 = (c + 1) % 3;
        const int c2 = (c + 2) % 3;
        const Polynomial plus =
          product(derivative(c, 0), product(derivative(c1, 1), derivative(c2, 2)));
        const Polynomial minus =
          product(derivative(c, 0), product(derivative(c2, 1), derivative(c1, 2)));
        for (std::size_t i = 0; i < sum.size(); ++i)
        {
          sum[i] += plus.second[i] - minus.second[i];
        }
      }
      long double least = INFINITY;
      long double greatest = -INFINITY;
      for (std::size_t i = 0; i < sum.size(); ++i)
      {
        const long double c =
          static_cast<long double>(sum[i]) / static_cast<long double>(unscale[i]);
        least = std::min(least, c);
        greatest = std::max(greatest, c);
      }
      const ElementValidity element = Tested(spline, options);
      EXPECT_LE(element.Minimum->Low, least);
      EXPECT_GE(element.Maximum->High, greatest);
      // The bound is no excuse: it is small itself.
      const long double scale = std::max(greatest, -least);
      EXPECT_LT(least - element.Minimum->Low, 1e-11L * scale);
      EXPECT_LT(element.Maximum->High - greatest, 1e-11L * scale);
    }
  }
}

TEST(Validity, NoVerdictOnRandomCellsIsContradictedBySamples)
{
  std::mt19937 random(3);
  struct Kind
  {
    int Degree;
    std::size_t Count;
  };
  for (const Kind& kind : { Kind{ 1, 30000 }, Kind{ 2, 50000 }, Kind{ 3, 20000 } })
  {
    const int n = kind.Degree + 1;
    const int size = n * n * n;
    // Basis functions' derivatives at 5^3 points, ends included.
    std::array<Eigen::MatrixXd, 3> basis;
    for (std::size_t d = 0; d < 3; ++d)
    {
      basis[d].resize(size, 125);
      for (int i = 0; i < size; ++i)
      {
        Eigen::VectorXd one = Eigen::VectorXd::Zero(size);
        one[i] = 1.0;
        const Bernstein b =
          Bernstein({ kind.Degree, kind.Degree, kind.Degree }, one).Derivative(static_cast<int>(d));
        for (int q = 0; q < 125; ++q)
        {
          basis[d](i, q) = b(q % 5 / 4.0, q / 5 % 5 / 4.0, q / 25 / 4.0);
        }
      }
    }
    // Noise from harmless to hopeless; every other cell has a corner that is singular up to 1e-9,
    // on either side.
    std::vector<double> points;
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    for (std::size_t cell = 0; cell < kind.Count; ++cell)
    {
      const double noise = 0.2 + 0.4 * std::abs(unit(random));
      const std::size_t first = points.size();
      for (int i = 0; i < size; ++i)
      {
        points.push_back(i % n + noise * unit(random));
        points.push_back(i / n % n + noise * unit(random));
        points.push_back(i / n / n + noise * unit(random));
      }
      if (cell % 2 == 0)
      {
        Eigen::Map<Eigen::Matrix3Xd> p(points.data() + first, 3, size);
        const Eigen::Vector3d a = p.col(1) - p.col(0);
        const Eigen::Vector3d b = p.col(n) - p.col(0);
        p.col(n * n) = p.col(0) + 0.3 * a + 0.4 * b + 1e-9 * unit(random) * a.cross(b);
      }
    }
    ValidityOptions options = SignsOnly();
    options.MaxBoxes = 500;
    ValidityTest test({ kind.Degree, kind.Degree, kind.Degree }, false, options);
    std::vector<ElementValidity> results(kind.Count);
    test(kind.Count, points.data(), nullptr, results.data());
    int verdicts[3] = {};
    for (std::size_t cell = 0; cell < kind.Count; ++cell)
    {
      const Eigen::Map<const Eigen::Matrix3Xd> p(
        points.data() + cell * 3 * static_cast<std::size_t>(size), 3, size);
      const Eigen::Matrix3Xd u = p * basis[0];
      const Eigen::Matrix3Xd v = p * basis[1];
      const Eigen::Matrix3Xd w = p * basis[2];
      const ElementValidity& result = results[cell];
      ++verdicts[result.Verdict + 1];
      double low = INFINITY;
      double high = -INFINITY;
      for (int q = 0; q < 125; ++q)
      {
        const double j = u.col(q).dot(v.col(q).cross(w.col(q)));
        low = std::min(low, j);
        high = std::max(high, j);
      }
      // Sampling itself rounds: six products of three numbers of up to 7, some twenty times.
      const double error = 6 * 7 * 7 * 7 * 20 * Epsilon;
      if (result.Verdict == 1)
      {
        EXPECT_GT(result.Sign > 0 ? low : -high, -error);
      }
      if (low < -error && high > error)
      {
        EXPECT_EQ(result.Verdict, -1);
      }
      if (result.Verdict == -1)
      {
        EXPECT_TRUE(result.Positive && result.Negative);
      }
    }
    // A zero at a corner up to 1e-9 is nearly always decided.
    EXPECT_LT(verdicts[1], static_cast<int>(kind.Count / 100));
    EXPECT_GT(verdicts[0], static_cast<int>(kind.Count / 10));
    EXPECT_GT(verdicts[2], static_cast<int>(kind.Count / 10));
  }
}

TEST(Validity, ScaledJacobianIsGivenWhereAskedFor)
{
  const Spline tube = RefineUniformly(models::QuarterTube(), { 2, 2, 1 });
  ValidityOptions options;
  EXPECT_FALSE(TestValidity(tube, options).Elements[0].Scaled);
  options.ScaledTolerance = 0.02;
  for (const ElementValidity& element : TestValidity(tube, options).Elements)
  {
    ASSERT_TRUE(element.Scaled);
    // Orthogonal coordinates.
    EXPECT_GE(element.Scaled->Minimum.Low, 0.98 - 1e-12);
    EXPECT_NEAR(element.Scaled->Maximum.High, 1.0, 1e-12);
  }
}

TEST(Validity, RationalVerdictsAreInvariantUnderScalingOfWeights)
{
  const Spline tube = models::QuarterTube();
  const Spline scaled(tube.Knots(), tube.Coefficients(), 3.0 * tube.Weights());
  for (const Spline& spline : { tube, scaled })
  {
    const ElementValidity element = TestValidity(spline).Elements[0];
    EXPECT_EQ(element.Verdict, 1);
    EXPECT_EQ(element.Sign, 1);
    // det J = r theta'(v), radius 1 to 2; theta' is sqrt(2) at the ends and 4 tan(pi / 8) =
    // 4 (sqrt(2) - 1) in the middle.
    EXPECT_LE(element.Minimum->Low, std::sqrt(2.0));
    EXPECT_GE(element.Minimum->High, std::sqrt(2.0) - 1e-12);
    EXPECT_LE(element.Maximum->Low, 8 * (std::sqrt(2.0) - 1) + 1e-12);
    EXPECT_GE(element.Maximum->High, 8 * (std::sqrt(2.0) - 1) - 1e-12);
    EXPECT_LE(element.Maximum->High - element.Maximum->Low, 0.01 * 3.4);
  }
  EXPECT_EQ(TestValidity(tube, SignsOnly()).Elements[0].Verdict, 1);
}

TEST(Validity, DegenerateFacesAndEdgesAreSaidAndLeftOut)
{
  for (const ValidityOptions& options : { SignsOnly(), ValidityOptions() })
  {
    // (u, u v, w): det J = u.
    const ElementValidity wedge =
      Tested(models::BezierVolume(
               { 1, 1, 1 }, [](int i, int j, int k) { return Eigen::Vector3d(i, i * j, k); }),
        options);
    EXPECT_EQ(wedge.Degenerate, 1u << 0);
    EXPECT_EQ(wedge.Verdict, 1);
    // (u, u v, u w): det J = u^2.
    const ElementValidity pyramid =
      Tested(models::BezierVolume(
               { 1, 1, 1 }, [](int i, int j, int k) { return Eigen::Vector3d(i, i * j, i * k); }),
        options);
    EXPECT_EQ(pyramid.Degenerate, 1u << 0);
    EXPECT_EQ(pyramid.Verdict, 1);
    // A quadrilateral with a straight angle at (0, 0), extruded: the edge u = v = 0.
    const ElementValidity extruded =
      Tested(models::BezierVolume({ 1, 1, 1 },
               [](int i, int j, int k)
               { return Eigen::Vector3d(i * j == 1 ? 1 : i - j, i * j == 1 ? 1 : j - i, k); }),
        options);
    EXPECT_EQ(extruded.Degenerate, 1u << 14);
    EXPECT_EQ(extruded.Verdict, 1);
  }
}

TEST(Validity, ADoubleZeroInsideIsUndecided)
{
  // ((2u - 1)^3, v, w): det J = 6 (2u - 1)^2.
  const double x[4] = { -1, 1, -1, 1 };
  const Spline spline = models::BezierVolume(
    { 3, 1, 1 }, [&x](int i, int j, int k) { return Eigen::Vector3d(x[i], j, k); });
  const ElementValidity element = Tested(spline, ValidityOptions());
  EXPECT_EQ(element.Verdict, 0);
  EXPECT_EQ(element.Depth, ValidityOptions().MaxDepth);
  EXPECT_LE(element.Minimum->Low, 0.0);
  EXPECT_FALSE(element.Negative);
}

TEST(Validity, ADegenerateFaceExcusesNoOtherZero)
{
  // (u, u q(v), w), q' = 6 (2v - 1)^2: det J = 6 u (2v - 1)^2.
  const double q[4] = { -1, 1, -1, 1 };
  const Spline spline = models::BezierVolume(
    { 1, 3, 1 }, [&q](int i, int j, int k) { return Eigen::Vector3d(i, i * q[j], k); });
  const ElementValidity element = Tested(spline, SignsOnly());
  EXPECT_EQ(element.Verdict, 0);
  EXPECT_EQ(element.Degenerate, 1u << 0);
}

TEST(Validity, AFlatVolumeIsUndecidedAtOnce)
{
  const ElementValidity element =
    Tested(models::BezierVolume(
             { 2, 2, 2 }, [](int i, int j, int) { return Eigen::Vector3d(i, j, i + j); }),
      ValidityOptions());
  EXPECT_EQ(element.Verdict, 0);
  EXPECT_EQ(element.Boxes, 1);
  EXPECT_EQ(element.Degenerate, 0x3fu);
}

TEST(Validity, LeftHandedPatchesAreValidElementsAgainstThePatchAreNot)
{
  Eigen::Matrix3Xd points(3, 16);
  const double x[4] = { 0, 1, 2, 1.5 };
  for (int i = 0; i < 16; ++i)
  {
    points.col(i) << -x[i % 4], i / 4 % 2, i / 8;
  }
  const Spline spline(
    { KnotVector::Uniform(1, 4), KnotVector::Uniform(1, 2), KnotVector::Uniform(1, 2) }, points);
  for (const ValidityOptions& options : { SignsOnly(), ValidityOptions() })
  {
    const PatchValidity patch = TestValidity(spline, options);
    EXPECT_EQ(patch.Handedness, -1);
    EXPECT_EQ(patch.Elements[0].Verdict, 1);
    EXPECT_EQ(patch.Elements[0].Sign, -1);
    EXPECT_EQ(patch.Elements[1].Verdict, 1);
    EXPECT_EQ(patch.Elements[2].Verdict, -1);
    ASSERT_TRUE(patch.Elements[2].Positive);
    EXPECT_GT(JacobianAt(spline, *patch.Elements[2].Positive), 0.0);
  }
}

TEST(Validity, DoesNotDependOnHowTheWorkIsDivided)
{
  std::mt19937 random(4);
  const KnotVector knots = KnotVector::Uniform(2, 6);
  Spline spline = models::RandomSpline(random, { knots, knots, knots }, 3, false);
  Eigen::MatrixXd points = 0.5 * spline.Coefficients();
  for (int i = 0; i < points.cols(); ++i)
  {
    points.col(i) += Eigen::Vector3d(i % 6, i / 6 % 6, i / 36);
  }
  spline = Spline(spline.Knots(), points);
  for (const ValidityOptions& options : { SignsOnly(), ValidityOptions() })
  {
    const PatchValidity whole = TestValidity(spline, options);
    const PatchValidity parts = TestValidity(spline, options,
      [](std::ptrdiff_t count, std::ptrdiff_t, const auto& body)
      {
        for (std::ptrdiff_t i = count; i > 0; i -= 3)
        {
          body(std::max<std::ptrdiff_t>(0, i - 3), i);
        }
      });
    ASSERT_EQ(whole.Elements.size(), 64u);
    for (std::size_t e = 0; e < 64; ++e)
    {
      EXPECT_EQ(whole.Elements[e].Verdict, parts.Elements[e].Verdict);
      EXPECT_EQ(whole.Elements[e].By, parts.Elements[e].By);
      EXPECT_EQ(whole.Elements[e].Positive, parts.Elements[e].Positive);
      EXPECT_EQ(whole.Elements[e].Negative, parts.Elements[e].Negative);
      if (whole.Elements[e].Minimum)
      {
        EXPECT_EQ(whole.Elements[e].Minimum->Low, parts.Elements[e].Minimum->Low);
        EXPECT_EQ(whole.Elements[e].Maximum->High, parts.Elements[e].Maximum->High);
      }
    }
  }
}

TEST(Validity, OnlyElementsThatAnEditReachesAreTestedAgain)
{
  std::mt19937 random(5);
  const KnotVector u = KnotVector::Uniform(3, 10);
  const KnotVector v = KnotVector::Uniform(2, 9);
  const KnotVector w(1, { 0, 0, 1, 1.5, 3, 3 });
  Eigen::MatrixXd points = models::RandomSpline(random, { u, v, w }, 3, false).Coefficients();
  for (int i = 0; i < points.cols(); ++i)
  {
    points.col(i) = 0.3 * points.col(i) + Eigen::Vector3d(i % 10, i / 10 % 9, i / 90);
  }
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(points.cols());
  const Spline before({ u, v, w }, points, weights);
  const PatchValidity known = TestValidity(before);
  EXPECT_EQ(known.Tested, 7u * 7u * 3u);

  // Point (5, 4, 1) reaches 4 x 3 x 2 spans; (0, 0, 0) one.
  points.col(5 + 10 * 4 + 90) += Eigen::Vector3d(2.0, 0.0, 0.0);
  const Spline moved({ u, v, w }, points, weights);
  weights[0] = 1.5;
  const Spline weighted({ u, v, w }, points, weights);
  const KnownValidity first{ &before, &known };
  const PatchValidity second = TestValidity(moved, {}, SerialFor, 0, &first);
  EXPECT_EQ(second.Tested, 24u);
  const KnownValidity edited{ &moved, &second };
  const PatchValidity third = TestValidity(weighted, {}, SerialFor, 0, &edited);
  EXPECT_EQ(third.Tested, 1u);
  EXPECT_EQ(TestValidity(weighted, {}, SerialFor, 0, nullptr).Tested, 147u);
  const KnownValidity turned{ &weighted, &third };
  Eigen::MatrixXd mirrored = points;
  mirrored.row(0) *= -1.0;
  EXPECT_EQ(
    TestValidity(Spline({ u, v, w }, mirrored, weights), {}, SerialFor, 0, &turned).Tested, 147u);

  const PatchValidity fresh = TestValidity(weighted);
  EXPECT_EQ(third.Handedness, fresh.Handedness);
  for (std::size_t e = 0; e < fresh.Elements.size(); ++e)
  {
    EXPECT_EQ(third.Elements[e].Verdict, fresh.Elements[e].Verdict);
    EXPECT_EQ(third.Elements[e].Minimum->Low, fresh.Elements[e].Minimum->Low);
    EXPECT_EQ(third.Elements[e].Maximum->High, fresh.Elements[e].Maximum->High);
    EXPECT_EQ(third.Elements[e].Positive, fresh.Elements[e].Positive);
    EXPECT_EQ(third.Elements[e].Negative, fresh.Elements[e].Negative);
  }
  // Other knots: nothing is known.
  const Spline other({ u, v, KnotVector(1, { 0, 0, 1, 2, 3, 3 }) }, points, weights);
  EXPECT_EQ(TestValidity(other, {}, SerialFor, 0, &turned).Tested, 147u);
}

TEST(Validity, AllowsForErrorsOfThePoints)
{
  // A slab of thickness 1e-6 that is known to 1e-7 is valid, known to 1e-6 it is not certain.
  const Spline slab = models::BezierVolume(
    { 1, 1, 1 }, [](int i, int j, int k) { return Eigen::Vector3d(i, j, 1e-6 * k); });
  for (const ValidityOptions& options : { SignsOnly(), ValidityOptions() })
  {
    ValidityTest test({ 1, 1, 1 }, false, options);
    ElementValidity result;
    double error = 1e-7;
    test(1, slab.Coefficients().data(), &error, &result);
    EXPECT_EQ(result.Verdict, 1);
    error = 1e-6;
    test(1, slab.Coefficients().data(), &error, &result);
    EXPECT_EQ(result.Verdict, 0);
  }
}

TEST(Validity, RefusesWhatItCannotTest)
{
  EXPECT_THROW(ValidityTest({ 1, 1, 0 }, false), Error);
  EXPECT_THROW(ValidityTest({ 1, MaxDegree + 1, 1 }, false), Error);
  ValidityOptions options;
  options.Tolerance = -0.1;
  EXPECT_THROW(ValidityTest({ 1, 1, 1 }, false, options), Error);
  EXPECT_THROW(static_cast<void>(TestValidity(models::QuarterTube(), options)), Error);
  options = ValidityOptions();
  options.ScaledTolerance = NAN;
  EXPECT_THROW(ValidityTest({ 1, 1, 1 }, false, options), Error);
  options = ValidityOptions();
  options.MaxBoxes = 0;
  EXPECT_THROW(ValidityTest({ 1, 1, 1 }, false, options), Error);

  Eigen::MatrixXd points = models::QuarterTube().Homogeneous();
  points(3, 4) = -1.0;
  ValidityTest test({ 1, 2, 1 }, true);
  ElementValidity result;
  EXPECT_THROW(test(1, points.data(), nullptr, &result), Error);

  const KnotVector line = KnotVector::Uniform(1, 2);
  EXPECT_THROW(
    static_cast<void>(TestValidity(Spline({ line, line, line }, Eigen::MatrixXd::Zero(1, 8)))),
    Error);
  EXPECT_THROW(static_cast<void>(
                 TestValidity(Spline({ line, line, KnotVector() }, Eigen::MatrixXd::Zero(3, 4)))),
    Error);
}
