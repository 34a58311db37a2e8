// SPDX-License-Identifier: BSD-3-Clause
#include "Error.h"
#include "Evaluator.h"
#include "Integrals.h"
#include "Interfaces.h"
#include "RealFiles.h"

#include <Eigen/LU>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <sstream>

using namespace hyperpatch;

namespace
{

constexpr double Epsilon = std::numeric_limits<double>::epsilon();

/// The determinant of the Jacobian at an inner grid of points.
std::vector<double> Determinants(const Spline& volume)
{
  const Evaluator evaluator(volume);
  std::vector<double> determinants;
  for (int n = 0; n < 27; ++n)
  {
    double u[3];
    for (int d = 0, rest = n; d < 3; ++d, rest /= 3)
    {
      const KnotVector& k = volume.Knots(d);
      u[d] = k.First() + (k.Last() - k.First()) * (0.1 + 0.4 * (rest % 3));
    }
    double value[3];
    Eigen::Matrix3d jacobian;
    evaluator.EvaluateWithDerivatives(1, u, value, jacobian.data());
    determinants.push_back(jacobian.determinant());
  }
  return determinants;
}

std::string Join(const std::vector<double>& numbers)
{
  std::ostringstream out;
  out.precision(17);
  for (const double number : numbers)
  {
    out << number << ' ';
  }
  return out.str();
}

/// The model as an MFEM mesh in the variant with control points per patch.
std::string WriteMfemPatches(const MultiPatch& model, bool cartesian)
{
  std::ostringstream out;
  out.precision(17);
  out << "MFEM NURBS mesh v1.0\ndimension 3\nelements " << model.Patches.size() << '\n';
  for (std::size_t p = 0; p < model.Patches.size(); ++p)
  {
    out << "1 5";
    for (std::size_t i = 0; i < 8; ++i)
    {
      out << ' ' << 8 * p + i;
    }
    out << '\n';
  }
  out << "boundary 0\nedges 0\nvertices " << 8 * model.Patches.size() << "\npatches\n";
  for (const Patch& patch : model.Patches)
  {
    const Spline& s = patch.Body.Geometry();
    out << "knotvectors 3\n";
    for (const KnotVector& k : s.Knots())
    {
      out << k.Degree() << ' ' << k.Size() << ' ' << Join(k.Knots()) << '\n';
    }
    out << "dimension " << s.Components() << '\n'
        << (cartesian ? "controlpoints_cartesian" : "controlpoints") << '\n';
    for (Eigen::Index i = 0; i < s.NumberOfControlPoints(); ++i)
    {
      const double w = s.IsRational() ? s.Weights()[i] : 1.0;
      for (int d = 0; d < s.Components(); ++d)
      {
        out << s.Coefficients()(d, i) * (cartesian ? 1.0 : w) << ' ';
      }
      out << w << '\n';
    }
  }
  return out.str();
}

void ExpectSameModel(const MultiPatch& a, const MultiPatch& b, double tolerance)
{
  ASSERT_EQ(a.Patches.size(), b.Patches.size());
  for (std::size_t p = 0; p < a.Patches.size(); ++p)
  {
    const Spline& s = a.Patches[p].Body.Geometry();
    const Spline& t = b.Patches[p].Body.Geometry();
    ASSERT_EQ(s.Knots(), t.Knots());
    EXPECT_LE((s.Coefficients() - t.Coefficients()).cwiseAbs().maxCoeff(), tolerance);
    ASSERT_EQ(s.IsRational(), t.IsRational());
    EXPECT_EQ(s.Weights(), t.Weights());
  }
}

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
      const std::vector<double> determinants = Determinants(patch.Body.Geometry());
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

TEST(Formats, PipeOfMfemIsRoundWhereItBeginsAndEnds)
{
  const std::string name = models::RealFile("mfem/pipe-nurbs.mesh");
  if (!std::filesystem::exists(name))
  {
    GTEST_SKIP() << "no shared data";
  }
  const MultiPatch model = ReadSplineFile(name).Model;
  ASSERT_EQ(model.Patches.size(), 4u);
  for (const Patch& patch : model.Patches)
  {
    for (int i = 0; i <= 10; ++i)
    {
      const Eigen::VectorXd begin = patch.Body.Geometry().Evaluate(0.1 * i, 0.3, 0.0);
      const Eigen::VectorXd end = patch.Body.Geometry().Evaluate(0.1 * i, 0.3, 2.0);
      EXPECT_NEAR(std::hypot(begin[0], begin[1]), 2.0 + 0.1 * i, 16 * Epsilon);
      EXPECT_NEAR(begin[2], 0.0, Epsilon);
      EXPECT_NEAR(end[0], 10.0, 32 * Epsilon);
      EXPECT_NEAR(std::hypot(end[1], end[2] - 20.0), 2.0 + 0.1 * i, 128 * Epsilon);
    }
  }
}

TEST(Formats, PatchesOfANonConformingMeshFillTheirBlock)
{
  // 4 x 1 x 4, of one patch of 2 x 3 x 2 elements and 12 patches that hang on it.
  const std::string name = models::RealFile("mfem/nc-nurbs3d.mesh");
  if (!std::filesystem::exists(name))
  {
    GTEST_SKIP() << "no shared data";
  }
  const MultiPatch model = ReadSplineFile(name).Model;
  ASSERT_EQ(model.Patches.size(), 13u);
  EXPECT_EQ(model.Patches[0].Body.Geometry().Sizes(), (std::array<int, 3>{ 3, 4, 3 }));
  double volume = 0.0;
  for (const Patch& patch : model.Patches)
  {
    const Spline& s = patch.Body.Geometry();
    for (const double determinant : Determinants(s))
    {
      EXPECT_GT(determinant, 0.0) << patch.Id;
    }
    volume += integrals::Volume(s);
  }
  // Nodes of the quadrature are good to 1e-13.
  EXPECT_NEAR(volume, 16.0, 1e-11);
  // Every vertex that hangs is the corner of the small patches and a control point of the large
  // one.
  const Spline& large = model.Patches[0].Body.Geometry();
  for (int i = 0; i < 3; ++i)
  {
    for (int j = 0; j < 4; ++j)
    {
      EXPECT_LE(
        (large.Evaluate(0.5 * i, j / 3.0, 0.0) - Eigen::Vector3d(2.0 * i, j / 3.0, 2)).norm(),
        1e-14);
    }
  }
}

namespace
{

/// A block of m x n x 1 spans under m x n patches, every vertex number and direction of the large
/// patch shuffled: control points are their own place.
std::string HangingBlock(std::mt19937& random, int m, int n, std::vector<Eigen::Vector3d>& places)
{
  // Vertices: four corners below, the (m + 1) (n + 1) of the common face, as many above.
  const int layer = (m + 1) * (n + 1);
  std::vector<int> number(static_cast<std::size_t>(4 + 2 * layer));
  std::iota(number.begin(), number.end(), 0);
  std::shuffle(number.begin(), number.end(), random);
  places.assign(number.size(), Eigen::Vector3d::Zero());
  const auto vertex = [&](int i, int j, int k)
  {
    const int at = k == 0 ? (i > 0) + 2 * (j > 0) : 4 + (k - 1) * layer + i + (m + 1) * j;
    const int id = number[static_cast<std::size_t>(at)];
    places[static_cast<std::size_t>(id)] = Eigen::Vector3d(i, j, k);
    return id;
  };
  std::ostringstream out;
  out << "MFEM NURBS NC-patch mesh v1.0 dimension 3 elements " << m * n + 1 << '\n';
  const auto element = [&](int i, int j, int k, int width, int depth)
  {
    // Turned about w and upside down at random.
    std::array<std::array<int, 2>, 4> ring{ { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 1 } } };
    std::rotate(ring.begin(), ring.begin() + static_cast<std::ptrdiff_t>(random() % 4), ring.end());
    const bool flips = random() % 2 == 0;
    if (flips)
    {
      std::reverse(ring.begin(), ring.end());
    }
    out << "0 1 5 0";
    for (int l = 0; l < 2; ++l)
    {
      for (const auto& [a, b] : ring)
      {
        out << ' ' << vertex(i + a * width, j + b * depth, k + (flips ? 1 - l : l));
      }
    }
    out << '\n';
  };
  element(0, 0, 0, m, n);
  for (int j = 0; j < n; ++j)
  {
    for (int i = 0; i < m; ++i)
    {
      element(i, j, 1, 1, 1);
    }
  }
  out << "boundary 0\nvertex_to_knotspan " << layer - 4 << '\n';
  for (int j = 0; j <= n; ++j)
  {
    for (int i = 0; i <= m; ++i)
    {
      if ((i % m != 0) || (j % n != 0))
      {
        out << vertex(i, j, 1) << ' ' << i << ' ' << j << ' ' << vertex(0, 0, 1) << ' '
            << vertex(m, 0, 1) << ' ' << vertex(m, n, 1) << ' ' << vertex(0, n, 1) << '\n';
      }
    }
  }
  out << "coordinates " << number.size() << " 1\n";
  for (std::size_t v = 0; v < number.size(); ++v)
  {
    out << "0 ";
  }
  // Knots 0: along x of the large patch, 1: along y, 2: all others.
  std::vector<std::array<int, 3>> edges;
  for (int k = 0; k < 2; ++k)
  {
    edges.push_back({ 0, vertex(0, 0, k), vertex(m, 0, k) });
    edges.push_back({ 0, vertex(0, n, k), vertex(m, n, k) });
    edges.push_back({ 1, vertex(0, 0, k), vertex(0, n, k) });
    edges.push_back({ 1, vertex(m, 0, k), vertex(m, n, k) });
  }
  for (const int i : { 0, m })
  {
    for (const int j : { 0, n })
    {
      edges.push_back({ 2, vertex(i, j, 0), vertex(i, j, 1) });
    }
  }
  for (int j = 0; j <= n; ++j)
  {
    for (int i = 0; i <= m; ++i)
    {
      edges.push_back({ 2, vertex(i, j, 1), vertex(i, j, 2) });
      for (int k = 1; k <= 2; ++k)
      {
        if (i < m)
        {
          edges.push_back({ 2, vertex(i, j, k), vertex(i + 1, j, k) });
        }
        if (j < n)
        {
          edges.push_back({ 2, vertex(i, j, k), vertex(i, j + 1, k) });
        }
      }
    }
  }
  std::shuffle(edges.begin(), edges.end(), random);
  out << "\nedges " << edges.size() << '\n';
  for (const auto& [knots, a, b] : edges)
  {
    out << knots << ' ' << a << ' ' << b << '\n';
    // Inside the edges below, from the lower vertex to the higher.
    const Eigen::Vector3d from = places[static_cast<std::size_t>(std::min(a, b))];
    const Eigen::Vector3d to = places[static_cast<std::size_t>(std::max(a, b))];
    const int count = knots == 0 ? m : knots == 1 ? n : 1;
    for (int i = 1; i < count && from[2] == 0.0; ++i)
    {
      places.push_back(from + (to - from) * i / count);
    }
  }
  out << "knotvectors 3\n";
  for (const int count : { m, n, 1 })
  {
    out << "1 " << count + 1 << " 0";
    for (int i = 0; i <= count; ++i)
    {
      out << ' ' << i;
    }
    out << ' ' << count << '\n';
  }
  return out.str();
}

}

