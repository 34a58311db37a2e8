// SPDX-License-Identifier: BSD-3-Clause
#include "Interfaces.h"
#include "Operators.h"
#include "Primitives.h"
#include "QuadricField.h"
#include "Splines/Models.h"
#include "Splines/TurnedPatches.h"
#include "Splines/Weld.h"
#include "ZeroSetGroup.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <condition_variable>
#include <cstring>
#include <map>
#include <mutex>
#include <numeric>
#include <set>
#include <thread>

using namespace hyperpatch;
using models::Curved;
using models::Split;
using models::Turn;
using models::Turned;
using models::Weld;
using models::Welded;

namespace
{

constexpr double Pi = 3.14159265358979323846;

using MakeField = std::function<std::shared_ptr<const ScalarField>(const PreparedAggregate&)>;

MakeField Slice(const Quadric& quadric)
{
  return [quadric](const PreparedAggregate& body)
  { return std::make_shared<const QuadricField>(body.Geometry(), quadric, true); };
}

MakeField Isosurface(double value)
{
  return [value](const PreparedAggregate& body)
  {
    return std::make_shared<const QuadricField>(
      body.Attributes()[0], ComponentEquals(body.Attributes()[0]->Spline(), 0, value), false);
  };
}

Quadric Sphere(const Eigen::Vector3d& centre, double radius)
{
  return { Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero(), -radius * radius, centre };
}

Quadric Plane(const Eigen::Vector3d& normal, const Eigen::Vector3d& origin)
{
  return { Eigen::MatrixXd(), normal, 0.0, origin };
}

/// What a group draws, all members together.
struct Drawn
{
  std::vector<ZeroSetMesh> Meshes;
  ZeroSetCertificate Certificate;
};

Drawn Draw(const std::vector<const Patch*>& patches, const std::vector<Interface>& interfaces,
  const MakeField& makeField, double tolerance, ZeroSetGroup::Ranks ranks = {},
  ParallelFor parallelFor = SerialFor)
{
  std::vector<ZeroSetGroup::Member> members;
  std::vector<std::shared_ptr<const ScalarField>> fields;
  for (const Patch* patch : patches)
  {
    auto body = std::make_shared<const PreparedAggregate>(patch->Body);
    fields.push_back(makeField(*body));
    ZeroSetOptions options;
    options.Tolerance = tolerance;
    options.Handedness = patch->WholeHandedness < 0 ? -1 : 1;
    members.push_back({ patch, body, fields.back().get(), 0, options });
  }
  ZeroSetGroup group(members, interfaces, std::move(ranks), std::move(parallelFor));
  EXPECT_TRUE(group.Extract());
  Drawn drawn{ {}, group.TotalCertificate() };
  for (std::size_t m = 0; m < members.size(); ++m)
  {
    drawn.Meshes.push_back(group.Mesh(m));
  }
  return drawn;
}

Drawn Draw(const MultiPatch& model, const MakeField& makeField, double tolerance)
{
  std::vector<const Patch*> patches;
  for (const Patch& patch : model.Patches)
  {
    patches.push_back(&patch);
  }
  return Draw(patches, model.Interfaces, makeField, tolerance);
}

void ExpectNoCrack(const ZeroSetCertificate& certificate)
{
  EXPECT_EQ(certificate.OpenEdgesInside, 0);
  EXPECT_EQ(certificate.OpenEdgesOnInterfaces, 0);
  EXPECT_EQ(certificate.UndecidedCells, 0);
  EXPECT_TRUE(certificate.ToleranceReached);
}

/// Runs work(rank, gather) for each rank in a thread of its own.
void OnRanks(int count, const std::function<void(ZeroSetGroup::Ranks)>& work)
{
  std::mutex mutex;
  std::condition_variable changed;
  std::vector<std::vector<double>> given(static_cast<std::size_t>(count));
  int arrived = 0;
  int left = 0;
  const auto gather = [&](int rank, const std::vector<double>& records)
  {
    std::unique_lock<std::mutex> lock(mutex);
    changed.wait(lock, [&] { return left == 0; });
    given[static_cast<std::size_t>(rank)] = records;
    ++arrived;
    changed.notify_all();
    changed.wait(lock, [&] { return arrived == count; });
    std::vector<double> all;
    for (const auto& one : given)
    {
      all.insert(all.end(), one.begin(), one.end());
    }
    if (++left == count)
    {
      arrived = left = 0;
    }
    changed.notify_all();
    // Nobody begins the next one before all have read this one.
    changed.wait(lock, [&] { return left == 0; });
    return all;
  };
  std::vector<std::thread> threads;
  for (int rank = 0; rank < count; ++rank)
  {
    threads.emplace_back(
      [&, rank]
      {
        work({ rank,
          [&gather, rank](const std::vector<double>& records) { return gather(rank, records); } });
      });
  }
  for (std::thread& thread : threads)
  {
    thread.join();
  }
}

}

