// SPDX-License-Identifier: BSD-3-Clause
#include "Interpolation.h"

#include "Error.h"
#include "Evaluator.h"
#include "Models.h"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <limits>
#include <random>
#include <string>
#include <vector>

using namespace hyperpatch;

namespace
{

constexpr double Epsilon = std::numeric_limits<double>::epsilon();

std::vector<double> RandomSites(std::mt19937& random, int count)
{
  std::uniform_real_distribution<double> step(0.3, 1.0);
  std::vector<double> sites{ step(random) };
  while (static_cast<int>(sites.size()) < count)
  {
    sites.push_back(sites.back() + step(random));
  }
  return sites;
}

std::vector<double> UniformSites(int count, double first = 0.0, double last = 1.0)
{
  std::vector<double> sites;
  for (int i = 0; i < count; ++i)
  {
    sites.push_back(first + (last - first) * i / (count - 1));
  }
  return sites;
}

/// The dense matrix of basis functions (columns) at sites (rows).
Eigen::MatrixXd Collocation(const KnotVector& knots, const std::vector<double>& sites)
{
  Eigen::MatrixXd matrix =
    Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(sites.size()), knots.Size());
  std::vector<double> values(static_cast<std::size_t>(knots.Degree() + 1));
  for (std::size_t i = 0; i < sites.size(); ++i)
  {
    const int span = knots.FindSpan(sites[i]);
    knots.BasisFunctions(span, sites[i], values.data());
    for (int j = 0; j <= knots.Degree(); ++j)
    {
      matrix(static_cast<Eigen::Index>(i), span - knots.Degree() + j) =
        values[static_cast<std::size_t>(j)];
    }
  }
  return matrix;
}

template <typename Function>
std::string Message(Function&& function)
{
  try
  {
    function();
  }
  catch (const Error& error)
  {
    return error.what();
  }
  return "no error";
}

template <typename Function>
void ExpectError(Function&& function, const std::string& text)
{
  const std::string message = Message(function);
  EXPECT_NE(message.find(text), std::string::npos) << message;
}

/// The greatest error at the sites, over the greatest value.
double ErrorAtSites(const Spline& spline, const std::array<std::vector<double>, 3>& sites,
  const Eigen::MatrixXd& values)
{
  Eigen::MatrixXd result(values.rows(), values.cols());
  Evaluator(spline).EvaluateGrid(sites, result.data());
  return (result - values).cwiseAbs().maxCoeff() / values.cwiseAbs().maxCoeff();
}

}

TEST(InterpolationKnots, OddDegreesDropKnotsNextToTheEnds)
{
  const std::vector<double> sites{ 0, 1, 3, 4, 7, 8, 9 };
  EXPECT_EQ(
    InterpolationKnots(1, sites).Knots(), (std::vector<double>{ 0, 0, 1, 3, 4, 7, 8, 9, 9 }));
  EXPECT_EQ(
    InterpolationKnots(3, sites).Knots(), (std::vector<double>{ 0, 0, 0, 0, 3, 4, 7, 9, 9, 9, 9 }));
  EXPECT_EQ(InterpolationKnots(5, sites).Knots(),
    (std::vector<double>{ 0, 0, 0, 0, 0, 0, 4, 9, 9, 9, 9, 9, 9 }));
}

TEST(InterpolationKnots, EvenDegreesAverage)
{
  const std::vector<double> sites{ 0, 1, 3, 4, 7, 8, 9 };
  EXPECT_EQ(InterpolationKnots(2, sites).Knots(),
    (std::vector<double>{ 0, 0, 0, 2, 3.5, 5.5, 7.5, 9, 9, 9 }));
  EXPECT_EQ(InterpolationKnots(4, sites).Knots(),
    (std::vector<double>{ 0, 0, 0, 0, 0, 3.75, 5.5, 9, 9, 9, 9, 9 }));
}

TEST(InterpolationKnots, RefusesTooFewAndCoincidentSites)
{
  ExpectError(
    [] {
      static_cast<void>(InterpolationKnots(3, { 0, 1, 2 }));
    },
    "3 samples are too few");
  ExpectError([] { static_cast<void>(InterpolationKnots(0, { 0, 1, 2 })); }, "degree 0");
  ExpectError([] { static_cast<void>(InterpolationKnots(1, { 0, 1, 1 })); }, "sites 1 and 2");
  ExpectError([] { static_cast<void>(InterpolationKnots(1, { 0, NAN, 1 })); }, "sites 0 and 1");
}

