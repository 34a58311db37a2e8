// SPDX-License-Identifier: BSD-3-Clause
#include "Error.h"
#include "ParameterField.h"
#include "QuadricField.h"
#include "Splines/Models.h"
#include "ZeroSet.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <random>

using namespace hyperpatch;

namespace
{

constexpr std::array<Part, 3> Everywhere{ Part::Whole, Part::Whole, Part::Whole };

Quadric Sphere(const Eigen::Vector3d& centre, double radius)
{
  return { Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero(), -radius * radius, centre };
}

}

TEST(QuadricField, BoxesOfSeveralSpansEncloseValuesAndDerivatives)
{
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (int seed = 0; seed < 40; ++seed)
  {
    const std::array<KnotVector, 3> knots{ models::RandomKnots(random, 2 + seed % 3, 9, true),
      models::RandomKnots(random, 2, 8, false), models::RandomKnots(random, 3, 9, true) };
    const Spline spline = models::RandomSpline(random, knots, 3, seed % 2 == 0);
    Quadric q = Sphere({ unit(random), unit(random), unit(random) }, unit(random));
    q.A(0, 1) = q.A(1, 0) = 0.3;
    q.b = Eigen::Vector3d(unit(random), -unit(random), 0.0);
    const QuadricField field(spline, q, true);
    ParameterBox box{};
    for (std::size_t d = 0; d < 3; ++d)
    {
      const double length = knots[d].Last() - knots[d].First();
      box.Low[d] = knots[d].First() + 0.3 * unit(random) * length;
      box.High[d] = box.Low[d] + (0.4 + 0.3 * unit(random)) * length;
    }
    BoxSpline f;
    ASSERT_TRUE(field.Restrict(box, f));
    const Range values = f.Values(Everywhere);
    for (int i = 0; i < 100; ++i)
    {
      Eigen::Vector3d p;
      for (int d = 0; d < 3; ++d)
      {
        const auto D = static_cast<std::size_t>(d);
        p[d] = box.Low[D] + (box.High[D] - box.Low[D]) * unit(random);
      }
      // Restrict() gives the function times the weight.
      const auto weighted = [&](const Eigen::Vector3d& at)
      {
        double value = 0.0;
        field.Evaluate(1, at.data(), &value);
        if (!spline.IsRational())
        {
          return value;
        }
        const Spline weight(knots, spline.Weights().transpose());
        return value * weight.Evaluate(at[0], at[1], at[2])[0];
      };
      EXPECT_TRUE(values.Contains(weighted(p))) << seed;
      for (int d = 0; d < 3; ++d)
      {
        const auto D = static_cast<std::size_t>(d);
        // The mean slope of a short chord is one of the derivative's values on it.
        const double width = box.High[D] - box.Low[D];
        Eigen::Vector3d next = p;
        next[d] = std::min(p[d] + 1e-3 * width, box.High[D]);
        const double slope =
          next[d] > p[d] ? (weighted(next) - weighted(p)) / (next[d] - p[d]) * width : 0.0;
        const Range slopes = f.Derivative(d, Everywhere);
        const double noise = 1e-11 * std::max(std::abs(slopes.Low), std::abs(slopes.High));
        EXPECT_TRUE(slopes.Low - noise <= slope && slope <= slopes.High + noise) << seed;
      }
    }
  }
}

TEST(QuadricField, TheEnclosureTightensWithTheSquareOfTheBox)
{
  // A refined identity map: what is beyond the exact hull is the rest of second order.
  const KnotVector knots = KnotVector::Uniform(2, 66);
  Eigen::MatrixXd points(3, knots.Size() * knots.Size() * knots.Size());
  for (int c = 0; c < points.cols(); ++c)
  {
    const int n = knots.Size();
    points.col(c) << knots.Greville(c % n), knots.Greville(c / n % n), knots.Greville(c / (n * n));
  }
  const Spline box({ knots, knots, knots }, points);
  const QuadricField field(box, Sphere({ 0.5, 0.5, 2.0 }, 1.5), true);
  double last = INFINITY;
  for (const double width : { 0.125, 0.0625 })
  {
    BoxSpline f;
    ASSERT_TRUE(
      field.Restrict({ { 0.5, 0.5, 0.5 }, { 0.5 + width, 0.5 + width, 0.5 + width } }, f));
    EXPECT_FALSE(f.Derivative(2, Everywhere).Contains(0.0));
    const Range slope = f.Derivative(0, Everywhere);
    const double spread = slope.High - slope.Low;
    EXPECT_LT(spread, 0.3 * last);
    last = spread;
  }
}

TEST(QuadricField, ReadOffItsValuesAQuadricIsItself)
{
  const Eigen::Vector3d centre(3.0, -2.0, 0.5);
  const auto value = [](const Eigen::Vector3d& x)
  { return 2.0 * x[0] * x[0] - x[0] * x[1] + 3.0 * x[2] * x[1] + x[2] - 4.0; };
  const auto quadric = QuadricFromValues(value, false, centre, 2.0);
  ASSERT_TRUE(quadric.has_value());
  const Eigen::Vector3d x(0.3, 7.0, -1.0);
  EXPECT_NEAR(quadric->Value(x.data()), value(x), 1e-13 * quadric->Terms(x.data()));
  EXPECT_FALSE(QuadricFromValues(
    [](const Eigen::Vector3d& p) { return 1.0 / (p[0] - 3.0); }, false, centre, 2.0));
}

TEST(ParameterField, IsoParametricSurfacesHaveTheParameterToTheLastBit)
{
  const Aggregate body(models::QuarterTube());
  const Spline& tube = body.Geometry();
  // In a face, in the middle, and beyond the domain.
  for (int d = 0; d < 3; ++d)
  {
    const double first = tube.Knots(d).First();
    const double last = tube.Knots(d).Last();
    for (const double value : { first, first + 0.3 * (last - first), last })
    {
      const ParameterField field(tube, d, value);
      ZeroSet surface(body, field, {});
      ASSERT_TRUE(surface.Extract());
      ASSERT_GT(surface.Mesh().Cells.cols(), 0);
      EXPECT_TRUE((surface.Mesh().Parameters.row(d).array() == value).all());
      EXPECT_EQ(surface.Certificate().UndecidedCells, 0);
      EXPECT_LE(surface.Certificate().LargestError, 1e-3);
    }
    const ParameterField beyond(tube, d, last + 1e-9);
    ZeroSet none(body, beyond, {});
    ASSERT_TRUE(none.Extract());
    EXPECT_EQ(none.Mesh().Cells.cols(), 0);
  }
}

TEST(ParameterField, ADirectionThatIsNotThereIsAnError)
{
  const Spline tube = models::QuarterTube();
  EXPECT_THROW(ParameterField(tube, 3, 0.5), Error);
  EXPECT_THROW(ParameterField(tube, -1, 0.5), Error);
  const KnotVector line = KnotVector::Uniform(1, 2);
  const Spline curve({ line, {}, {} }, Eigen::MatrixXd::Random(3, 2));
  EXPECT_THROW(ParameterField(curve, 1, 0.5), Error);
}
