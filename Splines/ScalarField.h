// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_ScalarField_h
#define hyperpatch_ScalarField_h

#include "Bernstein.h"
#include "BoxSpline.h"
#include "Prepared.h"

#include <Eigen/Dense>

#include <array>
#include <cstddef>
#include <functional>
#include <memory>
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

/// A function of degree two of the components x of a spline: y' A y + b . y + c with y = x -
/// Origin. The origin should be near the spline: far from it the terms lose the digits that count.
struct Quadric
{
  Eigen::MatrixXd A; ///< m x m, symmetric; empty where the function is linear (a plane)
  Eigen::VectorXd b; ///< m
  double c = 0.0;
  Eigen::VectorXd Origin; ///< m, or empty for 0

  [[nodiscard]] bool IsLinear() const { return this->A.size() == 0; }
  /// \param x m numbers
  [[nodiscard]] double Value(const double* x) const;
  /// Sum of the magnitudes of the terms of Value(): what its rounding error is relative to.
  [[nodiscard]] double Terms(const double* x) const;
  /// \param gradient m numbers
  void Gradient(const double* x, double* gradient) const;
};

/// f = q(S) for a spline S, the geometry or an attribute (times W or W^2 where rational): slices by
/// planes, spheres, cylinders and other quadrics; isosurfaces of components and magnitudes.
class QuadricField : public ScalarField
{
public:
  /// \param isPhysical whether the spline is the geometry, so that Snap() may move points: onto a
  /// plane to round-off, onto another quadric by one step of Newton's
  /// \throws Error if the sizes of the quadric do not fit
  QuadricField(std::shared_ptr<const PreparedSpline> spline, Quadric quadric, bool isPhysical);
  QuadricField(const Spline& spline, Quadric quadric, bool isPhysical);

  void Evaluate(std::size_t count, const double* parameters, double* values) const override;
  void EvaluateWithGradient(
    std::size_t count, const double* parameters, double* values, double* gradients) const override;
  [[nodiscard]] std::array<std::vector<double>, 3> Breaks() const override;
  [[nodiscard]] std::array<std::vector<double>, 3> Creases() const override;
  [[nodiscard]] std::optional<Bernstein> OnBox(const ParameterBox& box) const override;
  bool Restrict(const ParameterBox& box, BoxSpline& f) const override;
  [[nodiscard]] bool Excludes(const ParameterBox& box) const override;
  void Snap(std::size_t count, double* points) const override;

private:
  std::shared_ptr<const PreparedSpline> S;
  Quadric Q;
  bool Physical;
};

/// The quadric whose zeros are where one component of an attribute has a value.
/// \throws Error if there is no such component
[[nodiscard]] Quadric ComponentEquals(const Spline& attribute, int component, double value);

/// The quadric whose zeros are where the magnitude of an attribute has a value; a negative one is
/// nowhere.
[[nodiscard]] Quadric MagnitudeEquals(const Spline& attribute, double value);

/// f = det J of a volume (times W^4 in its Bernstein form where rational).
class JacobianField : public ScalarField
{
public:
  /// \throws Error if the geometry is not a volume of three coordinates
  explicit JacobianField(std::shared_ptr<const PreparedSpline> geometry);
  explicit JacobianField(const Spline& geometry);

  void Evaluate(std::size_t count, const double* parameters, double* values) const override;
  void EvaluateWithGradient(
    std::size_t count, const double* parameters, double* values, double* gradients) const override;
  [[nodiscard]] std::array<std::vector<double>, 3> Breaks() const override;
  [[nodiscard]] std::array<std::vector<double>, 3> Creases() const override;
  [[nodiscard]] std::optional<Bernstein> OnBox(const ParameterBox& box) const override;
  [[nodiscard]] bool Excludes(const ParameterBox& box) const override;

private:
  std::shared_ptr<const PreparedSpline> S;
};

/// f = g(P) for a function g on physical space that can only be sampled.
class SampledField : public ScalarField
{
public:
  /// \param function (count, points 3 x count, values, gradients 3 x count or nullptr)
  using Function =
    std::function<void(std::size_t count, const double* points, double* values, double* gradients)>;

  SampledField(std::shared_ptr<const PreparedSpline> geometry, Function function);
  SampledField(const Spline& geometry, Function function);

  void Evaluate(std::size_t count, const double* parameters, double* values) const override;
  void EvaluateWithGradient(
    std::size_t count, const double* parameters, double* values, double* gradients) const override;
  [[nodiscard]] std::array<std::vector<double>, 3> Breaks() const override;
  [[nodiscard]] std::array<std::vector<double>, 3> Creases() const override;
  [[nodiscard]] bool HasBounds() const override { return false; }
  [[nodiscard]] std::optional<Bernstein> OnBox(const ParameterBox& box) const override;

private:
  std::shared_ptr<const PreparedSpline> S;
  Function G;
};

}

#endif
