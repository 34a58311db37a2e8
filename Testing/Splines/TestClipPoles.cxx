// SPDX-License-Identifier: BSD-3-Clause
// Clips of patches with sides that are collapsed to an axis, a centre or a pole.
#include "Clip.h"
#include "Operators.h"
#include "Primitives.h"
#include "QuadricField.h"
#include "Splines/Clips.h"
#include "Splines/Integrals.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <functional>
#include <map>
#include <random>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

using namespace hyperpatch;
using Eigen::Vector3d;
using models::ClipAll;
using models::Clipped;
using models::Coarse;
using models::Inside;
using models::MakeFields;
using models::Plane;
using models::SignedVolume;
using models::Sphere;

namespace
{

constexpr double Pi = 3.14159265358979323846;

using Distance = std::function<double(const Vector3d&)>; ///< from surfaces, not signed

struct Solid
{
  std::string Name;
  MultiPatch Model;
  std::vector<Distance> Sides;
  double Volume;
  double Area;
};

Distance FromSphere(const Vector3d& centre, double radius)
{
  return [=](const Vector3d& x) { return std::abs((x - centre).norm() - radius); };
}

Distance FromPlane(const Vector3d& normal, const Vector3d& origin)
{
  return [=](const Vector3d& x) { return std::abs((x - origin).dot(normal.normalized())); };
}

Solid Cylinder()
{
  return { "cylinder", MakeCylinder(1.0, 1.0, Parametrisation::Poles),
    { [](const Vector3d& x) { return std::abs(x.head<2>().norm() - 1.0); },
      FromPlane({ 0, 0, 1 }, { 0, 0, 0.5 }), FromPlane({ 0, 0, 1 }, { 0, 0, -0.5 }) },
    Pi, 4.0 * Pi };
}

/// An apex at the top: the axis is one collapsed side, the apex another.
Solid Cone()
{
  return { "cone", MakeCone(1.0, 0.0, 1.0, Parametrisation::Poles),
    { [](const Vector3d& x)
      { return std::abs(x.head<2>().norm() - (0.5 - x[2])) * std::sqrt(0.5); },
      FromPlane({ 0, 0, 1 }, { 0, 0, -0.5 }) },
    Pi / 3.0, Pi * (1.0 + std::sqrt(2.0)) };
}

/// One patch: a centre and an axis.
Solid Ball()
{
  return { "ball", MakeSphere(1.0, Parametrisation::Poles), { FromSphere({ 0, 0, 0 }, 1.0) },
    4.0 / 3.0 * Pi, 4.0 * Pi };
}

/// One element: two poles of it are collapsed sides, the centre another.
Solid Octant()
{
  const Spline ball = Ball().Model.Patches[0].Body.Geometry();
  const KnotVector& v = ball.Knots(1);
  const KnotVector& w = ball.Knots(2);
  MultiPatch model;
  model.Patches.push_back({ 0,
    Aggregate(RestrictToBox(ball, { ball.Knots(0).First(), v.First(), w.First() },
      { ball.Knots(0).Last(), 0.5 * (v.First() + v.Last()),
        0.75 * w.First() + 0.25 * w.Last() })) });
  return { "octant", model,
    { FromSphere({ 0, 0, 0 }, 1.0), FromPlane({ 1, 0, 0 }, { 0, 0, 0 }),
      FromPlane({ 0, 1, 0 }, { 0, 0, 0 }), FromPlane({ 0, 0, 1 }, { 0, 0, 0 }) },
    Pi / 6.0, 5.0 / 4.0 * Pi };
}

struct Cut
{
  Quadric Field;
  Distance From;
  double Inside; ///< the volume where the field is negative
  double Area;
  bool IsHollow; ///< a ball is cut out of the inside
};

Cut ByPlane(const Vector3d& normal, const Vector3d& origin, double inside)
{
  return { Plane(normal, origin), FromPlane(normal, origin), inside, Pi, false };
}

Cut BySphere(const Vector3d& centre, double radius)
{
  return { Sphere(centre, radius), FromSphere(centre, radius), 4.0 / 3.0 * Pi * std::pow(radius, 3),
    4.0 * Pi * radius * radius, true };
}

/// Of the unit ball where x . normal <= distance.
double Cap(double distance)
{
  return Pi / 3.0 * (2.0 - 3.0 * -distance + std::pow(-distance, 3));
}

/// All tetrahedra have positive volume; their faces belong to two of them or lie within the
/// tolerance of the sides or the cut; the boundary is closed.
void ExpectSolid(const Solid& solid, const Cut& cut, const Clipped& clipped, double tolerance,
  double volume, int euler)
{
  using Corner = std::array<double, 3>;
  std::map<std::array<Corner, 3>, int> faces;
  double sum = 0.0;
  std::size_t turnedOver = 0;
  for (const ClipMesh& mesh : clipped.Meshes)
  {
    for (Eigen::Index c = 0; c < mesh.Cells.cols(); ++c)
    {
      const double own = SignedVolume(mesh, c);
      sum += own;
      turnedOver += own > 0.0 ? 0 : 1;
      for (Eigen::Index left = 0; left < 4; ++left)
      {
        std::array<Corner, 3> face{};
        for (Eigen::Index i = 0, k = 0; i < 4; ++i)
        {
          if (i != left)
          {
            const auto x = mesh.Points.col(mesh.Cells(i, c));
            face[static_cast<std::size_t>(k++)] = { x[0], x[1], x[2] };
          }
        }
        std::sort(face.begin(), face.end());
        ++faces[face];
      }
    }
  }
  EXPECT_EQ(turnedOver, 0u);
  EXPECT_NEAR(sum, volume, tolerance * (solid.Area + cut.Area));
  std::size_t shared = 0;
  std::set<Corner> points;
  std::set<std::pair<Corner, Corner>> edges;
  long triangles = 0;
  double worst = 0.0;
  for (const auto& [face, cells] : faces)
  {
    shared += cells > 2 ? 1 : 0;
    if (cells != 1)
    {
      continue;
    }
    ++triangles;
    const auto at = [&face = face](std::size_t i) { return Vector3d(face[i].data()); };
    for (std::size_t i = 0; i < 3; ++i)
    {
      points.insert(face[i]);
      edges.insert({ face[i], face[(i + 1) % 3] });
      if (face[(i + 1) % 3] < face[i])
      {
        edges.erase({ face[i], face[(i + 1) % 3] });
        edges.insert({ face[(i + 1) % 3], face[i] });
      }
    }
    // A face lies along one of the surfaces, all of it.
    double least = INFINITY;
    const auto along = [&](const Distance& from)
    {
      double largest = 0.0;
      for (int i = 0; i <= 4; ++i)
      {
        for (int j = 0; i + j <= 4; ++j)
        {
          largest = std::max(largest, from((i * at(0) + j * at(1) + (4 - i - j) * at(2)) / 4.0));
        }
      }
      least = std::min(least, largest);
    };
    along(cut.From);
    for (const Distance& side : solid.Sides)
    {
      along(side);
    }
    worst = std::max(worst, least);
  }
  EXPECT_EQ(shared, 0u);
  EXPECT_LE(worst, tolerance);
  EXPECT_EQ(static_cast<long>(points.size()) - static_cast<long>(edges.size()) + triangles, euler);
  EXPECT_TRUE(clipped.Certificate.ToleranceReached);
}

void ExpectBothSides(const Solid& solid, const Cut& cut, double tolerance)
{
  for (const bool inside : { true, false })
  {
    SCOPED_TRACE(solid.Name + (inside ? " inside " : " outside ") + std::to_string(tolerance));
    ClipOptions options = Coarse(tolerance);
    options.KeepInside = inside;
    const Clipped clipped = ClipAll(solid.Model, Inside({ cut.Field }), options);
    ExpectSolid(solid, cut, clipped, tolerance, inside ? cut.Inside : solid.Volume - cut.Inside,
      cut.IsHollow && !inside ? 4 : 2);
  }
}

std::size_t CellsOf(const Clipped& clipped)
{
  std::size_t cells = 0;
  for (const ClipMesh& mesh : clipped.Meshes)
  {
    cells += static_cast<std::size_t>(mesh.Cells.cols());
  }
  return cells;
}

}

