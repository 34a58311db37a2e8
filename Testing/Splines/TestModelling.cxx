// SPDX-License-Identifier: BSD-3-Clause
#include "Modelling.h"

#include "Error.h"
#include "Interfaces.h"
#include "Motions.h"
#include "Operators.h"
#include "Reparametrise.h"
#include "Splines/Integrals.h"
#include "Splines/Models.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <cmath>
#include <functional>
#include <limits>
#include <string>

using namespace hyperpatch;
using Eigen::Vector3d;

namespace
{

constexpr double Pi = 3.14159265358979323846;
constexpr double Epsilon = std::numeric_limits<double>::epsilon();

/// A curve in the xz-plane from (1, 0, 0), with a rational basis where `rational`.
Spline Profile(bool rational)
{
  Eigen::MatrixXd points(3, 4);
  points << 1, 2, 1.5, 3, 0, 0, 0, 0, 0, 0.5, 1.5, 2;
  Eigen::VectorXd weights(rational ? 4 : 0);
  if (rational)
  {
    weights << 1, 0.5, 2, 1;
  }
  return Spline({ KnotVector(2, { 0, 0, 0, 0.3, 1, 1, 1 }), {}, {} }, points, weights);
}

/// With an attribute in its basis and one of degree 3 in a basis of its own.
Aggregate ProfileWithAttributes(bool rational)
{
  const Spline geometry = Profile(rational);
  Eigen::MatrixXd shared(2, 4);
  shared << 1, -1, 4, 2, 0, 3, 1, 5;
  Eigen::MatrixXd own(1, 5);
  own << 1.5, 1.6, 1.9, 1.2, 1.0;
  return Aggregate(geometry,
    { { "Shared", Spline(geometry.Knots(), shared, geometry.Weights()) },
      { "Own", Spline({ KnotVector::Uniform(3, 5), {}, {} }, own) } });
}

Spline Curve(const Eigen::MatrixXd& points, int degree)
{
  return Spline({ KnotVector::Uniform(degree, static_cast<int>(points.cols())), {}, {} }, points);
}

Vector3d Moved(const Spline& motion, double t, const Vector3d& x)
{
  const Eigen::VectorXd entries = motion.Evaluate(t);
  const Eigen::Map<const Eigen::Matrix<double, 3, 4>> map(entries.data());
  return map.leftCols<3>() * x + map.col(3);
}

Eigen::Matrix3d Turn(const Spline& motion, double t)
{
  const Eigen::VectorXd entries = motion.Evaluate(t);
  return Eigen::Map<const Eigen::Matrix3d>(entries.data());
}

void ExpectError(const std::function<void()>& call, const std::string& text)
{
  try
  {
    call();
    ADD_FAILURE() << "no error, expected: " << text;
  }
  catch (const Error& error)
  {
    EXPECT_NE(std::string(error.what()).find(text), std::string::npos) << error.what();
  }
}

/// Attributes of an aggregate made of one section do not depend on the new direction.
void ExpectCarried(const Aggregate& section, const Aggregate& result, bool volume)
{
  ASSERT_EQ(result.Attributes().size(), section.Attributes().size());
  for (const Attribute& attribute : section.Attributes())
  {
    const Spline* field = result.FindAttribute(attribute.Name);
    ASSERT_NE(field, nullptr);
    EXPECT_EQ(
      SharesBasis(result.Geometry(), *field), SharesBasis(section.Geometry(), attribute.Field));
    for (const double u : { 0.0, 0.21, 0.3, 0.77, 1.0 })
    {
      for (const double t : { 0.0, 0.4, 1.0 })
      {
        const Eigen::VectorXd expected = attribute.Field.Evaluate(u, volume ? 0.6 : 0.0);
        const Eigen::VectorXd value = volume ? field->Evaluate(u, 0.6, t) : field->Evaluate(u, t);
        EXPECT_LE((value - expected).norm(), 40 * Epsilon * 5.0);
      }
    }
  }
}

}

