// SPDX-License-Identifier: BSD-3-Clause
// Clips of several patches are one mesh.
#include "Clip.h"
#include "Interfaces.h"
#include "Operators.h"
#include "Primitives.h"
#include "QuadricField.h"
#include "Splines/Clips.h"
#include "Splines/Integrals.h"
#include "Splines/Models.h"
#include "Splines/TurnedPatches.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <random>
#include <vector>

using namespace hyperpatch;
using models::ClipAll;
using models::Clipped;
using models::Coarse;
using models::Curved;
using models::Fields;
using models::Inside;
using models::MakeFields;
using models::Plane;
using models::SignedVolume;
using models::Sphere;
using models::Split;
using models::Turn;
using models::Turned;

namespace
{

constexpr double Pi = 3.14159265358979323846;

MakeFields Below(double value)
{
  return [value](const PreparedAggregate& body) -> Fields
  {
    return { std::make_shared<const QuadricField>(
      body.Attributes()[0], ComponentEquals(body.Attributes()[0]->Spline(), 0, value), false) };
  };
}

double Volume(const Clipped& clipped)
{
  double volume = 0.0;
  int turnedOver = 0;
  for (const ClipMesh& mesh : clipped.Meshes)
  {
    for (Eigen::Index c = 0; c < mesh.Cells.cols(); ++c)
    {
      const double own = SignedVolume(mesh, c);
      turnedOver += own > 0.0 ? 0 : 1;
      volume += own;
    }
  }
  EXPECT_EQ(turnedOver, 0);
  return volume;
}

/// All tetrahedra form one conforming mesh: a face belongs to two of them (equal bit by bit), or
/// lies in the outer boundary, or on the cut.
void ExpectOneMesh(const MultiPatch& model, const Clipped& clipped, const MakeFields& makeFields)
{
  using Corner = std::array<double, 3>;
  struct Face
  {
    int Cells = 0;
    bool IsOuter = false;
  };
  std::map<std::array<Corner, 3>, Face> faces;
  for (std::size_t m = 0; m < clipped.Meshes.size(); ++m)
  {
    const ClipMesh& mesh = clipped.Meshes[m];
    const Patch& patch = model.Patches[m];
    const PreparedAggregate body(patch.Body);
    const Fields fields = makeFields(body);
    std::array<bool, 6> isInner{};
    for (const Interface& interface : model.Interfaces)
    {
      for (const std::size_t side : { std::size_t{ 0 }, std::size_t{ 2 } })
      {
        if (interface.Values[side] == patch.Id)
        {
          isInner[static_cast<std::size_t>(interface.Values[side + 1] - 1)] = true;
        }
      }
    }
    for (Eigen::Index c = 0; c < mesh.Cells.cols(); ++c)
    {
      for (Eigen::Index left = 0; left < 4; ++left)
      {
        std::array<Corner, 3> key{};
        std::array<std::int64_t, 3> points{};
        for (Eigen::Index i = 0, k = 0; i < 4; ++i)
        {
          if (i != left)
          {
            const std::int64_t p = mesh.Cells(i, c);
            points[static_cast<std::size_t>(k)] = p;
            key[static_cast<std::size_t>(k++)] = { mesh.Points(0, p), mesh.Points(1, p),
              mesh.Points(2, p) };
          }
        }
        std::sort(key.begin(), key.end());
        Face& face = faces[key];
        ++face.Cells;
        for (int side = 0; side < 6 && !face.IsOuter; ++side)
        {
          const KnotVector& knots = patch.Body.Geometry().Knots(side / 2);
          const double end = side % 2 == 0 ? knots.First() : knots.Last();
          face.IsOuter = !isInner[static_cast<std::size_t>(side)] &&
            std::all_of(points.begin(), points.end(),
              [&](std::int64_t p) { return mesh.Parameters(side / 2, p) == end; });
        }
        for (const auto& field : fields)
        {
          face.IsOuter = face.IsOuter ||
            std::all_of(points.begin(), points.end(),
              [&](std::int64_t p)
              {
                double value = 0.0;
                field->Evaluate(1, mesh.Parameters.col(p).data(), &value);
                return std::abs(value) < 1e-11;
              });
        }
      }
    }
  }
  std::size_t wrong = 0;
  for (const auto& [key, face] : faces)
  {
    wrong += face.Cells == 2 || (face.Cells == 1 && face.IsOuter) ? 0 : 1;
  }
  EXPECT_EQ(wrong, 0u) << "of " << faces.size();
  EXPECT_EQ(clipped.OpenFaces, 0);
}

}