TEST(ClipPoles, PlanesThroughAndBesideTheAxisOfACylinder)
{
  const Solid solid = Cylinder();
  const double segment = Pi - (std::acos(0.4) - 0.4 * std::sqrt(1.0 - 0.16));
  for (const double tolerance : { 3e-2, 1e-2, 3e-3 })
  {
    for (const Cut& cut :
      { ByPlane({ 1, 0, 0 }, { 0, 0, 0 }, Pi / 2.0), ByPlane({ 1, 2, 0 }, { 0, 0, 0 }, Pi / 2.0),
        ByPlane({ 0.3, 1, 0.2 }, { 0, 0, 0 }, Pi / 2.0),
        ByPlane({ 1, 0, 0 }, { 0.4, 0, 0 }, segment), ByPlane({ 0, 0, 1 }, { 0, 0, 0.1 }, 0.6 * Pi),
        BySphere({ 0, 0, 0 }, 0.4), BySphere({ 0.2, 0.1, 0.05 }, 0.3) })
    {
      ExpectBothSides(solid, cut, tolerance);
    }
  }
}

TEST(ClipPoles, PlanesThroughAndBesideTheApexOfACone)
{
  const Solid solid = Cone();
  const double top = Pi / 3.0 * std::pow(0.4, 3);
  for (const double tolerance : { 3e-2, 1e-2 })
  {
    for (const Cut& cut :
      { ByPlane({ 1, 0, 0 }, { 0, 0, 0 }, Pi / 6.0), ByPlane({ 2, -1, 0 }, { 0, 0, 0 }, Pi / 6.0),
        ByPlane({ 0, 0, 1 }, { 0, 0, 0.1 }, Pi / 3.0 - top), BySphere({ 0, 0, -0.2 }, 0.2),
        BySphere({ 0.2, 0.1, -0.2 }, 0.15) })
    {
      ExpectBothSides(solid, cut, tolerance);
    }
  }
}

