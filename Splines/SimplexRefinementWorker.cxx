// SPDX-License-Identifier: BSD-3-Clause
#include "SimplexRefinementWorker.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cstddef>
#include <utility>

namespace hyperpatch
{

namespace
{

/// Cells between two questions whether to abort.
constexpr std::size_t Step = 1 << 14;

}

SimplexRefinement::SimplexRefinement(const std::array<std::vector<double>, 3>& lines,
  const std::array<bool, 3>& isThere, const std::vector<int>& roots,
  const CollapsedSides& collapsed)
  : IsThere(isThere)
  , HasPoles(collapsed.IsAny())
{
  for (std::size_t d = 0; d < 3; ++d)
  {
    this->D += isThere[d] ? 1 : 0;
    this->Size[d] = static_cast<int>(lines[d].size()) - 1;
  }
  for (const int root : roots)
  {
    for (int c = 0; c < 8; ++c)
    {
      std::array<int, 3> at{ root % this->Size[0], root / this->Size[0] % this->Size[1],
        root / (this->Size[0] * this->Size[1]) };
      bool isCorner = true;
      for (std::size_t d = 0; d < 3; ++d)
      {
        at[d] += c >> d & 1;
        isCorner = isCorner && (isThere[d] || (c >> d & 1) == 0);
      }
      if (isCorner)
      {
        this->AddGridNode(lines, at, collapsed);
      }
    }
  }
}

int SimplexRefinement::AddGridNode(const std::array<std::vector<double>, 3>& lines,
  const std::array<int, 3>& at, const CollapsedSides& collapsed)
{
  const auto [place, isNew] = this->Corners.Number({ at[0], at[1], at[2], 0 });
  if (!isNew)
  {
    return this->NodeAt[static_cast<std::size_t>(place)];
  }
  this->Places.push_back(at);
  this->NodeAt.push_back(-1);
  unsigned sides = 0;
  for (std::size_t d = 0; d < 3; ++d)
  {
    sides |= this->IsThere[d] && at[d] == 0 ? 1u << (2 * d) : 0;
    sides |= this->IsThere[d] && at[d] == this->Size[d] ? 2u << (2 * d) : 0;
  }
  const unsigned free = collapsed.Free(sides);
  // The same point at the low end of free directions is the node for all of them.
  std::array<int, 3> first = at;
  for (std::size_t d = 0; d < 3; ++d)
  {
    first[d] = free >> d & 1 ? 0 : first[d];
    sides |= free >> d & 1 ? 3u << (2 * d) : 0;
  }
  int node = this->NumberOfNodes();
  if (first != at)
  {
    node = this->AddGridNode(lines, first, collapsed);
  }
  else
  {
    Eigen::Vector3d& u = this->Nodes.emplace_back();
    Eigen::Vector3d weights;
    for (std::size_t d = 0; d < 3; ++d)
    {
      u[static_cast<Eigen::Index>(d)] = lines[d][static_cast<std::size_t>(at[d])];
      weights[static_cast<Eigen::Index>(d)] = free >> d & 1 ? 0.0 : 1.0;
    }
    this->Weights.insert(this->Weights.end(), this->HasPoles ? 1 : 0, weights);
    this->SideBits.push_back(static_cast<unsigned char>(sides));
    this->EndsOf.push_back({ -1, -1 });
  }
  this->NodeAt[static_cast<std::size_t>(place)] = node;
  return node;
}

bool SimplexRefinement::Triangulate(const std::vector<int>& roots,
  const std::vector<unsigned>& states, const Before& isBefore, const Abort& abort)
{
  std::vector<GridCorner> corners;
  std::array<GridCorner, 4> chain{};
  for (std::size_t r = 0; r < roots.size(); ++r)
  {
    if (r % (Step / 8) == 0 && abort())
    {
      return false;
    }
    Cell cell;
    cell.Root = roots[r];
    cell.State = states[r];
    corners.clear();
    for (int c = 0; c < 8; ++c)
    {
      std::array<int, 3> at{ cell.Root % this->Size[0], cell.Root / this->Size[0] % this->Size[1],
        cell.Root / (this->Size[0] * this->Size[1]) };
      bool isCorner = true;
      for (std::size_t d = 0; d < 3; ++d)
      {
        at[d] += c >> d & 1;
        isCorner = isCorner && (this->IsThere[d] || (c >> d & 1) == 0);
      }
      if (isCorner)
      {
        corners.emplace_back(at, this->GridNode(at));
      }
    }
    this->AddSimplices(corners, chain, 0, isBefore, cell);
  }
  return true;
}

void SimplexRefinement::AddSimplices(const std::vector<GridCorner>& corners,
  std::array<GridCorner, 4>& chain, int depth, const Before& isBefore, const Cell& like)
{
  // The first corner, and the simplices of the faces that it does not belong to (De Loera, Rambau &
  // Santos, Triangulations, 2010, section 4.3.2: pulling).
  const auto first = std::min_element(corners.begin(), corners.end(),
    [&isBefore](const auto& a, const auto& b) { return isBefore(a.second, b.second); });
  for (int i = 0; i < depth; ++i)
  {
    if (chain[static_cast<std::size_t>(i)].second == first->second)
    {
      return;
    }
  }
  chain[static_cast<std::size_t>(depth)] = *first;
  if (corners.size() == 1)
  {
    Cell cell = like;
    // Lines ascend: differences of their numbers have the signs of those of parameters.
    Eigen::Matrix3d sides = Eigen::Matrix3d::Identity();
    int column = 0;
    for (std::size_t d = 0; d < 3; ++d)
    {
      for (int row = 0; row < this->D && this->IsThere[d]; ++row)
      {
        sides(row, column) = chain[static_cast<std::size_t>(row) + 1].first[d] - chain[0].first[d];
      }
      column += this->IsThere[d] ? 1 : 0;
    }
    for (int c = 0; c <= this->D; ++c)
    {
      cell.Corners[static_cast<std::size_t>(c)] = chain[static_cast<std::size_t>(c)].second;
    }
    if (sides.determinant() < 0.0)
    {
      std::swap(cell.Corners[0], cell.Corners[1]);
    }
    this->C.push_back(cell);
    return;
  }
  for (std::size_t d = 0; d < 3; ++d)
  {
    std::vector<GridCorner> face;
    for (const auto& corner : corners)
    {
      if (corner.first[d] != first->first[d])
      {
        face.push_back(corner);
      }
    }
    if (!face.empty())
    {
      this->AddSimplices(face, chain, depth + 1, isBefore, like);
    }
  }
}

std::array<FreeParameters, 4> SimplexRefinement::Parameters(const Cell& cell) const
{
  std::array<FreeParameters, 4> u;
  for (std::size_t c = 0; c <= static_cast<std::size_t>(this->D); ++c)
  {
    u[c] = this->At(cell.Corners[c]);
  }
  if (this->HasPoles)
  {
    FillFree(u.data(), this->D + 1);
  }
  return u;
}

int SimplexRefinement::FindMiddle(int a, int b) const
{
  const std::int64_t edge = this->MiddleOf.Find({ std::min(a, b), std::max(a, b), 0, 0 });
  return edge < 0 ? -1 : this->MiddleNode[static_cast<std::size_t>(edge)];
}

int SimplexRefinement::Middle(int a, int b)
{
  const auto [edge, isNew] = this->MiddleOf.Number({ std::min(a, b), std::max(a, b), 0, 0 });
  if (isNew)
  {
    this->MiddleNode.push_back(this->NumberOfNodes());
    if (this->HasPoles)
    {
      const FreeParameters middle = hyperpatch::Middle(this->At(a), this->At(b));
      this->Nodes.push_back(middle.Values);
      this->Weights.push_back(middle.Weights);
    }
    else
    {
      // Equal coordinates stay what they are: sides of the domain, knot planes.
      this->Nodes.emplace_back(0.5 * (this->Parameter(a) + this->Parameter(b)));
    }
    this->EndsOf.push_back({ a, b });
    this->SideBits.push_back(static_cast<unsigned char>(this->Sides(a) & this->Sides(b)));
  }
  return this->MiddleNode[static_cast<std::size_t>(edge)];
}

void SimplexRefinement::FindMiddles(Cell& cell)
{
  for (int e = 0; e < NumberOfEdges(this->D); ++e)
  {
    cell.Middles[static_cast<std::size_t>(e)] =
      this->Middle(cell.Corners[static_cast<std::size_t>(Edges[e][0])],
        cell.Corners[static_cast<std::size_t>(Edges[e][1])]);
  }
}

bool SimplexRefinement::Refine(const std::vector<char>& isHalved, const Before& isBefore,
  std::vector<char>& isNew, const Abort& abort)
{
  std::vector<char> isEnd(this->Nodes.size(), 0);
  for (std::size_t node = 0; node < this->Nodes.size(); ++node)
  {
    if (isHalved[node])
    {
      isEnd[static_cast<std::size_t>(this->EndsOf[node][0])] = 1;
      isEnd[static_cast<std::size_t>(this->EndsOf[node][1])] = 1;
    }
  }
  std::vector<int> halves;
  std::vector<Cell> parts;
  const std::size_t count = this->C.size();
  isNew.assign(count, 0);
  for (std::size_t i = 0; i < count; ++i)
  {
    if (i % Step == 0 && abort())
    {
      return false;
    }
    halves.clear();
    for (int e = 0; e < NumberOfEdges(this->D); ++e)
    {
      const Cell& cell = this->C[i];
      const int a = cell.Corners[static_cast<std::size_t>(Edges[e][0])];
      const int b = cell.Corners[static_cast<std::size_t>(Edges[e][1])];
      if (!isEnd[static_cast<std::size_t>(a)] || !isEnd[static_cast<std::size_t>(b)])
      {
        continue;
      }
      const int known = cell.Middles[static_cast<std::size_t>(e)];
      const int middle = known >= 0 ? known : this->FindMiddle(a, b);
      if (middle >= 0 && isHalved[static_cast<std::size_t>(middle)])
      {
        halves.push_back(middle);
      }
    }
    if (halves.empty())
    {
      continue;
    }
    // The same order in all cells: neighbors divide a common face alike.
    std::sort(halves.begin(), halves.end(), isBefore);
    this->C[i].Middles.fill(-1);
    parts.assign(1, this->C[i]);
    for (const int middle : halves)
    {
      const auto [first, last] = this->Ends(middle);
      for (std::size_t p = 0, n = parts.size(); p < n; ++p)
      {
        auto& corners = parts[p].Corners;
        const auto a = std::find(corners.begin(), corners.end(), first) - corners.begin();
        const auto b = std::find(corners.begin(), corners.end(), last) - corners.begin();
        if (a < 4 && b < 4)
        {
          Cell other = parts[p];
          corners[static_cast<std::size_t>(a)] = middle;
          other.Corners[static_cast<std::size_t>(b)] = middle;
          parts.push_back(other);
        }
      }
    }
    this->C[i] = parts[0];
    this->C.insert(this->C.end(), parts.begin() + 1, parts.end());
    isNew[i] = 1;
  }
  isNew.resize(this->C.size(), 1);
  return true;
}

}