TEST(ClipGroup, TwoPatchesInEveryOrientationAreOneMesh)
{
  const Aggregate whole = Curved(1);
  const double radius = 0.3;
  const MakeFields ball = Inside({ Sphere({ 0.51, 0.48, 0.5 }, radius) });
  for (int n = 0; n < 48; ++n)
  {
    const MultiPatch model =
      Split(whole, { 2, 1, 1 }, { Turn::Number(n * 7 % 48), Turn::Number(n) });
    ASSERT_EQ(model.Interfaces.size(), 1u);
    const Clipped clipped = ClipAll(model, ball, Coarse(1e-2));
    ExpectOneMesh(model, clipped, ball);
    EXPECT_TRUE(clipped.Certificate.ToleranceReached);
    EXPECT_NEAR(
      Volume(clipped), 4.0 / 3.0 * Pi * std::pow(radius, 3), 1e-2 * 4.0 * Pi * radius * radius)
      << n;
  }
}

TEST(ClipGroup, EightPatchesAroundAVertexAreOneMesh)
{
  std::mt19937 random(5);
  for (int seed = 0; seed < 3; ++seed)
  {
    std::vector<Turn> turns;
    for (int i = 0; i < 8; ++i)
    {
      turns.push_back(Turn::Number(static_cast<int>(random() % 48)));
    }
    const Aggregate whole = Curved(seed);
    const MultiPatch model = Split(whole, { 2, 2, 2 }, turns);
    ASSERT_EQ(model.Interfaces.size(), 12u);
    const double exact = integrals::Integrate(
      whole.Geometry(), [](const Eigen::Matrix3d& J) { return std::abs(J.determinant()); });
    for (const MakeFields& fields :
      { Inside({ Plane({ 1, 2, 3 }, { 0.5, 0.5, 0.5 }) }), Below(0.05),
        Inside({ Plane({ 1, 0.1, 0 }, { 0.6, 0.5, 0.5 }),
          Plane({ -0.2, 1, 0.3 }, { 0.5, 0.7, 0.5 }) }) })
    {
      double sum = 0.0;
      for (const bool inside : { true, false })
      {
        ClipOptions options = Coarse(1e-2);
        options.KeepInside = inside;
        const Clipped clipped = ClipAll(model, fields, options);
        ExpectOneMesh(model, clipped, fields);
        sum += Volume(clipped);
      }
      // The boundary of the parts, cut included, is about ten unit squares.
      EXPECT_NEAR(sum, exact, 10.0 * 1e-2) << seed;
    }
  }
}

TEST(ClipGroup, APatchIsJoinedToItselfWhereItCloses)
{
  const MultiPatch model = MakeTube(0.5, 1.0, 1.0);
  ASSERT_EQ(model.Interfaces.size(), 1u);
  const MakeFields half = Inside({ Plane({ 0.3, 1.0, 0.2 }, { 0.0, 0.1, 0.2 }) });
  double sum = 0.0;
  for (const bool inside : { true, false })
  {
    ClipOptions options = Coarse(1e-2);
    options.KeepInside = inside;
    const Clipped clipped = ClipAll(model, half, options);
    ExpectOneMesh(model, clipped, half);
    sum += Volume(clipped);
  }
  EXPECT_NEAR(sum, 0.75 * Pi, 1e-2 * (1.5 * Pi + 3.0 * Pi));
}