TEST(Modelling, ExtrusionMovesTheSectionAndCarriesAttributes)
{
  for (const bool rational : { false, true })
  {
    const Aggregate section = ProfileWithAttributes(rational);
    const Vector3d vector(0.5, 2.0, -1.0);
    const Aggregate surface = Extrude(section, vector);
    for (const double u : { 0.0, 0.3, 0.6, 1.0 })
    {
      for (const double v : { 0.0, 0.25, 1.0 })
      {
        const Vector3d expected = section.Geometry().Evaluate(u) + v * vector;
        EXPECT_LE((surface.Geometry().Evaluate(u, v) - expected).norm(), 30 * Epsilon);
      }
    }
    ExpectCarried(section, surface, false);
    const Aggregate volume = Extrude(surface, { 0.0, 0.0, 4.0 });
    EXPECT_EQ(volume.Geometry().Dimension(), 3);
    ExpectCarried(surface, volume, true);
  }
}

TEST(Modelling, RevolutionIsExactForEveryAngle)
{
  const Vector3d point(0.2, -0.1, 0.3);
  const Vector3d axis(0.5, 1.0, 2.0);
  std::mt19937 random(3);
  const Spline curve = models::RandomSpline(random, { KnotVector::Uniform(3, 6), {}, {} }, 3, true);
  for (const double angle : { 30.0, 90.0, -135.0, 180.0, 270.0, 360.0, -360.0 })
  {
    const Spline surface = Revolve(Aggregate(curve), point, axis, angle).Geometry();
    for (const double v : { 0.0, 0.1, 0.37, 0.5, 0.9, 1.0 })
    {
      // Distance from the axis, height along it, and (at breaks) the angle itself are kept.
      for (const double u : { 0.0, 0.4, 1.0 })
      {
        const Vector3d from = curve.Evaluate(u) - point;
        const Vector3d to = surface.Evaluate(u, v) - point;
        const Vector3d unit = axis.normalized();
        EXPECT_NEAR(to.dot(unit), from.dot(unit), 50 * Epsilon);
        EXPECT_NEAR(to.cross(unit).norm(), from.cross(unit).norm(), 50 * Epsilon);
      }
    }
    const std::vector<double> breaks = surface.Knots(1).Breaks();
    for (const double v : breaks)
    {
      const Vector3d turned = Eigen::AngleAxisd(angle * v * Pi / 180.0, axis.normalized()) *
        (curve.Evaluate(0.4) - point);
      EXPECT_LE((surface.Evaluate(0.4, v) - point - turned).norm(), 50 * Epsilon);
    }
  }
}

TEST(Modelling, AFullTurnClosesToTheBit)
{
  const Spline surface =
    Revolve(Aggregate(Profile(true)), Vector3d::Zero(), Vector3d::UnitZ(), 360.0).Geometry();
  EXPECT_EQ(ExtractFace(surface, 2).Coefficients(), ExtractFace(surface, 3).Coefficients());
}

TEST(Modelling, AttributesAreConstantAroundTheAxis)
{
  for (const bool rational : { false, true })
  {
    const Aggregate section = ProfileWithAttributes(rational);
    const Aggregate surface = Revolve(section, Vector3d::Zero(), Vector3d::UnitZ(), 200.0);
    ExpectCarried(section, surface, false);
  }
}

TEST(Modelling, ARevolvedRectangleHasTheVolumeOfPappus)
{
  Eigen::MatrixXd points(3, 2);
  points << 2, 3, 0, 0, 0, 0;
  const Aggregate rectangle = Extrude(Aggregate(Curve(points, 1)), Vector3d::UnitZ());
  for (const double angle : { 50.0, 360.0 })
  {
    const Aggregate ring = Revolve(rectangle, Vector3d::Zero(), Vector3d::UnitZ(), angle);
    // r, z, angle is a left-handed system.
    EXPECT_NEAR(
      integrals::Volume(ring.Geometry()), -5.0 * Pi * angle / 360.0, 200 * Epsilon * 5.0 * Pi);
  }
}

