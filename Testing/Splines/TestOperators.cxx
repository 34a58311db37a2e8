// SPDX-License-Identifier: BSD-3-Clause
#include "Operators.h"

#include "BezierExtractor.h"
#include "Error.h"
#include "Evaluator.h"
#include "Measures.h"
#include "Splines/Models.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>

using namespace hyperpatch;

namespace
{

constexpr double Epsilon = std::numeric_limits<double>::epsilon();

/// Values are at most 1 (control points in a unit cube, weights that vary by a factor of 4); each
/// of three directions rounds a few times per degree, weights of rational splines included.
constexpr double Tolerance = 4 * 3 * 15 * 4 * Epsilon;

/// Curves, surfaces and volumes with degrees 1 to 15 that take turns, clamped or not, rational or
/// not; every direction that is there has repeated knots now and then.
void ForRandomSplines(
  const std::function<void(const Spline&, std::mt19937&)>& body, int greatestDegree = 15)
{
  std::mt19937 random(11);
  for (int round = 0; round < 60; ++round)
  {
    std::array<KnotVector, 3> knots;
    for (int d = 0; d <= round % 3; ++d)
    {
      // One direction takes all degrees, the others stay small to keep lattices small.
      const int degree = d == round / 3 % (round % 3 + 1) ? 1 + round % greatestDegree
                                                          : 1 + static_cast<int>(random() % 3);
      // Without clamping a run of equal knots could take up the whole domain of a shorter vector.
      const bool clamped = random() % 2 == 0;
      const int size = (clamped ? degree : 2 * degree) + 1 + static_cast<int>(random() % 5);
      knots[static_cast<std::size_t>(d)] = models::RandomKnots(random, degree, size, clamped);
    }
    // The direction that is not there may be any.
    std::shuffle(knots.begin(), knots.end(), random);
    const Spline spline = models::RandomSpline(random, knots, 1 + round % 4, round % 2 == 0);
    SCOPED_TRACE("round " + std::to_string(round));
    body(spline, random);
    if (testing::Test::HasFailure())
    {
      return;
    }
  }
}

std::array<double, 3> RandomParameters(std::mt19937& random, const std::array<KnotVector, 3>& knots)
{
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::array<double, 3> parameters;
  for (std::size_t d = 0; d < 3; ++d)
  {
    const double t = unit(random);
    parameters[d] = (1.0 - t) * knots[d].First() + t * knots[d].Last();
  }
  return parameters;
}

/// The two splines are one map on the domain of b.
void ExpectSameMap(
  const Spline& a, const Spline& b, std::mt19937& random, double tolerance = Tolerance)
{
  for (int i = 0; i < 20; ++i)
  {
    const auto t = RandomParameters(random, b.Knots());
    const Eigen::VectorXd difference = a.Evaluate(t[0], t[1], t[2]) - b.Evaluate(t[0], t[1], t[2]);
    EXPECT_LE(difference.lpNorm<Eigen::Infinity>(), tolerance);
  }
}

void ExpectSameDomain(const Spline& a, const Spline& b)
{
  for (int d = 0; d < 3; ++d)
  {
    EXPECT_EQ(a.Knots(d).First(), b.Knots(d).First());
    EXPECT_EQ(a.Knots(d).Last(), b.Knots(d).Last());
  }
}

bool IsClamped(const KnotVector& knots)
{
  return knots[0] == knots.First() && knots.Knots().back() == knots.Last();
}

std::string Message(const std::function<void()>& call)
{
  try
  {
    call();
    return "";
  }
  catch (const Error& error)
  {
    return error.what();
  }
}

Spline Curve(KnotVector knots)
{
  const Eigen::RowVectorXd values = Eigen::RowVectorXd::LinSpaced(knots.Size(), 0.0, 1.0);
  return Spline({ std::move(knots) }, values.array().square().matrix());
}

}

