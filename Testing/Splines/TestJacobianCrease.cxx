// SPDX-License-Identifier: BSD-3-Clause
#include "JacobianCrease.h"

#include "Error.h"
#include "Operators.h"
#include "Splines/Models.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

using namespace hyperpatch;

namespace
{

constexpr double Pi = 3.14159265358979323846;

/// A block with a C0 knot at u = 1/2: x grows by 2 u below it and by slope (u - 1/2) above, where
/// the slope has the given Bernstein coefficients, quadratic in v and w; y = v, z = w. So det J is
/// 2 below and the slope above.
struct Halves
{
  Spline Below, Above;
};

Halves Kinked(const Eigen::Matrix3d& slope, int pieces = 1)
{
  Eigen::MatrixXd points(3, 27);
  for (int i = 0; i < 27; ++i)
  {
    const int u = i % 3;
    const int v = i / 3 % 3;
    const int w = i / 9;
    points.col(i) << (u == 0 ? 0.0 : u == 1 ? 1.0 : 1.0 + 0.5 * slope(v, w)), v / 2.0, w / 2.0;
  }
  const KnotVector quadratic = KnotVector::Uniform(2, 3);
  const Spline s({ KnotVector(1, { 0, 0, 0.5, 1, 1 }), quadratic, quadratic }, points);
  const Spline fine = RefineUniformly(s, { 1, pieces, pieces });
  return { RestrictToSpans(fine, { 0, 0, 0 }, { 1, pieces, pieces }),
    RestrictToSpans(fine, { 1, 0, 0 }, { 2, pieces, pieces }) };
}

/// (v - 1/2)^2 + (w - 1/2)^2 - r^2.
Eigen::Matrix3d Circle(double r)
{
  const Eigen::Vector3d square(0.25, -0.25, 0.25);
  Eigen::Matrix3d f;
  for (int v = 0; v < 3; ++v)
  {
    for (int w = 0; w < 3; ++w)
    {
      f(v, w) = square[v] + square[w] - r * r;
    }
  }
  return f;
}

double Area(const JacobianCrease& crease)
{
  double area = 0.0;
  for (Eigen::Index t = 0; t < crease.Triangles.cols(); ++t)
  {
    const Eigen::Vector3d a = crease.Points.col(crease.Triangles(0, t));
    const Eigen::Vector3d normal = (crease.Points.col(crease.Triangles(1, t)) - a)
                                     .cross(crease.Points.col(crease.Triangles(2, t)) - a);
    // Turning with the normals of the vertices.
    EXPECT_GE(normal.dot(crease.Normals.col(crease.Triangles(0, t))), 0.0);
    area += 0.5 * normal.norm();
  }
  return area;
}

}

TEST(JacobianCrease, IsAllOfAPlaneWhereTheMapTurnsBack)
{
  const Halves back = Kinked(Eigen::Matrix3d::Constant(-0.5));
  const JacobianCrease crease = ExtractJacobianCrease(back.Below, back.Above, 0, 4, 0.1);
  EXPECT_NEAR(Area(crease), 1.0, 1e-14);
  EXPECT_TRUE((crease.Parameters.row(0).array() == 0.5).all());
  EXPECT_TRUE((crease.Points.row(0).array() == 1.0).all());
  // det J > 0 below the plane, that is against x.
  EXPECT_TRUE((crease.Normals.row(0).array() == -1.0).all());
  EXPECT_EQ(crease.UndecidedCells, 0);
  EXPECT_EQ(crease.LargestError, 0.0);
}

TEST(JacobianCrease, IsNowhereWhereSignsAreEqual)
{
  for (const double slope : { 0.01, 5.0 })
  {
    const Halves on = Kinked(Eigen::Matrix3d::Constant(slope));
    EXPECT_EQ(ExtractJacobianCrease(on.Below, on.Above, 0, 4, 0.1).Triangles.cols(), 0);
  }
}

