// SPDX-License-Identifier: BSD-3-Clause
#include "Interpolation.h"

#include "Error.h"
#include "LineBlocksWorker.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace hyperpatch
{

namespace
{

using Eigen::Index;

std::size_t Unsigned(Index i)
{
  return static_cast<std::size_t>(i);
}

/// Fits along the middle index of an array inner x samples x outer, in place. The result has the
/// layout inner x control points x outer, packed.
void FitAlong(
  const DirectionFit& fit, Index inner, Index outer, double* data, const ParallelFor& parallelFor)
{
  const Index samples = fit.NumberOfSamples();
  const Index points = fit.NumberOfControlPoints();
  const LineBlocks blocks(inner, samples, outer);
  blocks.ForEach(parallelFor,
    [&]
    {
      const Index lines = blocks.MaximalLines();
      std::vector<double> before(Unsigned(samples * lines));
      std::vector<double> after(fit.IsInterpolation() ? 0 : Unsigned(points * lines));
      return [&fit, &blocks, points, data, before = std::move(before), after = std::move(after)](
               const LineBlocks::Block& block) mutable
      {
        blocks.Read(block, data, before.data());
        double* const result = fit.IsInterpolation() ? before.data() : after.data();
        fit(block.Lines(), before.data(), result);
        blocks.Write(block, points, result, data);
      };
    });
  if (points < samples)
  {
    for (Index s = 1; s < outer; ++s)
    {
      std::copy_n(data + s * inner * samples, inner * points, data + s * inner * points);
    }
  }
}

void CheckAscending(const std::vector<double>& sites)
{
  for (std::size_t i = 1; i < sites.size(); ++i)
  {
    if (!(sites[i - 1] < sites[i]))
    {
      throw Error("sites " + std::to_string(i - 1) + " and " + std::to_string(i) + " (" +
        std::to_string(sites[i - 1]) + " and " + std::to_string(sites[i]) +
        ") coincide or decrease: sites must ascend");
    }
  }
}

/// The first sample that is not finite, as the user should hear it.
void CheckFinite(const Eigen::MatrixXd& samples)
{
  if (samples.allFinite())
  {
    return;
  }
  for (Index i = 0; i < samples.cols(); ++i)
  {
    if (!samples.col(i).allFinite())
    {
      throw Error("sample " + std::to_string(i) + " is not a finite number");
    }
  }
}

}

KnotVector InterpolationKnots(int degree, const std::vector<double>& sites)
{
  const auto n = static_cast<int>(sites.size());
  if (degree < 1)
  {
    throw Error("degree " + std::to_string(degree) + " cannot interpolate: take 1 or more");
  }
  if (n < degree + 1)
  {
    throw Error(std::to_string(n) + " samples are too few for degree " + std::to_string(degree) +
      ": at least " + std::to_string(degree + 1) + " are needed; take a lower degree");
  }
  CheckAscending(sites);
  std::vector<double> knots(Unsigned(degree + 1), sites.front());
  for (int i = 1; i < n - degree; ++i)
  {
    // Relative to the first of them, so that equal steps give exact averages.
    const double first = sites[Unsigned(i)];
    double sum = 0.0;
    for (int j = i; j < i + degree; ++j)
    {
      sum += sites[Unsigned(j)] - first;
    }
    knots.push_back(degree % 2 == 1 ? sites[Unsigned(i + (degree - 1) / 2)] : first + sum / degree);
  }
  knots.insert(knots.end(), Unsigned(degree + 1), sites.back());
  return KnotVector(degree, std::move(knots));
}

KnotVector LeastSquaresKnots(int degree, int size, const std::vector<double>& sites)
{
  const auto n = static_cast<int>(sites.size());
  if (size > n)
  {
    throw Error(std::to_string(size) + " control points are more than the " + std::to_string(n) +
      " samples can determine");
  }
  if (size == n)
  {
    return InterpolationKnots(degree, sites);
  }
  if (size < 2 || size < degree + 1)
  {
    throw Error(std::to_string(size) + " control points are too few for degree " +
      std::to_string(degree) + ": at least " + std::to_string(std::max(degree, 1) + 1) +
      " are needed");
  }
  CheckAscending(sites);
  std::vector<double> places(Unsigned(size));
  for (int i = 0; i < size; ++i)
  {
    const double at = static_cast<double>(i) * (n - 1) / (size - 1);
    const int before = std::min(static_cast<int>(at), n - 2);
    const double left = sites[Unsigned(before)];
    const double right = sites[Unsigned(before + 1)];
    places[Unsigned(i)] = i == size - 1 ? right : left + (at - before) * (right - left);
  }
  return InterpolationKnots(degree, places);
}

std::vector<double> GrevilleAbscissae(const KnotVector& knots)
{
  std::vector<double> sites(Unsigned(knots.Size()));
  for (int i = 0; i < knots.Size(); ++i)
  {
    sites[Unsigned(i)] = knots.Greville(i);
  }
  return sites;
}

Spline FitGrid(
  const std::array<DirectionFit, 3>& fits, Eigen::MatrixXd samples, const ParallelFor& parallelFor)
{
  Index expected = 1;
  for (const DirectionFit& fit : fits)
  {
    expected *= fit.NumberOfSamples();
  }
  if (samples.cols() != expected)
  {
    throw Error(std::to_string(samples.cols()) + " samples do not fill the grid " +
      std::to_string(fits[0].NumberOfSamples()) + " x " +
      std::to_string(fits[1].NumberOfSamples()) + " x " +
      std::to_string(fits[2].NumberOfSamples()) + " of the sites");
  }
  CheckFinite(samples);
  // The slowest direction first: where control points are fewer, less is left for the others.
  Index outer = 1;
  Index inner = samples.size();
  for (int d = 2; d >= 0; --d)
  {
    const DirectionFit& fit = fits[Unsigned(d)];
    inner /= fit.NumberOfSamples();
    if (fit.NumberOfSamples() > 1)
    {
      FitAlong(fit, inner, outer, samples.data(), parallelFor);
    }
    outer *= fit.NumberOfControlPoints();
  }
  samples.conservativeResize(Eigen::NoChange, outer);
  return Spline({ fits[0].Knots(), fits[1].Knots(), fits[2].Knots() }, std::move(samples));
}

Spline Interpolate(const std::array<KnotVector, 3>& knots,
  const std::array<std::vector<double>, 3>& sites, Eigen::MatrixXd values,
  const ParallelFor& parallelFor)
{
  std::array<DirectionFit, 3> fits;
  for (std::size_t d = 0; d < 3; ++d)
  {
    if (knots[d] != KnotVector())
    {
      fits[d] = DirectionFit::Interpolation(knots[d], sites[d]);
    }
  }
  return FitGrid(fits, std::move(values), parallelFor);
}

Spline InterpolateCurve(int degree, const std::vector<double>& sites, Eigen::MatrixXd points)
{
  return Interpolate({ InterpolationKnots(degree, sites), KnotVector(), KnotVector() },
    { sites, {}, {} }, std::move(points));
}

std::vector<double> ChordParameters(const Eigen::MatrixXd& points, double exponent)
{
  if (points.cols() < 2)
  {
    throw Error("a curve needs at least 2 points, there is " + std::to_string(points.cols()));
  }
  CheckFinite(points);
  std::vector<double> parameters(Unsigned(points.cols()), 0.0);
  for (Index i = 1; i < points.cols(); ++i)
  {
    const double step = std::pow((points.col(i) - points.col(i - 1)).stableNorm(), exponent);
    if (!(step > 0.0))
    {
      throw Error("points " + std::to_string(i - 1) + " and " + std::to_string(i) +
        " coincide: remove one of the two");
    }
    parameters[Unsigned(i)] = parameters[Unsigned(i - 1)] + step;
  }
  const double length = parameters.back();
  for (double& parameter : parameters)
  {
    parameter /= length;
  }
  return parameters;
}

}
