// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_ScalarField_h
#define hyperpatch_ScalarField_h

#include "Bernstein.h"
#include "Evaluator.h"

#include <Eigen/Dense>

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

namespace hyperpatch
{

/// A box in the parameter domain of a patch.
struct ParameterBox
{
  std::array<double, 3> Low;
  std::array<double, 3> High;
};

/// A scalar function f over the parameter domain of one patch, whose zero set is wanted: a slice,
/// an isosurface and the Jacobian boundary differ only in their field. Const and reentrant.
///
/// f may be multiplied by anything positive (powers of the weight function), which makes it a
/// piecewise polynomial for planes, quadrics, attributes and Jacobian determinants; then it can be
/// bounded by its Bernstein coefficients.
class ScalarField
{
public:
  virtual ~ScalarField();

  /// \param parameters 3 x count
  /// \param values count
  virtual void Evaluate(std::size_t count, const double* parameters, double* values) const = 0;

  /// \param gradients 3 x count, with respect to the patch's parameters
  virtual void EvaluateWithGradient(
    std::size_t count, const double* parameters, double* values, double* gradients) const = 0;

  /// The parameters per direction between which f is one polynomial, ends of the domain included.
  [[nodiscard]] virtual std::array<std::vector<double>, 3> Breaks() const = 0;

  /// f, up to a positive factor, on a box that lies between breaks, as a polynomial on the unit
  /// cube. Nothing where f is no polynomial: then no cell can be excluded or certified.
  [[nodiscard]] virtual std::optional<Bernstein> OnBox(const ParameterBox& box) const = 0;

  /// True where f certainly has no zero between the breaks around the box; cheap, may be false.
  [[nodiscard]] virtual bool Excludes(const ParameterBox& box) const;

  /// Moves points of the zero set, right up to round-off, onto the surface where that is known in
  /// physical space. \param points 3 x count
  virtual void Snap(std::size_t count, double* points) const;
};

/// f is a polynomial spline with one component.
class PolynomialField : public ScalarField
{
public:
  /// \param coefficientError bound of the error that each coefficient already has
  explicit PolynomialField(Spline polynomial, double coefficientError = 0.0);

  void Evaluate(std::size_t count, const double* parameters, double* values) const override;
  void EvaluateWithGradient(
    std::size_t count, const double* parameters, double* values, double* gradients) const override;
  [[nodiscard]] std::array<std::vector<double>, 3> Breaks() const override;
  [[nodiscard]] std::optional<Bernstein> OnBox(const ParameterBox& box) const override;
  [[nodiscard]] bool Excludes(const ParameterBox& box) const override;

private:
  Spline F;
  double CoefficientError;
  Evaluator E;
};

/// f = W (A_c - value) for one component of an attribute (W = 1 where polynomial).
[[nodiscard]] PolynomialField AttributeField(const Spline& attribute, int component, double value);

/// A function on physical space of degree two: x' A x + b . x + c.
struct Quadric
{
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  double c = 0.0;

  [[nodiscard]] bool IsPlane() const { return this->A.isZero(0.0); }
  [[nodiscard]] double operator()(const Eigen::Vector3d& x) const
  {
    return x.dot(this->A * x + this->b) + this->c;
  }
  [[nodiscard]] Eigen::Vector3d Gradient(const Eigen::Vector3d& x) const
  {
    return (this->A + this->A.transpose()) * x + this->b;
  }
};

/// f = W (n . P + c): the slice by a plane. Snap() puts points on the plane to round-off.
class PlaneField : public PolynomialField
{
public:
  PlaneField(const Spline& geometry, const Quadric& plane);
  void Snap(std::size_t count, double* points) const override;

private:
  Quadric Q;
};

/// f = W^2 q(P): the slice by a sphere, cylinder or other quadric; with an attribute of up to three
/// components in the place of P, its magnitude: q = |x|^2 - value^2.
class QuadricField : public ScalarField
{
public:
  /// \param isPhysical whether `spline` is the geometry, so that Snap() may move points
  QuadricField(const Spline& spline, const Quadric& quadric, bool isPhysical);

  void Evaluate(std::size_t count, const double* parameters, double* values) const override;
  void EvaluateWithGradient(
    std::size_t count, const double* parameters, double* values, double* gradients) const override;
  [[nodiscard]] std::array<std::vector<double>, 3> Breaks() const override;
  [[nodiscard]] std::optional<Bernstein> OnBox(const ParameterBox& box) const override;
  [[nodiscard]] bool Excludes(const ParameterBox& box) const override;
  void Snap(std::size_t count, double* points) const override;

private:
  Spline S;
  Quadric Q;
  bool Physical;
  Evaluator E;
};

/// f = det J of a volume (times W^4 in its Bernstein form where rational).
class JacobianField : public ScalarField
{
public:
  /// \throws Error if the geometry is not a volume of three coordinates
  explicit JacobianField(const Spline& geometry);

  void Evaluate(std::size_t count, const double* parameters, double* values) const override;
  void EvaluateWithGradient(
    std::size_t count, const double* parameters, double* values, double* gradients) const override;
  [[nodiscard]] std::array<std::vector<double>, 3> Breaks() const override;
  [[nodiscard]] std::optional<Bernstein> OnBox(const ParameterBox& box) const override;

private:
  Spline S;
  Evaluator E;
};

/// f = g(P) for a function g on physical space that can only be sampled.
class SampledField : public ScalarField
{
public:
  /// \param function (count, points 3 x count, values, gradients 3 x count or nullptr)
  using Function =
    std::function<void(std::size_t count, const double* points, double* values, double* gradients)>;

  SampledField(const Spline& geometry, Function function);

  void Evaluate(std::size_t count, const double* parameters, double* values) const override;
  void EvaluateWithGradient(
    std::size_t count, const double* parameters, double* values, double* gradients) const override;
  [[nodiscard]] std::array<std::vector<double>, 3> Breaks() const override;
  [[nodiscard]] std::optional<Bernstein> OnBox(const ParameterBox& box) const override;

private:
  Spline S;
  Function G;
  Evaluator E;
};

}

#endif