TEST(ZeroSetGroup, TwoPatchesInEveryOrientationGiveOneSphere)
{
  const Aggregate whole = Curved(1);
  for (int n = 0; n < 48; ++n)
  {
    const MultiPatch model =
      Split(whole, { 2, 1, 1 }, { Turn::Number(n * 7 % 48), Turn::Number(n) });
    ASSERT_EQ(model.Interfaces.size(), 1u);
    const Drawn drawn = Draw(model, Slice(Sphere({ 0.51, 0.48, 0.5 }, 0.3)), 3e-3);
    const Welded welded = Weld(drawn.Meshes);
    EXPECT_EQ(welded.Open, 0) << n;
    EXPECT_EQ(welded.Twice, 0) << n;
    EXPECT_EQ(welded.Euler, 2) << n;
    ExpectNoCrack(drawn.Certificate);
    EXPECT_EQ(drawn.Certificate.OpenEdgesOnBoundary, 0);
    // Its points on the common face are those of both sides.
    EXPECT_GT(
      static_cast<std::size_t>(drawn.Meshes[0].Points.cols() + drawn.Meshes[1].Points.cols()),
      welded.Points.size());
  }
}

TEST(ZeroSetGroup, EightPatchesAroundAVertexGiveOneSurface)
{
  std::mt19937 random(5);
  for (int seed = 0; seed < 12; ++seed)
  {
    std::vector<Turn> turns;
    for (int i = 0; i < 8; ++i)
    {
      turns.push_back(Turn::Number(static_cast<int>(random() % 48)));
    }
    const MultiPatch model = Split(Curved(seed), { 2, 2, 2 }, turns);
    ASSERT_EQ(model.Interfaces.size(), 12u);
    const Drawn sphere = Draw(model, Slice(Sphere({ 0.5, 0.5, 0.5 }, 0.3)), 1e-2);
    Welded welded = Weld(sphere.Meshes);
    EXPECT_EQ(welded.Open, 0) << seed;
    EXPECT_EQ(welded.Euler, 2) << seed;
    ExpectNoCrack(sphere.Certificate);

    const Drawn iso = Draw(model, Isosurface(0.05), 1e-2);
    welded = Weld(iso.Meshes);
    EXPECT_EQ(welded.Open, iso.Certificate.OpenEdgesOnBoundary) << seed;
    EXPECT_EQ(welded.Twice, 0) << seed;
    EXPECT_EQ(iso.Certificate.OpenEdgesInside, 0) << seed;
    EXPECT_EQ(iso.Certificate.OpenEdgesOnInterfaces, 0) << seed;
  }
}

