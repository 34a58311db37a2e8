// SPDX-License-Identifier: BSD-3-Clause
#include "ChordBound.h"
#include "Error.h"
#include "Evaluator.h"
#include "Operators.h"
#include "Splines/Models.h"
#include "Tessellation.h"

#include <Eigen/Geometry>

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <thread>

using namespace hyperpatch;

namespace
{

// A mesh is within its tolerance but for the slack that keeps counts from flipping.
constexpr double Bound = 1.0 + 1e-6;

Patch MakePatch(Spline geometry, std::vector<Attribute> attributes = {})
{
  Patch patch{ 0, Aggregate(std::move(geometry), std::move(attributes)) };
  return patch;
}

TessellationOptions Tolerances(double tolerance, std::vector<double> attributes = {})
{
  TessellationOptions options;
  options.Tolerance = tolerance;
  options.AttributeTolerances = std::move(attributes);
  return options;
}

struct Errors
{
  double Position = 0.0;
  std::vector<double> Attributes;
};

/// Compares linear interpolation in every cell with the exact values at the same parameters, on a
/// grid of barycentric or trilinear coordinates.
template <typename Mesh, typename Cells, typename Weights>
Errors SampleErrors(
  const Patch& patch, const Mesh& mesh, const Cells& cells, const std::vector<Weights>& samples)
{
  std::vector<Evaluator> evaluators;
  evaluators.emplace_back(patch.Body.Geometry());
  for (const Attribute& attribute : patch.Body.Attributes())
  {
    evaluators.emplace_back(attribute.Field);
  }
  Errors errors;
  errors.Attributes.assign(patch.Body.Attributes().size(), 0.0);
  for (Eigen::Index c = 0; c < cells.cols(); ++c)
  {
    for (const Weights& weights : samples)
    {
      Eigen::Vector3d parameters = Eigen::Vector3d::Zero();
      for (Eigen::Index i = 0; i < cells.rows(); ++i)
      {
        parameters += weights[i] * mesh.Parameters.col(cells(i, c));
      }
      for (std::size_t s = 0; s < evaluators.size(); ++s)
      {
        Eigen::VectorXd exact(evaluators[s].Components());
        evaluators[s].Evaluate(1, parameters.data(), exact.data());
        Eigen::VectorXd difference = -exact;
        for (Eigen::Index i = 0; i < cells.rows(); ++i)
        {
          const Eigen::Index point = cells(i, c);
          difference += weights[i] *
            (s == 0 ? Eigen::VectorXd(mesh.Points.col(point).head(exact.size()))
                    : Eigen::VectorXd(mesh.Attributes[s - 1].col(point)));
        }
        double& error = s == 0 ? errors.Position : errors.Attributes[s - 1];
        error = std::max(error, s == 0 ? difference.norm() : difference.cwiseAbs().maxCoeff());
      }
    }
  }
  return errors;
}

Errors SurfaceErrors(const Patch& patch, const SurfaceMesh& mesh)
{
  constexpr int N = 10;
  std::vector<Eigen::Vector3d> samples;
  for (int i = 0; i <= N; ++i)
  {
    for (int j = 0; i + j <= N; ++j)
    {
      samples.emplace_back(Eigen::Vector3d(i, j, N - i - j) / N);
    }
  }
  return SampleErrors(patch, mesh, mesh.Triangles, samples);
}

Errors SolidErrors(const Patch& patch, const SolidMesh& mesh)
{
  constexpr int N = 4;
  std::vector<Eigen::Matrix<double, 8, 1>> samples;
  for (int n = 0; n < (N + 1) * (N + 1) * (N + 1); ++n)
  {
    const double u = n % (N + 1) / double(N);
    const double v = n / (N + 1) % (N + 1) / double(N);
    const double w = n / ((N + 1) * (N + 1)) / double(N);
    Eigen::Matrix<double, 8, 1> weights;
    weights << (1 - u) * (1 - v) * (1 - w), u * (1 - v) * (1 - w), u * v * (1 - w),
      (1 - u) * v * (1 - w), (1 - u) * (1 - v) * w, u * (1 - v) * w, u * v * w, (1 - u) * v * w;
    samples.push_back(weights);
  }
  return SampleErrors(patch, mesh, mesh.Hexahedra, samples);
}

/// Ids that are the same for points closer than `distance` in each coordinate.
std::vector<Eigen::Index> MergePoints(const Eigen::Matrix3Xd& points, double distance)
{
  std::vector<Eigen::Index> merged(static_cast<std::size_t>(points.cols()));
  std::vector<Eigen::Index> order(merged.size());
  for (std::size_t i = 0; i < order.size(); ++i)
  {
    order[i] = static_cast<Eigen::Index>(i);
  }
  std::sort(order.begin(), order.end(),
    [&](Eigen::Index a, Eigen::Index b) { return points(0, a) < points(0, b); });
  for (std::size_t i = 0; i < order.size(); ++i)
  {
    merged[static_cast<std::size_t>(order[i])] = order[i];
    for (std::size_t j = i; j-- > 0 && points(0, order[i]) - points(0, order[j]) <= distance;)
    {
      if ((points.col(order[i]) - points.col(order[j])).cwiseAbs().maxCoeff() <= distance)
      {
        merged[static_cast<std::size_t>(order[i])] = merged[static_cast<std::size_t>(order[j])];
        break;
      }
    }
  }
  return merged;
}

/// Every edge is used once in each direction. \returns the Euler characteristic
int ExpectClosed(const SurfaceMesh& mesh)
{
  const auto merged = MergePoints(mesh.Points, 1e-12 * mesh.Points.cwiseAbs().maxCoeff());
  std::map<std::pair<Eigen::Index, Eigen::Index>, int> edges;
  std::map<Eigen::Index, int> vertices;
  for (Eigen::Index t = 0; t < mesh.Triangles.cols(); ++t)
  {
    for (int i = 0; i < 3; ++i)
    {
      const Eigen::Index a = merged[static_cast<std::size_t>(mesh.Triangles(i, t))];
      const Eigen::Index b = merged[static_cast<std::size_t>(mesh.Triangles((i + 1) % 3, t))];
      ++edges[{ a, b }];
      vertices[a] = 1;
    }
  }
  for (const auto& [edge, count] : edges)
  {
    EXPECT_EQ(count, 1);
    EXPECT_EQ(edges.count({ edge.second, edge.first }), 1u);
    if (::testing::Test::HasFailure())
    {
      break;
    }
  }
  return static_cast<int>(vertices.size()) - static_cast<int>(edges.size() / 2) +
    static_cast<int>(mesh.Triangles.cols());
}

double EnclosedVolume(const SurfaceMesh& mesh)
{
  double volume = 0.0;
  for (Eigen::Index t = 0; t < mesh.Triangles.cols(); ++t)
  {
    const Eigen::Vector3d a = mesh.Points.col(mesh.Triangles(0, t));
    const Eigen::Vector3d b = mesh.Points.col(mesh.Triangles(1, t));
    volume += a.dot(b.cross(mesh.Points.col(mesh.Triangles(2, t)))) / 6.0;
  }
  return volume;
}

/// The area of the triangles in the parameter plane of a side, relative to that of the domain.
double CoveredPart(const Patch& patch, const SurfaceMesh& mesh, int side)
{
  double area = 0.0;
  for (Eigen::Index t = 0; t < mesh.Triangles.cols(); ++t)
  {
    if (mesh.TriangleSides[static_cast<std::size_t>(t)] == side)
    {
      const Eigen::Vector3d a = mesh.Parameters.col(mesh.Triangles(0, t));
      const Eigen::Vector3d b = mesh.Parameters.col(mesh.Triangles(1, t));
      const Eigen::Vector3d c = mesh.Parameters.col(mesh.Triangles(2, t));
      area += 0.5 * (b - a).cross(c - a).norm();
    }
  }
  for (int d = 0; d < 3; ++d)
  {
    const KnotVector& k = patch.Body.Geometry().Knots(d);
    area /= d == side / 2 ? 1.0 : k.Last() - k.First();
  }
  return area;
}

/// A cube whose control points are moved a little: one to one, with all kinds of knots.
Spline WobblyCube(std::mt19937& random, std::array<int, 3> degrees, int spans, bool rational)
{
  std::array<KnotVector, 3> knots;
  for (std::size_t d = 0; d < 3; ++d)
  {
    knots[d] = models::RandomKnots(random, degrees[d], degrees[d] + spans, true);
  }
  const Spline noise = models::RandomSpline(random, knots, 3, rational);
  Eigen::MatrixXd points = 0.12 / spans * noise.Coefficients();
  Eigen::Index n = 0;
  for (int k = 0; k < knots[2].Size(); ++k)
  {
    for (int j = 0; j < knots[1].Size(); ++j)
    {
      for (int i = 0; i < knots[0].Size(); ++i, ++n)
      {
        const int index[3] = { i, j, k };
        for (int d = 0; d < 3; ++d)
        {
          const KnotVector& knot = knots[static_cast<std::size_t>(d)];
          points(d, n) += (knot.Greville(index[d]) - knot.First()) / (knot.Last() - knot.First());
        }
      }
    }
  }
  return Spline(knots, points, noise.Weights());
}

/// A field on the domain of a geometry with degrees and breaks of its own, C0 at some of them.
Attribute OwnAttribute(std::mt19937& random, const Spline& geometry, int components)
{
  std::array<KnotVector, 3> knots;
  for (std::size_t d = 0; d < 3; ++d)
  {
    const KnotVector& g = geometry.Knots(static_cast<int>(d));
    const KnotVector own = models::RandomKnots(random, 2, 6, true);
    std::vector<double> scaled = own.Knots();
    for (double& knot : scaled)
    {
      knot = knot >= own.Last()
        ? g.Last()
        : g.First() + (g.Last() - g.First()) * (knot - own.First()) / (own.Last() - own.First());
    }
    knots[d] = KnotVector(2, scaled);
  }
  return { "own", models::RandomSpline(random, knots, components, false) };
}

/// Polynomial, degree in u given, that in v from the number of points.
Spline BezierSurface(int degree, const std::vector<Eigen::Vector3d>& points)
{
  Eigen::MatrixXd coefficients(3, static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    coefficients.col(static_cast<Eigen::Index>(i)) = points[i];
  }
  const int nv = static_cast<int>(points.size()) / (degree + 1);
  return Spline(
    { KnotVector::Uniform(degree, degree + 1), KnotVector::Uniform(nv - 1, nv), {} }, coefficients);
}

/// An octant of the unit sphere as a quadratic times quadratic NURBS surface: u the longitude, v
/// from the equator to the pole, where the edge is collapsed.
Spline SphereOctant()
{
  const double s = std::sqrt(0.5);
  const double arc[3][3] = { { 1, 0, 1 }, { 1, 1, s }, { 0, 1, 1 } };
  Eigen::MatrixXd points(3, 9);
  Eigen::VectorXd weights(9);
  for (int j = 0, n = 0; j < 3; ++j)
  {
    for (int i = 0; i < 3; ++i, ++n)
    {
      points.col(n) << arc[j][0] * arc[i][0], arc[j][0] * arc[i][1], arc[j][1];
      weights[n] = arc[i][2] * arc[j][2];
    }
  }
  return Spline(
    { KnotVector::Uniform(2, 3), KnotVector::Uniform(2, 3), KnotVector() }, points, weights);
}

/// Triangles as sorted triples of their corners' parameters, to compare meshes as sets.
std::vector<std::array<double, 9>> TriangleSet(const std::vector<SurfaceMesh>& meshes)
{
  std::vector<std::array<double, 9>> set;
  for (const SurfaceMesh& mesh : meshes)
  {
    for (Eigen::Index t = 0; t < mesh.Triangles.cols(); ++t)
    {
      std::array<double, 9> triangle{};
      for (int i = 0; i < 3; ++i)
      {
        for (int d = 0; d < 3; ++d)
        {
          // Coordinates of pieces differ by round-off, far below this grid.
          triangle[static_cast<std::size_t>(3 * i + d)] =
            std::round(mesh.Points(d, mesh.Triangles(i, t)) * 1e9) + 0.0;
        }
      }
      set.push_back(triangle);
    }
  }
  std::sort(set.begin(), set.end());
  return set;
}

}

