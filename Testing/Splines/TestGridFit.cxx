// SPDX-License-Identifier: BSD-3-Clause
#include "GridFit.h"

#include "Error.h"
#include "Evaluator.h"
#include "Models.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

using namespace hyperpatch;

namespace
{

constexpr double Epsilon = std::numeric_limits<double>::epsilon();

using Sites = std::array<std::vector<double>, 3>;

std::vector<double> Line(int count)
{
  std::vector<double> sites;
  for (int i = 0; i < count; ++i)
  {
    sites.push_back(static_cast<double>(i) / std::max(count - 1, 1));
  }
  return sites;
}

/// Samples of function(x, y, z) on a grid, u fastest.
template <typename Function>
Eigen::MatrixXd Sample(const Sites& sites, Function&& function)
{
  Eigen::MatrixXd samples(
    function(0.0, 0.0, 0.0).size(), sites[0].size() * sites[1].size() * sites[2].size());
  Eigen::Index i = 0;
  for (const double z : sites[2])
  {
    for (const double y : sites[1])
    {
      for (const double x : sites[0])
      {
        samples.col(i++) = function(x, y, z);
      }
    }
  }
  return samples;
}

Eigen::Vector2d Bump(double x, double y, double z)
{
  return { std::exp(-60.0 * (x - 0.3) * (x - 0.3)) * (1.0 + y), std::sin(2.0 * y) + 0.2 * z };
}

SampleReader Reader(const Eigen::MatrixXd& samples)
{
  return [&samples](Eigen::Index first, Eigen::Index count, double* block)
  { std::copy_n(samples.data() + first * samples.rows(), count * samples.rows(), block); };
}

template <typename Function>
void ExpectError(Function&& function, const std::string& text)
{
  try
  {
    function();
    ADD_FAILURE() << "no error";
  }
  catch (const Error& error)
  {
    EXPECT_NE(std::string(error.what()).find(text), std::string::npos) << error.what();
  }
}

}

TEST(MeasureError, IsTheDistanceFromTheSamples)
{
  const Sites sites{ Line(11), Line(6), Line(4) };
  std::array<KnotVector, 3> knots;
  for (std::size_t d = 0; d < 3; ++d)
  {
    knots[d] = InterpolationKnots(2, sites[d]);
  }
  Eigen::MatrixXd samples = Sample(sites, Bump);
  const Spline spline = Interpolate(knots, sites, samples);
  // Rounding of a well conditioned interpolant.
  EXPECT_LE(MeasureError(spline, sites, Reader(samples)).Maximum, 1e3 * Epsilon);

  samples.col(100) += Eigen::Vector2d(3.0, -4.0);
  samples.col(7) += Eigen::Vector2d(0.0, 2.0);
  samples(0, 50) = NAN;
  const FitError error = MeasureError(spline, sites, Reader(samples));
  EXPECT_EQ(error.Where, 100);
  EXPECT_EQ(error.Count, 11 * 6 * 4 - 1);
  EXPECT_NEAR(error.Maximum, 5.0, 1e3 * Epsilon);
  EXPECT_NEAR(error.RootMeanSquare, std::sqrt(29.0 / 263.0), 1e3 * Epsilon);
}

TEST(MeasureError, OfARationalSplineIsThatOfItsValues)
{
  // The exact semicircle has the distance 1 from its centre everywhere.
  Eigen::MatrixXd points(2, 4);
  points << 1, 1, -1, -1, 0, 2, 2, 0;
  Eigen::VectorXd weights(4);
  weights << 1.0, 1.0 / 3.0, 1.0 / 3.0, 1.0;
  const Spline arc(
    { KnotVector::Uniform(3, 4), KnotVector(), KnotVector() }, std::move(points), weights);
  const Sites sites{ Line(31), { 0.5 }, { 0.5 } };
  const FitError error = MeasureError(arc, sites, Reader(Eigen::MatrixXd::Zero(2, 31)));
  EXPECT_NEAR(error.Maximum, 1.0, 8 * Epsilon);
  EXPECT_NEAR(error.RootMeanSquare, 1.0, 8 * Epsilon);
}