TEST(Modelling, ASectionThatCrossesTheAxisIsRefused)
{
  Eigen::MatrixXd points(3, 2);
  points << -1, 2, 0, 0, 0, 1;
  const Aggregate crossing(Curve(points, 1));
  const auto revolve = [](const Aggregate& section)
  { return Revolve(section, Vector3d::Zero(), Vector3d::UnitZ(), 90.0); };
  // From x = -1, z = 0 to x = 2, z = 1.
  const std::string place = "crosses the axis of revolution, at (0.000000, 0.000000, 0.333333)";
  ExpectError([&] { (void)revolve(crossing); }, place);
  ExpectError([&] { (void)revolve(Extrude(crossing, Vector3d::UnitX())); }, "crosses the axis");
  // Touching it is fine, and so are control points beyond it where the curve is not: also where
  // they are those farthest away.
  points << 0, 2, 0, 0, 0, 1;
  EXPECT_NO_THROW((void)revolve(Aggregate(Curve(points, 1))));
  Eigen::MatrixXd bulge(3, 3);
  bulge << 1, -0.2, 1, 0, 0, 0, 0, 1, 2;
  EXPECT_NO_THROW((void)revolve(Aggregate(Curve(bulge, 2))));
  bulge(0, 1) = -5.0;
  ExpectError([&] { (void)revolve(Aggregate(Curve(bulge, 2))); }, "crosses the axis");
  Eigen::VectorXd weights(3);
  weights << 1.0, 0.1, 1.0;
  EXPECT_NO_THROW((void)revolve(Aggregate(Spline(Curve(bulge, 2).Knots(), bulge, weights))));
  points << 0, 0, 0, 0, 0, 1;
  ExpectError([&] { (void)revolve(Aggregate(Curve(points, 1))); }, "lies on the axis");
}

TEST(Modelling, TheAxisMayNotPassThroughASurface)
{
  // A tilted square, z = x / 2, moved; the axis meets it in one point, inside, on its border or not
  // at all.
  const auto square = [](double x, double y, double bulge)
  {
    Eigen::MatrixXd points(3, 9);
    for (int j = 0; j < 3; ++j)
    {
      for (int i = 0; i < 3; ++i)
      {
        points.col(i + 3 * j) << x + i, y + j, 0.5 * (x + i) + (i == 1 && j == 1 ? bulge : 0.0);
      }
    }
    const KnotVector knots = KnotVector::Uniform(2, 3);
    return Aggregate(Spline({ knots, knots, KnotVector() }, points));
  };
  const auto revolve = [](const Aggregate& section)
  { return Revolve(section, Vector3d::Zero(), Vector3d::UnitZ(), 30.0); };
  ExpectError([&] { (void)revolve(square(-1.0, -1.0, 0.0)); }, "at (0.000000, 0.000000, 0.000000)");
  // At the middle a bulge of 1 is 1 / 4 high.
  ExpectError([&] { (void)revolve(square(-1.0, -1.0, 1.0)); }, "at (0.000000, 0.000000, 0.250000)");
  ExpectError([&] { (void)revolve(square(-0.001, -1.99, 1.0)); }, "crosses the axis");
  for (const auto& [x, y] : { std::pair{ 0.0, -1.0 }, { 0.0, 0.0 }, { 0.1, -1.0 }, { -1.0, 0.1 } })
  {
    EXPECT_NO_THROW((void)revolve(square(x, y, 0.0)));
    EXPECT_NO_THROW((void)revolve(square(x, y, 1.0)));
  }
  // A sheet that turns about the axis, of which one edge is.
  Eigen::MatrixXd helicoid(3, 4);
  helicoid << 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 1, 1;
  const KnotVector knots = KnotVector::Uniform(1, 2);
  EXPECT_NO_THROW((void)revolve(Aggregate(Spline({ knots, knots, KnotVector() }, helicoid))));
}