TEST(ChordBound, HoldsForRandomPieces)
{
  std::mt19937 random(3);
  for (int trial = 0; trial < 40; ++trial)
  {
    const std::array<int, 3> degrees{ int(random() % 5), int(random() % 4), int(random() % 3) };
    std::array<KnotVector, 3> knots;
    for (std::size_t d = 0; d < 3; ++d)
    {
      knots[d] = degrees[d] == 0 ? KnotVector() : KnotVector::Uniform(degrees[d], degrees[d] + 1);
    }
    const Spline spline = models::RandomSpline(random, knots, 3, trial % 2 == 0);
    ChordBound bound;
    for (int halvings = 0; halvings < 3; ++halvings)
    {
      const auto vector = bound(
        spline.Homogeneous(), degrees, spline.IsRational(), ChordBound::Norm::Vector, halvings);
      const auto components = bound(
        spline.Homogeneous(), degrees, spline.IsRational(), ChordBound::Norm::Components, halvings);
      ASSERT_EQ(components.size(), 3u);
      const Evaluator evaluator(spline);
      const Eigen::VectorXd corner = spline.Coefficients().col(0);
      for (int sample = 0; sample < 100; ++sample)
      {
        const Eigen::Vector3d parameters = 0.5 *
          (Eigen::Vector3d::Ones() +
            Eigen::Vector3d::NullaryExpr(
              [&](Eigen::Index) { return (random() % 1001) / 500.0 - 1.0; }));
        Eigen::Vector3d value;
        Eigen::Matrix3d first;
        Eigen::Matrix<double, 3, 6> second;
        evaluator.EvaluateWithSecondDerivatives(
          1, parameters.data(), value.data(), first.data(), second.data());
        ASSERT_LE((value - corner).norm(), 2.0 * vector[0].Radius * (1 + 1e-12) + 1e-15);
        for (int pair = 0; pair < 6; ++pair)
        {
          const auto p = static_cast<std::size_t>(pair);
          ASSERT_LE(second.col(pair).norm(), vector[0].Second[p] * (1 + 1e-12) + 1e-10);
          for (std::size_t c = 0; c < 3; ++c)
          {
            ASSERT_LE(std::abs(second(static_cast<Eigen::Index>(c), pair)),
              components[c].Second[p] * (1 + 1e-12) + 1e-10);
          }
        }
      }
    }
  }
}

