// SPDX-License-Identifier: BSD-3-Clause
#include "ZeroSetWorker.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace hyperpatch
{

namespace
{

/// What two parameters must differ by to be told apart after a sum or product.
double Resolution(double a, double b)
{
  return std::numeric_limits<double>::epsilon() * std::max(std::abs(a), std::abs(b));
}

constexpr std::int64_t MostCurvePoints = 4096;

}

void ZeroSet::Worker::Samples::Resize(const Worker& worker, Index count)
{
  this->Parameters.conservativeResize(3, count);
  this->Points.conservativeResize(3, count);
  this->Normals.conservativeResize(3, count);
  this->Residuals.conservativeResize(count);
  this->Attributes.resize(worker.Attributes.size());
  for (std::size_t a = 0; a < this->Attributes.size(); ++a)
  {
    this->Attributes[a].conservativeResize(worker.Attributes[a]->Components(), count);
  }
}

void ZeroSet::Worker::Evaluate(Samples& samples, Index begin, Index end) const
{
  const int m = this->Geometry.Components();
  Eigen::MatrixXd points(m, std::min(end - begin, Batch));
  Eigen::MatrixXd derivatives(3 * m, points.cols());
  std::vector<double> values(static_cast<std::size_t>(points.cols()));
  Eigen::Matrix3Xd gradients(3, points.cols());
  for (Index first = begin; first < end; first += Batch)
  {
    const Index count = std::min(Batch, end - first);
    const auto n = static_cast<std::size_t>(count);
    const double* parameters = samples.Parameters.col(first).data();
    this->Geometry.EvaluateWithDerivatives(n, parameters, points.data(), derivatives.data());
    samples.Points.middleCols(first, count).setZero();
    samples.Points.block(0, first, m, count) = points.leftCols(count);
    this->Field.EvaluateWithGradient(n, parameters, values.data(), gradients.data());
    this->Field.Snap(n, samples.Points.col(first).data());
    for (std::size_t a = 0; a < this->Attributes.size(); ++a)
    {
      this->Attributes[a]->Evaluate(n, parameters, samples.Attributes[a].col(first).data());
    }
    for (Index i = 0; i < count; ++i)
    {
      samples.Normals.col(first + i) = this->Normal(derivatives.col(i).data(), gradients.col(i));
      samples.Residuals[first + i] = std::abs(values[static_cast<std::size_t>(i)]);
    }
  }
}

Eigen::Vector3d ZeroSet::Worker::Normal(
  const double* derivatives, const Eigen::Vector3d& gradient) const
{
  const int m = this->Geometry.Components();
  Eigen::Matrix3d J = Eigen::Matrix3d::Zero();
  for (int d = 0; d < 3; ++d)
  {
    J.col(d).head(m) = Eigen::Map<const Eigen::VectorXd>(derivatives + m * d, m);
  }
  // cof(J) grad f: the physical gradient times det J, so it does not flip across folds.
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  if (this->Axes.size() == 3)
  {
    normal = this->Options.Handedness *
      (gradient[0] * J.col(1).cross(J.col(2)) + gradient[1] * J.col(2).cross(J.col(0)) +
        gradient[2] * J.col(0).cross(J.col(1)));
  }
  else if (this->Axes.size() == 2)
  {
    normal = J.col(this->Axes[0]).cross(J.col(this->Axes[1]));
  }
  const double norm = normal.norm();
  return norm > 0.0 ? Eigen::Vector3d(normal / norm) : normal;
}

template <typename Visitor>
void ZeroSet::Worker::ForMinimalFaces(const Node& low, int size, int normal, Visitor&& visit) const
{
  const auto b = static_cast<std::size_t>((normal + 1) % 3);
  const auto c = static_cast<std::size_t>((normal + 2) % 3);
  Node centre = low;
  centre[b] += size / 2;
  centre[c] += size / 2;
  if (this->MayBeDivided(size) && this->Axes.size() == 3 && this->IsNode(centre))
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
  if (this->MayBeDivided(size) && this->IsNode(middle))
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

ZeroSet::Worker::Index ZeroSet::Worker::TraceFace(
  const Node& low, int size, int normal, const std::array<double, 4>& cornerValues)
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
    this->ForMinimalEdges(from, size, axis, forward,
      [&](const Node& at, int length)
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
      });
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
    this->NodeBits |= node[0] | node[1] | node[2];
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
  Numbering halved;
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
      if (!halved.Number({ box.Low[0], box.Low[1], box.Low[2], box.Size }).second)
      {
        break;
      }
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

void ZeroSet::Worker::TraceLeaf(std::size_t leaf)
{
  const auto& [low, size] = this->Leaves[leaf].At;
  if (this->Axes.size() == 2)
  {
    const int normal = 3 - this->Axes[0] - this->Axes[1];
    this->TraceFace(low, size, normal, this->ValuesAround(low, size, normal));
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
  const bool mayBeDivided = this->MayBeDivided(size);
  for (int normal = 0; normal < 3; ++normal)
  {
    for (const bool high : { false, true })
    {
      static constexpr std::array<unsigned, 3> Lower{ 0x55, 0x33, 0x0F };
      const unsigned corners = Lower[static_cast<std::size_t>(normal)] << (high ? 1 << normal : 0);
      if (mayBeDivided || ((positive & corners) != 0 && (positive & corners) != corners))
      {
        const int b = (normal + 1) % 3;
        const int c = (normal + 2) % 3;
        const int lowest = high ? 1 << normal : 0;
        const std::array<double, 4> values{ valueAt(lowest), valueAt(lowest + (1 << b)),
          valueAt(lowest + (1 << b) + (1 << c)), valueAt(lowest + (1 << c)) };
        Node at = low;
        at[static_cast<std::size_t>(normal)] += high ? size : 0;
        this->ForMinimalFaces(at, size, normal,
          [&](const Node& part, int partSize)
          {
            const Index face = this->TraceFace(part, partSize, normal,
              partSize == size ? values : this->ValuesAround(part, partSize, normal));
            this->FacesOfLeaf.push_back(2 * face + (high ? 1 : 0));
            const auto [first, count] = this->CurvesOfFace[static_cast<std::size_t>(face)];
            for (Index i = first; i < first + count && this->Leaves[leaf].Height >= 0; ++i)
            {
              this->Curves[static_cast<std::size_t>(i)].Heights |= 1u << this->Leaves[leaf].Height;
            }
          });
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
  this->VertexKeys.Clear();
  this->FaceKeys.Clear();
  this->CurvesOfFace.clear();
  this->FacesOfLeaf.clear();
  this->FirstFace.clear();
  this->Vertices.clear();
  this->Curves.clear();
  this->LargestValue = 0.0;
  for (const double value : this->NodeValues)
  {
    this->LargestValue = std::max(this->LargestValue, std::abs(value));
  }

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

bool ZeroSet::Worker::FollowCurves()
{
  this->Snap();
  return this->FindCurves();
}

bool ZeroSet::Worker::FindVertices()
{
  const auto count = static_cast<Index>(this->Vertices.size());
  this->Shared.Resize(*this, count);
  return this->Parallel(count, Batch,
    [&](Index begin, Index end)
    {
      // Bracketed roots along edges, all of a batch in step: false position with Illinois' halved
      // weights, and a bisection wherever it does not halve the bracket in three steps.
      struct Bracket
      {
        Index Vertex;
        int Axis;
        double Low, High, FLow, FHigh;
        double WeightLow, WeightHigh; ///< Illinois: of an end that stays
        double Width;
        int Side, Steps;
      };
      constexpr int Most = 4 * 64; // steps, should every bracket have to be bisected
      std::vector<Bracket> open;
      std::vector<double> parameters;
      std::vector<double> values;
      for (Index v = begin; v < end; ++v)
      {
        const Vertex& vertex = this->Vertices[static_cast<std::size_t>(v)];
        this->Shared.Parameters.col(v) = this->ParameterOf(vertex.At);
        if (vertex.Axis > 3)
        {
          const int axis = vertex.Axis - 4;
          const int line = vertex.At[static_cast<std::size_t>(axis)];
          double& middle = this->Shared.Parameters(axis, v);
          middle = 0.5 * (middle + this->Line(axis, line + vertex.Size));
        }
        if (vertex.Axis < 3)
        {
          const auto axis = static_cast<std::size_t>(vertex.Axis);
          double low = this->Line(vertex.Axis, vertex.At[axis]);
          double high = this->Line(vertex.Axis, vertex.At[axis] + vertex.Size);
          double fLow = vertex.FLow;
          double fHigh = vertex.FHigh;
          if (high < low)
          {
            std::swap(low, high);
            std::swap(fLow, fHigh);
          }
          open.push_back({ v, vertex.Axis, low, high, fLow, fHigh, 1.0, 1.0, high - low, 0, 0 });
        }
      }
      for (int iteration = 0; !open.empty(); ++iteration)
      {
        parameters.resize(3 * open.size());
        values.resize(open.size());
        for (std::size_t b = 0; b < open.size(); ++b)
        {
          Bracket& o = open[b];
          const double low = o.WeightLow * o.FLow;
          const double high = o.WeightHigh * o.FHigh;
          double t = o.Low - low * (o.High - o.Low) / (high - low);
          if (o.Steps == 3)
          {
            o.Steps = 0;
            if (o.High - o.Low > 0.5 * o.Width)
            {
              t = 0.5 * (o.Low + o.High);
              o.WeightLow = o.WeightHigh = 1.0;
              o.Side = 0;
            }
            o.Width = o.High - o.Low;
          }
          ++o.Steps;
          // Never closer to an end than it matters: so a root beside an end closes the bracket.
          const double step = std::min(Resolution(o.Low, o.High), 0.5 * (o.High - o.Low));
          t = t > o.Low + step ? t : o.Low + step;
          t = t < o.High - step ? t : o.High - step;
          for (int d = 0; d < 3; ++d)
          {
            parameters[3 * b + static_cast<std::size_t>(d)] = this->Shared.Parameters(d, o.Vertex);
          }
          parameters[3 * b + static_cast<std::size_t>(o.Axis)] = t;
        }
        this->Field.Evaluate(open.size(), parameters.data(), values.data());
        std::size_t kept = 0;
        for (std::size_t b = 0; b < open.size(); ++b)
        {
          Bracket o = open[b];
          const double t = parameters[3 * b + static_cast<std::size_t>(o.Axis)];
          const double f = values[b];
          if ((f >= 0.0) == (o.FHigh >= 0.0))
          {
            o.High = t;
            o.FHigh = f;
            o.WeightHigh = 1.0;
            o.WeightLow *= o.Side == 1 ? 0.5 : 1.0;
            o.Side = 1;
          }
          else
          {
            o.Low = t;
            o.FLow = f;
            o.WeightLow = 1.0;
            o.WeightHigh *= o.Side == -1 ? 0.5 : 1.0;
            o.Side = -1;
          }
          if (f == 0.0 || o.High - o.Low <= 2.0 * Resolution(o.Low, o.High) || iteration == Most ||
            !std::isfinite(f))
          {
            const bool low = std::abs(o.FLow) < std::abs(o.FHigh);
            this->Shared.Parameters(o.Axis, o.Vertex) = low ? o.Low : o.High;
          }
          else
          {
            open[kept++] = o;
          }
        }
        open.resize(kept);
      }
      this->Evaluate(this->Shared, begin, end);
      for (Index v = begin; v < end; ++v)
      {
        Vertex& vertex = this->Vertices[static_cast<std::size_t>(v)];
        if (vertex.Axis < 3)
        {
          const int line = vertex.At[static_cast<std::size_t>(vertex.Axis)];
          const double low = this->Line(vertex.Axis, line);
          const double high = this->Line(vertex.Axis, line + vertex.Size);
          vertex.Fraction = (this->Shared.Parameters(vertex.Axis, v) - low) / (high - low);
        }
        vertex.IsZero = this->Shared.Residuals[v] == 0.0;
      }
    });
}

void ZeroSet::Worker::Snap()
{
  // Vertices of the edges around a node, if they are near to it: (node, vertex).
  constexpr double Near = 0.1;
  std::vector<std::pair<Node, Index>> around;
  for (std::size_t v = 0; v < this->Vertices.size(); ++v)
  {
    const Vertex& vertex = this->Vertices[v];
    if (vertex.Axis > 3)
    {
      continue;
    }
    Node node = vertex.At;
    if (vertex.Axis < 3)
    {
      if (vertex.Fraction > Near && vertex.Fraction < 1.0 - Near)
      {
        continue;
      }
      node[static_cast<std::size_t>(vertex.Axis)] += vertex.Fraction > 0.5 ? vertex.Size : 0;
    }
    around.emplace_back(node, static_cast<Index>(v));
  }
  std::sort(around.begin(), around.end());
  std::vector<Index> vertexOf(this->Vertices.size());
  for (std::size_t v = 0; v < vertexOf.size(); ++v)
  {
    vertexOf[v] = static_cast<Index>(v);
  }
  for (std::size_t first = 0, end = 0; first < around.size(); first = end)
  {
    const Node& node = around[first].first;
    while (end < around.size() && around[end].first == node)
    {
      ++end;
    }
    // The creases through the node in which the edge of a vertex does not lie. One that stays in
    // all of them can stand for the others.
    const auto leaves = [&](Index v)
    {
      const int axis = this->Vertices[static_cast<std::size_t>(v)].Axis;
      return axis < 3 &&
          this->Lines[static_cast<std::size_t>(axis)].IsCrease(node[static_cast<std::size_t>(axis)])
        ? 1
        : 0;
    };
    const auto best = std::min_element(around.begin() + static_cast<std::ptrdiff_t>(first),
      around.begin() + static_cast<std::ptrdiff_t>(end),
      [&](const auto& a, const auto& b)
      {
        // By place in space, which all patches around have the same bits of.
        const auto place = [this](Index v) -> std::array<double, 3>
        {
          const auto x = this->Shared.Points.col(v);
          return { x[0], x[1], x[2] };
        };
        return std::make_tuple(leaves(a.second), place(a.second)) <
          std::make_tuple(leaves(b.second), place(b.second));
      });
    for (std::size_t i = first; i < end; ++i)
    {
      const Index v = around[i].second;
      if (leaves(best->second) == 0 || v == best->second)
      {
        vertexOf[static_cast<std::size_t>(v)] = best->second;
      }
    }
  }
  // Curves with the same ends become one, except that of creases those in one plane only (which is
  // all that the patch on the other side of it sees), and of edges those that are that edge.
  constexpr int Anywhere = 0;
  constexpr int OnEdge = -1;
  this->CurveOf.assign(this->Curves.size(), -1);
  Numbering ends;
  std::vector<Index> firstOf;
  const auto join = [&](std::size_t c, int where, bool isNewAnywhere)
  {
    const auto [low, high] = std::minmax(this->Curves[c].From, this->Curves[c].To);
    const auto [number, isNew] =
      ends.Number({ static_cast<int>(low), static_cast<int>(high), where, 0 });
    if (isNew)
    {
      firstOf.push_back(static_cast<Index>(c));
    }
    if (isNewAnywhere)
    {
      this->CurveOf[c] = firstOf[static_cast<std::size_t>(number)];
    }
  };
  for (const bool onCrease : { true, false })
  {
    for (std::size_t c = 0; c < this->Curves.size(); ++c)
    {
      Curve& curve = this->Curves[c];
      if (curve.IsOnCrease != onCrease)
      {
        continue;
      }
      if (curve.EdgeAxis >= 0)
      {
        const Node& at = std::min(this->Vertices[static_cast<std::size_t>(curve.From)].At,
          this->Vertices[static_cast<std::size_t>(curve.To)].At);
        const Index middle = this->VertexKeys.Find({ at[0], at[1], at[2], 4 + curve.EdgeAxis });
        curve.EdgeAxis =
          this->Vertices[static_cast<std::size_t>(middle)].IsZero ? curve.EdgeAxis : -1;
      }
      curve.From = vertexOf[static_cast<std::size_t>(curve.From)];
      curve.To = vertexOf[static_cast<std::size_t>(curve.To)];
      if (curve.From == curve.To)
      {
        continue;
      }
      const int plane = 1 + curve.Normal + 3 * (curve.Line / CellLines::RootSize);
      join(c, !onCrease ? Anywhere : curve.EdgeAxis >= 0 ? OnEdge : plane, true);
      if (onCrease)
      {
        join(c, Anywhere, false); // for those that are not on a crease
      }
    }
  }
}

void ZeroSet::Worker::Project(
  Eigen::Matrix3Xd& parameters, const std::vector<int>& axes, std::vector<char>& projected) const
{
  const Index count = parameters.cols();
  projected.assign(static_cast<std::size_t>(count), 0);
  std::vector<Index> open(static_cast<std::size_t>(count));
  for (Index i = 0; i < count; ++i)
  {
    open[static_cast<std::size_t>(i)] = i;
  }
  Eigen::Matrix3Xd at(3, count);
  Eigen::Matrix3Xd gradients(3, count);
  std::vector<double> values(static_cast<std::size_t>(count));
  constexpr int Most = 12;
  for (int iteration = 0; iteration < Most && !open.empty(); ++iteration)
  {
    for (std::size_t k = 0; k < open.size(); ++k)
    {
      at.col(static_cast<Index>(k)) = parameters.col(open[k]);
    }
    this->Field.EvaluateWithGradient(open.size(), at.data(), values.data(), gradients.data());
    std::size_t kept = 0;
    for (std::size_t k = 0; k < open.size(); ++k)
    {
      const Index i = open[k];
      const int axis = axes[static_cast<std::size_t>(i)];
      const double slope = gradients(axis, static_cast<Index>(k));
      double& x = parameters(axis, i);
      const double before = x;
      const double step = values[k] != 0.0 ? values[k] / slope : 0.0;
      x = std::min(std::max(before - step, this->Low[axis]), this->High[axis]);
      // The next step would be smaller than round-off: quadratic convergence.
      if (std::abs(step) <= 1e-9 * (this->High[axis] - this->Low[axis]))
      {
        projected[static_cast<std::size_t>(i)] = 1;
      }
      else if (std::isfinite(x))
      {
        open[kept++] = i;
      }
      else
      {
        x = before;
      }
    }
    open.resize(kept);
  }
}

bool ZeroSet::Worker::FindCurves()
{
  const auto count = static_cast<Index>(this->Curves.size());
  constexpr Index Grain = 64;
  std::vector<Samples> found(static_cast<std::size_t>((count + Grain - 1) / Grain));
  const bool finished = this->Parallel(count, Grain,
    [&](Index begin, Index end)
    { this->Bend(begin, end, found[static_cast<std::size_t>(begin / Grain)]); });
  if (!finished)
  {
    return false;
  }
  Index total = this->Shared.Count();
  std::vector<Index> start;
  for (const Samples& samples : found)
  {
    start.push_back(total);
    total += samples.Count();
  }
  this->Shared.Resize(*this, total);
  for (std::size_t chunk = 0; chunk < found.size(); ++chunk)
  {
    this->Copy(found[chunk], 0, this->Shared, start[chunk], found[chunk].Count());
    const Index first = static_cast<Index>(chunk) * Grain;
    for (Index c = first; c < std::min(count, first + Grain); ++c)
    {
      this->Curves[static_cast<std::size_t>(c)].First += start[chunk];
    }
  }
  return true;
}

void ZeroSet::Worker::Bend(Index begin, Index end, Samples& found)
{
  const auto n = static_cast<std::size_t>(end - begin);
  const auto curve = [this, begin](std::size_t k) -> Curve&
  { return this->Curves[static_cast<std::size_t>(begin) + k]; };
  std::vector<std::size_t> open;
  for (std::size_t k = 0; k < n; ++k)
  {
    if (this->CurveOf[static_cast<std::size_t>(begin) + k] == begin + static_cast<Index>(k))
    {
      open.push_back(k);
    }
  }
  // The axis along which points of the chord are moved onto the surface: in the face itself where
  // that is one of the domain or a crease; one in which the surface is a graph, if there is one,
  // best in the face; of those the steepest at the ends.
  std::vector<int> axisOf(n);
  {
    Eigen::Matrix3Xd ends(3, 2 * static_cast<Index>(open.size()));
    for (std::size_t o = 0; o < open.size(); ++o)
    {
      ends.col(static_cast<Index>(2 * o)) = this->Shared.Parameters.col(curve(open[o]).From);
      ends.col(static_cast<Index>(2 * o + 1)) = this->Shared.Parameters.col(curve(open[o]).To);
    }
    std::vector<double> values(2 * open.size());
    Eigen::Matrix3Xd g(3, ends.cols());
    this->Field.EvaluateWithGradient(2 * open.size(), ends.data(), values.data(), g.data());
    for (std::size_t o = 0; o < open.size(); ++o)
    {
      const std::size_t k = open[o];
      const auto i = static_cast<Index>(2 * o);
      double best = -1.0;
      const unsigned normal = 1u << curve(k).Normal;
      const unsigned possible = ~((curve(k).IsOnCrease ? normal : 0u) |
        (curve(k).EdgeAxis >= 0 ? 1u << curve(k).EdgeAxis : 0u));
      const unsigned graphs = curve(k).Heights & possible;
      const unsigned directions = (graphs & ~normal) != 0 ? graphs & ~normal
        : graphs != 0                                     ? graphs
                                                          : possible;
      for (const int d : this->Axes)
      {
        if ((directions >> d & 1u) == 0)
        {
          continue;
        }
        const double product = g(d, i) * g(d, i + 1);
        const double steep =
          product > 0.0 ? std::min(std::abs(g(d, i)), std::abs(g(d, i + 1))) * this->Scale[d] : 0.0;
        if (steep > best)
        {
          best = steep;
          axisOf[k] = d;
        }
      }
    }
  }
  // The chord from end to end, measured where a curve that bends to both sides is seen too.
  std::vector<Index> offset(n, 0);
  std::vector<Index> wanted(n, 0);
  std::vector<double> errors(n, 0.0);
  Samples samples;
  samples.Resize(*this, 0);
  this->MeasureCurves(begin, open, offset, wanted, samples, axisOf, { 0.25, 0.5, 0.75 }, errors);
  std::vector<std::size_t> next;
  for (const std::size_t k : open)
  {
    if (errors[k] > 1.0)
    {
      wanted[k] = static_cast<Index>(std::ceil(std::sqrt(std::min(errors[k], 1e6)))) - 1;
      next.push_back(k);
    }
  }
  open = std::move(next);
  std::vector<Samples> done(n); // inner points of curves that are finished
  std::vector<int> axes;
  std::vector<char> projected;
  constexpr int Rounds = 6;
  for (int round = 0; round < Rounds && !open.empty(); ++round)
  {
    Index total = 0;
    for (const std::size_t k : open)
    {
      offset[k] = total;
      total += wanted[k];
    }
    samples.Resize(*this, total);
    axes.resize(static_cast<std::size_t>(total));
    for (const std::size_t k : open)
    {
      const Eigen::Vector3d a = this->Shared.Parameters.col(curve(k).From);
      const Eigen::Vector3d b = this->Shared.Parameters.col(curve(k).To);
      for (Index i = 0; i < wanted[k]; ++i)
      {
        const double t = static_cast<double>(i + 1) / static_cast<double>(wanted[k] + 1);
        for (int d = 0; d < 3; ++d)
        {
          // Where both ends have the same bits, so has what is between.
          samples.Parameters(d, offset[k] + i) = a[d] == b[d] ? a[d] : (1.0 - t) * a[d] + t * b[d];
        }
        axes[static_cast<std::size_t>(offset[k] + i)] = axisOf[k];
      }
    }
    this->Project(samples.Parameters, axes, projected);
    for (const std::size_t k : open)
    {
      for (Index i = 0; i < wanted[k] && curve(k).EdgeAxis >= 0; ++i)
      {
        // An edge is where it is.
        samples.Parameters(axisOf[k], offset[k] + i) =
          this->Shared.Parameters(axisOf[k], curve(k).From);
        projected[static_cast<std::size_t>(offset[k] + i)] = 1;
      }
    }
    this->Evaluate(samples, 0, total);
    this->MeasureCurves(begin, open, offset, wanted, samples, axisOf, { 0.5 }, errors);
    next.clear();
    for (const std::size_t k : open)
    {
      bool valid = true;
      for (Index i = 0; i < wanted[k]; ++i)
      {
        valid = valid && projected[static_cast<std::size_t>(offset[k] + i)] != 0;
      }
      if (valid && errors[k] > 1.1 && wanted[k] < MostCurvePoints && round + 1 < Rounds)
      {
        const double more = 1.05 * std::sqrt(std::min(errors[k], 64.0));
        wanted[k] = std::min(MostCurvePoints,
          static_cast<Index>(std::ceil(static_cast<double>(wanted[k] + 1) * more)) - 1);
        next.push_back(k);
      }
      else if (valid)
      {
        done[k].Resize(*this, wanted[k]);
        this->Copy(samples, offset[k], done[k], 0, wanted[k]);
      }
      else
      {
        curve(k).HasFailed = true;
      }
    }
    open = std::move(next);
  }
  Index total = 0;
  for (std::size_t k = 0; k < n; ++k)
  {
    curve(k).First = total;
    curve(k).Count = done[k].Count();
    total += done[k].Count();
  }
  found.Resize(*this, total);
  for (std::size_t k = 0; k < n; ++k)
  {
    this->Copy(done[k], 0, found, curve(k).First, done[k].Count());
  }
}

void ZeroSet::Worker::Middles::SetZero(const Worker& worker, Index count)
{
  this->Parameters.setZero(3, count);
  this->Points.setZero(3, count);
  this->Attributes.clear();
  for (const Evaluator* attribute : worker.Attributes)
  {
    this->Attributes.push_back(Eigen::MatrixXd::Zero(attribute->Components(), count));
  }
}

void ZeroSet::Worker::Middles::Add(Index to, double weight, const Samples& samples, Index from)
{
  this->Parameters.col(to) += weight * samples.Parameters.col(from);
  this->Points.col(to) += weight * samples.Points.col(from);
  for (std::size_t a = 0; a < this->Attributes.size(); ++a)
  {
    this->Attributes[a].col(to) += weight * samples.Attributes[a].col(from);
  }
}

void ZeroSet::Worker::MeasureCurves(Index begin, const std::vector<std::size_t>& which,
  const std::vector<Index>& firsts, const std::vector<Index>& counts, const Samples& samples,
  const std::vector<int>& axisOf, const std::vector<double>& places, std::vector<double>& errors)
{
  Index total = 0;
  for (const std::size_t k : which)
  {
    total += (counts[k] + 1) * static_cast<Index>(places.size());
  }
  Middles middles;
  middles.SetZero(*this, total);
  middles.Axes.resize(static_cast<std::size_t>(total));
  middles.Chords.setZero(3, total);
  Index at = 0;
  for (const std::size_t k : which)
  {
    const Curve& curve = this->Curves[static_cast<std::size_t>(begin) + k];
    const bool outline = curve.IsOnCrease || this->Axes.size() < 3;
    const auto point = [&](Index i) -> std::pair<const Samples*, Index>
    {
      return i < 0       ? std::make_pair(&this->Shared, curve.From)
        : i >= counts[k] ? std::make_pair(&this->Shared, curve.To)
                         : std::make_pair(&samples, firsts[k] + i);
    };
    for (Index i = 0; i <= counts[k]; ++i)
    {
      const auto [from, a] = point(i - 1);
      const auto [to, b] = point(i);
      for (const double t : places)
      {
        middles.Add(at, 1.0 - t, *from, a);
        middles.Add(at, t, *to, b);
        middles.Axes[static_cast<std::size_t>(at)] = axisOf[k];
        if (outline)
        {
          middles.Chords.col(at) = (to->Points.col(b) - from->Points.col(a)).normalized();
        }
        ++at;
      }
    }
  }
  std::vector<Error> measured;
  this->Measure(middles, measured);
  at = 0;
  for (const std::size_t k : which)
  {
    Curve& curve = this->Curves[static_cast<std::size_t>(begin) + k];
    const double inner = curve.IsOnCrease || this->Axes.size() < 3 ? 1.0 : InnerChord;
    curve.Measured = Error();
    for (Index i = 0; i < (counts[k] + 1) * static_cast<Index>(places.size()); ++i, ++at)
    {
      const Error& e = measured[static_cast<std::size_t>(at)];
      curve.Measured.Distance = std::max(curve.Measured.Distance, e.Distance);
      curve.Measured.Attribute = std::max(curve.Measured.Attribute, e.Attribute);
    }
    errors[k] = std::max(inner * curve.Measured.Distance / this->Options.Tolerance,
                  InnerChord * curve.Measured.Attribute) /
      Target;
  }
}

void ZeroSet::Worker::Copy(
  const Samples& from, Index first, Samples& to, Index at, Index count) const
{
  to.Parameters.middleCols(at, count) = from.Parameters.middleCols(first, count);
  to.Points.middleCols(at, count) = from.Points.middleCols(first, count);
  to.Normals.middleCols(at, count) = from.Normals.middleCols(first, count);
  to.Residuals.segment(at, count) = from.Residuals.segment(first, count);
  for (std::size_t a = 0; a < from.Attributes.size(); ++a)
  {
    to.Attributes[a].middleCols(at, count) = from.Attributes[a].middleCols(first, count);
  }
}

}