TEST(Modelling, ASectionMayTouchTheAxisAndNotCrossItByLittle)
{
  // x = (t - 1/2)^2 - depth, of 40 spans: where the axis is crossed is between any fixed places.
  for (const double depth : { -1e-3, 0.0, 1e-10, 1e-8, 1e-4 })
  {
    Eigen::MatrixXd parabola(3, 3);
    parabola << 0.25 - depth, -0.25 - depth, 0.25 - depth, 0, 0, 0, 0, 1, 2;
    const Spline curve = RefineUniformly(Curve(parabola, 2), { 40, 1, 1 });
    const auto revolve = [&]
    { return Revolve(Aggregate(curve), Vector3d::Zero(), Vector3d::UnitZ(), 90.0); };
    if (depth > 1e-9)
    {
      // The crossings are at z = 1 -+ 2 sqrt(depth).
      ExpectError([&] { (void)revolve(); },
        depth > 1e-5 ? "axis of revolution, at (0.000000, 0.000000, 0.98" : "0.9998");
    }
    else
    {
      EXPECT_NO_THROW((void)revolve());
    }
  }
}

TEST(Modelling, RulingJoinsSectionsOfOtherDegreesKnotsAndDomains)
{
  const Aggregate first = ProfileWithAttributes(true);
  Eigen::MatrixXd points(3, 5);
  points << 0, 1, 2, 3, 4, 5, 6, 5, 6, 5, 0, 1, 0, 2, 0;
  const Spline other = Spline({ KnotVector(3, { 2, 2, 2, 2, 3.5, 6, 6, 6, 6 }), {}, {} }, points);
  Eigen::MatrixXd values(2, 5);
  values << 5, 4, 3, 2, 1, 1, 1, 2, 2, 1;
  Eigen::MatrixXd line(1, 2);
  line << 3, 7;
  const Aggregate second(other,
    { { "Own", Spline({ KnotVector::Uniform(1, 2, 2, 6), {}, {} }, line) },
      { "Shared", Spline(other.Knots(), values) } });
  const Aggregate surface = Rule(first, second);
  EXPECT_EQ(surface.Geometry().Degrees(), (std::array<int, 3>{ 3, 1, 0 }));
  EXPECT_TRUE(SharesBasis(surface.Geometry(), *surface.FindAttribute("Shared")));
  for (const double u : { 0.0, 0.1, 0.3, 0.375, 0.8, 1.0 })
  {
    const double t = 2.0 + 4.0 * u;
    const Spline& g = surface.Geometry();
    EXPECT_LE((g.Evaluate(u, 0.0) - first.Geometry().Evaluate(u)).norm(), 200 * Epsilon);
    EXPECT_LE((g.Evaluate(u, 1.0) - other.Evaluate(t)).norm(), 200 * Epsilon);
    // A ruling is straight.
    const Vector3d ruling = g.Evaluate(u, 1.0) - g.Evaluate(u, 0.0);
    const Vector3d part = g.Evaluate(u, 0.4) - g.Evaluate(u, 0.0);
    EXPECT_LE(ruling.normalized().cross(part).norm(), 200 * Epsilon);
    for (const char* name : { "Shared", "Own" })
    {
      const Spline& field = *surface.FindAttribute(name);
      EXPECT_LE(
        (field.Evaluate(u, 0.0) - first.FindAttribute(name)->Evaluate(u)).norm(), 200 * Epsilon);
      EXPECT_LE(
        (field.Evaluate(u, 1.0) - second.FindAttribute(name)->Evaluate(t)).norm(), 200 * Epsilon);
    }
    const Eigen::VectorXd mean =
      0.5 * (first.FindAttribute("Own")->Evaluate(u) + second.FindAttribute("Own")->Evaluate(t));
    EXPECT_LE((surface.FindAttribute("Own")->Evaluate(u, 0.5) - mean).norm(), 200 * Epsilon);
  }
}