TEST(Formats, HangingVerticesAreFoundInEveryOrientation)
{
  std::mt19937 random(8);
  for (int round = 0; round < 100; ++round)
  {
    // One row of spans across: no control points inside the faces of the large patch but hanging
    // ones, whose order depends on nothing else.
    const int m = 2 + static_cast<int>(random() % 3);
    const int n = 2 + static_cast<int>(random() % 2);
    std::vector<Eigen::Vector3d> places;
    std::string text = HangingBlock(random, m, n, places);
    // The inside of the face below comes last; where all its points are one, in any order.
    const int inside = (m - 1) * (n - 1);
    std::ostringstream out;
    out << text << "unitweights FiniteElementSpace FiniteElementCollection: NURBS1 VDim: 3 "
        << "Ordering: 1\n";
    for (const Eigen::Vector3d& place : places)
    {
      out << place.transpose() << '\n';
    }
    for (int i = 0; i < inside; ++i)
    {
      out << "0.5 0.5 -1\n";
    }
    FileContents file;
    ASSERT_NO_THROW(file = ParseMfemMesh(out.str())) << out.str();
    ASSERT_EQ(file.Model.Patches.size(), static_cast<std::size_t>(m * n + 1));
    // The face of the large patch that others hang on is plane, with its points in their places.
    const Spline& large = file.Model.Patches[0].Body.Geometry();
    const bool isLast = large.Evaluate(0, 0, 1)[2] > 0.5;
    const KnotVector& ku = large.Knots(0);
    const KnotVector& kv = large.Knots(1);
    const double w = isLast ? 1.0 : 0.0;
    const Eigen::Vector3d origin = large.Evaluate(0, 0, w);
    const Eigen::Vector3d u = (large.Evaluate(ku.Last(), 0, w) - origin) / ku.Last();
    const Eigen::Vector3d v = (large.Evaluate(0, kv.Last(), w) - origin) / kv.Last();
    for (int j = 0; j <= kv.Last(); ++j)
    {
      for (int i = 0; i <= ku.Last(); ++i)
      {
        ASSERT_LE((large.Evaluate(i, j, w) - origin - i * u - j * v).norm(), 1e-14) << out.str();
      }
    }
    for (std::size_t p = 1; p < file.Model.Patches.size(); ++p)
    {
      EXPECT_NEAR(std::abs(Determinants(file.Model.Patches[p].Body.Geometry())[13]), 1.0, 1e-14);
    }
  }
}