TEST(MeasureError, ScalesWithTheData)
{
  // Also where squares would overflow, or vanish: by powers of two, all numbers are the same.
  const Sites sites{ Line(9), Line(8), Line(7) };
  const Eigen::MatrixXd samples = Sample(sites, Bump);
  const auto fit = [&sites](const Eigen::MatrixXd& data, ErrorMeasure measure, double tolerance) {
    return FitToTolerance({ 2, 2, 2 }, sites, data, tolerance, measure);
  };
  for (const ErrorMeasure measure : { ErrorMeasure::Maximum, ErrorMeasure::RootMeanSquare })
  {
    const Spline spline = fit(samples, measure, 0.01);
    const FitError error = MeasureError(spline, sites, Reader(samples));
    EXPECT_GT(error.RootMeanSquare, 1e-6);
    for (const double scale : { std::exp2(-900), std::exp2(900) })
    {
      const Eigen::MatrixXd scaled = scale * samples;
      const Spline same = fit(scaled, measure, 0.01 * scale);
      EXPECT_EQ(same.Coefficients(), scale * spline.Coefficients());
      const FitError other = MeasureError(same, sites, Reader(scaled));
      EXPECT_NEAR(other.Maximum, scale * error.Maximum, 8 * Epsilon * scale * error.Maximum);
      EXPECT_NEAR(other.RootMeanSquare, scale * error.RootMeanSquare,
        1000 * Epsilon * scale * error.RootMeanSquare);
      EXPECT_EQ(other.Where, error.Where);
      EXPECT_EQ(other.Count, error.Count);
    }
  }
}

TEST(FitToTolerance, MeetsItWithFewControlPoints)
{
  const Sites sites{ Line(101), Line(40), Line(30) };
  const Eigen::MatrixXd samples = Sample(sites, Bump);
  Eigen::Index before = 0;
  for (double tolerance : { 1e-1, 1e-2, 1e-3, 1e-5 })
  {
    const Spline spline =
      FitToTolerance({ 3, 3, 3 }, sites, samples, tolerance, ErrorMeasure::Maximum);
    EXPECT_LE(MeasureError(spline, sites, Reader(samples)).Maximum, tolerance);
    EXPECT_GT(spline.NumberOfControlPoints(), before);
    before = spline.NumberOfControlPoints();
    // A straight line in w needs no knot; the sine, halving, 8 spans for the h^4 / 24 of 1e-5.
    EXPECT_EQ(spline.Sizes()[2], 4);
    EXPECT_LE(spline.Sizes()[1], 16);
  }
  const Spline spline = FitToTolerance({ 3, 3, 3 }, sites, samples, 1e-3, ErrorMeasure::Maximum);
  const std::vector<double> breaks = spline.Knots(0).Breaks();
  double closest = 1.0;
  for (std::size_t i = 1; i < breaks.size(); ++i)
  {
    closest = std::min(closest, breaks[i] - breaks[i - 1]);
  }
  EXPECT_LE(breaks[2] - breaks[1], 0.1);
  EXPECT_GE(breaks.back() - breaks[breaks.size() - 2], 3.0 * closest);
}

TEST(FitToTolerance, InterpolatesWhatNothingElseMeets)
{
  const Sites sites{ Line(12), Line(1), Line(9) };
  const Eigen::MatrixXd samples = Eigen::MatrixXd::Random(1, 12 * 9);
  for (int degree : { 1, 2, 3 })
  {
    const Spline spline =
      FitToTolerance({ degree, degree, degree }, sites, samples, 1e-9, ErrorMeasure::Maximum);
    EXPECT_EQ(spline.Sizes(), (std::array<int, 3>{ 12, 1, 9 }));
    EXPECT_LE(MeasureError(spline, { sites[0], { 0.5 }, sites[2] }, Reader(samples)).Maximum, 1e-9);
  }
}