TEST(JacobianCrease, IsExactlyThePartWhereTheSignsDiffer)
{
  const Halves round = Kinked(Circle(0.3), 3);
  double last = 1.0;
  for (const int subdivision : { 4, 8, 16, 32 })
  {
    const JacobianCrease crease =
      ExtractJacobianCrease(round.Below, round.Above, 0, subdivision, 0.01);
    // Every vertex is inside, or on the circle to round-off.
    int border = 0;
    for (Eigen::Index i = 0; i < crease.Points.cols(); ++i)
    {
      const double r = std::hypot(crease.Points(1, i) - 0.5, crease.Points(2, i) - 0.5);
      ASSERT_LT(r, 0.3 + 1e-13);
      border += r > 0.3 - 1e-13;
    }
    EXPECT_GT(border, 8 * subdivision);
    // Chords of a circle: the area lacks, and the measured error is, at most the sagitta.
    EXPECT_NEAR(Area(crease), Pi * 0.09, 2 * Pi * 0.3 * crease.LargestError);
    EXPECT_LT(crease.LargestError, 0.5 * last);
    last = crease.LargestError;
    EXPECT_EQ(crease.UndecidedCells, 0);
  }
  EXPECT_LT(last, 1e-4);
}

TEST(JacobianCrease, OfEveryDirectionAndHandednessIsTheSame)
{
  const Halves round = Kinked(Circle(0.3), 2);
  const double area = Area(ExtractJacobianCrease(round.Below, round.Above, 0, 8, 0.01));
  const auto turned = [](const Spline& s)
  {
    // u, v, w become w, u, v.
    const auto n = s.Sizes();
    Eigen::MatrixXd points(3, s.Coefficients().cols());
    for (int i = 0, at = 0; i < n[0]; ++i)
    {
      for (int k = 0; k < n[2]; ++k)
      {
        for (int j = 0; j < n[1]; ++j, ++at)
        {
          points.col(at) = s.Coefficients().col(i + n[0] * (j + n[1] * k));
        }
      }
    }
    return Spline({ s.Knots()[1], s.Knots()[2], s.Knots()[0] }, points);
  };
  const Spline below = turned(round.Below);
  const Spline above = turned(round.Above);
  EXPECT_NEAR(Area(ExtractJacobianCrease(below, above, 2, 8, 0.01)), area, 1e-13);
  const auto mirrored = [](const Spline& s)
  { return Spline(s.Knots(), Eigen::Vector3d(-1, 1, 1).asDiagonal() * s.Coefficients()); };
  EXPECT_NEAR(Area(ExtractJacobianCrease(mirrored(round.Below), mirrored(round.Above), 0, 8, 0.01)),
    area, 1e-13);
}

TEST(JacobianCrease, CountsWhatIsLeftOpen)
{
  // The slope is 0 at the centre of the plane and positive around it.
  const Halves touching = Kinked(Circle(0.0));
  const JacobianCrease coarse = ExtractJacobianCrease(touching.Below, touching.Above, 0, 2, 0.01);
  EXPECT_GT(coarse.UndecidedCells, 0);
  EXPECT_TRUE(coarse.HasWideUndecidedCells);
  const JacobianCrease fine = ExtractJacobianCrease(touching.Below, touching.Above, 0, 256, 0.01);
  EXPECT_GT(fine.UndecidedCells, 0);
  EXPECT_FALSE(fine.HasWideUndecidedCells);
  EXPECT_EQ(fine.Triangles.cols(), 0);
  // A circle between the grid lines shows on a finer grid.
  const Halves small = Kinked(Circle(0.05), 3);
  const JacobianCrease unseen = ExtractJacobianCrease(small.Below, small.Above, 0, 1, 0.01);
  EXPECT_EQ(unseen.Triangles.cols(), 0);
  EXPECT_TRUE(unseen.HasWideUndecidedCells);
  EXPECT_GT(ExtractJacobianCrease(small.Below, small.Above, 0, 32, 0.01).Triangles.cols(), 0);
}

