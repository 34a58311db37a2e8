// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_ParameterField_h
#define hyperpatch_ParameterField_h

#include "ScalarField.h"
#include "Spline.h"

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

namespace hyperpatch
{

/// f = one parameter - value: its zeros are an iso-parametric surface. Exact, without rounding.
class ParameterField : public ScalarField
{
public:
  /// \param geometry gives the domain
  /// \throws Error if the geometry has no such direction
  ParameterField(const Spline& geometry, int direction, double value);

  void Evaluate(std::size_t count, const double* parameters, double* values) const override;
  void EvaluateWithGradient(
    std::size_t count, const double* parameters, double* values, double* gradients) const override;
  [[nodiscard]] std::array<std::vector<double>, 3> Breaks() const override;
  [[nodiscard]] std::array<std::vector<double>, 3> Creases() const override;
  [[nodiscard]] std::optional<Bernstein> OnBox(const ParameterBox& box) const override;
  [[nodiscard]] bool Excludes(const ParameterBox& box) const override;

private:
  std::array<std::vector<double>, 3> Ends;
  std::size_t Direction;
  double Value;
};

}

#endif