TEST(ClipPoles, PlanesThroughAndBesideTheCentreAndThePolesOfABall)
{
  const Solid solid = Ball();
  for (const double tolerance : { 5e-2, 2e-2 })
  {
    for (const Cut& cut : { ByPlane({ 0, 0, 1 }, { 0, 0, 0 }, Cap(0.0)),
           ByPlane({ 1, 0, 0 }, { 0, 0, 0 }, Cap(0.0)), ByPlane({ 1, 1, 0 }, { 0, 0, 0 }, Cap(0.0)),
           ByPlane({ 0.3, 1, 0.2 }, { 0, 0, 0 }, Cap(0.0)),
           ByPlane({ 0, 0, 1 }, { 0, 0, 0.3 }, Cap(0.3)),
           ByPlane({ 1, 0, 0 }, { 0.4, 0, 0 }, Cap(0.4)), BySphere({ 0, 0, 0 }, 0.5),
           BySphere({ 0.1, 0.2, 0.1 }, 0.5) })
    {
      ExpectBothSides(solid, cut, tolerance);
    }
  }
}

TEST(ClipPoles, AnOctantOfOneElement)
{
  const Solid solid = Octant();
  for (const double tolerance : { 3e-2, 1e-2, 3e-3 })
  {
    for (const Cut& cut : { ByPlane({ 1, 1, 1 }, { 0.3, 0.3, 0.3 }, std::pow(0.9, 3) / 6.0),
           ByPlane({ 1, -1, 0 }, { 0, 0, 0 }, Pi / 12.0),
           ByPlane({ 0, 1, -1 }, { 0, 0, 0 }, Pi / 12.0), BySphere({ 0.4, 0.4, 0.4 }, 0.2) })
    {
      ExpectBothSides(solid, cut, tolerance);
    }
    // The cut meets all three sides: nothing is hollow.
    Cut corner = BySphere({ 0, 0, 0 }, 0.5);
    corner.Inside /= 8.0;
    corner.IsHollow = false;
    ExpectBothSides(solid, corner, tolerance);
  }
}

