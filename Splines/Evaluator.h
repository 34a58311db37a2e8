// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_Evaluator_h
#define hyperpatch_Evaluator_h

#include "Spline.h"

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

namespace hyperpatch
{

/// Evaluates a spline at many points: values, first and second derivatives, exact for rational
/// splines (quotient rule on homogeneous sums; The NURBS Book A4.4).
///
/// Built once per spline (it copies the control points into the layout that the fast path wants),
/// then const and reentrant: any number of threads may share it. Nothing is allocated per point.
/// Parameters outside the domain are moved to its border; the domain is closed at its end. At a
/// crease derivatives are limits from the right. NaN in any parameter gives NaN.
///
/// All output is interleaved: point after point. Derivatives are with respect to the patch's own
/// parameters. Relative to the magnitude of the control points, errors of values are a few ulp
/// times the degree; clamped corners are their control points to the last bit (rational ones to
/// the rounding of w x / w).
///
/// The sums are contracted in w, then in v, then in u, in batches and grids alike: a point has the
/// same bits wherever it stands, alone, in a batch or in a grid. The fastest instruction set of the
/// processor is chosen when an Evaluator is made; results of different ones differ by a few ulp.
/// The environment variable HYPERPATCH_INSTRUCTION_SET (baseline, avx2 or avx512) overrules the
/// choice, for comparisons between machines.
class Evaluator
{
public:
  /// \throws Error if HYPERPATCH_INSTRUCTION_SET names one that processor and build do not have
  explicit Evaluator(const Spline& spline);
  ~Evaluator();
  Evaluator(Evaluator&&) noexcept;
  Evaluator& operator=(Evaluator&&) noexcept;

  [[nodiscard]] int Components() const;

  /// \param count number of points
  /// \param parameters 3 x count: u, v, w
  /// \param values m x count
  void Evaluate(std::size_t count, const double* parameters, double* values) const;

  /// \param values m x count
  /// \param derivatives 3m x count: d/du (m numbers), d/dv, d/dw
  void EvaluateWithDerivatives(
    std::size_t count, const double* parameters, double* values, double* derivatives) const;

  /// \param second 6m x count: uu (m numbers), uv, uw, vv, vw, ww
  void EvaluateWithSecondDerivatives(std::size_t count, const double* parameters, double* values,
    double* derivatives, double* second) const;

  /// On the tensor grid of three ascending parameter lists, by sum factorisation. Allocates two
  /// blocks: basis functions of the lists, and at most two planes of the control lattice.
  /// \param values m x (product of the sizes), u fastest
  /// \param derivatives nullptr or 3m x (product of the sizes), as above
  void EvaluateGrid(const std::array<std::vector<double>, 3>& parameters, double* values,
    double* derivatives = nullptr) const;

private:
  struct Layout;
  std::unique_ptr<const Layout> L;
};

}

#endif
