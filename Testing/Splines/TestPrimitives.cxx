// SPDX-License-Identifier: BSD-3-Clause
#include "Primitives.h"

#include "Error.h"
#include "Operators.h"
#include "Splines/Integrals.h"
#include "Validity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <set>
#include <string>

using namespace hyperpatch;

namespace
{

constexpr double Pi = 3.14159265358979323846;
constexpr double Epsilon = std::numeric_limits<double>::epsilon();

/// A solid and what is known of it.
struct Known
{
  const char* Name;
  MultiPatch Model;
  double Volume;
  double Area;
  std::size_t Interfaces;
  bool Regular; ///< det J > 0 on faces, edges and corners, too
  /// 0 on the boundary, in units of length.
  std::function<double(const Eigen::Vector3d&)> Distance;
};

std::vector<Known> KnownSolids()
{
  const auto across = [](const Eigen::Vector3d& p) { return std::hypot(p[0], p[1]); };
  const auto cylinder = [across](const Eigen::Vector3d& p)
  { return std::max(across(p) - 2.0, std::abs(p[2]) - 1.5); };
  const auto tube = [across](const Eigen::Vector3d& p)
  { return std::max(std::abs(across(p) - 1.5) - 0.5, std::abs(p[2]) - 1.5); };
  // Radius 2 below, 1 above, height 3: the wall falls by 1 in 3.
  const auto cone = [across](const Eigen::Vector3d& p)
  { return std::max((across(p) - 1.5 + p[2] / 3) / std::sqrt(10.0 / 9), std::abs(p[2]) - 1.5); };
  const auto tip = [across](const Eigen::Vector3d& p)
  { return std::max((across(p) - 1.0 + 2.0 * p[2] / 3) / std::sqrt(13.0 / 9), -1.5 - p[2]); };
  const auto sphere = [](const Eigen::Vector3d& p) { return p.norm() - 2.0; };
  const auto shell = [](const Eigen::Vector3d& p) { return std::abs(p.norm() - 1.5) - 0.5; };
  const auto torus = [across](const Eigen::Vector3d& p)
  { return std::hypot(across(p) - 3.0, p[2]) - 1.0; };
  const auto box = [](const Eigen::Vector3d& p)
  { return (p.cwiseAbs() - Eigen::Vector3d(0.5, 1.0, 1.5)).maxCoeff(); };
  const auto wedge = [](const Eigen::Vector3d& p)
  {
    const double slope = (p[0] + p[1] / 2) / std::sqrt(1.25);
    return std::max({ -0.5 - p[0], -1.0 - p[1], std::abs(p[2]) - 1.5, slope });
  };
  const double coneWall = Pi * 3.0 * std::sqrt(10.0);
  const double tipWall = Pi * 2.0 * std::sqrt(13.0);
  const double wedgeArea = 2.0 + 3.0 * (1.0 + 2.0 + std::sqrt(5.0));
  const Parametrisation poles = Parametrisation::Poles;
  const Parametrisation patches = Parametrisation::Patches;
  return {
    { "box", MakeBox({ 1, 2, 3 }), 6.0, 22.0, 0, true, box },
    { "cylinder", MakeCylinder(2, 3, poles), 12 * Pi, 20 * Pi, 1, false, cylinder },
    { "cylinder of patches", MakeCylinder(2, 3, patches), 12 * Pi, 20 * Pi, 8, true, cylinder },
    { "tube", MakeTube(1, 2, 3), 9 * Pi, 24 * Pi, 1, true, tube },
    { "cone", MakeCone(2, 1, 3, poles), 7 * Pi, coneWall + 5 * Pi, 1, false, cone },
    { "cone of patches", MakeCone(2, 1, 3, patches), 7 * Pi, coneWall + 5 * Pi, 8, true, cone },
    { "tip", MakeCone(2, 0, 3, poles), 4 * Pi, tipWall + 4 * Pi, 1, false, tip },
    { "sphere", MakeSphere(2, poles), 32 * Pi / 3, 16 * Pi, 1, false, sphere },
    { "sphere of patches", MakeSphere(2, patches), 32 * Pi / 3, 16 * Pi, 18, true, sphere },
    { "shell", MakeSphericalShell(1, 2, poles), 28 * Pi / 3, 20 * Pi, 1, false, shell },
    { "shell of patches", MakeSphericalShell(1, 2, patches), 28 * Pi / 3, 20 * Pi, 12, true,
      shell },
    { "torus", MakeTorus(3, 1, poles), 6 * Pi * Pi, 12 * Pi * Pi, 2, false, torus },
    { "torus of patches", MakeTorus(3, 1, patches), 6 * Pi * Pi, 12 * Pi * Pi, 13, true, torus },
    { "wedge", MakeWedge({ 1, 2, 3 }, poles), 3.0, wedgeArea, 0, false, wedge },
    { "wedge of patches", MakeWedge({ 1, 2, 3 }, patches), 3.0, wedgeArea, 3, true, wedge },
  };
}

/// Sides (patch, side) that are no interfaces and no points or curves.
std::vector<std::pair<std::size_t, Spline>> OuterFaces(const MultiPatch& model)
{
  std::set<std::pair<int, int>> inner;
  for (const Interface& item : model.Interfaces)
  {
    inner.insert({ item.Values[0], item.Values[1] - 1 });
    inner.insert({ item.Values[2], item.Values[3] - 1 });
  }
  std::vector<std::pair<std::size_t, Spline>> faces;
  for (std::size_t p = 0; p < model.Patches.size(); ++p)
  {
    for (int side = 0; side < NumberOfSides; ++side)
    {
      Spline face = ExtractFace(model.Patches[p].Body.Geometry(), side);
      if (inner.count({ static_cast<int>(p), side }) == 0 && integrals::Area(face) > 1e-9)
      {
        faces.emplace_back(p, std::move(face));
      }
    }
  }
  return faces;
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

}

TEST(Primitives, VolumesAndAreasAreAnalytic)
{
  for (const Known& known : KnownSolids())
  {
    SCOPED_TRACE(known.Name);
    double volume = 0.0;
    for (const Patch& patch : known.Model.Patches)
    {
      volume += integrals::Volume(patch.Body.Geometry());
    }
    double area = 0.0;
    for (const auto& face : OuterFaces(known.Model))
    {
      area += integrals::Area(face.second);
    }
    // Sums of some thousand terms, each of which has a few dozen roundings.
    EXPECT_NEAR(volume, known.Volume, 200 * Epsilon * known.Volume);
    // The length of a cross product has a kink where it is zero: at poles.
    EXPECT_NEAR(area, known.Area, 200 * Epsilon * known.Area);
  }
}

TEST(Primitives, BoundaryPointsAreOnTheSurfaceToRoundOff)
{
  for (const Known& known : KnownSolids())
  {
    SCOPED_TRACE(known.Name);
    for (const auto& [patch, face] : OuterFaces(known.Model))
    {
      for (int i = 0; i <= 20; ++i)
      {
        for (int j = 0; j <= 20; ++j)
        {
          const double s = i / 20.0;
          const double t = j / 20.0;
          const bool lacksU = face.Knots(0).Degree() == 0;
          const bool lacksV = face.Knots(1).Degree() == 0;
          const Eigen::VectorXd point = lacksU ? face.Evaluate(0.0, s, t)
            : lacksV                           ? face.Evaluate(s, 0.0, t)
                                               : face.Evaluate(s, t);
          // Coordinates up to 4, tile points sums of 25 terms.
          EXPECT_NEAR(known.Distance(point), 0.0, 4 * 25 * Epsilon) << "patch " << patch;
        }
      }
    }
  }
}

TEST(Primitives, AreRightHandedCertified)
{
  for (const Known& known : KnownSolids())
  {
    SCOPED_TRACE(known.Name);
    for (const Patch& patch : known.Model.Patches)
    {
      const PatchValidity validity = TestValidity(patch.Body.Geometry());
      EXPECT_EQ(validity.Handedness, 1);
      for (const ElementValidity& element : validity.Elements)
      {
        EXPECT_EQ(element.Verdict, 1);
        EXPECT_EQ(element.Sign, 1);
        if (known.Regular)
        {
          EXPECT_EQ(element.Degenerate, 0u);
          ASSERT_TRUE(element.Minimum);
          EXPECT_GT(element.Minimum->Low, 0.0);
        }
        else
        {
          EXPECT_NE(element.Degenerate, 0u);
        }
      }
    }
  }
}

TEST(Primitives, InterfacesAreFound)
{
  for (const Known& known : KnownSolids())
  {
    EXPECT_EQ(known.Model.Interfaces.size(), known.Interfaces) << known.Name;
  }
}

TEST(Primitives, AHelixHasTheVolumeOfItsWire)
{
  for (const Parametrisation parametrisation : { Parametrisation::Poles, Parametrisation::Patches })
  {
    for (const double pitch : { 0.7, -0.7 })
    {
      const MultiPatch helix = MakeHelix(1.0, 0.25, pitch, 2.5, 1e-6, parametrisation);
      double volume = 0.0;
      for (const Patch& patch : helix.Patches)
      {
        const double part = integrals::Volume(patch.Body.Geometry());
        EXPECT_GT(part, 0.0);
        volume += part;
      }
      // Pappus: the disk stands across the path of its centre.
      const double length = 2.5 * std::hypot(2 * Pi, pitch);
      const double wire = Pi * 0.0625 * length;
      // The boundary moves by the tolerance at most.
      EXPECT_NEAR(volume, wire, 1e-6 * 2 * Pi * 0.25 * length);
    }
  }
}

TEST(Primitives, BadLengthsAreRefused)
{
  const Parametrisation poles = Parametrisation::Poles;
  ExpectError([] { (void)MakeBox({ 1, 0, 1 }); }, "length along y is 0");
  ExpectError([=] { (void)MakeCylinder(-1, 1, poles); }, "radius is -1");
  ExpectError([=] { (void)MakeCylinder(1, std::nan(""), poles); }, "height is nan");
  ExpectError([] { (void)MakeTube(2, 1, 1); }, "inner radius, 2.000000, must be less than");
  ExpectError([=] { (void)MakeCone(1, -1, 1, poles); }, "top radius is -1");
  ExpectError(
    [] { (void)MakeCone(1, 0, 1, Parametrisation::Patches); }, "a top radius that is not 0");
  ExpectError([=] { (void)MakeSphere(0, poles); }, "radius is 0");
  ExpectError([=] { (void)MakeSphericalShell(1, 1, poles); }, "must be less than");
  ExpectError([=] { (void)MakeTorus(1, 1, poles); }, "minor radius");
  ExpectError([=] { (void)MakeWedge({ 1, 1, -1 }, poles); }, "length along z");
  ExpectError([=] { (void)MakeHelix(1, 0.25, 0.4, 2, 1e-3, poles); }, "coils overlap");
  ExpectError([=] { (void)MakeHelix(1, 0.25, 1, 0, 1e-3, poles); }, "number of turns");
  ExpectError([=] { (void)MakeHelix(1, 0.25, 1, 2, 0, poles); }, "tolerance");
  ExpectError([=] { (void)MakeHelix(1, 0.25, 1, 2, 1e-30, poles); }, "spans");
}