TEST(ClipPoles, AnEdgeAloneAndThinRims)
{
  // A cube one edge of which is a point, and a pillow: two sheets that meet all around.
  const KnotVector line = KnotVector::Uniform(1, 2);
  Eigen::MatrixXd wedge(3, 8);
  wedge << 0, 1, 0, 1, 0, 1, 0, 1, 0, 0, 1, 1, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 1, 1;
  const KnotVector arch = KnotVector::Uniform(2, 3);
  Eigen::MatrixXd pillow(3, 18);
  for (int i = 0; i < 18; ++i)
  {
    const bool isMiddle = i % 9 == 4;
    pillow.col(i) << 0.5 * (i % 3), 0.5 * (i / 3 % 3), isMiddle ? (i < 9 ? -1.0 : 1.0) : 0.0;
  }
  for (const Spline& geometry :
    { Spline({ line, line, line }, wedge), Spline({ arch, arch, line }, pillow) })
  {
    MultiPatch model;
    model.Patches.push_back({ 0, Aggregate(geometry) });
    const double exact =
      integrals::Integrate(geometry, [](const Eigen::Matrix3d& J) { return J.determinant(); });
    for (const Vector3d& normal : { Vector3d(1, 2, 0.5), Vector3d(1, -1, 0), Vector3d(0, 1, 0) })
    {
      double sum = 0.0;
      for (const bool inside : { true, false })
      {
        ClipOptions options = Coarse(1e-2);
        options.KeepInside = inside;
        const Clipped clipped =
          ClipAll(model, Inside({ Plane(normal, { 0.5, 0.5, 0.1 }) }), options);
        Solid solid{ "", model, { [](const Vector3d&) { return 0.0; } }, 0.0, 10.0 };
        double volume = 0.0;
        for (Eigen::Index c = 0; c < clipped.Meshes[0].Cells.cols(); ++c)
        {
          volume += SignedVolume(clipped.Meshes[0], c);
        }
        ExpectSolid(solid, ByPlane(normal, { 0.5, 0.5, 0.1 }, 0.0), clipped, 1e-2, volume, 2);
        sum += volume;
      }
      EXPECT_NEAR(sum, exact, 1e-2 * 6.0);
    }
  }
}

TEST(ClipPoles, CellsGrowLikeTheSurfacesThatAskForThem)
{
  // Where the cut goes through the centre all that bends is the sphere: cells are cones over it.
  const Solid solid = Ball();
  const MakeFields half = Inside({ Plane({ 0, 0, 1 }, { 0, 0, 0 }) });
  const std::size_t coarse = CellsOf(ClipAll(solid.Model, half, Coarse(1e-2)));
  const std::size_t fine = CellsOf(ClipAll(solid.Model, half, Coarse(1e-2 / 16.0)));
  EXPECT_LE(coarse, 3000u);
  EXPECT_LE(fine, 24u * coarse);
  // Beside it, as many as in a ball of patches that have no poles.
  const MakeFields part = Inside({ Plane({ 0.3, 1, 0.2 }, { 0.1, 0.2, 0.1 }) });
  EXPECT_LE(CellsOf(ClipAll(solid.Model, part, Coarse(1e-2))),
    CellsOf(ClipAll(MakeSphere(1.0, Parametrisation::Patches), part, Coarse(1e-2))));
}