TEST(Formats, HangingVerticesThatDoNotFitAreRefused)
{
  // Each time one line of the section is changed; the text ends before the weights, which is
  // another error.
  for (const int change : { 0, 1, 2, 3, 4 })
  {
    std::mt19937 random(9);
    std::vector<Eigen::Vector3d> places;
    const int m = change == 4 ? 3 : 2;
    std::istringstream in(HangingBlock(random, m, 2, places));
    std::ostringstream out;
    for (std::string line; std::getline(in, line);)
    {
      std::istringstream numbers(line);
      std::array<int, 7> n{};
      for (int& number : n)
      {
        numbers >> number;
      }
      const bool isHanging = !numbers.fail() && (numbers >> std::ws).eof();
      const bool isMiddle = isHanging && n[1] == 1 && n[2] == 1;
      const bool isOnEdge = isHanging && n[1] == 1 && n[2] == 0;
      if ((change == 1 || change == 4) && line.find("vertex_to_knotspan") == 0)
      {
        line = change == 1 ? "vertex_to_knotspan 4" : "vertex_to_knotspan 7";
      }
      if ((change == 1 || change == 4) && isMiddle)
      {
        continue; // of one vertex inside the face, none is left: then it has points of its own
      }
      if (change == 2 && isMiddle)
      {
        line = std::to_string(n[5]) + line.substr(line.find(' '));
      }
      if (change == 3 && isOnEdge)
      {
        line.replace(line.find(" 1 0 "), 5, " 0 0 ");
      }
      out << line << '\n';
    }
    std::string message;
    try
    {
      (void)ParseMfemMesh(out.str());
    }
    catch (const Error& error)
    {
      message = error.what();
    }
    const std::array<std::string, 5> expected{ "ends where \"weights\" is expected",
      "ends where \"weights\" is expected", "that place or the vertex is taken",
      "that place or the vertex is taken",
      "has 1 hanging vertices inside where 2 knot spans meet" };
    EXPECT_NE(message.find(expected[static_cast<std::size_t>(change)]), message.npos)
      << change << ": " << message;
  }
}