TEST(LeastSquaresKnots, FollowTheDensityOfTheSites)
{
  std::vector<double> sites;
  for (int i = 0; i <= 40; ++i)
  {
    sites.push_back(i * i);
  }
  EXPECT_EQ(LeastSquaresKnots(3, 41, sites), InterpolationKnots(3, sites));
  // Every fourth site is a place.
  EXPECT_EQ(LeastSquaresKnots(3, 11, sites).Breaks(),
    (std::vector<double>{ 0, 64, 144, 256, 400, 576, 784, 1024, 1600 }));
  ExpectError([&] { static_cast<void>(LeastSquaresKnots(3, 42, sites)); }, "42 control points");
  ExpectError([&] { static_cast<void>(LeastSquaresKnots(3, 3, sites)); }, "too few");
  ExpectError([&] { static_cast<void>(LeastSquaresKnots(3, -1, sites)); }, "too few");
  ExpectError([] { static_cast<void>(LeastSquaresKnots(1, 3, { 0, 1, 1, 2 })); }, "sites 1 and 2");
}

TEST(Interpolate, ReproducesSamplesOfAllDegreesAndShapes)
{
  std::mt19937 random(31);
  std::uniform_real_distribution<double> value(-1.0, 1.0);
  for (int degree = 1; degree <= 7; ++degree)
  {
    for (int components : { 1, 3 })
    {
      // Sizes on both sides of a block of lines, and the least that there may be.
      const std::array<std::vector<double>, 3> sites{ RandomSites(random, 37 + degree),
        RandomSites(random, degree + 1), RandomSites(random, 19) };
      std::array<KnotVector, 3> knots;
      for (std::size_t d = 0; d < 3; ++d)
      {
        knots[d] = InterpolationKnots(degree, sites[d]);
      }
      Eigen::MatrixXd values(components, (37 + degree) * (degree + 1) * 19);
      for (Eigen::Index i = 0; i < values.size(); ++i)
      {
        values.data()[i] = value(random);
      }
      const Spline spline = Interpolate(knots, sites, values);
      // Not-a-knot ends with uneven sites have condition numbers of 1e4 and more at degree 7.
      EXPECT_LE(ErrorAtSites(spline, sites, values), 1e5 * Epsilon) << degree;
    }
  }
}

TEST(Interpolate, MeetsEverySplineOfItsSpace)
{
  std::mt19937 random(32);
  for (int degree = 1; degree <= 5; ++degree)
  {
    const std::array<KnotVector, 3> knots{ models::RandomKnots(random, degree, 12, true),
      models::RandomKnots(random, degree, 9, true), KnotVector() };
    const Spline spline = models::RandomSpline(random, knots, 2, false);
    std::array<std::vector<double>, 3> sites;
    for (std::size_t d = 0; d < 3; ++d)
    {
      sites[d] = GrevilleAbscissae(knots[d]);
    }
    Eigen::MatrixXd values(2, spline.NumberOfControlPoints());
    Evaluator(spline).EvaluateGrid(sites, values.data());
    const Spline again = Interpolate(knots, sites, values);
    EXPECT_EQ(again.Knots(), spline.Knots());
    // The condition of Greville collocation is below 2^(2p) for these knots.
    EXPECT_LE((again.Coefficients() - spline.Coefficients()).cwiseAbs().maxCoeff(),
      std::pow(4.0, degree) * 16 * Epsilon);
  }
}

TEST(Interpolate, ErrorOfASmoothFieldFallsWithTheDegreePlusOne)
{
  const auto function = [](double x, double y, double z)
  { return std::sin(5.0 * x + 2.0 * y + 0.3) + std::exp(-x * z) * std::cos(3.0 * z - y); };
  const auto sample = [&function](const std::vector<double>& line)
  {
    Eigen::MatrixXd values(1, line.size() * line.size() * line.size());
    Eigen::Index i = 0;
    for (const double z : line)
    {
      for (const double y : line)
      {
        for (const double x : line)
        {
          values(0, i++) = function(x, y, z);
        }
      }
    }
    return values;
  };
  double before[6] = {};
  for (int count : { 25, 49 })
  {
    const std::vector<double> line = UniformSites(count);
    const std::vector<double> fine = UniformSites(3 * (count - 1) + 1);
    const Eigen::MatrixXd values = sample(line);
    const Eigen::MatrixXd exact = sample(fine);
    for (int degree = 1; degree <= 5; ++degree)
    {
      const KnotVector knots = InterpolationKnots(degree, line);
      const Spline spline = Interpolate({ knots, knots, knots }, { line, line, line }, values);
      const double error = ErrorAtSites(spline, { fine, fine, fine }, exact);
      if (before[degree] > 0.0)
      {
        const double slope = std::log2(before[degree] / error);
        std::cout << "degree " << degree << ": errors " << before[degree] << ", " << error
                  << ", slope " << slope << "\n";
        EXPECT_NEAR(slope, degree + 1, 0.1);
      }
      before[degree] = error;
    }
  }
}

