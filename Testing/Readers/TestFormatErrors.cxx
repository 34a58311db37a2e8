// SPDX-License-Identifier: BSD-3-Clause
#include "Error.h"
#include "RealFiles.h"

#include <gtest/gtest.h>

#include <fstream>
#include <random>

using namespace hyperpatch;

namespace
{

template <class Parse>
std::string MessageOf(Parse&& parse)
{
  try
  {
    parse();
  }
  catch (const Error& error)
  {
    return error.what();
  }
  return "no error";
}

/// Expects an error whose message has every one of the parts.
template <class Parse>
void ExpectError(Parse&& parse, const std::vector<std::string>& parts)
{
  const std::string message = MessageOf(parse);
  for (const std::string& part : parts)
  {
    EXPECT_NE(message.find(part), message.npos) << "\"" << part << "\" is not in: " << message;
  }
}

std::string Replaced(std::string text, const std::string& from, const std::string& to)
{
  const std::size_t at = text.find(from);
  EXPECT_NE(at, text.npos) << from;
  return text.replace(at, from.size(), to);
}

const std::string G2 = R"(700 1 0 0
3 1
2 2
0 0 1 1
2 2
0 0 1 1
2 2
0 0 1 1
0 0 0 1
1 0 0 1
0 1 0 1
1 1 0 1
0 0 1 1
1 0 1 1
0 1 1 1
1 1 1 1
)";

const std::string Mesh = R"(MFEM NURBS mesh v1.0
dimension 3
elements 1
1 5 0 1 2 3 4 5 6 7
boundary 1
3 3 0 1 2 3
edges 12
0 0 1
0 3 2
0 4 5
0 7 6
1 0 3
1 1 2
1 4 7
1 5 6
2 0 4
2 1 5
2 2 6
2 3 7
vertices 8
knotvectors 3
1 2 0 0 1 1
1 2 0 0 1 1
1 2 0 0 1 1
weights
1 1 1 1 1 1 1 1
FiniteElementSpace
FiniteElementCollection: NURBS1
VDim: 3
Ordering: 1
0 0 0  1 0 0  1 1 0  0 1 0
0 0 1  1 0 1  1 1 1  0 1 1
)";

const std::string MeshOfPatches = R"(MFEM NURBS mesh v1.0
dimension 1
elements 1
1 1 0 1
boundary 0
edges 0
vertices 2
patches
knotvectors 1
1 2 0 0 1 1
dimension 2
controlpoints
0 0 1
2 2 2
)";

// A strip of two squares above one patch of two spans.
const std::string NonConforming = R"(MFEM NURBS NC-patch mesh v1.0
dimension 2
elements 3
0 1 3 0 0 1 2 3
0 1 3 0 3 6 4 5
0 1 3 0 6 2 7 4
boundary 1
9 1 0 1
vertex_to_knotspan 1
6 1 3 2
coordinates 8 2
0 0 2 0 2 1 0 1 1 2 0 2 1 1 2 2
edges 11
0 0 1
1 1 2
1 0 3
0 3 2
2 3 6
2 6 2
2 5 4
2 4 7
1 3 5
1 6 4
1 2 7
knotvectors 3
1 3 0 0 1 2 2
1 2 0 0 1 1
1 2 0 0 1 1
weights 1 1 1 1 1 1 1 1 1
FiniteElementSpace
FiniteElementCollection: NURBS1
VDim: 2
Ordering: 1
0 0 2 0 2 1 0 1 1 2 0 2 1 1 2 2 1 0
)";

const std::string Itd = R"([OBJECT [COLOR 4] BLOCK
[TRIVAR BSPLINE 2 2 2 2 2 2 P3
[KV 0 0 1 1]
[KV 0 0 1 1]
[KV 0 0 1 1]
[1 0 0 0] [1 1 0 0] [1 0 1 0] [1 1 1 0]
[1 0 0 1] [1 1 0 1] [1 0 1 1] [1 1 1 2]
]
]
)";

const std::string GeoPdes = R"(# nurbs mesh v.2.1
# two squares
2 2 2 1 1
PATCH 1
1 1
2 2
0 0 1 1
0 0 1 1
0 1 0 1
0 0 1 1
1 1 1 1
PATCH 2
1 1
2 2
0 0 1 1
0 0 1 1
1 2 1 2
0 0 1 1
1 1 1 1
INTERFACE 1
1 2
2 1
1
SUBDOMAIN 1
1 2
BOUNDARY 1
2
1 1
2 2
)";

