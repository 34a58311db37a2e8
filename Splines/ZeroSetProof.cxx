// SPDX-License-Identifier: BSD-3-Clause
#include "ZeroSetWorker.h"

#include <algorithm>
#include <cmath>

namespace hyperpatch
{

namespace
{

constexpr std::array<Part, 3> Everywhere{ Part::Whole, Part::Whole, Part::Whole };

/// The least product of two slopes in the range.
double LeastProduct(const Range& slopes)
{
  const double low = std::min(std::abs(slopes.Low), std::abs(slopes.High));
  return slopes.Contains(0.0) ? slopes.Low * slopes.High : low * low;
}

/// A number below 27 of a part of a box.
int NumberOf(const std::array<Part, 3>& part)
{
  return static_cast<int>(part[0]) + 3 * static_cast<int>(part[1]) + 9 * static_cast<int>(part[2]);
}

}

template <typename Visitor>
void ZeroSet::Worker::ForSides(const std::array<Part, 3>& part, Visitor&& visit) const
{
  for (int i = 0; i < 27; ++i)
  {
    const std::array<int, 3> choice{ i % 3, i / 3 % 3, i / 9 };
    std::array<Part, 3> side = part;
    bool exists = i > 0;
    bool isPoint = true;
    for (std::size_t d = 0; d < 3; ++d)
    {
      const bool isThere = this->Lines[d].Length() > 0;
      exists = exists && (choice[d] == 0 || (isThere && part[d] == Part::Whole));
      side[d] = choice[d] == 0 ? part[d] : choice[d] == 1 ? Part::Low : Part::High;
      isPoint = isPoint && !(isThere && side[d] == Part::Whole);
    }
    if (exists && !isPoint)
    {
      visit(side);
    }
  }
}

bool ZeroSet::Worker::IsGraph(const BoxSpline& f, const std::array<Part, 3>& part) const
{
  if (!f.Values(part).Contains(0.0) || f.Vanishes(part))
  {
    return true;
  }
  bool isPoint = true;
  for (const int d : this->Axes)
  {
    if (part[static_cast<std::size_t>(d)] == Part::Whole)
    {
      isPoint = false;
      if (!f.Derivative(d, part).Contains(0.0))
      {
        return true;
      }
    }
  }
  return isPoint;
}

std::array<Range, 3> ZeroSet::Worker::SlopesOf(
  const BoxSpline& f, const std::array<Part, 3>& part) const
{
  std::array<Range, 3> slopes{};
  for (const int d : this->Axes)
  {
    const auto D = static_cast<std::size_t>(d);
    slopes[D] = part[D] == Part::Whole ? f.Derivative(d, part) : Range{ 0.0, 0.0 };
  }
  return slopes;
}

bool ZeroSet::Worker::CanHideNeck(
  const BoxSpline& f, const std::array<Part, 3>& part, const std::array<Range, 3>& slopes) const
{
  // A tube along which f grows is a graph. Signs at nodes do not show where it passes through a
  // face, or through an edge twice; where it can do so at one place only, that is a bulge. A neck
  // has gradients at a right angle to each other (Plantinga & Vegter 2004).
  double product = 0.0; // no more than that of any two gradients
  for (const Range& slope : slopes)
  {
    product += LeastProduct(slope);
  }
  if (this->Axes.size() < 3 || product > 0.0)
  {
    return false;
  }
  int hidden = 0;
  this->ForSides(part,
    [&](const std::array<Part, 3>& side)
    { hidden += hidden > 1 || this->IsGraph(f, side) ? 0 : 1; });
  return hidden > 1;
}

ZeroSet::Worker::Height ZeroSet::Worker::FindHeight(const Box& box, const BoxSpline& f) const
{
  Height height;
  double least = 0.0;
  double greatest = 0.0;
  const std::array<Range, 3> slopes = this->SlopesOf(f, Everywhere);
  for (const int d : this->Axes)
  {
    const Range& slope = slopes[static_cast<std::size_t>(d)];
    const double low = std::min(std::abs(slope.Low), std::abs(slope.High));
    greatest = std::max({ greatest, std::abs(slope.Low), std::abs(slope.High) });
    if (!slope.Contains(0.0) && low > least)
    {
      least = low;
      height.Axis = d;
      height.Rises = slope.Low > 0.0;
    }
  }
  height.Steepness = greatest > 0.0 ? least / greatest : 0.0;

  std::array<std::array<Part, 3>, 3> parts{};
  std::array<int, 3> count{ 1, 1, 1 };
  for (std::size_t d = 0; d < 3; ++d)
  {
    const CellLines& lines = this->Lines[d];
    parts[d][0] = Part::Whole;
    for (const bool high : { false, true })
    {
      if (lines.IsCrease(box.Low[d] + (high ? box.Size : 0)))
      {
        parts[d][static_cast<std::size_t>(count[d]++)] = this->PartAt(d, high);
      }
    }
  }
  for (int i = 1; i < count[0] * count[1] * count[2] && height.Axis >= 0; ++i)
  {
    const std::array<Part, 3> part{ parts[0][static_cast<std::size_t>(i % count[0])],
      parts[1][static_cast<std::size_t>(i / count[0] % count[1])],
      parts[2][static_cast<std::size_t>(i / (count[0] * count[1]))] };
    if (!this->IsGraph(f, part) || this->CanHideNeck(f, part, this->SlopesOf(f, part)))
    {
      height.Axis = -1;
    }
  }
  if (height.Axis >= 0 && this->CanHideNeck(f, Everywhere, slopes))
  {
    height.Axis = -1;
  }
  return height;
}

ZeroSet::Worker::UnseenSides ZeroSet::Worker::FindUnseen(const Box& box, BoxSpline& f) const
{
  UnseenSides unseen;
  if (!this->Field.Restrict(this->Parameters(box), f))
  {
    return unseen.set();
  }
  this->ForSides(Everywhere,
    [&](const std::array<Part, 3>& side)
    { unseen[static_cast<std::size_t>(NumberOf(side))] = !this->IsGraph(f, side); });
  const UnseenSides own = unseen;
  this->ForSides(Everywhere,
    [&](const std::array<Part, 3>& side)
    {
      this->ForSides(side,
        [&](const std::array<Part, 3>& end)
        {
          if (own[static_cast<std::size_t>(NumberOf(end))])
          {
            unseen.set(static_cast<std::size_t>(NumberOf(side)));
          }
        });
    });
  return unseen;
}

void ZeroSet::Worker::FindBeside(
  const Box& box, const Numbering& leaves, std::vector<std::size_t>& beside) const
{
  beside.clear();
  const auto touches = [&](const Box& other)
  {
    return std::all_of(this->Axes.begin(), this->Axes.end(),
      [&](int axis)
      {
        const auto d = static_cast<std::size_t>(axis);
        return other.Low[d] <= box.Low[d] + box.Size && box.Low[d] <= other.Low[d] + other.Size;
      });
  };
  const auto find = [&](const Box& other)
  {
    const Index leaf = leaves.Find({ other.Low[0], other.Low[1], other.Low[2], other.Size });
    if (leaf >= 0)
    {
      beside.push_back(static_cast<std::size_t>(leaf));
    }
    return leaf >= 0;
  };
  std::vector<Box> open;
  for (int i = 0; i < 27; ++i)
  {
    const std::array<int, 3> offset{ i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1 };
    Box other = box;
    bool exists = i != 13;
    for (std::size_t d = 0; d < 3; ++d)
    {
      other.Low[d] += offset[d] * box.Size;
      exists =
        exists && (offset[d] == 0 || (other.Low[d] >= 0 && other.Low[d] < this->Lines[d].Length()));
    }
    if (!exists)
    {
      continue;
    }
    // As large or larger; or smaller ones.
    Box around = other;
    while (!find(around) && around.Size < CellLines::RootSize)
    {
      around.Size *= 2;
      for (const int d : this->Axes)
      {
        around.Low[static_cast<std::size_t>(d)] &= ~(around.Size - 1);
      }
    }
    open.assign(1, other);
    while (!open.empty())
    {
      const Box part = open.back();
      open.pop_back();
      const bool isHalved =
        this->HalvedKeys.Find({ part.Low[0], part.Low[1], part.Low[2], part.Size }) >= 0;
      if (touches(part) && (part.Size == other.Size || !find(part)) && isHalved)
      {
        this->Halve(part, open);
      }
    }
  }
}

std::vector<ZeroSet::Worker::Box> ZeroSet::Worker::TakeBulges()
{
  // The sheet that bulges into a certified leaf is drawn by the leaf that it comes from, if it is
  // known there: from leaf to leaf, starting from those where nothing is known.
  Numbering leaves;
  std::vector<std::size_t> open;
  for (std::size_t l = 0; l < this->Leaves.size(); ++l)
  {
    const Box& box = this->Leaves[l].At;
    leaves.Number({ box.Low[0], box.Low[1], box.Low[2], box.Size });
    if (!this->Leaves[l].IsCertified)
    {
      open.push_back(l);
    }
  }
  std::vector<char> isTaken(this->Leaves.size(), 0);
  std::vector<std::optional<UnseenSides>> unseen(this->Leaves.size());
  std::vector<std::size_t> beside;
  BoxSpline f;
  while (!open.empty() && !this->Options.Abort())
  {
    const Box at = this->Leaves[open.back()].At;
    open.pop_back();
    this->FindBeside(at, leaves, beside);
    for (const std::size_t l : beside)
    {
      Leaf& leaf = this->Leaves[l];
      if (!leaf.IsCertified || isTaken[l] != 0)
      {
        continue;
      }
      // What both have in common, or the side of the leaf that it is in.
      std::array<Part, 3> common = Everywhere;
      for (const int axis : this->Axes)
      {
        const auto d = static_cast<std::size_t>(axis);
        common[d] = leaf.At.Low[d] == at.Low[d] + at.Size ? this->PartAt(d, false)
          : leaf.At.Low[d] + leaf.At.Size == at.Low[d]    ? this->PartAt(d, true)
                                                          : Part::Whole;
      }
      unseen[l] = unseen[l] ? unseen[l] : this->FindUnseen(leaf.At, f);
      if (!(*unseen[l])[static_cast<std::size_t>(NumberOf(common))])
      {
        continue;
      }
      if (leaf.At.Size > 1 && !this->WasCapped && this->Width(leaf.At) > this->Options.Tolerance)
      {
        isTaken[l] = 1;
      }
      else
      {
        leaf.IsCertified = false;
        this->Undecided.push_back(leaf.At);
        open.push_back(l);
      }
    }
  }
  return this->TakeApart(isTaken);
}

bool ZeroSet::Worker::UncoverBulges()
{
  // All leaves are undecided where nothing bounds f.
  bool finished = true;
  while (finished && !this->Undecided.empty() && this->Field.HasBounds())
  {
    std::vector<Box> halved = this->TakeBulges();
    if (halved.empty())
    {
      break;
    }
    finished = this->SearchBoxes(std::move(halved));
  }
  return finished && !this->Options.Abort();
}

}