TEST(Modelling, ALoftPassesThroughItsSections)
{
  std::mt19937 random(5);
  std::vector<Aggregate> sections;
  for (int i = 0; i < 5; ++i)
  {
    // Degrees, knots, domains and rationality differ from section to section.
    const std::array<KnotVector, 3> knots{ models::RandomKnots(random, 1 + i % 3, 4 + i, true),
      models::RandomKnots(random, 2, 4, true), {} };
    const Spline patch = models::RandomSpline(random, knots, 3, i % 2 == 1);
    Eigen::MatrixXd points = 0.1 * patch.Coefficients();
    points.row(2).array() += i * i;
    sections.emplace_back(Spline(knots, points, patch.Weights().array().pow(0.1)),
      std::vector<Attribute>{ { "Heat", models::RandomSpline(random, knots, 1, false) } });
  }
  const Aggregate solid = Loft(sections, 3);
  EXPECT_EQ(solid.Geometry().Dimension(), 3);
  EXPECT_EQ(solid.Geometry().Knots(2).Degree(), 3);
  EXPECT_EQ(solid.Geometry().Knots(2).Size(), 5);
  const auto at = [](const Spline& s, double u, double v, double w = 0.0)
  {
    const auto in = [](const KnotVector& k, double t)
    { return k.First() + t * (k.Last() - k.First()); };
    return s.Evaluate(in(s.Knots(0), u), in(s.Knots(1), v), w);
  };
  for (const Aggregate& section : sections)
  {
    // Where the loft has the height of the section at one place, it has all of the section.
    double low = 0.0;
    double high = 1.0;
    const double height = at(section.Geometry(), 0.37, 0.61)[2];
    while (0.5 * (low + high) > low && 0.5 * (low + high) < high)
    {
      const double middle = 0.5 * (low + high);
      (at(solid.Geometry(), 0.37, 0.61, middle)[2] < height ? low : high) = middle;
    }
    for (const double u : { 0.0, 0.5, 0.9 })
    {
      for (const double v : { 0.0, 0.3, 1.0 })
      {
        // Heights up to 16 in slopes up to 40.
        EXPECT_LE((at(solid.Geometry(), u, v, high) - at(section.Geometry(), u, v)).norm(), 1e-12);
        EXPECT_LE(
          (at(*solid.FindAttribute("Heat"), u, v, high) - at(*section.FindAttribute("Heat"), u, v))
            .norm(),
          1e-12);
      }
    }
  }
}

TEST(Modelling, WeightsThatWouldVanishBetweenSectionsAreRefused)
{
  std::vector<Aggregate> sections;
  for (const double weight : { 1.0, 0.01, 0.01, 1.0, 0.01, 0.01, 1.0 })
  {
    Eigen::MatrixXd points = Profile(true).Coefficients();
    points.row(1).array() += static_cast<double>(sections.size());
    Eigen::VectorXd weights = Profile(true).Weights();
    weights[1] = weight;
    sections.emplace_back(Spline(Profile(true).Knots(), points, weights));
  }
  ExpectError([&] { (void)Loft(sections, 3); }, "would not be positive");
  EXPECT_NO_THROW((void)Loft(sections, 1));
}

