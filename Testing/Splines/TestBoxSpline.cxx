// SPDX-License-Identifier: BSD-3-Clause
#include "BoxSpline.h"
#include "Evaluator.h"
#include "Splines/Models.h"

#include <gtest/gtest.h>

#include <random>

using namespace hyperpatch;

namespace
{

constexpr std::array<Part, 3> Everywhere{ Part::Whole, Part::Whole, Part::Whole };

BoxSpline Restricted(const Spline& spline, const ParameterBox& box)
{
  BoxSpline f;
  f.Restrict(spline, box, [&spline](Eigen::Index i) { return spline.Coefficients()(0, i); });
  return f;
}

}

TEST(BoxSpline, EnclosesValuesAndDerivativesOnTheBoxAndItsFaces)
{
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int seed = 0; seed < 60; ++seed)
  {
    const std::array<KnotVector, 3> knots{ models::RandomKnots(random, 1 + seed % 4, 7, true),
      models::RandomKnots(random, 1 + seed / 4 % 4, 12, false),
      models::RandomKnots(random, 2, 9, seed % 2 == 0) };
    const Spline spline = models::RandomSpline(random, knots, 1, false);
    const Evaluator evaluator(spline);
    ParameterBox box{};
    Eigen::Vector3d width;
    bool hasCrease = false;
    for (std::size_t d = 0; d < 3; ++d)
    {
      const double first = knots[d].First();
      const double length = knots[d].Last() - first;
      const double a = seed % 3 == 0 ? 0.0 : unit(random);
      const double b = seed % 5 == 0 ? 1.0 : unit(random);
      box.Low[d] = first + length * std::min(a, b);
      box.High[d] = first + length * std::max({ a, b, std::min(a, b) + 1e-3 });
      box.High[d] = std::min(box.High[d], knots[d].Last());
      width[static_cast<Eigen::Index>(d)] = box.High[d] - box.Low[d];
      for (const double crease : knots[d].Creases())
      {
        hasCrease = hasCrease || (box.Low[d] < crease && crease < box.High[d]);
      }
    }
    if (width.minCoeff() <= 0.0)
    {
      continue;
    }
    const BoxSpline f = Restricted(spline, box);
    const Range values = f.Values(Everywhere);
    const Range onFace = f.Values({ Part::Low, Part::Whole, Part::High });
    for (int i = 0; i < 200; ++i)
    {
      Eigen::Vector3d p;
      for (int d = 0; d < 3; ++d)
      {
        const auto D = static_cast<std::size_t>(d);
        p[d] = box.Low[D] + (box.High[D] - box.Low[D]) * unit(random);
      }
      double value = 0.0;
      Eigen::Vector3d gradient;
      evaluator.EvaluateWithDerivatives(1, p.data(), &value, gradient.data());
      EXPECT_TRUE(values.Contains(value));
      for (int d = 0; d < 3 && !hasCrease; ++d)
      {
        EXPECT_TRUE(f.Derivative(d, Everywhere).Contains(gradient[d] * width[d]));
      }
      p[0] = box.Low[0];
      p[2] = box.High[2];
      evaluator.Evaluate(1, p.data(), &value);
      EXPECT_TRUE(onFace.Contains(value));
    }
    // Clamped at its ends, it is known exactly in its corners.
    const Range corner = f.Values({ Part::High, Part::Low, Part::High });
    const Eigen::Vector3d at(box.High[0], box.Low[1], box.High[2]);
    double value = 0.0;
    evaluator.Evaluate(1, at.data(), &value);
    EXPECT_TRUE(corner.Contains(value));
    EXPECT_LT(corner.High - corner.Low, 1e-12);
  }
}

TEST(BoxSpline, LooksAtNoMoreControlPointsThanAsked)
{
  const KnotVector knots = KnotVector::Uniform(2, 6);
  std::mt19937 random(3);
  const Spline spline = models::RandomSpline(random, { knots, knots, knots }, 1, false);
  const auto coefficient = [&spline](Eigen::Index i) { return spline.Coefficients()(0, i); };
  // Four spans: windows of 3 control points on one of them, of 4 on two.
  BoxSpline f;
  EXPECT_TRUE(f.Restrict(spline, { { 0.0, 0.0, 0.0 }, { 0.2, 0.2, 0.3 } }, coefficient, 36.0));
  EXPECT_FALSE(f.Restrict(spline, { { 0.0, 0.0, 0.0 }, { 0.2, 0.2, 0.3 } }, coefficient, 35.0));
}

TEST(BoxSpline, HullsTightenWithTheSquareOfTheBox)
{
  std::mt19937 random(9);
  const KnotVector k = KnotVector::Uniform(3, 8);
  const Spline spline = models::RandomSpline(random, { k, k, k }, 1, false);
  const Evaluator evaluator(spline);
  double previous = 0.0;
  for (const double size : { 0.4, 0.2, 0.1 })
  {
    const ParameterBox box{ { 0.41, 0.41, 0.41 }, { 0.41 + size, 0.41 + size, 0.41 + size } };
    const Range hull = Restricted(spline, box).Values(Everywhere);
    double low = INFINITY;
    double high = -INFINITY;
    for (int i = 0; i < 21 * 21 * 21; ++i)
    {
      const Eigen::Vector3d p = Eigen::Vector3d::Constant(0.41) +
        size / 20.0 * Eigen::Vector3d(i % 21, i / 21 % 21, static_cast<double>(i / 441));
      double value = 0.0;
      evaluator.Evaluate(1, p.data(), &value);
      low = std::min(low, value);
      high = std::max(high, value);
    }
    const double excess = (low - hull.Low) + (hull.High - high);
    EXPECT_GE(excess, -1e-14);
    if (previous > 0.0)
    {
      EXPECT_LT(excess, 0.5 * previous + 1e-12);
    }
    previous = excess;
  }
}