TEST(Formats, SpacingOfMfemDoesNotChangeTheModel)
{
  if (models::RealFiles("mfem").empty())
  {
    GTEST_SKIP() << "no shared data";
  }
  ExpectSameModel(ReadSplineFile(models::RealFile("mfem/pipe-nurbs-log.mesh")).Model,
    ReadSplineFile(models::RealFile("mfem/pipe-nurbs.mesh")).Model, 0.0);
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

TEST(Formats, BothVariantsOfMfemGiveTheSameModel)
{
  if (models::RealFiles("mfem").empty())
  {
    GTEST_SKIP() << "no shared data";
  }
  for (const std::string name : { "mfem/pipe-nurbs.mesh", "mfem/ijk-hex-nurbs.mesh" })
  {
    const MultiPatch model = ReadSplineFile(models::RealFile(name)).Model;
    // One multiplication and one division by the weight: two roundings of coordinates up to 23.
    ExpectSameModel(model, ParseMfemMesh(WriteMfemPatches(model, false)).Model, 64 * Epsilon);
    ExpectSameModel(model, ParseMfemMesh(WriteMfemPatches(model, true)).Model, 0.0);
  }
}

namespace
{

/// A row of two cubes as an MFEM mesh with one vector of control points. Vertex numbers are
/// shuffled and the cubes turned at random, so that every orientation of edges and faces occurs;
/// control points are equal to their place, so that the spline must be the identity up to a turn.
struct ShuffledCubes
{
  std::ostringstream Text;
  std::array<std::array<int, 8>, 2> Vertices;
  std::array<Eigen::Vector3d, 12> Places;

  static const std::vector<double>& Inner(int axis)
  {
    static const std::vector<double> inner[3] = { { 0.3 }, { 0.2, 0.6 }, { 0.1, 0.4, 0.8 } };
    return inner[axis];
  }

  void Point(const Eigen::Vector3d& p) { this->Points.push_back(p); }

  explicit ShuffledCubes(unsigned seed, bool byVector)
  {
    std::mt19937 random(seed);
    std::array<int, 12> number{};
    std::iota(number.begin(), number.end(), 0);
    std::shuffle(number.begin(), number.end(), random);
    const auto vertexAt = [&](int x, int y, int z)
    { return number[static_cast<std::size_t>(x + 3 * (y + 2 * z))]; };
    for (int z = 0; z < 2; ++z)
    {
      for (int y = 0; y < 2; ++y)
      {
        for (int x = 0; x < 3; ++x)
        {
          this->Places[static_cast<std::size_t>(vertexAt(x, y, z))] = Eigen::Vector3d(x, y, z);
        }
      }
    }
    const int order[8][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 1, 1, 0 }, { 0, 1, 0 }, { 0, 0, 1 },
      { 1, 0, 1 }, { 1, 1, 1 }, { 0, 1, 1 } };
    for (int cube = 0; cube < 2; ++cube)
    {
      int axes[3] = { 0, 1, 2 };
      std::shuffle(axes, axes + 3, random);
      const unsigned flips = static_cast<unsigned>(random() % 8);
      for (std::size_t i = 0; i < 8; ++i)
      {
        int at[3];
        for (int d = 0; d < 3; ++d)
        {
          at[axes[d]] = order[i][d] ^ static_cast<int>(flips >> d & 1);
        }
        this->Vertices[static_cast<std::size_t>(cube)][i] = vertexAt(at[0] + cube, at[1], at[2]);
      }
    }
    std::ostream& out = this->Text;
    out << "MFEM NURBS mesh v1.0\n\n# shuffled\ndimension\n3\nelements\n2\n";
    for (const auto& cube : this->Vertices)
    {
      out << "1 5";
      for (const int v : cube)
      {
        out << ' ' << v;
      }
      out << '\n';
    }
    out << "boundary\n1\n7 3 " << vertexAt(0, 0, 0) << ' ' << vertexAt(0, 1, 0) << ' '
        << vertexAt(0, 1, 1) << ' ' << vertexAt(0, 0, 1) << "\nedges\n";

    // Edges in random order, each from the lower to the higher place: the knots run that way.
    std::vector<std::array<int, 3>> edges;
    for (int a = 0; a < 12; ++a)
    {
      for (int b = 0; b < 12; ++b)
      {
        const Eigen::Vector3d step = this->Place(b) - this->Place(a);
        if (std::abs(step.sum() - 1.0) < 0.5 && std::abs(step.norm() - 1.0) < 0.1)
        {
          edges.push_back({ step[0] > 0.5 ? 0 : step[1] > 0.5 ? 1 : 2, a, b });
        }
      }
    }
    std::shuffle(edges.begin(), edges.end(), random);
    out << edges.size() << '\n';
    for (int v = 0; v < 12; ++v)
    {
      this->Point(this->Place(v));
    }
    for (const auto& [axis, a, b] : edges)
    {
      out << axis << ' ' << a << ' ' << b << '\n';
      std::vector<Eigen::Vector3d> inner;
      for (const double t : Inner(axis))
      {
        inner.push_back(this->Place(a) + t * (this->Place(b) - this->Place(a)));
      }
      if (a > b)
      {
        std::reverse(inner.begin(), inner.end());
      }
      this->Points.insert(this->Points.end(), inner.begin(), inner.end());
    }
    out << "vertices\n12\nknotvectors\n3\n";
    for (int axis = 0; axis < 3; ++axis)
    {
      out << "1 " << Inner(axis).size() + 2 << " 0 0 " << Join(Inner(axis)) << "1 1\n";
    }
    const int faces[6][4] = { { 3, 2, 1, 0 }, { 0, 1, 5, 4 }, { 1, 2, 6, 5 }, { 2, 3, 7, 6 },
      { 3, 0, 4, 7 }, { 4, 5, 6, 7 } };
    std::set<std::set<int>> seen;
    for (const auto& cube : this->Vertices)
    {
      for (const auto& face : faces)
      {
        std::array<int, 4> v{};
        for (std::size_t i = 0; i < 4; ++i)
        {
          v[i] = cube[static_cast<std::size_t>(face[i])];
        }
        if (seen.insert(std::set<int>(v.begin(), v.end())).second)
        {
          this->Tensor(v[0], { v[1], v[3] });
        }
      }
    }
    for (const auto& cube : this->Vertices)
    {
      this->Tensor(cube[0], { cube[1], cube[3], cube[4] });
    }
    out << "weights\n";
    for (std::size_t i = 0; i < this->Points.size(); ++i)
    {
      out << "1\n";
    }
    out.precision(17);
    out << "FiniteElementSpace\nFiniteElementCollection: NURBS1\nVDim: 3\nOrdering: " << byVector
        << "\n\n";
    for (std::size_t i = 0; i < 3 * this->Points.size(); ++i)
    {
      const std::size_t n = this->Points.size();
      out << (byVector ? this->Points[i / 3][static_cast<Eigen::Index>(i % 3)]
                       : this->Points[i % n][static_cast<Eigen::Index>(i / n)])
          << '\n';
    }
  }

  [[nodiscard]] const Eigen::Vector3d& Place(int vertex) const
  {
    return this->Places[static_cast<std::size_t>(vertex)];
  }

private:
  /// Inner points of a face or cube from a vertex towards its neighbours, the first one fastest.
  void Tensor(int origin, const std::vector<int>& neighbours)
  {
    std::vector<std::vector<Eigen::Vector3d>> steps;
    for (const int neighbour : neighbours)
    {
      const Eigen::Vector3d step = this->Place(neighbour) - this->Place(origin);
      int axis = 0;
      step.cwiseAbs().maxCoeff(&axis);
      steps.emplace_back();
      for (double t : Inner(axis))
      {
        steps.back().push_back((step[axis] > 0 ? t : 1.0 - t) * step);
      }
      if (step[axis] < 0)
      {
        std::reverse(steps.back().begin(), steps.back().end());
      }
    }
    steps.resize(3, { Eigen::Vector3d::Zero() });
    for (const Eigen::Vector3d& c : steps[2])
    {
      for (const Eigen::Vector3d& b : steps[1])
      {
        for (const Eigen::Vector3d& a : steps[0])
        {
          this->Point(this->Place(origin) + a + b + c);
        }
      }
    }
  }

  std::vector<Eigen::Vector3d> Points;
};

}