const std::string Hierarchical = R"(<xml>
<Geometry type="THBSpline2" id="3">
<Basis type="THBSplineBasis2">
<Basis type="TensorBSplineBasis2">
<Basis type="BSplineBasis" index="0"><KnotVector degree="1">0 0 1 1</KnotVector></Basis>
<Basis type="BSplineBasis" index="1"><KnotVector degree="1">0 0 2 2</KnotVector></Basis>
</Basis>
<box level="1">0 0 1 1</box>
</Basis>
<coefs geoDim="2">0 0 1 0 0 1 1 1 0 0</coefs>
</Geometry>
</xml>
)";

const std::string Xml = R"(<?xml version="1.0"?>
<xml>
<MultiPatch><patches type="id_range">3 3</patches>
<interfaces>3 2 3 1 0 1 1 1</interfaces><boundary name="b">3 3 3 4</boundary></MultiPatch>
<Geometry type="TensorNurbs2" id="3">
<Basis type="TensorNurbsBasis2">
<Basis type="TensorBSplineBasis2">
<Basis type="BSplineBasis" index="0"><KnotVector degree="1">0 0 1 1</KnotVector></Basis>
<Basis type="BSplineBasis" index="1"><KnotVector degree="1">0 0 2 2</KnotVector></Basis>
</Basis>
<weights>1 1 1 1</weights>
</Basis>
<coefs geoDim="2">0 0 1 0 0 1 1 1</coefs>
</Geometry>
</xml>
)";

}

TEST(FormatErrors, TextsOfThisTestAreGood)
{
  EXPECT_EQ(MessageOf([] { (void)ParseGoToolsG2(G2); }), "no error");
  EXPECT_EQ(MessageOf([] { (void)ParseMfemMesh(Mesh); }), "no error");
  EXPECT_EQ(MessageOf([] { (void)ParseMfemMesh(MeshOfPatches); }), "no error");
  EXPECT_EQ(MessageOf([] { (void)ParseMfemMesh(NonConforming); }), "no error");
  EXPECT_EQ(MessageOf([] { (void)ParseGismoXml(Xml); }), "no error");
  EXPECT_EQ(MessageOf([] { (void)ParseGismoXml(Hierarchical); }), "no error");
  EXPECT_EQ(MessageOf([] { (void)ParseIritItd(Itd); }), "no error");
  EXPECT_EQ(MessageOf([] { (void)ParseGeoPdesText(GeoPdes); }), "no error");
}

TEST(FormatErrors, G2NamesLineThingAndRemedy)
{
  const auto expect =
    [](const std::string& from, const std::string& to, const std::vector<std::string>& parts)
  { ExpectError([&] { (void)ParseGoToolsG2(Replaced(G2, from, to)); }, parts); };
  expect("1 1 1 1\n", "1 1 1",
    { "object 0 (SplineVolume)", "line 8", "room for at most 7", "cut short" });
  expect(
    "\n1 1 1 1\n", "\n1 1 1 1 7\n", { "line 16", "no GoTools class has the number 7", "sizes" });
  expect("0 1 0 1", "0 x 0 1", { "line 11", "\"x\"", "a number, is expected" });
  expect("0 1 0 1", "0 nan 0 1", { "line 11", "\"nan\"", "finite" });
  expect("0 1 0 1", "0 1e999 0 1", { "line 11", "too large" });
  expect("0 1 0 1", "0 1 0 0", { "weight 2 is 0", "must be positive" });
  expect("0 1 0 1", "0 1 0 -1", { "weight 2 is -1", "must be positive" });
  expect("0 0 1 1", "0 0 1 0.5", { "line 4", "direction u", "knots decrease at index 3" });
  expect("2 2\n0 0 1 1", "4 2\n0 0 0.5 0.5 1 1",
    { "line 4", "direction u", "multiplicity 2", "split the patch there" });
  expect("2 2\n", "1000000000 2\n", { "line 3", "1000000002 knots", "room for at most" });
  expect("2 2\n", "1000000000000 2\n", { "line 3", "number of control points", "1000000000000" });
  expect("2 2\n", "99999999999999999999999 2\n", { "line 3", "9999999999" });
  expect("2 2\n", "2 0\n", { "line 3", "order" });
  expect("2 2\n", "2 40\n", { "line 3", "order", "1..32" });
  expect("3 1\n", "4 1\n", { "line 2", "number of coordinates" });
  expect("3 1\n", "3 2\n", { "line 2", "rational flag" });
  expect("700 1 0 0", "701 1 0 0", { "line 1", "no GoTools class has the number 701" });
  expect("700 1 0 0", "700 1 0 9999999", { "line 1", "9999999 auxiliary integers" });
  ExpectError([] { (void)ParseGoToolsG2("793 1 0 0\n0 1e-10\n1 2 3\n"); },
    { "no tensor-product spline", "1 LRSplineVolume (class 793)", "convert" });
  ExpectError([] { (void)ParseGoToolsG2(""); }, { "no tensor-product spline" });
}

