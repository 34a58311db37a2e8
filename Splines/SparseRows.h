// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_SparseRows_h
#define hyperpatch_SparseRows_h

#include "KnotVector.h"

#include <cstddef>
#include <vector>

namespace hyperpatch
{

/// A sparse matrix by rows, each of which is one run of numbers, as those of a band are.
///
/// It is applied to lines that stand side by side: the operand has one row of `lines` numbers per
/// column of the matrix.
class SparseRows
{
public:
  /// Consecutive columns: First .. First + Count - 1.
  struct Row
  {
    int First;
    int Count;
    const double* Values;
  };

  /// The values N_j(x_i) of all basis functions j of a knot vector at the sites x_i, which are
  /// moved into its domain.
  [[nodiscard]] static SparseRows Collocation(
    const KnotVector& knots, const std::vector<double>& sites);

  /// One more row, from a column on. Zeros at both its ends are left out: collocation at the knots
  /// themselves has many.
  void Append(const double* begin, const double* end, int column);

  [[nodiscard]] int Size() const { return static_cast<int>(this->Runs.size()); }
  [[nodiscard]] Row operator[](int row) const
  {
    const Run& run = this->Runs[static_cast<std::size_t>(row)];
    return { run.First, run.Count, this->Values.data() + run.Begin };
  }

  /// One row of the product.
  /// \param source as many rows of `lines` numbers as there are columns
  /// \param target `lines` numbers
  void Multiply(int row, std::ptrdiff_t lines, const double* source, double* target) const;

private:
  struct Run
  {
    int First;
    int Count;
    std::size_t Begin;
  };
  std::vector<Run> Runs;
  std::vector<double> Values;
};

}

#endif
