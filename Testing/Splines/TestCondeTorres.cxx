// SPDX-License-Identifier: BSD-3-Clause
#include "CondeTorres.h"
#include "Error.h"
#include "Operators.h"
#include "Splines/Models.h"
#include "Splines/ValidityModels.h"
#include "Validity.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>

using namespace hyperpatch;

namespace
{

CondeTorres Tested(const Spline& geometry)
{
  MultiPatch model;
  model.Patches.push_back({ 0, Aggregate(geometry) });
  return TestCondeTorres(model);
}

/// A lattice of spacing 1 in generic directions, no axis of which is one of space, with noise.
Spline SkewLattice(std::array<int, 3> sizes, double noise, int seed = 1)
{
  std::mt19937 random(static_cast<unsigned>(seed));
  std::uniform_real_distribution<double> move(-noise, noise);
  Eigen::Matrix3d axes;
  axes << 1.0, 0.3, 0.2, 0.25, 1.0, 0.35, 0.3, 0.2, 1.0;
  Eigen::Matrix3Xd points(3, sizes[0] * sizes[1] * sizes[2]);
  for (int i = 0; i < points.cols(); ++i)
  {
    points.col(i) =
      axes * Eigen::Vector3d(i % sizes[0], i / sizes[0] % sizes[1], i / sizes[0] / sizes[1]) +
      Eigen::Vector3d(move(random), move(random), move(random));
  }
  return Spline({ models::Unclamped(3, sizes[0]), models::Unclamped(3, sizes[1]),
                  models::Unclamped(3, sizes[2]) },
    points);
}

}

TEST(CondeTorres, TheCounterexampleToTheirTheoremPasses)
{
  for (const double epsilon : { 0.0, 0.001 })
  {
    const Spline spline = models::OrderedButInvalid(epsilon);
    const CondeTorres result = Tested(spline);
    EXPECT_EQ(result.Forms[0], CondeTorresForm::Uniform);
    EXPECT_EQ(result.Elements[0], CondeTorresResult::Passes);
    EXPECT_EQ(TestValidity(spline).Elements[0].Verdict, -1);
  }
}

TEST(CondeTorres, NeighboursThatCrossAreContiguousAndNotTested)
{
  const CondeTorres result = Tested(models::CrossingNeighbours());
  EXPECT_EQ(result.Pairs.Contiguous, 1u);
  EXPECT_EQ(result.Pairs.Meeting, 0u);
}

TEST(CondeTorres, SkewLatticesPassWithAllThatTouchLegitimately)
{
  const CondeTorres result = Tested(SkewLattice({ 8, 7, 6 }, 0.02));
  ASSERT_EQ(result.Elements.size(), 5u * 4 * 3);
  for (const CondeTorresResult element : result.Elements)
  {
    EXPECT_EQ(element, CondeTorresResult::Passes);
  }
  const CondeTorresPairs& pairs = result.Pairs;
  EXPECT_EQ(pairs.Contiguous, 4u * 4 * 3 + 5 * 3 * 3 + 5 * 4 * 2);
  EXPECT_EQ(pairs.Contiguous + pairs.ByBoxes + pairs.ByHulls + pairs.ByBorders, 60u * 59 / 2);
  // Elements with common control points are never told apart by boxes and hulls; this patch has
  // pairs that are further apart.
  EXPECT_GT(pairs.ByBoxes, 0u);
  EXPECT_GT(pairs.ByBorders, 0u);
}

TEST(CondeTorres, IsNotInvariantUnderRotation)
{
  // Rows along the axes turn back with the least noise, though the element is as valid as before.
  std::mt19937 random(2);
  std::uniform_real_distribution<double> move(-0.02, 0.02);
  Eigen::Matrix3Xd points(3, 64);
  for (int i = 0; i < 64; ++i)
  {
    points.col(i) << i % 4 + move(random), i / 4 % 4 + move(random), i / 16 + move(random);
  }
  EXPECT_EQ(TestCondeTorresLattice(points, { 4, 4, 4 }), CondeTorresResult::SpanNotOrdered);
  Eigen::Matrix3d axes;
  axes << 1.0, 0.3, 0.2, 0.25, 1.0, 0.35, 0.3, 0.2, 1.0;
  EXPECT_EQ(TestCondeTorresLattice(axes * points, { 4, 4, 4 }), CondeTorresResult::Passes);
}

TEST(CondeTorres, RowsMayRunBackwardsOrStandStillButNotTurnBack)
{
  Eigen::Matrix3Xd points(3, 64);
  for (int i = 0; i < 64; ++i)
  {
    points.col(i) << -(i % 4), i / 4 % 4, i / 16;
  }
  EXPECT_EQ(TestCondeTorresLattice(points, { 4, 4, 4 }), CondeTorresResult::Passes);
  points(1, 21) += 0.1;
  EXPECT_EQ(TestCondeTorresLattice(points, { 4, 4, 4 }), CondeTorresResult::SpanNotOrdered);
}

