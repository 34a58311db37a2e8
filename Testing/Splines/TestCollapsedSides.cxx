// SPDX-License-Identifier: BSD-3-Clause
#include "CollapsedSidesWorker.h"
#include "FreeParametersWorker.h"
#include "Primitives.h"

#include <gtest/gtest.h>

#include <array>

using namespace hyperpatch;

namespace
{

constexpr unsigned U0 = 1;
constexpr unsigned U1 = 2;
constexpr unsigned V0 = 4;
constexpr unsigned V1 = 8;
constexpr unsigned W0 = 16;
constexpr unsigned W1 = 32;
constexpr unsigned U = 1;
constexpr unsigned V = 2;
constexpr unsigned W = 4;

CollapsedSides Of(const MultiPatch& model)
{
  return { model.Patches[0].Body.Geometry(), 1e-12 };
}

/// The unit cube of degree 1, its corners moved: c -> where corner c (u fastest) goes.
Spline Hexahedron(const std::array<int, 8>& corners)
{
  const KnotVector line = KnotVector::Uniform(1, 2);
  Eigen::MatrixXd points(3, 8);
  for (int c = 0; c < 8; ++c)
  {
    const int to = corners[static_cast<std::size_t>(c)];
    points.col(c) << (to & 1), (to >> 1 & 1), (to >> 2);
  }
  return { { line, line, line }, points };
}

}

TEST(CollapsedSides, AxesPolesAndApexesAreFound)
{
  const CollapsedSides box = Of(MakeBox({ 1, 1, 1 }));
  EXPECT_FALSE(box.IsAny());

  const CollapsedSides cylinder = Of(MakeCylinder(1.0, 1.0, Parametrisation::Poles));
  EXPECT_EQ(cylinder.Free(U0), V);
  EXPECT_EQ(cylinder.Free(U1 | V0 | W0), 0u);
  EXPECT_EQ(cylinder.Free(U0 | V0 | W1), V);
  EXPECT_FALSE(cylinder.NeedsMiddle(0));

  const CollapsedSides cone = Of(MakeCone(1.0, 0.0, 1.0, Parametrisation::Poles));
  EXPECT_EQ(cone.Free(U0), V);
  EXPECT_EQ(cone.Free(W1), U | V);
  EXPECT_FALSE(cone.NeedsMiddle(2));

  const CollapsedSides ball = Of(MakeSphere(1.0, Parametrisation::Poles));
  EXPECT_EQ(ball.Free(U0), V | W);
  EXPECT_EQ(ball.Free(V0), W);
  EXPECT_EQ(ball.Free(V1 | U1), W);
  // What is between the poles has no longitude of theirs.
  EXPECT_TRUE(ball.NeedsMiddle(1));
  EXPECT_EQ(ball.SidesOf({ 0, 0, 0 }), U0 | V0 | V1 | W0 | W1);
}

TEST(CollapsedSides, AnEdgeAloneIsFound)
{
  // The edge at u = 0, w = 1 along v.
  const CollapsedSides wedge(Hexahedron({ 0, 1, 2, 3, 4, 5, 4, 7 }), 1e-12);
  EXPECT_EQ(wedge.Free(U0), 0u);
  EXPECT_EQ(wedge.Free(W1), 0u);
  EXPECT_EQ(wedge.Free(U0 | W1), V);
}

TEST(CollapsedSides, OnePointInTheShapeOfAnLIsLeftAlone)
{
  // u = 0 is collapsed along v, and v = 1 along u.
  const CollapsedSides lens(Hexahedron({ 0, 1, 0, 0, 4, 5, 4, 4 }), 1e-12);
  EXPECT_EQ(lens.Free(U0), V);
  EXPECT_EQ(lens.Free(V1), 0u);
}

TEST(CollapsedSides, WeightsCanSpreadWhatControlPointsCollapse)
{
  // All along v the points are the same, but not where their weights draw the curve along w.
  const Spline wedge = Hexahedron({ 0, 1, 0, 3, 4, 5, 4, 7 });
  EXPECT_EQ(CollapsedSides(wedge, 1e-12).Free(U0), V);
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(8);
  weights[2] = 2.0;
  EXPECT_EQ(
    CollapsedSides(Spline(wedge.Knots(), wedge.Coefficients(), weights), 1e-12).Free(U0), 0u);
  // The same ratio at both ends of w does nothing.
  weights[6] = 2.0;
  EXPECT_EQ(
    CollapsedSides(Spline(wedge.Knots(), wedge.Coefficients(), weights), 1e-12).Free(U0), V);
}

TEST(FreeParameters, LinesThroughAPoleAreStraight)
{
  // Polar coordinates: the middle of two points is that of (u, u v).
  const FreeParameters pole{ { 0, 0, 0 }, { 1, 0, 1 } };
  const FreeParameters a{ { 1, 0.2, 0.5 }, { 1, 1, 1 } };
  const FreeParameters b{ { 1, 0.8, 0.5 }, { 1, 1, 1 } };
  const FreeParameters half = Middle(pole, a);
  EXPECT_EQ(half.Values, Eigen::Vector3d(0.5, 0.2, 0.25));
  EXPECT_EQ(half.Weights, Eigen::Vector3d(1, 0.5, 1));
  const FreeParameters across = Middle(half, b);
  EXPECT_DOUBLE_EQ(across.Values[1] * across.Values[0], 0.5 * (0.5 * 0.2 + 1.0 * 0.8));
  EXPECT_DOUBLE_EQ(across.Weights[1], across.Values[0]);
  EXPECT_EQ(Middle(pole, pole).Weights[1], 0.0);
}
