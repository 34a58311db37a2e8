// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_ScatteredFit_h
#define hyperpatch_ScatteredFit_h

#include "GridFit.h"
#include "Parallel.h"
#include "Spline.h"

#include <Eigen/Core>

#include <array>

namespace hyperpatch
{

struct ScatteredFitOptions
{
  std::array<int, 3> Degrees{ 3, 3, 3 };
  /// The least number of control points per direction; the number of knot spans is the next power
  /// of two.
  std::array<int, 3> ControlPoints{ 16, 16, 16 };
  /// More than 0: in the place of ControlPoints, spans are halved until the error at the points is
  /// not larger, or there are four times as many control points as points.
  double Tolerance = 0.0;
  ErrorMeasure Measure = ErrorMeasure::Maximum;
};

/// Multilevel B-spline approximation of scattered data (Lee, Wolberg & Shin, IEEE TVCG 3(3), 1997):
/// from the best linear polynomial on, each level adds a spline with half the spacing to what the
/// coarser ones leave; the sum is one spline. Every control point is an average of the data around
/// it, so there is no system to solve, gaps are bridged by the coarse levels, and coincident points
/// are averaged. Time per level is O(points).
///
/// \param parameters 3 x N, inside the box
/// \param values m x N
/// \param low, high the box: the domain of the spline, with uniform knots. A direction in which it
/// is flat is not there
/// \throws Error if there is no point, sizes differ, a number is not finite or a point is outside
/// the box, a degree is less than 1, or ControlPoints are fewer than a degree + 1
[[nodiscard]] Spline FitScattered(const Eigen::Matrix3Xd& parameters, const Eigen::MatrixXd& values,
  std::array<double, 3> low, std::array<double, 3> high, const ScatteredFitOptions& options = {},
  const ParallelFor& parallelFor = SerialFor);

/// The errors at points anywhere.
/// \param parameters 3 x N
/// \param values m x N
[[nodiscard]] FitError MeasureError(const Spline& spline, const Eigen::Matrix3Xd& parameters,
  const Eigen::MatrixXd& values, const ParallelFor& parallelFor = SerialFor);

}

#endif
