// SPDX-License-Identifier: BSD-3-Clause
#include "ZeroSetWorker.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace hyperpatch
{

std::pair<ZeroSet::Worker::Index, bool> ZeroSet::Worker::AddNode(const Node& node)
{
  const auto added = this->Nodes.Number({ node[0], node[1], node[2], 0 });
  if (added.second)
  {
    this->NodeAt.push_back(node);
  }
  return added;
}

void ZeroSet::Worker::CollectNodes()
{
  const std::size_t known = this->CornersOf.size();
  // In Morton order what is near in space is near in memory.
  std::sort(this->Leaves.begin() + static_cast<std::ptrdiff_t>(known), this->Leaves.end(),
    [](const Leaf& a, const Leaf& b)
    {
      int most = 0;
      bool less = false;
      for (std::size_t d = 0; d < 3; ++d)
      {
        const int differs = a.At.Low[d] ^ b.At.Low[d];
        if (most < differs && most < (most ^ differs)) // a higher bit than before
        {
          most = differs;
          less = a.At.Low[d] < b.At.Low[d];
        }
      }
      return less;
    });
  this->CornersOf.resize(this->Leaves.size());
  const auto addCorners = [this](const Box& box, int divisions)
  {
    std::array<int, 3> count{ 1, 1, 1 };
    for (const int d : this->Axes)
    {
      count[static_cast<std::size_t>(d)] = divisions + 1;
    }
    const int step = box.Size / divisions;
    for (int i = 0; i < count[0] * count[1] * count[2]; ++i)
    {
      this->AddNode(
        { box.Low[0] + step * (i % count[0]), box.Low[1] + step * (i / count[0] % count[1]),
          box.Low[2] + step * (i / (count[0] * count[1])) });
    }
  };
  // The corners of leaves, and the places where boxes around them were halved.
  for (std::size_t l = known; l < this->Leaves.size(); ++l)
  {
    const Leaf& leaf = this->Leaves[l];
    for (int c = 0; c < 8; ++c)
    {
      this->CornersOf[l][static_cast<std::size_t>(c)] =
        static_cast<int>(this->AddNode(this->Corner(leaf.At, c)).first);
    }
    for (Box box = leaf.At; box.Size < CellLines::RootSize;)
    {
      box.Size *= 2;
      for (const int d : this->Axes)
      {
        box.Low[static_cast<std::size_t>(d)] &= ~(box.Size - 1);
      }
      if (!this->HalvedKeys.Number({ box.Low[0], box.Low[1], box.Low[2], box.Size }).second)
      {
        break;
      }
      this->Halved.push_back(box);
      addCorners(box, 2);
    }
  }
}

bool ZeroSet::Worker::FindValues()
{
  const std::size_t known = this->NodeValues.size();
  this->NodeValues.resize(this->Nodes.Count());
  return this->Parallel(static_cast<Index>(this->NodeValues.size() - known), Batch,
    [this, known](Index begin, Index end)
    {
      Eigen::Matrix<double, 3, Batch> parameters;
      const std::size_t first = known + static_cast<std::size_t>(begin);
      for (Index i = 0; i < end - begin; ++i)
      {
        parameters.col(i) = this->ParameterOf(this->NodeAt[first + static_cast<std::size_t>(i)]);
      }
      this->Field.Evaluate(
        static_cast<std::size_t>(end - begin), parameters.data(), &this->NodeValues[first]);
    });
}

ZeroSet::Worker::Sides ZeroSet::Worker::CommonSides(const std::array<int, 3>& offset)
{
  const auto step = [&offset](int d) { return offset[static_cast<std::size_t>(d)]; };
  const auto touches = [&step](int d, bool high) { return step(d) == 0 || (step(d) > 0) == high; };
  Sides common = 0;
  for (int d = 0; d < 3; ++d)
  {
    const int b = (d + 1) % 3;
    const int c = (d + 2) % 3;
    for (const bool high : { false, true })
    {
      const bool isBeside = step(b) == 0 && step(c) == 0;
      common |= isBeside && touches(d, high) ? FaceBit(d, high) : 0u;
      for (const bool other : { false, true })
      {
        const bool isAlong = step(d) == 0 && touches(b, high) && touches(c, other);
        common |= isAlong ? EdgeBit(d, high, other) : 0u;
      }
    }
  }
  return common;
}

bool ZeroSet::Worker::FindDivided()
{
  this->Divided.assign(this->Leaves.size(), this->Axes.size() < 3 ? AllSides : 0u);
  if (this->Axes.size() < 3)
  {
    return true;
  }
  std::vector<std::pair<std::array<int, 3>, Sides>> beside;
  for (int i = 0; i < 27; ++i)
  {
    const std::array<int, 3> offset{ i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1 };
    const Sides common = CommonSides(offset);
    if (common != 0 && i != 13)
    {
      beside.emplace_back(offset, common);
    }
  }
  constexpr Index Grain = 256;
  return this->Parallel(static_cast<Index>(this->Leaves.size()), Grain,
    [this, &beside](Index begin, Index end)
    {
      for (auto l = static_cast<std::size_t>(begin); l < static_cast<std::size_t>(end); ++l)
      {
        const auto& [low, size] = this->Leaves[l].At;
        for (const auto& [offset, common] : beside)
        {
          // Nodes on sides may be those of boxes beyond. Others are those of boxes beside that were
          // halved: nodes of smaller ones come with those.
          bool goesOn = false;
          for (int d = 0; d < 3; ++d)
          {
            const auto D = static_cast<std::size_t>(d);
            const bool isAcross = offset[(D + 1) % 3] == 0 && offset[(D + 2) % 3] == 0;
            goesOn = goesOn ||
              (isAcross && offset[D] != 0 && this->GoesOn(d, low[D] + (offset[D] > 0 ? size : 0)));
          }
          const Numbering::Key box{ low[0] + offset[0] * size, low[1] + offset[1] * size,
            low[2] + offset[2] * size, size };
          this->Divided[l] |= goesOn || this->HalvedKeys.Find(box) >= 0 ? common : 0u;
        }
      }
    });
}

}
