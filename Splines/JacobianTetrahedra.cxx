// SPDX-License-Identifier: BSD-3-Clause
#include "JacobianTetrahedra.h"

#include "Evaluator.h"
#include "ScalarField.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <map>
#include <set>
#include <utility>

namespace hyperpatch
{

namespace
{

using Index = std::int64_t;
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

/// The complex of tetrahedra, and the surface in it.
class Complex
{
public:
  Complex(const Spline& geometry, const JacobianTree& tree, CrackRepair repair)
    : Geometry(geometry)
    , Tree(tree)
    , Repair(repair)
  {
  }

  JacobianTetrahedra Make()
  {
    this->FindFaces();
    for (const auto& [cell, faces] : this->Faces)
    {
      this->AddCell(cell, faces);
    }
    this->EvaluateVertices();
    this->March();
    this->CountOpenEdges();
    return std::move(this->Result);
  }

private:
  struct Tetrahedron
  {
    std::array<Index, 4> Vertices; ///< positively oriented in the parameter domain
    int Cell;
  };

  /// A vertex whose position and J are interpolated from those of a larger cell's face.
  struct Hanging
  {
    Index Vertex;
    Triangle From;
    std::array<double, 3> Weights;
  };

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
      this->VertexAt.emplace(at, static_cast<Index>(this->Parameters.size()));
    if (isNew)
    {
      this->Parameters.push_back(at);
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
      this->Tetrahedra.push_back({ { t[0], t[2], t[1], centre }, cell });
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
    const auto [found, isNew] = moved.emplace(at, static_cast<Index>(this->Parameters.size()));
    if (isNew)
    {
      this->Parameters.push_back(at);
      const auto [b, c] = Local(at, larger);
      const Index first = this->Vertex(corners[0]);
      const Index third = this->Vertex(corners[2]);
      this->Interpolated.push_back(b >= c
          ? Hanging{ found->second, { first, this->Vertex(corners[1]), third },
              { 1.0 - b, b - c, c } }
          : Hanging{
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

  void EvaluateVertices()
  {
    const std::size_t count = this->Parameters.size();
    this->Positions.resize(3, static_cast<Index>(count));
    this->Values.resize(count);
    if (count == 0)
    {
      return;
    }
    const double* parameters = this->Parameters.front().data();
    Evaluator(this->Geometry).Evaluate(count, parameters, this->Positions.data());
    JacobianField(this->Geometry).Evaluate(count, parameters, this->Values.data());
    for (const Hanging& hanging : this->Interpolated)
    {
      Eigen::Vector3d position = Eigen::Vector3d::Zero();
      double value = 0.0;
      for (std::size_t i = 0; i < 3; ++i)
      {
        position += hanging.Weights[i] * this->Positions.col(hanging.From[i]);
        value += hanging.Weights[i] * this->Values[static_cast<std::size_t>(hanging.From[i])];
      }
      this->Positions.col(hanging.Vertex) = position;
      this->Values[static_cast<std::size_t>(hanging.Vertex)] = value;
    }
  }

  /// The surface vertex on an edge between corners of different sign.
  Index Cut(Index a, Index b)
  {
    const std::pair<Index, Index> edge = std::minmax(a, b);
    const auto [found, isNew] = this->Cuts.emplace(edge, static_cast<Index>(this->Cuts.size()));
    if (isNew)
    {
      const auto [i, j] = edge;
      const double from = this->Values[static_cast<std::size_t>(i)];
      const double to = this->Values[static_cast<std::size_t>(j)];
      const double t = from / (from - to);
      this->Points.emplace_back(
        this->Positions.col(i) + t * (this->Positions.col(j) - this->Positions.col(i)));
      const Eigen::Map<const Eigen::Vector3d> low(
        this->Parameters[static_cast<std::size_t>(i)].data());
      const Eigen::Map<const Eigen::Vector3d> high(
        this->Parameters[static_cast<std::size_t>(j)].data());
      // On a face of the domain it stays there.
      this->PointParameters.emplace_back(low + t * (high - low));
    }
    return found->second;
  }

  void March()
  {
    // Even permutations, by the corner or corners that are alone on their side.
    static constexpr int Alone[4][4] = { { 0, 1, 2, 3 }, { 1, 0, 3, 2 }, { 2, 3, 0, 1 },
      { 3, 2, 1, 0 } };
    std::vector<Triangle> triangles;
    for (const Tetrahedron& tetrahedron : this->Tetrahedra)
    {
      const std::array<Index, 4>& v = tetrahedron.Vertices;
      std::vector<int> positive;
      std::vector<int> negative;
      for (int i = 0; i < 4; ++i)
      {
        const double value = this->Values[static_cast<std::size_t>(v[static_cast<std::size_t>(i)])];
        (value >= 0.0 ? positive : negative).push_back(i);
      }
      const auto cut = [&](int i, int j)
      { return this->Cut(v[static_cast<std::size_t>(i)], v[static_cast<std::size_t>(j)]); };
      const std::size_t before = triangles.size();
      if (positive.size() == 1)
      {
        const int* p = Alone[positive[0]];
        triangles.push_back({ cut(p[0], p[1]), cut(p[0], p[3]), cut(p[0], p[2]) });
      }
      else if (negative.size() == 1)
      {
        const int* p = Alone[negative[0]];
        triangles.push_back({ cut(p[0], p[1]), cut(p[0], p[2]), cut(p[0], p[3]) });
      }
      else if (positive.size() == 2)
      {
        // Corners a, b positive and c, d negative in an even order.
        const int a = positive[0];
        const int b = positive[1];
        const bool isEven = (b - a) % 2 != 0;
        const int c = negative[isEven ? 0 : 1];
        const int d = negative[isEven ? 1 : 0];
        triangles.push_back({ cut(a, c), cut(b, c), cut(b, d) });
        triangles.push_back({ cut(a, c), cut(b, d), cut(a, d) });
      }
      this->Result.Cells.insert(
        this->Result.Cells.end(), triangles.size() - before, tetrahedron.Cell);
    }
    this->Result.Tetrahedra = static_cast<Index>(this->Tetrahedra.size());
    this->Result.Parameters.resize(3, static_cast<Index>(this->Points.size()));
    this->Result.Points.resize(3, static_cast<Index>(this->Points.size()));
    for (std::size_t i = 0; i < this->Points.size(); ++i)
    {
      this->Result.Parameters.col(static_cast<Index>(i)) = this->PointParameters[i];
      this->Result.Points.col(static_cast<Index>(i)) = this->Points[i];
    }
    this->Result.Triangles.resize(3, static_cast<Index>(triangles.size()));
    for (std::size_t t = 0; t < triangles.size(); ++t)
    {
      this->Result.Triangles.col(static_cast<Index>(t)) =
        Eigen::Map<const Eigen::Matrix<Index, 3, 1>>(triangles[t].data());
    }
  }

  void CountOpenEdges()
  {
    std::map<std::pair<Index, Index>, int> uses;
    for (Index t = 0; t < this->Result.Triangles.cols(); ++t)
    {
      for (Index i = 0; i < 3; ++i)
      {
        ++uses[std::minmax(this->Result.Triangles(i, t), this->Result.Triangles((i + 1) % 3, t))];
      }
    }
    const ParameterBox& domain = this->At(0).Box;
    for (const auto& [edge, count] : uses)
    {
      bool isOnFace = false;
      for (std::size_t d = 0; d < 3; ++d)
      {
        const double a = this->PointParameters[static_cast<std::size_t>(edge.first)][Index(d)];
        const double b = this->PointParameters[static_cast<std::size_t>(edge.second)][Index(d)];
        isOnFace = isOnFace || (a == domain.Low[d] && b == domain.Low[d]) ||
          (a == domain.High[d] && b == domain.High[d]);
      }
      this->Result.OpenEdges += count == 1 && !isOnFace ? 1 : 0;
    }
  }

  const Spline& Geometry;
  const JacobianTree& Tree;
  CrackRepair Repair;
  std::map<int, std::vector<FacePart>> Faces;
  /// Conforming: coordinates of corners on the lines along each direction.
  std::array<std::map<std::array<double, 2>, std::set<double>>, 3> Lines;
  std::map<Parameter, Index> VertexAt;
  std::vector<Parameter> Parameters;
  std::vector<Hanging> Interpolated;
  std::vector<Tetrahedron> Tetrahedra;
  Eigen::Matrix3Xd Positions;
  std::vector<double> Values;
  std::map<std::pair<Index, Index>, Index> Cuts;
  std::vector<Eigen::Vector3d> Points;
  std::vector<Eigen::Vector3d> PointParameters;
  JacobianTetrahedra Result;
};

}

JacobianTetrahedra MarchTetrahedra(
  const Spline& geometry, const JacobianTree& tree, CrackRepair repair)
{
  return Complex(geometry, tree, repair).Make();
}

}
