// SPDX-License-Identifier: BSD-3-Clause
#include "BezierExtractor.h"
#include "Cone.h"
#include "Error.h"
#include "Evaluator.h"
#include "Splines/Models.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <limits>

using namespace hyperpatch;

namespace
{

constexpr double Epsilon = std::numeric_limits<double>::epsilon();
/// Of samples on the border of a cone: trigonometry, and a side that is perpendicular to round-off
/// over the length of a random cross product.
constexpr double SampleError = 32 * Epsilon;
constexpr double Pi = 3.14159265358979323846;

Eigen::Vector3d RandomDirection(std::mt19937& random)
{
  std::normal_distribution<double> value;
  const double x = value(random);
  const double y = value(random);
  return Eigen::Vector3d(x, y, value(random)).normalized();
}

/// A unit vector at an angle from a unit axis, all around it.
Eigen::Vector3d AtAngle(std::mt19937& random, const Eigen::Vector3d& axis, double angle)
{
  const Eigen::Vector3d side = axis.cross(RandomDirection(random)).normalized();
  return std::cos(angle) * axis + std::sin(angle) * side;
}

/// A unit vector in the cone, on its border as often as not.
Eigen::Vector3d In(std::mt19937& random, const Cone& cone)
{
  std::uniform_real_distribution<double> part(0.0, 1.0);
  // As far out as the slack of 1e-7 at small angles allows the sine and cosine to disagree.
  const double angle = std::acos(cone.Cosine());
  return AtAngle(random, cone.Axis(), random() % 2 == 0 ? angle : angle * part(random));
}

Cone RandomCone(std::mt19937& random, double largest)
{
  return Cone(
    RandomDirection(random), std::uniform_real_distribution<double>(0.0, largest)(random));
}

double Degrees(double radians)
{
  return radians * 180.0 / Pi;
}

}

TEST(Cone, AroundVectorsHoldsThemAndTheirCombinations)
{
  std::mt19937 random(1);
  std::uniform_real_distribution<double> length(1e-3, 1e3);
  for (int round = 0; round < 500; ++round)
  {
    const Eigen::Vector3d axis = RandomDirection(random);
    Eigen::Matrix3Xd vectors(3, 10);
    for (auto v : vectors.colwise())
    {
      v = length(random) * AtAngle(random, axis, 0.6);
    }
    const Cone cone = Cone::Around(vectors);
    ASSERT_FALSE(cone.IsEverything());
    EXPECT_LE(cone.Angle(), 1.2 + 1e-7);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const auto v : vectors.colwise())
    {
      EXPECT_TRUE(cone.Contains(v));
      sum += length(random) * v;
    }
    EXPECT_TRUE(cone.Contains(sum));
  }
}

TEST(Cone, AllowsForTheErrorOfEveryVector)
{
  std::mt19937 random(2);
  for (int round = 0; round < 200; ++round)
  {
    const Eigen::Vector3d axis = RandomDirection(random);
    const double error = 0.1;
    Eigen::Matrix3Xd vectors(3, 5);
    Eigen::Matrix3Xd moved(3, 5);
    for (int i = 0; i < 5; ++i)
    {
      vectors.col(i) = AtAngle(random, axis, 0.3);
      moved.col(i) = vectors.col(i) + error * RandomDirection(random);
    }
    const Cone cone = Cone::Around(vectors, error);
    for (const auto v : moved.colwise())
    {
      EXPECT_TRUE(cone.Contains(v));
    }
  }
}

TEST(Cone, LeavesOutZeroVectorsAndCountsThem)
{
  Eigen::Matrix3Xd vectors = Eigen::Matrix3Xd::Zero(3, 4);
  vectors.col(2) = Eigen::Vector3d(0, 0, 2);
  const Cone cone = Cone::Around(vectors);
  EXPECT_EQ(cone.ZeroVectors(), 3);
  EXPECT_FALSE(cone.IsEverything());
  EXPECT_LT(cone.Angle(), 1e-7);

  const Cone none = Cone::Around(Eigen::Matrix3Xd::Zero(3, 4));
  EXPECT_EQ(none.ZeroVectors(), 4);
  EXPECT_TRUE(none.IsEverything());
}

