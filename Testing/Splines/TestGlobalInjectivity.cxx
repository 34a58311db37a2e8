// SPDX-License-Identifier: BSD-3-Clause
#include "Error.h"
#include "Evaluator.h"
#include "GlobalInjectivity.h"
#include "Operators.h"
#include "Reparametrise.h"
#include "Splines/Models.h"
#include "Splines/ValidityModels.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <gtest/gtest.h>

using namespace hyperpatch;

namespace
{

constexpr double Pi = 3.14159265358979323846;

MultiPatch Model(const std::vector<Spline>& geometries)
{
  MultiPatch model;
  for (const Spline& geometry : geometries)
  {
    model.Patches.push_back({ static_cast<int>(10 + model.Patches.size()), Aggregate(geometry) });
  }
  return model;
}

std::vector<PatchValidity> Validity(const MultiPatch& model)
{
  ValidityOptions options;
  options.Tolerance = 0.0;
  std::vector<PatchValidity> validity;
  for (const Patch& patch : model.Patches)
  {
    validity.push_back(TestValidity(patch.Body.Geometry(), options));
  }
  return validity;
}

Injectivity Tested(const MultiPatch& model, const InjectivityOptions& options = {})
{
  return TestInjectivity(model, Validity(model), options);
}

Injectivity Tested(const std::vector<Spline>& geometries, const InjectivityOptions& options = {})
{
  return Tested(Model(geometries), options);
}

/// The witness is two different points with one image, to rounding.
void ExpectWitness(const MultiPatch& model, const Injectivity& result)
{
  EXPECT_EQ(result.Verdict, -1);
  ASSERT_TRUE(result.Witness);
  const DoublePoint& witness = *result.Witness;
  Eigen::Vector3d images[2];
  for (std::size_t i = 0; i < 2; ++i)
  {
    for (const Patch& patch : model.Patches)
    {
      if (patch.Id == witness.Patches[i])
      {
        const auto& [u, v, w] = witness.Parameters[i];
        images[i] = patch.Body.Geometry().Evaluate(u, v, w);
      }
    }
  }
  EXPECT_LT((images[0] - images[1]).norm(), 1e-12 * (1.0 + images[0].norm()));
  EXPECT_TRUE(
    witness.Patches[0] != witness.Patches[1] || witness.Parameters[0] != witness.Parameters[1]);
}

/// A box from `low` to `high`, of one trilinear element.
Spline Box(const Eigen::Vector3d& low, const Eigen::Vector3d& high)
{
  return models::BezierVolume({ 1, 1, 1 },
    [&](int i, int j, int k) -> Eigen::Vector3d
    { return low + Eigen::Vector3d(i, j, k).cwiseProduct(high - low); });
}

/// A tricubic element on a lattice of spacing 1, each coordinate moved by up to `noise`.
Spline NoisyCell(std::mt19937& random, double noise)
{
  std::uniform_real_distribution<double> move(-noise, noise);
  return models::BezierVolume({ 3, 3, 3 },
    [&](int i, int j, int k)
    { return Eigen::Vector3d(i + move(random), j + move(random), k + move(random)); });
}

/// A sector of an annulus of 1 +- 1/2 about z, up to 2 high, exact: u radius, v angle, w height.
/// \param inner radius; 0 collapses the side u = 0
Spline Sector(double inner, double from, double to)
{
  Eigen::MatrixXd points(3, 12);
  Eigen::VectorXd weights(12);
  const double half = 0.5 * (to - from);
  const double angles[3] = { from, from + half, to };
  for (int i = 0; i < 12; ++i)
  {
    const int j = i / 2 % 3;
    const double radius = (i % 2 == 0 ? inner : 1.5) / (j == 1 ? std::cos(half) : 1.0);
    points.col(i) << radius * std::cos(angles[j]), radius * std::sin(angles[j]), 2 * (i / 6);
    weights[i] = j == 1 ? std::cos(half) : 1.0;
  }
  return Spline({ KnotVector::Uniform(1, 2), KnotVector::Uniform(2, 3), KnotVector::Uniform(1, 2) },
    points, weights);
}

/// A strip along a plane curve given by its cubic Bezier points, so wide, extruded.
Spline Strip(const std::vector<Eigen::Vector2d>& curve, double width)
{
  const auto n = static_cast<int>(curve.size());
  Eigen::Matrix3Xd points(3, n * 4);
  for (int i = 0; i < points.cols(); ++i)
  {
    const auto r = static_cast<std::size_t>(i % n);
    const Eigen::Vector2d along =
      curve[std::min(r + 1, curve.size() - 1)] - curve[r > 0 ? r - 1 : 0];
    const Eigen::Vector2d normal = Eigen::Vector2d(-along.y(), along.x()).normalized();
    points.col(i) << curve[r] + (i / n % 2 - 0.5) * width * normal, i / n / 2;
  }
  return Spline(
    { KnotVector::Uniform(3, n), KnotVector::Uniform(1, 2), KnotVector::Uniform(1, 2) }, points);
}

}

