// SPDX-License-Identifier: BSD-3-Clause
#include "Interfaces.h"
#include "RealFiles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <set>
#include <sstream>

using namespace hyperpatch;

namespace
{

constexpr double Epsilon = std::numeric_limits<double>::epsilon();

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

}

TEST(Mfem, PipeOfMfemIsRoundWhereItBeginsAndEnds)
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

TEST(Mfem, SpacingOfMfemDoesNotChangeTheModel)
{
  if (models::RealFiles("mfem").empty())
  {
    GTEST_SKIP() << "no shared data";
  }
  ExpectSameModel(ReadSplineFile(models::RealFile("mfem/pipe-nurbs-log.mesh")).Model,
    ReadSplineFile(models::RealFile("mfem/pipe-nurbs.mesh")).Model, 0.0);
}

TEST(Mfem, BothVariantsOfMfemGiveTheSameModel)
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

TEST(Mfem, MfemNumberingHoldsInEveryOrientation)
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

TEST(Mfem, MfemReadsSurfacesAndCurves)
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
