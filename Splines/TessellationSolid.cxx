// SPDX-License-Identifier: BSD-3-Clause
#include "TessellationWorker.h"

#include "Error.h"
#include "Evaluator.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace hyperpatch
{

using namespace tessellation;

namespace
{

/// Segments of every cell along each direction of a volume, so that trilinear interpolation is
/// within the tolerances: sum of h_d^2 M_dd / 8 in every element.
std::array<std::vector<int>, 3> SolidSegments(
  const Domain& domain, const TessellationOptions& options, bool& limited)
{
  const std::size_t fields = domain.NumberOfBounds;
  const auto& axes = domain.Axes;
  const std::array<std::ptrdiff_t, 3> cells{ axes[0].Cells(), axes[1].Cells(), axes[2].Cells() };
  const std::ptrdiff_t count = cells[0] * cells[1] * cells[2];
  const auto triple = [&](std::ptrdiff_t c)
  {
    return std::array<int, 3>{ static_cast<int>(c % cells[0]),
      static_cast<int>(c / cells[0] % cells[1]), static_cast<int>(c / (cells[0] * cells[1])) };
  };
  std::vector<std::array<double, 3>> bends(static_cast<std::size_t>(count) * fields);
  options.For(count, 32,
    [&](std::ptrdiff_t begin, std::ptrdiff_t end)
    {
      ChordBound bound;
      Eigen::MatrixXd points;
      for (std::ptrdiff_t c = begin; c < end; ++c)
      {
        std::array<double, 3>* bend = bends.data() + static_cast<std::size_t>(c) * fields;
        for (const Domain::Measured& field : domain.Fields)
        {
          const Spline& spline = domain.Splines[field.Index];
          domain.Extract(field, triple(c), points);
          const double scale = 1.0 / (8.0 * field.Tolerance);
          for (const ChordBound::Bound& b :
            bound(points, spline.Degrees(), spline.IsRational(), field.Norm, Halvings[2]))
          {
            *bend++ = { scale * b.Second[0], scale * b.Second[3], scale * b.Second[5] };
          }
        }
      }
    });
  // First what each direction needs by itself; then all layers of an element are refined together
  // by what it still lacks. Both steps take maxima, so that no order of elements matters.
  std::array<std::vector<double>, 3> needed;
  for (std::size_t d = 0; d < 3; ++d)
  {
    needed[d].assign(static_cast<std::size_t>(cells[d]), 1.0);
  }
  const auto forAll = [&](const auto& body)
  {
    for (std::ptrdiff_t c = 0; c < count; ++c)
    {
      const auto cell = triple(c);
      for (std::size_t k = 0; k < fields; ++k)
      {
        body(cell, bends[static_cast<std::size_t>(c) * fields + k]);
      }
    }
  };
  forAll(
    [&](const std::array<int, 3>& cell, const std::array<double, 3>& bend)
    {
      for (std::size_t d = 0; d < 3; ++d)
      {
        double& n = needed[d][static_cast<std::size_t>(cell[d])];
        n = std::max(n, std::sqrt(bend[d]));
      }
    });
  const auto alone = needed;
  forAll(
    [&](const std::array<int, 3>& cell, const std::array<double, 3>& bend)
    {
      double sum = 0.0;
      for (std::size_t d = 0; d < 3; ++d)
      {
        const double n = alone[d][static_cast<std::size_t>(cell[d])];
        sum += bend[d] / (n * n);
      }
      for (std::size_t d = 0; d < 3 && sum > 1.0; ++d)
      {
        const auto slab = static_cast<std::size_t>(cell[d]);
        if (bend[d] > 0.0)
        {
          needed[d][slab] = std::max(needed[d][slab], alone[d][slab] * std::sqrt(sum));
        }
      }
    });
  std::array<std::vector<int>, 3> segments;
  for (std::size_t d = 0; d < 3; ++d)
  {
    for (double n : needed[d])
    {
      segments[d].push_back(Count(n, options.MaximumSubdivision, limited));
    }
  }
  return segments;
}

/// The tensor grid that hexahedra are made of.
struct SolidGrid
{
  std::array<std::vector<double>, 3> Lines; ///< ascending parameters
  /// Per layer between lines: the non-empty knot span of the geometry, counted in this part.
  std::array<std::vector<int>, 3> Spans;
  bool LimitReached = false;
};

SolidGrid MakeGrid(const Domain& domain, const TessellationOptions& options)
{
  SolidGrid grid;
  const auto segments = SolidSegments(domain, options, grid.LimitReached);
  for (std::size_t d = 0; d < 3; ++d)
  {
    const ElementAxis& axis = domain.Axes[d];
    grid.Lines[d].push_back(axis.Breaks.front());
    for (int c = 0; c < axis.Cells(); ++c)
    {
      const int n = segments[d][static_cast<std::size_t>(c)];
      for (int k = 1; k <= n; ++k)
      {
        grid.Lines[d].push_back(axis.At(c, static_cast<double>(k) / n));
        grid.Spans[d].push_back(axis.Spans[0][static_cast<std::size_t>(c)]);
      }
    }
  }
  return grid;
}

}

SolidMesh TessellateSolid(const Patch& patch, int handedness, const TessellationOptions& options)
{
  Check(patch, handedness, options);
  const Aggregate& body = patch.Body;
  if (DirectionsWithDegree(body.Geometry()).size() != 3)
  {
    throw Error("hexahedra need a volume; this patch has " +
      std::to_string(body.Geometry().Dimension()) +
      " parametric dimensions: tessellate its surface instead");
  }
  const Domain domain(SplinesOf(body), options);
  SolidMesh mesh;
  const SolidGrid grid = MakeGrid(domain, options);
  mesh.LimitReached = grid.LimitReached;
  const auto& lines = grid.Lines;
  const auto nu = static_cast<Id>(lines[0].size());
  const auto nv = static_cast<Id>(lines[1].size());
  const auto nw = static_cast<Id>(lines[2].size());
  mesh.Parameters.resize(3, nu * nv * nw);
  mesh.Points.setZero(3, nu * nv * nw);
  for (std::size_t s = 1; s < domain.Splines.size(); ++s)
  {
    mesh.Attributes.emplace_back(domain.Splines[s].Components(), nu * nv * nw);
  }
  const Evaluator geometry(domain.Splines[0]);
  std::vector<Evaluator> attributes;
  for (std::size_t s = 1; s < domain.Splines.size(); ++s)
  {
    attributes.emplace_back(domain.Splines[s]);
  }
  options.For(nw, 1,
    [&](std::ptrdiff_t begin, std::ptrdiff_t end)
    {
      const Id first = begin * nu * nv;
      Id id = first;
      for (std::ptrdiff_t k = begin; k < end; ++k)
      {
        for (double v : lines[1])
        {
          for (double u : lines[0])
          {
            mesh.Parameters.col(id++) << u, v, lines[2][static_cast<std::size_t>(k)];
          }
        }
      }
      const std::array<std::vector<double>, 3> layers{ lines[0], lines[1],
        { lines[2].begin() + begin, lines[2].begin() + end } };
      Eigen::MatrixXd values(geometry.Components(), id - first);
      geometry.EvaluateGrid(layers, values.data());
      mesh.Points.block(0, first, values.rows(), values.cols()) = values;
      for (std::size_t a = 0; a < attributes.size(); ++a)
      {
        attributes[a].EvaluateGrid(layers, mesh.Attributes[a].col(first).data());
      }
    });

  const Id hexahedra = (nu - 1) * (nv - 1) * (nw - 1);
  mesh.Hexahedra.resize(8, hexahedra);
  mesh.Elements.resize(3, hexahedra);
  // A mirrored patch has its lower and upper quadrilaterals exchanged.
  const Id lower = handedness > 0 ? 0 : nu * nv;
  const Id upper = nu * nv - lower;
  options.For(nw - 1, 1,
    [&](std::ptrdiff_t begin, std::ptrdiff_t end)
    {
      Id id = begin * (nu - 1) * (nv - 1);
      for (Id k = begin; k < end; ++k)
      {
        for (Id j = 0; j + 1 < nv; ++j)
        {
          for (Id i = 0; i + 1 < nu; ++i, ++id)
          {
            const Id p = i + nu * (j + nv * k);
            mesh.Hexahedra.col(id) << p + lower, p + 1 + lower, p + 1 + nu + lower, p + nu + lower,
              p + upper, p + 1 + upper, p + 1 + nu + upper, p + nu + upper;
            mesh.Elements.col(id) << patch.FirstSpan[0] +
                grid.Spans[0][static_cast<std::size_t>(i)],
              patch.FirstSpan[1] + grid.Spans[1][static_cast<std::size_t>(j)],
              patch.FirstSpan[2] + grid.Spans[2][static_cast<std::size_t>(k)];
          }
        }
      }
    });
  return mesh;
}

}