TEST(InsertKnots, LeavesTheMapAlone)
{
  ForRandomSplines(
    [](const Spline& spline, std::mt19937& random)
    {
      Spline refined = spline;
      for (int d = 0; d < 3; ++d)
      {
        const KnotVector& knots = spline.Knots(d);
        if (knots.Degree() == 0)
        {
          continue;
        }
        std::vector<double> inserted;
        for (int i = 0; i < 4; ++i)
        {
          inserted.push_back(RandomParameters(random, spline.Knots())[static_cast<std::size_t>(d)]);
        }
        // Some repeat, some are there already, some sit at an end.
        if (knots.Degree() > 1)
        {
          inserted.push_back(inserted[0]);
        }
        for (double knot : knots.Breaks())
        {
          if (knots.Multiplicity(knot) < knots.Degree())
          {
            inserted.push_back(knot);
          }
        }
        std::sort(inserted.begin(), inserted.end());
        refined = InsertKnots(refined, d, inserted);
        // At an end a new knot takes the place of the outermost one.
        const auto ends = std::count(inserted.begin(), inserted.end(), knots.First()) +
          std::count(inserted.begin(), inserted.end(), knots.Last());
        EXPECT_EQ(refined.Knots(d).Size() - knots.Size(),
          static_cast<std::ptrdiff_t>(inserted.size()) - ends);
      }
      ExpectSameDomain(refined, spline);
      ExpectSameMap(spline, refined, random);
    });
}

TEST(InsertKnots, KeepsDistantControlPointsBitwise)
{
  std::mt19937 random(12);
  const Spline spline =
    models::RandomSpline(random, { KnotVector::Uniform(3, 20, 0, 17) }, 3, true);
  const Spline refined = InsertKnots(spline, 0, { 8.5 });
  ASSERT_EQ(refined.Knots(0).Size(), 21);
  // Knot 8.5 is in span 11: control points up to 8 and, moved by one, from 11 on are untouched.
  EXPECT_EQ(refined.Coefficients().leftCols(9), spline.Coefficients().leftCols(9));
  EXPECT_EQ(refined.Coefficients().rightCols(9), spline.Coefficients().rightCols(9));
  EXPECT_EQ(refined.Weights().head(9), spline.Weights().head(9));
  EXPECT_EQ(InsertKnots(spline, 0, {}), spline);
}

TEST(InsertKnots, RefusesWhatIsNoRefinement)
{
  const Spline curve = Curve(KnotVector(2, { 0, 0, 0, 1, 2, 2, 2 }));
  EXPECT_NO_THROW(static_cast<void>(InsertKnots(curve, 0, { 1 })));
  EXPECT_NE(Message(
              [&] {
                static_cast<void>(InsertKnots(curve, 0, { 1, 1 }));
              })
              .find("multiplicity 3"),
    std::string::npos);
  EXPECT_NE(
    Message([&] { static_cast<void>(InsertKnots(curve, 0, { 0 })); }).find("multiplicity 4"),
    std::string::npos);
  EXPECT_NE(Message([&] { static_cast<void>(InsertKnots(curve, 0, { 3 })); }).find("domain"),
    std::string::npos);
  EXPECT_NE(Message([&] { static_cast<void>(InsertKnots(curve, 0, { NAN })); }).find("domain"),
    std::string::npos);
  EXPECT_NE(Message(
              [&] {
                static_cast<void>(InsertKnots(curve, 0, { 1, 0.5 }));
              })
              .find("ascend"),
    std::string::npos);
  EXPECT_THROW(static_cast<void>(InsertKnots(curve, 3, { 1 })), Error);
}

TEST(ElevateDegree, LeavesTheMapAloneAndKeepsSmoothness)
{
  ForRandomSplines(
    [](const Spline& spline, std::mt19937& random)
    {
      Spline elevated = spline;
      for (int d = 0; d < 3; ++d)
      {
        elevated = ElevateDegree(elevated, d, 3);
        const KnotVector& before = spline.Knots(d);
        const KnotVector& after = elevated.Knots(d);
        EXPECT_EQ(after.Degree(), before.Degree() + 3);
        EXPECT_EQ(after.Breaks(), before.Breaks());
        for (int s : before.Spans())
        {
          const double knot = before[s];
          if (knot > before.First())
          {
            EXPECT_EQ(after.Multiplicity(knot), before.Multiplicity(knot) + 3);
          }
        }
      }
      ExpectSameMap(spline, elevated, random);
    });
}