TEST(ChordBound, AsksForHardlyMoreSegmentsThanACircleNeeds)
{
  const double s = std::sqrt(0.5);
  Eigen::MatrixXd arc(3, 3);
  arc << 1, s, 0, 0, s, 1, 1, s, 1;
  ChordBound bound;
  const double second = bound(arc, { 2, 0, 0 }, true, ChordBound::Norm::Vector, 2)[0].Second[0];
  // The least that any number of segments can do: chords of equal length, sagitta = L^2 / 8.
  const double fewest = std::acos(-1.0) / 2;
  EXPECT_LT(std::sqrt(second), 1.2 * fewest);
}

TEST(Tessellation, QuarterTubeIsWithinToleranceAndNotFarBelow)
{
  const Patch patch = MakePatch(models::QuarterTube());
  for (double tolerance : { 1e-1, 1e-2, 1e-3 })
  {
    const SurfaceMesh mesh = TessellateBoundary(patch, 1, Tolerances(tolerance));
    EXPECT_FALSE(mesh.LimitReached);
    const double error = SurfaceErrors(patch, mesh).Position;
    EXPECT_LE(error, tolerance * Bound);
    EXPECT_GE(error, tolerance / 4);
    EXPECT_EQ(ExpectClosed(mesh), 2);
    EXPECT_NEAR(EnclosedVolume(mesh), 0.75 * std::acos(-1.0), 8 * tolerance);
    for (int side = 0; side < 6; ++side)
    {
      EXPECT_NEAR(CoveredPart(patch, mesh, side), 1.0, 1e-12);
    }
  }
}

