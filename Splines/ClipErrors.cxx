// SPDX-License-Identifier: BSD-3-Clause
// How wrong linear interpolation in the simplices of a clip is.
#include "ClipWorker.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

namespace hyperpatch
{

namespace
{

/// The largest error of linear interpolation of something quadratic in a simplex, from those at the
/// middles of its edges (in the order of SimplexRefinement::Edges): there, or in the middle of a
/// face, or in that of the simplex.
template <typename Vector, typename Norm>
double LargestError(const Vector* edges, int dimension, const Norm& norm)
{
  double largest = 0.0;
  for (int e = 0; e < SimplexRefinement::NumberOfEdges(dimension); ++e)
  {
    largest = std::max(largest, norm(edges[e]));
  }
  if (dimension >= 2)
  {
    // Faces 012, 013, 023, 123.
    static constexpr int Faces[4][3] = { { 0, 1, 2 }, { 0, 3, 4 }, { 1, 3, 5 }, { 2, 4, 5 } };
    for (int f = 0; f < (dimension == 3 ? 4 : 1); ++f)
    {
      const Vector sum = edges[Faces[f][0]] + edges[Faces[f][1]] + edges[Faces[f][2]];
      largest = std::max(largest, 4.0 / 9.0 * norm(sum));
    }
  }
  if (dimension == 3)
  {
    const Vector sum = edges[0] + edges[1] + edges[2] + edges[3] + edges[4] + edges[5];
    largest = std::max(largest, 0.25 * norm(sum));
  }
  return largest;
}

}

void ClipWorker::Error::Add(double largest, const std::array<double, 6>& edges)
{
  this->Largest = std::max(this->Largest, largest);
  for (std::size_t e = 0; e < 6; ++e)
  {
    this->Edges[e] = std::max(this->Edges[e], edges[e]);
  }
}

ClipWorker::Bound ClipWorker::BoundError(const Cell& cell) const
{
  const auto& axes = this->B->Axes();
  const std::array<int, 3> size{ axes[0].Cells(), axes[1].Cells(), axes[2].Cells() };
  const std::array<int, 3> element{ cell.Root % size[0], cell.Root / size[0] % size[1],
    cell.Root / (size[0] * size[1]) };
  const int dimension = this->Simplices->Dimension();
  const int edges = SimplexRefinement::NumberOfEdges(dimension);
  // In the parameters of the element.
  const auto corners = this->Simplices->Parameters(cell);
  std::array<double, 3> scales{};
  std::array<double, 3> widths{};
  for (std::size_t d = 0; d < 3; ++d)
  {
    scales[d] = axes[d].Breaks[static_cast<std::size_t>(element[d]) + 1] -
      axes[d].Breaks[static_cast<std::size_t>(element[d])];
    double low = INFINITY;
    double high = -INFINITY;
    for (std::size_t c = 0; c <= static_cast<std::size_t>(dimension); ++c)
    {
      low = std::min(low, corners[c].Values[static_cast<Eigen::Index>(d)] / scales[d]);
      high = std::max(high, corners[c].Values[static_cast<Eigen::Index>(d)] / scales[d]);
    }
    widths[d] = high - low;
  }
  // Towards a collapsed side the bend along it goes to 0; that of the element is the largest.
  Eigen::Vector3d shares = Eigen::Vector3d::Zero();
  for (std::size_t c = 0; c <= static_cast<std::size_t>(dimension); ++c)
  {
    shares = shares.cwiseMax(corners[c].Weights);
  }
  const double jump = this->Jump(cell);
  Bound all;
  const BendBounds::Bend* bends = this->B->Of(cell.Root);
  for (std::size_t k = 0; k < this->Tolerances.size(); ++k)
  {
    const BendBounds::Bend& bend = bends[k];
    const double error =
      BendBounds::LinearError(bend, widths) / this->Tolerances[k] + (k == 0 ? 0.0 : jump);
    double& largest = k == 0 ? all.Position : all.Attribute;
    largest = std::max(largest, error);
    if (error <= 1.0)
    {
      continue;
    }
    all.IsCertain = false;
    // What an edge that runs along no direction adds is left to measurement.
    const BendBounds::Bend pure{ shares[0] * bend[0], 0.0, 0.0, shares[1] * bend[3], 0.0,
      shares[2] * bend[5] };
    if (BendBounds::LinearError(pure, widths) <= this->Tolerances[k])
    {
      continue;
    }
    all.IsCoarse = true;
    for (int e = 0; e < edges; ++e)
    {
      std::array<FreeParameters, 2> ends{ this->Simplices->At(static_cast<int>(End(cell, e, 0))),
        this->Simplices->At(static_cast<int>(End(cell, e, 1))) };
      FillFree(ends.data(), 2);
      const Eigen::Vector3d along = ends[1].Values - ends[0].Values;
      double& own = all.Edges[static_cast<std::size_t>(e)];
      own = std::max(own,
        BendBounds::LinearError(
          pure, { along[0] / scales[0], along[1] / scales[1], along[2] / scales[2] }) /
          this->Tolerances[k]);
    }
  }
  return all;
}

ClipWorker::Error ClipWorker::PositionError(const Cell& cell) const
{
  const int dimension = this->Simplices->Dimension();
  std::array<Eigen::Vector3d, 6> errors;
  std::array<double, 6> norms{};
  for (int e = 0; e < SimplexRefinement::NumberOfEdges(dimension); ++e)
  {
    const auto at = static_cast<std::size_t>(e);
    errors[at] = (this->Points[Middle(cell, e)] -
                   0.5 * (this->Points[End(cell, e, 0)] + this->Points[End(cell, e, 1)])) /
      this->M.Options.Tolerance;
    norms[at] = errors[at].norm();
  }
  return {
    LargestError(errors.data(), dimension, [](const Eigen::Vector3d& x) { return x.norm(); }), norms
  };
}

ClipWorker::Error ClipWorker::AttributeError(const Cell& cell) const
{
  const int dimension = this->Simplices->Dimension();
  Error error;
  error.Largest = this->Jump(cell);
  for (std::size_t a = 0; a < this->M.Options.AttributeTolerances.size(); ++a)
  {
    const double tolerance = this->M.Options.AttributeTolerances[a];
    const auto components =
      static_cast<std::size_t>(this->M.Body->Attributes()[a]->Spline().Components());
    const std::vector<double>& values = this->Attributes[a];
    for (std::size_t c = 0; c < components && tolerance > 0.0; ++c)
    {
      const auto at = [&values, components, c](std::size_t node)
      { return values[components * node + c]; };
      std::array<double, 6> differences{};
      std::array<double, 6> magnitudes{};
      for (int e = 0; e < SimplexRefinement::NumberOfEdges(dimension); ++e)
      {
        const double difference =
          at(Middle(cell, e)) - 0.5 * (at(End(cell, e, 0)) + at(End(cell, e, 1)));
        differences[static_cast<std::size_t>(e)] = difference / tolerance;
        magnitudes[static_cast<std::size_t>(e)] = std::abs(difference) / tolerance;
      }
      error.Add(LargestError(differences.data(), dimension, [](double x) { return std::abs(x); }),
        magnitudes);
    }
  }
  return error;
}

ClipWorker::Error ClipWorker::CutError(const Cell& cell, std::size_t field) const
{
  // At a point of the interpolant's zero set, f is the error e of interpolating f, but for what
  // the point in space is off by: its distance from f = 0 is |s| / |g| to first order, with s = e -
  // g . (error of the position) and the gradient g of the interpolant in space. s is 0 at corners
  // and taken for quadratic.
  const int dimension = this->Simplices->Dimension();
  const int edges = SimplexRefinement::NumberOfEdges(dimension);
  const std::vector<double>& values = this->Values[field];
  Eigen::MatrixXd sides(dimension, 3);
  Eigen::VectorXd differences(dimension);
  for (int c = 1; c <= dimension; ++c)
  {
    sides.row(c - 1) = (this->Points[Corner(cell, c)] - this->Points[Corner(cell, 0)]).transpose();
    differences[c - 1] = values[Corner(cell, c)] - values[Corner(cell, 0)];
  }
  const Eigen::VectorXd gradient = sides.completeOrthogonalDecomposition().solve(differences);
  const double scale = 1.0 / (gradient.norm() * this->M.Options.Tolerance);
  std::array<double, 6> s{};
  std::array<double, 6> magnitudes{};
  double error = 0.0;
  std::array<Eigen::Vector4d, 6> cut; // barycentric coordinates of points of the cut
  std::size_t cuts = 0;
  for (int e = 0; e < edges; ++e)
  {
    const std::size_t a = End(cell, e, 0);
    const std::size_t b = End(cell, e, 1);
    const std::size_t m = Middle(cell, e);
    const double chord = values[m] - 0.5 * (values[a] + values[b]);
    s[static_cast<std::size_t>(e)] =
      chord - gradient.dot(this->Points[m] - 0.5 * (this->Points[a] + this->Points[b]));
    magnitudes[static_cast<std::size_t>(e)] = std::abs(s[static_cast<std::size_t>(e)]) * scale;
    if (values[a] * values[b] < 0.0)
    {
      Eigen::Vector4d& at = cut[cuts++];
      at.setZero();
      at[SimplexRefinement::Edges[e][0]] = values[b] / (values[b] - values[a]);
      at[SimplexRefinement::Edges[e][1]] = values[a] / (values[a] - values[b]);
    }
    else if (values[m] * (values[a] + values[b]) < 0.0)
    {
      // Through the edge and back.
      error = std::max(error, std::abs(values[m]) * scale);
    }
  }
  const auto at = [&s, edges](const Eigen::Vector4d& place)
  {
    double sum = 0.0;
    for (int e = 0; e < edges; ++e)
    {
      sum += 4.0 * place[SimplexRefinement::Edges[e][0]] * place[SimplexRefinement::Edges[e][1]] *
        s[static_cast<std::size_t>(e)];
    }
    return sum;
  };
  // The corners of the cut are exact whatever s is there.
  Eigen::Vector4d centre = Eigen::Vector4d::Zero();
  double mean = 0.0;
  for (std::size_t i = 0; i < cuts; ++i)
  {
    centre += cut[i] / static_cast<double>(cuts);
    mean += at(cut[i]) / static_cast<double>(cuts);
    for (std::size_t j = 0; j < i; ++j)
    {
      const double chord = at(0.5 * (cut[i] + cut[j])) - 0.5 * (at(cut[i]) + at(cut[j]));
      error = std::max(error, std::abs(chord) * scale);
    }
  }
  if (cuts > 0)
  {
    error = std::max(error, std::abs(at(centre) - mean) * scale);
  }
  return { std::isnan(error) ? 0.0 : error, magnitudes };
}

}