TEST(ElevateDegree, FromEightToElevenKeepsTwelveDigits)
{
  std::mt19937 random(13);
  for (bool clamped : { true, false })
  {
    const Spline spline =
      models::RandomSpline(random, { models::RandomKnots(random, 8, 40, clamped) }, 3, false);
    ExpectSameMap(spline, ElevateDegree(spline, 0, 3), random, 1e-13);
  }
}

TEST(ElevateDegree, RefusesImpossibleDegrees)
{
  const Spline curve = Curve(KnotVector::Uniform(2, 4));
  EXPECT_THROW(static_cast<void>(ElevateDegree(curve, 0, MaxDegree - 1)), Error);
  EXPECT_THROW(static_cast<void>(ElevateDegree(curve, 0, -1)), Error);
  EXPECT_THROW(static_cast<void>(ElevateDegree(curve, -1)), Error);
  EXPECT_EQ(ElevateDegree(curve, 0, 0), curve);
}

TEST(RefineUniformly, LeavesTheMapAlone)
{
  ForRandomSplines(
    [](const Spline& spline, std::mt19937& random)
    {
      const Spline refined = RefineUniformly(spline, { 3, 1, 2 });
      for (int d = 0; d < 3; ++d)
      {
        const bool there = spline.Knots(d).Degree() > 0;
        EXPECT_EQ(refined.Knots(d).Spans().size(),
          spline.Knots(d).Spans().size() * (there && d != 1 ? (d == 0 ? 3u : 2u) : 1u));
      }
      ExpectSameMap(spline, refined, random);
    });
  EXPECT_THROW(static_cast<void>(RefineUniformly(models::QuarterTube(), { 1, 0, 1 })), Error);
}

TEST(Clamp, LeavesTheMapAlone)
{
  ForRandomSplines(
    [](const Spline& spline, std::mt19937& random)
    {
      const Spline clamped = Clamp(spline);
      ExpectSameDomain(clamped, spline);
      ExpectSameMap(spline, clamped, random);
      for (int d = 0; d < 3; ++d)
      {
        EXPECT_TRUE(IsClamped(clamped.Knots(d)));
        EXPECT_EQ(clamped.Knots(d).Breaks(), spline.Knots(d).Breaks());
      }
      EXPECT_EQ(Clamp(clamped), clamped);
    });
}

TEST(Clamp, OfASinglePeriodicSpanOfDegreeFifteen)
{
  // All knots but two are outside the domain.
  std::mt19937 random(18);
  std::vector<double> knots(32);
  for (std::size_t i = 0; i < knots.size(); ++i)
  {
    knots[i] = static_cast<double>(i);
  }
  const Spline spline = models::RandomSpline(random, { KnotVector(15, knots) }, 3, true);
  ExpectSameMap(spline, Clamp(spline), random);
  ExpectSameMap(spline, InsertKnots(spline, 0, { 15.3, 15.3, 15.7 }), random);
  ExpectSameMap(spline, ElevateDegree(spline, 0, 2), random);
}

TEST(ToBezier, HasFullMultiplicitiesAndTheSameMap)
{
  ForRandomSplines(
    [](const Spline& spline, std::mt19937& random)
    {
      const Spline bezier = ToBezier(spline);
      ExpectSameMap(spline, bezier, random);
      for (int d = 0; d < 3; ++d)
      {
        const KnotVector& knots = bezier.Knots(d);
        EXPECT_TRUE(IsClamped(knots));
        EXPECT_EQ(knots.Breaks(), spline.Knots(d).Breaks());
        EXPECT_EQ(knots.Creases().size() + (knots.Degree() > 0 ? 1 : knots.Spans().size()),
          knots.Spans().size());
      }
      EXPECT_EQ(ToBezier(bezier), bezier);
    });
}

TEST(ToBezier, KeepsDiscontinuousBreaks)
{
  std::mt19937 random(14);
  const KnotVector knots(2, { 0, 0, 0, 1, 1, 1, 2, 3, 3, 3 }, Smoothness::Discontinuous);
  const Spline jump = models::RandomSpline(random, { knots }, 1, false);
  const Spline bezier = ToBezier(jump);
  EXPECT_EQ(bezier.Knots(0).Multiplicity(1), 3);
  EXPECT_EQ(bezier.Knots(0).Multiplicity(2), 2);
  ExpectSameMap(jump, bezier, random);
  ExpectSameMap(jump, ElevateDegree(jump, 0), random);
  // Both control points of the jump are there, each on its side.
  EXPECT_EQ(bezier.Coefficients().leftCols(4), jump.Coefficients().leftCols(4));
}

