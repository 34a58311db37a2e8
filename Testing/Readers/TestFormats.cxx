// SPDX-License-Identifier: BSD-3-Clause
#include "Interfaces.h"
#include "RealFiles.h"

#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <sstream>

using namespace hyperpatch;

namespace
{

constexpr double Epsilon = std::numeric_limits<double>::epsilon();

const std::string Curve = R"(<KnotVector degree="1">0 0 1 1</KnotVector>)";

std::string GismoBox(const std::string& attributes, double shift)
{
  std::ostringstream out;
  out << "<Geometry type=\"TensorBSpline3\" " << attributes << "><Basis>";
  for (int d = 0; d < 3; ++d)
  {
    out << "<Basis type=\"BSplineBasis\" index=\"" << d << "\">" << Curve << "</Basis>";
  }
  out << "</Basis><coefs geoDim=\"3\">";
  for (int i = 0; i < 8; ++i)
  {
    out << (i & 1) + shift << ' ' << (i >> 1 & 1) << ' ' << (i >> 2) << '\n';
  }
  out << "</coefs></Geometry>";
  return out.str();
}

}

TEST(Formats, EveryRealFileOpens)
{
  std::size_t seen = 0;
  for (const std::string folder :
    { "gismo", "splinepy", "mfem", "gotools", "splipy", "irit", "geopdes" })
  {
    for (const std::string& name : models::RealFiles(folder))
    {
      ++seen;
      FileContents contents;
      ASSERT_NO_THROW(contents = ReadSplineFile(name)) << name;
      EXPECT_FALSE(contents.Model.Patches.empty()) << name;
      for (const Patch& patch : contents.Model.Patches)
      {
        EXPECT_EQ(patch.Body.Geometry().Dimension(), 3) << name;
        EXPECT_EQ(patch.Body.Attributes().empty(), name.find("sphere8") == name.npos) << name;
      }
    }
  }
  if (seen == 0)
  {
    GTEST_SKIP() << "no shared data";
  }
}

TEST(Formats, PatchesOfRealFilesDoNotFold)
{
  if (models::RealFiles("gismo").empty())
  {
    GTEST_SKIP() << "no shared data";
  }
  // Sign of det J at inner points, 0 where patches of both hands are in the file: a wrong order of
  // control points or a weight that is missing folds a patch.
  const std::map<std::string, int> files{ { "gismo/fichera.xml", 0 }, { "gismo/bent_pipe.xml", 0 },
    { "gismo/quarter_cylinder.xml", 0 }, { "gismo/cylinder.xml", -1 },
    { "gismo/twisted_pipe.xml", 0 }, { "gismo/linear_elasticity_example.xml", 1 },
    { "mfem/beam-hex-nurbs.mesh", 1 }, { "mfem/cube-nurbs.mesh", 1 },
    { "mfem/ijk-hex-nurbs.mesh", 1 }, { "mfem/pipe-nurbs.mesh", 1 },
    { "mfem/two-cubes-nurbs.mesh", 1 }, { "gotools/vols.g2", 1 }, { "gotools/swept_vol.g2", 0 },
    { "gotools/nut.g2", -1 }, { "splipy/cube-8-orient0.g2", 1 } };
  for (const auto& [name, sign] : files)
  {
    const FileContents file = ReadSplineFile(models::RealFile(name));
    for (const Patch& patch : file.Model.Patches)
    {
      const std::vector<double> determinants = models::Determinants(patch.Body.Geometry());
      const double reference = sign == 0 ? determinants[13] : sign;
      for (const double determinant : determinants)
      {
        EXPECT_GT(determinant * reference, 0.0) << name << ", patch " << patch.Id;
      }
    }
  }
}

TEST(Formats, InterfacesThatFilesStateCoincide)
{
  bool any = false;
  for (const std::string folder : { "gismo", "splinepy", "mfem" })
  {
    for (const std::string& name : models::RealFiles(folder))
    {
      const MultiPatch model = ReadSplineFile(name).Model;
      // The three patches of this file leave gaps of 0.3 at a size of 400.
      const double tolerance = name.find("water_passage") != name.npos ? 1e-2 : 1e-14;
      for (const Interface& interface : model.Interfaces)
      {
        any = true;
        EXPECT_LE(models::Gap(model, interface), tolerance * models::Diagonal(model)) << name;
      }
    }
  }
  if (!any)
  {
    GTEST_SKIP() << "no shared data";
  }
}