TEST(ZeroSetGroup, PlanesThroughVerticesEdgesAndFacesOfEightPatchesAreClosed)
{
  // The unit cube: planes meet its interfaces exactly.
  const KnotVector k = KnotVector::Uniform(2, 4);
  Eigen::MatrixXd points(3, 64);
  for (int i = 0; i < 64; ++i)
  {
    points.col(i) << k.Greville(i % 4), k.Greville(i / 4 % 4), k.Greville(i / 16);
  }
  std::mt19937 random(2);
  const Eigen::Vector3d middle(0.5, 0.5, 0.5);
  for (int seed = 0; seed < 6; ++seed)
  {
    std::vector<Turn> turns;
    for (int i = 0; i < 8; ++i)
    {
      turns.push_back(Turn::Number(seed == 0 ? 0 : static_cast<int>(random() % 48)));
    }
    const MultiPatch model = Split(Aggregate(Spline({ k, k, k }, points)), { 2, 2, 2 }, turns);
    for (const Eigen::Vector3d& normal : { Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, -1, 0),
           Eigen::Vector3d(1, 1, 0), Eigen::Vector3d(1, -1, 0), Eigen::Vector3d(0, 1, 1),
           Eigen::Vector3d(1, 1, 1), Eigen::Vector3d(1, 2, 0), Eigen::Vector3d(0.3, -0.2, 1.0) })
    {
      const Drawn drawn = Draw(model, Slice(Plane(normal, middle)), 1e-3);
      const Welded welded = Weld(drawn.Meshes);
      // The area of the plane in the cube, from the length of its outline in two dimensions.
      const Eigen::Vector3d n = normal.cwiseAbs() / normal.norm();
      if (n.minCoeff() == 0.0)
      {
        EXPECT_NEAR(welded.Area, 1.0 / n.maxCoeff(), 1e-12) << seed << " " << normal.transpose();
      }
      EXPECT_EQ(welded.Euler, 1) << seed << " " << normal.transpose();
      EXPECT_EQ(welded.Twice, 0) << seed << " " << normal.transpose();
      EXPECT_EQ(drawn.Certificate.OpenEdgesInside, 0) << seed << " " << normal.transpose();
      EXPECT_EQ(drawn.Certificate.OpenEdgesOnInterfaces, 0) << seed << " " << normal.transpose();
      EXPECT_EQ(welded.Open, drawn.Certificate.OpenEdgesOnBoundary)
        << seed << " " << normal.transpose();
    }
  }
}

TEST(ZeroSetGroup, PatchesWithSmallGapsCloseEvenWhereSignsDifferOnBothSides)
{
  // Control points with eight digits, as files have them, and planes through the common vertex.
  std::mt19937 random(21);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int seed = 0; seed < 8; ++seed)
  {
    std::vector<Turn> turns;
    for (int i = 0; i < 8; ++i)
    {
      turns.push_back(Turn::Number(static_cast<int>(random() % 48)));
    }
    const Aggregate whole = Curved(seed);
    MultiPatch model = Split(whole, { 2, 2, 2 }, turns);
    for (Patch& patch : model.Patches)
    {
      const Spline& old = patch.Body.Geometry();
      Eigen::MatrixXd points = old.Coefficients();
      for (Eigen::Index i = 0; i < points.size(); ++i)
      {
        points.data()[i] += 1e-8 * unit(random);
      }
      patch.Body = Aggregate(Spline(old.Knots(), points, old.Weights()));
    }
    const Eigen::Vector3d vertex = whole.Geometry().Evaluate(0.5, 0.5, 0.5);
    const Eigen::Vector3d normal(unit(random), unit(random), unit(random));
    const Drawn drawn = Draw(model, Slice(Plane(normal, vertex)), 1e-2);
    const Welded welded = Weld(drawn.Meshes);
    EXPECT_EQ(welded.Euler, 1) << seed;
    EXPECT_EQ(welded.Twice, 0) << seed;
    EXPECT_EQ(welded.Open, drawn.Certificate.OpenEdgesOnBoundary) << seed;
    EXPECT_EQ(drawn.Certificate.OpenEdgesInside, 0) << seed;
    EXPECT_EQ(drawn.Certificate.OpenEdgesOnInterfaces, 0) << seed;
  }
}

