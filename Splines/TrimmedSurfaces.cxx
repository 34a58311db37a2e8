// SPDX-License-Identifier: BSD-3-Clause
#include "TrimmedSurfaces.h"

#include "SimplexCutWorker.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <tuple>
#include <utility>

namespace hyperpatch
{

namespace
{

using Index = SimplexCut::Index;

/// Points on the line of two zero sets that are nearer than this, as a share of its length, become
/// one.
constexpr double Near = 1e-9;

/// A trimmed surface under work.
struct Surface
{
  std::vector<Eigen::Vector3d> Parameters, Points, Normals;
  std::vector<unsigned> On;
  std::vector<std::array<Index, 3>> Cells;
  std::vector<Eigen::Index> Origins; ///< per cell, that of the surface before
};

bool Trim(const std::shared_ptr<const PreparedAggregate>& body,
  const std::vector<std::shared_ptr<const ScalarField>>& fields, std::size_t field,
  const ZeroSetMesh& mesh, const ParallelFor& parallel, const std::function<bool()>& abort,
  Surface& surface)
{
  const auto corners = static_cast<std::size_t>(mesh.Cells.rows());
  SimplexCut cut(body, fields, static_cast<int>(corners) - 1);
  for (Eigen::Index i = 0; i < mesh.Points.cols(); ++i)
  {
    cut.AddPoint(FreeParameters{ mesh.Parameters.col(i) }, mesh.Points.col(i), 1u << field);
    surface.Normals.emplace_back(mesh.Normals.col(i));
  }
  for (Eigen::Index c = 0; c < mesh.Cells.cols(); ++c)
  {
    SimplexCut::Cell cell{ {}, c, 0 };
    std::copy_n(mesh.Cells.col(c).data(), corners, cell.Corners.begin());
    cut.AddCell(cell);
  }
  for (std::size_t other = 0; other < fields.size(); ++other)
  {
    if (other != field && !cut.Cut(static_cast<int>(other), false, parallel, abort))
    {
      return false;
    }
  }
  surface.Parameters = cut.Parameters();
  surface.Points = cut.Points();
  surface.On = cut.On();
  for (std::size_t i = surface.Normals.size(); i < surface.Points.size(); ++i)
  {
    const auto& ends = cut.Between()[i];
    surface.Normals.push_back((surface.Normals[static_cast<std::size_t>(ends[0])] +
      surface.Normals[static_cast<std::size_t>(ends[1])])
                                .normalized());
  }
  for (const SimplexCut::Cell& cell : cut.Cells())
  {
    surface.Cells.push_back({ cell.Corners[0], cell.Corners[1], cell.Corners[2] });
    surface.Origins.push_back(cell.Origin);
  }
  return true;
}

/// A place on a line in which two surfaces meet: the point that both have there.
struct Place
{
  Eigen::Vector3d Parameter, Point;
  unsigned On;
};

/// Splits the triangles along the line at the places between the ends of their edges.
void Insert(const std::vector<Place>& places, const std::vector<int>& rankOf, Surface& surface)
{
  const auto rank = [&rankOf](Index i)
  { return i < static_cast<Index>(rankOf.size()) ? rankOf[static_cast<std::size_t>(i)] : -1; };
  std::map<std::pair<int, Index>, Index> pointAt; ///< by place, and end of its edge
  const std::size_t count = surface.Cells.size();
  for (std::size_t k = 0; k < count; ++k)
  {
    for (std::size_t c = 0; c < 3; ++c)
    {
      const Index a = surface.Cells[k][c];
      const Index b = surface.Cells[k][(c + 1) % 3];
      const int from = rank(a);
      const int to = rank(b);
      if (from < 0 || to < 0 || std::abs(from - to) < 2)
      {
        continue;
      }
      // A fan from the third corner, from a to b.
      const int step = from < to ? 1 : -1;
      for (int r = from + step; r != to; r += step)
      {
        const auto [at, isNew] =
          pointAt.insert({ { r, std::min(a, b) }, static_cast<Index>(surface.Points.size()) });
        if (isNew)
        {
          const Place& place = places[static_cast<std::size_t>(r)];
          surface.Parameters.push_back(place.Parameter);
          surface.Points.push_back(place.Point);
          surface.Normals.push_back(surface.Normals[static_cast<std::size_t>(a)]);
          surface.On.push_back(place.On);
        }
        std::array<Index, 3> part = surface.Cells[k];
        part[(c + 1) % 3] = at->second;
        surface.Cells.push_back(part);
        surface.Origins.push_back(surface.Origins[k]);
        surface.Cells[k][c] = at->second;
      }
      break;
    }
  }
}

/// Gives both surfaces the points that either has on the line in which they meet.
void Stitch(std::array<Surface*, 2> surfaces, unsigned line, std::size_t corners)
{
  struct Found
  {
    double At;
    std::size_t Surface;
    Index Point;
  };
  std::vector<Found> found;
  Eigen::AlignedBox3d bounds;
  std::array<std::vector<int>, 2> rankOf; ///< of points on the line: which place; -1
  for (std::size_t s = 0; s < 2; ++s)
  {
    rankOf[s].assign(surfaces[s]->Points.size(), -1);
    for (const auto& cell : surfaces[s]->Cells)
    {
      for (std::size_t c = 0; c < corners; ++c)
      {
        const auto i = static_cast<std::size_t>(cell[c]);
        if ((surfaces[s]->On[i] & line) == line && rankOf[s][i] < 0)
        {
          rankOf[s][i] = 0;
          bounds.extend(surfaces[s]->Points[i]);
          found.push_back({ 0.0, s, cell[c] });
        }
      }
    }
  }
  if (found.empty())
  {
    return;
  }
  // The line is a diagonal of the bounds; which one, the farthest point tells.
  const Eigen::Vector3d& first =
    surfaces[found[0].Surface]->Points[static_cast<std::size_t>(found[0].Point)];
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
  for (const Found& f : found)
  {
    const Eigen::Vector3d side =
      surfaces[f.Surface]->Points[static_cast<std::size_t>(f.Point)] - first;
    direction = side.norm() > direction.norm() ? side : direction;
  }
  direction.normalize();
  for (Found& f : found)
  {
    f.At = direction.dot(surfaces[f.Surface]->Points[static_cast<std::size_t>(f.Point)] - first);
  }
  std::sort(found.begin(), found.end(),
    [](const Found& a, const Found& b) {
      return std::make_tuple(a.At, a.Surface, a.Point) < std::make_tuple(b.At, b.Surface, b.Point);
    });

  std::vector<Place> places;
  const double near = Near * bounds.diagonal().norm();
  for (std::size_t begin = 0, end = 0; begin < found.size(); begin = end)
  {
    // The first surface has its way: where three meet, all take the point of the first of them.
    std::size_t chosen = begin;
    for (end = begin + 1; end < found.size() && found[end].At <= found[begin].At + near; ++end)
    {
      chosen = found[end].Surface < found[chosen].Surface ? end : chosen;
    }
    const Surface& own = *surfaces[found[chosen].Surface];
    const auto c = static_cast<std::size_t>(found[chosen].Point);
    places.push_back({ own.Parameters[c], own.Points[c], own.On[c] });
    for (std::size_t f = begin; f < end; ++f)
    {
      const auto i = static_cast<std::size_t>(found[f].Point);
      surfaces[found[f].Surface]->Parameters[i] = places.back().Parameter;
      surfaces[found[f].Surface]->Points[i] = places.back().Point;
      rankOf[found[f].Surface][i] = static_cast<int>(places.size()) - 1;
    }
  }
  for (std::size_t s = 0; s < 2 && corners == 3; ++s)
  {
    Insert(places, rankOf[s], *surfaces[s]);
  }
}

/// The surface as a mesh again, with the points that it uses.
ZeroSetMesh Assemble(const PreparedAggregate& body, const Surface& surface,
  const ZeroSetMesh& before, std::size_t corners)
{
  ZeroSetMesh mesh;
  std::vector<Index> numberOf(surface.Points.size(), -1);
  std::vector<std::size_t> used;
  mesh.Cells.resize(
    static_cast<Eigen::Index>(corners), static_cast<Eigen::Index>(surface.Cells.size()));
  mesh.Elements.resize(3, mesh.Cells.cols());
  for (std::size_t c = 0; c < surface.Cells.size(); ++c)
  {
    const auto at = static_cast<Eigen::Index>(c);
    mesh.Elements.col(at) = before.Elements.col(surface.Origins[c]);
    for (std::size_t i = 0; i < corners; ++i)
    {
      const auto point = static_cast<std::size_t>(surface.Cells[c][i]);
      if (numberOf[point] < 0)
      {
        numberOf[point] = static_cast<Index>(used.size());
        used.push_back(point);
      }
      mesh.Cells(static_cast<Eigen::Index>(i), at) = numberOf[point];
    }
  }
  const auto count = static_cast<Eigen::Index>(used.size());
  mesh.Parameters.resize(3, count);
  mesh.Points.resize(3, count);
  mesh.Normals.resize(3, count);
  for (Eigen::Index i = 0; i < count; ++i)
  {
    mesh.Parameters.col(i) = surface.Parameters[used[static_cast<std::size_t>(i)]];
    mesh.Points.col(i) = surface.Points[used[static_cast<std::size_t>(i)]];
    mesh.Normals.col(i) = surface.Normals[used[static_cast<std::size_t>(i)]];
  }
  for (const auto& attribute : body.Attributes())
  {
    Eigen::MatrixXd& values = mesh.Attributes.emplace_back(attribute->Spline().Components(), count);
    attribute->Evaluator().Evaluate(used.size(), mesh.Parameters.data(), values.data());
  }
  return mesh;
}

}

bool TrimToEachOther(const std::shared_ptr<const PreparedAggregate>& body,
  const std::vector<std::shared_ptr<const ScalarField>>& fields, std::vector<ZeroSetMesh>& surfaces,
  const ParallelFor& parallel, const std::function<bool()>& abort)
{
  std::vector<Surface> trimmed(fields.size());
  for (std::size_t k = 0; k < fields.size(); ++k)
  {
    if (!Trim(body, fields, k, surfaces[k], parallel, abort, trimmed[k]))
    {
      return false;
    }
  }
  const auto corners = static_cast<std::size_t>(body->Body().Geometry().Dimension());
  for (std::size_t i = 0; i < fields.size(); ++i)
  {
    for (std::size_t j = i + 1; j < fields.size(); ++j)
    {
      Stitch({ &trimmed[i], &trimmed[j] }, 1u << i | 1u << j, corners);
    }
  }
  for (std::size_t k = 0; k < fields.size(); ++k)
  {
    surfaces[k] = Assemble(*body, trimmed[k], surfaces[k], corners);
  }
  return !abort();
}

}