TEST(Modelling, SectionsThatDoNotFitAreRefused)
{
  const Aggregate section = ProfileWithAttributes(false);
  const Aggregate bare(Profile(false));
  const Aggregate surface = Extrude(bare, Vector3d::UnitY());
  const Aggregate volume = Extrude(surface, Vector3d::UnitX());
  ExpectError([&] { (void)Rule(section, bare); }, "not all sections have the attribute \"Shared\"");
  ExpectError([&] { (void)Rule(bare, section); }, "attributes that the first one has not");
  ExpectError([&] { (void)Rule(bare, surface); }, "curves or surfaces, not some of both");
  ExpectError([&] { (void)Rule(bare, bare); }, "sections 0 and 1 coincide");
  ExpectError([&] { (void)Loft({ bare }, 3); }, "two sections at least");
  ExpectError([&] { (void)Loft({ bare, bare }, 0); }, "degree 1 at least");
  ExpectError([&] { (void)Extrude(volume, Vector3d::UnitX()); }, "one or two directions, not 3");
  ExpectError([&] { (void)Extrude(bare, Vector3d::Zero()); }, "finite and not zero");
  ExpectError([&] { (void)Sweep(bare, Profile(false)); }, "12 components");
  const auto revolve = [&](const Vector3d& axis, double angle)
  { return Revolve(bare, Vector3d::Zero(), axis, angle); };
  ExpectError([&] { (void)revolve(Vector3d::Zero(), 90); }, "direction that is not zero");
  ExpectError([&] { (void)revolve(Vector3d::UnitZ(), 0); }, "within -360 and 360");
  ExpectError([&] { (void)revolve(Vector3d::UnitZ(), 361); }, "within -360 and 360");
  Eigen::MatrixXd one(1, 4);
  one << 1, 2, 3, 4;
  const Aggregate scalar(Profile(false), { { "A", Spline(Profile(false).Knots(), one) } });
  const Aggregate vector(Spline(Profile(false).Knots(), 2.0 * Profile(false).Coefficients()),
    { { "A", Spline(Profile(false).Knots(), one.replicate(2, 1)) } });
  ExpectError([&] { (void)Rule(scalar, vector); }, "\"A\" has 1 components in one section and 2");
}

TEST(Modelling, DirectionsOfASectionCloseUp)
{
  const Aggregate surface = Extrude(Aggregate(Profile(true)), Vector3d::UnitY());
  const Spline& g = surface.Geometry();
  const Aggregate gap(Spline({ g.Knots(0), {}, g.Knots(1) }, g.Coefficients(), g.Weights()));
  EXPECT_EQ(
    Extrude(gap, Vector3d::UnitX()).Geometry(), Extrude(surface, Vector3d::UnitX()).Geometry());
}

TEST(Modelling, ModelsOfSectionsKeepTheirTopology)
{
  // Two lines that meet, extruded twice.
  MultiPatch lines;
  for (const int id : { 4, 7 })
  {
    Eigen::MatrixXd points(3, 2);
    points << id, id + 3, 0, 0, 0, 0;
    lines.Patches.push_back({ id, Aggregate(Curve(points, 1)) });
  }
  lines.Interfaces = FindInterfaces(lines, 1e-9);
  ASSERT_EQ(lines.Interfaces.size(), 1u);
  lines.Boundaries = { { "left", { { 4, 0 } } } };
  const auto extrude = [](const Vector3d& vector)
  { return [vector](const Aggregate& section) { return Extrude(section, vector); }; };
  const MultiPatch surfaces = ForEachSection(lines, extrude(Vector3d::UnitY()));
  const MultiPatch volumes = ForEachSection(surfaces, extrude(Vector3d::UnitZ()));
  // What came along is what would be found.
  EXPECT_EQ(volumes.Interfaces[0].Values, FindInterfaces(volumes, 1e-9)[0].Values);
  EXPECT_EQ(volumes.Boundaries[0].Sides, lines.Boundaries[0].Sides);
  EXPECT_EQ(volumes.Patches[1].Id, 7);

  ExpectError([&] { (void)ForEachSection(volumes, extrude(Vector3d::UnitX())); },
    "patch 4: a section has one or two directions");

  MultiPatch above = lines;
  for (Patch& patch : above.Patches)
  {
    const Spline& g = patch.Body.Geometry();
    patch.Body = Aggregate(Spline(g.Knots(), g.Coefficients().colwise() + Vector3d::UnitY()));
  }
  const MultiPatch ruled = LoftModels({ lines, above }, 3);
  EXPECT_EQ(ruled.Interfaces[0].Values, lines.Interfaces[0].Values);
  EXPECT_EQ(ruled.Patches[1].Body.Geometry(), surfaces.Patches[1].Body.Geometry());
  above.Patches.pop_back();
  ExpectError([&] { (void)LoftModels({ lines, above }, 3); }, "correspond patch by patch");
}