TEST(ClipPoles, ASurfaceWithPolesIsCutToTriangles)
{
  // The sphere alone, and a disk of one patch.
  const Spline ball = Ball().Model.Patches[0].Body.Geometry();
  MultiPatch sphere;
  sphere.Patches.push_back({ 0, Aggregate(ExtractFace(ball, 1)) });
  const Clipped cap =
    ClipAll(sphere, Inside({ Plane({ 0.1, 0.2, 1 }, { 0, 0, 0 }) }), Coarse(1e-3));
  MultiPatch disk;
  disk.Patches.push_back(
    { 0, Aggregate(ExtractFace(Cylinder().Model.Patches[0].Body.Geometry(), 4)) });
  const Clipped half = ClipAll(disk, Inside({ Plane({ 1, 0, 0 }, { 0, 0, 0 }) }), Coarse(1e-3));
  const auto area = [](const Clipped& clipped)
  {
    double sum = 0.0;
    const ClipMesh& mesh = clipped.Meshes[0];
    for (Eigen::Index c = 0; c < mesh.Cells.cols(); ++c)
    {
      const Vector3d a = mesh.Points.col(mesh.Cells(1, c)) - mesh.Points.col(mesh.Cells(0, c));
      const Vector3d b = mesh.Points.col(mesh.Cells(2, c)) - mesh.Points.col(mesh.Cells(0, c));
      sum += 0.5 * a.cross(b).norm();
      EXPECT_GT(a.cross(b).norm(), 0.0);
    }
    return sum;
  };
  EXPECT_NEAR(area(cap), 2.0 * Pi, 1e-3 * 4.0 * Pi);
  EXPECT_NEAR(area(half), Pi / 2.0, 1e-3 * (2.0 + Pi));
  EXPECT_EQ(half.Certificate.UndecidedCells, 0);
}

TEST(ClipPoles, ThreadsDoNotChangeTheResult)
{
  const Solid solid = Ball();
  const MakeFields plane = Inside({ Plane({ 0.3, 1, 0.2 }, { 0.05, 0, 0 }) });
  const Clipped one = ClipAll(solid.Model, plane, Coarse(2e-2));
  std::vector<ClipGroup::Member> members;
  const auto parallel = [](std::ptrdiff_t count, std::ptrdiff_t grain,
                          const std::function<void(std::ptrdiff_t, std::ptrdiff_t)>& body)
  {
    std::atomic<std::ptrdiff_t> next{ 0 };
    const auto work = [&]
    {
      for (std::ptrdiff_t begin = next.fetch_add(grain); begin < count;
           begin = next.fetch_add(grain))
      {
        body(begin, std::min(count, begin + grain));
      }
    };
    std::thread other(work);
    work();
    other.join();
  };
  auto body = std::make_shared<const PreparedAggregate>(solid.Model.Patches[0].Body);
  ClipGroup two({ { &solid.Model.Patches[0], body, plane(*body), Coarse(2e-2) } },
    solid.Model.Interfaces, parallel);
  ASSERT_TRUE(two.Extract());
  EXPECT_EQ(one.Meshes[0].Points, two.Mesh(0).Points);
  EXPECT_EQ(one.Meshes[0].Cells, two.Mesh(0).Cells);
  EXPECT_EQ(one.Certificate.LargestError, two.Certificate().LargestError);
}

