// SPDX-License-Identifier: BSD-3-Clause
#include "JacobianComplexWorker.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

namespace hyperpatch
{

namespace
{

using Index = JacobianComplex::Index;
using Parameter = std::array<double, 3>;
using Triangle = std::array<Index, 3>;

/// A part of a face of a cell: all of it, or what it shares with one neighbour.
struct FacePart
{
  int Axis;
  bool IsHigh;
  ParameterBox Box; ///< flat along the axis
  int Neighbour;    ///< leaf on the other side, -1 at the end of the domain
};

/// The corners of a flat box, counter-clockwise seen from the high side of its axis.
std::array<Parameter, 4> CornersOf(const ParameterBox& box, int axis)
{
  const auto b = static_cast<std::size_t>((axis + 1) % 3);
  const auto c = static_cast<std::size_t>((axis + 2) % 3);
  std::array<Parameter, 4> corners{ box.Low, box.Low, box.Low, box.Low };
  corners[1][b] = corners[2][b] = box.High[b];
  corners[2][c] = corners[3][c] = box.High[c];
  return corners;
}

Parameter CentreOf(const ParameterBox& box)
{
  Parameter centre{};
  for (std::size_t d = 0; d < 3; ++d)
  {
    centre[d] = 0.5 * (box.Low[d] + box.High[d]);
  }
  return centre;
}

bool IsSame(const ParameterBox& a, const ParameterBox& b)
{
  return a.Low == b.Low && a.High == b.High;
}

class Builder
{
public:
  Builder(const JacobianTree& tree, CrackRepair repair)
    : Tree(tree)
    , Repair(repair)
  {
  }

  JacobianComplex Make()
  {
    this->FindFaces();
    for (const auto& [cell, faces] : this->Faces)
    {
      this->AddCell(cell, faces);
    }
    return std::move(this->Result);
  }

private:
  [[nodiscard]] const JacobianTree::Cell& At(int cell) const
  {
    return this->Tree.Cells()[static_cast<std::size_t>(cell)];
  }

  [[nodiscard]] ParameterBox Face(int cell, int axis, bool isHigh) const
  {
    const auto a = static_cast<std::size_t>(axis);
    ParameterBox box = this->At(cell).Box;
    box.Low[a] = box.High[a] = isHigh ? box.High[a] : box.Low[a];
    return box;
  }

  /// The leaves behind a face, by descent from the root.
  void FindNeighbours(int cell, const FacePart& face, std::vector<FacePart>& parts) const
  {
    const JacobianTree::Cell& node = this->At(cell);
    const auto a = static_cast<std::size_t>(face.Axis);
    const double at = face.Box.Low[a];
    const bool isBehind = face.IsHigh ? node.Box.Low[a] <= at && at < node.Box.High[a]
                                      : node.Box.Low[a] < at && at <= node.Box.High[a];
    FacePart part = face;
    for (std::size_t d = 0; d < 3; ++d)
    {
      if (d != a)
      {
        part.Box.Low[d] = std::max(face.Box.Low[d], node.Box.Low[d]);
        part.Box.High[d] = std::min(face.Box.High[d], node.Box.High[d]);
      }
    }
    const auto b = (a + 1) % 3;
    const auto c = (a + 2) % 3;
    if (!isBehind || !(part.Box.Low[b] < part.Box.High[b]) || !(part.Box.Low[c] < part.Box.High[c]))
    {
      return;
    }
    if (node.Axis < 0)
    {
      part.Neighbour = cell;
      parts.push_back(part);
      return;
    }
    this->FindNeighbours(node.Children[0], face, parts);
    this->FindNeighbours(node.Children[1], face, parts);
  }

  void FindFaces()
  {
    for (const int cell : this->Tree.Queue())
    {
      std::vector<FacePart>& parts = this->Faces[cell];
      for (int axis = 0; axis < 3; ++axis)
      {
        for (const bool isHigh : { false, true })
        {
          const FacePart face{ axis, isHigh, this->Face(cell, axis, isHigh), -1 };
          const std::size_t before = parts.size();
          this->FindNeighbours(0, face, parts);
          if (parts.size() == before)
          {
            parts.push_back(face);
          }
        }
      }
      if (this->Repair == CrackRepair::Conforming)
      {
        for (const FacePart& part : parts)
        {
          for (const Parameter& corner : CornersOf(part.Box, part.Axis))
          {
            this->AddToLines(corner);
          }
        }
      }
    }
  }