TEST(FormatErrors, MfemNamesLineThingAndRemedy)
{
  const auto expect =
    [](const std::string& from, const std::string& to, const std::vector<std::string>& parts)
  { ExpectError([&] { (void)ParseMfemMesh(Replaced(Mesh, from, to)); }, parts); };
  expect("MFEM NURBS mesh v1.0", "MFEM mesh v1.0", { "line 1", "not a NURBS mesh", "mesh reader" });
  expect("v1.0", "v2.0", { "line 1", "v2.0", "save it as v1.0" });
  expect("mesh v1.0", "NC-patch mesh v1.1", { "line 1", "v1.1", "save it as v1.0" });
  expect("dimension 3", "dimension 4", { "line 2", "dimension", "1..3" });
  expect("1 5 0 1", "1 3 0 1", { "line 4", "element's type" });
  expect("elements 1", "elements 1000000000000", { "line 3", "1000000000000 elements", "room" });
  expect("elements 1\n1 5 0 1 2 3 4 5 6 7", "elements 0", { "line 3", "no elements" });
  expect("0 1 2 3 4 5 6 7", "0 1 2 3 4 5 6 6", { "line 4", "vertex 6 twice" });
  expect("0 1 2 3 4 5 6 7", "0 1 2 3 4 5 6 8", { "patch 0", "vertex 8" });
  expect("2 3 7\n", "2 3 6\n", { "patch 0", "edge 3 - 7", "section edges" });
  expect("2 3 7\n", "2 2 6\n", { "edge 2 - 6 is listed twice" });
  expect("2 3 7\n", "1 3 7\n", { "patch 0", "direction w", "opposite edges" });
  expect("2 3 7\n", "3 3 7\n", { "edge 3 - 7", "knot vector 3" });
  expect("vertices 8", "vertices 2000000000", { "weights are announced", "room" });
  expect("knotvectors 3\n1 2 0 0 1 1", "knotvectors 3\n1 2 0 0 1 0.5",
    { "line 22", "knot vector 0", "knots decrease" });
  expect("knotvectors 3\n1 2 ", "knotvectors 3\n1 2000000000 ", { "line 22", "2000000002 knots" });
  expect("knotvectors 3\n1 2 ", "knotvectors 3\n0 2 ", { "line 22", "degree" });
  expect("weights\n1 1", "weights\n1 0", { "line 26", "weights must be positive" });
  expect("weights\n1 1", "weights\n1 inf", { "line 26", "\"inf\"", "finite" });
  expect("weights\n", "autoweights\n", { "line 25", "\"autoweights\"", "\"weights\" is expected" });
  expect("FiniteElementCollection: NURBS1", "FiniteElementCollection: H1_3D_P1",
    { "line 28", "not NURBS" });
  expect("FiniteElementCollection: NURBS1", "FiniteElementCollection: NURBS2",
    { "line 28", "degree 1", "same space" });
  expect("VDim: 3", "VDim: 4", { "line 29", "VDim" });
  expect("1 1 1  0 1 1\n", "1 1 1  0 1\n", { "ends where a coordinate is expected", "cut short" });
  expect("1 1 1  0 1 1\n", "1 1 1  0 1 1 5\n",
    { "line 32", "\"5\" after the last control point", "counts" });
  expect("knotvectors 3", "spacing 3", { "line 21", "\"spacing\"", "patches" });
  const auto expectSpacing = [&](const std::string& section, const std::vector<std::string>& parts)
  {
    const std::string text = Replaced(Mesh, "v1.0", "v1.1");
    ExpectError(
      [&] { (void)ParseMfemMesh(Replaced(text, "weights\n", section + "weights\n")); }, parts);
  };
  expectSpacing("refinements 2 2 2 knotvector_refinements 1 2 0 1 3 spacing 1 0 5 3 1 1 0 1 10.0 ",
    { "no error" });
  expectSpacing("spacing 1 3 5 0 0\n", { "line 25", "knot vector's index", "0..2" });
  expectSpacing("spacing 1 0 5 0 1000000000000 2\n", { "line 25", "1000000000000 real", "room" });
  expectSpacing("refinements 2 2\n", { "line 26", "\"weights\"", "refinement factor" });
  ExpectError([] { (void)ParseMfemMesh(Mesh.substr(0, Mesh.find("FiniteElement"))); },
    { "the file ends where \"FiniteElementSpace\" is expected", "cut short" });
  ExpectError(
    []
    {
      (void)ParseMfemMesh(Replaced(Replaced(Mesh, "elements 1", "elements 3"),
        "1 5 0 1 2 3 4 5 6 7", "1 5 0 1 2 3 4 5 6 7 1 5 0 1 2 3 4 5 6 7 1 5 0 1 2 3 4 5 6 7"));
    },
    { "patch 2", "shared by more than two patches" });
  ExpectError(
    []
    {
      (void)ParseMfemMesh(
        Replaced(Replaced(Replaced(Mesh, "vertices 8", "vertices 12"), "elements 1", "elements 2"),
          "1 5 0 1 2 3 4 5 6 7", "1 5 0 1 2 3 4 5 6 7 1 5 0 2 1 3 8 9 10 11"));
    },
    { "patch 1", "does not go around the same face" });
}