TEST(GlobalInjectivity, CellsWithNoiseAreCertified)
{
  std::mt19937 random(1);
  for (const double noise : { 0.15, 0.3, 0.4 })
  {
    int valid = 0;
    int certified = 0;
    for (int round = 0; round < 20; ++round)
    {
      const MultiPatch model = Model({ NoisyCell(random, noise) });
      const Injectivity result = Tested(model);
      valid += Validity(model)[0].Elements[0].Verdict == 1;
      certified += result.Verdict == 1;
      if (result.Verdict < 0)
      {
        EXPECT_EQ(Validity(model)[0].Elements[0].Verdict, -1);
      }
    }
    EXPECT_EQ(certified, valid) << noise;
    EXPECT_GE(valid, 10);
  }
}

TEST(GlobalInjectivity, ContiguousElementsThatCrossAreFound)
{
  // Conde & Torres: two hyperpatches that share three slices do not intersect. These do, though
  // each is valid and injective.
  const MultiPatch model = Model({ models::CrossingNeighbours() });
  const std::vector<PatchValidity> validity = Validity(model);
  EXPECT_EQ(validity[0].Elements[0].Verdict, 1);
  EXPECT_EQ(validity[0].Elements[1].Verdict, 1);
  const Injectivity result = Tested(model);
  ExpectWitness(model, result);
  ASSERT_EQ(result.Items.size(), 3u);
  EXPECT_EQ(result.Items[0].Verdict, 1);
  EXPECT_EQ(result.Items[1].Verdict, -1);
  EXPECT_EQ(result.Items[2].Verdict, 1);
}

TEST(GlobalInjectivity, TheCounterexampleToCondeAndTorresTheoremIsRefused)
{
  EXPECT_EQ(Tested({ models::OrderedButInvalid(0.001) }).Verdict, -1);
}

TEST(GlobalInjectivity, AFoldHasADoublePoint)
{
  const MultiPatch model = Model({ models::SweptHalfCylinder() });
  ExpectWitness(model, Tested(model));
  // Cut at the fold: elements of two signs.
  const MultiPatch cut = Model({ InsertKnots(models::SweptHalfCylinder(), 0, { 0.5, 0.5, 0.5 }) });
  ExpectWitness(cut, Tested(cut));
}

TEST(GlobalInjectivity, PatchesMayTouchButNotOverlap)
{
  const Spline first = Box({ 0, 0, 0 }, { 1, 1, 1 });
  EXPECT_EQ(Tested({ first, Box({ 3, 0, 0 }, { 4, 1, 1 }) }).Verdict, 1);
  EXPECT_EQ(Tested({ first, Box({ 1, 0, 0 }, { 2, 1, 1 }) }).Verdict, 1);
  EXPECT_EQ(Tested({ first, Box({ 1, 1, 0 }, { 2, 2, 1 }) }).Verdict, 1);
  EXPECT_EQ(Tested({ first, Box({ 1, 1, 1 }, { 2, 2, 2 }) }).Verdict, 1);
  for (const Eigen::Vector3d& low :
    { Eigen::Vector3d(0.9, 0, 0), Eigen::Vector3d(0.3, 0.3, 0.3), Eigen::Vector3d(0, 0, 0) })
  {
    const MultiPatch model = Model({ first, Box(low, low + Eigen::Vector3d(1, 1, 1)) });
    ExpectWitness(model, Tested(model));
  }
  // One inside another.
  const MultiPatch nested = Model({ Box({ -9, -9, -9 }, { 9, 9, 9 }), first });
  ExpectWitness(nested, Tested(nested));
}

