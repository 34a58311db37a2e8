// SPDX-License-Identifier: BSD-3-Clause
#include "ZeroSetWorker.h"

#include <algorithm>
#include <cmath>

namespace hyperpatch
{

template <typename Visitor>
void ZeroSet::Worker::ForMinimalFaces(const Face& face, Visitor&& visit) const
{
  const auto b = static_cast<std::size_t>((face.Normal + 1) % 3);
  const auto c = static_cast<std::size_t>((face.Normal + 2) % 3);
  const int half = face.Size / 2;
  const auto find = [&](int i, int j)
  {
    Node node = face.At;
    node[b] += i * half;
    node[c] += j * half;
    return static_cast<int>(this->Find(node));
  };
  const int centre = half > 0 ? find(1, 1) : -1;
  if (centre < 0)
  {
    visit(face);
    return;
  }
  // A box on one of the two sides was halved.
  const std::array<int, 4> middles{ find(1, 0), find(2, 1), find(1, 2), find(0, 1) };
  Face part{ face.At, half, face.Normal, { face.Corners[0], middles[0], centre, middles[3] } };
  this->ForMinimalFaces(part, visit);
  part.At[b] += half;
  part.Corners = { middles[0], face.Corners[1], middles[1], centre };
  this->ForMinimalFaces(part, visit);
  part.At[b] -= half;
  part.At[c] += half;
  part.Corners = { middles[3], centre, middles[2], face.Corners[3] };
  this->ForMinimalFaces(part, visit);
  part.At[b] += half;
  part.Corners = { centre, middles[1], face.Corners[2], middles[2] };
  this->ForMinimalFaces(part, visit);
}

template <typename Visitor>
void ZeroSet::Worker::ForMinimalEdges(const Edge& edge, bool forward, Visitor&& visit) const
{
  Node node = edge.At;
  node[static_cast<std::size_t>(edge.Axis)] += edge.Size / 2;
  const auto middle = static_cast<int>(edge.Size > 1 ? this->Find(node) : -1);
  if (middle < 0)
  {
    visit(edge);
    return;
  }
  const std::array<Edge, 2> parts{ { { edge.At, edge.Size / 2, edge.Axis, edge.Low, middle },
    { node, edge.Size / 2, edge.Axis, middle, edge.High } } };
  this->ForMinimalEdges(parts[forward ? 0 : 1], forward, visit);
  this->ForMinimalEdges(parts[forward ? 1 : 0], forward, visit);
}

ZeroSet::Worker::VertexPlace ZeroSet::Worker::VertexOn(const Edge& edge) const
{
  // Only a positive end can be zero; then the vertex is that node.
  return this->ValueAt(edge.Low) == 0.0 ? VertexAt(edge.Low)
    : this->ValueAt(edge.High) == 0.0   ? VertexAt(edge.High)
                                        : VertexPlace{ edge.Low, edge.High, edge.Axis };
}

ZeroSet::Worker::Index ZeroSet::Worker::AddVertex(const VertexPlace& place)
{
  const auto low = static_cast<std::size_t>(place.Low);
  int& number = this->AtNode[low].Vertices[static_cast<std::size_t>(place.Axis)];
  if (number < 0)
  {
    number = static_cast<int>(this->Vertices.size());
    const auto d = static_cast<std::size_t>(place.Axis % 4);
    const Node& at = this->NodeAt[low];
    const bool isOnEdge = place.Axis < 3;
    this->Vertices.push_back({ at, place.Low, place.Axis,
      place.Axis == 3 ? 0 : this->NodeAt[static_cast<std::size_t>(place.High)][d] - at[d],
      isOnEdge ? this->ValueAt(place.Low) : 0.0, isOnEdge ? this->ValueAt(place.High) : 0.0,
      place.Axis > 3 ? 0.5 : 0.0, place.Axis == 3 });
  }
  return number;
}

bool ZeroSet::Worker::GoesOn(int direction, int line) const
{
  const auto d = static_cast<std::size_t>(direction);
  const CellLines& lines = this->Lines[d];
  const bool atEnd = line == lines.Length();
  return (line == 0 || atEnd) && this->GoesBeyond[2 * d + (atEnd != lines.IsMirrored() ? 1 : 0)];
}

std::array<ZeroSet::Worker::Edge, 4> ZeroSet::Worker::EdgesOf(const Face& face)
{
  const auto& [low, size, normal, nodes] = face;
  const int b = (normal + 1) % 3;
  const int c = (normal + 2) % 3;
  Node right = low;
  right[static_cast<std::size_t>(b)] += size;
  Node top = low;
  top[static_cast<std::size_t>(c)] += size;
  return { { { low, size, b, nodes[0], nodes[1] }, { right, size, c, nodes[1], nodes[2] },
    { top, size, b, nodes[3], nodes[2] }, { low, size, c, nodes[0], nodes[3] } } };
}

void ZeroSet::Worker::TraceFace(const LeafFace& leafFace, Traced& traced) const
{
  const auto& [low, size, normal, nodes] = leafFace.At;
  const std::size_t before = traced.Curves.size();
  // Once around, counter-clockwise seen from the end of the normal axis.
  std::vector<Traced::Crossing>& crossings = traced.Crossings;
  std::vector<int>& corners = traced.Around;
  crossings.clear();
  corners.clear();
  const auto keyOf = [&traced](const VertexPlace& vertex)
  {
    traced.Vertices.push_back(vertex);
    return vertex.Key();
  };
  const std::array<Edge, 4> edges = EdgesOf(leafFace.At);
  bool wasPositive = this->ValueAt(nodes[0]) >= 0.0;
  for (std::size_t e = 0; e < 4; ++e)
  {
    const bool forward = e < 2;
    const auto visit = [&](const Edge& edge)
    {
      corners.push_back(forward ? edge.Low : edge.High);
      const bool isPositive = this->ValueAt(forward ? edge.High : edge.Low) >= 0.0;
      if (wasPositive != isPositive)
      {
        crossings.push_back({ keyOf(this->VertexOn(edge)), wasPositive, corners.size() });
      }
      wasPositive = isPositive;
    };
    if ((leafFace.Divided >> e & 1u) != 0)
    {
      this->ForMinimalEdges(edges[e], forward, visit);
    }
    else
    {
      visit(edges[e]);
    }
  }
  traced.Counts.push_back(0);
  if (crossings.empty())
  {
    return;
  }
  const int line = low[static_cast<std::size_t>(normal)];
  const bool onCrease =
    this->Axes.size() == 3 && this->Lines[static_cast<std::size_t>(normal)].IsCrease(line);
  bool cutNegative = true;
  if (crossings.size() > 2)
  {
    double value = 0.0;
    if (this->GoesOn(normal, line))
    {
      // Of what both sides know, and in an order that both can find.
      std::array<double, 4> values{ this->ValueAt(nodes[0]), this->ValueAt(nodes[1]),
        this->ValueAt(nodes[2]), this->ValueAt(nodes[3]) };
      std::sort(values.begin(), values.end());
      value = values[0] + values[1] + values[2] + values[3];
    }
    else
    {
      const Node& opposite = this->NodeAt[static_cast<std::size_t>(nodes[2])];
      const Eigen::Vector3d middle = 0.5 * (this->ParameterOf(low) + this->ParameterOf(opposite));
      this->Field.Evaluate(1, middle.data(), &value);
    }
    cutNegative = value >= 0.0;
  }
  const auto add = [&](Index from, Index to) {
    traced.Curves.push_back({ from, to, 0, 0, normal, onCrease, false, {}, line, -1 });
  };
  for (std::size_t i = 0; i < crossings.size(); ++i)
  {
    if (!crossings[i].ToNegative)
    {
      continue;
    }
    // From where the walk leaves the positive side: around what follows, or around what was.
    const std::size_t other = (cutNegative ? i + 1 : i + crossings.size() - 1) % crossings.size();
    Index from = crossings[i].Key;
    // A positive side that is all zero is the curve.
    const std::size_t begin = crossings[other].Corner;
    std::size_t end = crossings[i].Corner;
    end += end < begin ? corners.size() : 0;
    const auto corner = [&](std::size_t k) { return corners[k % corners.size()]; };
    bool isZero = crossings.size() == 2;
    for (std::size_t k = begin; k < end && isZero; ++k)
    {
      isZero = this->ValueAt(corner(k)) == 0.0;
    }
    for (std::size_t k = end; k > begin + 1 && isZero; --k)
    {
      const Index next = keyOf(VertexAt(corner(k - 2)));
      add(from, next);
      from = next;
    }
    if (!isZero || from != crossings[other].Key)
    {
      add(from, crossings[other].Key);
    }
  }
  traced.Counts.back() = static_cast<Index>(traced.Curves.size() - before);
}

bool ZeroSet::Worker::IsFlat(const Leaf& leaf, int normal, bool high) const
{
  const auto& [low, size] = leaf.At;
  for (int c = 0; c < 8; ++c)
  {
    const Node node{ low[0] + (c & 1) * size, low[1] + (c >> 1 & 1) * size,
      low[2] + (c >> 2) * size };
    const double value = this->ValueAt(static_cast<int>(this->Find(node)));
    const bool onFace = ((c >> normal & 1) != 0) == high;
    if (onFace ? value != 0.0 : value < 0.0)
    {
      return false;
    }
  }
  return true;
}

bool ZeroSet::Worker::IsDrawn(const Leaf& leaf, int normal, bool high) const
{
  return (leaf.Flat >> (2 * normal + (high ? 1 : 0)) & 1u) != 0 && this->IsFlat(leaf, normal, high);
}

void ZeroSet::Worker::TraceFlat(const Face& face)
{
  // Its outline, counter-clockwise seen from the end of the normal axis.
  const auto& [low, size, normal, nodes] = face;
  this->AtNode[static_cast<std::size_t>(nodes[0])].Faces[static_cast<std::size_t>(3 + normal)] =
    static_cast<int>(this->CurvesOfFace.size());
  const auto first = static_cast<Index>(this->Curves.size());
  const int line = low[static_cast<std::size_t>(normal)];
  const std::array<Edge, 4> edges = EdgesOf(face);
  for (std::size_t e = 0; e < 4; ++e)
  {
    const bool forward = e < 2;
    this->ForMinimalEdges(edges[e], forward,
      [&](const Edge& edge)
      {
        const Index from = this->AddVertex(VertexAt(forward ? edge.Low : edge.High));
        const Index to = this->AddVertex(VertexAt(forward ? edge.High : edge.Low));
        this->Curves.push_back({ from, to, 0, 0, normal, true, false, {}, line, -1 });
      });
  }
  this->CurvesOfFace.push_back({ first, static_cast<Index>(this->Curves.size()) - first });
}

ZeroSet::Worker::Face ZeroSet::Worker::FaceOf(std::size_t leaf, int normal, bool isUpper) const
{
  const std::array<int, 8>& nodes = this->CornersOf[leaf];
  const auto& [low, size] = this->Leaves[leaf].At;
  const std::size_t b = 1u << (normal + 1) % 3;
  const std::size_t c = 1u << (normal + 2) % 3;
  const std::size_t lowest = isUpper ? 1u << normal : 0u;
  Node at = low;
  at[static_cast<std::size_t>(normal)] += isUpper ? size : 0;
  return { at, size, normal,
    { nodes[lowest], nodes[lowest + b], nodes[lowest + b + c], nodes[lowest + c] } };
}

void ZeroSet::Worker::FindFaces(std::size_t leaf, std::vector<LeafFace>& faces) const
{
  const auto number = static_cast<int>(leaf);
  if (this->Axes.size() == 2)
  {
    const int normal = 3 - this->Axes[0] - this->Axes[1];
    faces.push_back({ this->FaceOf(leaf, normal, false), AllSides, number, false });
    return;
  }
  const std::array<int, 8>& nodes = this->CornersOf[leaf];
  unsigned positive = 0; // bits of corners
  for (std::size_t c = 0; c < 8; ++c)
  {
    positive |= this->ValueAt(nodes[c]) >= 0.0 ? 1u << c : 0u;
  }
  const Sides divided = this->Divided[leaf];
  for (int normal = 0; normal < 3; ++normal)
  {
    for (const bool high : { false, true })
    {
      static constexpr std::array<unsigned, 3> Lower{ 0x55, 0x33, 0x0F };
      const unsigned corners = Lower[static_cast<std::size_t>(normal)] << (high ? 1 << normal : 0);
      const int b = (normal + 1) % 3;
      const int c = (normal + 2) % 3;
      const std::array<Sides, 4> edges{ EdgeBit(b, false, high), EdgeBit(c, high, true),
        EdgeBit(b, true, high), EdgeBit(c, high, false) };
      unsigned dividedEdges = 0;
      for (std::size_t e = 0; e < 4; ++e)
      {
        dividedEdges |= (divided & edges[e]) != 0 ? 1u << e : 0u;
      }
      const int size = this->Leaves[leaf].At.Size;
      if ((divided & FaceBit(normal, high)) != 0)
      {
        this->ForMinimalFaces(this->FaceOf(leaf, normal, high),
          [&](const Face& part) {
            faces.push_back({ part, part.Size == size ? dividedEdges : AllSides, number, high });
          });
      }
      else if (dividedEdges != 0 || ((positive & corners) != 0 && (positive & corners) != corners))
      {
        faces.push_back({ this->FaceOf(leaf, normal, high), dividedEdges, number, high });
      }
    }
  }
}

void ZeroSet::Worker::TraceEdge(std::size_t leaf)
{
  const auto& [low, size] = this->Leaves[leaf].At;
  const std::array<int, 8>& nodes = this->CornersOf[leaf];
  const int axis = this->Axes[0];
  this->ForMinimalEdges({ low, size, axis, nodes[0], nodes[std::size_t{ 1 } << axis] }, true,
    [&](const Edge& edge)
    {
      if ((this->ValueAt(edge.Low) >= 0.0) != (this->ValueAt(edge.High) >= 0.0))
      {
        this->AddVertex(this->VertexOn(edge));
      }
    });
}

bool ZeroSet::Worker::TraceFaces()
{
  Round round;
  round.Vertices.swap(this->Vertices);
  round.AtNode.swap(this->AtNode);
  round.Curves.swap(this->Curves);
  round.CurvesOfFace.swap(this->CurvesOfFace);
  round.CurveOf.swap(this->CurveOf);
  std::swap(round.Shared, this->Shared);
  this->Before = std::move(round);
  this->AtNode.assign(this->NodeAt.size(), {});
  this->LargestValue = 0.0;
  for (const double value : this->NodeValues)
  {
    this->LargestValue = std::max(this->LargestValue, std::abs(value));
  }
  if (!this->FindDivided())
  {
    return false;
  }
  if (this->Axes.size() > 1)
  {
    return this->TraceAll() && this->FindVertices();
  }
  for (std::size_t leaf = 0; leaf < this->Leaves.size(); ++leaf)
  {
    this->TraceEdge(leaf);
  }
  return this->FindVertices();
}

bool ZeroSet::Worker::TraceAll()
{
  // In parallel what costs most: looking nodes up, and walking around faces. Numbers are given in
  // between, in the order of the leaves.
  constexpr Index Grain = 256;
  const bool isSolid = this->Axes.size() == 3;
  const auto leaves = static_cast<Index>(this->Leaves.size());
  this->FirstFace.assign(this->Leaves.size() + 1, 0);
  std::vector<std::vector<LeafFace>> chunks(static_cast<std::size_t>((leaves + Grain - 1) / Grain));
  const bool found = this->Parallel(leaves, Grain,
    [&](Index begin, Index end)
    {
      std::vector<LeafFace>& own = chunks[static_cast<std::size_t>(begin / Grain)];
      for (auto leaf = static_cast<std::size_t>(begin); leaf < static_cast<std::size_t>(end);
           ++leaf)
      {
        const std::size_t before = own.size();
        this->FindFaces(leaf, own);
        this->FirstFace[leaf + 1] = isSolid ? static_cast<Index>(own.size() - before) : 0;
      }
    });
  if (!found)
  {
    return false;
  }
  for (std::size_t leaf = 1; leaf < this->FirstFace.size(); ++leaf)
  {
    this->FirstFace[leaf] += this->FirstFace[leaf - 1];
  }
  this->FacesOfLeaf.clear();
  std::vector<const LeafFace*> faces;
  std::vector<unsigned> heights; // Curve::Heights of those in each face
  for (const std::vector<LeafFace>& chunk : chunks)
  {
    for (const LeafFace& face : chunk)
    {
      int& number = this->AtNode[static_cast<std::size_t>(face.At.Corners[0])]
                      .Faces[static_cast<std::size_t>(face.At.Normal)];
      if (number < 0)
      {
        number = static_cast<int>(faces.size());
        faces.push_back(&face);
        heights.push_back(0);
      }
      if (isSolid)
      {
        const int height = this->Leaves[static_cast<std::size_t>(face.Leaf)].Height;
        heights[static_cast<std::size_t>(number)] |= height >= 0 ? 1u << height : 0u;
        this->FacesOfLeaf.push_back(2 * number + (face.IsUpper ? 1 : 0));
      }
    }
  }

  const auto count = static_cast<Index>(faces.size());
  std::vector<Traced> traced(static_cast<std::size_t>((count + Grain - 1) / Grain));
  const bool finished = this->Parallel(count, Grain,
    [&](Index begin, Index end)
    {
      for (Index i = begin; i < end; ++i)
      {
        this->TraceFace(
          *faces[static_cast<std::size_t>(i)], traced[static_cast<std::size_t>(begin / Grain)]);
      }
    });
  if (!finished)
  {
    return false;
  }
  chunks.clear();
  Index curves = 0;
  for (const Traced& some : traced)
  {
    for (const VertexPlace& vertex : some.Vertices)
    {
      this->AddVertex(vertex);
    }
    for (const Index own : some.Counts)
    {
      this->CurvesOfFace.push_back({ curves, own });
      curves += own;
    }
  }
  this->Curves.resize(static_cast<std::size_t>(curves));
  const auto numberOf = [this](Index key)
  {
    return this->AtNode[static_cast<std::size_t>(key / 8)]
      .Vertices[static_cast<std::size_t>(key % 8)];
  };
  const bool copied = this->Parallel(count, Grain,
    [&](Index begin, Index end)
    {
      auto curve = traced[static_cast<std::size_t>(begin / Grain)].Curves.begin();
      for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i)
      {
        const auto [first, own] = this->CurvesOfFace[i];
        for (Index c = first; c < first + own; ++c, ++curve)
        {
          curve->From = numberOf(curve->From);
          curve->To = numberOf(curve->To);
          curve->Heights = heights[i];
          this->Curves[static_cast<std::size_t>(c)] = *curve;
        }
      }
    });
  if (!copied)
  {
    return false;
  }
  for (std::size_t leaf = 0; leaf < this->Leaves.size(); ++leaf)
  {
    for (int side = 0; side < 6 && this->Leaves[leaf].Flat != 0; ++side)
    {
      if (this->IsDrawn(this->Leaves[leaf], side / 2, side % 2 != 0))
      {
        this->TraceFlat(this->FaceOf(leaf, side / 2, side % 2 != 0));
      }
    }
  }
  this->FindEdgeCurves();
  return true;
}