TEST(FormatErrors, MfemPatchesNameLineThingAndRemedy)
{
  const auto expect =
    [](const std::string& from, const std::string& to, const std::vector<std::string>& parts)
  { ExpectError([&] { (void)ParseMfemMesh(Replaced(MeshOfPatches, from, to)); }, parts); };
  expect("2 2 2", "2 2", { "ends where a coordinate is expected", "cut short" });
  expect("2 2 2", "2 2 0", { "patch 0", "weight 1 is 0", "must be positive" });
  expect("2 2 2", "2 2 -1", { "patch 0", "weight 1 is -1" });
  expect("controlpoints", "points", { "line 12", "\"points\"", "controlpoints_cartesian" });
  expect("controlpoints\n0 0 1\n2 2 2", "controlpoints_cartesian\n0 0 1\n2 2 0",
    { "patch 0", "weight 1", "must be positive" });
  expect("knotvectors 1", "knotvectors 2", { "line 9", "number of knot vectors" });
  expect("1 2 0 0 1 1", "1 3 0 0 0 1 1", { "line 10", "patch 0, direction u", "multiplicity 3" });
}

TEST(FormatErrors, NonConformingMeshesNameLineThingAndRemedy)
{
  const auto expect =
    [](const std::string& from, const std::string& to, const std::vector<std::string>& parts)
  { ExpectError([&] { (void)ParseMfemMesh(Replaced(NonConforming, from, to)); }, parts); };
  expect("0 1 3 0 0 1 2 3", "0 1 3 1 0 1 2 3", { "line 4", "refined in itself", "save" });
  expect("6 1 3 2", "8 1 3 2", { "hanging vertex 8", "0..7" });
  expect("6 1 3 2", "6 1 3 9", { "vertex 6 hangs on edge 3 - 9", "section edges" });
  expect("6 1 3 2", "6 2 3 2", { "vertex 6 hangs behind 2", "that place or the vertex is taken" });
  expect("6 1 3 2", "6 7 3 2", { "vertex 6 hangs behind 7", "not on its face" });
  expect("vertex_to_knotspan 1", "vertex_to_knotspan 99", { "line 9", "99 hanging", "room" });
  expect("coordinates 8 2", "coordinates 999 2", { "line 11", "999 vertices", "room" });
  expect(
    "1 3 0 0 1 2 2", "2 4 0 0 0 1 2 2 2", { "edge 2 - 3", "degree 2", "save a conforming one" });
  expect("1 3 0 0 1 2 2", "1 4 0 0 0.5 1 2 2", { "edge 2 - 3", "1 hanging", "2 control points" });
}