TEST(GlobalInjectivity, PatchesWithCommonControlPointsMayStillOverlap)
{
  const Spline first = Box({ 0, 0, 0 }, { 1, 1, 1 });
  const auto second = [](const Eigen::Vector3d& u, const Eigen::Vector3d& v,
                        const Eigen::Vector3d& w) -> Spline
  {
    return models::BezierVolume(
      { 1, 1, 1 }, [&](int i, int j, int k) -> Eigen::Vector3d { return i * u + j * v + k * w; });
  };
  const std::vector<Spline> others{
    // The face x = 0, then the edge x = y = 0, then the corner 0 in common.
    second({ 0.5, 0.1, 0.1 }, { 0, 1, 0 }, { 0, 0, 1 }),
    second({ 1, 0.5, 0 }, { 0.5, 1, 0 }, { 0, 0, 1 }),
    second({ 0.6, -0.8, 0 }, { 0.8, 0.6, 0 }, { 0, 0, 1 }),
    second({ 1, 0.3, 0.2 }, { 0.2, 1, 0.1 }, { 0.1, 0.1, 1 }),
    second({ -1, 0.1, 0.1 }, { 1, 1, 0.8 }, { 0.1, -1, 1 })
  };
  for (std::size_t i = 0; i < others.size(); ++i)
  {
    const MultiPatch model = Model({ first, others[i] });
    SCOPED_TRACE(i);
    ExpectWitness(model, Tested(model));
  }
  // The same on the other side of the face, edge and corner.
  EXPECT_EQ(Tested({ first, second({ -0.5, 0.1, 0.1 }, { 0, 1, 0 }, { 0, 0, 1 }) }).Verdict, 1);
  EXPECT_EQ(Tested({ first, second({ -0.6, -0.8, 0 }, { -0.8, 0.6, 0 }, { 0, 0, 1 }) }).Verdict, 1);
  EXPECT_EQ(
    Tested({ first, second({ -1, 0.3, 0.2 }, { 0.2, -1, 0.1 }, { 0.1, 0.1, -1 }) }).Verdict, 1);
}

TEST(GlobalInjectivity, AFlatVolumeIsNotCertified)
{
  // The derivatives are three directions of a plane.
  const Spline flat = models::BezierVolume({ 2, 2, 2 },
    [](int i, int j, int k) { return Eigen::Vector3d(i + 0.3 * k, j + 0.4 * k, 0.0); });
  EXPECT_NE(Tested({ flat }).Verdict, 1);
  // det J = 6 (2u - 1)^2 keeps its sign, and the map is one to one all the same.
  const double x[4] = { -1, 1, -1, 1 };
  const Spline inflection = models::BezierVolume(
    { 3, 1, 1 }, [&x](int i, int j, int k) { return Eigen::Vector3d(x[i], j, k); });
  EXPECT_EQ(Tested({ inflection }).Verdict, 0);
}

TEST(GlobalInjectivity, FacesThatTouchWithoutCommonControlPointsStayUndecided)
{
  const Injectivity result =
    Tested({ Box({ 0, 0, 0 }, { 1, 1, 1 }), Box({ 1, 0.25, 0.25 }, { 2, 0.75, 0.75 }) });
  EXPECT_EQ(result.Verdict, 0);
  EXPECT_EQ(result.UndecidedPairs, 1u);
  EXPECT_EQ(result.UndecidedElements, 0u);
}

