// SPDX-License-Identifier: BSD-3-Clause
#include "Interfaces.h"

#include "Error.h"
#include "Operators.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <unordered_map>
#include <utility>

namespace hyperpatch
{

namespace
{

constexpr double ParameterTolerance = 1e-6;

bool IsThere(const KnotVector& knots)
{
  return knots.Degree() > 0;
}

/// The control net of one side: a lattice in the two directions that run along it.
struct SideNet
{
  std::array<int, 2> Directions; ///< along the side, ascending
  std::array<int, 2> Sizes;
  Eigen::MatrixXd Points;  ///< 3 x (n0 n1), first direction fastest, missing coordinates 0
  Eigen::VectorXd Weights; ///< 1 where polynomial

  [[nodiscard]] Eigen::Index Column(int i, int j) const
  {
    return i + static_cast<Eigen::Index>(this->Sizes[0]) * j;
  }
};

SideNet MakeSideNet(const Spline& spline, int side)
{
  const int normal = side / 2;
  SideNet net;
  net.Directions = { normal == 0 ? 1 : 0, normal == 2 ? 1 : 2 };
  const Spline face = ExtractFace(spline, side);
  const auto sizes = face.Sizes();
  net.Sizes = { sizes[static_cast<std::size_t>(net.Directions[0])],
    sizes[static_cast<std::size_t>(net.Directions[1])] };
  net.Points = Eigen::MatrixXd::Zero(3, face.NumberOfControlPoints());
  net.Points.topRows(face.Components()) = face.Coefficients();
  net.Weights = face.IsRational() ? Eigen::VectorXd(face.Weights())
                                  : Eigen::VectorXd::Ones(face.NumberOfControlPoints());
  return net;
}

/// True if all points coincide along one of the directions.
bool IsCollapsed(const SideNet& net, double distance)
{
  for (int d = 0; d < 2; ++d)
  {
    if (net.Sizes[static_cast<std::size_t>(d)] < 2)
    {
      continue;
    }
    bool collapsed = true;
    for (int j = 0; collapsed && j < net.Sizes[1]; ++j)
    {
      for (int i = 0; collapsed && i < net.Sizes[0]; ++i)
      {
        const Eigen::Index first = d == 0 ? net.Column(0, j) : net.Column(i, 0);
        collapsed = (net.Points.col(net.Column(i, j)) - net.Points.col(first)).norm() <= distance;
      }
    }
    if (collapsed)
    {
      return true;
    }
  }
  return false;
}

/// Agreement of two knot vectors, the second one possibly reversed, both scaled to [0, 1].
bool SameKnots(const KnotVector& a, const KnotVector& b, bool reversed)
{
  if (a.Degree() != b.Degree() || a.Size() != b.Size())
  {
    return false;
  }
  const double scaleA = a.Last() - a.First();
  const double scaleB = b.Last() - b.First();
  const int last = static_cast<int>(a.Knots().size()) - 1;
  for (int i = 0; i <= last; ++i)
  {
    const double u = (a[i] - a.First()) / scaleA;
    const double v = reversed ? (b.Last() - b[last - i]) / scaleB : (b[i] - b.First()) / scaleB;
    if (!(std::abs(u - v) <= ParameterTolerance))
    {
      return false;
    }
  }
  return true;
}

/// How net 2 lies on net 1: direction d of net 1 runs along d or, if swapped, 1 - d of net 2,
/// against it where flipped.
struct Orientation
{
  bool Swapped;
  std::array<bool, 2> Flipped;
};

bool Coincide(
  const SideNet& one, const SideNet& two, const Orientation& orientation, double distance)
{
  const auto matches = [&](int i, int j)
  {
    const int a = orientation.Flipped[0] ? one.Sizes[0] - 1 - i : i;
    const int b = orientation.Flipped[1] ? one.Sizes[1] - 1 - j : j;
    const Eigen::Index first = one.Column(i, j);
    const Eigen::Index second = orientation.Swapped ? two.Column(b, a) : two.Column(a, b);
    const double weight = one.Weights[first];
    return (one.Points.col(first) - two.Points.col(second)).norm() <= distance &&
      std::abs(weight - two.Weights[second]) <= ParameterTolerance * weight;
  };
  // The corners first: they reject almost every wrong orientation.
  const int endI = one.Sizes[0] - 1;
  const int endJ = one.Sizes[1] - 1;
  if (!matches(0, 0) || !matches(endI, 0) || !matches(0, endJ) || !matches(endI, endJ))
  {
    return false;
  }
  for (int j = 0; j <= endJ; ++j)
  {
    for (int i = 0; i <= endI; ++i)
    {
      if (!matches(i, j))
      {
        return false;
      }
    }
  }
  return true;
}

std::optional<Interface> MatchNets(const Patch& patch1, int side1, const SideNet& net1,
  const Patch& patch2, int side2, const SideNet& net2, double distance)
{
  const Spline& spline1 = patch1.Body.Geometry();
  const Spline& spline2 = patch2.Body.Geometry();
  for (int code = 0; code < 8; ++code)
  {
    const Orientation o{ code >= 4, { (code & 1) != 0, (code & 2) != 0 } };
    std::array<int, 3> direction{ 0, 1, 2 };
    std::array<bool, 3> same{ true, true, true };
    bool fits = true;
    for (std::size_t d = 0; d < 2; ++d)
    {
      const int along1 = net1.Directions[d];
      const int along2 = net2.Directions[o.Swapped ? 1 - d : d];
      direction[static_cast<std::size_t>(along1)] = along2;
      same[static_cast<std::size_t>(along1)] = !o.Flipped[d];
      // A direction that is not there has nothing to flip.
      fits = fits && !(o.Flipped[d] && net1.Sizes[d] == 1) &&
        SameKnots(spline1.Knots(along1), spline2.Knots(along2), o.Flipped[d]);
    }
    if (fits && Coincide(net1, net2, o, distance))
    {
      return MakeInterface(patch1.Id, side1, patch2.Id, side2, direction, same);
    }
  }
  return std::nullopt;
}

/// Cells of a grid that is coarser than the tolerance, so that two points that coincide are in the
/// same or in neighbouring cells.
class Grid
{
public:
  Grid(const Eigen::Vector3d& origin, double cell)
    : Origin(origin)
    , Cell(cell)
  {
  }
  [[nodiscard]] std::uint64_t Key(const Eigen::Vector3d& point) const
  {
    std::uint64_t key = 0;
    for (int d = 0; d < 3; ++d)
    {
      const double cell = std::floor((point[d] - this->Origin[d]) / this->Cell);
      key =
        (key ^ static_cast<std::uint64_t>(static_cast<std::int64_t>(cell))) * 0x9e3779b97f4a7c15ULL;
      key ^= key >> 29;
    }
    return key;
  }

private:
  Eigen::Vector3d Origin;
  double Cell;
};

struct OpenSide
{
  std::size_t Patch;
  int Side;
  SideNet Net;
};

}

Interface MakeInterface(int patch1, int side1, int patch2, int side2, std::array<int, 3> direction,
  std::array<bool, 3> same)
{
  const auto normal = static_cast<std::size_t>(side1 / 2);
  direction[normal] = side2 / 2;
  same[normal] = side1 % 2 != side2 % 2;
  return { { patch1, side1 + 1, patch2, side2 + 1, direction[0], direction[1], direction[2],
    same[0] ? 1 : 0, same[1] ? 1 : 0, same[2] ? 1 : 0 } };
}

std::optional<Interface> MatchSides(
  const Patch& patch1, int side1, const Patch& patch2, int side2, double distance)
{
  for (const auto& [patch, side] : { std::pair(&patch1, side1), std::pair(&patch2, side2) })
  {
    if (side < 0 || side >= NumberOfSides || !IsThere(patch->Body.Geometry().Knots(side / 2)))
    {
      throw Error("patch " + std::to_string(patch->Id) + " has no side " + std::to_string(side));
    }
  }
  const SideNet net1 = MakeSideNet(patch1.Body.Geometry(), side1);
  const SideNet net2 = MakeSideNet(patch2.Body.Geometry(), side2);
  if (IsCollapsed(net1, distance) || IsCollapsed(net2, distance))
  {
    return std::nullopt;
  }
  return MatchNets(patch1, side1, net1, patch2, side2, net2, distance);
}

std::vector<Interface> FindInterfaces(const MultiPatch& model, double relativeTolerance)
{
  if (!(relativeTolerance >= 0.0 && relativeTolerance < 1.0))
  {
    throw Error("the tolerance of interfaces is " + std::to_string(relativeTolerance) +
      "; a fraction of the diagonal in [0, 1) is needed");
  }
  if (model.Patches.empty())
  {
    return {};
  }
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Eigen::Vector3d low = Eigen::Vector3d::Constant(infinity);
  Eigen::Vector3d high = -low;
  for (const Patch& patch : model.Patches)
  {
    const auto points = patch.Body.Geometry().Coefficients();
    for (Eigen::Index d = 0; d < 3; ++d)
    {
      low[d] = std::min(low[d], d < points.rows() ? points.row(d).minCoeff() : 0.0);
      high[d] = std::max(high[d], d < points.rows() ? points.row(d).maxCoeff() : 0.0);
    }
  }
  const double diagonal = (high - low).norm();
  const double distance = relativeTolerance * diagonal;
  // At least 1e-12 of the diagonal, so that cell numbers fit in 64 bits and rounding of the mean
  // does not matter.
  const double reach = std::max({ distance, 1e-12 * diagonal, std::numeric_limits<double>::min() });
  const Grid grid(low, 4.0 * reach);

  std::unordered_multimap<std::uint64_t, OpenSide> open;
  std::vector<std::pair<std::size_t, Interface>> found;
  for (std::size_t p = 0; p < model.Patches.size(); ++p)
  {
    const Patch& patch = model.Patches[p];
    for (int side = 0; side < NumberOfSides; ++side)
    {
      const Spline& spline = patch.Body.Geometry();
      if (!patch.IsDomainFace[static_cast<std::size_t>(side)] || !IsThere(spline.Knots(side / 2)))
      {
        continue;
      }
      SideNet net = MakeSideNet(spline, side);
      if (IsCollapsed(net, distance))
      {
        continue;
      }
      const int i = net.Sizes[0] - 1;
      const int j = net.Sizes[1] - 1;
      const Eigen::Vector3d mean = 0.25 *
        (net.Points.col(0) + net.Points.col(net.Column(i, 0)) + net.Points.col(net.Column(0, j)) +
          net.Points.col(net.Column(i, j)));
      // The cells that a ball around the mean touches: at most two per axis.
      std::vector<std::uint64_t> keys;
      for (int corner = 0; corner < 8; ++corner)
      {
        const Eigen::Vector3d sign(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
        keys.push_back(grid.Key(mean + reach * sign));
      }
      std::sort(keys.begin(), keys.end());
      keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
      // Of several candidates the one of the earliest patch and side.
      auto best = open.end();
      std::optional<Interface> interface;
      for (const std::uint64_t key : keys)
      {
        const auto [begin, end] = open.equal_range(key);
        for (auto other = begin; other != end; ++other)
        {
          if (best != open.end() &&
            std::pair(best->second.Patch, best->second.Side) <
              std::pair(other->second.Patch, other->second.Side))
          {
            continue;
          }
          if (auto match = MatchNets(model.Patches[other->second.Patch], other->second.Side,
                other->second.Net, patch, side, net, distance))
          {
            best = other;
            interface = match;
          }
        }
      }
      if (interface)
      {
        found.emplace_back(
          best->second.Patch * NumberOfSides + static_cast<std::size_t>(best->second.Side),
          *interface);
        open.erase(best);
      }
      else
      {
        open.emplace(grid.Key(mean), OpenSide{ p, side, std::move(net) });
      }
    }
  }
  std::sort(
    found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Interface> interfaces;
  interfaces.reserve(found.size());
  for (const auto& entry : found)
  {
    interfaces.push_back(entry.second);
  }
  return interfaces;
}

}
