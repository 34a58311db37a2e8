// SPDX-License-Identifier: BSD-3-Clause
#include "SimplexRefinementWorker.h"

#include <algorithm>
#include <cstddef>
#include <tuple>
#include <utility>

namespace hyperpatch
{

SimplexRefinement::SimplexRefinement(
  const std::array<std::vector<double>, 3>& lines, const std::array<bool, 3>& isThere)
{
  std::vector<std::size_t> axes;
  std::array<int, 3> cells{ 1, 1, 1 };
  for (std::size_t d = 0; d < 3; ++d)
  {
    if (isThere[d])
    {
      axes.push_back(d);
      cells[d] = static_cast<int>(lines[d].size()) - 1;
    }
  }
  this->D = static_cast<int>(axes.size());
  Numbering corners;
  const auto number = [&](const std::array<int, 3>& at)
  {
    const auto [corner, isNew] = corners.Number({ at[0], at[1], at[2], 0 });
    if (isNew)
    {
      this->Nodes.emplace_back(lines[0][static_cast<std::size_t>(at[0])],
        lines[1][static_cast<std::size_t>(at[1])], lines[2][static_cast<std::size_t>(at[2])]);
    }
    return static_cast<int>(corner);
  };
  for (int root = 0; root < cells[0] * cells[1] * cells[2]; ++root)
  {
    const std::array<int, 3> low{ root % cells[0], root / cells[0] % cells[1],
      root / (cells[0] * cells[1]) };
    // From the corner of even lines to that of odd ones, along the directions in every order.
    std::vector<std::size_t> order = axes;
    do
    {
      bool isPositive = true;
      for (std::size_t i = 0; i < order.size(); ++i)
      {
        isPositive = isPositive != (low[order[i]] % 2 != 0);
        for (std::size_t j = 0; j < i; ++j)
        {
          isPositive = isPositive != (order[j] > order[i]);
        }
      }
      Cell cell;
      cell.Root = root;
      std::array<int, 3> at{};
      for (const std::size_t d : axes)
      {
        at[d] = low[d] + low[d] % 2;
      }
      cell.Corners[0] = number(at);
      for (std::size_t i = 0; i < order.size(); ++i)
      {
        at[order[i]] = low[order[i]] + 1 - low[order[i]] % 2;
        cell.Corners[i + 1] = number(at);
      }
      if (!isPositive)
      {
        std::swap(cell.Corners[0], cell.Corners[1]);
      }
      this->C.push_back(cell);
    } while (std::next_permutation(order.begin(), order.end()));
  }
  for (Cell& cell : this->C)
  {
    this->FindMiddles(cell);
  }
}

void SimplexRefinement::FindMiddles(Cell& cell)
{
  for (int e = 0; e < NumberOfEdges(this->D); ++e)
  {
    const int a = cell.Corners[static_cast<std::size_t>(Edges[e][0])];
    const int b = cell.Corners[static_cast<std::size_t>(Edges[e][1])];
    const auto [edge, isNew] = this->MiddleOf.Number({ std::min(a, b), std::max(a, b), 0, 0 });
    if (isNew)
    {
      this->MiddleNode.push_back(this->NumberOfNodes());
      // Equal coordinates stay what they are: sides of the domain, knot planes.
      this->Nodes.emplace_back(0.5 * (this->Parameter(a) + this->Parameter(b)));
    }
    cell.Middles[static_cast<std::size_t>(e)] = this->MiddleNode[static_cast<std::size_t>(edge)];
  }
}

void SimplexRefinement::Refine(
  const std::vector<char>& isHalved, const std::vector<double>& length, std::vector<char>& isNew)
{
  struct Half
  {
    int Middle, A, B;
  };
  std::vector<Half> halves;
  std::vector<Cell> parts;
  const std::size_t count = this->C.size();
  isNew.assign(count, 0);
  for (std::size_t i = 0; i < count; ++i)
  {
    halves.clear();
    for (int e = 0; e < NumberOfEdges(this->D); ++e)
    {
      const Cell& cell = this->C[i];
      const int middle = cell.Middles[static_cast<std::size_t>(e)];
      if (isHalved[static_cast<std::size_t>(middle)])
      {
        halves.push_back({ middle, cell.Corners[static_cast<std::size_t>(Edges[e][0])],
          cell.Corners[static_cast<std::size_t>(Edges[e][1])] });
      }
    }
    if (halves.empty())
    {
      continue;
    }
    // The same order in all cells: neighbors divide a common face alike.
    std::sort(halves.begin(), halves.end(),
      [&length](const Half& a, const Half& b)
      {
        const double la = length[static_cast<std::size_t>(a.Middle)];
        const double lb = length[static_cast<std::size_t>(b.Middle)];
        return std::tie(lb, a.Middle) < std::tie(la, b.Middle);
      });
    parts.assign(1, this->C[i]);
    for (const Half& half : halves)
    {
      for (std::size_t p = 0, n = parts.size(); p < n; ++p)
      {
        auto& corners = parts[p].Corners;
        const auto a = std::find(corners.begin(), corners.end(), half.A) - corners.begin();
        const auto b = std::find(corners.begin(), corners.end(), half.B) - corners.begin();
        if (a < 4 && b < 4)
        {
          Cell other = parts[p];
          corners[static_cast<std::size_t>(a)] = half.Middle;
          other.Corners[static_cast<std::size_t>(b)] = half.Middle;
          parts.push_back(other);
        }
      }
    }
    for (std::size_t p = 0; p < parts.size(); ++p)
    {
      this->FindMiddles(parts[p]);
      if (p == 0)
      {
        this->C[i] = parts[p];
      }
      else
      {
        this->C.push_back(parts[p]);
      }
    }
    isNew[i] = 1;
  }
  isNew.resize(this->C.size(), 1);
}

}