TEST(Cone, IsEverythingWhereNoHalfSpaceHoldsTheVectors)
{
  Eigen::Matrix3Xd vectors(3, 3);
  vectors << 1, -0.5, -0.4, 0, 1, -1, 0, 0, 0;
  const Cone cone = Cone::Around(vectors);
  EXPECT_TRUE(cone.IsEverything());
  EXPECT_EQ(cone.Angle(), Pi);
  EXPECT_TRUE(cone.Contains({ -3, 2, 1 }));
  // Numbers whose squares leave the range of doubles.
  EXPECT_TRUE(Cone::Around(1e-200 * Eigen::Matrix3Xd::Identity(3, 3)).IsEverything());
  EXPECT_TRUE(Cone::Around(1e200 * Eigen::Matrix3Xd::Identity(3, 3)).IsEverything());
  Eigen::Matrix3Xd tiny(3, 2);
  tiny << 1, -1e-170, 0, 0, 0, 0;
  EXPECT_TRUE(Cone::Around(tiny).IsEverything());
}

TEST(Cone, GrowsToTheLeastConeThatHoldsBoth)
{
  std::mt19937 random(3);
  int grown = 0;
  for (int round = 0; round < 2000; ++round)
  {
    const Cone cone = RandomCone(random, 1.5);
    const Eigen::Vector3d v = RandomDirection(random);
    const Cone both = cone.Grown(3.0 * v);
    const double alpha = std::acos(cone.Axis().dot(v));
    if (alpha + cone.Angle() >= Pi)
    {
      EXPECT_TRUE(both.IsEverything());
      continue;
    }
    EXPECT_TRUE(both.Contains(v));
    if (both.IsEverything())
    {
      continue;
    }
    EXPECT_NEAR(both.Angle(), std::max(cone.Angle(), 0.5 * (alpha + cone.Angle())), 2e-7);
    grown += both.Angle() > cone.Angle();
    for (int i = 0; i < 20; ++i)
    {
      EXPECT_GE(both.Axis().dot(In(random, cone)), both.Cosine() - SampleError);
    }
  }
  EXPECT_GT(grown, 500);
  EXPECT_NEAR(Cone({ 1, 0, 0 }, 0.0).Grown({ 0, 1, 0 }).Angle(), Pi / 4, 1e-7);
}

TEST(Cone, DotBoundsAreHeldAndReached)
{
  std::mt19937 random(4);
  for (int round = 0; round < 1000; ++round)
  {
    const Cone a = RandomCone(random, 1.5);
    const Cone b = RandomCone(random, 1.5);
    const Interval dot = Dot(a, b);
    for (int i = 0; i < 20; ++i)
    {
      const double value = In(random, a).dot(In(random, b));
      EXPECT_GE(value, dot.Low - SampleError);
      EXPECT_LE(value, dot.High + SampleError);
    }
    // The extremes lie in the plane of the axes.
    const double beta = std::acos(a.Axis().dot(b.Axis()));
    EXPECT_NEAR(dot.Low, std::cos(std::min(Pi, beta + a.Angle() + b.Angle())), 3e-7);
    EXPECT_NEAR(dot.High, std::cos(std::max(0.0, beta - a.Angle() - b.Angle())), 3e-7);
  }
}

