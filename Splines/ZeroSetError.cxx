// SPDX-License-Identifier: BSD-3-Clause
#include "ZeroSetWorker.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <mutex>

namespace hyperpatch
{

namespace
{

Eigen::Vector3d ClosestOnSegment(
  const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b, double& t)
{
  const Eigen::Vector3d ab = b - a;
  const double square = ab.squaredNorm();
  t = square > 0.0 ? std::clamp((p - a).dot(ab) / square, 0.0, 1.0) : 0.0;
  return a + t * ab;
}

}

void ZeroSet::Worker::Want(
  const Cell& at, double factor, std::array<std::vector<int>, 3>& wanted, bool& reached) const
{
  // Divide where the cell is long: its extent in physical space, along each direction.
  std::array<double, 3> extent{};
  double longest = 0.0;
  Eigen::Vector3d low;
  Eigen::Vector3d high;
  for (int d = 0; d < 3; ++d)
  {
    const auto D = static_cast<std::size_t>(d);
    low[d] = this->Line(d, at[D]);
    high[d] = at[D] + 1 < this->Counts[D] ? this->Line(d, at[D] + 1) : low[d];
  }
  const Eigen::Vector3d middle = 0.5 * (low + high);
  for (int d : this->Axes)
  {
    Eigen::Matrix3d ends;
    ends.col(0) = ends.col(1) = ends.col(2) = middle;
    ends(d, 0) = low[d];
    ends(d, 2) = high[d];
    const int m = this->Geometry.Components();
    Eigen::MatrixXd points(m, 3);
    this->Geometry.Evaluate(3, ends.data(), points.data());
    const double length =
      (points.col(1) - points.col(0)).norm() + (points.col(2) - points.col(1)).norm();
    extent[static_cast<std::size_t>(d)] = length;
    longest = std::max(longest, length);
  }
  for (int d : this->Axes)
  {
    const auto D = static_cast<std::size_t>(d);
    if (extent[D] < 0.4 * longest)
    {
      continue;
    }
    const auto b = static_cast<std::size_t>(this->Interval(d, at[D]));
    const int now = this->Grid.Counts[D][b];
    const int then = std::min(this->Options.MaximumSubdivision,
      std::max(now + 1, static_cast<int>(std::ceil(now * std::min(factor, 4.0)))));
    reached = reached && then > now;
    wanted[D][b] = std::max(wanted[D][b], then);
  }
}

void ZeroSet::Worker::MeasureCells(Index begin, Index end, ZeroSetCertificate& certificate,
  std::array<std::vector<int>, 3>& wanted) const
{
  const int axes = static_cast<int>(this->Axes.size());
  const int m = this->Geometry.Components();
  // Samples per cell: midpoints of its edges and, for a triangle, its centre.
  const int samples = axes == 3 ? 4 : 1;
  const Index count = (end - begin) * samples;
  Eigen::Matrix3Xd at(3, count);
  Eigen::Matrix3Xd step(3, count); ///< squared cell size where the sample may move, 0 where not
  std::vector<char> onCrease(static_cast<std::size_t>(count), 0);
  for (Index c = begin; c < end; ++c)
  {
    const Cell& cell = this->CellOfPiece[static_cast<std::size_t>(c)];
    for (int s = 0; s < samples; ++s)
    {
      const Index q = (c - begin) * samples + s;
      const Eigen::Vector3d a = this->Mesh.Parameters.col(this->Mesh.Cells(s % axes, c));
      const Eigen::Vector3d b = this->Mesh.Parameters.col(this->Mesh.Cells((s + 1) % axes, c));
      const bool centre = s == 3;
      at.col(q) = centre
        ? Eigen::Vector3d(
            (a + b + Eigen::Vector3d(this->Mesh.Parameters.col(this->Mesh.Cells(2, c)))) / 3.0)
        : Eigen::Vector3d(0.5 * (a + b));
      for (int d = 0; d < 3; ++d)
      {
        const auto D = static_cast<std::size_t>(d);
        const bool there = !this->Grid.Counts[D].empty();
        const double low = this->Line(d, cell[D]);
        const double high = there ? this->Line(d, cell[D] + 1) : low;
        const double h = high - low;
        // An edge in a plane of the grid belongs to the cells on both sides: stay in the plane.
        const bool locked = !centre && a[d] == b[d] && (a[d] == low || a[d] == high);
        step(d, q) = locked ? 0.0 : h * h;
        const auto& creases = this->Creases[D];
        if (there && locked && std::find(creases.begin(), creases.end(), a[d]) != creases.end())
        {
          onCrease[static_cast<std::size_t>(q)] = 1;
        }
      }
    }
  }
  std::vector<double> values(static_cast<std::size_t>(count));
  Eigen::Matrix3Xd gradients(3, count);
  for (int iteration = 0; iteration < 2; ++iteration)
  {
    this->Field.EvaluateWithGradient(
      static_cast<std::size_t>(count), at.data(), values.data(), gradients.data());
    for (Index q = 0; q < count; ++q)
    {
      const Eigen::Vector3d direction = step.col(q).cwiseProduct(gradients.col(q));
      const double slope = direction.dot(gradients.col(q));
      Eigen::Vector3d move = Eigen::Vector3d::Zero();
      if (slope > 0.0 && values[static_cast<std::size_t>(q)] != 0.0)
      {
        move = -values[static_cast<std::size_t>(q)] / slope * direction;
        // Further than the cell is wide is no step of Newton's but noise at a singular point.
        if ((move.array().square() > step.col(q).array()).any())
        {
          move.setZero();
        }
      }
      at.col(q) += move;
      for (int d : this->Axes)
      {
        const KnotVector& knots = this->Body.Geometry().Knots(d);
        at(d, q) = std::clamp(at(d, q), knots.First(), knots.Last());
      }
    }
  }
  Eigen::MatrixXd exact(m, count);
  this->Geometry.Evaluate(static_cast<std::size_t>(count), at.data(), exact.data());
  std::vector<Eigen::MatrixXd> attributes(this->Attributes.size());
  for (std::size_t a = 0; a < attributes.size(); ++a)
  {
    if (this->Options.AttributeTolerances[a] > 0.0)
    {
      attributes[a].resize(this->Attributes[a]->Components(), count);
      this->Attributes[a]->Evaluate(
        static_cast<std::size_t>(count), at.data(), attributes[a].data());
    }
  }
  for (Index c = begin; c < end; ++c)
  {
    double worst = 0.0; // of errors over tolerances
    for (int s = 0; s < samples; ++s)
    {
      const Index q = (c - begin) * samples + s;
      Eigen::Vector3d p = Eigen::Vector3d::Zero();
      p.head(m) = exact.col(q);
      const auto corner = [&](int k)
      { return Eigen::Vector3d(this->Mesh.Points.col(this->Mesh.Cells(k % axes, c))); };
      // Nearest point of the edge that the sample belongs to; of any edge in a sliver, whose plane
      // says nothing; of the triangle's plane otherwise, unless the mesh ends or bends at the edge.
      Eigen::Vector3d weights = Eigen::Vector3d::Zero();
      double error = INFINITY;
      const auto tryEdge = [&](int k)
      {
        double t = 0.0;
        const double distance = (p - ClosestOnSegment(p, corner(k), corner(k + 1), t)).norm();
        if (distance < error)
        {
          error = distance;
          weights.setZero();
          weights[k % axes] += 1.0 - t;
          weights[(k + 1) % axes] += t;
        }
      };
      const bool atCrease = onCrease[static_cast<std::size_t>(q)] != 0;
      if (axes == 2 || atCrease)
      {
        tryEdge(s);
      }
      else
      {
        const Eigen::Vector3d e1 = corner(1) - corner(0);
        const Eigen::Vector3d e2 = corner(2) - corner(0);
        const Eigen::Vector3d normal = e1.cross(e2);
        const double square = normal.squaredNorm();
        const double longest =
          std::max({ e1.squaredNorm(), e2.squaredNorm(), (e2 - e1).squaredNorm() });
        if (square > 1e-12 * longest * longest)
        {
          const Eigen::Vector3d r = p - corner(0);
          error = std::abs(r.dot(normal)) / std::sqrt(square);
          weights[1] = r.cross(e2).dot(normal) / square;
          weights[2] = e1.cross(r).dot(normal) / square;
          weights[0] = 1.0 - weights[1] - weights[2];
        }
        else
        {
          tryEdge(0);
          tryEdge(1);
          tryEdge(2);
        }
      }
      Eigen::Vector3d sameParameters = Eigen::Vector3d::Zero();
      for (int k = 0; k < axes; ++k)
      {
        const bool ofEdge = k == s % axes || k == (s + 1) % axes;
        sameParameters[k] = s == 3 ? 1.0 / 3.0 : ofEdge ? 0.5 : 0.0;
      }
      Eigen::Vector3d meshPoint = Eigen::Vector3d::Zero();
      for (int k = 0; k < axes; ++k)
      {
        meshPoint += sameParameters[k] * corner(k);
      }
      const double displacement = (p - meshPoint).norm();
      const auto attributeError = [&attributes, this, c, axes](
                                    std::size_t a, const Eigen::Vector3d& at_, Index sample)
      {
        double largest = 0.0;
        for (Eigen::Index e = 0; e < attributes[a].rows(); ++e)
        {
          double difference = attributes[a](e, sample);
          for (int k = 0; k < axes; ++k)
          {
            difference -= at_[k] * this->Mesh.Attributes[a](e, this->Mesh.Cells(k, c));
          }
          largest = std::max(largest, std::abs(difference));
        }
        return largest;
      };
      certificate.LargestError = std::max(certificate.LargestError, error);
      worst = std::max(worst, error / this->Options.Tolerance);
      for (std::size_t a = 0; a < attributes.size(); ++a)
      {
        const double tolerance = this->Options.AttributeTolerances[a];
        if (!(tolerance > 0.0))
        {
          continue;
        }
        // Against the linear value at the nearest point of the mesh; where a fold makes that
        // another branch of the map, at the mesh point of the same parameters, if that is near.
        double ratio = attributeError(a, weights, q) / tolerance;
        if (ratio > 1.0 && displacement <= this->Options.Tolerance)
        {
          ratio = std::min(ratio, attributeError(a, sameParameters, q) / tolerance);
        }
        certificate.LargestAttributeError = std::max(certificate.LargestAttributeError, ratio);
        worst = std::max(worst, ratio);
      }
    }
    if (worst > 1.0)
    {
      // Errors fall with the square of the cell size.
      this->Want(this->CellOfPiece[static_cast<std::size_t>(c)], 1.05 * std::sqrt(worst), wanted,
        certificate.ToleranceReached);
    }
  }
}

bool ZeroSet::Worker::MeasureErrors()
{
  if (this->Axes.size() < 2)
  {
    return true;
  }
  std::mutex mutex;
  return this->Parallel(static_cast<Index>(this->CellOfPiece.size()), Batch / 4,
    [&](Index begin, Index end)
    {
      ZeroSetCertificate certificate;
      std::array<std::vector<int>, 3> wanted = this->Grid.Counts;
      this->MeasureCells(begin, end, certificate, wanted);
      // Only maxima are merged, so the order of the chunks does not matter.
      const std::lock_guard<std::mutex> lock(mutex);
      this->Certificate.Add(certificate);
      for (std::size_t d = 0; d < 3; ++d)
      {
        for (std::size_t b = 0; b < wanted[d].size(); ++b)
        {
          this->Wanted[d][b] = std::max(this->Wanted[d][b], wanted[d][b]);
        }
      }
    });
}

}