TEST(RestrictToSpans, IsBitwiseTheSameMap)
{
  ForRandomSplines(
    [](const Spline& spline, std::mt19937& random)
    {
      std::array<int, 3> begin;
      std::array<int, 3> end;
      for (std::size_t d = 0; d < 3; ++d)
      {
        const auto count = static_cast<unsigned>(spline.Knots()[d].Spans().size());
        begin[d] = static_cast<int>(random() % count);
        end[d] =
          begin[d] + 1 + static_cast<int>(random() % (count - static_cast<unsigned>(begin[d])));
      }
      const Spline part = RestrictToSpans(spline, begin, end);
      for (std::size_t d = 0; d < 3; ++d)
      {
        const auto breaks = spline.Knots()[d].Breaks();
        EXPECT_EQ(part.Knots()[d].Breaks(),
          std::vector<double>(breaks.begin() + begin[d], breaks.begin() + end[d] + 1));
      }
      for (int i = 0; i < 20; ++i)
      {
        const auto t = RandomParameters(random, part.Knots());
        EXPECT_EQ(part.Evaluate(t[0], t[1], t[2]), spline.Evaluate(t[0], t[1], t[2]));
      }
    });
}

TEST(RestrictToSpans, RefusesSpansThatDoNotExist)
{
  const Spline curve = Curve(KnotVector::Uniform(2, 5));
  EXPECT_THROW(static_cast<void>(RestrictToSpans(curve, { 0, 0, 0 }, { 4, 1, 1 })), Error);
  EXPECT_THROW(static_cast<void>(RestrictToSpans(curve, { -1, 0, 0 }, { 2, 1, 1 })), Error);
  EXPECT_THROW(static_cast<void>(RestrictToSpans(curve, { 1, 0, 0 }, { 1, 1, 1 })), Error);
}

TEST(RestrictToBox, IsTheSameMapOnItsOwnDomain)
{
  ForRandomSplines(
    [](const Spline& spline, std::mt19937& random)
    {
      auto low = RandomParameters(random, spline.Knots());
      auto high = RandomParameters(random, spline.Knots());
      for (std::size_t d = 0; d < 3; ++d)
      {
        // Ends are anywhere, at a break, or at an end of the domain.
        if (random() % 3 == 0)
        {
          const auto breaks = spline.Knots()[d].Breaks();
          low[d] = breaks[random() % breaks.size()];
        }
        if (low[d] > high[d])
        {
          std::swap(low[d], high[d]);
        }
        if (random() % 4 == 0)
        {
          low[d] = spline.Knots()[d].First();
        }
      }
      const Spline part = RestrictToBox(spline, low, high);
      for (std::size_t d = 0; d < 3; ++d)
      {
        EXPECT_EQ(part.Knots()[d].First(), low[d]);
        EXPECT_EQ(part.Knots()[d].Last(), high[d]);
        EXPECT_TRUE(IsClamped(part.Knots()[d]));
      }
      ExpectSameMap(spline, part, random);
    });
}

TEST(RestrictToBox, RefusesBoxesOutsideTheDomain)
{
  const Spline tube = models::QuarterTube();
  EXPECT_THROW(static_cast<void>(RestrictToBox(tube, { 0, 0, 0 }, { 1, 1.5, 1 })), Error);
  EXPECT_THROW(static_cast<void>(RestrictToBox(tube, { 0, 0.5, 0 }, { 1, 0.5, 1 })), Error);
  EXPECT_THROW(static_cast<void>(RestrictToBox(tube, { 0, 0, -1 }, { 1, 1, 1 })), Error);
  EXPECT_THROW(static_cast<void>(RestrictToBox(tube, { NAN, 0, 0 }, { 1, 1, 1 })), Error);
}

