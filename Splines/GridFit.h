// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_GridFit_h
#define hyperpatch_GridFit_h

#include "Interpolation.h"

#include <Eigen/Core>

#include <array>
#include <functional>
#include <vector>

namespace hyperpatch
{

/// What a tolerance is a bound of.
enum class ErrorMeasure
{
  Maximum,
  RootMeanSquare
};

/// How far a spline is from samples; distances are Euclidean over the components.
struct FitError
{
  double RootMeanSquare = 0.0;
  double Maximum = 0.0;
  Eigen::Index Where = 0; ///< the (first) sample with the largest error
  Eigen::Index Count = 0; ///< samples that were compared: those that are finite

  /// Of consecutive samples, from their distances; those that are not finite are passed over.
  [[nodiscard]] static FitError Of(const Eigen::VectorXd& distances, Eigen::Index first = 0);

  [[nodiscard]] double Of(ErrorMeasure measure) const
  {
    return measure == ErrorMeasure::Maximum ? this->Maximum : this->RootMeanSquare;
  }
};

/// Copies samples first .. first + count - 1 (m numbers each) to a block. Called on several threads
/// at once.
using SampleReader = std::function<void(Eigen::Index first, Eigen::Index count, double* samples)>;

/// The errors at the samples of a tensor grid, u fastest; samples that are not finite are passed
/// over. Allocates a layer of the grid per thread.
[[nodiscard]] FitError MeasureError(const Spline& spline,
  const std::array<std::vector<double>, 3>& sites, const SampleReader& read,
  const ParallelFor& parallelFor = SerialFor);

/// Least squares with as many knots as an error asks for. Knots are placed direction by
/// direction, each for the errors of fitting along it alone (they bound the whole up to the norm of
/// the projections): intervals between sites that are knots, or for even degrees stand for one, are
/// halved where the error is too large, until the whole fit is good. All sites: interpolation.
/// \param degrees of the directions that have more than one site
/// \param samples m x (n0 n1 n2), u fastest; a working copy is made
/// \param tolerance bound of the error at the samples, more than 0
/// \throws Error if it is not, and where InterpolationKnots() and FitGrid() do
[[nodiscard]] Spline FitToTolerance(std::array<int, 3> degrees,
  const std::array<std::vector<double>, 3>& sites, const Eigen::MatrixXd& samples, double tolerance,
  ErrorMeasure measure, const ParallelFor& parallelFor = SerialFor);

/// Replaces samples that are not finite (in any component) by the solution of Laplace's equation
/// between the others, on the grid of indices and to about 1 % of the values around; the fill is
/// smooth and stays between its neighbours. \returns their indices, ascending
/// \throws Error if no sample is finite
std::vector<Eigen::Index> FillMissing(std::array<int, 3> sizes, Eigen::MatrixXd& samples);

/// The least-squares fit of a grid from which some samples are left out: what they are filled with
/// is replaced by the fit there until it stays (expectation maximisation), which is the fit of the
/// others. Interpolation keeps the fill.
/// \param missing indices of the samples to leave out, as FillMissing() gives them
/// \param samples finite everywhere
[[nodiscard]] Spline FitAroundMissing(const std::array<DirectionFit, 3>& fits,
  const std::vector<Eigen::Index>& missing, Eigen::MatrixXd samples,
  const ParallelFor& parallelFor = SerialFor);

}

#endif