TEST(Formats, TheHierarchicalCubeIsTheIdentity)
{
  const std::string name = models::RealFile("gismo/thbcube.xml");
  if (!std::filesystem::exists(name))
  {
    GTEST_SKIP() << "no shared data";
  }
  const FileContents file = ReadSplineFile(name);
  const Spline& cube = file.Model.Patches.at(0).Body.Geometry();
  EXPECT_EQ(cube.Sizes(), (std::array<int, 3>{ 5, 5, 5 }));
  for (int n = 0; n < 125; ++n)
  {
    const Eigen::Vector3d u(n % 5 / 4.0, n / 5 % 5 / 4.0, n / 25 / 4.0);
    EXPECT_LE((cube.Evaluate(u[0], u[1], u[2]) - u).norm(), 4 * Epsilon);
  }
  ASSERT_EQ(file.Warnings.size(), 1u);
  EXPECT_EQ(file.Warnings[0],
    "1 hierarchical spline read as the same tensor-product spline on its finest level.");
}

TEST(Formats, GoToolsReadsCurvesSurfacesAndColours)
{
  const FileContents file = ParseGoToolsG2(R"(100 1 0 4 255 0 0 255
2 1
3 3
0 0 0 1 1 1
1 0 1
1 1 2
0 3 3

200 1 0 0
3 0
2 2 0 0 1 1
3 2 0 0 0.5 1 1
0 0 0  1 0 0  0 1 0  1 1 0  0 2 0  1 2 4
793 1 0 0
0 1e-10
100 200 300 400
700 2 0 0
250 1 0 0

0 0 0
100 1 0 0
+3 0 2 2 0 0 1 1 0 0 0 1e0 1E0 +1
)");
  ASSERT_EQ(file.Model.Patches.size(), 3u);
  const Spline& curve = file.Model.Patches[0].Body.Geometry();
  EXPECT_EQ(curve.Dimension(), 1);
  // The file has points multiplied by their weights.
  EXPECT_EQ(curve.Coefficients().col(1), Eigen::Vector2d(0.5, 0.5));
  EXPECT_EQ(curve.Coefficients().col(2), Eigen::Vector2d(0, 1));
  EXPECT_EQ(curve.Weights(), Eigen::Vector3d(1, 2, 3));
  const Spline& surface = file.Model.Patches[1].Body.Geometry();
  EXPECT_EQ(surface.Sizes(), (std::array<int, 3>{ 2, 3, 1 }));
  EXPECT_EQ(surface.Coefficients().col(5), Eigen::Vector3d(1, 2, 4));
  EXPECT_EQ(file.Model.Patches[2].Id, 2);
  ASSERT_EQ(file.Warnings.size(), 1u);
  EXPECT_EQ(file.Warnings[0],
    "2 objects of classes that are not read: 1 Plane (class 250), 1 LRSplineVolume (class 793).");
}

TEST(Formats, GismoTakesTextAsPeopleWriteIt)
{
  const FileContents file = ParseGismoXml(R"(<!-- first --> <?xml version="1.0"?>
<xml><Function type="FunctionExpr" dim="3">x*y</Function><OptionList/><Function/>
<Geometry type="TensorNurbs2"><Basis type="TensorNurbsBasis2"><weights>1 2/4 1
1</weights><Basis type="TensorBSplineBasis2">
<Basis type="BSplineBasis" index="1"><KnotVector degree="1">0 0 1/3 1/3</KnotVector></Basis>
<Basis type="BSplineBasis" index="0"><KnotVector degree="1">0	0 <!-- inside -->	2
2</KnotVector></Basis></Basis></Basis>
<coefs geoDim="3">0 0 0 1 0 0 0 1 0 1 1 -1/3</coefs></Geometry>
<Geometry type="BSpline"><Basis type="BSplineBasis"><KnotVector degree="1">0 0 1 1</KnotVector>
</Basis><coefs>1 2 3 4</coefs></Geometry></xml>)");
  ASSERT_EQ(file.Model.Patches.size(), 2u);
  const Spline& surface = file.Model.Patches[0].Body.Geometry();
  EXPECT_EQ(surface.Knots(0).Knots(), (std::vector<double>{ 0, 0, 2, 2 }));
  EXPECT_EQ(surface.Knots(1).Last(), 1.0 / 3.0);
  EXPECT_EQ(surface.Weights(), Eigen::Vector4d(1, 0.5, 1, 1));
  EXPECT_EQ(surface.Coefficients()(2, 3), -1.0 / 3.0);
  EXPECT_EQ(file.Model.Patches[1].Id, 1);
  EXPECT_EQ(file.Model.Patches[1].Body.Geometry().Components(), 2);
  ASSERT_EQ(file.Warnings.size(), 1u);
  EXPECT_EQ(
    file.Warnings[0], "3 elements skipped that are no splines: 2 <Function>, 1 <OptionList>.");
}

