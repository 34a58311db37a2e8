// SPDX-License-Identifier: BSD-3-Clause
#include "ZeroSetWorker.h"

#include <algorithm>
#include <utility>

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

ZeroSet::Worker::Index ZeroSet::Worker::VertexOn(const Edge& edge)
{
  // Only a positive end can be zero; then the vertex is that node.
  const double low = this->ValueAt(edge.Low);
  const double high = this->ValueAt(edge.High);
  if (low == 0.0 || high == 0.0)
  {
    return this->VertexAt(low == 0.0 ? edge.Low : edge.High);
  }
  return this->AddVertex(edge.Low, { edge.At, edge.Axis, edge.Size, low, high, 0.0, false });
}

ZeroSet::Worker::Index ZeroSet::Worker::VertexAt(int node)
{
  return this->AddVertex(
    node, { this->NodeAt[static_cast<std::size_t>(node)], 3, 0, 0.0, 0.0, 0.0, true });
}

ZeroSet::Worker::Index ZeroSet::Worker::AddVertex(int node, const Vertex& vertex)
{
  int& number =
    this->AtNode[static_cast<std::size_t>(node)].Vertices[static_cast<std::size_t>(vertex.Axis)];
  if (number < 0)
  {
    number = static_cast<int>(this->Vertices.size());
    this->Vertices.push_back(vertex);
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

ZeroSet::Worker::Index ZeroSet::Worker::TraceFace(const Face& face, unsigned divided)
{
  const auto& [low, size, normal, nodes] = face;
  int& number =
    this->AtNode[static_cast<std::size_t>(nodes[0])].Faces[static_cast<std::size_t>(normal)];
  if (number >= 0)
  {
    return number;
  }
  number = static_cast<int>(this->CurvesOfFace.size());
  const auto first = static_cast<Index>(this->Curves.size());
  this->CurvesOfFace.push_back({ first, 0 });
  // Once around, counter-clockwise seen from the end of the normal axis.
  std::vector<Crossing>& crossings = this->Crossings;
  std::vector<int>& corners = this->Around;
  crossings.clear();
  corners.clear();
  const std::array<Edge, 4> edges = EdgesOf(face);
  bool before = this->ValueAt(nodes[0]) >= 0.0;
  for (std::size_t e = 0; e < 4; ++e)
  {
    const bool forward = e < 2;
    const auto visit = [&](const Edge& edge)
    {
      corners.push_back(forward ? edge.Low : edge.High);
      const bool after = this->ValueAt(forward ? edge.High : edge.Low) >= 0.0;
      if (before != after)
      {
        crossings.push_back({ this->VertexOn(edge), before, corners.size() });
      }
      before = after;
    };
    if ((divided >> e & 1u) != 0)
    {
      this->ForMinimalEdges(edges[e], forward, visit);
    }
    else
    {
      visit(edges[e]);
    }
  }
  if (crossings.empty())
  {
    return number;
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
    this->Curves.push_back({ from, to, 0, 0, normal, onCrease, false, {}, line, -1 });
  };
  for (std::size_t i = 0; i < crossings.size(); ++i)
  {
    if (!crossings[i].ToNegative)
    {
      continue;
    }
    // From where the walk leaves the positive side: around what follows, or around what was.
    const std::size_t other = (cutNegative ? i + 1 : i + crossings.size() - 1) % crossings.size();
    Index from = crossings[i].Vertex;
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
      const Index next = this->VertexAt(corner(k - 2));
      add(from, next);
      from = next;
    }
    if (!isZero || from != crossings[other].Vertex)
    {
      add(from, crossings[other].Vertex);
    }
  }
  this->CurvesOfFace.back()[1] = static_cast<Index>(this->Curves.size()) - first;
  return number;
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
        this->Curves.push_back({ this->VertexAt(forward ? edge.Low : edge.High),
          this->VertexAt(forward ? edge.High : edge.Low), 0, 0, normal, true, false, {}, line,
          -1 });
      });
  }
  this->CurvesOfFace.push_back({ first, static_cast<Index>(this->Curves.size()) - first });
}

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