TEST(Formats, MfemNumberingHoldsInEveryOrientation)
{
  for (unsigned seed = 0; seed < 200; ++seed)
  {
    const ShuffledCubes cubes(seed, seed % 2 == 0);
    FileContents file;
    ASSERT_NO_THROW(file = ParseMfemMesh(cubes.Text.str())) << cubes.Text.str();
    ASSERT_EQ(file.Model.Patches.size(), 2u);
    for (std::size_t p = 0; p < 2; ++p)
    {
      const Spline& s = file.Model.Patches[p].Body.Geometry();
      EXPECT_FALSE(s.IsRational());
      const auto& v = cubes.Vertices[p];
      const Eigen::Vector3d origin = cubes.Place(v[0]);
      for (int n = 0; n < 64; ++n)
      {
        const Eigen::Vector3d u(n % 4 / 3.0, n / 4 % 4 / 3.0, n / 16 / 3.0);
        const Eigen::Vector3d expected = origin + u[0] * (cubes.Place(v[1]) - origin) +
          u[1] * (cubes.Place(v[3]) - origin) + u[2] * (cubes.Place(v[4]) - origin);
        ASSERT_LE((s.Evaluate(u[0], u[1], u[2]) - expected).norm(), 32 * Epsilon)
          << "seed " << seed << ", patch " << p;
      }
    }
    ASSERT_EQ(file.Model.Interfaces.size(), 1u);
    EXPECT_LE(models::Gap(file.Model, file.Model.Interfaces[0]), 32 * Epsilon);
    ASSERT_EQ(file.Model.Boundaries.size(), 1u);
    EXPECT_EQ(file.Model.Boundaries[0].Name, "boundary 7");
    ASSERT_EQ(file.Model.Boundaries[0].Sides.size(), 1u);
    EXPECT_EQ(file.Model.Boundaries[0].Sides[0][0], 0);
    EXPECT_TRUE(file.Warnings.empty());
  }
}

