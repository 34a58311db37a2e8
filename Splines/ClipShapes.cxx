// SPDX-License-Identifier: BSD-3-Clause
// The shapes of the simplices of a clip, and how the geometry bends in them.
#include "ClipWorker.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace hyperpatch
{

double ClipWorker::Width(const Cell& cell) const
{
  Eigen::AlignedBox3d bounds;
  for (int c = 0; c <= this->Simplices->Dimension(); ++c)
  {
    bounds.extend(this->Points[Corner(cell, c)]);
  }
  return bounds.diagonal().norm();
}

unsigned char ClipWorker::LongestEdge(const Cell& cell) const
{
  // Of equal ones the same in all cells that have both.
  const auto keyOf = [&cell](int e)
  {
    return std::pair(
      std::min(End(cell, e, 0), End(cell, e, 1)), std::max(End(cell, e, 0), End(cell, e, 1)));
  };
  int longest = 0;
  double best = -1.0;
  for (int e = 0; e < SimplexRefinement::NumberOfEdges(this->Simplices->Dimension()); ++e)
  {
    const double length =
      (this->Points[End(cell, e, 0)] - this->Points[End(cell, e, 1)]).squaredNorm();
    if (length > best || (length == best && keyOf(e) < keyOf(longest)))
    {
      longest = e;
      best = length;
    }
  }
  return static_cast<unsigned char>(1 << longest);
}

std::array<double, 6> ClipWorker::Bends(const Cell& cell) const
{
  const auto& geometry = *this->M.Body->Geometry();
  const auto m = static_cast<std::size_t>(geometry.Spline().Components());
  const int edges = SimplexRefinement::NumberOfEdges(this->Simplices->Dimension());
  Eigen::Matrix<double, 3, 6> u;
  for (int e = 0; e < edges; ++e)
  {
    u.col(e) = hyperpatch::Middle(this->Simplices->At(static_cast<int>(End(cell, e, 0))),
      this->Simplices->At(static_cast<int>(End(cell, e, 1))))
                 .Values;
  }
  std::vector<double> x(m * static_cast<std::size_t>(edges));
  geometry.Evaluator().Evaluate(static_cast<std::size_t>(edges), u.data(), x.data());
  std::array<double, 6> bends{};
  for (int e = 0; e < edges; ++e)
  {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    std::copy_n(&x[m * static_cast<std::size_t>(e)], m, middle.data());
    bends[static_cast<std::size_t>(e)] =
      (middle - 0.5 * (this->Points[End(cell, e, 0)] + this->Points[End(cell, e, 1)])).norm();
  }
  return bends;
}

unsigned char ClipWorker::MostBentEdge(const Cell& cell) const
{
  const std::array<double, 6> bends = this->Bends(cell);
  const auto most = std::max_element(bends.begin(), bends.end());
  return *most > 0.0 ? static_cast<unsigned char>(1 << (most - bends.begin()))
                     : this->LongestEdge(cell);
}

unsigned char ClipWorker::EdgesBentAtPole(const Cell& cell) const
{
  constexpr double Largest = 0.07; // a share of the length: an arc of 30 degrees
  bool hasPole = false;
  for (int c = 0; c <= this->Simplices->Dimension(); ++c)
  {
    hasPole = hasPole || this->Simplices->Free(cell.Corners[static_cast<std::size_t>(c)]) != 0;
  }
  unsigned char bent = 0;
  const std::array<double, 6> bends = hasPole ? this->Bends(cell) : std::array<double, 6>{};
  for (int e = 0; hasPole && e < SimplexRefinement::NumberOfEdges(this->Simplices->Dimension());
       ++e)
  {
    const double length = (this->Points[End(cell, e, 0)] - this->Points[End(cell, e, 1)]).norm();
    bent |= static_cast<unsigned char>(
      bends[static_cast<std::size_t>(e)] > Largest * length ? 1 << e : 0);
  }
  return bent;
}

bool ClipWorker::IsTurnedOver(const Cell& cell) const
{
  return this->Simplices->Dimension() == 3 &&
    this->M.Options.Handedness *
      SixVolumes([&](int c) -> const Eigen::Vector3d& { return this->Points[Corner(cell, c)]; }) <=
    0.0 &&
    this->IsRegular(cell);
}

bool ClipWorker::IsRegular(const Cell& cell) const
{
  constexpr double Narrowest = 0.1;
  constexpr double Degenerate = 0.05;
  if (this->Width(cell) <= Narrowest * this->M.Options.Tolerance)
  {
    return false;
  }
  const Range jacobians = this->Jacobians(cell);
  return jacobians.Low > Degenerate * jacobians.High;
}

bool ClipWorker::IsFolded(const Cell& cell) const
{
  constexpr double Rounding = 1e-9;
  const Range jacobians = this->Jacobians(cell);
  return jacobians.Low < -Rounding * jacobians.High;
}

Range ClipWorker::Jacobians(const Cell& cell) const
{
  const auto corners = this->Simplices->Parameters(cell);
  Eigen::Matrix<double, 3, 5> u;
  for (int c = 0; c < 4; ++c)
  {
    u.col(c) = corners[static_cast<std::size_t>(c)].Values;
  }
  constexpr std::array<double, 4> Quarter{ 0.25, 0.25, 0.25, 0.25 };
  const FreeParameters centre = Between(corners.data(), Quarter.data(), 4);
  u.col(4) = centre.Values;
  Eigen::Matrix<double, 3, 5> x;
  Eigen::Matrix<double, 3, 15> derivatives;
  this->M.Body->Geometry()->Evaluator().EvaluateWithDerivatives(
    5, u.data(), x.data(), derivatives.data());
  Range range{ INFINITY, -INFINITY };
  for (int i = 0; i < 5; ++i)
  {
    // In homogeneous coordinates: det J itself goes to 0 towards a pole.
    const double weight =
      (i < 4 ? corners[static_cast<std::size_t>(i)].Weights : centre.Weights).prod();
    const double jacobian =
      this->M.Options.Handedness * derivatives.middleCols<3>(3 * i).determinant() / weight;
    if (weight == 0.0)
    {
      continue;
    }
    range = { std::min(range.Low, jacobian), std::max(range.High, jacobian) };
  }
  return range;
}

}