TEST(Cone, CrossProductConeIsHeldAndTight)
{
  std::mt19937 random(5);
  int cones = 0;
  for (int round = 0; round < 400; ++round)
  {
    const Cone a = RandomCone(random, 0.7);
    const Cone b = RandomCone(random, 0.7);
    const Cone cross = Cross(a, b);
    const double beta = std::acos(std::abs(a.Axis().dot(b.Axis())));
    EXPECT_EQ(cross.IsEverything(), a.Angle() + b.Angle() >= beta);
    if (cross.IsEverything())
    {
      continue;
    }
    ++cones;
    double widest = 0.0;
    for (int i = 0; i < 4000; ++i)
    {
      const Eigen::Vector3d u = AtAngle(random, a.Axis(), std::acos(a.Cosine()));
      const Eigen::Vector3d v = AtAngle(random, b.Axis(), std::acos(b.Cosine()));
      const Eigen::Vector3d product = u.cross(v);
      // The product of two nearly parallel samples is right to 4 ulp over its length.
      EXPECT_GE(cross.Axis().dot(product.normalized()),
        cross.Cosine() - 16 * Epsilon * (1.0 + 1.0 / product.norm()));
      widest = std::max(widest, std::acos(cross.Axis().dot(product.normalized())));
    }
    // Random samples come within a few percent of the border.
    EXPECT_GT(widest, 0.9 * cross.Angle() - 1e-6);
  }
  EXPECT_GT(cones, 100);
}

TEST(Cone, TripleProductBoundsAndSignsAreHeld)
{
  std::mt19937 random(6);
  int decided = 0;
  for (int round = 0; round < 3000; ++round)
  {
    const Cone a = RandomCone(random, 0.6);
    const Cone b = RandomCone(random, 0.6);
    const Cone c = RandomCone(random, 0.6);
    const Interval bounds = TripleProduct(a, b, c);
    const int sign = TripleProductSign(a, b, c);
    decided += sign != 0;
    // Turning the product round leaves its sign, exchanging two factors turns it over.
    EXPECT_EQ(TripleProductSign(b, c, a), sign);
    EXPECT_EQ(TripleProductSign(b, a, c), -sign);
    if (sign != 0)
    {
      EXPECT_GT(sign > 0 ? bounds.Low : -bounds.High, -4 * Epsilon);
    }
    for (int i = 0; i < 30; ++i)
    {
      const double value = In(random, a).dot(In(random, b).cross(In(random, c)));
      EXPECT_GE(value, bounds.Low - SampleError);
      EXPECT_LE(value, bounds.High + SampleError);
      if (sign != 0)
      {
        EXPECT_GT(sign * value, -SampleError);
      }
    }
  }
  EXPECT_GT(decided, 200);
}

TEST(Cone, ThreeOrdersDecideMoreThanOne)
{
  std::mt19937 random(8);
  int one = 0;
  int three = 0;
  for (int round = 0; round < 5000; ++round)
  {
    const Cone a = RandomCone(random, 0.6);
    const Cone b = RandomCone(random, 0.6);
    const Cone c = RandomCone(random, 0.6);
    const Interval dot = Dot(a, Cross(b, c));
    const int sign = TripleProductSign(a, b, c);
    three += sign != 0;
    if (dot.Low > 1e-6 || dot.High < -1e-6)
    {
      ++one;
      EXPECT_EQ(sign, dot.Low > 0.0 ? 1 : -1);
    }
  }
  EXPECT_GT(three, one + one / 20);
}