TEST(FitToTolerance, HoldsWhereErrorsOfDirectionsAddUp)
{
  // Noise: what one direction leaves, the others cannot take away.
  const Sites sites{ Line(14), Line(11), Line(12) };
  const Eigen::MatrixXd samples = Eigen::MatrixXd::Random(2, 14 * 11 * 12);
  for (double tolerance : { 1.2, 0.9, 0.6, 0.3, 0.1 })
  {
    const Spline spline =
      FitToTolerance({ 2, 3, 1 }, sites, samples, tolerance, ErrorMeasure::Maximum);
    EXPECT_LE(MeasureError(spline, sites, Reader(samples)).Maximum, tolerance);
  }
}

TEST(FitToTolerance, MeetsARootMeanSquareWithFewerControlPoints)
{
  const Sites sites{ Line(60), Line(40), Line(1) };
  Eigen::MatrixXd samples = Sample(sites, Bump);
  // A single spike, which the largest error would have to follow.
  samples.col(20 + 60 * 10) += Eigen::Vector2d(0.5, 0.0);
  Eigen::Index before = 0;
  for (double tolerance : { 1e-1, 3e-2, 1e-2 })
  {
    const Spline spline =
      FitToTolerance({ 3, 3, 3 }, sites, samples, tolerance, ErrorMeasure::RootMeanSquare);
    EXPECT_LE(MeasureError(spline, sites, Reader(samples)).RootMeanSquare, tolerance);
    EXPECT_GE(spline.NumberOfControlPoints(), before);
    before = spline.NumberOfControlPoints();
    EXPECT_LT(2 * before,
      FitToTolerance({ 3, 3, 3 }, sites, samples, tolerance, ErrorMeasure::Maximum)
        .NumberOfControlPoints());
  }
}

TEST(FitToTolerance, IsTheSameOnAnyNumberOfThreads)
{
  const ParallelFor backwards = [](std::ptrdiff_t count, std::ptrdiff_t grain, const auto& body)
  {
    for (std::ptrdiff_t begin = (count - 1) / grain * grain; begin >= 0; begin -= grain)
    {
      body(begin, std::min(begin + grain, count));
    }
  };
  const Sites sites{ Line(60), Line(50), Line(40) };
  const Eigen::MatrixXd samples =
    Sample(sites, Bump) + 0.05 * Eigen::MatrixXd::Random(2, 60 * 50 * 40);
  for (const ErrorMeasure measure : { ErrorMeasure::Maximum, ErrorMeasure::RootMeanSquare })
  {
    const double tolerance = 0.045;
    const Spline spline = FitToTolerance({ 3, 3, 3 }, sites, samples, tolerance, measure);
    EXPECT_EQ(FitToTolerance({ 3, 3, 3 }, sites, samples, tolerance, measure, backwards), spline);
    const FitError error = MeasureError(spline, sites, Reader(samples));
    const FitError other = MeasureError(spline, sites, Reader(samples), backwards);
    EXPECT_EQ(other.RootMeanSquare, error.RootMeanSquare);
    EXPECT_EQ(other.Maximum, error.Maximum);
    EXPECT_EQ(other.Where, error.Where);
  }
}

TEST(FitToTolerance, GoesOnWhereTheIntervalsAroundAnErrorAreFull)
{
  // A single peak between two sites that are places already: more of them have to come beside.
  const Sites sites{ Line(27), Line(1), Line(1) };
  Eigen::MatrixXd samples = Eigen::MatrixXd::Zero(1, 27);
  samples(0, 8) = 1.0;
  const Spline spline = FitToTolerance({ 4, 1, 1 }, sites, samples, 0.125, ErrorMeasure::Maximum);
  EXPECT_LE(MeasureError(spline, { sites[0], { 0.5 }, { 0.5 } }, Reader(samples)).Maximum, 0.125);
  EXPECT_LT(spline.NumberOfControlPoints(), 27);
}