TEST(Interpolate, IsTheSameOnAnyNumberOfThreads)
{
  std::mt19937 random(33);
  const std::array<std::vector<double>, 3> sites{ UniformSites(40), UniformSites(30),
    UniformSites(20) };
  std::array<KnotVector, 3> knots;
  for (std::size_t d = 0; d < 3; ++d)
  {
    knots[d] = InterpolationKnots(3, sites[d]);
  }
  const Eigen::MatrixXd values = Eigen::MatrixXd::Random(2, 40 * 30 * 20);
  const ParallelFor backwards = [](std::ptrdiff_t count, std::ptrdiff_t grain, const auto& body)
  {
    for (std::ptrdiff_t begin = (count - 1) / grain * grain; begin >= 0; begin -= grain)
    {
      body(begin, std::min(begin + grain, count));
    }
  };
  EXPECT_EQ(Interpolate(knots, sites, values, backwards), Interpolate(knots, sites, values));
}

TEST(Interpolate, RefusesWhatDoesNotFit)
{
  const std::array<KnotVector, 3> knots{ KnotVector::Uniform(2, 4), KnotVector(), KnotVector() };
  const auto at = [&knots](std::vector<double> sites, Eigen::Index count = 4)
  {
    static_cast<void>(
      Interpolate(knots, { std::move(sites), {}, {} }, Eigen::MatrixXd::Ones(1, count)));
  };
  EXPECT_NO_THROW(at({ 0, 0.3, 0.7, 1 }));
  ExpectError([&] { at({ 0, 0.3, 1 }); }, "3 sites");
  ExpectError([&] { at({ 0, 0.3, 0.3, 1 }); }, "coincides");
  ExpectError([&] { at({ 0, 0.3, 0.2, 1 }); }, "sort");
  ExpectError([&] { at({ 0, 0.3, NAN, 1 }); }, "site 2 (nan) is not a finite number");
  ExpectError([&] { at({ 0, 0.3, 0.7, 2 }); }, "outside the domain");
  ExpectError([&] { at({ 0, 0.1, 0.2, 0.4 }); }, "Schoenberg-Whitney");
  ExpectError([&] { at({ 0, 0.3, 0.7, 1 }, 5); }, "5 samples");
  Eigen::MatrixXd bad = Eigen::MatrixXd::Ones(1, 4);
  bad(0, 2) = NAN;
  ExpectError(
    [&] {
      static_cast<void>(Interpolate(knots, { std::vector<double>{ 0, 0.3, 0.7, 1 } }, bad));
    },
    "sample 2 is not a finite number");
}

TEST(LeastSquares, AgreesWithADenseSolution)
{
  std::mt19937 random(34);
  for (int degree = 1; degree <= 5; ++degree)
  {
    for (double smoothing : { 0.0, 0.3, 100.0 })
    {
      const std::vector<double> sites = RandomSites(random, 30);
      const KnotVector knots = LeastSquaresKnots(degree, 11, sites);
      const DirectionFit fit = DirectionFit::LeastSquares(knots, sites, smoothing);
      const Eigen::MatrixXd basis = Collocation(knots, sites);
      Eigen::MatrixXd normal = basis.transpose() * basis;
      for (int j = 1; j + 1 < knots.Size(); ++j)
      {
        // Second divided differences, on uniform Greville abscissae (1, -2, 1).
        const double h = (sites.back() - sites.front()) / (knots.Size() - 1);
        const double a = knots.Greville(j) - knots.Greville(j - 1);
        const double b = knots.Greville(j + 1) - knots.Greville(j);
        Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(knots.Size());
        row.segment(j - 1, 3) << 1 / a, -1 / a - 1 / b, 1 / b;
        row *= h * h / (0.5 * (a + b));
        normal += smoothing * row.transpose() * row;
      }
      // Rows are sites, columns are lines.
      const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> samples =
        Eigen::MatrixXd::Random(30, 5);
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> result(11, 5);
      fit(5, samples.data(), result.data());
      const Eigen::MatrixXd expected = normal.ldlt().solve(basis.transpose() * samples);
      // The normal equations have a condition of at most some 1e5 here.
      EXPECT_LE((result - expected).cwiseAbs().maxCoeff(), 1e6 * Epsilon) << degree;
    }
  }
}

