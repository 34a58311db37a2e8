// SPDX-License-Identifier: BSD-3-Clause
#include "JacobianCreaseWorker.h"

#include <Eigen/Geometry>

#include <algorithm>

namespace hyperpatch
{

void JacobianCreaseExtraction::Fill()
{
  std::vector<Eigen::Vector3d> parameters;
  std::vector<Eigen::Vector3d> points;
  std::vector<Eigen::Vector3d> normals;
  std::vector<Triangle> triangles;
  std::vector<Eigen::Vector3i> elements;
  for (std::size_t region = 0; region < 2; ++region)
  {
    std::map<Index, Index> used;
    const auto use = [&](Index vertex)
    {
      const auto [found, isNew] = used.emplace(vertex, static_cast<Index>(parameters.size()));
      if (isNew)
      {
        const Parameter& at = this->V[static_cast<std::size_t>(vertex)].At;
        Eigen::Vector3d point;
        Eigen::Matrix3d J;
        this->Geometry.EvaluateWithDerivatives(1, at.data(), point.data(), J.data());
        const Eigen::Vector3d normal = J.col(Column(this->B)).cross(J.col(Column(this->C)));
        parameters.emplace_back(at[0], at[1], at[2]);
        points.push_back(point);
        normals.push_back((region == 0 ? -1.0 : 1.0) * normal.stableNormalized());
        this->Source.push_back(vertex);
      }
      return found->second;
    };
    for (const auto& [triangle, element] : this->Pieces[region])
    {
      Triangle t{ use(triangle[0]), use(triangle[1]), use(triangle[2]) };
      if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0])
      {
        continue;
      }
      if (region == 0)
      {
        std::swap(t[1], t[2]);
      }
      triangles.push_back(t);
      Eigen::Vector3i at;
      at[Column(this->D)] = static_cast<int>(this->Below.Knots()[this->D].Spans().size()) - 1;
      at[Column(this->B)] = static_cast<int>(element[0]);
      at[Column(this->C)] = static_cast<int>(element[1]);
      elements.push_back(at);
    }
  }
  const auto n = static_cast<Eigen::Index>(parameters.size());
  const auto columns = [](const auto& from)
  { return from.empty() ? nullptr : from.front().data(); };
  this->Result.Parameters = Eigen::Map<const Eigen::Matrix3Xd>(columns(parameters), 3, n);
  this->Result.Points = Eigen::Map<const Eigen::Matrix3Xd>(columns(points), 3, n);
  this->Result.Normals = Eigen::Map<const Eigen::Matrix3Xd>(columns(normals), 3, n);
  const auto cells = static_cast<Eigen::Index>(triangles.size());
  this->Result.Elements = Eigen::Map<const Eigen::Matrix3Xi>(columns(elements), 3, cells);
  this->Result.Triangles =
    Eigen::Map<const Eigen::Matrix<Index, 3, Eigen::Dynamic>>(columns(triangles), 3, cells);
}

Eigen::Vector3d JacobianCreaseExtraction::Exact(Index a, Index b) const
{
  const Vertex& from = this->V[static_cast<std::size_t>(a)];
  const Vertex& to = this->V[static_cast<std::size_t>(b)];
  Eigen::Vector3d middle;
  for (std::size_t d = 0; d < 3; ++d)
  {
    middle[Column(d)] = 0.5 * (from.At[d] + to.At[d]);
  }
  for (std::size_t side = 0; side < 2; ++side)
  {
    if (from.IsRoot[side] && to.IsRoot[side])
    {
      double value = 0.0;
      Eigen::Vector3d gradient;
      this->Sides[side].EvaluateWithGradient(1, middle.data(), &value, gradient.data());
      gradient[Column(this->D)] = 0.0;
      const double square = gradient.squaredNorm();
      if (square > 0.0)
      {
        middle -= value / square * gradient;
      }
    }
  }
  Eigen::Vector3d point;
  this->Geometry.Evaluate(1, middle.data(), point.data());
  return point;
}

void JacobianCreaseExtraction::Measure()
{
  for (Eigen::Index t = 0; t < this->Result.Triangles.cols(); ++t)
  {
    for (Eigen::Index i = 0; i < 3; ++i)
    {
      const Index a = this->Result.Triangles(i, t);
      const Index b = this->Result.Triangles((i + 1) % 3, t);
      const Eigen::Vector3d middle =
        0.5 * (this->Result.Points.col(a) + this->Result.Points.col(b));
      const Eigen::Vector3d exact = this->Exact(
        this->Source[static_cast<std::size_t>(a)], this->Source[static_cast<std::size_t>(b)]);
      this->Result.LargestError = std::max(this->Result.LargestError, (middle - exact).norm());
    }
  }
}

}