TEST(ExtractFace, IsTheSplineThere)
{
  ForRandomSplines(
    [](const Spline& spline, std::mt19937& random)
    {
      for (int side = 0; side < NumberOfSides; ++side)
      {
        const int d = side / 2;
        const Spline face = ExtractFace(spline, side);
        EXPECT_EQ(face.Knots(d), KnotVector());
        for (int i = 0; i < 10; ++i)
        {
          auto t = RandomParameters(random, spline.Knots());
          double& x = t[static_cast<std::size_t>(d)];
          x = side % 2 == 0 ? spline.Knots(d).First() : spline.Knots(d).Last();
          const Eigen::VectorXd difference =
            face.Evaluate(t[0], t[1], t[2]) - spline.Evaluate(t[0], t[1], t[2]);
          EXPECT_LE(difference.lpNorm<Eigen::Infinity>(), Tolerance);
        }
      }
    });
}

TEST(ExtractFace, OfClampedSplinesCopiesControlPoints)
{
  const Spline tube = models::QuarterTube();
  const Spline face = ExtractFace(tube, 5);
  EXPECT_EQ(face.Coefficients(), tube.Coefficients().rightCols(6));
  EXPECT_EQ(face.Weights(), tube.Weights().tail(6));
  EXPECT_THROW(static_cast<void>(ExtractFace(tube, 6)), Error);
  EXPECT_THROW(static_cast<void>(ExtractFace(tube, -1)), Error);
}

TEST(ExtractIsoparametric, IsTheSplineThere)
{
  ForRandomSplines(
    [](const Spline& spline, std::mt19937& random)
    {
      const auto at = RandomParameters(random, spline.Knots());
      for (int d = 0; d < 3; ++d)
      {
        const double value = at[static_cast<std::size_t>(d)];
        const Spline face = ExtractIsoparametric(spline, d, value);
        for (int i = 0; i < 10; ++i)
        {
          auto t = RandomParameters(random, spline.Knots());
          t[static_cast<std::size_t>(d)] = value;
          const Eigen::VectorXd difference =
            face.Evaluate(t[0], t[1], t[2]) - spline.Evaluate(t[0], t[1], t[2]);
          EXPECT_LE(difference.lpNorm<Eigen::Infinity>(), Tolerance);
        }
      }
    });
  EXPECT_THROW(static_cast<void>(ExtractIsoparametric(models::QuarterTube(), 0, 1.1)), Error);
  EXPECT_THROW(static_cast<void>(ExtractIsoparametric(models::QuarterTube(), 3, 0.5)), Error);
}

namespace
{

/// Derivative splines against the evaluator's derivatives, relative to `scale`.
void ExpectDerivative(
  const Spline& spline, int direction, const Spline& derivative, double scale, std::mt19937& random)
{
  ExpectSameDomain(derivative, spline);
  const Evaluator evaluator(spline);
  const auto m = static_cast<std::size_t>(spline.Components());
  std::vector<double> value(m);
  std::vector<double> derivatives(3 * m);
  for (int i = 0; i < 20; ++i)
  {
    const auto t = RandomParameters(random, spline.Knots());
    evaluator.EvaluateWithDerivatives(1, t.data(), value.data(), derivatives.data());
    const Eigen::VectorXd expected = Eigen::Map<Eigen::VectorXd>(
      derivatives.data() + static_cast<std::size_t>(direction) * m, spline.Components());
    EXPECT_LE((derivative.Evaluate(t[0], t[1], t[2]) - expected).lpNorm<Eigen::Infinity>(),
      Tolerance * scale);
  }
}

double SteepestPiece(const KnotVector& knots)
{
  double shortest = knots.Last() - knots.First();
  for (int s : knots.Spans())
  {
    shortest = std::min(shortest, knots[s + 1] - knots[s]);
  }
  return 2.0 * std::max(knots.Degree(), 1) / shortest;
}

}

TEST(Derivative, AgreesWithTheEvaluator)
{
  ForRandomSplines(
    [](const Spline& spline, std::mt19937& random)
    {
      const Spline polynomial = AsPolynomial(spline);
      for (int d = 0; d < 3; ++d)
      {
        const Spline derivative = Derivative(polynomial, d);
        ExpectDerivative(polynomial, d, derivative, 2 * SteepestPiece(spline.Knots(d)), random);
        // A second one goes through the discontinuous breaks of the first.
        ExpectDerivative(derivative, d, Derivative(derivative, d),
          2 * SteepestPiece(spline.Knots(d)) * SteepestPiece(spline.Knots(d)), random);
      }
    });
}