TEST(ZeroSetGroup, ATouchOnAnInterfaceIsUndecided)
{
  // |x - 1/2| in two boxes: zero on their common face, positive on both sides.
  const KnotVector k = KnotVector::Uniform(1, 2);
  MultiPatch model;
  for (int p = 0; p < 2; ++p)
  {
    Eigen::MatrixXd points(3, 8);
    Eigen::MatrixXd values(1, 8);
    for (int i = 0; i < 8; ++i)
    {
      points.col(i) << 0.5 * (p + i % 2), i / 2 % 2, i / 4;
      values(0, i) = std::abs(points(0, i) - 0.5);
    }
    model.Patches.push_back(
      { p, Aggregate(Spline({ k, k, k }, points), { { "A", Spline({ k, k, k }, values) } }) });
  }
  model.Interfaces = FindInterfaces(model, 1e-9);
  ASSERT_EQ(model.Interfaces.size(), 1u);
  const Drawn touch = Draw(model, Isosurface(0.0), 1e-2);
  EXPECT_EQ(Weld(touch.Meshes).Area, 0.0);
  EXPECT_GE(touch.Certificate.UndecidedCells, 2);
  // A plane in the face is drawn once, whichever side its normal points to.
  for (const double sign : { 1.0, -1.0 })
  {
    const Drawn plane =
      Draw(model, Slice(Plane(Eigen::Vector3d(sign, 0, 0), Eigen::Vector3d(0.5, 0, 0))), 1e-2);
    EXPECT_NEAR(Weld(plane.Meshes).Area, 1.0, 1e-14);
    EXPECT_EQ(plane.Certificate.UndecidedCells, 0);
    EXPECT_EQ(plane.Certificate.OpenEdgesInside, 0);
  }
}

/// A ring about the z axis of inner radius 1 and outer radius 2, closed with itself: u the radius,
/// v around, w the height; turned by `twist` half turns of its section on the way.
Aggregate Ring(int twist)
{
  const KnotVector u = KnotVector::Uniform(1, 2);
  const KnotVector v = KnotVector::Uniform(1, 13);
  Eigen::MatrixXd points(3, 52);
  Eigen::MatrixXd field(1, 52);
  for (int i = 0; i < 52; ++i)
  {
    const int j = i / 2 % 13 % 12;
    const bool isLast = i / 2 % 13 == 12;
    const double angle = 2.0 * Pi * j / 12.0;
    const double turn = twist * 0.5 * angle + (isLast ? twist * Pi : 0.0);
    const Eigen::Vector2d section(i % 2 - 0.5, i / 26 - 0.5);
    const Eigen::Vector2d at = Eigen::Rotation2Dd(turn) * section;
    points.col(i) << (1.5 + at[0]) * std::cos(angle), (1.5 + at[0]) * std::sin(angle), at[1];
    field(0, i) = at.squaredNorm() + 0.1 * std::cos(angle) + 0.2 * section[0] * (twist ? 0 : 1);
  }
  return Aggregate(Spline({ u, v, u }, points), { { "A", Spline({ u, v, u }, field) } });
}

TEST(ZeroSetGroup, ThePipeClosesAtItsSeam)
{
  MultiPatch model;
  model.Patches.push_back({ 7, Ring(0) });
  model.Interfaces = FindInterfaces(model, 1e-9);
  ASSERT_EQ(model.Interfaces.size(), 1u);
  // Across the seam at (1.5, 0, 0).
  const Drawn sphere = Draw(model, Slice(Sphere({ 1.5, 0.02, 0.03 }, 0.3)), 1e-3);
  const Welded welded = Weld(sphere.Meshes);
  EXPECT_EQ(welded.Open, 0);
  EXPECT_EQ(welded.Euler, 2);
  ExpectNoCrack(sphere.Certificate);
  // All around: a plane between, whose two outlines are closed.
  const Drawn plane = Draw(model, Slice(Plane({ 0, 0, 1 }, { 0, 0, 0.1 })), 1e-3);
  EXPECT_EQ(Weld(plane.Meshes).Euler, 0);
  ExpectNoCrack(plane.Certificate);
}

