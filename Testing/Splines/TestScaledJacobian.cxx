// SPDX-License-Identifier: BSD-3-Clause
#include "Error.h"
#include "Evaluator.h"
#include "ScaledJacobian.h"
#include "Splines/Models.h"

#include <Eigen/LU>
#include <gtest/gtest.h>

using namespace hyperpatch;

TEST(ScaledJacobian, OfOrthogonalCoordinatesIsOne)
{
  const Spline tube = models::QuarterTube();
  const ScaledJacobian j = BoundScaledJacobian(tube.Homogeneous(), tube.Degrees(), 0.01);
  EXPECT_GE(j.Minimum.Low, 0.99 - 1e-12);
  EXPECT_LE(j.Minimum.Low, 1.0);
  EXPECT_EQ(j.Maximum.High, 1.0);
  EXPECT_NEAR(j.Minimum.High, 1.0, 1e-13);
  EXPECT_NEAR(j.Maximum.Low, 1.0, 1e-13);
}

TEST(ScaledJacobian, OfAShearIsEnclosedToTheTolerance)
{
  // (u + v^2 / 2, v, w): 1 / sqrt(1 + v^2), and the mirror image of it.
  for (const double sign : { 1.0, -1.0 })
  {
    Eigen::MatrixXd points(3, 12);
    const double shear[3] = { 0.0, 0.0, 0.5 };
    for (int i = 0; i < 12; ++i)
    {
      points.col(i) << i % 2 + shear[i / 2 % 3], 0.5 * (i / 2 % 3), sign * (i / 6);
    }
    const ScaledJacobian j = BoundScaledJacobian(points, { 1, 2, 1 }, 0.02);
    const double least = sign > 0 ? std::sqrt(0.5) : -1.0;
    const double greatest = sign > 0 ? 1.0 : -std::sqrt(0.5);
    EXPECT_LE(j.Minimum.Low, least);
    EXPECT_GE(j.Minimum.High, least);
    EXPECT_LE(j.Maximum.Low, greatest);
    EXPECT_GE(j.Maximum.High, greatest);
    EXPECT_LE(j.Minimum.High - j.Minimum.Low, 0.02);
    EXPECT_LE(j.Maximum.High - j.Maximum.Low, 0.02);
    EXPECT_LT(j.Boxes, 1000);
  }
}

TEST(ScaledJacobian, OneHandednessIsBoundedWithFewerBoxes)
{
  std::mt19937 random(4);
  const KnotVector k = KnotVector::Uniform(2, 3);
  int boxes = 0;
  int boxesOfBoth = 0;
  for (int round = 0; round < 10; ++round)
  {
    Eigen::MatrixXd points =
      0.5 * models::RandomSpline(random, { k, k, k }, 3, false).Coefficients();
    for (int i = 0; i < points.cols(); ++i)
    {
      points.col(i) += Eigen::Vector3d(i % 3, i / 3 % 3, i / 9);
    }
    const ScaledJacobian both = BoundScaledJacobian(points, { 2, 2, 2 }, 0.1, 0, 20000);
    boxesOfBoth += both.Boxes;
    for (const int handedness : { 1, -1 })
    {
      const ScaledJacobian one = BoundScaledJacobian(points, { 2, 2, 2 }, 0.1, handedness, 20000);
      const Interval found = one.Least(handedness);
      const Interval known = both.Least(handedness);
      EXPECT_LE(found.High - found.Low, 0.1);
      // Two enclosures of one number meet.
      EXPECT_LE(std::max(found.Low, known.Low), std::min(found.High, known.High));
      boxes += one.Boxes;
    }
  }
  EXPECT_LT(boxes, boxesOfBoth + 40);
}

TEST(ScaledJacobian, ABudgetThatIsTooSmallLeavesItWide)
{
  std::mt19937 random(5);
  const KnotVector k = KnotVector::Uniform(2, 3);
  const Spline wild = models::RandomSpline(random, { k, k, k }, 3, false);
  const ScaledJacobian j = BoundScaledJacobian(wild.Coefficients(), { 2, 2, 2 }, 0.01, 1, 9);
  EXPECT_LE(j.Boxes, 9);
  EXPECT_GT(j.Minimum.High - j.Minimum.Low, 0.01);
}

TEST(ScaledJacobian, BoundsOfRandomVolumesHoldSamples)
{
  std::mt19937 random(1);
  std::uniform_real_distribution<double> at(0.0, 1.0);
  for (int round = 0; round < 20; ++round)
  {
    std::array<KnotVector, 3> knots;
    for (KnotVector& k : knots)
    {
      const int degree = 1 + static_cast<int>(random() % 3);
      k = KnotVector::Uniform(degree, degree + 1);
    }
    const Spline noise = models::RandomSpline(random, knots, 3, round % 2 == 0);
    const auto n = noise.Sizes();
    Eigen::MatrixXd points = 0.4 * noise.Coefficients();
    for (int i = 0; i < points.cols(); ++i)
    {
      points.col(i) += Eigen::Vector3d(i % n[0], i / n[0] % n[1], i / n[0] / n[1]);
    }
    const Spline spline(knots, points, noise.Weights());
    const ScaledJacobian j =
      BoundScaledJacobian(spline.Homogeneous(), spline.Degrees(), 0.2, 0, 300);
    const Evaluator evaluator(spline);
    EXPECT_LE(j.Minimum.Low, j.Minimum.High);
    EXPECT_LE(j.Maximum.Low, j.Maximum.High);
    for (int i = 0; i < 200; ++i)
    {
      const double u = at(random);
      const double v = at(random);
      const double parameters[3] = { u, v, at(random) };
      double value[3];
      Eigen::Matrix3d derivatives;
      evaluator.EvaluateWithDerivatives(1, parameters, value, derivatives.data());
      const double scaled = derivatives.colwise().normalized().determinant();
      EXPECT_GE(scaled, j.Minimum.Low - 1e-13);
      EXPECT_LE(scaled, j.Maximum.High + 1e-13);
    }
  }
}

TEST(ScaledJacobian, RefusesWhatItCannotBound)
{
  const Spline tube = models::QuarterTube();
  Eigen::MatrixXd points = tube.Homogeneous();
  EXPECT_THROW(static_cast<void>(BoundScaledJacobian(points, tube.Degrees(), 0.0)), Error);
  EXPECT_THROW(static_cast<void>(BoundScaledJacobian(points, { 1, 1, 1 })), Error);
  EXPECT_THROW(static_cast<void>(BoundScaledJacobian(points.topRows(3), { 1, 1, 1 })), Error);
  points(3, 2) = 0.0;
  EXPECT_THROW(static_cast<void>(BoundScaledJacobian(points, tube.Degrees())), Error);
}
