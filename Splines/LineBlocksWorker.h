// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_LineBlocksWorker_h
#define hyperpatch_LineBlocksWorker_h

#include "Parallel.h"

#include <Eigen/Core>

#include <algorithm>
#include <cstddef>

namespace hyperpatch
{

/// The lines along the middle index of an array inner x samples x outer, cut into blocks of about
/// the size of the second level cache. The lines of a block are copied side by side, so that work
/// on a row of the block is work on a run, and strides of the array are met once per line only.
class LineBlocks
{
public:
  using Index = Eigen::Index;

  /// Some lines: `Length` neighbours along the inner index in each of `Slabs` slabs.
  struct Block
  {
    Index Number, FirstSlab, Slabs, FirstLine, Length;
    [[nodiscard]] Index Lines() const { return this->Slabs * this->Length; }
  };

  LineBlocks(Index inner, Index samples, Index outer)
    : Inner(inner)
    , Samples(samples)
    , Outer(outer)
  {
    constexpr Index blockNumbers = 16384;
    const Index lines = std::max<Index>(8, blockNumbers / samples / 8 * 8);
    // Short runs: whole slabs side by side. Long ones: parts of a slab.
    this->Slabs = std::max<Index>(1, lines / inner);
    this->Run = this->Slabs > 1 ? inner : std::min(lines, inner);
    this->Parts = (inner + this->Run - 1) / this->Run;
  }

  /// How many there are: Block::Number is 0 .. Count() - 1.
  [[nodiscard]] Index Count() const
  {
    return (this->Outer + this->Slabs - 1) / this->Slabs * this->Parts;
  }

  /// Bound of Block::Lines().
  [[nodiscard]] Index MaximalLines() const { return this->Run * this->Slabs; }

  /// Calls work() once per chunk, and what it returns, with its own scratch, for every block.
  template <typename MakeWork>
  void ForEach(const ParallelFor& parallelFor, MakeWork&& makeWork) const
  {
    parallelFor(this->Count(), 1 + this->Count() / 256,
      [this, &makeWork](std::ptrdiff_t begin, std::ptrdiff_t end)
      {
        auto work = makeWork();
        for (std::ptrdiff_t i = begin; i < end; ++i)
        {
          const Index firstSlab = i / this->Parts * this->Slabs;
          const Index firstLine = i % this->Parts * this->Run;
          work(Block{ i, firstSlab, std::min(this->Slabs, this->Outer - firstSlab), firstLine,
            std::min(this->Run, this->Inner - firstLine) });
        }
      });
  }

  /// Rows of the block from the array.
  void Read(const Block& block, const double* data, double* rows) const
  {
    this->Copy(block, this->Samples,
      [data, rows](Index at, Index row, Index length)
      { std::copy_n(data + at, length, rows + row); });
  }

  /// The first `count` rows of the array from the block.
  void Write(const Block& block, Index count, const double* rows, double* data) const
  {
    this->Copy(block, count,
      [data, rows](Index at, Index row, Index length)
      { std::copy_n(rows + row, length, data + at); });
  }

private:
  template <typename Function>
  void Copy(const Block& block, Index count, Function&& copy) const
  {
    const Index width = block.Lines();
    for (Index s = 0; s < block.Slabs; ++s)
    {
      const Index origin = (block.FirstSlab + s) * this->Samples * this->Inner + block.FirstLine;
      for (Index i = 0; i < count; ++i)
      {
        copy(origin + i * this->Inner, i * width + s * block.Length, block.Length);
      }
    }
  }

  Index Inner, Samples, Outer;
  Index Slabs, Run, Parts;
};

}

#endif