TEST(ZeroSetGroup, PrimitivesOfManyPatchesAreClosed)
{
  for (const MultiPatch& model :
    { MakeCylinder(1.0, 2.0, Parametrisation::Patches), MakeSphere(1.0, Parametrisation::Patches),
      MakeTorus(2.0, 1.0, Parametrisation::Patches), MakeTube(1.0, 2.0, 1.0) })
  {
    ASSERT_FALSE(model.Interfaces.empty());
    for (const Eigen::Vector3d& normal : { Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(1, 0, 0),
           Eigen::Vector3d(1, 1, 0), Eigen::Vector3d(1, 1, 1) })
    {
      const Drawn drawn = Draw(model, Slice(Plane(normal, Eigen::Vector3d::Zero())), 1e-2);
      const Welded welded = Weld(drawn.Meshes);
      ExpectNoCrack(drawn.Certificate);
      EXPECT_EQ(welded.Open, drawn.Certificate.OpenEdgesOnBoundary);
      EXPECT_EQ(welded.Twice, 0);
    }
  }
}

TEST(ZeroSetGroup, AOneSidedRingIsLeftOpenAndCounted)
{
  // Its lines would have to run against themselves. Turned, so that round-off tells both sides of
  // the seam apart.
  const Aggregate ring = Ring(1);
  const Eigen::Matrix3d turn =
    Eigen::AngleAxisd(0.7, Eigen::Vector3d(1.0, 2.0, 3.0).normalized()).toRotationMatrix();
  MultiPatch model;
  model.Patches.push_back(
    { 0, Aggregate(Spline(ring.Geometry().Knots(), turn * ring.Geometry().Coefficients())) });
  model.Interfaces = FindInterfaces(model, 1e-9);
  ASSERT_EQ(model.Interfaces.size(), 1u);
  const Drawn drawn =
    Draw(model, Slice(Plane(turn.col(2), Eigen::Vector3d(0.1 * turn.col(2)))), 1e-2);
  EXPECT_GT(drawn.Certificate.OpenEdgesOnInterfaces, 0);
  EXPECT_EQ(drawn.Certificate.OpenEdgesInside, 0);
}

TEST(ZeroSetGroup, AnIsosurfaceIsLeftOpenWhereItsAttributeJumps)
{
  MultiPatch model = Split(Curved(3), { 2, 1, 1 }, { Turn(), Turn::Number(17) });
  const Aggregate& body = model.Patches[1].Body;
  const Spline& old = body.Attributes()[0].Field;
  for (const double jump : { 1e-12, 1e-3 })
  {
    MultiPatch other = model;
    other.Patches[1].Body = Aggregate(body.Geometry(),
      { { "A", Spline(old.Knots(), old.Coefficients().array() + jump, old.Weights()) } });
    const Drawn drawn = Draw(other, Isosurface(0.05), 1e-2);
    EXPECT_EQ(drawn.Certificate.OpenEdgesInside, 0);
    EXPECT_EQ(drawn.Certificate.OpenEdgesOnInterfaces > 0, jump > 1e-6);
    // A slice knows nothing of it.
    const Drawn slice = Draw(other, Slice(Sphere({ 0.5, 0.5, 0.5 }, 0.3)), 1e-2);
    EXPECT_EQ(Weld(slice.Meshes).Open, 0);
  }
}

TEST(ZeroSetGroup, PatchesOfOtherKnotsOrDegreesCloseWhereTheMapsAgree)
{
  MultiPatch model = Split(Curved(4), { 2, 1, 1 }, { Turn(), Turn::Number(29) });
  const Aggregate& body = model.Patches[1].Body;
  model.Patches[1].Body = Aggregate(RefineUniformly(ElevateDegree(body.Geometry(), 1), { 2, 1, 3 }),
    { { "A", RefineUniformly(body.Attributes()[0].Field, { 1, 2, 1 }) } });
  for (const MakeField& field : { Slice(Sphere({ 0.5, 0.5, 0.5 }, 0.3)), Isosurface(0.02) })
  {
    const Drawn drawn = Draw(model, field, 3e-3);
    EXPECT_EQ(Weld(drawn.Meshes).Open, drawn.Certificate.OpenEdgesOnBoundary);
    EXPECT_EQ(drawn.Certificate.OpenEdgesInside, 0);
    EXPECT_EQ(drawn.Certificate.OpenEdgesOnInterfaces, 0);
  }
}