TEST(Motions, BeginWithTheIdentity)
{
  Eigen::MatrixXd points(3, 5);
  points << 0, 1, 2, 3, 3, 0, 1, -1, 0, 2, 1, 1, 2, 0, 0;
  const Vector3d x(0.3, -0.7, 1.1);
  for (const Spline& motion :
    { Translation(Vector3d(1, 2, 3)), Translation(Curve(points, 3)),
      Rotation({ 1, 0, 0 }, { 0, 1, 1 }, 77.0),
      Screw({ 1, 0, 0 }, { 0, 1, 1 }, 800.0, 2.0, 1.0, 1e-3), FollowPath(Curve(points, 3), 90, 5) })
  {
    EXPECT_LE((Moved(motion, 0.0, x) - x).norm(), 10 * Epsilon);
    EXPECT_EQ(motion.Knots(0).First(), 0.0);
    EXPECT_EQ(motion.Knots(0).Last(), 1.0);
  }
}

TEST(Motions, AScrewStaysWithinItsTolerance)
{
  const Vector3d point(0.5, 0.0, -1.0);
  const Vector3d axis = Vector3d(1, 2, 2) / 3.0;
  const Vector3d start(2.0, 1.0, 0.0);
  const double radius = (start - point).cross(axis).norm();
  double before = 0.0;
  for (const double tolerance : { 1e-2, 1e-4, 1e-6, 1e-8 })
  {
    const Spline motion = Screw(point, axis, 900.0, 1.5, radius, tolerance);
    double worst = 0.0;
    for (int i = 0; i <= 2000; ++i)
    {
      const double t = i / 2000.0;
      const Vector3d exact =
        point + Eigen::AngleAxisd(900.0 * t * Pi / 180.0, axis) * (start - point) + 1.5 * t * axis;
      worst = std::max(worst, (Moved(motion, t, start) - exact).norm());
    }
    EXPECT_LE(worst, tolerance);
    // The bound is sharp but for the number of spans, which is whole.
    EXPECT_GT(worst, 0.3 * tolerance);
    EXPECT_NE(worst, before);
    before = worst;
  }
}

TEST(Motions, FollowsACircleExactly)
{
  // The turn of its frame is rational in the basis of the arc.
  const Spline turn = Rotation(Vector3d::Zero(), Vector3d::UnitZ(), 90.0);
  Eigen::MatrixXd points(3, 3);
  points << 2, 2, 0, 0, 2, 2, 0, 0, 0;
  const Spline arc({ KnotVector::Uniform(2, 3), {}, {} }, points, turn.Weights());
  const Spline motion = FollowPath(arc, 0.0, 4);
  for (int i = 0; i <= 100; ++i)
  {
    const double t = i / 100.0;
    EXPECT_LE((Turn(motion, t) - Turn(turn, t)).norm(), 100 * Epsilon);
    EXPECT_LE((Moved(motion, t, points.col(0)) - arc.Evaluate(t)).norm(), 100 * Epsilon);
  }
}

TEST(Motions, FramesOfAPlanePathTurnLikeItsTangent)
{
  Eigen::MatrixXd points(3, 3);
  points << 0, 1, 2, 0, 0, 3, 0, 0, 0;
  const Spline parabola = Curve(points, 2);
  double before = 1.0;
  for (const int sections : { 8, 16, 32, 64 })
  {
    const Spline motion = FollowPath(parabola, 0.0, sections);
    double worst = 0.0;
    for (int i = 0; i <= 100; ++i)
    {
      const double t = i / 100.0;
      // The point where the path begins follows it exactly.
      EXPECT_LE((Moved(motion, t, points.col(0)) - parabola.Evaluate(t)).norm(), 1e-14);
      const Vector3d tangent = Vector3d(2.0, 6.0 * t, 0.0).normalized();
      worst = std::max(worst, (Turn(motion, t) * Vector3d::UnitX() - tangent).norm());
      EXPECT_LE((Turn(motion, t) * Vector3d::UnitZ() - Vector3d::UnitZ()).norm(), 1e-13);
    }
    // Cubic interpolation: order 4.
    EXPECT_LT(worst, before / 10.0);
    before = worst;
  }
  EXPECT_LT(before, 1e-6);
}