TEST(Derivative, GoesThroughDiscontinuousBreaks)
{
  std::mt19937 random(19);
  for (int degree : { 1, 5 })
  {
    std::vector<double> knots;
    for (double knot : { 0.0, 1.0, 2.0 })
    {
      knots.insert(knots.end(), static_cast<std::size_t>(degree) + 1, knot);
    }
    const Spline jump = models::RandomSpline(
      random, { KnotVector(degree, knots, Smoothness::Discontinuous) }, 2, false);
    const Spline derivative = Derivative(jump, 0);
    EXPECT_EQ(derivative.Knots(0).Multiplicity(1.0), degree);
    ExpectDerivative(jump, 0, derivative, SteepestPiece(jump.Knots(0)), random);
  }
}

TEST(Derivative, OfARationalSplinePointsToRationalDerivative)
{
  EXPECT_NE(Message([] { static_cast<void>(Derivative(models::QuarterTube(), 0)); })
              .find("RationalDerivative"),
    std::string::npos);
  EXPECT_THROW(static_cast<void>(Derivative(AsPolynomial(models::QuarterTube()), 3)), Error);
}

TEST(AsPolynomial, HasTheWeightAsItsLastComponent)
{
  const Spline tube = models::QuarterTube();
  const Spline polynomial = AsPolynomial(tube);
  EXPECT_FALSE(polynomial.IsRational());
  const Eigen::VectorXd h = polynomial.Evaluate(0.3, 0.4, 0.5);
  ASSERT_EQ(h.size(), 4);
  EXPECT_LE(
    (h.head(3) / h[3] - tube.Evaluate(0.3, 0.4, 0.5)).lpNorm<Eigen::Infinity>(), 10 * Epsilon);
}

TEST(RationalDerivative, AgreesWithTheEvaluator)
{
  ForRandomSplines(
    [](const Spline& spline, std::mt19937& random)
    {
      for (int d = 0; d < 3; ++d)
      {
        const Spline derivative = RationalDerivative(spline, d);
        // Weights vary by a factor of 4 and enter squared.
        ExpectDerivative(spline, d, derivative, 16 * SteepestPiece(spline.Knots(d)), random);
        if (spline.IsRational() && spline.Knots(d).Degree() > 0)
        {
          EXPECT_EQ(derivative.Knots(d).Degree(), 2 * spline.Knots(d).Degree());
        }
      }
    });
}

TEST(RationalDerivative, RefusesDegreesWhoseDoubleIsTooGreat)
{
  std::mt19937 random(15);
  const Spline curve = models::RandomSpline(random, { KnotVector::Uniform(16, 17) }, 1, true);
  EXPECT_THROW(static_cast<void>(RationalDerivative(curve, 0)), Error);
  EXPECT_THROW(static_cast<void>(RationalDerivative(curve, -1)), Error);
}

TEST(BezierExtractor, AgreesWithToBezier)
{
  ForRandomSplines(
    [](const Spline& spline, std::mt19937& random)
    {
      const Spline bezier = ToBezier(spline);
      const Eigen::MatrixXd expected = bezier.Homogeneous();
      const BezierExtractor extractor(spline);
      Eigen::MatrixXd points;
      for (int round = 0; round < 4; ++round)
      {
        std::array<int, 3> e;
        for (std::size_t d = 0; d < 3; ++d)
        {
          e[d] = static_cast<int>(random() % spline.Knots()[d].Spans().size());
        }
        extractor.Extract(e, points);
        const auto p = spline.Degrees();
        const auto n = bezier.Sizes();
        Eigen::Index column = 0;
        for (int k = 0; k <= p[2]; ++k)
        {
          for (int j = 0; j <= p[1]; ++j)
          {
            for (int i = 0; i <= p[0]; ++i, ++column)
            {
              const Eigen::Index global =
                e[0] * p[0] + i + n[0] * (e[1] * p[1] + j + n[1] * (e[2] * p[2] + k));
              EXPECT_LE((points.col(column) - expected.col(global)).lpNorm<Eigen::Infinity>(),
                2 * Tolerance);
            }
          }
        }
      }
    });
}