TEST(ZeroSetGroup, WithoutInterfacesSidesThatCoincideAreFound)
{
  std::vector<Turn> turns;
  for (int i = 0; i < 8; ++i)
  {
    turns.push_back(Turn::Number(13 * i % 48));
  }
  MultiPatch model = Split(Curved(2), { 2, 2, 2 }, turns);
  model.Interfaces.clear();
  const MakeField field = Slice(Sphere({ 0.5, 0.52, 0.5 }, 0.3));
  EXPECT_EQ(Weld(Draw(model, field, 1e-2).Meshes).Euler, 2);

  // Elements: each has the domain of the unit cube and the id of one patch.
  for (std::size_t p = 0; p < 8; ++p)
  {
    Patch& patch = model.Patches[p];
    std::array<KnotVector, 3> knots;
    for (std::size_t d = 0; d < 3; ++d)
    {
      const KnotVector& old = patch.Body.Geometry().Knots()[d];
      std::vector<double> k = old.Knots();
      for (double& x : k)
      {
        x = (x - old.First()) / (old.Last() - old.First());
      }
      knots[d] = KnotVector(old.Degree(), k);
    }
    patch.Body = Aggregate(
      Spline(knots, patch.Body.Geometry().Coefficients(), patch.Body.Geometry().Weights()));
    patch.Id = 0;
    patch.FirstSpan = { static_cast<int>(p), 0, 0 };
    patch.WholeSpans = { 8, 1, 1 };
    patch.IsDomainFace.fill(false);
  }
  const Drawn elements = Draw(model, field, 1e-2);
  EXPECT_EQ(Weld(elements.Meshes).Open, 0);
  EXPECT_EQ(Weld(elements.Meshes).Euler, 2);
  ExpectNoCrack(elements.Certificate);
}

TEST(ZeroSetGroup, RanksGiveWhatOneGives)
{
  std::vector<Turn> turns;
  for (int i = 0; i < 8; ++i)
  {
    turns.push_back(Turn::Number(11 * i % 48));
  }
  const MultiPatch model = Split(Curved(6), { 2, 2, 2 }, turns);
  const MakeField field = Isosurface(0.05);
  const Drawn one = Draw(model, field, 1e-2);
  for (const int ranks : { 2, 3 })
  {
    std::vector<ZeroSetMesh> meshes(8);
    std::mutex mutex;
    ZeroSetCertificate certificate;
    OnRanks(ranks,
      [&](ZeroSetGroup::Ranks own)
      {
        std::vector<const Patch*> patches;
        std::vector<std::size_t> which;
        for (std::size_t p = 0; p < 8; ++p)
        {
          if (static_cast<int>(p) * 5 % ranks == own.Own)
          {
            patches.push_back(&model.Patches[p]);
            which.push_back(p);
          }
        }
        const Drawn drawn = Draw(patches, model.Interfaces, field, 1e-2, own);
        const std::lock_guard<std::mutex> lock(mutex);
        certificate = drawn.Certificate;
        for (std::size_t i = 0; i < which.size(); ++i)
        {
          meshes[which[i]] = drawn.Meshes[i];
        }
      });
    for (std::size_t p = 0; p < 8; ++p)
    {
      EXPECT_EQ(meshes[p].Points, one.Meshes[p].Points);
      EXPECT_EQ(meshes[p].Cells, one.Meshes[p].Cells);
      EXPECT_EQ(meshes[p].Normals, one.Meshes[p].Normals);
    }
    EXPECT_EQ(certificate.OpenEdgesOnBoundary, one.Certificate.OpenEdgesOnBoundary);
    EXPECT_EQ(certificate.OpenEdgesInside, 0);
    EXPECT_EQ(certificate.OpenEdgesOnInterfaces, 0);
  }
}

