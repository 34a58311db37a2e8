// SPDX-License-Identifier: BSD-3-Clause
#include "JacobianField.h"

#include "Models.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

using namespace hyperpatch;

namespace
{

constexpr std::array<Part, 3> Everywhere{ Part::Whole, Part::Whole, Part::Whole };

/// A box inside the element of these spans.
ParameterBox BoxIn(std::mt19937& random, const Spline& geometry, const std::array<int, 3>& spans)
{
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  ParameterBox box{};
  for (std::size_t d = 0; d < 3; ++d)
  {
    const KnotVector& knots = geometry.Knots()[d];
    const int s = knots.Spans()[static_cast<std::size_t>(spans[d])];
    const double size = 0.5 * unit(random) + 0.1;
    box.Low[d] = knots[s] + (1.0 - size) * unit(random) * (knots[s + 1] - knots[s]);
    box.High[d] = box.Low[d] + size * (knots[s + 1] - knots[s]);
  }
  return box;
}

/// Whether the hull on a box is that of coefficients computed for it, but for the positive factor
/// between the unit cubes of box and element.
bool HasTheHullOf(const JacobianField& field, const Spline& geometry,
  const std::array<int, 3>& spans, const ParameterBox& box)
{
  BoxSpline f;
  if (!field.Restrict(box, f))
  {
    return false;
  }
  const Bernstein computed = *field.OnBox(box);
  double factor = 1.0;
  for (std::size_t d = 0; d < 3; ++d)
  {
    const KnotVector& knots = geometry.Knots()[d];
    const int s = knots.Spans()[static_cast<std::size_t>(spans[d])];
    factor *= (box.High[d] - box.Low[d]) / (knots[s + 1] - knots[s]);
  }
  const Range hull = f.Values(Everywhere);
  // The hull has the rounding bound in it, some thousand roundings of products of four numbers up
  // to tens.
  const double tolerance = 1e-9;
  return std::abs(hull.Low * factor - computed.Min()) <= tolerance &&
    std::abs(hull.High * factor - computed.Max()) <= tolerance &&
    hull.Low * factor <= computed.Min() + computed.RoundingBound() &&
    hull.High * factor >= computed.Max() - computed.RoundingBound();
}

Spline RandomVolume(std::mt19937& random, bool rational)
{
  std::array<KnotVector, 3> knots;
  for (KnotVector& k : knots)
  {
    const int degree = 1 + static_cast<int>(random() % 3);
    k = models::RandomKnots(random, degree, degree + 6, true);
  }
  return models::RandomSpline(random, knots, 3, rational);
}

}

TEST(JacobianField, HalvesCoefficientsToWhatTheyAreOnTheBox)
{
  std::mt19937 random(1);
  for (int round = 0; round < 20; ++round)
  {
    const Spline geometry = RandomVolume(random, round % 2 == 0);
    const JacobianField field(geometry);
    for (int n = 0; n < 20; ++n)
    {
      std::array<int, 3> spans{};
      for (std::size_t d = 0; d < 3; ++d)
      {
        spans[d] = static_cast<int>(random() % geometry.Knots()[d].Spans().size());
      }
      ASSERT_TRUE(HasTheHullOf(field, geometry, spans, BoxIn(random, geometry, spans)));
    }
  }
}

TEST(JacobianField, KnowsNothingOnBoxesOfSeveralElements)
{
  std::mt19937 random(2);
  const Spline geometry = RandomVolume(random, false);
  ParameterBox box{};
  for (std::size_t d = 0; d < 3; ++d)
  {
    box.Low[d] = geometry.Knots()[d].First();
    box.High[d] = geometry.Knots()[d].Last();
  }
  BoxSpline f;
  EXPECT_FALSE(JacobianField(geometry).Restrict(box, f));
}

TEST(JacobianField, WorksForDegreesThatNoKnotVectorOfTheDeterminantHas)
{
  std::mt19937 random(3);
  const KnotVector high = KnotVector::Uniform(9, 10);
  const KnotVector low = KnotVector::Uniform(1, 2);
  const Spline geometry = models::RandomSpline(random, { high, low, low }, 3, true);
  const JacobianField field(geometry);
  BoxSpline f;
  const ParameterBox box{ { 0.25, 0.0, 0.0 }, { 0.5, 1.0, 1.0 } };
  ASSERT_TRUE(field.Restrict(box, f));
  EXPECT_EQ(f.Values(Everywhere).Contains(0.0),
    field.OnBox(box)->Min() <= 0.0 && field.OnBox(box)->Max() >= 0.0);
}

TEST(JacobianField, AnyNumberOfThreadsMayAsk)
{
  std::mt19937 random(4);
  const KnotVector k = KnotVector::Uniform(2, 10);
  const Spline geometry = models::RandomSpline(random, { k, k, k }, 3, false);
  const JacobianField field(geometry);
  std::atomic<int> wrong{ 0 };
  std::vector<std::thread> threads;
  for (unsigned t = 0; t < 4; ++t)
  {
    threads.emplace_back(
      [&, t]
      {
        std::mt19937 own(t);
        for (int n = 0; n < 200; ++n)
        {
          const std::array<int, 3> spans{ static_cast<int>(own() % 8), static_cast<int>(own() % 8),
            static_cast<int>(own() % 8) };
          wrong += !HasTheHullOf(field, geometry, spans, BoxIn(own, geometry, spans));
        }
      });
  }
  for (std::thread& thread : threads)
  {
    thread.join();
  }
  EXPECT_EQ(wrong, 0);
}