TEST(Tessellation, RandomVolumesWithAttributesAreWithinTolerance)
{
  std::mt19937 random(5);
  for (int trial = 0; trial < 6; ++trial)
  {
    const std::array<int, 3> degrees{ 1 + int(random() % 4), 1 + int(random() % 3),
      1 + int(random() % 3) };
    const Spline cube = WobblyCube(random, degrees, 2, trial % 2 == 0);
    const Spline shared(cube.Knots(), cube.Coefficients().topRows(1).cwiseAbs2(), cube.Weights());
    Patch patch = MakePatch(cube, { { "shared", shared }, OwnAttribute(random, cube, 2) });
    const SurfaceMesh mesh = TessellateBoundary(patch, 1, Tolerances(0.01, { 0.02, 0.3 }));
    const Errors errors = SurfaceErrors(patch, mesh);
    EXPECT_LE(errors.Position, 0.01 * Bound);
    EXPECT_LE(errors.Attributes[0], 0.02 * Bound);
    EXPECT_LE(errors.Attributes[1], 0.3 * Bound);
    EXPECT_GE(errors.Attributes[1], 0.3 / 30);
    EXPECT_EQ(ExpectClosed(mesh), 2);
    for (int side = 0; side < 6; ++side)
    {
      EXPECT_NEAR(CoveredPart(patch, mesh, side), 1.0, 1e-12);
    }
  }
}

TEST(Tessellation, HighDegreesAreWithinTolerance)
{
  std::mt19937 random(6);
  for (int degree = 1; degree <= 15; ++degree)
  {
    const Patch patch = MakePatch(
      WobblyCube(random, { degree, degree < 8 ? 2 : 1, 1 + degree % 3 }, 1, degree % 2 == 0));
    const SurfaceMesh mesh = TessellateBoundary(patch, 1, Tolerances(0.03));
    EXPECT_LE(SurfaceErrors(patch, mesh).Position, 0.03 * Bound);
    EXPECT_EQ(ExpectClosed(mesh), 2);
  }
}

TEST(Tessellation, EdgesThatBendLessThanTheInsideAreWithinTolerance)
{
  using V = Eigen::Vector3d;
  const std::vector<Spline> surfaces{
    // Straight on one side, an arc on the other.
    BezierSurface(2, { V(0, 0, 0), V(1, 0, 0), V(2, 0, 0), V(0, 1, 0), V(1, 1, 2), V(2, 1, 0) }),
    // Hyperbolic paraboloid: only the mixed derivative is there.
    BezierSurface(1, { V(0, 0, 0), V(1, 0, 1), V(0, 1, 1), V(1, 1, 0) }),
    // All four edges straight, a bulge inside.
    BezierSurface(2,
      { V(0, 0, 0), V(1, 0, 0), V(2, 0, 0), V(0, 1, 0), V(1, 1, 3), V(2, 1, 0), V(0, 2, 0),
        V(1, 2, 0), V(2, 2, 0) }),
    // A plane with curved parameter lines.
    BezierSurface(2, { V(0, 0, 0), V(1, 0, 0), V(2, 0, 0), V(0, 1, 0), V(1, 3, 0), V(2, 2, 0) }),
  };
  for (const Spline& surface : surfaces)
  {
    const Patch patch = MakePatch(surface);
    for (double tolerance : { 0.3, 0.05, 0.003 })
    {
      const SurfaceMesh mesh = TessellateBoundary(patch, 1, Tolerances(tolerance));
      EXPECT_FALSE(mesh.LimitReached);
      const double error = SurfaceErrors(patch, mesh).Position;
      EXPECT_LE(error, tolerance * Bound);
      EXPECT_GE(error, tolerance / 30);
      EXPECT_NEAR(CoveredPart(patch, mesh, 4), 1.0, 1e-9);
      EXPECT_TRUE(std::all_of(
        mesh.TriangleSides.begin(), mesh.TriangleSides.end(), [](int side) { return side == 4; }));
    }
  }
}

