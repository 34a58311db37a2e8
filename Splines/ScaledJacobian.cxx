// SPDX-License-Identifier: BSD-3-Clause
#include "ScaledJacobian.h"

#include "Error.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace hyperpatch
{

namespace
{

/// Unit roundoff.
constexpr double U = std::numeric_limits<double>::epsilon() / 2;

struct Box
{
  Eigen::MatrixXd Points;
  double Error;
  Interval Range;
};

class Search
{
public:
  Search(std::array<int, 3> degrees, double tolerance, int handedness)
    : P(degrees)
    , Tolerance(tolerance)
    , Handedness(handedness)
  {
  }

  /// The least and the greatest value at corners so far, the first rounded up, the other down.
  double Least = 1.0;
  double Greatest = -1.0;

  /// Bounds from the cones, and values at the corners.
  void Examine(Box& box)
  {
    std::array<Cone, 3> cones;
    for (int d = 0; d < 3; ++d)
    {
      cones[static_cast<std::size_t>(d)] = DerivativeCone(box.Points, this->P, d, box.Error);
    }
    box.Range = TripleProduct(cones[0], cones[1], cones[2]);
    for (int corner = 0; corner < 8; ++corner)
    {
      this->Sample(box, corner);
    }
  }

  [[nodiscard]] bool IsOpen(const Box& box) const
  {
    return (this->Handedness >= 0 && box.Range.Low < this->Least - this->Tolerance) ||
      (this->Handedness <= 0 && box.Range.High > this->Greatest + this->Tolerance);
  }

  /// Whether a box may tell less than another: the bound that is furthest out comes first.
  [[nodiscard]] bool ComesLater(const Box& a, const Box& b) const
  {
    return this->Handedness > 0 ? a.Range.Low > b.Range.Low
      : this->Handedness < 0    ? a.Range.High < b.Range.High
                                : a.Range.High - a.Range.Low < b.Range.High - b.Range.Low;
  }

  /// Two halves, across the direction in which the derivatives vary most.
  [[nodiscard]] std::array<Box, 2> HalvesOf(const Box& box) const
  {
    int direction = 0;
    double most = -1.0;
    for (int d = 0; d < 3; ++d)
    {
      double variation = 0.0;
      for (int e = 0; e < 3; ++e)
      {
        const Eigen::MatrixXd first = this->Difference(box.Points, e, this->P);
        std::array<int, 3> lower = this->P;
        --lower[static_cast<std::size_t>(e)];
        const double size = first.cwiseAbs().maxCoeff();
        if (lower[static_cast<std::size_t>(d)] > 0 && size > 0.0)
        {
          variation += this->Difference(first, d, lower).cwiseAbs().maxCoeff() / size;
        }
      }
      variation *= this->P[static_cast<std::size_t>(d)];
      if (variation > most)
      {
        most = variation;
        direction = d;
      }
    }
    const int p = this->P[static_cast<std::size_t>(direction)];
    const double magnitude = box.Points.cwiseAbs().maxCoeff();
    // Means of numbers; each step rounds once, and halving is exact.
    const double error = box.Error + 2 * p * U * (magnitude + box.Error);
    std::array<Box, 2> halves{ Box{ box.Points, error, {} }, Box{ box.Points, error, {} } };
    const Eigen::Index stride = this->Stride(direction, this->P);
    for (Eigen::Index slab = 0; slab < box.Points.cols(); slab += stride * (p + 1))
    {
      auto right = halves[1].Points.middleCols(slab, stride * (p + 1));
      for (int r = 1; r <= p; ++r)
      {
        for (Eigen::Index i = 0; i < stride * (p + 1 - r); ++i)
        {
          right.col(i) = 0.5 * (right.col(i) + right.col(i + stride));
        }
        halves[0].Points.middleCols(slab + r * stride, stride) = right.leftCols(stride);
      }
    }
    return halves;
  }

private:
  [[nodiscard]] Eigen::Index Stride(int direction, const std::array<int, 3>& degrees) const
  {
    return (direction > 0 ? degrees[0] + 1 : 1) *
      static_cast<Eigen::Index>(direction > 1 ? degrees[1] + 1 : 1);
  }

  [[nodiscard]] Eigen::MatrixXd Difference(
    const Eigen::MatrixXd& points, int direction, const std::array<int, 3>& degrees) const
  {
    const Eigen::Index stride = this->Stride(direction, degrees);
    const Eigen::Index n = degrees[static_cast<std::size_t>(direction)];
    const Eigen::Index slabs = points.cols() / (stride * (n + 1));
    Eigen::MatrixXd result(points.rows(), slabs * stride * n);
    for (Eigen::Index s = 0; s < slabs; ++s)
    {
      result.middleCols(s * stride * n, stride * n) =
        points.middleCols(s * stride * (n + 1) + stride, stride * n) -
        points.middleCols(s * stride * (n + 1), stride * n);
    }
    return result;
  }

  /// The tangents at a corner point from its control point to the next ones.
  void Sample(const Box& box, int corner)
  {
    Eigen::Index at = 0;
    for (int d = 0; d < 3; ++d)
    {
      at += (corner >> d & 1) * this->P[static_cast<std::size_t>(d)] * this->Stride(d, this->P);
    }
    const auto projected = [&box](Eigen::Index i, double& error) -> Eigen::Vector3d
    {
      const Eigen::Vector3d x = box.Points.col(i).head<3>();
      if (box.Points.rows() == 3)
      {
        error += std::sqrt(3.0) * box.Error;
        return x;
      }
      const double w = box.Points(3, i);
      const Eigen::Vector3d point = x / w;
      error += std::sqrt(3.0) *
        (box.Error * (1.0 + point.norm()) / (w - box.Error) + 4 * U * point.norm());
      return point;
    };
    Eigen::Matrix3d tangents;
    double uncertain = 64 * U;
    for (int d = 0; d < 3; ++d)
    {
      const int end = corner >> d & 1;
      const Eigen::Index next = at + (end ? -1 : 1) * this->Stride(d, this->P);
      double error = 0.0;
      const Eigen::Vector3d here = projected(at, error);
      const Eigen::Vector3d tangent = (end ? -1.0 : 1.0) * (projected(next, error) - here);
      const double length = tangent.norm();
      if (!(length > 2.0 * error))
      {
        return;
      }
      tangents.col(d) = tangent / length;
      // The product changes by no more than a unit vector does.
      uncertain += 2.0 * error / length;
    }
    const double value = tangents.col(0).dot(tangents.col(1).cross(tangents.col(2)));
    this->Least = std::min(this->Least, value + uncertain);
    this->Greatest = std::max(this->Greatest, value - uncertain);
  }

  std::array<int, 3> P;
  double Tolerance;
  int Handedness;
};

}

ScaledJacobian BoundScaledJacobian(const Eigen::MatrixXd& homogeneousBezierPoints,
  std::array<int, 3> degrees, double tolerance, int handedness, int maxBoxes, double pointError)
{
  const Eigen::MatrixXd& h = homogeneousBezierPoints;
  if (!(tolerance > 0.0))
  {
    throw Error(
      "the tolerance of the scaled Jacobian is positive, not " + std::to_string(tolerance));
  }
  if (h.rows() == 4 && !(h.row(3).minCoeff() > pointError))
  {
    throw Error("the scaled Jacobian needs positive weights; the least is " +
      std::to_string(h.row(3).minCoeff()));
  }
  Search search(degrees, tolerance, handedness);
  std::vector<Box> heap{ Box{ h, pointError, {} } };
  search.Examine(heap.front());
  const auto comesLater = [&search](const Box& a, const Box& b) { return search.ComesLater(a, b); };
  Interval closed{ 1.0, -1.0 };
  int boxes = 1;
  while (!heap.empty())
  {
    std::pop_heap(heap.begin(), heap.end(), comesLater);
    const Box box = std::move(heap.back());
    heap.pop_back();
    if (!search.IsOpen(box) || boxes + 2 > maxBoxes)
    {
      closed = { std::min(closed.Low, box.Range.Low), std::max(closed.High, box.Range.High) };
      continue;
    }
    for (Box& half : search.HalvesOf(box))
    {
      ++boxes;
      search.Examine(half);
      // What held for the whole holds for its parts.
      half.Range = { std::max(half.Range.Low, box.Range.Low),
        std::min(half.Range.High, box.Range.High) };
      heap.push_back(std::move(half));
      std::push_heap(heap.begin(), heap.end(), comesLater);
    }
  }
  return { { closed.Low, std::max(closed.Low, search.Least) },
    { std::min(search.Greatest, closed.High), closed.High }, boxes };
}

}
