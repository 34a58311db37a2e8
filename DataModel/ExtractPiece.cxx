// SPDX-License-Identifier: BSD-3-Clause
#include "NURBSConversion.h"
#include "Operators.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace hyperpatch
{

namespace
{

/// A half-open range of spans per direction.
struct Block
{
  std::array<int, 3> Begin;
  std::array<int, 3> End;

  [[nodiscard]] int Length(std::size_t d) const { return this->End[d] - this->Begin[d]; }
  [[nodiscard]] double Elements() const
  {
    return static_cast<double>(this->Length(0)) * this->Length(1) * this->Length(2);
  }
};

Block WholeBlock(const Spline& geometry)
{
  Block block{ { 0, 0, 0 }, {} };
  for (std::size_t d = 0; d < 3; ++d)
  {
    block.End[d] = static_cast<int>(geometry.Knots(static_cast<int>(d)).Spans().size());
  }
  return block;
}

/// Halves a block, along its longest direction, until there are `parts`; fewer if it has fewer
/// elements.
void Divide(const Block& block, int parts, std::vector<Block>& blocks)
{
  std::size_t longest = 0;
  for (std::size_t d = 1; d < 3; ++d)
  {
    longest = block.Length(d) > block.Length(longest) ? d : longest;
  }
  const int length = block.Length(longest);
  if (parts < 2 || length < 2)
  {
    blocks.push_back(block);
    return;
  }
  const int left = parts / 2;
  const int cut = std::clamp((length * left + parts / 2) / parts, 1, length - 1);
  Block first = block;
  Block second = block;
  first.End[longest] = second.Begin[longest] = block.Begin[longest] + cut;
  Divide(first, left, blocks);
  Divide(second, parts - left, blocks);
}

/// Into how many parts each patch is cut, so that pieces of about the same number of elements can
/// be made of them: one where there are patches enough.
std::vector<int> PartsOfPatches(const std::vector<double>& elements, int numberOfPieces)
{
  double total = 0.0;
  for (const double count : elements)
  {
    total += count;
  }
  std::vector<int> parts;
  int sum = 0;
  for (const double count : elements)
  {
    parts.push_back(std::max(1, static_cast<int>(std::lround(numberOfPieces * count / total))));
    sum += parts.back();
  }
  for (; sum < numberOfPieces; ++sum)
  {
    std::size_t largest = 0;
    for (std::size_t p = 1; p < parts.size(); ++p)
    {
      largest = elements[p] / parts[p] > elements[largest] / parts[largest] ? p : largest;
    }
    ++parts[largest];
  }
  return parts;
}

}

MultiPatch ExtractPiece(const MultiPatch& model, int piece, int numberOfPieces)
{
  MultiPatch result;
  result.Interfaces = model.Interfaces;
  result.Boundaries = model.Boundaries;
  if (model.Patches.empty())
  {
    return result;
  }
  std::vector<double> elements;
  for (const Patch& patch : model.Patches)
  {
    elements.push_back(WholeBlock(patch.Body.Geometry()).Elements());
  }
  const std::vector<int> parts = PartsOfPatches(elements, numberOfPieces);

  std::vector<std::pair<std::size_t, Block>> blocks;
  double total = 0.0;
  for (std::size_t p = 0; p < parts.size(); ++p)
  {
    std::vector<Block> own;
    Divide(WholeBlock(model.Patches[p].Body.Geometry()), parts[p], own);
    for (const Block& block : own)
    {
      blocks.emplace_back(p, block);
    }
    total += elements[p];
  }

  double before = 0.0;
  for (std::size_t b = 0; b < blocks.size(); ++b)
  {
    const auto& [p, block] = blocks[b];
    const double middle = before + 0.5 * block.Elements();
    before += block.Elements();
    const int owner = blocks.size() <= static_cast<std::size_t>(numberOfPieces)
      ? static_cast<int>(b)
      : static_cast<int>(numberOfPieces * middle / total);
    if (owner != piece)
    {
      continue;
    }
    const Patch& patch = model.Patches[p];
    result.Patches.push_back(parts[p] == 1 ? patch : RestrictPatch(patch, block.Begin, block.End));
  }
  return result;
}

}
