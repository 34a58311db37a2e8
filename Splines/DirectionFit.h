// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_DirectionFit_h
#define hyperpatch_DirectionFit_h

#include "KnotVector.h"
#include "SparseRows.h"

#include <cstddef>
#include <vector>

namespace hyperpatch
{

/// The linear map from samples at the sites of one direction to the control points of a spline
/// there: interpolation or least squares. Made once per direction, applied to any number of lines.
///
/// Interpolation solves with the collocation matrix N_j(x_i), which is totally positive: its banded
/// LU factorisation needs no pivoting (de Boor & Pinkus, Backward error analysis for totally
/// positive linear systems, 1977). Least squares solves the normal equations, of bandwidth 2p + 1.
/// Work is O(p) per sample, and less where sites are knots.
class DirectionFit
{
public:
  /// The direction that is not there: one sample is one control point.
  DirectionFit();

  /// \param sites as many as control points, finite, ascending, in the domain
  /// \throws Error if they are not, if two coincide, or if site i is not inside the support of
  /// basis function i (Schoenberg & Whitney 1953): then there is no interpolant
  [[nodiscard]] static DirectionFit Interpolation(
    const KnotVector& knots, const std::vector<double>& sites);

  /// Minimises, on every line, sum_i (s(x_i) - y_i)^2 + smoothing sum_j (D2 c)_j^2, where D2 are
  /// the second divided differences of the control points over their Greville abscissae, scaled so
  /// that equal knots give Eilers & Marx's P-splines (Statistical Science 11, 1996). Straight lines
  /// pass through any smoothing unchanged.
  /// \param smoothing at least 0; at 0 some of the sites must satisfy Schoenberg & Whitney
  /// \throws Error if sites are not finite, ascending and in the domain, or do not determine the
  /// spline
  [[nodiscard]] static DirectionFit LeastSquares(
    const KnotVector& knots, const std::vector<double>& sites, double smoothing = 0.0);

  [[nodiscard]] const KnotVector& Knots() const { return this->K; }
  [[nodiscard]] const std::vector<double>& Sites() const { return this->X; }
  [[nodiscard]] int NumberOfSamples() const { return static_cast<int>(this->X.size()); }
  [[nodiscard]] int NumberOfControlPoints() const { return this->K.Size(); }
  /// True for the interpolating map, whose two arguments may be one.
  [[nodiscard]] bool IsInterpolation() const { return this->Sums.Size() == 0; }

  /// Fits lines that stand side by side.
  /// \param lines their number
  /// \param samples NumberOfSamples() rows of `lines` numbers: row i holds the samples at site i
  /// \param coefficients NumberOfControlPoints() rows of `lines` numbers; may be `samples` if this
  /// IsInterpolation()
  void operator()(std::ptrdiff_t lines, const double* samples, double* coefficients) const;

  /// The values at the sites of splines that stand side by side.
  /// \param coefficients NumberOfControlPoints() rows of `lines` numbers
  /// \param values NumberOfSamples() rows of `lines` numbers, not `coefficients`
  void Evaluate(std::ptrdiff_t lines, const double* coefficients, double* values) const;

private:
  DirectionFit(const KnotVector& knots, const std::vector<double>& sites);
  void Factorise(std::vector<double>& band, int lower, int upper);

  KnotVector K;
  std::vector<double> X;
  SparseRows Basis;        ///< the collocation matrix
  SparseRows Sums;         ///< its transpose; none: interpolation
  SparseRows Lower, Upper; ///< of L (unit diagonal, not stored) and U (diagonal apart)
  std::vector<double> InverseDiagonal;
};

}

#endif