TEST(GlobalInjectivity, FacesThatTouchMayHaveDifferentDegrees)
{
  // Two sectors one above the other, and beside each other: one of higher degrees, the other way
  // round.
  const Spline below = Sector(0.5, 0.0, 1.0);
  const auto raised = [](const Spline& spline)
  { return ElevateDegree(ElevateDegree(ElevateDegree(spline, 0, 2), 1), 2, 3); };
  Eigen::MatrixXd points = Sector(0.5, 0.0, 1.0).Coefficients();
  points.row(2).array() += 2.0;
  const Spline above(below.Knots(), points, below.Weights());
  for (const Spline& other : { above, Sector(0.5, 1.0, 2.5) })
  {
    EXPECT_EQ(Tested({ below, raised(other) }).Verdict, 1);
    EXPECT_EQ(Tested({ below, ReverseDirection(raised(other), 1) }).Verdict, 1);
    EXPECT_EQ(Tested({ raised(below), other }).Verdict, 1);
  }
  // The same face, but not the same points of it.
  points.row(0) = above.Coefficients().row(0) * 1.001;
  EXPECT_NE(Tested({ below, raised(Spline(below.Knots(), points, below.Weights())) }).Verdict, 1);
}

TEST(GlobalInjectivity, CurvedPatchesAroundAnEdgeMeetThereOnly)
{
  // Sectors of a torus-like bend: their common edge is curved, three and five of them go round it.
  for (const int n : { 3, 5 })
  {
    std::vector<Spline> sectors;
    for (int i = 0; i < n; ++i)
    {
      const Spline sector = Sector(0.0, 2 * Pi * i / n, 2 * Pi * (i + 1) / n);
      // Bent: (x, y, z) to (x, y, z) + z^2 (0.1, 0, 0), as quadratic in w.
      const Spline quadratic = ElevateDegree(sector, 2);
      Eigen::MatrixXd points = quadratic.Coefficients();
      points.rightCols(6).row(0).array() += 0.4;
      sectors.emplace_back(quadratic.Knots(), points, quadratic.Weights());
    }
    const Injectivity result = Tested(sectors);
    EXPECT_EQ(result.Verdict, 1) << n;
    EXPECT_EQ(result.CollapsedElements, static_cast<std::size_t>(n));
  }
}

TEST(GlobalInjectivity, AClosedPatchMeetsItselfAtItsSeam)
{
  // Quarter by quarter: knots of multiplicity 2 in v.
  for (const double inner : { 0.5, 0.0 })
  {
    Eigen::MatrixXd points(3, 2 * 9 * 2);
    Eigen::VectorXd weights(points.cols());
    for (int i = 0; i < points.cols(); ++i)
    {
      const int j = i / 2 % 9;
      const double corner = j % 2 == 1 ? std::sqrt(2.0) : 1.0;
      const double radius = (i % 2 == 0 ? inner : 1.5) * corner;
      points.col(i) << radius * std::cos(Pi * j / 4), radius * std::sin(Pi * j / 4), i / 18;
      weights[i] = 1.0 / corner;
    }
    const Spline ring(
      { KnotVector::Uniform(1, 2), KnotVector(2, { 0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4 }),
        KnotVector::Uniform(1, 2) },
      points, weights);
    const Injectivity result = Tested({ ring });
    EXPECT_EQ(result.Verdict, 1) << inner;
    EXPECT_EQ(result.Elements, 4u);
    EXPECT_EQ(result.CollapsedElements, inner == 0.0 ? 4u : 0u);
    // Refined, and turned half a step too far: overlaps itself.
    EXPECT_EQ(Tested({ RefineUniformly(ring, { 2, 2, 2 }) }).Verdict, 1) << inner;
    if (inner > 0.0)
    {
      Eigen::MatrixXd open = ring.Coefficients();
      for (int i = 0; i < open.cols(); ++i)
      {
        if (i / 2 % 9 == 8)
        {
          open.col(i) += Eigen::Vector3d(0.0, 0.3, 0.0);
        }
      }
      const MultiPatch model = Model({ Spline(ring.Knots(), open, weights) });
      ExpectWitness(model, Tested(model));
    }
  }
}