TEST(ClipGroup, APatchInTheMiddleOfSixIsJoinedToThem)
{
  const MultiPatch model = MakeSphere(1.0, Parametrisation::Patches);
  ASSERT_EQ(model.Interfaces.size(), 18u);
  const MakeFields box =
    Inside({ Plane({ 1, 0.1, 0 }, { 0.6, 0, 0 }), Plane({ 0, 1, 0.3 }, { 0, 0.2, 0 }) });
  double sum = 0.0;
  for (const bool inside : { true, false })
  {
    ClipOptions options = Coarse(2e-2);
    options.KeepInside = inside;
    const Clipped clipped = ClipAll(model, box, options);
    ExpectOneMesh(model, clipped, box);
    sum += Volume(clipped);
  }
  EXPECT_NEAR(sum, 4.0 / 3.0 * Pi, 2e-2 * 4.0 * Pi);
}

TEST(ClipGroup, PatchesWithOtherBreaksAndDegreesAreJoined)
{
  const MultiPatch parts = Split(Curved(3), { 1, 2, 1 }, { Turn::Number(0), Turn::Number(29) });
  MultiPatch model = parts;
  const Aggregate& body = parts.Patches[1].Body;
  model.Patches[1].Body =
    Aggregate(ElevateDegree(RefineUniformly(body.Geometry(), { 2, 3, 2 }), 0), body.Attributes());
  const MakeFields plane = Inside({ Plane({ 1, 2, 3 }, { 0.5, 0.5, 0.5 }) });
  const Clipped clipped = ClipAll(model, plane, Coarse(1e-2));
  ExpectOneMesh(model, clipped, plane);
}

TEST(ClipGroup, FieldsOrPatchesThatDisagreeAreLeftApartAndCounted)
{
  const MultiPatch good = Split(Curved(4), { 2, 1, 1 }, { Turn::Number(0), Turn::Number(11) });
  const MakeFields below = Below(0.05);
  EXPECT_EQ(ClipAll(good, below, Coarse(1e-2)).OpenFaces, 0);
  const Aggregate& body = good.Patches[1].Body;
  // Another attribute.
  MultiPatch other = good;
  const Spline& field = body.Attributes()[0].Field;
  const Spline changed(field.Knots(), Eigen::MatrixXd(2.0 * field.Coefficients()), field.Weights());
  other.Patches[1].Body = Aggregate(body.Geometry(), { { "A", changed } });
  EXPECT_GT(ClipAll(other, below, Coarse(1e-2)).OpenFaces, 0);
  // Another place.
  MultiPatch moved = good;
  Eigen::MatrixXd points = body.Geometry().Coefficients();
  points.array() += 1e-3;
  moved.Patches[1].Body = Aggregate(
    Spline(body.Geometry().Knots(), points, body.Geometry().Weights()), body.Attributes());
  EXPECT_GT(ClipAll(moved, below, Coarse(1e-2)).OpenFaces, 0);
}

TEST(ClipGroup, WhatMissesIsTheWholeModelOrNothing)
{
  const Aggregate whole = Curved(2);
  const MultiPatch model = Split(whole, { 2, 1, 1 }, { Turn::Number(0), Turn::Number(31) });
  const double exact = integrals::Integrate(
    whole.Geometry(), [](const Eigen::Matrix3d& J) { return std::abs(J.determinant()); });
  for (const MakeFields& fields : { Below(1e3), Inside({ Plane({ 1, 0, 0 }, { 5, 0, 0 }) }) })
  {
    ClipOptions options = Coarse(1e-2);
    const Clipped all = ClipAll(model, fields, options);
    ExpectOneMesh(model, all, fields);
    EXPECT_NEAR(Volume(all), exact, 6.0 * 1e-2);
    EXPECT_EQ(all.Certificate.UndecidedCells, 0);
    options.KeepInside = false;
    const Clipped none = ClipAll(model, fields, options);
    EXPECT_EQ(none.Meshes[0].Cells.cols() + none.Meshes[1].Cells.cols(), 0);
  }
}