TEST(Formats, GismoTopologyUsesTheIdsOfTheFile)
{
  const std::string topology = R"(<MultiPatch parDim="3"><patches type="id_index">9 4</patches>
<interfaces>4 2 9 1 0 1 2 1 1 1</interfaces><boundary name="in">4 1</boundary>
<boundary name="out">9 2</boundary><boundary name="in">9 3</boundary><boundary>4 3</boundary>
</MultiPatch>)";
  const FileContents file = ParseGismoXml(
    "<xml>" + GismoBox("id=\"4\"", 0) + topology + GismoBox("id=\"9\"", 1) + "</xml>");
  ASSERT_EQ(file.Model.Patches.size(), 2u);
  EXPECT_EQ(file.Model.Patches[1].Id, 9);
  ASSERT_EQ(file.Model.Interfaces.size(), 1u);
  EXPECT_EQ(file.Model.Interfaces[0].Values, (std::array<int, 10>{ 4, 2, 9, 1, 0, 1, 2, 1, 1, 1 }));
  EXPECT_EQ(models::Gap(file.Model, file.Model.Interfaces[0]), 0.0);
  ASSERT_EQ(file.Model.Boundaries.size(), 3u);
  EXPECT_EQ(file.Model.Boundaries[0].Name, "in");
  EXPECT_EQ(
    file.Model.Boundaries[0].Sides, (std::vector<std::array<int, 2>>{ { 4, 0 }, { 9, 2 } }));
  EXPECT_EQ(file.Model.Boundaries[2].Name, "boundary");
  EXPECT_TRUE(file.Warnings.empty());

  // The form without direction maps.
  const FileContents old =
    ParseGismoXml("<xml>" + GismoBox("id=\"4\"", 0) + GismoBox("id=\"9\"", 1) +
      R"(<MultiPatch><patches type="id_index">9 4</patches><interfaces>4 2 9 1 1
4 1 9 2 1</interfaces></MultiPatch></xml>)");
  ASSERT_EQ(old.Model.Interfaces.size(), 1u);
  EXPECT_EQ(old.Model.Interfaces[0].Values, file.Model.Interfaces[0].Values);
  ASSERT_EQ(old.Warnings.size(), 1u);
  EXPECT_EQ(old.Warnings[0].find("2 interfaces without direction map"), 0u);

  const FileContents repeated = ParseGismoXml(
    "<xml>" + GismoBox("id=\"4\"", 0) + GismoBox("id=\"4\"", 1) + topology + "</xml>");
  EXPECT_EQ(repeated.Model.Patches[0].Id, 0);
  EXPECT_EQ(repeated.Model.Patches[1].Id, 1);
  EXPECT_TRUE(repeated.Model.Interfaces.empty());
  ASSERT_EQ(repeated.Warnings.size(), 1u);
  EXPECT_NE(repeated.Warnings[0].find("ambiguous"), std::string::npos);
}