TEST(GlobalInjectivity, ADiscWithFourCornersOnItsCircleIsInjective)
{
  // det J is 0 at the corners, where the sides of the disc run on into each other.
  const double s = std::sqrt(0.5);
  const double x[9][3] = { { -s, -s, 1 }, { 0, -2 * s, s }, { s, -s, 1 }, { -2 * s, 0, s },
    { 0, 0, 1 }, { 2 * s, 0, s }, { -s, s, 1 }, { 0, 2 * s, s }, { s, s, 1 } };
  Eigen::MatrixXd points(3, 18);
  Eigen::VectorXd weights(18);
  for (int i = 0; i < 18; ++i)
  {
    points.col(i) << x[i % 9][0], x[i % 9][1], i / 9;
    weights[i] = x[i % 9][2];
  }
  const Spline disc(
    { KnotVector::Uniform(2, 3), KnotVector::Uniform(2, 3), KnotVector::Uniform(1, 2) }, points,
    weights);
  const std::vector<PatchValidity> validity = Validity(Model({ disc }));
  EXPECT_EQ(validity[0].Elements[0].Verdict, 1);
  // Four edges along w.
  EXPECT_EQ(validity[0].Elements[0].Degenerate, 0xfu << 14);
  EXPECT_EQ(Tested({ disc }).Verdict, 1);
  EXPECT_EQ(Tested({ RefineUniformly(disc, { 1, 1, 3 }) }).Verdict, 1);
}

TEST(GlobalInjectivity, BentStripsAreCertifiedAndLoopsAreFound)
{
  // A half circle, a horseshoe that nearly closes, a loop.
  const std::vector<Eigen::Vector2d> half{ { 1, 0 }, { 1, 1.3 }, { -1, 1.3 }, { -1, 0 } };
  const std::vector<Eigen::Vector2d> horseshoe{ { 0.2, 0 }, { 2.4, 2.5 }, { -2.4, 2.5 },
    { -0.2, 0 } };
  const std::vector<Eigen::Vector2d> loop{ { -0.5, 0 }, { 3, 2.5 }, { -3, 2.5 }, { 0.5, 0 } };
  EXPECT_EQ(Tested({ Strip(half, 0.3) }).Verdict, 1);
  const Injectivity closing = Tested({ Strip(horseshoe, 0.2) });
  EXPECT_EQ(closing.Verdict, 1);
  EXPECT_LT(closing.Boxes, 3000);
  const MultiPatch model = Model({ Strip(loop, 0.2) });
  EXPECT_EQ(Validity(model)[0].Elements[0].Verdict, 1);
  ExpectWitness(model, Tested(model));
}

TEST(GlobalInjectivity, RandomStripsAreOneToOneUnlessTheirMiddlesCross)
{
  // Strips of one element along random plane cubics, of which the middle is known densely.
  std::mt19937 random(6);
  std::uniform_real_distribution<double> coordinate(-1.0, 1.0);
  int crossings = 0;
  int certified = 0;
  int undecided = 0;
  for (int round = 0; round < 400; ++round)
  {
    std::vector<Eigen::Vector2d> curve(4);
    for (Eigen::Vector2d& point : curve)
    {
      point = { coordinate(random), coordinate(random) };
    }
    const MultiPatch model = Model({ Strip(curve, 0.02) });
    const Injectivity result = Tested(model);
    // Segments of the middle that cross.
    constexpr int N = 300;
    std::vector<Eigen::Vector2d> middle;
    for (int i = 0; i <= N; ++i)
    {
      middle.emplace_back(
        model.Patches[0].Body.Geometry().Evaluate(static_cast<double>(i) / N, 0.5, 0.5).head<2>());
    }
    const auto side =
      [](const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c)
    { return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x(); };
    bool crosses = false;
    for (std::size_t i = 0; i < N; ++i)
    {
      for (std::size_t j = i + 2; j < N; ++j)
      {
        crosses = crosses ||
          (side(middle[i], middle[i + 1], middle[j]) *
                side(middle[i], middle[i + 1], middle[j + 1]) <
              0.0 &&
            side(middle[j], middle[j + 1], middle[i]) *
                side(middle[j], middle[j + 1], middle[i + 1]) <
              0.0);
      }
    }
    crossings += crosses;
    certified += result.Verdict == 1;
    undecided += result.Verdict == 0;
    if (crosses)
    {
      EXPECT_EQ(result.Verdict, -1) << round;
    }
    if (result.Verdict == -1 && result.Witness)
    {
      ExpectWitness(model, result);
    }
  }
  EXPECT_GT(crossings, 20);
  EXPECT_GT(certified, 200);
  EXPECT_LT(undecided, 5);
}