TEST(Motions, FramesOfAPathInSpaceDoNotTurnAboutIt)
{
  Eigen::MatrixXd points(3, 6);
  points << 0, 2, 3, 2, 0, 1, 0, 0, 2, 3, 2, 0, 0, 1, 0, 2, 3, 4;
  const Spline path = Curve(points, 3);
  const Spline motion = FollowPath(path, 0.0, 200);
  const double h = 1e-4;
  const Vector3d tangent0 = (path.Evaluate(h) - path.Evaluate(0.0)).normalized();
  for (int i = 1; i < 20; ++i)
  {
    const double t = i / 20.0;
    const Eigen::Matrix3d a = Turn(motion, t);
    EXPECT_LE((a * a.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-5);
    const Vector3d tangent = (path.Evaluate(t + h) - path.Evaluate(t - h)).normalized();
    EXPECT_LE((a * tangent0 - tangent).norm(), 1e-3);
    // The angular velocity of a rotation-minimising frame has no part along the tangent.
    const Eigen::Matrix3d rate = (Turn(motion, t + h) - Turn(motion, t - h)) / (2 * h);
    const Eigen::Matrix3d spin = rate * a.transpose();
    const Vector3d omega(spin(2, 1), spin(0, 2), spin(1, 0));
    EXPECT_LE(std::abs(omega.dot(tangent)), 1e-3 * omega.norm());
  }
}

TEST(Motions, ATwistAlongALineInterpolatesItsSections)
{
  // Joy & Duchaineau (1999), Figure 11: a patch turned by 35 degrees along a line, four sections.
  Eigen::MatrixXd points(3, 2);
  points << 0, 0, 0, 0, 0, 3;
  const Spline motion = FollowPath(Curve(points, 1), 35.0, 4);
  EXPECT_EQ(motion.Knots(0).Degree(), 3);
  EXPECT_EQ(motion.Knots(0).Size(), 4);
  const Vector3d x(1.0, 0.5, 0.2);
  for (int i = 0; i < 4; ++i)
  {
    const double t = i / 3.0;
    const Vector3d exact =
      Eigen::AngleAxisd(35.0 * t * Pi / 180.0, Vector3d::UnitZ()) * x + 3.0 * t * Vector3d::UnitZ();
    EXPECT_LE((Moved(motion, t, x) - exact).norm(), 1e-14);
  }
}

TEST(Motions, PathsThatCannotBeFollowedAreRefused)
{
  Eigen::MatrixXd corner(3, 3);
  corner << 0, 1, 1, 0, 0, 1, 0, 0, 0;
  ExpectError([&] { (void)FollowPath(Curve(corner, 1), 0, 8); }, "a corner at 0.5");
  EXPECT_NO_THROW((void)Translation(Curve(corner, 1)));
  Eigen::MatrixXd rest(3, 4);
  rest << 0, 0, 1, 2, 0, 0, 1, 1, 0, 0, 0, 0;
  ExpectError([&] { (void)FollowPath(Curve(rest, 3), 0, 8); }, "comes to rest at 0.0");
  ExpectError([&] { (void)FollowPath(Curve(corner, 2), 0, 1); }, "2 sections at least");
  ExpectError([&] { (void)FollowPath(Curve(corner, 2), NAN, 8); }, "twist");
  const Aggregate surface = Extrude(Aggregate(Curve(corner, 2)), Vector3d::UnitZ());
  ExpectError([&] { (void)FollowPath(surface.Geometry(), 0, 8); }, "it must be a curve in space");
  ExpectError([&] { (void)Translation(surface.Geometry()); }, "it must be a curve in space");
  const Vector3d o = Vector3d::Zero();
  const Vector3d z = Vector3d::UnitZ();
  ExpectError([&] { (void)Screw(o, z, 0, 1, 1, 1e-3); }, "angle that is finite and not zero");
  ExpectError([&] { (void)Screw(o, z, 90, 1, 0, 1e-3); }, "both must be positive");
}
