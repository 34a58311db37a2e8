// SPDX-License-Identifier: BSD-3-Clause
#include "Measures.h"
#include "Operators.h"
#include "Splines/Models.h"

#include <gtest/gtest.h>

using namespace hyperpatch;

TEST(Handedness, IsTheSameForAnyNumberOfElements)
{
  const Spline tube = models::QuarterTube();
  Eigen::MatrixXd mirrored = tube.Coefficients();
  mirrored.row(0) *= -1.0;
  const Spline other(tube.Knots(), mirrored, tube.Weights());
  const int sign = Handedness(tube);
  EXPECT_NE(sign, 0);
  for (const int parts : { 1, 2, 7, 8, 9, 10, 16, 17 })
  {
    EXPECT_EQ(Handedness(RefineUniformly(tube, { parts, 1, parts })), sign) << parts;
    EXPECT_EQ(Handedness(RefineUniformly(other, { parts, 1, parts })), -sign) << parts;
  }
}

TEST(Handedness, OfASymmetricFoldIsNoneForAnyNumberOfElements)
{
  // det J changes its sign in the middle plane.
  const Spline folded = models::SweptHalfCylinder();
  for (const int parts : { 1, 2, 7, 8, 9, 10, 16, 17 })
  {
    EXPECT_EQ(Handedness(RefineUniformly(folded, { parts, parts, parts })), 0) << parts;
  }
}

TEST(ControlPointBounds, HoldAllPatchesAndAreZeroWhereThereIsNoCoordinate)
{
  const KnotVector knots = KnotVector::Uniform(1, 2);
  Eigen::MatrixXd plane(2, 4);
  plane << 1.0, 2.0, 1.0, 2.0, //
    -3.0, -3.0, 5.0, 5.0;
  MultiPatch model;
  model.Patches.push_back({ 0, Aggregate(Spline({ knots, knots, KnotVector() }, plane)) });
  const Bounds flat = ControlPointBounds(model);
  EXPECT_EQ(flat.Low, (std::array<double, 3>{ 1.0, -3.0, 0.0 }));
  EXPECT_EQ(flat.High, (std::array<double, 3>{ 2.0, 5.0, 0.0 }));
  Eigen::MatrixXd line(3, 2);
  line << 0.0, 9.0, 0.0, 0.0, 1.0, 7.0;
  model.Patches.push_back({ 1, Aggregate(Spline({ knots, KnotVector(), KnotVector() }, line)) });
  const Bounds both = ControlPointBounds(model);
  EXPECT_EQ(both.Low, (std::array<double, 3>{ 0.0, -3.0, 0.0 }));
  EXPECT_EQ(both.High, (std::array<double, 3>{ 9.0, 5.0, 7.0 }));
}