TEST(Formats, Base64HoldsTheSameNumbers)
{
  // 0 0 1 1 as little-endian doubles.
  const std::string knots = "AAAAAAAAAAAAAAAAAAAAAAAAAAAAAPA/AAAAAAAA8D8=";
  const FileContents file =
    ParseGismoXml(R"(<xml><Geometry type="BSpline"><Basis type="BSplineBasis">
<KnotVector degree="1" format="B64Float64">)" +
      knots + R"(</KnotVector></Basis><coefs format="B64Float64" geoDim="2">)" + knots +
      "</coefs></Geometry></xml>");
  const Spline& curve = file.Model.Patches[0].Body.Geometry();
  EXPECT_EQ(curve.Knots(0).Knots(), (std::vector<double>{ 0, 0, 1, 1 }));
  EXPECT_EQ(curve.Coefficients().col(0), Eigen::Vector2d(0, 0));
  EXPECT_EQ(curve.Coefficients().col(1), Eigen::Vector2d(1, 1));
}

TEST(Formats, AScalarVolumeIsAFieldOverItsParameters)
{
  const FileContents file = ParseGoToolsG2(
    "700 1 0 0 1 0 2 2 0 0 1 1 3 3 2 2 2 5 5 5 2 2 0 0 1 1 1 2 3 4 5 6 7 8 9 10 11 12");
  ASSERT_EQ(file.Model.Patches.size(), 1u);
  const Aggregate& body = file.Model.Patches[0].Body;
  EXPECT_LE((body.Geometry().Evaluate(0.25, 3.5, 0.75) - Eigen::Vector3d(0.25, 3.5, 0.75)).norm(),
    8 * Epsilon);
  const Spline* field = body.FindAttribute("Field");
  ASSERT_NE(field, nullptr);
  EXPECT_EQ(field->Coefficients()(0, 11), 12.0);
  ASSERT_EQ(file.Warnings.size(), 1u);
  EXPECT_NE(file.Warnings[0].find("1 spline with fewer coordinates"), std::string::npos);
}

TEST(Formats, SniffingIsStrict)
{
  EXPECT_EQ(SniffFormat("<xml>"), Format::GismoXml);
  EXPECT_EQ(SniffFormat("\xef\xbb\xbf<!-- a > b --> <?xml version='1.0'?>\n<xml id='1'/>"),
    Format::GismoXml);
  EXPECT_EQ(SniffFormat("<xmlns/>"), Format::Unknown);
  EXPECT_EQ(SniffFormat("<?xml version='1.0'?><VTKFile type='x'>"), Format::Unknown);
  EXPECT_EQ(SniffFormat("<!-- never closed <xml>"), Format::Unknown);
  EXPECT_EQ(SniffFormat("MFEM NURBS mesh v1.0\n"), Format::MfemMesh);
  EXPECT_EQ(SniffFormat("MFEM mesh v1.0\n"), Format::MfemMesh);
  EXPECT_EQ(SniffFormat("\n 700 1 0 0\r\n3 0"), Format::GoToolsG2);
  EXPECT_EQ(SniffFormat("200 1 0 4 1 2 3 4\n"), Format::GoToolsG2);
  EXPECT_EQ(SniffFormat("700 1 0 4 1 2 3\n"), Format::Unknown);
  EXPECT_EQ(SniffFormat("700,1,0,0\n"), Format::Unknown);
  EXPECT_EQ(SniffFormat("701 1 0 0\n"), Format::Unknown);
  EXPECT_EQ(SniffFormat("x,y,z\n1,2,3\n"), Format::Unknown);
  EXPECT_EQ(SniffFormat("# made\n# by hand\n\n[OBJECT A"), Format::IritItd);
  EXPECT_EQ(SniffFormat("[ TRIVAR BSPLINE"), Format::IritItd);
  EXPECT_EQ(SniffFormat("[OBJECTS"), Format::Unknown);
  EXPECT_EQ(SniffFormat("[section]\nkey=1\n"), Format::Unknown);
  EXPECT_EQ(SniffFormat("[1, 2, 3]"), Format::Unknown);
  EXPECT_EQ(SniffFormat("# nurbs mesh v.0.7\n2 1\n"), Format::GeoPdesText);
  EXPECT_EQ(SniffFormat("# x y z\n1 2 3\n"), Format::Unknown);
  EXPECT_EQ(SniffFormat(""), Format::Unknown);
}