TEST(Cone, OfRationalDerivativesHoldsTheTangents)
{
  std::mt19937 random(7);
  for (int round = 0; round < 50; ++round)
  {
    std::array<KnotVector, 3> knots;
    for (KnotVector& k : knots)
    {
      const int degree = 1 + static_cast<int>(random() % 3);
      k = KnotVector::Uniform(degree, degree + 1);
    }
    Spline spline = models::RandomSpline(random, knots, 3, round % 2 == 0);
    Eigen::MatrixXd points = spline.Coefficients();
    for (int i = 0; i < points.cols(); ++i)
    {
      const auto n = spline.Sizes();
      points.col(i) =
        0.3 * points.col(i) + Eigen::Vector3d(i % n[0], i / n[0] % n[1], i / n[0] / n[1]);
    }
    spline = Spline(knots, points, spline.Weights());
    const Evaluator evaluator(spline);
    for (int d = 0; d < 3; ++d)
    {
      const Cone cone = DerivativeCone(spline.Homogeneous(), spline.Degrees(), d);
      for (int i = 0; i < 50; ++i)
      {
        std::uniform_real_distribution<double> at(0.0, 1.0);
        const double u = at(random);
        const double v = at(random);
        const double parameters[3] = { u, v, at(random) };
        double value[3];
        Eigen::Matrix3d derivatives;
        evaluator.EvaluateWithDerivatives(1, parameters, value, derivatives.data());
        const Eigen::Vector3d t = derivatives.col(d);
        EXPECT_GE(cone.Axis().dot(t), (cone.Cosine() - 100 * Epsilon) * t.norm());
      }
    }
  }
}

TEST(Cone, OfHomogenisedDerivativePointsLosesTheTangentOfAQuarterCircle)
{
  // Martin & Cohen bound (X_u, W_u) projected by its own weight; the tangents of the quarter circle
  // run from 90 to 180 degrees, and that cone begins at 157.5.
  const Spline tube = models::QuarterTube();
  const Eigen::MatrixXd points = tube.Homogeneous();
  Eigen::Matrix3Xd projected(3, 2);
  for (int j = 0; j < 2; ++j)
  {
    // Inner radius, bottom: control points 0, 2, 4.
    const Eigen::Vector4d difference = points.col(2 * j + 2) - points.col(2 * j);
    projected.col(j) = difference.head<3>() / difference[3];
  }
  const Cone wrong = Cone::Around(projected);
  EXPECT_NEAR(Degrees(wrong.Angle()), 67.5, 1e-5);
  const Eigen::Vector3d tangent(0, 1, 0);
  EXPECT_NEAR(Degrees(std::acos(wrong.Axis().dot(tangent)) - wrong.Angle()), 67.5, 1e-5);
  EXPECT_FALSE(wrong.Contains(tangent));

  const Cone right = DerivativeCone(points, tube.Degrees(), 1);
  EXPECT_NEAR(Degrees(right.Angle()), 45.0, 1e-5);
  // Both ends are on the border: inside, by the bounds for round-off of about 50 ulp.
  EXPECT_NEAR(right.Axis().dot(tangent), right.Cosine(), 200 * Epsilon);
  EXPECT_TRUE(right.Contains(tangent));
}

TEST(Cone, RefusesWhatIsNoCone)
{
  EXPECT_THROW(Cone(Eigen::Vector3d::Zero(), 0.1), Error);
  EXPECT_THROW(Cone({ NAN, 0, 1 }, 0.1), Error);
  EXPECT_THROW(Cone({ 0, 0, 1 }, -0.1), Error);
  EXPECT_THROW(Cone({ 0, 0, 1 }, NAN), Error);
  EXPECT_TRUE(Cone({ 0, 0, 1 }, Pi / 2).IsEverything());
  EXPECT_THROW(static_cast<void>(DerivativeCone(Eigen::MatrixXd(3, 8), { 1, 1, 1 }, 3)), Error);
  EXPECT_THROW(static_cast<void>(DerivativeCone(Eigen::MatrixXd(3, 4), { 1, 1, 0 }, 2)), Error);
  EXPECT_THROW(static_cast<void>(DerivativeCone(Eigen::MatrixXd(2, 8), { 1, 1, 1 }, 0)), Error);
  EXPECT_THROW(static_cast<void>(DerivativeCone(Eigen::MatrixXd(3, 7), { 1, 1, 1 }, 0)), Error);
  EXPECT_THROW(static_cast<void>(DerivativeCone(Eigen::MatrixXd(4, 7), { 1, 1, 1 }, 0)), Error);
}