TEST(GlobalInjectivity, NoCertificateIsContradictedBySearch)
{
  // From random starts Newton's iteration finds no second point with the image of a first one.
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::uniform_real_distribution<double> move(-0.5, 0.5);
  int certified = 0;
  for (int round = 0; round < 300; ++round)
  {
    const Spline cell = models::BezierVolume({ 2, 2, 2 },
      [&](int i, int j, int k)
      { return Eigen::Vector3d(i + move(random), j + move(random), k + move(random)); });
    if (Tested({ cell }).Verdict != 1)
    {
      continue;
    }
    ++certified;
    const Evaluator evaluator(cell);
    for (int search = 0; search < 100; ++search)
    {
      const Eigen::Vector3d x(unit(random), unit(random), unit(random));
      Eigen::Vector3d y(unit(random), unit(random), unit(random));
      const Eigen::Vector3d image = cell.Evaluate(x[0], x[1], x[2]);
      Eigen::Vector3d value;
      for (int iteration = 0; iteration < 20; ++iteration)
      {
        Eigen::Matrix3d j;
        evaluator.EvaluateWithDerivatives(1, y.data(), value.data(), j.data());
        y = (y + j.partialPivLu().solve(image - value)).cwiseMax(0.0).cwiseMin(1.0);
      }
      if ((value - image).norm() < 1e-12)
      {
        EXPECT_LT((x - y).norm(), 1e-6) << round;
      }
    }
  }
  EXPECT_GT(certified, 50);
}

TEST(GlobalInjectivity, ABudgetThatIsTooSmallLeavesItUndecided)
{
  InjectivityOptions options;
  options.MaxTests = 1;
  std::mt19937 random(2);
  const Injectivity result = Tested({ NoisyCell(random, 0.35) }, options);
  EXPECT_EQ(result.Verdict, 0);
  EXPECT_EQ(result.UndecidedElements, 1u);
  EXPECT_FALSE(result.Witness);
}

TEST(GlobalInjectivity, LatticesOfManyElementsAreCertifiedOnAnyShareOfTheWork)
{
  std::mt19937 random(3);
  const KnotVector knots = KnotVector::Uniform(3, 9);
  Eigen::MatrixXd points =
    0.05 * models::RandomSpline(random, { knots, knots, knots }, 3, false).Coefficients();
  for (int i = 0; i < points.cols(); ++i)
  {
    points.col(i) +=
      Eigen::Vector3d(knots.Greville(i % 9), knots.Greville(i / 9 % 9), knots.Greville(i / 81)) * 6;
  }
  const MultiPatch model = Model({ Spline({ knots, knots, knots }, points) });
  const Injectivity whole = Tested(model);
  EXPECT_EQ(whole.Verdict, 1);
  EXPECT_EQ(whole.Elements, 216u);
  EXPECT_EQ(whole.Tested, 216u + whole.Pairs);
  std::size_t items = 0;
  std::int64_t boxes = 0;
  for (std::size_t share = 0; share < 3; ++share)
  {
    InjectivityOptions options;
    options.Share = share;
    options.Shares = 3;
    const Injectivity part = Tested(model, options);
    EXPECT_EQ(part.Verdict, 1);
    items += part.Items.size();
    boxes += part.Boxes;
  }
  EXPECT_EQ(items, whole.Items.size());
  EXPECT_EQ(boxes, whole.Boxes);
}

TEST(GlobalInjectivity, OnlyWhatAnEditReachesIsTestedAgain)
{
  std::mt19937 random(4);
  const KnotVector knots = KnotVector::Uniform(2, 10);
  Eigen::MatrixXd points(3, 1000);
  for (int i = 0; i < points.cols(); ++i)
  {
    points.col(i) << knots.Greville(i % 10), knots.Greville(i / 10 % 10), knots.Greville(i / 100);
  }
  const MultiPatch before = Model({ Spline({ knots, knots, knots }, points) });
  const Injectivity first = Tested(before);
  EXPECT_EQ(first.Verdict, 1);
  points(0, 5 + 50 + 500) += 0.01;
  const MultiPatch after = Model({ Spline({ knots, knots, knots }, points) });
  const KnownInjectivity known{ &first,
    ChangedElements(before.Patches[0].Body.Geometry(), after.Patches[0].Body.Geometry()) };
  const Injectivity second = TestInjectivity(after, Validity(after), {}, SerialFor, &known);
  EXPECT_EQ(second.Verdict, 1);
  // 3^3 elements, and pairs of them and with the 5^3 around.
  EXPECT_GE(second.Tested, 27u + 27u * 26u / 2u);
  EXPECT_LT(second.Tested, 27u + 27u * 30u);
  EXPECT_EQ(second.Items.size(), second.Elements + second.Pairs);
}

