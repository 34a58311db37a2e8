// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_SampledField_h
#define hyperpatch_SampledField_h

#include "Prepared.h"
#include "ScalarField.h"

#include <array>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

namespace hyperpatch
{

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