TEST(FormatErrors, GismoNamesElementThingAndRemedy)
{
  const auto expect =
    [](const std::string& from, const std::string& to, const std::vector<std::string>& parts)
  { ExpectError([&] { (void)ParseGismoXml(Replaced(Xml, from, to)); }, parts); };
  const std::string geometry = "line 5, <Geometry id=\"3\">";
  ExpectError([] { (void)ParseGismoXml(Xml.substr(0, Xml.size() / 2)); },
    { "line ", "not well-formed XML", "cut short" });
  ExpectError([] { (void)ParseGismoXml("<VTKFile/>"); }, { "no element <xml>" });
  ExpectError([] { (void)ParseGismoXml("<xml><Function/></xml>"); },
    { "no tensor-product spline geometry, only 1 <Function>", "export" });
  expect("TensorNurbs2\"", "RationalTHBSpline2\"", { "only 1 <Geometry", "RationalTHBSpline2" });
  expect("TensorNurbs2\"", "TensorNurbs4\"", { "only 1 <Geometry type=\"TensorNurbs4\">" });
  expect("TensorNurbs2\"", "TensorNurbs3\"", { geometry, "2 knot vectors where 3 are needed" });
  expect("id=\"3\">", "id=\"x\">", { "<Geometry id=\"x\">: line 5", "the id" });
  expect("index=\"1\"", "index=\"0\"", { "line 9", "index 0 is repeated" });
  expect("index=\"1\"", "index=\"5\"", { "line 9", "index 5" });
  expect("degree=\"1\"", "order=\"1\"", { "line 8", "degree is missing" });
  expect("degree=\"1\"", "degree=\"99\"", { "line 8", "degree", "0..31" });
  expect("0 0 2 2", "0 0 2 1", { "line 9, <KnotVector>, direction v", "knots decrease" });
  expect("0 0 2 2", "0 0 1 1 2 2", { "line 9", "direction v", "multiplicity 2" });
  expect("0 0 2 2", "0 0 2 nan", { "line 9", "\"nan\"", "finite" });
  expect("0 0 2 2", "0 0 2 2/0", { "line 9", "\"2/0\"", "finite" });
  expect("0 0 2 2", "0 0 2 zwei", { "line 9", "\"zwei\"" });
  expect("<weights>1 1", "<weights>1 0", { geometry, "weight 1", "positive" });
  expect("<weights>1 1", "<weights>1", { geometry, "3 weights for 4 control points" });
  expect("<weights>1 1 1 1</weights>", "", { geometry, "no <weights>" });
  expect("<weights>1 1 1 1<", "<weights><", { "line 11, <weights>", "empty" });
  expect("0 0 1 0 0 1 1 1", "0 0 1 0 0 1 1", { "line 13, <coefs>", "7 numbers", "2 x 2 x 1" });
  expect("geoDim=\"2\"", "geoDim=\"3\"", { "line 13, <coefs>", "8 numbers", "geoDim" });
  expect(
    "coefs geoDim", "coefs format=\"B64Int32\" geoDim", { "line 13", "\"B64Int32\"", "ASCII" });
  expect("coefs geoDim", "coefs format=\"B64Float64\" geoDim", { "line 13", "multiple of 8" });
  expect("<coefs geoDim=\"2\">0 0 1 0 0 1 1 1</coefs>", "", { geometry, "no <coefs>" });
  expect("3 3<", "3 4<", { "line 3, <patches>", "more patches than" });
  expect("3 3<", "0 999999999<", { "line 3, <patches>", "more patches than" });
  expect("3 3<", "4 4<", { "line 3, <patches>", "no geometry of the file has the id 4" });
  expect("id_range", "id_list", { "line 3, <patches>", "\"id_list\"", "id_index" });
  expect("3 2 3 1 0 1", "3 2 3 1 0 0", { "line 4, <interfaces>", "8 each" });
  expect("3 2 3 1 0 1", "3 2 5 1 0 1", { "line 4, <interfaces>", "existing patches" });
  expect("3 3 3 4", "3 3 3 5", { "line 4, <boundary>", "patch 3 with side 5" });
  expect("3 3 3 4", "3 3 3", { "line 4, <boundary>", "3 numbers" });
}

TEST(FormatErrors, HierarchicalSplinesNameElementThingAndRemedy)
{
  const auto expect =
    [](const std::string& from, const std::string& to, const std::vector<std::string>& parts)
  { ExpectError([&] { (void)ParseGismoXml(Replaced(Hierarchical, from, to)); }, parts); };
  const std::string geometry = "line 2, <Geometry id=\"3\">";
  expect("0 0 1 1</box>", "0 0 1</box>", { "line 8, <box>", "4 numbers", "there are 3" });
  expect("0 0 1 1</box>", "0 0 3 1</box>", { geometry, "level 1", "has 2 elements" });
  expect("0 0 1 1</box>", "0 0 0 1</box>", { geometry, "is empty or outside" });
  expect("level=\"1\"", "level=\"31\"", { "line 8", "the level", "0..30" });
  expect("level=\"1\"", "level=\"30\"", { geometry, "finest of 31 levels", "fewer levels" });
  expect("1 1 0 0</coefs>", "1 1</coefs>", { geometry, "fewer than active functions" });
  expect("1 1 0 0</coefs>", "1 1 0 0 0 0</coefs>", { geometry, "6 control points for 5 active" });
  expect("1 1 0 0</coefs>", "1 1 0</coefs>", { "line 10, <coefs>", "9 numbers", "geoDim" });
  expect("geoDim=\"2\"", "geoDim=\"0\"", { "line 10, <coefs>", "0 coordinates" });
  expect("index=\"1\"", "index=\"0\"", { "line 6", "index 0 is repeated" });
}

