// SPDX-License-Identifier: BSD-3-Clause
#include "ControlBounds.h"
#include "Splines/Models.h"

#include <gtest/gtest.h>

#include <algorithm>

using namespace hyperpatch;

TEST(ControlBounds, HoldTheSplineOnBoxesOfAnySize)
{
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int seed = 0; seed < 12; ++seed)
  {
    const Spline spline = models::RandomSpline(random,
      { models::RandomKnots(random, 1 + seed % 3, 23, seed % 2 == 0),
        models::RandomKnots(random, 2, 9, true), models::RandomKnots(random, 1, 4, true) },
      1 + seed % 4, seed % 3 == 0);
    const ControlBounds bounds(spline);
    for (int trial = 0; trial < 50; ++trial)
    {
      ParameterBox box{};
      for (int d = 0; d < 3; ++d)
      {
        const KnotVector& knots = spline.Knots(d);
        double a = knots.First() + (knots.Last() - knots.First()) * unit(random);
        double b = knots.First() + (knots.Last() - knots.First()) * unit(random);
        // Some boxes end on knots, as those of elements do.
        if (trial % 3 == 0)
        {
          a = knots[knots.FindSpan(a)];
          b = knots[knots.FindSpan(b) + 1];
        }
        box.Low[static_cast<std::size_t>(d)] = std::min(a, b);
        box.High[static_cast<std::size_t>(d)] = std::max(a, b);
      }
      Eigen::VectorXd low(spline.Components());
      Eigen::VectorXd high(spline.Components());
      bounds.Find(box, low.data(), high.data());
      for (int sample = 0; sample < 20; ++sample)
      {
        double p[3];
        for (std::size_t d = 0; d < 3; ++d)
        {
          p[d] =
            box.Low[d] + (box.High[d] - box.Low[d]) * (sample < 8 ? sample >> d & 1 : unit(random));
        }
        const Eigen::VectorXd value = spline.Evaluate(p[0], p[1], p[2]);
        // A convex combination of control points of size 1, to round-off.
        EXPECT_TRUE((value.array() >= low.array() - 1e-14).all());
        EXPECT_TRUE((value.array() <= high.array() + 1e-14).all());
      }
    }
  }
}

TEST(ControlBounds, OfTheWholeAreThoseOfTheControlPointsAndOfAnElementThoseOfItsWindow)
{
  std::mt19937 random(4);
  const KnotVector k = KnotVector::Uniform(2, 20);
  const Spline spline = models::RandomSpline(random, { k, k, k }, 2, true);
  const ControlBounds bounds(spline);
  Eigen::Vector2d low;
  Eigen::Vector2d high;
  bounds.Find({ { 0, 0, 0 }, { 1, 1, 1 } }, low.data(), high.data());
  EXPECT_EQ(low, spline.Coefficients().rowwise().minCoeff());
  EXPECT_EQ(high, spline.Coefficients().rowwise().maxCoeff());

  const double h = 1.0 / 18;
  bounds.Find({ { 0, 0, 0 }, { h, h, h } }, low.data(), high.data());
  Eigen::Vector2d expected = Eigen::Vector2d::Constant(INFINITY);
  for (int i = 0; i < 27; ++i)
  {
    expected = expected.cwiseMin(
      Eigen::Vector2d(spline.Coefficients().col(i % 3 + 20 * (i / 3 % 3 + 20 * (i / 9)))));
  }
  EXPECT_EQ(low, expected);
}
