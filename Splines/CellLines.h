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
/// of root cells, so that no cell reaches across. Directions of patches that meet have the same
/// lines on their common face when all of them are made of one (On()).
class CellLines
{
public:
  /// A direction that is not there: the one line 0, at this parameter.
  explicit CellLines(double parameter = 0.0);

  /// \param breaks the parameters between which everything is one polynomial, ascending
  /// \param isCrease one per break; the two ends always are
  /// \param cells about how many root cells are wanted
  CellLines(std::vector<double> breaks, const std::vector<bool>& isCrease, int cells);

  /// The same lines in another direction, or those of a part of it.
  /// \param breaks as many as these have, where the direction has them: ascending, or descending if
  /// it runs against this one
  /// \param first, last the crease lines, counted in root cells, that become the first and last
  /// line
  [[nodiscard]] CellLines On(std::vector<double> breaks, int first, int last) const;

  /// The size of a root cell, a power of two; a cell of size 1 cannot be halved.
  static constexpr int RootSize = 1 << 18;
  /// The most root cells of one direction; more creases than that throw an Error.
  static constexpr int MostRoots = 4096;
  [[nodiscard]] int NumberOfRoots() const { return static_cast<int>(this->Roots.size()); }
  /// The number of root cells times their size; 0 for a direction that is not there.
  [[nodiscard]] int Length() const { return static_cast<int>(this->Roots.size()) * RootSize; }
  [[nodiscard]] double Parameter(int line) const;
  [[nodiscard]] bool IsCrease(int line) const;
  /// Whether parameters fall from line to line.
  [[nodiscard]] bool IsMirrored() const { return this->B.back() < this->B.front(); }

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
};

}

#endif