TEST(Formats, MfemReadsSurfacesAndCurves)
{
  // A plate of two squares, the second one seen from its other end; x and y only.
  const FileContents plate = ParseMfemMesh(R"(MFEM NURBS mesh v1.0
dimension 2
elements 2
1 3 0 1 2 3
1 3 4 5 1 2
boundary 2
1 1 0 3
9 1 0 5
edges 7
0 0 1
1 1 2
0 3 2
1 0 3
0 1 5
1 5 4
0 2 4
vertices 6
knotvectors 2
1 3 0 0 0.25 1 1
1 2 0 0 1 1
unitweights
FiniteElementSpace
FiniteElementCollection: NURBS
VDim: 2
Ordering: 1
0 0  1 0  1 1  0 1  2 1  2 0
0.25 0  0.25 1  1.25 0  1.25 1)");
  ASSERT_EQ(plate.Model.Patches.size(), 2u);
  for (const double u : { 0.0, 0.2, 0.7, 1.0 })
  {
    for (const double v : { 0.0, 0.4, 1.0 })
    {
      const Spline& first = plate.Model.Patches[0].Body.Geometry();
      const Spline& second = plate.Model.Patches[1].Body.Geometry();
      EXPECT_EQ(first.Dimension(), 2);
      EXPECT_LE((first.Evaluate(u, v) - Eigen::Vector2d(u, v)).norm(), 4 * Epsilon);
      // Vertices 4, 5, 1, 2: u from (2, 1) down, v towards the first square.
      EXPECT_LE((second.Evaluate(u, v) - Eigen::Vector2d(2 - v, 1 - u)).norm(), 8 * Epsilon);
    }
  }
  ASSERT_EQ(plate.Model.Interfaces.size(), 1u);
  EXPECT_EQ(
    plate.Model.Interfaces[0].Values, (std::array<int, 10>{ 0, 2, 1, 4, 1, 0, 2, 0, 0, 1 }));
  ASSERT_EQ(plate.Model.Boundaries.size(), 1u);
  EXPECT_EQ(plate.Model.Boundaries[0].Sides[0], (std::array<int, 2>{ 0, 0 }));
  ASSERT_EQ(plate.Warnings.size(), 1u);
  EXPECT_EQ(plate.Warnings[0], "1 boundary element skipped: not the side of a patch.");

  const FileContents line = ParseMfemMesh(R"(MFEM NURBS mesh v1.0
dimension 1
elements 1
1 1 0 1
boundary 2
1 0 0
2 0 1
edges 1
0 0 1
vertices 2
knotvectors 1
2 4 0 0 0 0.5 1 1 1
weights 1 1 2 2
FiniteElementSpace FiniteElementCollection: NURBS2 VDim: 3 Ordering: 0
0 3 1 2  0 0 1 1  0 0 0 5)");
  const Spline& curve = line.Model.Patches[0].Body.Geometry();
  EXPECT_EQ(curve.Dimension(), 1);
  EXPECT_EQ(curve.Coefficients().col(1), Eigen::Vector3d(1, 1, 0));
  EXPECT_EQ(curve.Coefficients().col(2), Eigen::Vector3d(2, 1, 5));
  EXPECT_EQ(curve.Coefficients().col(3), Eigen::Vector3d(3, 0, 0));
  EXPECT_EQ(curve.Weights(), Eigen::Vector4d(1, 2, 2, 1));
  EXPECT_EQ(line.Model.Boundaries.size(), 2u);
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