TEST(Tessellation, CollapsedEdgeGivesAFanAndTheNormalOfTheLimit)
{
  const Patch patch = MakePatch(SphereOctant());
  for (double tolerance : { 0.1, 0.01, 0.001 })
  {
    const SurfaceMesh mesh = TessellateBoundary(patch, 1, Tolerances(tolerance));
    EXPECT_TRUE(mesh.Normals.allFinite());
    EXPECT_LT((mesh.Normals - mesh.Points).cwiseAbs().maxCoeff(), 1e-5);
    double area = 0.0;
    double deepest = 0.0;
    for (Eigen::Index t = 0; t < mesh.Triangles.cols(); ++t)
    {
      const Eigen::Vector3d a = mesh.Points.col(mesh.Triangles(0, t));
      const Eigen::Vector3d b = mesh.Points.col(mesh.Triangles(1, t));
      const Eigen::Vector3d c = mesh.Points.col(mesh.Triangles(2, t));
      const Eigen::Vector3d cross = (b - a).cross(c - a);
      area += 0.5 * cross.norm();
      EXPECT_GT(cross.norm(), 0.0);
      EXPECT_GT(cross.dot(a + b + c), 0.0);
      for (int i = 0; i <= 10; ++i)
      {
        for (int j = 0; i + j <= 10; ++j)
        {
          deepest = std::max(deepest, 1.0 - ((i * a + j * b + (10 - i - j) * c) / 10).norm());
        }
      }
    }
    EXPECT_LE(deepest, tolerance * Bound);
    EXPECT_GE(deepest, tolerance / 30);
    // Nothing is missing: the area tends to an eighth of the sphere's.
    EXPECT_NEAR(area, std::acos(-1.0) / 2, 4 * tolerance);
  }
}

TEST(Tessellation, NeighboursHaveTheSamePointsOnTheirInterface)
{
  std::mt19937 random(8);
  for (int trial = 0; trial < 6; ++trial)
  {
    const Spline first = WobblyCube(random, { 2, 3, 2 }, 3, trial % 2 == 0);
    // The second patch begins (w = first) where the first ends (u = last); its u runs along the
    // w of the first and its v against the v.
    const auto size = first.Sizes();
    std::vector<double> reversed = first.Knots(1).Knots();
    std::reverse(reversed.begin(), reversed.end());
    for (double& knot : reversed)
    {
      knot = -knot;
    }
    const std::array<KnotVector, 3> knots{ first.Knots(2), KnotVector(3, reversed),
      KnotVector::Uniform(3, 4) };
    const Spline noise = models::RandomSpline(random, knots, 3, first.IsRational());
    Eigen::MatrixXd points = noise.Coefficients();
    Eigen::VectorXd weights = noise.Weights();
    for (int j = 0; j < size[1]; ++j)
    {
      for (int i = 0; i < size[2]; ++i)
      {
        const Eigen::Index from = size[0] - 1 +
          static_cast<Eigen::Index>(size[0]) *
            (size[1] - 1 - j + static_cast<Eigen::Index>(size[1]) * i);
        const Eigen::Index to = i + static_cast<Eigen::Index>(size[2]) * j;
        points.col(to) = first.Coefficients().col(from);
        if (first.IsRational())
        {
          weights[to] = first.Weights()[from];
        }
      }
    }
    std::vector<Eigen::Vector3d> sets[2];
    const Patch patches[2] = { MakePatch(first), MakePatch(Spline(knots, points, weights)) };
    const int sides[2] = { 1, 4 };
    for (int p = 0; p < 2; ++p)
    {
      Patch patch = patches[p];
      patch.IsDomainFace.fill(false);
      patch.IsDomainFace[static_cast<std::size_t>(sides[p])] = true;
      const SurfaceMesh mesh = TessellateBoundary(patch, 1, Tolerances(0.002));
      for (Eigen::Index i = 0; i < mesh.Points.cols(); ++i)
      {
        sets[p].push_back(mesh.Points.col(i));
      }
    }
    ASSERT_EQ(sets[0].size(), sets[1].size());
    for (const Eigen::Vector3d& point : sets[0])
    {
      EXPECT_TRUE(std::any_of(sets[1].begin(), sets[1].end(),
        [&](const Eigen::Vector3d& other) { return (point - other).norm() < 1e-13; }));
    }
  }
}

