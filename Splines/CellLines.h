// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_CellLines_h
#define hyperpatch_CellLines_h

#include <cstdint>
#include <vector>

namespace hyperpatch
{

/// The lines, in one direction of a patch, that an octree of cells is cut along: integers 0 ..
/// Length() for the places where a cell may end.
///
/// A root cell holds one or more whole knot spans or an equal part of one. Halving a cell that
/// holds several spans cuts at a knot, halving a smaller one cuts in the middle. Creases are lines
/// of root cells, so that no cell reaches across. The same breaks, creases and number of cells
/// mirrored give the mirrored lines: patches that meet can have the same lines on their common
/// face.
class CellLines
{
public:
  /// A direction that is not there: the one line 0, at this parameter.
  explicit CellLines(double parameter = 0.0);

  /// \param breaks the parameters between which everything is one polynomial, ascending
  /// \param isCrease one per break; the two ends always are
  /// \param cells about how many root cells are wanted
  /// \param mirrored whether lines are counted from the last break
  CellLines(std::vector<double> breaks, const std::vector<bool>& isCrease, int cells,
    bool mirrored = false);

  /// The size of a root cell, a power of two; a cell of size 1 cannot be halved.
  static constexpr int RootSize = 1 << 18;
  /// The most root cells of one direction; more creases than that throw an Error.
  static constexpr int MostRoots = 4096;
  [[nodiscard]] int NumberOfRoots() const { return static_cast<int>(this->Roots.size()); }
  /// The number of root cells times their size; 0 for a direction that is not there.
  [[nodiscard]] int Length() const { return static_cast<int>(this->Roots.size()) * RootSize; }
  [[nodiscard]] double Parameter(int line) const;
  [[nodiscard]] bool IsCrease(int line) const;
  [[nodiscard]] bool IsMirrored() const { return this->Mirrored; }

private:
  /// Breaks First .. Last, or part Part of Parts of the span between two of them.
  struct Root
  {
    int First, Last;
    int Part, Parts;
  };

  std::vector<double> B; ///< in the order of the lines
  std::vector<Root> Roots;
  std::vector<bool> Creases; ///< of the root lines
  bool Mirrored = false;
};

}

#endif