TEST(ZeroSetGroup, PartsOfPatchesOnRanksGiveAClosedSphere)
{
  // Patches that are cut at other places than their neighbors.
  const MultiPatch model = Split(Curved(8), { 2, 1, 1 }, { Turn::Number(3), Turn::Number(40) });
  std::vector<Patch> parts;
  for (const Patch& patch : model.Patches)
  {
    std::array<int, 3> end{};
    for (std::size_t d = 0; d < 3; ++d)
    {
      end[d] = static_cast<int>(patch.Body.Geometry().Knots()[d].Spans().size());
    }
    const std::size_t cut = patch.Id == 0 ? 1 : 2;
    std::array<int, 3> first{};
    std::array<int, 3> last = end;
    last[cut] = 1;
    parts.push_back(RestrictPatch(patch, first, last));
    first[cut] = 1;
    parts.push_back(RestrictPatch(patch, first, end));
  }
  for (const int ranks : { 1, 2, 3 })
  {
    std::vector<ZeroSetMesh> meshes(4);
    std::mutex mutex;
    ZeroSetCertificate certificate;
    OnRanks(ranks,
      [&](ZeroSetGroup::Ranks own)
      {
        std::vector<const Patch*> patches;
        std::vector<std::size_t> which;
        for (std::size_t p = 0; p < parts.size(); ++p)
        {
          if (static_cast<int>(p) % ranks == own.Own)
          {
            patches.push_back(&parts[p]);
            which.push_back(p);
          }
        }
        const Drawn drawn =
          Draw(patches, model.Interfaces, Slice(Sphere({ 0.52, 0.47, 0.5 }, 0.33)), 2e-3, own);
        const std::lock_guard<std::mutex> lock(mutex);
        certificate = drawn.Certificate;
        for (std::size_t i = 0; i < which.size(); ++i)
        {
          meshes[which[i]] = drawn.Meshes[i];
        }
      });
    const Welded welded = Weld(meshes);
    EXPECT_EQ(welded.Open, 0) << ranks;
    EXPECT_EQ(welded.Euler, 2) << ranks;
    ExpectNoCrack(certificate);
    EXPECT_EQ(certificate.OpenEdgesOnBoundary, 0);
  }
}

TEST(ZeroSetGroup, ThreadsDoNotChangeTheResult)
{
  std::vector<Turn> turns;
  for (int i = 0; i < 8; ++i)
  {
    turns.push_back(Turn::Number(5 * i % 48));
  }
  const MultiPatch model = Split(Curved(9), { 2, 2, 2 }, turns);
  const ParallelFor two = [](std::ptrdiff_t count, std::ptrdiff_t grain,
                            const std::function<void(std::ptrdiff_t, std::ptrdiff_t)>& body)
  {
    const std::ptrdiff_t half = count / (2 * grain) * grain;
    std::thread other([&] { body(0, half); });
    body(half, count);
    other.join();
  };
  std::vector<const Patch*> patches;
  for (const Patch& patch : model.Patches)
  {
    patches.push_back(&patch);
  }
  for (const std::size_t count : { 8, 4 })
  {
    patches.resize(count);
    const Drawn one = Draw(patches, model.Interfaces, Isosurface(0.0), 1e-2);
    const Drawn threaded = Draw(patches, model.Interfaces, Isosurface(0.0), 1e-2, {}, two);
    for (std::size_t p = 0; p < count; ++p)
    {
      EXPECT_EQ(one.Meshes[p].Points, threaded.Meshes[p].Points);
      EXPECT_EQ(one.Meshes[p].Cells, threaded.Meshes[p].Cells);
    }
  }
}

TEST(ZeroSetGroup, AbortStopsTheWork)
{
  const MultiPatch model = Split(Curved(1), { 2, 1, 1 }, { Turn(), Turn() });
  std::vector<ZeroSetGroup::Member> members;
  std::vector<std::shared_ptr<const ScalarField>> fields;
  int asked = 0;
  for (const Patch& patch : model.Patches)
  {
    auto body = std::make_shared<const PreparedAggregate>(patch.Body);
    fields.push_back(Isosurface(0.0)(*body));
    ZeroSetOptions options;
    options.Abort = [&asked] { return ++asked > 20; };
    members.push_back({ &patch, body, fields.back().get(), 0, options });
  }
  ZeroSetGroup group(members, model.Interfaces);
  EXPECT_FALSE(group.Extract());
}