TEST(Tessellation, PiecesGiveTheTrianglesOfTheWhole)
{
  std::mt19937 random(9);
  for (bool rational : { false, true })
  {
    const Spline cube = WobblyCube(random, { 2, 3, 2 }, 5, rational);
    const Patch whole = MakePatch(cube, { OwnAttribute(random, cube, 1) });
    const TessellationOptions options = Tolerances(0.004, { 0.2 });
    std::array<int, 3> spans{};
    for (int d = 0; d < 3; ++d)
    {
      spans[static_cast<std::size_t>(d)] = static_cast<int>(cube.Knots(d).Spans().size());
    }
    std::vector<SurfaceMesh> pieces;
    for (int n = 0; n < 8; ++n)
    {
      std::array<int, 3> begin{};
      std::array<int, 3> end = spans;
      for (std::size_t d = 0; d < 3; ++d)
      {
        const int cut = spans[d] / 2;
        ((n >> d) % 2 == 0 ? end[d] : begin[d]) = cut;
      }
      const Patch piece = RestrictPatch(whole, begin, end);
      pieces.push_back(TessellateBoundary(piece, 1, options));
      for (Eigen::Index t = 0; t < pieces.back().Triangles.cols(); ++t)
      {
        for (Eigen::Index d = 0; d < 3; ++d)
        {
          const int element = pieces.back().TriangleElements(d, t);
          ASSERT_GE(element, begin[static_cast<std::size_t>(d)]);
          ASSERT_LT(element, end[static_cast<std::size_t>(d)]);
        }
      }
    }
    EXPECT_EQ(TriangleSet(pieces), TriangleSet({ TessellateBoundary(whole, 1, options) }));
  }
}

TEST(Tessellation, TrianglesAndLinesLieInTheirElementAndSide)
{
  std::mt19937 random(10);
  const Spline cube = WobblyCube(random, { 2, 1, 3 }, 3, true);
  const Patch patch = MakePatch(cube, { OwnAttribute(random, cube, 1) });
  TessellationOptions options = Tolerances(0.01, { 0.2 });
  options.KnotLines = true;
  const SurfaceMesh mesh = TessellateBoundary(patch, 1, options);
  const auto check =
    [&](const auto& cells, const std::vector<int>& sides, const Eigen::Matrix3Xi& elements)
  {
    ASSERT_EQ(cells.cols(), elements.cols());
    ASSERT_EQ(static_cast<std::size_t>(cells.cols()), sides.size());
    for (Eigen::Index c = 0; c < cells.cols(); ++c)
    {
      const int side = sides[static_cast<std::size_t>(c)];
      for (Eigen::Index i = 0; i < cells.rows(); ++i)
      {
        const Eigen::Vector3d u = mesh.Parameters.col(cells(i, c));
        const KnotVector& across = cube.Knots(side / 2);
        ASSERT_EQ(u[side / 2], side % 2 == 0 ? across.First() : across.Last());
        for (int d = 0; d < 3; ++d)
        {
          const auto breaks = cube.Knots(d).Breaks();
          const auto e = static_cast<std::size_t>(elements(d, c));
          ASSERT_GE(u[d], breaks[e]);
          ASSERT_LE(u[d], breaks[e + 1]);
        }
      }
    }
  };
  check(mesh.Triangles, mesh.TriangleSides, mesh.TriangleElements);
  check(mesh.Lines, mesh.LineSides, mesh.LineElements);
  // Each segment runs along a knot of the geometry and is an edge of a triangle.
  std::map<std::pair<std::int64_t, std::int64_t>, int> edges;
  for (Eigen::Index t = 0; t < mesh.Triangles.cols(); ++t)
  {
    for (int i = 0; i < 3; ++i)
    {
      const auto [a, b] = std::minmax({ mesh.Triangles(i, t), mesh.Triangles((i + 1) % 3, t) });
      ++edges[{ a, b }];
    }
  }
  double length = 0.0;
  for (Eigen::Index l = 0; l < mesh.Lines.cols(); ++l)
  {
    const auto [a, b] = std::minmax({ mesh.Lines(0, l), mesh.Lines(1, l) });
    ASSERT_EQ(edges.count({ a, b }), 1u);
    length += (mesh.Parameters.col(a) - mesh.Parameters.col(b)).norm();
  }
  double expected = 0.0;
  for (int d = 0; d < 3; ++d)
  {
    const double breaks[2] = { double(cube.Knots((d + 1) % 3).Breaks().size()),
      double(cube.Knots((d + 2) % 3).Breaks().size()) };
    expected += (cube.Knots(d).Last() - cube.Knots(d).First()) * 2 * (breaks[0] + breaks[1]);
  }
  EXPECT_NEAR(length, expected, 1e-10 * expected);
}