void ZeroSet::Worker::FindDivided()
{
  this->Divided.assign(this->Leaves.size(), this->Axes.size() < 3 ? AllSides : 0u);
  if (this->Axes.size() < 3)
  {
    return;
  }
  Numbering leaves;
  for (std::size_t l = 0; l < this->Leaves.size(); ++l)
  {
    const Box& box = this->Leaves[l].At;
    leaves.Number({ box.Low[0], box.Low[1], box.Low[2], box.Size });
    // Nodes on sides may be those of boxes beyond.
    for (int d = 0; d < 3; ++d)
    {
      for (const int step : { -1, 1 })
      {
        std::array<int, 3> offset{};
        offset[static_cast<std::size_t>(d)] = step;
        const int low = box.Low[static_cast<std::size_t>(d)];
        this->Divided[l] |=
          this->GoesOn(d, step < 0 ? low : low + box.Size) ? CommonSides(offset) : 0u;
      }
    }
  }
  // Others are those of boxes beside that were halved: nodes of smaller ones come with those.
  for (int i = 0; i < 27; ++i)
  {
    const std::array<int, 3> offset{ i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1 };
    const Sides common = CommonSides({ -offset[0], -offset[1], -offset[2] });
    if (common == 0 || i == 13)
    {
      continue;
    }
    for (const Box& box : this->Halved)
    {
      const Index leaf = leaves.Find({ box.Low[0] + offset[0] * box.Size,
        box.Low[1] + offset[1] * box.Size, box.Low[2] + offset[2] * box.Size, box.Size });
      if (leaf >= 0)
      {
        this->Divided[static_cast<std::size_t>(leaf)] |= common;
      }
    }
  }
}

void ZeroSet::Worker::TraceLeaf(std::size_t leaf)
{
  const Leaf& traced = this->Leaves[leaf];
  const auto& [low, size] = traced.At;
  const std::array<int, 8>& nodes = this->CornersOf[leaf];
  const auto face = [&](int normal, bool high)
  {
    const std::size_t b = 1u << (normal + 1) % 3;
    const std::size_t c = 1u << (normal + 2) % 3;
    const std::size_t lowest = high ? 1u << normal : 0u;
    Node at = low;
    at[static_cast<std::size_t>(normal)] += high ? size : 0;
    return Face{ at, size, normal,
      { nodes[lowest], nodes[lowest + b], nodes[lowest + b + c], nodes[lowest + c] } };
  };
  if (this->Axes.size() == 2)
  {
    this->TraceFace(face(3 - this->Axes[0] - this->Axes[1], false), AllSides);
    return;
  }
  if (this->Axes.size() == 1)
  {
    const int axis = this->Axes[0];
    this->ForMinimalEdges({ low, size, axis, nodes[0], nodes[std::size_t{ 1 } << axis] }, true,
      [&](const Edge& edge)
      {
        if ((this->ValueAt(edge.Low) >= 0.0) != (this->ValueAt(edge.High) >= 0.0))
        {
          this->VertexOn(edge);
        }
      });
    return;
  }
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
      const auto visit = [&](const Face& part)
      {
        const Index number = this->TraceFace(part, part.Size == size ? dividedEdges : AllSides);
        this->FacesOfLeaf.push_back(2 * number + (high ? 1 : 0));
        const auto [first, count] = this->CurvesOfFace[static_cast<std::size_t>(number)];
        for (Index i = first; i < first + count && traced.Height >= 0; ++i)
        {
          this->Curves[static_cast<std::size_t>(i)].Heights |= 1u << traced.Height;
        }
      };
      if ((divided & FaceBit(normal, high)) != 0)
      {
        this->ForMinimalFaces(face(normal, high), visit);
      }
      else if (dividedEdges != 0 || ((positive & corners) != 0 && (positive & corners) != corners))
      {
        visit(face(normal, high));
      }
      if (traced.Flat != 0 && this->IsDrawn(traced, normal, high))
      {
        this->TraceFlat(face(normal, high));
      }
    }
  }
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
  this->FacesOfLeaf.clear();
  this->FirstFace.clear();
  this->LargestValue = 0.0;
  for (const double value : this->NodeValues)
  {
    this->LargestValue = std::max(this->LargestValue, std::abs(value));
  }

  this->FindDivided();
  for (std::size_t leaf = 0; leaf < this->Leaves.size(); ++leaf)
  {
    this->FirstFace.push_back(static_cast<Index>(this->FacesOfLeaf.size()));
    this->TraceLeaf(leaf);
  }
  this->FirstFace.push_back(static_cast<Index>(this->FacesOfLeaf.size()));
  this->FindEdgeCurves();
  return this->FindVertices();
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
      const auto D = static_cast<std::size_t>(axis);
      const Vertex middle{ low, 4 + axis, high[D] - low[D], 0.0, 0.0, 0.5, false };
      this->Curves[c].EdgeAxis = axis;
      this->AddVertex(static_cast<int>(this->Find(low)), middle);
    }
  }
}

}