TEST(FormatErrors, ItdNamesLineThingAndRemedy)
{
  const auto expect =
    [](const std::string& from, const std::string& to, const std::vector<std::string>& parts)
  { ExpectError([&] { (void)ParseIritItd(Replaced(Itd, from, to)); }, parts); };
  expect("[1 1 1 2]\n]\n]", "[1 1 1 2]\n]\n", { "line 8", "1 open bracket", "cut short" });
  expect("[1 1 1 2]\n]\n]", "[1 1 1", { "ends where a coordinate is expected", "cut short" });
  expect("[1 1 1 2]\n]", "]", { "line 7", "where \"[\" is expected" });
  expect("]\n]\n]", "]\n]\n]\n]", { "line 10", "closed that was not opened" });
  expect("[1 0 1 0]", "[1 0 x 0]", { "line 6", "\"x\"", "a number, is expected" });
  expect("[1 0 1 0]", "[1 0 nan 0]", { "line 6", "\"nan\"", "finite" });
  expect("[1 0 1 0]", "[0 0 1 0]", { "line 8", "TRIVAR 0", "weight 2 is 0", "must be positive" });
  expect("[1 0 1 0]", "[-1 0 1 0]", { "TRIVAR 0", "weight 2 is -1", "must be positive" });
  expect("[1 0 1 0]", "[1 0 1]", { "line 6", "\"]\" where a coordinate" });
  expect("[1 0 1 0]", "[1 0 1 0 5]", { "line 6", "\"5\" where \"]\" is expected" });
  expect("[KV 0 0 1 1]", "[KV 0 0 1 0.5]", { "line 3", "direction u", "knots decrease" });
  expect("[KV 0 0 1 1]", "[KV 0 0 1]", { "line 3", "\"]\" where a knot" });
  expect("[KV 0 0 1 1]", "[KV 0 0 1 1 1]", { "line 3", "\"1\" where \"]\" is expected" });
  expect("BSPLINE 2 2 2 2", "BSPLINE 4 2 2 2", { "line 3", "\"]\" where a knot" });
  expect("BSPLINE 2 2 2 2", "BSPLINE 1000000000 2 2 2", { "line 3", "1000000002 knots", "room" });
  expect("BSPLINE 2 2 2 2", "BSPLINE 2 2 2 99", { "line 2", "order", "1..32" });
  expect("BSPLINE 2 2 2 2 2 2", "BEZIER 99 2 2", { "line 2", "the order is 99", "1..32" });
  expect("BSPLINE", "POWER", { "line 2", "\"POWER\"", "BSPLINE or BEZIER" });
  expect("P3", "E5", { "line 2", "\"E5\"", "E1 to E3" });
  expect("P3", "X3", { "line 2", "\"X3\"", "P1 to P3" });
  ExpectError([] { (void)ParseIritItd("[OBJECT A [POLYGON 1 [0 0 0]]]"); },
    { "no spline", "only 1 POLYGON", "save it as TRIVAR" });
  ExpectError([] { (void)ParseIritItd(""); }, { "no spline" });
}