TEST(Tessellation, NormalsPointOutOfRightAndLeftHandedVolumes)
{
  for (int handedness : { 1, -1 })
  {
    Spline tube = models::QuarterTube();
    if (handedness < 0)
    {
      Eigen::MatrixXd mirrored = tube.Coefficients();
      mirrored.row(2) *= -1.0;
      tube = Spline(tube.Knots(), mirrored, tube.Weights());
    }
    const SurfaceMesh mesh = TessellateBoundary(MakePatch(tube), handedness, Tolerances(0.01));
    EXPECT_NEAR(EnclosedVolume(mesh), 0.75 * std::acos(-1.0), 0.05);
    const Eigen::Vector3d middle(1.5 * std::sqrt(0.5), 1.5 * std::sqrt(0.5), 0.5 * handedness);
    for (Eigen::Index t = 0; t < mesh.Triangles.cols(); ++t)
    {
      const int side = mesh.TriangleSides[static_cast<std::size_t>(t)];
      const Eigen::Vector3d a = mesh.Points.col(mesh.Triangles(0, t));
      const Eigen::Vector3d cross = (mesh.Points.col(mesh.Triangles(1, t)) - a)
                                      .cross(mesh.Points.col(mesh.Triangles(2, t)) - a);
      for (int i = 0; i < 3; ++i)
      {
        const Eigen::Vector3d point = mesh.Points.col(mesh.Triangles(i, t));
        const Eigen::Vector3d normal = mesh.Normals.col(mesh.Triangles(i, t));
        EXPECT_NEAR(normal.norm(), 1.0, 1e-14);
        EXPECT_GT(normal.dot(cross), 0.0);
        if (side == 0 || side == 1)
        {
          const Eigen::Vector3d radial(point[0], point[1], 0.0);
          EXPECT_NEAR(normal.dot(radial.normalized()), side == 0 ? -1.0 : 1.0, 1e-12);
        }
        else
        {
          EXPECT_GT(normal.dot(point - middle), 0.0);
        }
      }
    }
  }
}

TEST(Tessellation, ThreadsAndTheirChunksDoNotMatter)
{
  std::mt19937 random(11);
  const Spline cube = WobblyCube(random, { 3, 2, 2 }, 4, true);
  const Patch patch = MakePatch(cube, { OwnAttribute(random, cube, 2) });
  TessellationOptions serial = Tolerances(0.003, { 0.3 });
  TessellationOptions threaded = serial;
  threaded.For = [](std::ptrdiff_t count, std::ptrdiff_t,
                   const std::function<void(std::ptrdiff_t, std::ptrdiff_t)>& body)
  {
    std::vector<std::thread> threads;
    for (std::ptrdiff_t t = 3; t >= 0; --t)
    {
      threads.emplace_back(
        [=]
        {
          if (count * t / 4 < count * (t + 1) / 4)
          {
            body(count * t / 4, count * (t + 1) / 4);
          }
        });
    }
    for (std::thread& thread : threads)
    {
      thread.join();
    }
  };
  const SurfaceMesh a = TessellateBoundary(patch, 1, serial);
  const SurfaceMesh b = TessellateBoundary(patch, 1, threaded);
  EXPECT_EQ(a.Triangles, b.Triangles);
  EXPECT_EQ(a.Points, b.Points);
  EXPECT_EQ(a.Normals, b.Normals);
  EXPECT_EQ(a.Attributes[0], b.Attributes[0]);
  const SolidMesh c = TessellateSolid(patch, 1, serial);
  const SolidMesh d = TessellateSolid(patch, 1, threaded);
  EXPECT_EQ(c.Hexahedra, d.Hexahedra);
  EXPECT_EQ(c.Points, d.Points);
  EXPECT_EQ(c.Attributes[0], d.Attributes[0]);
}

TEST(Tessellation, CurvesAreWithinTolerance)
{
  std::mt19937 random(12);
  for (int direction = 0; direction < 3; ++direction)
  {
    std::array<KnotVector, 3> knots;
    knots[static_cast<std::size_t>(direction)] = models::RandomKnots(random, 3, 9, true);
    const Patch patch = MakePatch(models::RandomSpline(random, knots, 2, true));
    const SurfaceMesh mesh = TessellateBoundary(patch, 1, Tolerances(0.01));
    EXPECT_EQ(mesh.Triangles.cols(), 0);
    std::vector<Eigen::Vector2d> samples;
    for (int i = 0; i <= 20; ++i)
    {
      samples.emplace_back(i / 20.0, 1.0 - i / 20.0);
    }
    const double error = SampleErrors(patch, mesh, mesh.Lines, samples).Position;
    EXPECT_LE(error, 0.01 * Bound);
    EXPECT_GE(error, 0.01 / 4);
  }
}

