// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_Interpolation_h
#define hyperpatch_Interpolation_h

#include "DirectionFit.h"
#include "Parallel.h"
#include "Spline.h"

#include <Eigen/Core>

#include <array>
#include <vector>

namespace hyperpatch
{

/// Clamped knots on [first site, last site] for interpolation at given sites. Odd degree: the sites
/// themselves, without the (p - 1) / 2 next to each end (not-a-knot). Even degree: averages of p
/// consecutive sites (The NURBS Book, eq. 9.8). Smooth data are met with order p + 1 either way.
/// \throws Error if the degree is less than 1, there are fewer than degree + 1 sites, or they are
/// not finite and strictly ascending
[[nodiscard]] KnotVector InterpolationKnots(int degree, const std::vector<double>& sites);

/// Clamped knots for `size` control points that follow the density of the sites: the
/// InterpolationKnots of `size` places, equally far apart when sites are counted. As many control
/// points as sites: their InterpolationKnots.
/// \throws Error also if `size` is less than degree + 1 or more than the number of sites
[[nodiscard]] KnotVector LeastSquaresKnots(int degree, int size, const std::vector<double>& sites);

/// The Greville abscissae of all control points: the sites to interpolate at where they are free.
/// Of a direction that is not there, the middle of its domain.
[[nodiscard]] std::vector<double> GrevilleAbscissae(const KnotVector& knots);

/// Fits a tensor grid of samples, one direction after the other.
/// \param fits one per direction; DirectionFit() for one that is not there
/// \param samples m x (n0 n1 n2), u fastest. Pass an rvalue: the control points are computed in its
/// place, and beside it only blocks of lines are allocated
/// \param parallelFor threads of the caller
/// \throws Error if the number of samples is not the product of those of the fits, or one is not
/// finite (the message has its index)
[[nodiscard]] Spline FitGrid(const std::array<DirectionFit, 3>& fits, Eigen::MatrixXd samples,
  const ParallelFor& parallelFor = SerialFor);

/// The spline over given knots that has given values on a tensor grid of sites.
/// \param sites as many per direction as control points, see DirectionFit::Interpolation; those of
/// a direction that is not there are ignored
/// \param values m x (n0 n1 n2), u fastest; see FitGrid
[[nodiscard]] Spline Interpolate(const std::array<KnotVector, 3>& knots,
  const std::array<std::vector<double>, 3>& sites, Eigen::MatrixXd values,
  const ParallelFor& parallelFor = SerialFor);

/// The curve through points at given parameters, over InterpolationKnots.
/// \param points m x (number of sites)
[[nodiscard]] Spline InterpolateCurve(
  int degree, const std::vector<double>& sites, Eigen::MatrixXd points);

/// Parameters of points along a curve by the lengths of the chords between them, from 0 to 1
/// (centripetal for exponent 1/2, equal steps for 0; The NURBS Book, eqs. 9.5, 9.6).
/// \throws Error if there are fewer than 2 points, one is not finite, or consecutive ones coincide
/// (exponent other than 0)
[[nodiscard]] std::vector<double> ChordParameters(
  const Eigen::MatrixXd& points, double exponent = 1.0);

}

#endif
