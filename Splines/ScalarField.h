// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_ScalarField_h
#define hyperpatch_ScalarField_h

#include "Bernstein.h"
#include "BoxSpline.h"
#include "ControlBounds.h"

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

namespace hyperpatch
{

/// A scalar function f over the parameter domain of one patch, whose zero set is wanted: a slice,
/// an isosurface and the Jacobian boundary differ only in their field. Const and reentrant.
///
/// f may be multiplied by anything positive (powers of the weight function), which makes it a
/// piecewise polynomial for planes, quadrics, attributes and Jacobian determinants; then it can be
/// bounded by its Bernstein coefficients. Constructors that take a spline itself keep a reference
/// to it; it must outlive the field.
class ScalarField
{
public:
  virtual ~ScalarField();

  /// A value that is no larger than its own rounding error is returned as 0, so that a surface
  /// which lies in a face or knot plane is that plane and no noise about it. The same parameters
  /// give the same value, whatever they are evaluated with. \param parameters 3 x count \param
  /// values count
  virtual void Evaluate(std::size_t count, const double* parameters, double* values) const = 0;

  /// \param gradients 3 x count, with respect to the patch's parameters
  virtual void EvaluateWithGradient(
    std::size_t count, const double* parameters, double* values, double* gradients) const = 0;

  /// The parameters per direction between which f is one polynomial, ends of the domain included.
  [[nodiscard]] virtual std::array<std::vector<double>, 3> Breaks() const = 0;

  /// The breaks inside the domain at which f has a kink or a jump.
  [[nodiscard]] virtual std::array<std::vector<double>, 3> Creases() const = 0;

  /// Whether f is a piecewise polynomial, so that OnBox() gives one.
  [[nodiscard]] virtual bool HasBounds() const { return true; }

  /// f, up to a positive factor, on a box that lies between breaks, as a polynomial on the unit
  /// cube. Nothing where f is no polynomial: then no cell can be excluded or certified.
  [[nodiscard]] virtual std::optional<Bernstein> OnBox(const ParameterBox& box) const = 0;

  /// f, up to a positive factor, on a box inside which nothing has a crease, as a spline.
  /// \returns false where that is not known: on a smaller box it may be
  virtual bool Restrict(const ParameterBox& box, BoxSpline& f) const;

  /// True if f certainly has no zero on the box, which may be of any size; cheap, may be false.
  [[nodiscard]] virtual bool Excludes(const ParameterBox& box) const;

  /// Moves points of the zero set, right up to round-off, onto the surface where that is known in
  /// physical space. \param points 3 x count
  virtual void Snap(std::size_t count, double* points) const;
};

}

#endif