TEST(Tessellation, HexahedraAreWithinToleranceAndPositive)
{
  std::mt19937 random(13);
  for (int trial = 0; trial < 2; ++trial)
  {
    const Spline cube = WobblyCube(random, { 2, 3, 1 }, 2, trial % 2 == 0);
    const Patch patch = MakePatch(cube, { OwnAttribute(random, cube, 2) });
    const SolidMesh mesh = TessellateSolid(patch, 1, Tolerances(0.01, { 0.5 }));
    const Errors errors = SolidErrors(patch, mesh);
    EXPECT_LE(errors.Position, 0.01 * Bound);
    EXPECT_LE(errors.Attributes[0], 0.5 * Bound);
    EXPECT_GE(errors.Attributes[0], 0.5 / 30);
  }
  const double exact = 0.75 * std::acos(-1.0);
  double before = 1.0;
  for (double tolerance : { 0.1, 0.01, 0.001 })
  {
    for (int handedness : { 1, -1 })
    {
      Spline tube = models::QuarterTube();
      Eigen::MatrixXd points = tube.Coefficients();
      points.row(2) *= handedness;
      const Patch patch = MakePatch(Spline(tube.Knots(), points, tube.Weights()));
      const SolidMesh mesh = TessellateSolid(patch, handedness, Tolerances(tolerance));
      const double distance = SolidErrors(patch, mesh).Position;
      EXPECT_LE(distance, tolerance * Bound);
      EXPECT_GE(distance, tolerance / 4);
      double volume = 0.0;
      for (Eigen::Index h = 0; h < mesh.Hexahedra.cols(); ++h)
      {
        // These are prisms over plane quadrilaterals: base times height is their volume.
        const auto corner = [&](int i) -> Eigen::Vector3d
        { return mesh.Points.col(mesh.Hexahedra(i, h)); };
        const Eigen::Vector3d base = 0.5 * (corner(2) - corner(0)).cross(corner(3) - corner(1));
        const double part = base.dot(corner(4) - corner(0));
        EXPECT_GT(part, 0.0);
        volume += part;
      }
      const double error = std::abs(volume - exact);
      EXPECT_LE(error, 4 * tolerance);
      if (handedness < 0)
      {
        EXPECT_LE(error, 0.25 * before);
        before = error;
      }
    }
  }
}

TEST(Tessellation, StraightBoxHasTwelveTrianglesAndOneHexahedron)
{
  const Spline box(
    { KnotVector::Uniform(1, 2), KnotVector::Uniform(1, 2), KnotVector::Uniform(1, 2) },
    (Eigen::MatrixXd(3, 8) << 0, 2, 0, 2, 0, 2, 0, 2, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 1,
      1)
      .finished());
  EXPECT_EQ(TessellateBoundary(MakePatch(box), 1, Tolerances(1e-6)).Triangles.cols(), 12);
  EXPECT_EQ(TessellateSolid(MakePatch(box), 1, Tolerances(1e-6)).Hexahedra.cols(), 1);
}

TEST(Tessellation, SaysWhenTheLimitStopsIt)
{
  TessellationOptions options = Tolerances(1e-6);
  options.MaximumSubdivision = 8;
  const Patch patch = MakePatch(models::QuarterTube());
  const SurfaceMesh mesh = TessellateBoundary(patch, 1, options);
  EXPECT_TRUE(mesh.LimitReached);
  EXPECT_EQ(ExpectClosed(mesh), 2);
  EXPECT_TRUE(TessellateSolid(patch, 1, options).LimitReached);
}

TEST(Tessellation, RefusesBadOptions)
{
  const Patch patch = MakePatch(models::QuarterTube(), { { "position", models::QuarterTube() } });
  for (double tolerance : { 0.0, -1.0, double(NAN), double(INFINITY) })
  {
    EXPECT_THROW(TessellateBoundary(patch, 1, Tolerances(tolerance)), Error);
  }
  EXPECT_THROW(TessellateBoundary(patch, 0, Tolerances(1.0)), Error);
  EXPECT_THROW(TessellateBoundary(patch, 1, Tolerances(1.0, { 1.0, 1.0 })), Error);
  EXPECT_THROW(TessellateBoundary(patch, 1, Tolerances(1.0, { -1.0 })), Error);
  EXPECT_THROW(TessellateBoundary(patch, 1, Tolerances(1.0, { double(NAN) })), Error);
  EXPECT_NO_THROW(TessellateBoundary(patch, 1, Tolerances(1.0, { double(INFINITY) })));
  TessellationOptions options;
  options.MaximumSubdivision = 0;
  EXPECT_THROW(TessellateBoundary(patch, 1, options), Error);
  EXPECT_THROW(TessellateSolid(MakePatch(SphereOctant()), 1, Tolerances(1.0)), Error);
}
