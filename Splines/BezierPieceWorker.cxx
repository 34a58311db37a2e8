// SPDX-License-Identifier: BSD-3-Clause
#include "BezierPieceWorker.h"

#include "RoundingWorker.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <utility>

namespace hyperpatch
{

using rounding::U;

namespace
{

/// Whether all of `a` is on one side and all of `b` on the other along a direction, errors and the
/// rounding of dot products included.
bool SeparatesAlong(const Eigen::Vector3d& direction, const BezierPiece& a, const BezierPiece& b)
{
  const auto along = [&direction](const BezierPiece& piece)
  { return (direction.transpose() * piece.Projected()).eval(); };
  const auto pa = along(a);
  const auto pb = along(b);
  const double magnitude =
    std::max({ a.BoxLow().cwiseAbs().maxCoeff(), a.BoxHigh().cwiseAbs().maxCoeff(),
      b.BoxLow().cwiseAbs().maxCoeff(), b.BoxHigh().cwiseAbs().maxCoeff() });
  const double slack = direction.lpNorm<1>() *
    (a.ProjectedError() + b.ProjectedError() + 8 * U * magnitude) * rounding::Outward;
  return pa.maxCoeff() + slack < pb.minCoeff() || pb.maxCoeff() + slack < pa.minCoeff();
}

/// Directions across the mean parallelepiped of a piece.
std::array<Eigen::Vector3d, 3> MeanNormals(const BezierPiece& piece)
{
  std::array<Eigen::Vector3d, 3> tangents;
  for (int d = 0; d < 3; ++d)
  {
    Eigen::Vector3d& t = tangents[static_cast<std::size_t>(d)];
    t.setZero();
    for (int corner = 0; corner < 8; ++corner)
    {
      t += (corner >> d & 1 ? 1.0 : -1.0) * piece.Projected().col(piece.Corner(corner));
    }
  }
  return { tangents[1].cross(tangents[2]), tangents[2].cross(tangents[0]),
    tangents[0].cross(tangents[1]) };
}

}

BezierPiece::BezierPiece(std::array<int, 3> degrees, Eigen::MatrixXd points, double error)
  : P(degrees)
  , H(std::move(points))
  , E(error)
{
  for (std::size_t d = 0; d < 3; ++d)
  {
    this->S[d] = degrees[d] > 0 ? 1.0 : 0.0;
  }
  if (this->H.rows() == 4 && (this->H.row(3).array() == this->H(3, 0)).all())
  {
    const double weight = this->H(3, 0);
    const double magnitude = this->H.topRows<3>().cwiseAbs().maxCoeff();
    this->E = (error + (error + 2 * U * weight) * magnitude / weight) / weight * rounding::Outward;
    this->H = (this->H.topRows<3>() / weight).eval();
  }
  this->Project();
}

void BezierPiece::Project()
{
  if (this->IsRational())
  {
    this->X = this->H.topRows<3>().array().rowwise() / this->H.row(3).array();
    const double least = this->H.row(3).minCoeff();
    const double magnitude = this->X.cwiseAbs().maxCoeff();
    this->XE =
      (this->E * (1.0 + magnitude) / (least - this->E) + 2 * U * magnitude) * rounding::Outward;
  }
  else
  {
    this->X = this->H;
    this->XE = this->E;
  }
  this->Bottom = this->X.rowwise().minCoeff().array() - this->XE;
  this->Top = this->X.rowwise().maxCoeff().array() + this->XE;
}

std::array<double, 3> BezierPiece::Centre() const
{
  return { this->L[0] + 0.5 * this->S[0], this->L[1] + 0.5 * this->S[1],
    this->L[2] + 0.5 * this->S[2] };
}

Eigen::Index BezierPiece::Stride(int direction) const
{
  return (direction > 0 ? this->P[0] + 1 : 1) *
    static_cast<Eigen::Index>(direction > 1 ? this->P[1] + 1 : 1);
}

Eigen::Index BezierPiece::Corner(int corner) const
{
  Eigen::Index index = 0;
  for (int d = 0; d < 3; ++d)
  {
    index += (corner >> d & 1) * this->Degree(d) * this->Stride(d);
  }
  return index;
}

std::array<BezierPiece, 2> BezierPiece::Halves(int direction) const
{
  const auto d = static_cast<std::size_t>(direction);
  const int p = this->P[d];
  std::array<BezierPiece, 2> halves{ *this, *this };
  // Means of means; each step rounds once, and halving is exact.
  const double error =
    (this->E + rounding::Gamma(p) * (this->E + this->H.cwiseAbs().maxCoeff())) * rounding::Outward;
  const Eigen::Index stride = this->Stride(direction);
  for (Eigen::Index slab = 0; slab < this->H.cols(); slab += stride * (p + 1))
  {
    auto right = halves[1].H.middleCols(slab, stride * (p + 1));
    for (int r = 1; r <= p; ++r)
    {
      for (Eigen::Index i = 0; i < stride * (p + 1 - r); ++i)
      {
        right.col(i) = 0.5 * (right.col(i) + right.col(i + stride));
      }
      halves[0].H.middleCols(slab + r * stride, stride) = right.leftCols(stride);
    }
  }
  for (int end = 0; end < 2; ++end)
  {
    BezierPiece& half = halves[static_cast<std::size_t>(end)];
    half.E = error;
    half.S[d] *= 0.5;
    half.L[d] += end * half.S[d];
    half.Project();
  }
  return halves;
}

BezierPiece BezierPiece::AtEnd(int direction, int end) const
{
  const auto d = static_cast<std::size_t>(direction);
  const int p = this->P[d];
  const Eigen::Index stride = this->Stride(direction);
  BezierPiece result;
  result.P = this->P;
  result.P[d] = 0;
  result.E = this->E;
  result.L = this->L;
  result.L[d] += end * this->S[d];
  result.S = this->S;
  result.S[d] = 0.0;
  result.H.resize(this->H.rows(), this->H.cols() / (p + 1));
  for (Eigen::Index slab = 0; slab * stride < result.H.cols(); ++slab)
  {
    result.H.middleCols(slab * stride, stride) =
      this->H.middleCols((slab * (p + 1) + end * p) * stride, stride);
  }
  result.Project();
  return result;
}

double BezierPiece::Length(int direction) const
{
  const int p = this->Degree(direction);
  const Eigen::Index stride = this->Stride(direction);
  double longest = 0.0;
  for (Eigen::Index slab = 0; slab < this->X.cols(); slab += stride * (p + 1))
  {
    for (Eigen::Index i = slab; i < slab + stride; ++i)
    {
      double length = 0.0;
      for (int r = 0; r < p; ++r)
      {
        length += (this->X.col(i + (r + 1) * stride) - this->X.col(i + r * stride)).norm();
      }
      longest = std::max(longest, length);
    }
  }
  return longest;
}

double BezierPiece::Bend(int direction) const
{
  // |second differences across| / |first differences|, over the first ones of each direction.
  const Eigen::Index stride = this->Stride(direction);
  const int p = this->Degree(direction);
  double bend = 0.0;
  for (int e = 0; e < 3 && p > 0; ++e)
  {
    const Eigen::Index step = this->Stride(e);
    const int q = this->Degree(e);
    double first = 0.0;
    double second = 0.0;
    for (Eigen::Index i = 0; i < this->X.cols(); ++i)
    {
      const auto index = static_cast<int>(i / stride % (p + 1));
      const auto other = static_cast<int>(i / step % (q + 1));
      if (other < q)
      {
        const Eigen::Vector3d difference = this->X.col(i + step) - this->X.col(i);
        first = std::max(first, difference.norm());
        if (e == direction ? other + 2 <= q : index < p)
        {
          second = std::max(
            second, (this->X.col(i + stride + step) - this->X.col(i + stride) - difference).norm());
        }
      }
    }
    bend += first > 0.0 ? p * second / first : 0.0;
  }
  return bend;
}

bool BoxesAreDisjoint(const BezierPiece& a, const BezierPiece& b)
{
  return (a.BoxLow().array() > b.BoxHigh().array()).any() ||
    (b.BoxLow().array() > a.BoxHigh().array()).any();
}

bool AreSeparated(const BezierPiece& a, const BezierPiece& b)
{
  if (BoxesAreDisjoint(a, b))
  {
    return true;
  }
  const Eigen::Vector3d apart = b.Projected().rowwise().mean() - a.Projected().rowwise().mean();
  if (SeparatesAlong(apart, a, b))
  {
    return true;
  }
  for (const BezierPiece* piece : { &a, &b })
  {
    for (const Eigen::Vector3d& normal : MeanNormals(*piece))
    {
      if (SeparatesAlong(normal, a, b))
      {
        return true;
      }
    }
  }
  return false;
}

bool HullsAreDisjoint(const BezierPiece& a, const BezierPiece& b, int steps)
{
  // v is a point of the difference of the hulls, which approaches the one nearest to the origin.
  Eigen::Vector3d v = b.Projected().rowwise().mean() - a.Projected().rowwise().mean();
  for (int step = 0; step < steps; ++step)
  {
    Eigen::Index ia = 0;
    Eigen::Index ib = 0;
    (v.transpose() * a.Projected()).maxCoeff(&ia);
    (v.transpose() * b.Projected()).minCoeff(&ib);
    const Eigen::Vector3d support = b.Projected().col(ib) - a.Projected().col(ia);
    if (v.dot(support) > 0.0 && SeparatesAlong(v, a, b))
    {
      return true;
    }
    const Eigen::Vector3d edge = support - v;
    const double square = edge.squaredNorm();
    const double t = square > 0.0 ? std::clamp(-v.dot(edge) / square, 0.0, 1.0) : 0.0;
    if (!(t > 0.0))
    {
      return false;
    }
    v += t * edge;
  }
  return false;
}

}
