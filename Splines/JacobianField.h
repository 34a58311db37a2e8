// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_JacobianField_h
#define hyperpatch_JacobianField_h

#include "ElementPolynomials.h"
#include "JacobianRounding.h"
#include "Prepared.h"
#include "ScalarField.h"

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

namespace hyperpatch
{

/// f = det J - value of a volume (times W^4 in its Bernstein form where rational).
class JacobianField : public ScalarField
{
public:
  /// \throws Error if the geometry is not a volume of three coordinates
  explicit JacobianField(std::shared_ptr<const PreparedSpline> geometry, double value = 0.0);
  explicit JacobianField(const Spline& geometry, double value = 0.0);

  void Evaluate(std::size_t count, const double* parameters, double* values) const override;
  void EvaluateWithGradient(
    std::size_t count, const double* parameters, double* values, double* gradients) const override;
  [[nodiscard]] std::array<std::vector<double>, 3> Breaks() const override;
  [[nodiscard]] std::array<std::vector<double>, 3> Creases() const override;
  [[nodiscard]] std::optional<Bernstein> OnBox(const ParameterBox& box) const override;
  bool Restrict(const ParameterBox& box, BoxSpline& f) const override;
  [[nodiscard]] bool Excludes(const ParameterBox& box) const override;

private:
  std::shared_ptr<const PreparedSpline> S;
  JacobianRounding Rounding;
  double Value;
  ElementPolynomials Polynomials;
};

}

#endif
