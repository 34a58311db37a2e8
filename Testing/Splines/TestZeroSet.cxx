// SPDX-License-Identifier: BSD-3-Clause
#include "Error.h"
#include "JacobianField.h"
#include "QuadricField.h"
#include "SampledField.h"
#include "Splines/Models.h"
#include "ZeroSet.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <map>
#include <set>
#include <thread>

using namespace hyperpatch;

namespace
{

struct Result
{
  ZeroSetMesh Mesh;
  ZeroSetCertificate Certificate;
};

Result Extract(const Aggregate& body, const ScalarField& field, ZeroSetOptions options)
{
  ZeroSet zeroSet(body, field, std::move(options));
  zeroSet.Extract();
  return { zeroSet.Mesh(), zeroSet.Certificate() };
}

ZeroSetOptions WithTolerance(double tolerance)
{
  ZeroSetOptions options;
  options.Tolerance = tolerance;
  return options;
}

/// The identity map of a box, of any degree and knots.
Spline Box(std::array<KnotVector, 3> knots)
{
  const Eigen::Index nu = knots[0].Size();
  const Eigen::Index nv = knots[1].Size();
  const Eigen::Index nw = knots[2].Size();
  Eigen::MatrixXd points(3, nu * nv * nw);
  for (Eigen::Index i = 0; i < points.cols(); ++i)
  {
    points.col(i) << knots[0].Greville(static_cast<int>(i % nu)),
      knots[1].Greville(static_cast<int>(i / nu % nv)),
      knots[2].Greville(static_cast<int>(i / (nu * nv)));
  }
  return Spline(std::move(knots), points);
}

Spline UnitBox(int degree, int size)
{
  const KnotVector k = KnotVector::Uniform(degree, size);
  return Box({ k, k, k });
}

Quadric Sphere(const Eigen::Vector3d& centre, double radius)
{
  return { Eigen::Matrix3d::Identity(), -2.0 * centre, centre.squaredNorm() - radius * radius,
    Eigen::VectorXd() };
}

Quadric Plane(const Eigen::Vector3d& normal, double offset)
{
  return { Eigen::MatrixXd(), normal, -offset, Eigen::VectorXd() };
}

double Area(const ZeroSetMesh& mesh)
{
  double area = 0.0;
  for (Eigen::Index c = 0; c < mesh.Cells.cols(); ++c)
  {
    const Eigen::Vector3d a = mesh.Points.col(mesh.Cells(0, c));
    area += 0.5 *
      (Eigen::Vector3d(mesh.Points.col(mesh.Cells(1, c))) - a)
        .cross(Eigen::Vector3d(mesh.Points.col(mesh.Cells(2, c))) - a)
        .norm();
  }
  return area;
}

/// Directed edges that have no opposite partner, and whether any edge is used twice in one
/// direction.
struct Topology
{
  std::set<std::pair<std::int64_t, std::int64_t>> Open;
  bool Oriented = true;
  long Euler = 0;
};

Topology Inspect(const ZeroSetMesh& mesh)
{
  // Points on creases occur once per side, with the same bits.
  std::map<std::array<double, 3>, std::int64_t> firstAt;
  std::vector<std::int64_t> point;
  for (Eigen::Index v = 0; v < mesh.Points.cols(); ++v)
  {
    point.push_back(
      firstAt.try_emplace({ mesh.Points(0, v), mesh.Points(1, v), mesh.Points(2, v) }, v)
        .first->second);
  }
  const auto corner = [&](Eigen::Index c, int k)
  { return point[static_cast<std::size_t>(mesh.Cells(k % 3, c))]; };
  Topology topology;
  std::set<std::pair<std::int64_t, std::int64_t>> edges;
  std::set<std::int64_t> used;
  for (Eigen::Index c = 0; c < mesh.Cells.cols(); ++c)
  {
    for (int k = 0; k < 3; ++k)
    {
      used.insert(corner(c, k));
      topology.Oriented =
        edges.insert({ corner(c, k), corner(c, k + 1) }).second && topology.Oriented;
    }
  }
  long undirected = 0;
  for (const auto& [a, b] : edges)
  {
    const bool partner = edges.count({ b, a }) > 0;
    if (!partner)
    {
      topology.Open.insert({ a, b });
    }
    undirected += a < b || !partner ? 1 : 0;
  }
  topology.Euler = static_cast<long>(used.size()) - undirected + mesh.Cells.cols();
  return topology;
}

}

