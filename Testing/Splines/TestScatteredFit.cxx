// SPDX-License-Identifier: BSD-3-Clause
#include "ScatteredFit.h"

#include "Error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>

using namespace hyperpatch;

namespace
{

constexpr double Epsilon = std::numeric_limits<double>::epsilon();
constexpr std::array<double, 3> Low{ -1.0, 0.0, 2.0 };
constexpr std::array<double, 3> High{ 1.0, 4.0, 3.0 };

Eigen::Matrix3Xd RandomPoints(int count)
{
  std::mt19937 random(51);
  Eigen::Matrix3Xd points(3, count);
  for (int i = 0; i < count; ++i)
  {
    for (int d = 0; d < 3; ++d)
    {
      const auto k = static_cast<std::size_t>(d);
      points(d, i) = std::uniform_real_distribution<double>(Low[k], High[k])(random);
    }
  }
  return points;
}

template <typename Function>
Eigen::MatrixXd Values(const Eigen::Matrix3Xd& points, Function&& function)
{
  Eigen::MatrixXd values(1, points.cols());
  for (Eigen::Index i = 0; i < points.cols(); ++i)
  {
    values(0, i) = function(points(0, i), points(1, i), points(2, i));
  }
  return values;
}

double Wave(double x, double y, double z)
{
  return std::sin(2.0 * x + y) + z * z;
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

TEST(FitScattered, LinearDataAreMetExactly)
{
  const Eigen::Matrix3Xd points = RandomPoints(50);
  const Eigen::MatrixXd values =
    Values(points, [](double x, double y, double z) { return 3.0 - x + 0.5 * y + 2.0 * z; });
  const Spline spline = FitScattered(points, values, Low, High);
  // 16 control points of degree 3 have 13 spans, 16 with the next power of two.
  EXPECT_EQ(spline.Sizes(), (std::array<int, 3>{ 19, 19, 19 }));
  EXPECT_LE(MeasureError(spline, points, values).Maximum, 1e3 * Epsilon);
  EXPECT_NEAR(spline.Evaluate(0.1, 3.9, 2.2)[0], 3.0 - 0.1 + 1.95 + 4.4, 1e3 * Epsilon);
}

TEST(FitScattered, ErrorFallsWithTheLevels)
{
  const Eigen::Matrix3Xd points = RandomPoints(20000);
  const Eigen::MatrixXd values = Values(points, Wave);
  double before = 4.0;
  for (int size : { 4, 8, 16 })
  {
    ScatteredFitOptions options;
    options.ControlPoints = { size, size, size };
    const FitError error =
      MeasureError(FitScattered(points, values, Low, High, options), points, values);
    EXPECT_EQ(error.Count, 20000);
    EXPECT_LE(error.RootMeanSquare, error.Maximum);
    EXPECT_LE(error.RootMeanSquare, 0.6 * before);
    before = error.RootMeanSquare;
  }
  EXPECT_LE(before, 0.01);
}

TEST(FitScattered, MeetsATolerance)
{
  const Eigen::Matrix3Xd points = RandomPoints(3000);
  const Eigen::MatrixXd values = Values(points, Wave);
  ScatteredFitOptions options;
  options.Degrees = { 2, 3, 1 };
  options.Tolerance = 0.1;
  const Spline spline = FitScattered(points, values, Low, High, options);
  EXPECT_LE(MeasureError(spline, points, values).Maximum, 0.1);
  // y is the longest side of the box, z the shortest.
  EXPECT_GT(spline.Knots(1).Spans().size(), spline.Knots(2).Spans().size());

  ScatteredFitOptions mean = options;
  mean.Measure = ErrorMeasure::RootMeanSquare;
  const Spline fewer = FitScattered(points, values, Low, High, mean);
  EXPECT_LE(MeasureError(fewer, points, values).RootMeanSquare, 0.1);
  EXPECT_LT(fewer.NumberOfControlPoints(), spline.NumberOfControlPoints());

  // Contradicting data are averaged, and end the search.
  Eigen::Matrix3Xd twice(3, 2);
  twice << 0, 0, 1, 1, 2.5, 2.5;
  Eigen::MatrixXd two(1, 2);
  two << 1, 3;
  const Spline average = FitScattered(twice, two, Low, High, options);
  EXPECT_NEAR(average.Evaluate(0, 1, 2.5)[0], 2.0, 1e3 * Epsilon);
  EXPECT_LE(average.NumberOfControlPoints(), 4 * 2 + 64);
}

TEST(FitScattered, ScalesWithTheValues)
{
  const Eigen::Matrix3Xd points = RandomPoints(300);
  const Eigen::MatrixXd values = Values(points, Wave);
  const Spline spline = FitScattered(points, values, Low, High);
  const FitError error = MeasureError(spline, points, values);
  for (const double scale : { std::exp2(-900), std::exp2(900) })
  {
    const Spline same = FitScattered(points, scale * values, Low, High);
    EXPECT_EQ(same.Coefficients(), scale * spline.Coefficients());
    const FitError other = MeasureError(same, points, scale * values);
    EXPECT_NEAR(other.Maximum, scale * error.Maximum, 8 * Epsilon * scale * error.Maximum);
    EXPECT_NEAR(other.RootMeanSquare, scale * error.RootMeanSquare,
      1000 * Epsilon * scale * error.RootMeanSquare);
  }
}

TEST(FitScattered, ALevelIsThatOfLeeWolbergAndShin)
{
  // Signs at the corners of a cube have no linear trend, so one span shows one level: control point
  // j is sum_c w_cj^2 phi_cj / sum_c w_cj^2 with phi_cj = w_cj z_c / sum_k w_ck^2.
  Eigen::Matrix3Xd points(3, 8);
  Eigen::MatrixXd values(1, 8);
  for (int c = 0; c < 8; ++c)
  {
    const Eigen::Vector3d sign(c % 2 ? 1 : -1, c / 2 % 2 ? 1 : -1, c / 4 ? 1 : -1);
    points.col(c) = 0.6 * sign;
    values(0, c) = sign.prod();
  }
  ScatteredFitOptions options;
  options.Degrees = { 2, 2, 2 };
  options.ControlPoints = { 3, 3, 3 };
  const Spline spline = FitScattered(points, values, { -1, -1, -1 }, { 1, 1, 1 }, options);
  // Bernstein polynomials at the points.
  Eigen::MatrixXd w(8, 27);
  for (int c = 0; c < 8; ++c)
  {
    const auto bernstein = [&](int d, int i)
    {
      const double t = 0.5 * (points(d, c) + 1.0);
      return i == 0 ? (1 - t) * (1 - t) : i == 1 ? 2 * t * (1 - t) : t * t;
    };
    for (int j = 0; j < 27; ++j)
    {
      w(c, j) = bernstein(0, j % 3) * bernstein(1, j / 3 % 3) * bernstein(2, j / 9);
    }
  }
  for (int j = 0; j < 27; ++j)
  {
    double sum = 0.0;
    for (int c = 0; c < 8; ++c)
    {
      sum += w(c, j) * w(c, j) * w(c, j) * values(0, c) / w.row(c).squaredNorm();
    }
    EXPECT_NEAR(spline.Coefficients()(0, j), sum / w.col(j).squaredNorm(), 100 * Epsilon);
  }
}

TEST(FitScattered, FlatBoxesGiveSurfaces)
{
  Eigen::Matrix3Xd points = RandomPoints(4000);
  points.row(1).setConstant(0.7);
  const Eigen::MatrixXd values = Values(points, Wave);
  ScatteredFitOptions options;
  options.ControlPoints = { 19, 19, 19 };
  const Spline spline =
    FitScattered(points, values, { -1.0, 0.7, 2.0 }, { 1.0, 0.7, 3.0 }, options);
  EXPECT_EQ(spline.Sizes(), (std::array<int, 3>{ 19, 1, 19 }));
  EXPECT_LE(MeasureError(spline, points, values).RootMeanSquare, 0.01);
}

TEST(FitScattered, RefusesWhatCannotBeFitted)
{
  const Eigen::Matrix3Xd points = RandomPoints(10);
  const Eigen::MatrixXd values = Values(points, Wave);
  const auto fit = [&](const Eigen::MatrixXd& v, std::array<double, 3> high,
                     const ScatteredFitOptions& options = {})
  { static_cast<void>(FitScattered(points, v, Low, high, options)); };
  ExpectError([&] { fit(values.leftCols(9), High); }, "9 values at 10 points");
  ExpectError([&] { fit(values, { 1.0, -4.0, 3.0 }); }, "box");
  ExpectError([&] { fit(values, { 1.0, 0.01, 3.0 }); }, "outside the box");
  Eigen::MatrixXd bad = values;
  bad(0, 6) = NAN;
  ExpectError([&] { fit(bad, High); }, "sample 6");
  ScatteredFitOptions options;
  options.ControlPoints[1] = 3;
  ExpectError([&] { fit(values, High, options); }, "3 control points");
  options.Degrees[1] = 0;
  ExpectError([&] { fit(values, High, options); }, "degree 0");
}
