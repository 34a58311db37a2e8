// SPDX-License-Identifier: BSD-3-Clause
#include "ZeroSetWorker.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <utility>

namespace hyperpatch
{

bool ZeroSet::Worker::EvaluateVertices()
{
  const Index count = this->Mesh.Parameters.cols();
  const int m = this->Geometry.Components();
  this->Mesh.Points.setZero(3, count);
  this->Mesh.Normals.setZero(3, count);
  this->Mesh.Attributes.resize(this->Attributes.size());
  for (std::size_t a = 0; a < this->Attributes.size(); ++a)
  {
    this->Mesh.Attributes[a].resize(this->Attributes[a]->Components(), count);
  }
  return this->Parallel(count, Batch,
    [&](Index begin, Index end)
    {
      const auto n = static_cast<std::size_t>(end - begin);
      const double* parameters = this->Mesh.Parameters.col(begin).data();
      Eigen::MatrixXd points(m, end - begin);
      Eigen::MatrixXd derivatives(3 * m, end - begin);
      std::vector<double> values(n);
      Eigen::Matrix3Xd gradients(3, end - begin);
      this->Geometry.EvaluateWithDerivatives(n, parameters, points.data(), derivatives.data());
      this->Mesh.Points.block(0, begin, m, end - begin) = points;
      this->Field.EvaluateWithGradient(n, parameters, values.data(), gradients.data());
      this->Field.Snap(n, this->Mesh.Points.col(begin).data());
      for (std::size_t a = 0; a < this->Attributes.size(); ++a)
      {
        this->Attributes[a]->Evaluate(n, parameters, this->Mesh.Attributes[a].col(begin).data());
      }
      for (Index i = 0; i < end - begin; ++i)
      {
        Eigen::Matrix3d J = Eigen::Matrix3d::Zero();
        for (int d = 0; d < 3; ++d)
        {
          J.col(d).head(m) = derivatives.block(d * m, i, m, 1);
        }
        // cof(J) grad f: the physical gradient times det J, so it does not flip across folds.
        Eigen::Vector3d normal = Eigen::Vector3d::Zero();
        if (this->Axes.size() == 3)
        {
          const Eigen::Vector3d g = gradients.col(i);
          normal = this->Options.Handedness *
            (g[0] * J.col(1).cross(J.col(2)) + g[1] * J.col(2).cross(J.col(0)) +
              g[2] * J.col(0).cross(J.col(1)));
        }
        else if (this->Axes.size() == 2)
        {
          normal = J.col(this->Axes[0]).cross(J.col(this->Axes[1]));
        }
        const double norm = normal.norm();
        this->Mesh.Normals.col(begin + i) = norm > 0.0 ? Eigen::Vector3d(normal / norm) : normal;
      }
    });
}

void ZeroSet::Worker::Triangulate(const std::vector<Index>& ring,
  const std::vector<CellEdge>& edges, std::vector<std::array<Index, 3>>& triangles) const
{
  // The triangulation with the least sum of squared diagonals: flat, well shaped, the same on any
  // thread. A diagonal inside a face of the cell is forbidden where there is another way: the
  // neighbour might draw it too. Klincsek's dynamic program; polygons are short.
  constexpr std::size_t Most = 16;
  const std::size_t n = ring.size();
  std::array<std::array<double, Most>, Most> cost{};
  std::array<std::array<std::size_t, Most>, Most> apex{};
  const auto weight = [&](std::size_t i, std::size_t j)
  {
    if (j - i == 1 || j - i == n - 1)
    {
      return 0.0;
    }
    bool inFace = false;
    for (int a = 0; a < 3; ++a)
    {
      inFace = inFace ||
        (a != edges[i].Axis && a != edges[j].Axis &&
          ((edges[i].Corner ^ edges[j].Corner) >> a & 1) == 0);
    }
    const double square =
      (this->Mesh.Points.col(ring[i]) - this->Mesh.Points.col(ring[j])).squaredNorm();
    return inFace ? 1e100 : square;
  };
  for (std::size_t length = 2; length < n; ++length)
  {
    for (std::size_t i = 0; i + length < n; ++i)
    {
      const std::size_t j = i + length;
      cost[i][j] = INFINITY;
      for (std::size_t k = i + 1; k < j; ++k)
      {
        const double sum = cost[i][k] + cost[k][j] + weight(i, k) + weight(k, j);
        if (sum < cost[i][j])
        {
          cost[i][j] = sum;
          apex[i][j] = k;
        }
      }
    }
  }
  triangles.clear();
  const std::function<void(std::size_t, std::size_t)> cut = [&](std::size_t i, std::size_t j)
  {
    if (j - i < 2)
    {
      return;
    }
    const std::size_t k = apex[i][j];
    if (ring[i] != ring[k] && ring[k] != ring[j] && ring[j] != ring[i])
    {
      triangles.push_back({ ring[i], ring[k], ring[j] });
    }
    cut(i, k);
    cut(k, j);
  };
  cut(0, n - 1);
}

void ZeroSet::Worker::MakeCells()
{
  const int axes = static_cast<int>(this->Axes.size());
  std::vector<Index> indices;
  this->CellOfPiece.clear();
  std::vector<Index> ring;
  std::vector<CellEdge> edges;
  std::vector<std::array<Index, 3>> triangles;
  const auto vertexOf = [&](const CrossedCell& cell, const CellEdge& edge)
  {
    const int other = edge.Corner | 1 << edge.Axis;
    const bool low = cell.Zero >> edge.Corner & 1u;
    const bool high = cell.Zero >> other & 1u;
    const int from = high ? other : edge.Corner;
    Cell corner = cell.At;
    for (int b = 0; b < axes; ++b)
    {
      corner[static_cast<std::size_t>(this->Axes[static_cast<std::size_t>(b)])] += from >> b & 1;
    }
    const int axis = low || high ? 3 : this->Axes[static_cast<std::size_t>(edge.Axis)];
    const Index key = 4 * this->Corner(corner) + axis;
    return static_cast<Index>(std::lower_bound(this->Vertices.begin(), this->Vertices.end(), key,
                                [](const Crossing& c, Index k) { return c.Key < k; }) -
      this->Vertices.begin());
  };
  const auto add = [&](const Cell& at, std::initializer_list<Index> cell)
  {
    indices.insert(indices.end(), cell);
    this->CellOfPiece.push_back(at);
  };
  const auto point = [this](Index v) { return this->Mesh.Points.col(v); };
  for (const CrossedCell& cell : this->Crossed)
  {
    for (const std::vector<CellEdge>& piece : PiecesOfCell(axes, cell.Positive))
    {
      ring.clear();
      edges.clear();
      for (const CellEdge& edge : piece)
      {
        const Index v = vertexOf(cell, edge);
        if (ring.empty() || ring.back() != v)
        {
          ring.push_back(v);
          edges.push_back(edge);
        }
      }
      while (ring.size() > 1 && ring.front() == ring.back())
      {
        ring.pop_back();
        edges.pop_back();
      }
      if (axes == 1)
      {
        add(cell.At, { ring[0] });
      }
      else if (axes == 2 && ring.size() == 2)
      {
        add(cell.At, { ring[0], ring[1] });
      }
      else if (axes == 3 && ring.size() >= 3)
      {
        this->Triangulate(ring, edges, triangles);
        for (const auto& [a, b, c] : triangles)
        {
          if (this->Options.Handedness > 0)
          {
            add(cell.At, { a, b, c });
          }
          else
          {
            add(cell.At, { a, c, b });
          }
        }
      }
    }
  }
  const auto count = static_cast<Index>(this->CellOfPiece.size());
  this->Mesh.Cells = Eigen::Map<const Eigen::Matrix<Index, Eigen::Dynamic, Eigen::Dynamic>>(
    indices.data(), axes, count);
  this->Mesh.Elements.resize(3, count);
  for (int d = 0; d < 3; ++d)
  {
    const std::vector<double> breaks = this->Body.Geometry().Knots(d).Breaks();
    for (Index c = 0; c < count; ++c)
    {
      const int i = this->CellOfPiece[static_cast<std::size_t>(c)][static_cast<std::size_t>(d)];
      const double low = this->Line(d, i);
      const double high =
        i + 1 < this->Counts[static_cast<std::size_t>(d)] ? this->Line(d, i + 1) : low;
      const auto span = std::upper_bound(breaks.begin() + 1, breaks.end() - 1, 0.5 * (low + high)) -
        breaks.begin() - 1;
      this->Mesh.Elements(d, c) = static_cast<int>(span);
    }
  }
  // Where the Jacobian has no rank at a pole there is no normal; take that of the triangles around.
  if (axes == 3)
  {
    std::vector<std::pair<Index, Index>> lost;
    for (Index c = 0; c < count; ++c)
    {
      for (int k = 0; k < 3; ++k)
      {
        if (this->Mesh.Normals.col(this->Mesh.Cells(k, c)).isZero(0.0))
        {
          lost.emplace_back(this->Mesh.Cells(k, c), c);
        }
      }
    }
    std::vector<std::pair<Index, Eigen::Vector3d>> sums;
    std::sort(lost.begin(), lost.end());
    for (const auto& [v, c] : lost)
    {
      const Eigen::Vector3d a = point(this->Mesh.Cells(0, c));
      const Eigen::Vector3d n =
        (point(this->Mesh.Cells(1, c)) - a).cross(point(this->Mesh.Cells(2, c)) - a);
      if (sums.empty() || sums.back().first != v)
      {
        sums.emplace_back(v, Eigen::Vector3d::Zero());
      }
      sums.back().second += n;
    }
    for (const auto& [v, n] : sums)
    {
      this->Mesh.Normals.col(v) = n.norm() > 0.0 ? Eigen::Vector3d(n.normalized()) : n;
    }
  }
}

void ZeroSet::Worker::DropUnusedPoints()
{
  std::vector<Index> place(static_cast<std::size_t>(this->Mesh.Points.cols()), -1);
  for (Index i = 0; i < this->Mesh.Cells.size(); ++i)
  {
    place[static_cast<std::size_t>(this->Mesh.Cells.data()[i])] = 0;
  }
  Index count = 0;
  for (std::size_t v = 0; v < place.size(); ++v)
  {
    if (place[v] < 0)
    {
      continue;
    }
    const auto from = static_cast<Index>(v);
    this->Mesh.Parameters.col(count) = this->Mesh.Parameters.col(from);
    this->Mesh.Points.col(count) = this->Mesh.Points.col(from);
    this->Mesh.Normals.col(count) = this->Mesh.Normals.col(from);
    for (Eigen::MatrixXd& values : this->Mesh.Attributes)
    {
      values.col(count) = values.col(from);
    }
    place[v] = count++;
  }
  this->Mesh.Parameters.conservativeResize(3, count);
  this->Mesh.Points.conservativeResize(3, count);
  this->Mesh.Normals.conservativeResize(3, count);
  for (Eigen::MatrixXd& values : this->Mesh.Attributes)
  {
    values.conservativeResize(values.rows(), count);
  }
  for (Index i = 0; i < this->Mesh.Cells.size(); ++i)
  {
    Index& v = this->Mesh.Cells.data()[i];
    v = place[static_cast<std::size_t>(v)];
  }
}

}