TEST(ZeroSet, SphereInABoxIsClosedAndWithinTolerance)
{
  const double radius = 0.35;
  const Eigen::Vector3d centre(0.51, 0.52, 0.49);
  for (int degree : { 1, 2, 3, 5, 9 })
  {
    const Aggregate body(UnitBox(degree, degree + 2));
    const QuadricField field(body.Geometry(), Sphere(centre, radius), true);
    for (double tolerance : { 1e-2, 1e-3 })
    {
      const Result r = Extract(body, field, WithTolerance(tolerance));
      EXPECT_TRUE(r.Certificate.ToleranceReached);
      EXPECT_EQ(r.Certificate.UndecidedCells, 0);
      const Topology topology = Inspect(r.Mesh);
      EXPECT_TRUE(topology.Open.empty());
      EXPECT_TRUE(topology.Oriented);
      EXPECT_EQ(topology.Euler, 2);
      for (Eigen::Index v = 0; v < r.Mesh.Points.cols(); ++v)
      {
        const Eigen::Vector3d outward = (r.Mesh.Points.col(v) - centre) / radius;
        EXPECT_NEAR(outward.norm(), 1.0, 1e-14);
        EXPECT_NEAR((r.Mesh.Normals.col(v) - outward).norm(), 0.0, 1e-12);
      }
      for (Eigen::Index c = 0; c < r.Mesh.Cells.cols(); ++c)
      {
        // The whole triangle: its point nearest to the centre bounds the chord error.
        for (int i = 0; i <= 8; ++i)
        {
          for (int j = 0; i + j <= 8; ++j)
          {
            const Eigen::Vector3d p = (i * r.Mesh.Points.col(r.Mesh.Cells(0, c)) +
                                        j * r.Mesh.Points.col(r.Mesh.Cells(1, c)) +
                                        (8 - i - j) * r.Mesh.Points.col(r.Mesh.Cells(2, c))) /
              8.0;
            EXPECT_LE(std::abs((p - centre).norm() - radius), 1.1 * tolerance);
          }
        }
        const Eigen::Vector3d a = r.Mesh.Points.col(r.Mesh.Cells(0, c));
        const Eigen::Vector3d n =
          (Eigen::Vector3d(r.Mesh.Points.col(r.Mesh.Cells(1, c))) - a)
            .cross(Eigen::Vector3d(r.Mesh.Points.col(r.Mesh.Cells(2, c))) - a);
        EXPECT_GT(n.dot(a - centre), 0.0);
      }
    }
  }
}

TEST(ZeroSet, PlaneThroughAQuarterTubeHasTheExactArea)
{
  const Aggregate body(models::QuarterTube());
  const Eigen::Vector3d normal(0.0, 0.0, 1.0);
  const QuadricField field(body.Geometry(), Plane(normal, 0.3), true);
  double previous = 1.0;
  for (double tolerance : { 1e-2, 1e-3, 1e-4 })
  {
    const Result r = Extract(body, field, WithTolerance(tolerance));
    const double exact = std::acos(-1.0) / 4 * (4.0 - 1.0);
    const double error = std::abs(Area(r.Mesh) - exact);
    // The outline is 3 pi / 2 + 2 long; both arcs count with the same sign of curvature.
    EXPECT_LT(error, 2.0 * std::acos(-1.0) * tolerance);
    EXPECT_LT(error, previous);
    previous = error;
    EXPECT_TRUE(r.Certificate.ToleranceReached);
    for (Eigen::Index v = 0; v < r.Mesh.Points.cols(); ++v)
    {
      EXPECT_NEAR(r.Mesh.Points(2, v), 0.3, 1e-15);
      EXPECT_NEAR((r.Mesh.Normals.col(v) - normal).norm(), 0.0, 1e-14);
      const Eigen::Vector3d on = body.Geometry().Evaluate(
        r.Mesh.Parameters(0, v), r.Mesh.Parameters(1, v), r.Mesh.Parameters(2, v));
      EXPECT_NEAR((on - r.Mesh.Points.col(v)).norm(), 0.0, 1e-14);
    }
  }
}