TEST(BezierExtractor, PartsOfAnElementAreRestrictionsToABox)
{
  std::mt19937 random(16);
  const Spline spline = models::RandomSpline(random,
    { models::RandomKnots(random, 3, 7, true), models::RandomKnots(random, 2, 5, false),
      models::RandomKnots(random, 4, 6, false) },
    3, true);
  const std::array<int, 3> e{ 1, 0, 1 };
  std::array<double, 3> low;
  std::array<double, 3> high;
  for (std::size_t d = 0; d < 3; ++d)
  {
    const KnotVector& knots = spline.Knots()[d];
    const int s = knots.Spans()[static_cast<std::size_t>(e[d])];
    low[d] = 0.75 * knots[s] + 0.25 * knots[s + 1];
    high[d] = knots[s + 1];
  }
  Eigen::MatrixXd points;
  const BezierExtractor extractor(spline);
  extractor.Extract(e, low, high, points);
  const Eigen::MatrixXd expected = RestrictToBox(spline, low, high).Homogeneous();
  EXPECT_LE((points - expected).lpNorm<Eigen::Infinity>(), 2 * Tolerance);
  const double* before = points.data();
  extractor.Extract({ 0, 0, 0 }, points);
  EXPECT_EQ(points.data(), before) << "a matrix of the right size is used again";
  EXPECT_THROW(extractor.Extract({ 0, 0, 99 }, points), Error);
  EXPECT_THROW(extractor.Extract({ -1, 0, 0 }, points), Error);
}

TEST(RestrictPatch, ContinuesTheNumbersOfThePatch)
{
  std::mt19937 random(17);
  const auto spline = [&random](std::array<int, 3> sizes, int components)
  {
    return models::RandomSpline(random,
      { KnotVector::Uniform(2, sizes[0]), KnotVector::Uniform(2, sizes[1]),
        KnotVector::Uniform(2, sizes[2]) },
      components, true);
  };
  // 4 x 2 x 1 spans; one attribute has the same breaks, one has none of them.
  const Spline geometry = spline({ 6, 4, 3 }, 3);
  const Patch whole{ 7,
    Aggregate(
      geometry, { { "aligned", spline({ 10, 4, 3 }, 1) }, { "across", spline({ 5, 5, 5 }, 2) } }) };
  const Patch part = RestrictPatch(whole, { 1, 0, 0 }, { 4, 1, 1 });
  const Patch piece = RestrictPatch(part, { 0, 0, 0 }, { 2, 1, 1 });
  EXPECT_EQ(piece.Id, 7);
  EXPECT_EQ(part.FirstSpan, (std::array<int, 3>{ 1, 0, 0 }));
  EXPECT_EQ(piece.FirstSpan, (std::array<int, 3>{ 1, 0, 0 }));
  EXPECT_EQ(piece.WholeSpans, (std::array<int, 3>{ 4, 2, 1 }));
  EXPECT_EQ(part.IsDomainFace, (std::array<bool, 6>{ false, true, true, false, true, true }));
  EXPECT_EQ(piece.IsDomainFace, (std::array<bool, 6>{ false, false, true, false, true, true }));
  EXPECT_EQ(piece.WholeHandedness, Handedness(whole));
  for (int i = 0; i < 20; ++i)
  {
    const auto t = RandomParameters(random, piece.Body.Geometry().Knots());
    EXPECT_EQ(
      piece.Body.Geometry().Evaluate(t[0], t[1], t[2]), geometry.Evaluate(t[0], t[1], t[2]));
    EXPECT_EQ(piece.Body.FindAttribute("aligned")->Evaluate(t[0], t[1], t[2]),
      whole.Body.FindAttribute("aligned")->Evaluate(t[0], t[1], t[2]));
  }
  ExpectSameMap(*whole.Body.FindAttribute("across"), *piece.Body.FindAttribute("across"), random);
  EXPECT_THROW(static_cast<void>(RestrictPatch(whole, { 0, 0, 0 }, { 5, 1, 1 })), Error);
}