TEST(LeastSquares, OfAsManyControlPointsAsSamplesInterpolates)
{
  std::mt19937 random(35);
  const std::vector<double> sites = RandomSites(random, 20);
  const KnotVector knots = LeastSquaresKnots(3, 20, sites);
  const Eigen::MatrixXd values = Eigen::MatrixXd::Random(1, 20);
  const Spline curve =
    FitGrid({ DirectionFit::LeastSquares(knots, sites), DirectionFit(), DirectionFit() }, values);
  const Spline same = InterpolateCurve(3, sites, values);
  EXPECT_LE((curve.Coefficients() - same.Coefficients()).cwiseAbs().maxCoeff(), 1e6 * Epsilon);
}

TEST(LeastSquares, KeepsStraightLinesUnderAnySmoothing)
{
  std::mt19937 random(36);
  const std::vector<double> sites = RandomSites(random, 25);
  Eigen::MatrixXd values(2, 25);
  for (int i = 0; i < 25; ++i)
  {
    values.col(i) << 1.0 - 0.5 * sites[static_cast<std::size_t>(i)], 3.0;
  }
  for (double smoothing : { 0.0, 1.0, 1e6 })
  {
    const KnotVector knots = LeastSquaresKnots(3, 15, sites);
    const Spline curve = FitGrid(
      { DirectionFit::LeastSquares(knots, sites, smoothing), DirectionFit(), DirectionFit() },
      values);
    // Smoothing adds its own size to the condition number.
    EXPECT_LE(
      ErrorAtSites(curve, { sites, { 0.5 }, { 0.5 } }, values), (1e5 + 100 * smoothing) * Epsilon);
  }
}

TEST(LeastSquares, FitsGridsOfFewerControlPointsThanSamples)
{
  // A spline of the space itself is met, whatever the sizes: compaction between directions.
  std::mt19937 random(37);
  const std::array<std::vector<double>, 3> sites{ RandomSites(random, 41), RandomSites(random, 18),
    RandomSites(random, 23) };
  const std::array<KnotVector, 3> knots{ LeastSquaresKnots(3, 9, sites[0]),
    LeastSquaresKnots(2, 18, sites[1]), LeastSquaresKnots(1, 7, sites[2]) };
  const Spline spline = models::RandomSpline(random, knots, 3, false);
  Eigen::MatrixXd values(3, 41 * 18 * 23);
  Evaluator(spline).EvaluateGrid(sites, values.data());
  std::array<DirectionFit, 3> fits;
  for (std::size_t d = 0; d < 3; ++d)
  {
    fits[d] = DirectionFit::LeastSquares(knots[d], sites[d]);
  }
  const Spline again = FitGrid(fits, values);
  ASSERT_EQ(again.Sizes(), spline.Sizes());
  EXPECT_LE((again.Coefficients() - spline.Coefficients()).cwiseAbs().maxCoeff(), 1e5 * Epsilon);
}

TEST(LeastSquares, RefusesWhatIsNotDetermined)
{
  const KnotVector knots = KnotVector::Uniform(3, 10);
  ExpectError([&] { static_cast<void>(DirectionFit::LeastSquares(knots, UniformSites(9))); },
    "9 sites do not determine 10 control points");
  ExpectError([&]
    { static_cast<void>(DirectionFit::LeastSquares(knots, UniformSites(30, 0.0, 0.5))); },
    "none is left for basis function 7");
  EXPECT_NO_THROW(
    static_cast<void>(DirectionFit::LeastSquares(knots, UniformSites(30, 0.0, 0.5), 1.0)));
  ExpectError([&] { static_cast<void>(DirectionFit::LeastSquares(knots, { 0.5 }, 1.0)); },
    "1 sites do not determine");
  ExpectError([&] { static_cast<void>(DirectionFit::LeastSquares(knots, UniformSites(30), -1.0)); },
    "smoothing");
  ExpectError(
    [&] {
      static_cast<void>(DirectionFit::LeastSquares(knots, { 0, 0, 1 }));
    },
    "coincides");
}

TEST(ChordParameters, AreLengthsOfChords)
{
  Eigen::MatrixXd points(2, 4);
  points << 0, 3, 3, 4, 0, 4, 5, 5;
  const std::vector<double> chords = ChordParameters(points);
  EXPECT_EQ(chords, (std::vector<double>{ 0.0, 5.0 / 7.0, 6.0 / 7.0, 1.0 }));
  // Squares of these would vanish.
  EXPECT_EQ(ChordParameters(std::exp2(-800) * points), chords);
  EXPECT_EQ(ChordParameters(points, 0.0), (std::vector<double>{ 0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0 }));
  points.col(2) = points.col(1);
  ExpectError([&] { static_cast<void>(ChordParameters(points)); }, "points 1 and 2 coincide");
  ExpectError([&] { static_cast<void>(ChordParameters(points.leftCols(1))); }, "at least 2 points");
  points(0, 3) = INFINITY;
  ExpectError([&] { static_cast<void>(ChordParameters(points)); }, "sample 3");
}