TEST(ZeroSet, JacobianSheetOfTheSweptHalfCylinderIsFlat)
{
  const Aggregate body(models::SweptHalfCylinder());
  const JacobianField field(body.Geometry());
  const Result r = Extract(body, field, WithTolerance(1e-3));
  ASSERT_GT(r.Mesh.Cells.cols(), 0);
  EXPECT_NEAR(Area(r.Mesh), 3.0, 1e-12);
  EXPECT_TRUE(Inspect(r.Mesh).Oriented);
  Eigen::AlignedBox3d box;
  for (Eigen::Index v = 0; v < r.Mesh.Points.cols(); ++v)
  {
    EXPECT_NEAR(r.Mesh.Points(1, v), 1.0, 1e-12);
    EXPECT_NEAR(r.Mesh.Normals.col(v).norm(), 1.0, 1e-12);
    box.extend(Eigen::Vector3d(r.Mesh.Points.col(v)));
  }
  EXPECT_NEAR((box.min() - Eigen::Vector3d(0, 1, 0)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((box.max() - Eigen::Vector3d(3, 1, 1)).norm(), 0.0, 1e-12);
}

TEST(ZeroSet, AttributeOfAnotherBasisIsCarriedWithinItsTolerance)
{
  std::mt19937 random(7);
  const KnotVector u(3, { 0, 0, 0, 0, 0.3, 0.7, 1, 1, 1, 1 });
  Attribute temperature{ "T",
    models::RandomSpline(
      random, { u, KnotVector::Uniform(2, 4), KnotVector::Uniform(1, 3) }, 1, true) };
  const Spline field = temperature.Field;
  const Aggregate body(models::QuarterTube(), { temperature });
  ZeroSetOptions options = WithTolerance(1e-2);
  options.AttributeTolerances = { 0.01 };
  const QuadricField plane(body.Geometry(), Plane({ 0.2, 0.1, 1.0 }, 0.7), true);
  const Result r = Extract(body, plane, options);
  ASSERT_GT(r.Mesh.Cells.cols(), 0);
  EXPECT_TRUE(r.Certificate.ToleranceReached);
  for (Eigen::Index v = 0; v < r.Mesh.Points.cols(); ++v)
  {
    const Eigen::Vector3d p = r.Mesh.Parameters.col(v);
    EXPECT_NEAR(r.Mesh.Attributes[0](0, v), field.Evaluate(p[0], p[1], p[2])[0], 1e-13);
  }
  // Dense samples of the exact slice against the triangle they fall into.
  double worst = 0.0;
  for (Eigen::Index c = 0; c < r.Mesh.Cells.cols(); ++c)
  {
    for (int i = 1; i < 6; ++i)
    {
      for (int j = 1; i + j < 6; ++j)
      {
        const Eigen::Vector3d weights = Eigen::Vector3d(i, j, 6 - i - j) / 6.0;
        Eigen::Vector3d target = Eigen::Vector3d::Zero();
        Eigen::Vector3d p = Eigen::Vector3d::Zero();
        double linear = 0.0;
        for (int k = 0; k < 3; ++k)
        {
          target += weights[k] * r.Mesh.Points.col(r.Mesh.Cells(k, c));
          p += weights[k] * r.Mesh.Parameters.col(r.Mesh.Cells(k, c));
          linear += weights[k] * r.Mesh.Attributes[0](0, r.Mesh.Cells(k, c));
        }
        const Evaluator geometry(body.Geometry());
        for (int newton = 0; newton < 5; ++newton)
        {
          Eigen::Vector3d x;
          Eigen::Matrix3d J;
          geometry.EvaluateWithDerivatives(1, p.data(), x.data(), J.data());
          p -= J.inverse() * (x - target);
        }
        worst = std::max(worst, std::abs(field.Evaluate(p[0], p[1], p[2])[0] - linear));
      }
    }
  }
  EXPECT_LE(worst, 1.1 * 0.01);
}

TEST(ZeroSet, OpenEdgesLieOnTheDomainFaces)
{
  std::mt19937 random(3);
  for (int seed = 0; seed < 20; ++seed)
  {
    const KnotVector k = models::RandomKnots(random, 1 + seed % 4, 6, seed % 2 == 0);
    const Spline attribute = models::RandomSpline(random, { k, k, k }, 1, seed % 3 == 0);
    const Spline geometry = Box({ k, k, k });
    const Aggregate body(geometry, { { "A", attribute } });
    const QuadricField field(attribute, ComponentEquals(attribute, 0, 0.05), false);
    const Result r = Extract(body, field, WithTolerance(2e-2 * (k.Last() - k.First())));
    const Topology topology = Inspect(r.Mesh);
    EXPECT_TRUE(topology.Oriented);
    for (const auto& [a, b] : topology.Open)
    {
      bool onFace = false;
      for (int d = 0; d < 3; ++d)
      {
        const double pa = r.Mesh.Parameters(d, a);
        onFace = onFace || (pa == r.Mesh.Parameters(d, b) && (pa == k.First() || pa == k.Last()));
      }
      EXPECT_TRUE(onFace);
    }
    for (Eigen::Index v = 0; v < r.Mesh.Points.cols(); ++v)
    {
      EXPECT_NEAR(r.Mesh.Attributes[0](0, v), 0.05, 1e-13);
    }
  }
}

TEST(ZeroSet, ZerosExactlyOnKnotPlanesGiveOneSheet)
{
  const KnotVector k(2, { 0, 0, 0, 0.25, 0.5, 0.5, 1, 1, 1 });
  const Aggregate body(Box({ k, k, k }));
  for (double offset : { 0.25, 0.5 })
  {
    const QuadricField field(body.Geometry(), Plane({ 1, 0, 0 }, offset), true);
    const Result r = Extract(body, field, WithTolerance(1e-3));
    EXPECT_NEAR(Area(r.Mesh), 1.0, 1e-14);
    EXPECT_TRUE(Inspect(r.Mesh).Oriented);
    EXPECT_EQ(Inspect(r.Mesh).Euler, 1);
  }
}

TEST(ZeroSet, TheRangeThatMissesIsEmptyAndCertain)
{
  const Aggregate body(UnitBox(3, 8));
  const Result r = Extract(
    body, QuadricField(body.Geometry(), Plane({ 1, 1, 1 }, 3.01), true), WithTolerance(1e-3));
  EXPECT_EQ(r.Mesh.Cells.cols(), 0);
  EXPECT_EQ(r.Mesh.Points.cols(), 0);
  EXPECT_EQ(r.Certificate.UndecidedCells, 0);
}

TEST(ZeroSet, SmallClosedSheetBetweenCornersIsFound)
{
  // One element; a sphere that no corner of the first grid sees.
  const Aggregate body(UnitBox(2, 3));
  const QuadricField field(body.Geometry(), Sphere({ 0.3, 0.6, 0.45 }, 0.05), true);
  const Result r = Extract(body, field, WithTolerance(1e-3));
  EXPECT_GT(r.Mesh.Cells.cols(), 0);
  EXPECT_TRUE(Inspect(r.Mesh).Open.empty());
  EXPECT_EQ(Inspect(r.Mesh).Euler, 2);
}

TEST(ZeroSet, TangentPlaneEndsInBoundedTimeAndIsCountedUndecided)
{
  // |x - c|^2 = 0 touches zero in one point and changes no sign.
  const Aggregate body(UnitBox(2, 4));
  const QuadricField field(body.Geometry(), Sphere({ 0.31, 0.47, 0.53 }, 0.0), true);
  const Result r = Extract(body, field, WithTolerance(1e-3));
  EXPECT_EQ(r.Mesh.Cells.cols(), 0);
  EXPECT_GE(r.Certificate.UndecidedCells, 1);
}

TEST(ZeroSet, SampledFunctionsCountAllCellsAsUndecided)
{
  const Aggregate body(UnitBox(1, 9));
  const SampledField field(body.Geometry(),
    [](std::size_t count, const double* points, double* values, double* gradients)
    {
      for (std::size_t i = 0; i < count; ++i)
      {
        const Eigen::Map<const Eigen::Vector3d> x(points + 3 * i);
        const Eigen::Vector3d d = x - Eigen::Vector3d::Constant(0.5);
        values[i] = d.norm() - 0.3;
        if (gradients)
        {
          Eigen::Map<Eigen::Vector3d>(gradients + 3 * i) = d.normalized();
        }
      }
    });
  const Result r = Extract(body, field, WithTolerance(5e-3));
  EXPECT_GE(r.Certificate.UndecidedCells, 512);
  EXPECT_EQ(Inspect(r.Mesh).Euler, 2);
  EXPECT_NEAR(Area(r.Mesh), 4 * std::acos(-1.0) * 0.09, 0.02);
}

TEST(ZeroSet, LeftHandedPatchesKeepTheSameSide)
{
  Spline geometry = models::QuarterTube();
  Eigen::MatrixXd mirrored = geometry.Coefficients();
  mirrored.row(2) *= -1.0;
  const Aggregate body(Spline(geometry.Knots(), mirrored, geometry.Weights()));
  ZeroSetOptions options = WithTolerance(1e-2);
  options.Handedness = -1;
  const Result r =
    Extract(body, QuadricField(body.Geometry(), Plane({ 0, 1, 0.1 }, 0.4), true), options);
  ASSERT_GT(r.Mesh.Cells.cols(), 0);
  const Eigen::Vector3d up = Eigen::Vector3d(0, 1, 0.1).normalized();
  for (Eigen::Index c = 0; c < r.Mesh.Cells.cols(); ++c)
  {
    const Eigen::Vector3d a = r.Mesh.Points.col(r.Mesh.Cells(0, c));
    const Eigen::Vector3d n = (Eigen::Vector3d(r.Mesh.Points.col(r.Mesh.Cells(1, c))) - a)
                                .cross(Eigen::Vector3d(r.Mesh.Points.col(r.Mesh.Cells(2, c))) - a);
    EXPECT_GE(n.dot(up), 0.0);
    EXPECT_NEAR((r.Mesh.Normals.col(r.Mesh.Cells(0, c)) - up).norm(), 0.0, 1e-13);
  }
}

TEST(ZeroSet, SurfacesGiveSegmentsAndCurvesPoints)
{
  const KnotVector k = KnotVector::Uniform(2, 5);
  const Aggregate sheet(Box({ k, k, KnotVector() }));
  const Result line = Extract(sheet,
    QuadricField(sheet.Geometry(), Sphere({ 0.5, 0.5, 0.5 }, 0.4), true), WithTolerance(1e-3));
  double length = 0.0;
  ASSERT_EQ(line.Mesh.Cells.rows(), 2);
  for (Eigen::Index c = 0; c < line.Mesh.Cells.cols(); ++c)
  {
    length +=
      (line.Mesh.Points.col(line.Mesh.Cells(0, c)) - line.Mesh.Points.col(line.Mesh.Cells(1, c)))
        .norm();
  }
  EXPECT_NEAR(length, 2 * std::acos(-1.0) * 0.4, 0.02);

  const Aggregate curve(Box({ k, KnotVector(), KnotVector() }));
  const Result point = Extract(
    curve, QuadricField(curve.Geometry(), Plane({ 1, 0, 0 }, 0.37), true), WithTolerance(1e-3));
  ASSERT_EQ(point.Mesh.Cells.rows(), 1);
  ASSERT_EQ(point.Mesh.Cells.cols(), 1);
  EXPECT_NEAR(point.Mesh.Points(0, 0), 0.37, 1e-15);
}

TEST(ZeroSet, ThreadsDoNotChangeTheResult)
{
  std::mt19937 random(11);
  const KnotVector k = KnotVector::Uniform(3, 9);
  const Spline attribute = models::RandomSpline(random, { k, k, k }, 1, true);
  const Aggregate body(Box({ k, k, k }), { { "A", attribute } });
  const QuadricField field(attribute, ComponentEquals(attribute, 0, 0.0), false);
  ZeroSetOptions serial = WithTolerance(2e-2);
  ZeroSetOptions threaded = serial;
  threaded.For = [](std::ptrdiff_t count, std::ptrdiff_t grain,
                   const std::function<void(std::ptrdiff_t, std::ptrdiff_t)>& body_)
  {
    std::atomic<std::ptrdiff_t> next{ 0 };
    const auto work = [&]
    {
      for (std::ptrdiff_t b = next.fetch_add(grain); b < count; b = next.fetch_add(grain))
      {
        body_(b, std::min(count, b + grain));
      }
    };
    std::thread a(work);
    std::thread b(work);
    a.join();
    b.join();
  };
  const Result one = Extract(body, field, serial);
  const Result two = Extract(body, field, threaded);
  EXPECT_EQ(one.Mesh.Points, two.Mesh.Points);
  EXPECT_EQ(one.Mesh.Cells, two.Mesh.Cells);
  EXPECT_EQ(one.Mesh.Normals, two.Mesh.Normals);
  EXPECT_EQ(one.Certificate.UndecidedCells, two.Certificate.UndecidedCells);
}

TEST(ZeroSet, AbortStopsTheWork)
{
  const Aggregate body(UnitBox(3, 12));
  ZeroSetOptions options = WithTolerance(1e-4);
  options.Abort = [] { return true; };
  const QuadricField field(body.Geometry(), Sphere({ 0.5, 0.5, 0.5 }, 0.4), true);
  ZeroSet zeroSet(body, field, options);
  EXPECT_FALSE(zeroSet.Extract());
}

TEST(ScalarField, RefusesWhatItCannotBe)
{
  const Spline tube = models::QuarterTube();
  EXPECT_THROW((void)ComponentEquals(tube, 3, 0.0), Error);
  EXPECT_THROW(QuadricField(tube,
                 { Eigen::MatrixXd(), Eigen::VectorXd::Ones(2), 0.0, Eigen::VectorXd() }, true),
    Error);
  const Spline sheet = Box({ KnotVector::Uniform(2, 3), KnotVector::Uniform(2, 3), KnotVector() });
  EXPECT_THROW(JacobianField{ sheet }, Error);
}

TEST(ScalarField, GradientsAreThoseOfTheValues)
{
  std::mt19937 random(5);
  const KnotVector k = KnotVector::Uniform(3, 5);
  const Spline geometry = models::RandomSpline(random, { k, k, k }, 3, true);
  Quadric q = Sphere({ 0.1, 0.2, -0.1 }, 0.3);
  q.A(0, 1) = q.A(1, 0) = 0.2;
  const QuadricField quadric(geometry, q, true);
  const JacobianField jacobian(geometry);
  const QuadricField plane(geometry, Plane({ 1, -2, 0.5 }, 0.1), true);
  for (const ScalarField* field :
    std::initializer_list<const ScalarField*>{ &quadric, &jacobian, &plane })
  {
    const Eigen::Vector3d p(0.41, 0.77, 0.13);
    double value = 0.0;
    Eigen::Vector3d gradient;
    field->EvaluateWithGradient(1, p.data(), &value, gradient.data());
    for (int d = 0; d < 3; ++d)
    {
      const double h = 1e-4;
      double sum = 0.0;
      // Central difference of order six: error h^6 times a derivative, and eps / h.
      static constexpr double Weights[3] = { 45.0, -9.0, 1.0 };
      for (int s = 1; s <= 3; ++s)
      {
        Eigen::Vector3d at = p;
        double plus = 0.0;
        double minus = 0.0;
        at[d] = p[d] + s * h;
        field->Evaluate(1, at.data(), &plus);
        at[d] = p[d] - s * h;
        field->Evaluate(1, at.data(), &minus);
        sum += Weights[s - 1] * (plus - minus);
      }
      EXPECT_NEAR(gradient[d], sum / (60.0 * h), 1e-9 * (1.0 + gradient.norm()));
    }
  }
}

TEST(ZeroSet, PlanesInFacesAndKnotPlanesOfTurnedBoxesAreThosePlanes)
{
  const KnotVector k(2, { 0, 0, 0, 0.25, 0.5, 0.5, 1, 1, 1 });
  const Spline box = Box({ k, k, k });
  std::mt19937 random(8);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int seed = 0; seed < 20; ++seed)
  {
    const Eigen::Matrix3d turn =
      Eigen::Quaterniond(unit(random), unit(random), unit(random), unit(random))
        .normalized()
        .toRotationMatrix();
    const Eigen::Vector3d shift(unit(random), unit(random), unit(random));
    const Eigen::MatrixXd turned = (turn * box.Coefficients()).colwise() + shift;
    const Aggregate body(Spline(box.Knots(), turned));
    for (double height : { 0.0, 0.25, 0.5, 1.0 })
    {
      for (double side : { 1.0, -1.0 })
      {
        const Eigen::Vector3d normal = side * turn.col(seed % 3);
        Eigen::Vector3d origin = Eigen::Vector3d::Unit(seed % 3) * height;
        origin = turn * origin + shift;
        const Result r =
          Extract(body, QuadricField(body.Geometry(), Plane(normal, normal.dot(origin)), true),
            WithTolerance(1e-3));
        // In a face of the domain too, whichever side of it the model is on.
        EXPECT_NEAR(Area(r.Mesh), 1.0, 1e-12);
        EXPECT_LE(r.Mesh.Cells.cols(), 18);
        EXPECT_TRUE(r.Certificate.ToleranceReached);
      }
    }
  }
}

TEST(ZeroSet, APlateauIsCountedAndEndsInBoundedTime)
{
  // Zero on [0, 1/4] in u, then growing.
  const KnotVector k(1, { 0, 0, 0.25, 0.5, 0.75, 1, 1 });
  const KnotVector v = KnotVector::Uniform(1, 2);
  Eigen::MatrixXd values(1, 20);
  for (int i = 0; i < 20; ++i)
  {
    values(0, i) = std::max(0, i % 5 - 1);
  }
  const Spline attribute({ k, v, v }, values);
  const Aggregate body(Box({ k, v, v }), { { "A", attribute } });
  const Result r = Extract(
    body, QuadricField(attribute, ComponentEquals(attribute, 0, 0.0), false), WithTolerance(1e-3));
  EXPECT_GE(r.Certificate.UndecidedCells, 1);
  EXPECT_TRUE(r.Certificate.ToleranceReached);
}

TEST(ZeroSet, ADomeOverALevelOutlineIsSeen)
{
  // Normals at all corners are upright, as those of the flat outline.
  // w = 0.3 + 0.8 u (1 - u) v (1 - v): 0.3 all around, 0.35 in the middle.
  const KnotVector k(2, { 0, 0, 0, 1, 1, 1 });
  Eigen::MatrixXd values(1, 27);
  for (int i = 0; i < 27; ++i)
  {
    values(0, i) = 0.5 * (i / 9) - 0.3 - (i % 9 == 4 ? 0.2 : 0.0);
  }
  const Spline field({ k, k, k }, values);
  const Aggregate body(Box({ k, k, k }), { { "f", field } });
  const Result r =
    Extract(body, QuadricField(field, ComponentEquals(field, 0, 0.0), false), WithTolerance(2e-3));
  EXPECT_TRUE(r.Certificate.ToleranceReached);
  EXPECT_NEAR(r.Mesh.Points.row(2).maxCoeff(), 0.35, 2e-3);
}

TEST(ZeroSet, AShortKnotSpanDoesNotHideTheSheet)
{
  // x = (u - 0.35)^2: det J = 0 on u = 0.35, whatever the knots elsewhere.
  for (double h : { 1e-2, 1e-6, 1e-8 })
  {
    const KnotVector k(3, { 0, 0, 0, 0, 0.5, 0.5 + h, 1, 1, 1, 1 });
    Eigen::MatrixXd points = Box({ k, k, k }).Coefficients();
    for (int i = 0; i < 216; ++i)
    {
      // The blossom of (u - a)^2 at the knots of the control point.
      const int n = i % 6;
      const double a[3] = { k[n + 1] - 0.35, k[n + 2] - 0.35, k[n + 3] - 0.35 };
      points(0, i) = (a[0] * a[1] + a[1] * a[2] + a[2] * a[0]) / 3.0;
    }
    const Aggregate body(Spline({ k, k, k }, points));
    const Result r = Extract(body, JacobianField(body.Geometry()), WithTolerance(1e-3));
    EXPECT_NEAR(Area(r.Mesh), 1.0, 1e-9) << h;
    for (Eigen::Index v = 0; v < r.Mesh.Parameters.cols(); ++v)
    {
      EXPECT_NEAR(r.Mesh.Parameters(0, v), 0.35, 1e-9) << h;
    }
  }
}

TEST(ZeroSet, LargeValuesElsewhereDoNotHideAnIsosurface)
{
  const KnotVector k = KnotVector::Uniform(3, 8);
  Eigen::MatrixXd values(1, 512);
  for (int i = 0; i < 512; ++i)
  {
    values(0, i) = k.Greville(i % 8);
  }
  values(0, 511) = 1e14;
  const Spline attribute({ k, k, k }, values);
  const Aggregate body(Box({ k, k, k }), { { "A", attribute } });
  const Result r = Extract(
    body, QuadricField(attribute, ComponentEquals(attribute, 0, 0.1), false), WithTolerance(1e-3));
  EXPECT_GT(Area(r.Mesh), 0.5);
}

TEST(ZeroSet, SpheresFarFromTheOriginAreSpheres)
{
  for (double far : { 0.0, 1e3, 1e6 })
  {
    const Eigen::Vector3d origin = Eigen::Vector3d::Constant(far);
    const Spline box = UnitBox(2, 4);
    const Aggregate body(Spline(box.Knots(), box.Coefficients().colwise() + origin));
    const Eigen::Vector3d centre = origin + Eigen::Vector3d::Constant(0.5);
    Quadric sphere = Sphere(Eigen::Vector3d::Zero(), 0.4);
    sphere.Origin = centre;
    const Result r =
      Extract(body, QuadricField(body.Geometry(), sphere, true), WithTolerance(1e-3));
    EXPECT_EQ(Inspect(r.Mesh).Euler, 2);
    EXPECT_TRUE(Inspect(r.Mesh).Open.empty());
    for (Eigen::Index v = 0; v < r.Mesh.Points.cols(); ++v)
    {
      EXPECT_NEAR((r.Mesh.Points.col(v) - centre).norm(), 0.4, 1e-14 + 1e-15 * far);
    }
  }
}

TEST(ZeroSet, ATouchOnAKnotPlaneIsUndecided)
{
  // |u - 1/2| is zero on the knot plane and positive on both sides.
  const KnotVector k(1, { 0, 0, 0.5, 1, 1 });
  const KnotVector v = KnotVector::Uniform(1, 2);
  Eigen::MatrixXd values(1, 12);
  for (int i = 0; i < 12; ++i)
  {
    values(0, i) = i % 3 == 1 ? 0.0 : 0.5;
  }
  const Spline attribute({ k, v, v }, values);
  const Aggregate body(Box({ k, v, v }), { { "A", attribute } });
  const Result r = Extract(
    body, QuadricField(attribute, ComponentEquals(attribute, 0, 0.0), false), WithTolerance(1e-3));
  EXPECT_EQ(r.Mesh.Cells.cols(), 0);
  EXPECT_GE(r.Certificate.UndecidedCells, 2);
}
