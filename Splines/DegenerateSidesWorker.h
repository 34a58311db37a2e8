// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_DegenerateSidesWorker_h
#define hyperpatch_DegenerateSidesWorker_h

#include "TensorGridWorker.h"

#include <array>
#include <cstdint>
#include <vector>

namespace hyperpatch
{

/// The bit of a side in a set of sides, u0 u1 v0 v1 w0 w1.
[[nodiscard]] inline unsigned SideBit(int direction, int end)
{
  return 1u << (2 * direction + end);
}

/// Internal to ValidityTest: the faces, edges and corners of an element where det J is 0 to
/// rounding, and which coefficients that excuses from having a sign.
class DegenerateSides
{
public:
  /// \param coefficients of det J (times W^4) on the element, each right to `error`
  /// \return ElementValidity::Degenerate
  std::uint32_t Find(const TensorGrid& grid, const double* coefficients, double error);

  /// Every coefficient is 0 to rounding.
  [[nodiscard]] bool IsAllOfIt() const { return this->Layers[0] == this->Grid.Size[0]; }

  /// Whether a coefficient that is 0 to rounding belongs to a degenerate face, edge or corner.
  /// \param boxSides of the element that the box of the coefficients lies on
  [[nodiscard]] bool IsExcused(unsigned boxSides, std::size_t i) const;

private:
  [[nodiscard]] int ZeroLayers(int direction, int end) const;
  [[nodiscard]] unsigned SidesOf(std::size_t i) const;
  [[nodiscard]] bool IsZero(std::size_t i) const;
  [[nodiscard]] bool IsZeroWhere(unsigned sides) const;

  TensorGrid Grid;
  const double* Values = nullptr;
  double Error = 0.0;
  /// Layers of zeros next to each side.
  std::array<int, 6> Layers{};
  /// The sides that meet in each degenerate edge or corner.
  std::vector<unsigned> Excused;
};

}

#endif
