// SPDX-License-Identifier: BSD-3-Clause
#include "Append.h"

#include "Error.h"
#include "Interfaces.h"
#include "Modelling.h"
#include "Operators.h"
#include "Primitives.h"

#include <gtest/gtest.h>

#include <string>

using namespace hyperpatch;

namespace
{

/// A unit cube with one corner at (x, 0, 0), its id 7, and a boundary on its far side.
MultiPatch Cube(double x, int components)
{
  MultiPatch cube = MakeBox({ 1, 1, 1 });
  const Spline& g = cube.Patches[0].Body.Geometry();
  Eigen::MatrixXd points = g.Coefficients();
  points.array() += 0.5;
  points.row(0).array() += x;
  const Spline geometry(g.Knots(), points);
  const Spline field(g.Knots(), Eigen::MatrixXd::Constant(components, 8, x));
  cube.Patches[0] = { 7, Aggregate(geometry, { { "Heat", field } }) };
  cube.Boundaries = { { "end", { { 7, 1 } } } };
  return cube;
}

}

TEST(Append, RenumbersPatchesAndFindsInterfaces)
{
  MultiPatch sphere = MakeSphere(0.1, Parametrisation::Patches);
  const MultiPatch all = Append({ Cube(0, 1), Cube(1, 1), sphere });
  ASSERT_EQ(all.Patches.size(), 9u);
  for (int i = 0; i < 9; ++i)
  {
    EXPECT_EQ(all.Patches[static_cast<std::size_t>(i)].Id, i);
  }
  ASSERT_EQ(all.Interfaces.size(), sphere.Interfaces.size());
  EXPECT_EQ(all.Interfaces[0].Values[0], sphere.Interfaces[0].Values[0] + 2);
  EXPECT_EQ(all.Interfaces[0].Values[2], sphere.Interfaces[0].Values[2] + 2);
  ASSERT_EQ(all.Boundaries.size(), 1u);
  EXPECT_EQ(all.Boundaries[0].Sides, (std::vector<std::array<int, 2>>{ { 0, 1 }, { 1, 1 } }));

  const MultiPatch joined = WithFoundInterfaces(all, 1e-9);
  ASSERT_EQ(joined.Interfaces.size(), sphere.Interfaces.size() + 1);
  EXPECT_EQ(joined.Interfaces.back().Values, (std::array<int, 10>{ 0, 2, 1, 1, 0, 1, 2, 1, 1, 1 }));
  // What is there already is not found again.
  EXPECT_EQ(WithFoundInterfaces(joined, 1e-9).Interfaces.size(), joined.Interfaces.size());
}

TEST(Append, AttributesMustAgreeInComponents)
{
  try
  {
    (void)Append({ Cube(0, 1), Cube(1, 3) });
    FAIL();
  }
  catch (const Error& error)
  {
    EXPECT_NE(std::string(error.what()).find("\"Heat\" has 1 components"), std::string::npos);
  }
}

TEST(Append, PartsOfAPatchStayTogetherOrBecomePatches)
{
  const Patch whole{ 3,
    Aggregate(RefineUniformly(Cube(0, 1).Patches[0].Body.Geometry(), { 2, 1, 1 })) };
  MultiPatch parts;
  parts.Patches = { RestrictPatch(whole, { 0, 0, 0 }, { 1, 1, 1 }),
    RestrictPatch(whole, { 1, 0, 0 }, { 2, 1, 1 }) };
  const MultiPatch all = Append({ Cube(5, 1), parts });
  EXPECT_EQ(all.Patches[1].Id, 1);
  EXPECT_EQ(all.Patches[2].Id, 1);
  EXPECT_EQ(all.Patches[2].FirstSpan, (std::array<int, 3>{ 1, 0, 0 }));

  const MultiPatch patches = PartsAsPatches(parts);
  EXPECT_EQ(patches.Patches[1].Id, 1);
  EXPECT_EQ(patches.Patches[1].FirstSpan, (std::array<int, 3>{ 0, 0, 0 }));
  EXPECT_EQ(WithFoundInterfaces(patches, 1e-9).Interfaces.size(), 1u);
  EXPECT_EQ(PartsAsPatches(Cube(0, 1)).Patches[0].Id, 7);
}