TEST(FitToTolerance, RefusesBadToleranceAndTooFewSamples)
{
  const Sites sites{ Line(12), Line(3), Line(1) };
  const Eigen::MatrixXd samples = Eigen::MatrixXd::Ones(1, 36);
  ExpectError(
    [&] {
      static_cast<void>(FitToTolerance({ 2, 2, 2 }, sites, samples, 0.0, ErrorMeasure::Maximum));
    },
    "target error");
  ExpectError(
    [&] {
      static_cast<void>(FitToTolerance({ 3, 3, 3 }, sites, samples, 0.1, ErrorMeasure::Maximum));
    },
    "3 samples");
}

TEST(FillMissing, FillsLinesLinearlyAndStaysBetweenNeighbours)
{
  // One direction: Laplace's equation is a straight line.
  Eigen::MatrixXd line(1, 6);
  line << 0, NAN, NAN, INFINITY, 8, 9;
  EXPECT_EQ(FillMissing({ 6, 1, 1 }, line), (std::vector<Eigen::Index>{ 1, 2, 3 }));
  for (int i = 0; i < 5; ++i)
  {
    EXPECT_NEAR(line(0, i), 2.0 * i, 0.08);
  }

  const Sites sites{ Line(9), Line(8), Line(7) };
  Eigen::MatrixXd samples = Sample(sites, Bump);
  const Eigen::MatrixXd original = samples;
  const std::vector<Eigen::Index> holes{ 0, 4 + 9 * (3 + 8 * 3), 5 + 9 * (3 + 8 * 3), 503 };
  for (const Eigen::Index i : holes)
  {
    samples(1, i) = NAN;
  }
  EXPECT_EQ(FillMissing({ 9, 8, 7 }, samples), holes);
  for (Eigen::Index i = 0; i < samples.cols(); ++i)
  {
    if (std::find(holes.begin(), holes.end(), i) == holes.end())
    {
      EXPECT_EQ(samples.col(i), original.col(i));
    }
    // A step of the grid changes the second component by at most 2 / 7 + 0.2 / 6.
    EXPECT_NEAR(samples(1, i), original(1, i), 0.32);
  }
  Eigen::MatrixXd nothing = Eigen::MatrixXd::Constant(1, 4, NAN);
  ExpectError([&] { FillMissing({ 2, 2, 1 }, nothing); }, "no sample");
}

TEST(FitAroundMissing, IsTheFitOfTheOthers)
{
  // Of a spline of the space itself, samples that are left out change nothing.
  std::mt19937 random(41);
  const Sites sites{ Line(20), Line(17), Line(12) };
  std::array<KnotVector, 3> knots;
  std::array<DirectionFit, 3> fits;
  for (std::size_t d = 0; d < 3; ++d)
  {
    knots[d] = LeastSquaresKnots(3, 6, sites[d]);
    fits[d] = DirectionFit::LeastSquares(knots[d], sites[d]);
  }
  const Spline spline = models::RandomSpline(random, knots, 1, false);
  Eigen::MatrixXd samples(1, 20 * 17 * 12);
  Evaluator(spline).EvaluateGrid(sites, samples.data());
  for (const Eigen::Index i : { 5, 1203, 1204, 3000 })
  {
    samples(0, i) = NAN;
  }
  const std::vector<Eigen::Index> missing = FillMissing({ 20, 17, 12 }, samples);
  const Spline fit = FitAroundMissing(fits, missing, samples);
  // The iteration ends at changes of 1e-6 of the range.
  EXPECT_LE((fit.Coefficients() - spline.Coefficients()).cwiseAbs().maxCoeff(), 1e-4);
  EXPECT_GT(
    (FitGrid(fits, samples).Coefficients() - spline.Coefficients()).cwiseAbs().maxCoeff(), 1e-2);
}
