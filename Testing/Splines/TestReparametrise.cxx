// SPDX-License-Identifier: BSD-3-Clause
#include "Reparametrise.h"

#include "Error.h"
#include "Interfaces.h"
#include "Measures.h"
#include "Operators.h"
#include "Primitives.h"
#include "Splines/Models.h"

#include <gtest/gtest.h>

#include <limits>
#include <set>

using namespace hyperpatch;

namespace
{

constexpr double Epsilon = std::numeric_limits<double>::epsilon();

Spline Volume(std::mt19937& random, bool rational)
{
  return models::RandomSpline(random,
    { models::RandomKnots(random, 2, 6, true), models::RandomKnots(random, 3, 9, false),
      models::RandomKnots(random, 1, 4, true) },
    3, rational);
}

/// Parameters at fractions of the domain.
Eigen::VectorXd At(const Spline& s, double u, double v, double w)
{
  const auto in = [](const KnotVector& k, double t) { return (1 - t) * k.First() + t * k.Last(); };
  return s.Evaluate(in(s.Knots(0), u), in(s.Knots(1), v), in(s.Knots(2), w));
}

constexpr double Places[][3] = { { 0, 0, 0 }, { 0.2, 0.7, 0.4 }, { 1, 0.5, 0.3 }, { 0.9, 1, 1 } };

/// Interfaces as a set, each named from its lesser side.
std::set<std::array<int, 10>> AsSet(const std::vector<Interface>& interfaces)
{
  std::set<std::array<int, 10>> result;
  for (const Interface& item : interfaces)
  {
    result.insert(item.Values);
  }
  return result;
}

}

TEST(Reparametrise, ScaledDomainsKeepTheMap)
{
  std::mt19937 random(1);
  for (const bool rational : { false, true })
  {
    const Spline before = Volume(random, rational);
    const Spline after = ScaleDomain(ScaleDomain(before, 0), 1, -3.0, 7.0);
    EXPECT_EQ(after.Knots(0).First(), 0.0);
    EXPECT_EQ(after.Knots(0).Last(), 1.0);
    EXPECT_EQ(after.Knots(1).First(), -3.0);
    EXPECT_EQ(after.Knots(1).Last(), 7.0);
    EXPECT_EQ(after.Coefficients(), before.Coefficients());
    for (const auto& p : Places)
    {
      EXPECT_LE((At(after, p[0], p[1], p[2]) - At(before, p[0], p[1], p[2])).norm(), 200 * Epsilon);
    }
  }
  EXPECT_THROW((void)ScaleDomain(Volume(random, false), 0, 1.0, 1.0), Error);
  EXPECT_THROW((void)ScaleDomain(Volume(random, false), 3), Error);
}

TEST(Reparametrise, ReversingTwiceGivesTheSplineBack)
{
  std::mt19937 random(2);
  const Spline before = Volume(random, true);
  for (int d = 0; d < 3; ++d)
  {
    const Spline after = ReverseDirection(before, d);
    EXPECT_EQ(after.Knots(d).First(), before.Knots(d).First());
    EXPECT_EQ(after.Knots(d).Last(), before.Knots(d).Last());
    for (const auto& p : Places)
    {
      std::array<double, 3> q{ p[0], p[1], p[2] };
      q[static_cast<std::size_t>(d)] = 1.0 - p[d];
      EXPECT_LE((At(after, p[0], p[1], p[2]) - At(before, q[0], q[1], q[2])).norm(), 200 * Epsilon);
    }
    EXPECT_EQ(ReverseDirection(after, d).Coefficients(), before.Coefficients());
    EXPECT_EQ(Handedness(after), -Handedness(before));
  }
}

TEST(Reparametrise, SwappingExchangesParameters)
{
  std::mt19937 random(3);
  const Spline before = Volume(random, true);
  const Spline after = SwapDirections(before, 0, 2);
  for (const auto& p : Places)
  {
    EXPECT_EQ(At(after, p[0], p[1], p[2]).size(), 3);
    EXPECT_LE((At(after, p[2], p[1], p[0]) - At(before, p[0], p[1], p[2])).norm(), 200 * Epsilon);
  }
  EXPECT_EQ(SwapDirections(after, 2, 0), before);
  EXPECT_EQ(SwapDirections(before, 1, 1), before);
  EXPECT_EQ(Handedness(after), -Handedness(before));
}

TEST(Reparametrise, InterfacesAndBoundariesFollow)
{
  // What follows must be what is found from the control points.
  MultiPatch model = MakeSphere(1.0, Parametrisation::Patches);
  model.Boundaries = { { "skin", { { 1, 5 }, { 2, 5 } } }, { "core", { { 0, 0 } } } };
  for (int d = 0; d < 3; ++d)
  {
    const MultiPatch reversed = ReverseDirection(model, d);
    EXPECT_EQ(AsSet(reversed.Interfaces), AsSet(FindInterfaces(reversed, 1e-9)));
    const MultiPatch swapped = SwapDirections(model, d, (d + 1) % 3);
    EXPECT_EQ(AsSet(swapped.Interfaces), AsSet(FindInterfaces(swapped, 1e-9)));
  }
  EXPECT_EQ(ReverseDirection(model, 2).Boundaries[0].Sides[0], (std::array<int, 2>{ 1, 4 }));
  EXPECT_EQ(SwapDirections(model, 0, 2).Boundaries[0].Sides[1], (std::array<int, 2>{ 2, 1 }));
  EXPECT_EQ(SwapDirections(model, 0, 2).Boundaries[1].Sides[0], (std::array<int, 2>{ 0, 4 }));

  MultiPatch part = model;
  part.Patches[0] =
    RestrictPatch({ 0, Aggregate(RefineUniformly(model.Patches[0].Body.Geometry(), { 2, 2, 2 })) },
      { 0, 0, 0 }, { 1, 1, 1 });
  EXPECT_THROW((void)ReverseDirection(part, 0), Error);
  EXPECT_THROW((void)SwapDirections(part, 0, 1), Error);
}

TEST(Reparametrise, CompatibleSplinesHaveOneBasisAndTheirOldMaps)
{
  std::mt19937 random(4);
  for (int round = 0; round < 20; ++round)
  {
    std::vector<Spline> before;
    for (int i = 0; i < 3; ++i)
    {
      const int p = 1 + static_cast<int>(random() % 4);
      before.push_back(models::RandomSpline(random,
        { models::RandomKnots(random, p, 2 * p + 3, random() % 2 == 0),
          models::RandomKnots(random, 2, 4, true), {} },
        2, (round + i) % 3 == 0));
    }
    const std::vector<Spline> after = MakeCompatible(before);
    for (std::size_t i = 0; i < 3; ++i)
    {
      EXPECT_EQ(after[i].Knots(), after[0].Knots());
      EXPECT_TRUE(after[i].IsRational());
      for (const auto& p : Places)
      {
        // Elevation and insertion are convex combinations of numbers up to 1.
        EXPECT_LE((At(after[i], p[0], p[1], 0) - At(before[i], p[0], p[1], 0)).norm(), 1e-12);
      }
    }
  }
  EXPECT_THROW((void)MakeCompatible({}), Error);
  EXPECT_THROW((void)MakeCompatible({ models::QuarterTube(),
                 models::RandomSpline(random, models::QuarterTube().Knots(), 2, false) }),
    Error);
}
