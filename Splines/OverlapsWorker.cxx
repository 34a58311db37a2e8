// SPDX-License-Identifier: BSD-3-Clause
#include "OverlapsWorker.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace hyperpatch
{

namespace
{

/// A balanced binary tree: node i has the children 2i + 1 and 2i + 2.
class Tree
{
public:
  Tree(const Eigen::Matrix3Xd& low, const Eigen::Matrix3Xd& high)
    : Low(low)
    , High(high)
    , Order(static_cast<std::size_t>(low.cols()))
  {
    std::iota(this->Order.begin(), this->Order.end(), 0);
    this->Build(0, 0, this->Order.size());
  }

  std::vector<std::array<int, 2>> Pairs()
  {
    this->Within(0);
    std::sort(this->Found.begin(), this->Found.end());
    return std::move(this->Found);
  }

private:
  struct Node
  {
    Eigen::Vector3d Low;
    Eigen::Vector3d High;
    std::size_t Begin;
    std::size_t End;
  };
  static constexpr std::size_t Leaf = 4;

  void Build(std::size_t number, std::size_t begin, std::size_t end)
  {
    this->Nodes.resize(std::max(this->Nodes.size(), number + 1));
    Eigen::Vector3d low = Eigen::Vector3d::Constant(INFINITY);
    Eigen::Vector3d high = Eigen::Vector3d::Constant(-INFINITY);
    for (std::size_t i = begin; i < end; ++i)
    {
      low = low.cwiseMin(this->Low.col(this->Order[i]));
      high = high.cwiseMax(this->High.col(this->Order[i]));
    }
    this->Nodes[number] = { low, high, begin, end };
    if (end - begin <= Leaf)
    {
      return;
    }
    Eigen::Index d = 0;
    (high - low).maxCoeff(&d);
    const auto middle = (begin + end) / 2;
    const auto at = [this](std::size_t i)
    { return this->Order.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(middle), at(end),
      [this, d](int a, int b)
      { return this->Low(d, a) + this->High(d, a) < this->Low(d, b) + this->High(d, b); });
    this->Build(2 * number + 1, begin, middle);
    this->Build(2 * number + 2, middle, end);
  }

  [[nodiscard]] bool IsLeaf(const Node& node) const { return node.End - node.Begin <= Leaf; }

  void Test(std::size_t i, std::size_t j)
  {
    const int a = this->Order[i];
    const int b = this->Order[j];
    if ((this->Low.col(a).array() <= this->High.col(b).array()).all() &&
      (this->Low.col(b).array() <= this->High.col(a).array()).all())
    {
      this->Found.push_back({ std::min(a, b), std::max(a, b) });
    }
  }

  void Within(std::size_t number)
  {
    const Node node = this->Nodes[number];
    if (!this->IsLeaf(node))
    {
      this->Within(2 * number + 1);
      this->Within(2 * number + 2);
      this->Between(2 * number + 1, 2 * number + 2);
      return;
    }
    for (std::size_t i = node.Begin; i < node.End; ++i)
    {
      for (std::size_t j = i + 1; j < node.End; ++j)
      {
        this->Test(i, j);
      }
    }
  }

  void Between(std::size_t first, std::size_t second)
  {
    const Node a = this->Nodes[first];
    const Node b = this->Nodes[second];
    if ((a.Low.array() > b.High.array()).any() || (b.Low.array() > a.High.array()).any())
    {
      return;
    }
    if (this->IsLeaf(a) && this->IsLeaf(b))
    {
      for (std::size_t i = a.Begin; i < a.End; ++i)
      {
        for (std::size_t j = b.Begin; j < b.End; ++j)
        {
          this->Test(i, j);
        }
      }
      return;
    }
    const bool halveFirst =
      this->IsLeaf(b) || (!this->IsLeaf(a) && a.End - a.Begin >= b.End - b.Begin);
    for (std::size_t child = 1; child <= 2; ++child)
    {
      if (halveFirst)
      {
        this->Between(2 * first + child, second);
      }
      else
      {
        this->Between(first, 2 * second + child);
      }
    }
  }

  const Eigen::Matrix3Xd& Low;
  const Eigen::Matrix3Xd& High;
  std::vector<int> Order;
  std::vector<Node> Nodes;
  std::vector<std::array<int, 2>> Found;
};

}

std::vector<std::array<int, 2>> FindOverlaps(
  const Eigen::Matrix3Xd& low, const Eigen::Matrix3Xd& high)
{
  return Tree(low, high).Pairs();
}

}
