// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_DeterminantBatchWorker_h
#define hyperpatch_DeterminantBatchWorker_h

#include "DeterminantKernel.h"

#include <array>
#include <cstddef>
#include <vector>

namespace hyperpatch
{

/// Internal to ValidityTest: the Bernstein coefficients of det J of several polynomial elements of
/// one shape at once, by the kernel that this processor can run, with their rounding bounds.
class DeterminantBatch
{
public:
  explicit DeterminantBatch(std::array<int, 3> degrees);
  DeterminantBatch(const DeterminantBatch&) = delete;
  DeterminantBatch& operator=(const DeterminantBatch&) = delete;

  /// How many elements fit.
  [[nodiscard]] std::size_t Lanes() const { return this->N; }

  /// \param count 1..Lanes()
  /// \param points of each element, 3 x product of (degrees + 1)
  void operator()(std::size_t count, const double* const* points);

  /// Least and greatest coefficient of the element in a lane.
  [[nodiscard]] double Least(std::size_t lane) const { return this->Summary[lane]; }
  [[nodiscard]] double Greatest(std::size_t lane) const { return this->Summary[this->N + lane]; }

  /// All product of (3 degrees) coefficients of the element in a lane.
  void Copy(std::size_t lane, double* coefficients) const;

  /// Bound of the error of the coefficients in a lane: rounding, and what errors of the points add.
  [[nodiscard]] double Error(std::size_t lane, double pointError) const;

private:
  /// Product tables of the kernel, and how many roundings a coefficient sees.
  void MakeTables();

  std::array<int, 3> Degrees;
  const DeterminantKernels* Kernels;
  std::size_t N;
  DeterminantShape Shape{};
  std::array<std::vector<double>, 3> Scales;
  std::vector<double> Unscale;
  double Gamma = 0.0;

  std::vector<double> Packed;
  std::vector<double> Scratch;
  std::vector<double> Coefficients;
  std::vector<double> Summary;
};

}

#endif
