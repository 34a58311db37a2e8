// SPDX-License-Identifier: BSD-3-Clause
#include "ZeroSetWorker.h"

#include <algorithm>
#include <utility>

namespace hyperpatch
{

template <typename Visitor>
void ZeroSet::Worker::ForMinimalFaces(const Node& low, int size, int normal, Visitor&& visit) const
{
  const auto b = static_cast<std::size_t>((normal + 1) % 3);
  const auto c = static_cast<std::size_t>((normal + 2) % 3);
  Node centre = low;
  centre[b] += size / 2;
  centre[c] += size / 2;
  if (this->Axes.size() == 3 && this->IsNode(centre))
  {
    // A box on one of the two sides was halved.
    for (int i = 0; i < 4; ++i)
    {
      Node at = low;
      at[b] += (i & 1) * (size / 2);
      at[c] += (i >> 1) * (size / 2);
      this->ForMinimalFaces(at, size / 2, normal, visit);
    }
    return;
  }
  visit(low, size);
}

template <typename Visitor>
void ZeroSet::Worker::ForMinimalEdges(
  const Node& low, int size, int axis, bool forward, Visitor&& visit) const
{
  Node middle = low;
  middle[static_cast<std::size_t>(axis)] += size / 2;
  if (this->IsNode(middle))
  {
    this->ForMinimalEdges(forward ? low : middle, size / 2, axis, forward, visit);
    this->ForMinimalEdges(forward ? middle : low, size / 2, axis, forward, visit);
    return;
  }
  visit(low, size);
}

ZeroSet::Worker::Index ZeroSet::Worker::VertexOn(
  const Node& low, int size, int axis, double fLow, double fHigh)
{
  // Only a positive end can be zero; then the vertex is that node.
  Vertex vertex{ low, axis, size, fLow, fHigh, 0.0, false };
  if (fLow == 0.0 || fHigh == 0.0)
  {
    vertex = { low, 3, 0, 0.0, 0.0, 0.0, true };
    vertex.At[static_cast<std::size_t>(axis)] += fLow == 0.0 ? 0 : size;
  }
  return this->AddVertex(vertex);
}

ZeroSet::Worker::Index ZeroSet::Worker::AddVertex(const Vertex& vertex)
{
  const auto [number, isNew] =
    this->VertexKeys.Number({ vertex.At[0], vertex.At[1], vertex.At[2], vertex.Axis });
  if (isNew)
  {
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

std::array<double, 4> ZeroSet::Worker::ValuesAround(const Node& low, int size, int normal) const
{
  const auto b = static_cast<std::size_t>((normal + 1) % 3);
  const auto c = static_cast<std::size_t>((normal + 2) % 3);
  Node right = low;
  right[b] += size;
  Node top = low;
  top[c] += size;
  Node opposite = right;
  opposite[c] += size;
  return { this->ValueAt(low), this->ValueAt(right), this->ValueAt(opposite), this->ValueAt(top) };
}

ZeroSet::Worker::Index ZeroSet::Worker::TraceFace(const Node& low, int size, int normal,
  const std::array<double, 4>& cornerValues, unsigned divided)
{
  const auto first = static_cast<Index>(this->Curves.size());
  const auto [face, isNew] = this->FaceKeys.Number({ low[0], low[1], low[2], normal });
  if (!isNew)
  {
    return face;
  }
  this->CurvesOfFace.push_back({ first, 0 });
  // Once around, counter-clockwise seen from the end of the normal axis.
  const int b = (normal + 1) % 3;
  const int c = (normal + 2) % 3;
  std::vector<Crossing>& crossings = this->Crossings;
  std::vector<Node>& corners = this->Around;
  crossings.clear();
  corners.clear();
  double before = cornerValues[0];
  const auto side = [&](const Node& from, int axis, bool forward, double last)
  {
    int left = size;
    const auto visit = [&](const Node& at, int length)
    {
      Node begin = at;
      Node end = at;
      (forward ? end : begin)[static_cast<std::size_t>(axis)] += length;
      left -= length;
      const double after = left == 0 ? last : this->ValueAt(end);
      corners.push_back(begin);
      if ((before >= 0.0) != (after >= 0.0))
      {
        crossings.push_back(
          { this->VertexOn(at, length, axis, forward ? before : after, forward ? after : before),
            before >= 0.0, corners.size() });
      }
      before = after;
    };
    if ((divided & 1u) != 0)
    {
      this->ForMinimalEdges(from, size, axis, forward, visit);
    }
    else
    {
      visit(from, size);
    }
    divided >>= 1;
  };
  Node right = low;
  right[static_cast<std::size_t>(b)] += size;
  Node top = low;
  top[static_cast<std::size_t>(c)] += size;
  side(low, b, true, cornerValues[1]);
  side(right, c, true, cornerValues[2]);
  side(top, b, false, cornerValues[3]);
  side(low, c, false, cornerValues[0]);
  if (crossings.empty())
  {
    return face;
  }
  const int line = low[static_cast<std::size_t>(normal)];
  const bool onCrease =
    this->Axes.size() == 3 && this->Lines[static_cast<std::size_t>(normal)].IsCrease(line);
  bool cutNegative = true;
  if (crossings.size() > 2)
  {
    Node opposite = right;
    opposite[static_cast<std::size_t>(c)] += size;
    double value = 0.0;
    if (this->GoesOn(normal, line))
    {
      // Of what both sides know, and in an order that both can find.
      std::array<double, 4> values{ this->ValueAt(low), this->ValueAt(right), this->ValueAt(top),
        this->ValueAt(opposite) };
      std::sort(values.begin(), values.end());
      value = values[0] + values[1] + values[2] + values[3];
    }
    else
    {
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
    const auto corner = [&](std::size_t k) -> const Node& { return corners[k % corners.size()]; };
    bool isZero = crossings.size() == 2;
    for (std::size_t k = begin; k < end && isZero; ++k)
    {
      isZero = this->ValueAt(corner(k)) == 0.0;
    }
    for (std::size_t k = end; k > begin + 1 && isZero; --k)
    {
      const Index next = this->AddVertex({ corner(k - 2), 3, 0, 0.0, 0.0, 0.0, true });
      add(from, next);
      from = next;
    }
    if (!isZero || from != crossings[other].Vertex)
    {
      add(from, crossings[other].Vertex);
    }
  }
  this->CurvesOfFace.back()[1] = static_cast<Index>(this->Curves.size()) - first;
  return face;
}

bool ZeroSet::Worker::IsFlat(const Leaf& leaf, int normal, bool high) const
{
  const auto& [low, size] = leaf.At;
  for (int c = 0; c < 8; ++c)
  {
    const Node node{ low[0] + (c & 1) * size, low[1] + (c >> 1 & 1) * size,
      low[2] + (c >> 2) * size };
    const double value = this->ValueAt(node);
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

void ZeroSet::Worker::TraceFlat(const Node& low, int size, int normal)
{
  // Its outline, counter-clockwise seen from the end of the normal axis.
  const auto first = static_cast<Index>(this->Curves.size());
  const auto b = static_cast<std::size_t>((normal + 1) % 3);
  const auto c = static_cast<std::size_t>((normal + 2) % 3);
  this->FaceKeys.Number({ low[0], low[1], low[2], 3 + normal });
  const auto vertexAt = [this](const Node& node) {
    return this->AddVertex({ node, 3, 0, 0.0, 0.0, 0.0, true });
  };
  const auto side = [&](const Node& from, std::size_t axis, bool forward)
  {
    this->ForMinimalEdges(from, size, static_cast<int>(axis), forward,
      [&](const Node& at, int length)
      {
        Node end = at;
        end[axis] += length;
        this->Curves.push_back({ vertexAt(forward ? at : end), vertexAt(forward ? end : at), 0, 0,
          normal, true, false, {}, low[static_cast<std::size_t>(normal)], -1 });
      });
  };
  Node right = low;
  right[b] += size;
  Node top = low;
  top[c] += size;
  side(low, b, true);
  side(right, c, true);
  side(top, b, false);
  side(low, c, false);
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
  const auto& [low, size] = this->Leaves[leaf].At;
  if (this->Axes.size() == 2)
  {
    const int normal = 3 - this->Axes[0] - this->Axes[1];
    this->TraceFace(low, size, normal, this->ValuesAround(low, size, normal), AllSides);
    return;
  }
  if (this->Axes.size() == 1)
  {
    double before = this->ValueAt(low);
    this->ForMinimalEdges(low, size, this->Axes[0], true,
      [&](const Node& at, int length)
      {
        Node end = at;
        end[static_cast<std::size_t>(this->Axes[0])] += length;
        const double after = this->ValueAt(end);
        if ((before >= 0.0) != (after >= 0.0))
        {
          this->VertexOn(at, length, this->Axes[0], before, after);
        }
        before = after;
      });
    return;
  }
  const auto valueAt = [this, leaf](int corner)
  {
    const int node = this->CornersOf[leaf][static_cast<std::size_t>(corner)];
    return this->NodeValues[static_cast<std::size_t>(node)];
  };
  unsigned positive = 0; // bits of corners
  for (int c = 0; c < 8; ++c)
  {
    positive |= valueAt(c) >= 0.0 ? 1u << c : 0u;
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
      const bool isDivided = (divided & FaceBit(normal, high)) != 0;
      const std::array<Sides, 4> edges{ EdgeBit(b, false, high), EdgeBit(c, high, true),
        EdgeBit(b, true, high), EdgeBit(c, high, false) };
      unsigned dividedEdges = 0;
      for (std::size_t e = 0; e < 4; ++e)
      {
        dividedEdges |= (divided & edges[e]) != 0 ? 1u << e : 0u;
      }
      if (isDivided || dividedEdges != 0 ||
        ((positive & corners) != 0 && (positive & corners) != corners))
      {
        const int lowest = high ? 1 << normal : 0;
        const std::array<double, 4> values{ valueAt(lowest), valueAt(lowest + (1 << b)),
          valueAt(lowest + (1 << b) + (1 << c)), valueAt(lowest + (1 << c)) };
        Node at = low;
        at[static_cast<std::size_t>(normal)] += high ? size : 0;
        const auto visit = [&](const Node& part, int partSize)
        {
          const Index face = partSize == size
            ? this->TraceFace(part, size, normal, values, dividedEdges)
            : this->TraceFace(
                part, partSize, normal, this->ValuesAround(part, partSize, normal), AllSides);
          this->FacesOfLeaf.push_back(2 * face + (high ? 1 : 0));
          const auto [first, count] = this->CurvesOfFace[static_cast<std::size_t>(face)];
          for (Index i = first; i < first + count && this->Leaves[leaf].Height >= 0; ++i)
          {
            this->Curves[static_cast<std::size_t>(i)].Heights |= 1u << this->Leaves[leaf].Height;
          }
        };
        if (isDivided)
        {
          this->ForMinimalFaces(at, size, normal, visit);
        }
        else
        {
          visit(at, size);
        }
      }
      if (this->Leaves[leaf].Flat != 0 && this->IsDrawn(this->Leaves[leaf], normal, high))
      {
        Node at = low;
        at[static_cast<std::size_t>(normal)] += high ? size : 0;
        this->TraceFlat(at, size, normal);
      }
    }
  }
}

bool ZeroSet::Worker::TraceFaces()
{
  Round round;
  round.Vertices.swap(this->Vertices);
  std::swap(round.VertexKeys, this->VertexKeys);
  std::swap(round.FaceKeys, this->FaceKeys);
  round.Curves.swap(this->Curves);
  round.CurvesOfFace.swap(this->CurvesOfFace);
  round.CurveOf.swap(this->CurveOf);
  std::swap(round.Shared, this->Shared);
  this->Before = std::move(round);
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
      this->AddVertex(middle);
    }
  }
}

}