void ZeroSet::Worker::FindEdgeCurves()
{
  // Curves from node to node along the edge in which two creases meet: each of their faces has one
  // of its own. Where f is 0 in the middle too, they are that edge.
  for (std::size_t c = 0; c < this->Curves.size(); ++c)
  {
    const Vertex& from = this->Vertices[static_cast<std::size_t>(this->Curves[c].From)];
    const Vertex& to = this->Vertices[static_cast<std::size_t>(this->Curves[c].To)];
    if (!this->Curves[c].IsOnCrease || from.Axis != 3 || to.Axis != 3)
    {
      continue;
    }
    const auto& [low, high] = std::minmax(from.At, to.At);
    int axis = -1;
    int differing = 0;
    bool creases = true;
    for (const int d : this->Axes)
    {
      const auto D = static_cast<std::size_t>(d);
      const bool differs = low[D] != high[D];
      axis = differs ? d : axis;
      differing += differs ? 1 : 0;
      creases = creases && (differs || this->Lines[D].IsCrease(low[D]));
    }
    if (differing == 1 && creases)
    {
      this->Curves[c].EdgeAxis = axis;
      this->AddVertex(
        { static_cast<int>(this->Find(low)), static_cast<int>(this->Find(high)), 4 + axis });
    }
  }
}

}