TEST(CondeTorres, SkinsThatMeetFail)
{
  // A lattice that is flat: all rows ordered, slices across w coincide.
  Eigen::Matrix3Xd points(3, 64);
  for (int i = 0; i < 64; ++i)
  {
    points.col(i) << i % 4, i / 4 % 4, 0.0;
  }
  EXPECT_EQ(TestCondeTorresLattice(points, { 4, 4, 4 }), CondeTorresResult::SkinsMeet);
  // Slices that tilt against each other, each by itself a plane.
  for (int i = 0; i < 64; ++i)
  {
    const double tilt = 0.4 * (i / 16);
    points.col(i) << i % 4, i / 4 % 4, 0.3 * (i / 16) + tilt * (1.5 - i % 4);
  }
  EXPECT_EQ(TestCondeTorresLattice(points, { 4, 4, 4 }), CondeTorresResult::SkinsMeet);
}

TEST(CondeTorres, DistantElementsThatMeetFail)
{
  // A bar of 17 elements bent by 400 degrees; its ends run into each other.
  constexpr int N = 20;
  Eigen::Matrix3Xd points(3, N * 16);
  for (int i = 0; i < points.cols(); ++i)
  {
    const double angle = (i % N) * 400.0 / 16 * 3.14159265358979 / 180 + 0.1;
    const double radius = 3.0 + 0.4 * (i / N % 4);
    points.col(i) << radius * std::cos(angle), radius * std::sin(angle),
      0.3 * (i / N / 4) + 0.01 * (i % N);
  }
  const Spline bar(
    { models::Unclamped(3, N), models::Unclamped(3, 4), models::Unclamped(3, 4) }, points);
  const CondeTorres result = Tested(bar);
  EXPECT_GT(result.Pairs.Meeting, 0u);
  // Where the bar turns back in x or y elements fail by themselves.
  EXPECT_GT(result.Pairs.Failed, 0u);
  const CondeTorresPairs& pairs = result.Pairs;
  EXPECT_EQ(pairs.Contiguous + pairs.Failed + pairs.ByBoxes + pairs.ByHulls + pairs.ByBorders +
      pairs.Meeting,
    17u * 16 / 2);
  const auto pass = [](CondeTorresResult element) { return element == CondeTorresResult::Passes; };
  EXPECT_FALSE(std::all_of(result.Elements.begin(), result.Elements.end(), pass));
}

TEST(CondeTorres, HullsTellApartWhatBoxesDoNot)
{
  // All axes run along the diagonal, nearly: boxes of distant elements overlap.
  constexpr int N = 8;
  Eigen::Matrix3Xd points(3, N * N * 4);
  for (int i = 0; i < points.cols(); ++i)
  {
    const Eigen::Vector3d at(i % N, i / N % N, i / N / N);
    points.col(i) = 0.1 * at + 0.9 * at.sum() * Eigen::Vector3d::Ones();
  }
  const CondeTorres result = Tested(
    Spline({ models::Unclamped(3, N), models::Unclamped(3, N), models::Unclamped(3, 4) }, points));
  for (const CondeTorresResult element : result.Elements)
  {
    EXPECT_EQ(element, CondeTorresResult::Passes);
  }
  EXPECT_GT(result.Pairs.ByHulls, 0u);
}

TEST(CondeTorres, OtherSplinesGoThroughTheirUniformOrBezierForm)
{
  // A uniform cubic element and its Bezier form are one polynomial, and so is the answer.
  for (int seed = 1; seed <= 10; ++seed)
  {
    const Spline uniform = SkewLattice({ 4, 4, 4 }, 0.3, seed);
    const Spline bezier = ToBezier(Clamp(uniform));
    const CondeTorres a = Tested(uniform);
    const CondeTorres b = Tested(bezier);
    EXPECT_EQ(a.Forms[0], CondeTorresForm::Uniform);
    EXPECT_EQ(b.Forms[0], CondeTorresForm::UniformElement);
    EXPECT_EQ(a.Elements[0], b.Elements[0]);
  }
  const Spline trilinear = models::BezierVolume(
    { 1, 2, 1 }, [](int i, int j, int k) { return Eigen::Vector3d(i, j + 0.2 * i, k + 0.1 * j); });
  EXPECT_EQ(Tested(trilinear).Forms[0], CondeTorresForm::UniformElement);
  EXPECT_EQ(Tested(trilinear).Elements[0], CondeTorresResult::Passes);
  EXPECT_EQ(Tested(models::QuarterTube()).Forms[0], CondeTorresForm::Bezier);
  EXPECT_EQ(Tested(models::QuarterTube()).Elements[0], CondeTorresResult::Passes);
  EXPECT_EQ(Tested(ElevateDegree(trilinear, 0, 4)).Forms[0], CondeTorresForm::Bezier);
}

TEST(CondeTorres, RefusesWhatIsNoVolume)
{
  const KnotVector line = KnotVector::Uniform(1, 2);
  EXPECT_THROW(
    static_cast<void>(Tested(Spline({ line, line, KnotVector() }, Eigen::MatrixXd::Zero(3, 4)))),
    Error);
}
