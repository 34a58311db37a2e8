// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_DeterminantKernel_h
#define hyperpatch_DeterminantKernel_h

#include <cstddef>

/// Internal to ValidityTest: the Bernstein coefficients of det(P_u, P_v, P_w) of several polynomial
/// elements at once, one per lane of a vector register, so that the registers are full for any
/// degree. DeterminantKernel.inl is compiled once per instruction set; plain data and internal
/// linkage only, for the reason told in EvaluatorKernel.h.
namespace hyperpatch
{

/// What does not depend on the points. The products are convolutions of binomially scaled
/// coefficients (Farouki & Rajan 1988); no binomial is computed twice.
struct DeterminantShape
{
  int Degrees[3];
  /// Per direction and derivative coefficient: the degree times the binomials.
  const double* Scales[3];
  /// Per coefficient of the determinant: the reciprocal of its binomials.
  const double* Unscale;
};

struct DeterminantKernels
{
  const char* Name;
  /// Elements that are worked on together; the innermost dimension of every array below.
  int Lanes;

  /// \param points 3 x product of (degrees + 1) x Lanes
  /// \param scratch 3 x (product of derivative counts, summed, and of the cross product P_v x P_w)
  /// x Lanes
  /// \param coefficients product of (3 degrees) x Lanes
  /// \param least, greatest coefficient, Lanes each
  /// \param magnitudes 3 (direction) x 3 (coordinate) x Lanes: the greatest |derivative
  /// coefficient|
  void (*Determinant)(const DeterminantShape& shape, const double* points, double* scratch,
    double* coefficients, double* least, double* greatest, double* magnitudes);
};

extern const DeterminantKernels DeterminantBaseline;
extern const DeterminantKernels DeterminantAVX2;

}

#endif