TEST(JacobianCrease, IsNowhereWhereOnlyTheSpeedJumps)
{
  // Two arcs of 90 degrees with a double knot between them make a tube whose section is squeezed,
  // so that det J changes its sign on both sides of the plane at the same radius.
  const double r = std::sqrt(0.5);
  const double arcs[5][3] = { { 1, 0, 1 }, { 1, 1, r }, { 0, 1, 1 }, { -1, 1, r }, { -1, 0, 1 } };
  for (const double stretch : { 1.0, 3.0 })
  {
    Eigen::MatrixXd points(3, 30);
    Eigen::VectorXd weights(30);
    for (int n = 0; n < 30; ++n)
    {
      const int v = n / 5 % 3;
      const double radius = v == 1 ? 3.0 : 1.0;
      points.col(n) << radius * arcs[n % 5][0], radius * arcs[n % 5][1], n / 15 + 0.3 * v;
      weights[n] = arcs[n % 5][2];
    }
    const Spline s({ KnotVector(2, { 0, 0, 0, 1, 1, 1 + stretch, 1 + stretch, 1 + stretch }),
                     KnotVector::Uniform(2, 3), KnotVector::Uniform(1, 2) },
      points, weights);
    const JacobianCrease crease =
      ExtractJacobianCrease(RestrictToSpans(s, { 0, 0, 0 }, { 1, 1, 1 }),
        RestrictToSpans(s, { 1, 0, 0 }, { 2, 1, 1 }), 0, 8, 0.01);
    EXPECT_EQ(crease.Triangles.cols(), 0);
    EXPECT_EQ(crease.UndecidedCells, 0);
  }
}

TEST(JacobianCrease, IsNowhereWhereBothSidesFoldTogether)
{
  // y folds back at the same v on both sides, x grows by 2 u below and by (1 + v) (u - 1/2) above.
  Eigen::MatrixXd points(3, 24);
  const double y[4] = { 0.0, 1.0, 0.7, 0.2 };
  for (int i = 0; i < 24; ++i)
  {
    const int u = i % 3;
    const int v = i / 3 % 4;
    points.col(i) << (u == 0 ? 0.0 : u == 1 ? 1.0 : 1.0 + 0.5 * (1.0 + v / 3.0)), y[v], i / 12;
  }
  const Spline s(
    { KnotVector(1, { 0, 0, 0.5, 1, 1 }), KnotVector::Uniform(3, 4), KnotVector::Uniform(1, 2) },
    points);
  for (const int subdivision : { 4, 64 })
  {
    const JacobianCrease crease =
      ExtractJacobianCrease(RestrictToSpans(s, { 0, 0, 0 }, { 1, 1, 1 }),
        RestrictToSpans(s, { 1, 0, 0 }, { 2, 1, 1 }), 0, subdivision, 1e-6);
    EXPECT_EQ(crease.Triangles.cols(), 0);
    // The cells on the fold, and no reason to refine them.
    EXPECT_EQ(crease.UndecidedCells, subdivision);
    EXPECT_FALSE(crease.HasWideUndecidedCells);
  }
}

TEST(JacobianCrease, LeavesSheetsInThePlaneAlone)
{
  // det J = 0 above, all over the plane.
  Halves flat = Kinked(Eigen::Matrix3d::Zero());
  const JacobianCrease crease = ExtractJacobianCrease(flat.Below, flat.Above, 0, 4, 0.01);
  EXPECT_EQ(crease.Triangles.cols(), 0);
  EXPECT_EQ(crease.UndecidedCells, 0);
}

TEST(JacobianCrease, RefusesVolumesThatDoNotMeet)
{
  const Halves halves = Kinked(Circle(0.3));
  EXPECT_THROW((void)ExtractJacobianCrease(halves.Above, halves.Below, 0, 4, 0.1), Error);
  EXPECT_THROW((void)ExtractJacobianCrease(halves.Below, halves.Above, 1, 4, 0.1), Error);
  EXPECT_THROW((void)ExtractJacobianCrease(halves.Below, halves.Above, 3, 4, 0.1), Error);
  EXPECT_THROW((void)ExtractJacobianCrease(halves.Below, halves.Above, 0, 3, 0.1), Error);
  EXPECT_THROW((void)ExtractJacobianCrease(halves.Below, halves.Above, 0, 0, 0.1), Error);
}