  void AddToLines(const Parameter& point)
  {
    for (std::size_t d = 0; d < 3; ++d)
    {
      this->Lines[d][{ point[(d + 1) % 3], point[(d + 2) % 3] }].insert(point[d]);
    }
  }

  Index Vertex(const Parameter& at)
  {
    const auto [found, isNew] =
      this->VertexAt.emplace(at, static_cast<Index>(this->Result.Parameters.size()));
    if (isNew)
    {
      this->Result.Parameters.push_back(at);
    }
    return found->second;
  }

  void AddCell(int cell, const std::vector<FacePart>& parts)
  {
    std::vector<Triangle> triangles;
    bool isRepaired = false;
    if (this->Repair == CrackRepair::Conforming)
    {
      for (const FacePart& part : parts)
      {
        isRepaired = this->AddPart(part, triangles) || isRepaired ||
          !IsSame(part.Box, this->Face(cell, part.Axis, part.IsHigh));
      }
    }
    else
    {
      isRepaired = this->AddFaces(cell, parts, triangles);
    }
    this->Result.RepairedCells += isRepaired ? 1 : 0;
    const Index centre = this->Vertex(CentreOf(this->At(cell).Box));
    for (const Triangle& t : triangles)
    {
      this->Result.Tetrahedra.push_back({ { t[0], t[2], t[1], centre }, cell });
    }
  }

  /// Triangles that turn counter-clockwise seen from outside of the cell.
  static void Add(Triangle t, bool isHigh, std::vector<Triangle>& triangles)
  {
    if (!isHigh)
    {
      std::swap(t[1], t[2]);
    }
    triangles.push_back(t);
  }

  /// Conforming: the triangles of a part of a face, the same for both of its cells. True if there
  /// are more corners than four.
  bool AddPart(const FacePart& part, std::vector<Triangle>& triangles)
  {
    const std::array<Parameter, 4> corners = CornersOf(part.Box, part.Axis);
    std::vector<Index> border;
    for (std::size_t i = 0; i < 4; ++i)
    {
      const Parameter& from = corners[i];
      const Parameter& to = corners[(i + 1) % 4];
      border.push_back(this->Vertex(from));
      std::size_t d = 0;
      while (from[d] == to[d])
      {
        ++d;
      }
      const std::set<double>& line = this->Lines[d].at({ from[(d + 1) % 3], from[(d + 2) % 3] });
      std::vector<double> between(
        line.upper_bound(std::min(from[d], to[d])), line.lower_bound(std::max(from[d], to[d])));
      if (to[d] < from[d])
      {
        std::reverse(between.begin(), between.end());
      }
      for (const double at : between)
      {
        Parameter point = from;
        point[d] = at;
        border.push_back(this->Vertex(point));
      }
    }
    if (border.size() == 4)
    {
      Add({ border[0], border[1], border[2] }, part.IsHigh, triangles);
      Add({ border[0], border[2], border[3] }, part.IsHigh, triangles);
      return false;
    }
    const Index centre = this->Vertex(CentreOf(part.Box));
    for (std::size_t i = 0; i < border.size(); ++i)
    {
      Add({ border[i], border[(i + 1) % border.size()], centre }, part.IsHigh, triangles);
    }
    return true;
  }

  /// The paper's faces: two triangles, or those of a larger cell behind the face. True if there is
  /// a larger one.
  bool AddFaces(int cell, const std::vector<FacePart>& parts, std::vector<Triangle>& triangles)
  {
    std::map<Parameter, Index> moved;
    std::vector<std::pair<FacePart, FacePart>> abutting;
    std::vector<FacePart> plain;
    for (int axis = 0; axis < 3; ++axis)
    {
      for (const bool isHigh : { false, true })
      {
        const FacePart own{ axis, isHigh, this->Face(cell, axis, isHigh), -1 };
        const auto part = std::find_if(parts.begin(), parts.end(),
          [&own](const FacePart& p) { return p.Axis == own.Axis && p.IsHigh == own.IsHigh; });
        const bool isKept = part->Neighbour >= 0 && !this->At(part->Neighbour).Discarded;
        const ParameterBox behind = isKept ? this->Face(part->Neighbour, axis, !isHigh) : own.Box;
        // One neighbour behind all of the face, and more of it than that.
        if (this->Repair == CrackRepair::AsPrinted && IsSame(part->Box, own.Box) &&
          !IsSame(behind, own.Box))
        {
          abutting.push_back({ own, { axis, isHigh, behind, part->Neighbour } });
          for (const Parameter& corner : CornersOf(own.Box, axis))
          {
            this->Move(corner, abutting.back().second, moved);
          }
        }
        else
        {
          plain.push_back(own);
        }
      }
    }
    const auto vertex = [&](const Parameter& at)
    {
      const auto found = moved.find(at);
      return found != moved.end() ? found->second : this->Vertex(at);
    };
    for (const FacePart& face : plain)
    {
      const std::array<Parameter, 4> corners = CornersOf(face.Box, face.Axis);
      const Index first = vertex(corners[0]);
      const Index third = vertex(corners[2]);
      Add({ first, vertex(corners[1]), third }, face.IsHigh, triangles);
      Add({ first, third, vertex(corners[3]) }, face.IsHigh, triangles);
    }
    for (const auto& [own, larger] : abutting)
    {
      this->AddAlongDiagonal(own, larger, moved, triangles);
    }
    return !abutting.empty();
  }