TEST(FormatErrors, GeoPdesNamesLineThingAndRemedy)
{
  const auto expect =
    [](const std::string& from, const std::string& to, const std::vector<std::string>& parts)
  { ExpectError([&] { (void)ParseGeoPdesText(Replaced(GeoPdes, from, to)); }, parts); };
  expect("2 2 2 1 1", "2", { "line 3", "line of counts", "at least two numbers" });
  expect("2 2 2 1 1", "4 2 2 1 1", { "line 3", "4 parameters", "1 to 3" });
  expect("2 2 2 1 1", "2 4 2 1 1", { "line 3", "4 coordinates", "1 to 3" });
  expect("2 2 2 1 1", "2 x 2 1 1", { "line 3", "\"x\" where a count" });
  expect("2 2 2 1 1", "2 2 1000000000 1 1", { "line 3", "1000000000 patches", "room" });
  expect("2 2 2 1 1", "2 2 2 1000000000 1", { "line 3", "1000000000 interfaces", "room" });
  expect("2 2 2 1 1", "2 2 2 1 1000000000", { "line 3", "1000000000 subdomains", "room" });
  expect("1 1\n2 2\n", "1 99\n2 2\n", { "patch 1: line 5", "a degree", "0..31" });
  expect("1 1\n2 2\n", "1 1\n2 0\n", { "patch 1: line 6", "number of control points" });
  expect("1 1\n2 2\n", "1 1\n1000000000 2\n", { "patch 1: line 6", "1000000002 knots", "room" });
  expect("0 0 1 1\n", "0 0 1 0.5\n", { "patch 1: line 7", "direction u", "knots decrease" });
  expect("0 0 1 1\n", "0 0 1 nan\n", { "patch 1: line 7", "\"nan\"", "finite" });
  expect("1 1 1 1\nPATCH", "1 1 1 0\nPATCH",
    { "patch 1: control points up to line 11", "weight 3 is 0", "must be positive" });
  expect("1 1 1 1\nPATCH", "1 1 1 -1\nPATCH", { "patch 1", "weight 3 is -1" });
  expect("1 1 1 1\nPATCH", "1 1 1\nPATCH", { "patch 1: line 12", "\"PATCH\"", "a weight" });
  expect("1 2\n2 1\n1\n", "1 5\n2 1\n1\n", { "line 21", "a side", "1..4" });
  expect("1 2\n2 1\n1\n", "3 2\n2 1\n1\n", { "line 21", "a patch", "1..2" });
  expect("1 2\n2 1\n1\n", "1 2\n2 1\n7\n", { "line 23", "orientation", "-1..1" });
  expect("BOUNDARY 1\n2\n", "BOUNDARY 1\n3\n", { "line 27", "3 sides of a boundary", "room" });
  ExpectError([] { (void)ParseGeoPdesText(GeoPdes.substr(0, GeoPdes.find("PATCH 2") - 6)); },
    { "patch 1: line 8", "room for at most 3", "cut short" });
  ExpectError([] { (void)ParseGeoPdesText("# nurbs mesh v.2.1\n"); },
    { "line of counts is expected", "cut short" });
}

TEST(FormatErrors, AHugeCountIsRefusedBeforeMemoryIsTaken)
{
  // Each factor fits in the file, the product does not: 3 x 10^6 bytes announce 10^17 points.
  std::string huge = "700 1 0 0\n3 0\n";
  for (int d = 0; d < 3; ++d)
  {
    huge += "500000 2\n0 ";
    for (int i = 0; i < 500000; ++i)
    {
      huge += std::to_string(i) + " ";
    }
    huge += "499999\n";
  }
  ExpectError([&] { (void)ParseGoToolsG2(huge); }, { "250000000000 control points", "room" });

  // A mesh whose two knot vectors are there, but not the 9 x 10^6 control points.
  std::string mesh = "MFEM NURBS mesh v1.0 dimension 2 elements 1 1 3 0 1 2 3 boundary 0 edges 4 "
                     "0 0 1 1 1 2 0 3 2 1 0 3 vertices 4 knotvectors 2 ";
  for (int d = 0; d < 2; ++d)
  {
    mesh += "1 3000 0 ";
    for (int i = 0; i < 3000; ++i)
    {
      mesh += std::to_string(i) + " ";
    }
    mesh += "2999 ";
  }
  ExpectError([&] { (void)ParseMfemMesh(mesh); },
    { "patch 0", "more control points than a file of this size can hold" });
}

TEST(FormatErrors, ReadSplineFileBeginsWithTheFileName)
{
  const auto directory = std::filesystem::temp_directory_path();
  const auto write = [&](const std::string& name, const std::string& text)
  {
    const std::string path = (directory / name).string();
    std::ofstream(path, std::ios::binary) << text;
    return path;
  };
  const std::vector<std::pair<std::string, std::string>> files{ { "", "the file is empty" },
    { "\x1f\x8b\x08zzzz", "compressed" }, { "x,y,z\n1,2,3\n", "not a G+Smo XML, MFEM mesh" },
    { "MFEM mesh v1.0\n", "not a NURBS mesh" },
    { Replaced(G2, "1 1 1 1\n", "1 1 1"), "object 0 (SplineVolume): line 8" } };
  for (const auto& [text, expected] : files)
  {
    const std::string path = write("hyperpatch-format-error.txt", text);
    const std::string message = MessageOf([&] { (void)ReadSplineFile(path); });
    EXPECT_EQ(message.find(path + ": "), 0u) << message;
    EXPECT_NE(message.find(expected), message.npos) << message;
    std::filesystem::remove(path);
  }
  const std::string absent = (directory / "no-such-file.g2").string();
  EXPECT_EQ(
    MessageOf([&] { (void)ReadSplineFile(absent); }).find(absent + ": the file cannot be "), 0u);
  EXPECT_NE(MessageOf([&] { (void)ReadSplineFile(directory.string()); }).find("cannot be read"),
    std::string::npos);
  const std::string good = write("hyperpatch-format-good.mesh", Mesh);
  EXPECT_EQ(ReadSplineFile(good).Model.Patches.size(), 1u);
  std::filesystem::remove(good);
}