namespace
{

/// The cylinder with two attributes: the square of the radius, and the cosine of the angle, which
/// is not one value on the axis.
MultiPatch CylinderWithAttributes()
{
  MultiPatch model = Cylinder().Model;
  const Spline& geometry = model.Patches[0].Body.Geometry();
  Eigen::MatrixXd cosine(1, geometry.NumberOfControlPoints());
  for (Eigen::Index i = 0; i < cosine.cols(); ++i)
  {
    // Of the control point at the end of u.
    const auto n = static_cast<Eigen::Index>(geometry.Sizes()[0]);
    cosine(0, i) = geometry.Coefficients()(0, i / n * n + n - 1);
  }
  const KnotVector line = KnotVector::Uniform(1, 2);
  const auto domain = [&geometry](int d, int degree)
  {
    return KnotVector::Uniform(
      degree, degree + 1, geometry.Knots(d).First(), geometry.Knots(d).Last());
  };
  Eigen::MatrixXd square(1, 12);
  square << 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1;
  model.Patches[0].Body = Aggregate(geometry,
    { { "Square", Spline({ domain(0, 2), domain(1, 1), domain(2, 1) }, square) },
      { "Cosine", Spline(geometry.Knots(), cosine, geometry.Weights()) } });
  return model;
}

/// The largest errors of linear interpolation of the square and the cosine, in cells that keep a
/// distance from the axis.
std::array<double, 2> AttributeErrors(const ClipMesh& mesh, double distance)
{
  std::mt19937 random(7);
  std::exponential_distribution<double> share;
  std::array<double, 2> worst{};
  for (Eigen::Index c = 0; c < mesh.Cells.cols(); ++c)
  {
    double nearest = INFINITY;
    for (Eigen::Index i = 0; i < 4; ++i)
    {
      nearest = std::min(nearest, mesh.Points.col(mesh.Cells(i, c)).head<2>().norm());
    }
    for (int sample = 0; sample < 5; ++sample)
    {
      Eigen::Vector4d weights(share(random), share(random), share(random), share(random));
      weights /= weights.sum();
      Vector3d x = Vector3d::Zero();
      Eigen::Vector2d value = Eigen::Vector2d::Zero();
      for (int i = 0; i < 4; ++i)
      {
        const Eigen::Index p = mesh.Cells(i, c);
        x += weights[i] * mesh.Points.col(p);
        value += weights[i] * Eigen::Vector2d(mesh.Attributes[0](0, p), mesh.Attributes[1](0, p));
      }
      const double r = x.head<2>().norm();
      worst[0] = std::max(worst[0], std::abs(value[0] - r * r));
      worst[1] = nearest > distance ? std::max(worst[1], std::abs(value[1] - x[0] / r)) : worst[1];
    }
  }
  return worst;
}

}

TEST(ClipPoles, AttributesKeepToTheirTolerances)
{
  const MultiPatch model = CylinderWithAttributes();
  const MakeFields half = Inside({ Plane({ 0.3, 1, 0.2 }, { 0, 0.1, 0 }) });
  ClipOptions options = Coarse(5e-2);
  options.AttributeTolerances = { 0.05, 0.0 };
  const Clipped smooth = ClipAll(model, half, options);
  EXPECT_TRUE(smooth.Certificate.ToleranceReached);
  EXPECT_EQ(smooth.Certificate.UndecidedCells, 0);
  // Points in space are off by the tolerance besides, and the slope of the square is 2.
  EXPECT_LE(AttributeErrors(smooth.Meshes[0], 0.0)[0], 0.05 + 2.0 * 5e-2);

  // What has many values on the axis is wrong there, which is counted, and nowhere else.
  options.AttributeTolerances = { 0.0, 0.1 };
  const Clipped split = ClipAll(model, half, options);
  EXPECT_TRUE(split.Certificate.ToleranceReached);
  EXPECT_GT(split.Certificate.UndecidedCells, 0);
  EXPECT_LE(AttributeErrors(split.Meshes[0], options.Tolerance)[1], 0.1 + 2.0 * 5e-2);
  EXPECT_LE(CellsOf(split), 50000u);
}

TEST(ClipPoles, AnAttributeWithManyValuesOnTheAxisIsCutThroughIt)
{
  // Where the cosine is at most 0.3: a sector, whose sides end in the axis.
  const MultiPatch model = CylinderWithAttributes();
  const MakeFields sector = [](const PreparedAggregate& body) -> models::Fields
  {
    return { std::make_shared<const QuadricField>(
      body.Attributes()[1], ComponentEquals(body.Attributes()[1]->Spline(), 0, 0.3), false) };
  };
  Solid solid = Cylinder();
  for (const double sign : { -1.0, 1.0 })
  {
    solid.Sides.push_back(FromPlane({ std::sqrt(1.0 - 0.09), sign * 0.3, 0 }, { 0, 0, 0 }));
  }
  const double angle = 2.0 * Pi - 2.0 * std::acos(0.3);
  for (const bool inside : { true, false })
  {
    ClipOptions options = Coarse(1e-2);
    options.KeepInside = inside;
    const Clipped clipped = ClipAll(model, sector, options);
    const double volume = 0.5 * angle;
    ExpectSolid(solid, ByPlane({ 0, 0, 1 }, { 0, 0, 0.5 }, 0.0), clipped, 1e-2,
      inside ? volume : Pi - volume, 2);
  }
}