  /// Where a point of a larger face lies above (positive) or below its diagonal, from 0 to 1 along
  /// both edges.
  static std::array<double, 2> Local(const Parameter& at, const FacePart& larger)
  {
    std::array<double, 2> local{};
    for (int i = 0; i < 2; ++i)
    {
      const auto d = static_cast<std::size_t>((larger.Axis + 1 + i) % 3);
      local[static_cast<std::size_t>(i)] =
        (at[d] - larger.Box.Low[d]) / (larger.Box.High[d] - larger.Box.Low[d]);
    }
    return local;
  }

  /// The vertex at a point of a larger face that takes all it has from the triangles of that face.
  Index Move(const Parameter& at, const FacePart& larger, std::map<Parameter, Index>& moved)
  {
    const std::array<Parameter, 4> corners = CornersOf(larger.Box, larger.Axis);
    if (std::find(corners.begin(), corners.end(), at) != corners.end())
    {
      return this->Vertex(at);
    }
    const auto [found, isNew] =
      moved.emplace(at, static_cast<Index>(this->Result.Parameters.size()));
    if (isNew)
    {
      this->Result.Parameters.push_back(at);
      const auto [b, c] = Local(at, larger);
      const Index first = this->Vertex(corners[0]);
      const Index third = this->Vertex(corners[2]);
      this->Result.Interpolated.push_back(b >= c
          ? JacobianComplex::Hanging{ found->second, { first, this->Vertex(corners[1]), third },
              { 1.0 - b, b - c, c } }
          : JacobianComplex::Hanging{
              found->second, { first, third, this->Vertex(corners[3]) }, { 1.0 - c, b, c - b } });
    }
    return found->second;
  }

  /// Splits a face along the diagonal of the larger face that holds it (FIGURE 9).
  void AddAlongDiagonal(const FacePart& own, const FacePart& larger,
    std::map<Parameter, Index>& moved, std::vector<Triangle>& triangles)
  {
    const std::array<Parameter, 4> corners = CornersOf(own.Box, own.Axis);
    std::array<std::vector<Index>, 2> halves; // below and above the diagonal
    for (std::size_t i = 0; i < 4; ++i)
    {
      const Parameter& from = corners[i];
      const Parameter& to = corners[(i + 1) % 4];
      const auto [fromB, fromC] = Local(from, larger);
      const auto [toB, toC] = Local(to, larger);
      const double here = fromC - fromB;
      const double there = toC - toB;
      const Index vertex = this->Move(from, larger, moved);
      if (here <= 0.0)
      {
        halves[0].push_back(vertex);
      }
      if (here >= 0.0)
      {
        halves[1].push_back(vertex);
      }
      if (here * there < 0.0)
      {
        Parameter crossing = from;
        for (std::size_t d = 0; d < 3; ++d)
        {
          crossing[d] += here / (here - there) * (to[d] - from[d]);
        }
        const Index on = this->Move(crossing, larger, moved);
        halves[0].push_back(on);
        halves[1].push_back(on);
      }
    }
    for (const std::vector<Index>& half : halves)
    {
      for (std::size_t i = 1; i + 1 < half.size(); ++i)
      {
        Add({ half[0], half[i], half[i + 1] }, own.IsHigh, triangles);
      }
    }
  }

  const JacobianTree& Tree;
  CrackRepair Repair;
  std::map<int, std::vector<FacePart>> Faces;
  /// Conforming: coordinates of corners on the lines along each direction.
  std::array<std::map<std::array<double, 2>, std::set<double>>, 3> Lines;
  std::map<Parameter, Index> VertexAt;
  JacobianComplex Result;
};

}

JacobianComplex MakeComplex(const JacobianTree& tree, CrackRepair repair)
{
  return Builder(tree, repair).Make();
}

}
