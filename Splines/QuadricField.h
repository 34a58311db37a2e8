// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_QuadricField_h
#define hyperpatch_QuadricField_h

#include "Prepared.h"
#include "ScalarField.h"

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace hyperpatch
{

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
  /// Value(), and Terms() too.
  double Value(const double* x, double& terms) const
  {
    if (!this->IsLinear())
    {
      terms = this->Terms(x);
      return this->Value(x);
    }
    const double* origin = this->Origin.size() > 0 ? this->Origin.data() : nullptr;
    double sum = this->c;
    terms = std::abs(sum);
    for (Eigen::Index i = 0; i < this->b.size(); ++i)
    {
      const double o = origin ? origin[i] : 0.0;
      sum += this->b[i] * (x[i] - o);
      terms += std::abs(this->b[i]) * (std::abs(x[i]) + std::abs(o));
    }
    return sum;
  }
  /// \param gradient m numbers
  void Gradient(const double* x, double* gradient) const;
};

/// The quadric that a function on space is, read off its values around a point. Of a function that
/// is none the result means nothing.
/// \param isLinear whether it is known to be linear: a plane
/// \param size the distance at which it is looked at
/// \returns nothing if a value is not finite
[[nodiscard]] std::optional<Quadric> QuadricFromValues(
  const std::function<double(const Eigen::Vector3d&)>& value, bool isLinear,
  const Eigen::Vector3d& centre, double size);

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

}

#endif