TEST(FormatErrors, EveryTruncationAndMutationParsesOrIsAnError)
{
  std::vector<std::string> seeds{ G2, Mesh, MeshOfPatches, NonConforming, Xml, Hierarchical, Itd,
    GeoPdes };
  std::vector<std::string> names;
  for (const std::string name : { "folded_sweep.xml", "tube_on_block.xml", "quarter_tube.g2",
         "twisted_bar.mesh", "quarter_tube.itd", "two_blocks.txt" })
  {
    names.push_back(std::string(HYPERPATCH_DATA) + "/" + name);
  }
  for (const std::string name : { "gismo/fichera.xml", "gismo/linear_elasticity_example.xml",
         "splinepy/gismo_indent_nolabels_ascii_3d.xml", "mfem/beam-hex-nurbs.mesh",
         "mfem/two-cubes-nurbs.mesh", "mfem/pipe-nurbs.mesh", "mfem/pipe-nurbs-log.mesh",
         "mfem/nc-nurbs3d.mesh", "splipy/cube-8-orient3.g2", "gismo/thbcube.xml",
         "irit/skeletal_muscle.itd", "geopdes/geo_2cubesb.txt" })
  {
    names.push_back(models::RealFile(name));
  }
  for (const std::string& name : names)
  {
    std::ifstream file(name, std::ios::binary);
    if (file)
    {
      seeds.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
    }
  }
  const std::vector<std::string> numbers{ "0", "-1", "1e308", "-1e308", "1e-320", "nan", "inf",
    "2147483647", "2147483648", "-2147483648", "9223372036854775807", "1000000000000", "1e999",
    "0x10", "1/0", "3.5", "", " ", "#", "<", "\"", "&#0;", std::string(1, '\0') };
  std::mt19937 random(20240607);
  const auto below = [&random](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  std::size_t parsed = 0;
  std::size_t refused = 0;
  for (const std::string& seed : seeds)
  {
    for (int n = 0; n < 600; ++n)
    {
      std::string text = seed;
      const std::size_t changes = 1 + below(3);
      for (std::size_t c = 0; c < changes && !text.empty(); ++c)
      {
        const std::size_t at = below(text.size());
        switch (below(5))
        {
          case 0:
            text.resize(at);
            break;
          case 1:
            text[at] = static_cast<char>(text[at] ^ 1 << below(8));
            break;
          case 2:
          {
            const std::size_t begin = text.find_first_of("0123456789", at);
            if (begin != text.npos)
            {
              const std::size_t end = text.find_first_not_of("0123456789.", begin);
              text.replace(
                begin, end == text.npos ? end : end - begin, numbers[below(numbers.size())]);
            }
            break;
          }
          case 3:
            text.erase(at, 1 + below(40));
            break;
          default:
            text.insert(at, text.substr(below(text.size()), below(80)));
            break;
        }
      }
      const auto parse = seed[0] == '<' ? ParseGismoXml
        : seed[0] == 'M'                ? ParseMfemMesh
        : seed[0] == '['                ? ParseIritItd
        : seed[0] == '#'                ? ParseGeoPdesText
                                        : ParseGoToolsG2;
      (void)SniffFormat(text);
      try
      {
        (void)parse(text);
        ++parsed;
      }
      catch (const Error& error)
      {
        ++refused;
        ASSERT_STRNE(error.what(), "");
        for (const char* c = error.what(); *c != '\0'; ++c)
        {
          ASSERT_TRUE(*c >= ' ' && *c <= '~') << error.what();
        }
      }
      // Any other exception fails the test.
    }
  }
  EXPECT_GT(parsed, 100u);
  EXPECT_GT(refused, 500u);
}