TEST(GlobalInjectivity, CellsOfAMeshAreNoNeighboursByTheirNumbers)
{
  // Bezier hexahedra: one Id, spans in a row, each on [0, 1]^3, in any arrangement.
  const auto mesh = [](const std::vector<Spline>& cells)
  {
    MultiPatch model = Model(cells);
    for (std::size_t i = 0; i < cells.size(); ++i)
    {
      model.Patches[i].Id = 0;
      model.Patches[i].FirstSpan = { static_cast<int>(i), 0, 0 };
      model.Patches[i].WholeSpans = { static_cast<int>(cells.size()), 1, 1 };
    }
    return model;
  };
  const Spline first = Box({ 0, 0, 0 }, { 1, 1, 1 });
  EXPECT_EQ(Tested(mesh({ first, Box({ 0, 1, 0 }, { 1, 2, 1 }) })).Verdict, 1);
  EXPECT_EQ(Tested(mesh({ first, Box({ 0.5, 0, 0 }, { 1.5, 1, 1 }) })).Verdict, -1);
  // Left-handed and right-handed cells may touch.
  EXPECT_EQ(Tested(mesh({ first, Box({ 0, 0, 0 }, { 1, 1, -1 }) })).Verdict, 1);
}

TEST(GlobalInjectivity, PartsOfAPatchAreOnePatch)
{
  const Spline tube = RefineUniformly(models::QuarterTube(), { 2, 4, 2 });
  const Patch whole{ 5, Aggregate(tube) };
  MultiPatch parts;
  parts.Patches.push_back(RestrictPatch(whole, { 0, 0, 0 }, { 2, 1, 2 }));
  parts.Patches.push_back(RestrictPatch(whole, { 0, 1, 0 }, { 2, 4, 2 }));
  EXPECT_EQ(Tested(parts).Verdict, 1);
  // Cut at its fold, where the parts have different signs.
  const Patch fold{ 5, Aggregate(InsertKnots(models::SweptHalfCylinder(), 0, { 0.5, 0.5, 0.5 })) };
  MultiPatch halves;
  halves.Patches.push_back(RestrictPatch(fold, { 0, 0, 0 }, { 1, 1, 1 }));
  halves.Patches.push_back(RestrictPatch(fold, { 1, 0, 0 }, { 2, 1, 1 }));
  EXPECT_EQ(Tested(halves).Verdict, -1);
}

TEST(GlobalInjectivity, RefusesWhatItCannotTest)
{
  const MultiPatch model = Model({ Box({ 0, 0, 0 }, { 1, 1, 1 }) });
  const std::vector<PatchValidity> validity = Validity(model);
  InjectivityOptions options;
  options.MaxTests = 0;
  EXPECT_THROW(static_cast<void>(TestInjectivity(model, validity, options)), Error);
  options = InjectivityOptions();
  options.Share = 1;
  EXPECT_THROW(static_cast<void>(TestInjectivity(model, validity, options)), Error);
  options = InjectivityOptions();
  options.ContactTolerance = NAN;
  EXPECT_THROW(static_cast<void>(TestInjectivity(model, validity, options)), Error);
  EXPECT_THROW(static_cast<void>(TestInjectivity(model, {})), Error);
  const KnotVector line = KnotVector::Uniform(1, 2);
  EXPECT_THROW(static_cast<void>(TestInjectivity(
                 Model({ Spline({ line, line, KnotVector() }, Eigen::MatrixXd::Zero(3, 4)) }), {})),
    Error);
}
