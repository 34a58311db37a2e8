// SPDX-License-Identifier: BSD-3-Clause
#include "JacobianTree.h"

#include "Error.h"
#include "Evaluator.h"
#include "JacobianComplexWorker.h"
#include "JacobianField.h"
#include "JacobianTetrahedra.h"
#include "Operators.h"
#include "Splines/Models.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <limits>
#include <map>
#include <set>

using namespace hyperpatch;

namespace
{

/// FIGURE 10 of the paper: a sheet, here arched over v and straight in u, swept along a line. det J
/// depends on v alone and vanishes where the arch is level: in the middle for
/// skew = 1/2.
Spline SweptArch(double skew)
{
  const double height[4] = { 0.0, 4.0 / 3 * (1.0 - skew), 4.0 / 3 * skew, 0.0 };
  Eigen::MatrixXd points(3, 16);
  for (int i = 0; i < 16; ++i)
  {
    const int u = i % 2;
    const int v = i / 2 % 4;
    const int w = i / 8;
    points.col(i) << v / 3.0 + 2.0 * w, height[v], u + 0.3 * w;
  }
  return Spline(
    { KnotVector::Uniform(1, 2), KnotVector::Uniform(3, 4), KnotVector::Uniform(1, 2) }, points);
}

/// FIGURE 11: four sections of a sheet, turned by 35 degrees in all on their way along a line, and
/// lofted.
Spline TurnedSweep()
{
  Eigen::MatrixXd points(3, 64);
  for (int i = 0; i < 64; ++i)
  {
    const double angle = 35.0 * 3.14159265358979 / 180.0 * (i / 16) / 3.0;
    const double x = (i % 4) / 3.0;
    const double y = (i / 4 % 4) / 3.0;
    const double z = 0.5 * std::sin(2.5 * x) * std::cos(2.0 * y);
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    points.col(i) << x, c * y - s * z, s * y + c * z;
    points.col(i) += i / 16 / 3.0 * Eigen::Vector3d(0.6, 0.4, 0.5);
  }
  const KnotVector k = KnotVector::Uniform(3, 4);
  return Spline({ k, k, k }, points);
}

/// A lattice of several spans that is folded in places.
Spline Folded(unsigned seed, bool rational)
{
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> move(-1.8, 1.8);
  std::uniform_real_distribution<double> weight(0.7, 1.4);
  constexpr int N = 5;
  Eigen::MatrixXd points(3, N * N * N);
  Eigen::VectorXd weights(rational ? N * N * N : 0);
  for (int i = 0; i < N * N * N; ++i)
  {
    points.col(i) << i % N + move(random), i / N % N + move(random), i / N / N + move(random);
    if (rational)
    {
      weights[i] = weight(random);
    }
  }
  const KnotVector k = KnotVector::Uniform(3, N);
  return Spline({ k, k, k }, points, weights);
}

JacobianTreeOptions Options(JacobianBound bound, double width, std::size_t cells)
{
  JacobianTreeOptions options;
  options.Bound = bound;
  options.MinimumWidth = width;
  options.MaximumCells = cells;
  return options;
}

constexpr JacobianBound AllBounds[] = { JacobianBound::Cones, JacobianBound::ConesInThreeOrders,
  JacobianBound::Bernstein };

const JacobianTree::Cell& At(const JacobianTree& tree, int cell)
{
  return tree.Cells()[static_cast<std::size_t>(cell)];
}

bool IsIn(const ParameterBox& box, const std::array<double, 3>& at)
{
  for (std::size_t d = 0; d < 3; ++d)
  {
    if (at[d] < box.Low[d] || at[d] > box.High[d])
    {
      return false;
    }
  }
  return true;
}

}

// The paper: "the algorithm adaptively subdivides the domain space only with planes having constant
// v value. The resulting tree contains only one cell. The algorithm subdivides this cell into 12
// tetrahedra, and represents the isosurface with 14 triangles."
TEST(JacobianTree, OfFigure10IsOneCellOf12TetrahedraAnd14Triangles)
{
  for (const JacobianBound bound : AllBounds)
  {
    // The top is on no cut: every split discards one of the halves.
    const Spline arch = SweptArch(0.1);
    const JacobianTree tree(arch, Options(bound, 0.01, 900));
    ASSERT_EQ(tree.Queue().size(), 1u);
    EXPECT_GT(tree.Steps().size(), 5u);
    for (const JacobianTree::Cell& cell : tree.Cells())
    {
      EXPECT_TRUE(cell.Axis == -1 || cell.Axis == 1);
    }
    for (const CrackRepair repair :
      { CrackRepair::None, CrackRepair::AsPrinted, CrackRepair::Conforming })
    {
      const JacobianTetrahedra mesh = MarchTetrahedra(arch, tree, repair);
      EXPECT_EQ(mesh.Tetrahedra, 12);
      EXPECT_EQ(mesh.Triangles.cols(), 14);
      EXPECT_EQ(mesh.OpenEdges, 0);
    }
    // The same where the cap stops before the first split, with J = 0 at the centre.
    const Spline symmetric = SweptArch(0.5);
    const JacobianTree root(symmetric, Options(bound, 0.0, 1));
    EXPECT_EQ(root.Queue(), std::vector<int>{ 0 });
    const JacobianTetrahedra mesh = MarchTetrahedra(symmetric, root);
    EXPECT_EQ(mesh.Tetrahedra, 12);
    EXPECT_EQ(mesh.Triangles.cols(), 14);
  }
}

TEST(JacobianTree, CoversAllZerosOfTheJacobian)
{
  std::mt19937 random(5);
  std::uniform_real_distribution<double> at(0.0, 1.0);
  for (unsigned seed = 1; seed <= 3; ++seed)
  {
    for (const JacobianBound bound : AllBounds)
    {
      const Spline s = Folded(seed, seed == 2);
      const JacobianTree tree(s, Options(bound, 0.05, 400));
      const JacobianField field(s);
      const auto value = [&field](const std::array<double, 3>& p)
      {
        double f = 0.0;
        field.Evaluate(1, p.data(), &f);
        return f;
      };
      // Zeros on segments between points of different sign, by bisection.
      int zeros = 0;
      for (int run = 0; run < 500; ++run)
      {
        std::array<double, 3> a{ at(random), at(random), at(random) };
        std::array<double, 3> b{ at(random), at(random), at(random) };
        if ((value(a) < 0.0) == (value(b) < 0.0))
        {
          continue;
        }
        ++zeros;
        for (int i = 0; i < 60; ++i)
        {
          std::array<double, 3> m{};
          for (std::size_t d = 0; d < 3; ++d)
          {
            m[d] = 0.5 * (a[d] + b[d]);
          }
          ((value(m) < 0.0) == (value(a) < 0.0) ? a : b) = m;
        }
        ASSERT_TRUE(std::any_of(tree.Queue().begin(), tree.Queue().end(),
          [&](int cell) { return IsIn(At(tree, cell).Box, a); }));
      }
      EXPECT_GT(zeros, 20);
    }
  }
}

TEST(JacobianTree, IsBinaryAndItsLeavesFillTheDomain)
{
  const JacobianTree tree(TurnedSweep(), Options(JacobianBound::Cones, 0.0, 300));
  double volume = 0.0;
  std::set<int> kept(tree.Queue().begin(), tree.Queue().end());
  for (int i = 0; i < static_cast<int>(tree.Cells().size()); ++i)
  {
    const JacobianTree::Cell& cell = At(tree, i);
    if (cell.Axis < 0)
    {
      volume += (cell.Box.High[0] - cell.Box.Low[0]) * (cell.Box.High[1] - cell.Box.Low[1]) *
        (cell.Box.High[2] - cell.Box.Low[2]);
      EXPECT_EQ(cell.Discarded, kept.count(i) == 0);
      continue;
    }
    const JacobianTree::Cell& low = At(tree, cell.Children[0]);
    const JacobianTree::Cell& high = At(tree, cell.Children[1]);
    const auto a = static_cast<std::size_t>(cell.Axis);
    EXPECT_EQ(low.Parent, i);
    EXPECT_EQ(high.Parent, i);
    EXPECT_EQ(low.Box.High[a], high.Box.Low[a]);
    EXPECT_EQ(low.Box.High[a], 0.5 * (cell.Box.Low[a] + cell.Box.High[a]));
  }
  EXPECT_EQ(volume, 1.0);
}

TEST(JacobianTree, WidestIntervalsShrinkMonotonicallyToTheirMinimumOrTheCap)
{
  for (const JacobianBound bound : AllBounds)
  {
    const JacobianTree capped(TurnedSweep(), Options(bound, 0.0, 500));
    // A split of one cell adds no more than one.
    EXPECT_EQ(capped.Queue().size(), 500u);
    EXPECT_EQ(capped.Steps().back().Cells, 500u);
    for (std::size_t i = 1; i < capped.Steps().size(); ++i)
    {
      ASSERT_LE(capped.Steps()[i].Width, capped.Steps()[i - 1].Width);
    }
    const JacobianTree fine(TurnedSweep(), Options(bound, 0.5, 1000000));
    EXPECT_LT(fine.Steps().back().Width, 0.5);
    for (const int cell : fine.Queue())
    {
      EXPECT_LT(At(fine, cell).Bound.High - At(fine, cell).Bound.Low, 0.5);
    }
  }
}

TEST(JacobianTree, IsEmptyWhereTheVolumeDoesNotFold)
{
  for (const JacobianBound bound : AllBounds)
  {
    const JacobianTree tree(models::QuarterTube(), Options(bound, 0.0, 10000));
    EXPECT_TRUE(tree.Queue().empty());
    EXPECT_EQ(tree.Steps().back().Cells, 0u);
    EXPECT_EQ(MarchTetrahedra(models::QuarterTube(), tree).Triangles.cols(), 0);
  }
}

TEST(JacobianTree, KeepsDegenerateEdges)
{
  Spline tube = models::QuarterTube();
  Eigen::MatrixXd points = tube.Coefficients();
  for (Eigen::Index i = 0; i < points.cols(); i += 2)
  {
    points.col(i).head(2).setZero(); // the axis: J = 0 at u = 0 and nowhere else
  }
  const Spline cake(tube.Knots(), points, tube.Weights());
  for (const JacobianBound bound : AllBounds)
  {
    const JacobianTree tree(cake, Options(bound, 0.0, 64));
    ASSERT_FALSE(tree.Queue().empty());
    double covered = 0.0;
    for (const int cell : tree.Queue())
    {
      const ParameterBox& box = At(tree, cell).Box;
      covered += box.Low[0] == 0.0 ? (box.High[1] - box.Low[1]) * (box.High[2] - box.Low[2]) : 0.0;
    }
    EXPECT_EQ(covered, 1.0);
  }
}

TEST(JacobianTree, OfFigure1EnclosesTheRectangle)
{
  const Spline s = models::SweptHalfCylinder();
  for (const JacobianBound bound : AllBounds)
  {
    const JacobianTree tree(s, Options(bound, 0.0, 1000));
    ASSERT_FALSE(tree.Queue().empty());
    const JacobianTetrahedra mesh = MarchTetrahedra(s, tree);
    ASSERT_GT(mesh.Triangles.cols(), 0);
    EXPECT_EQ(mesh.OpenEdges, 0);
    // The plane u = 1/2 is one of cuts, where J is 0 to rounding.
    EXPECT_LT((mesh.Points.row(1).array() - 1.0).abs().maxCoeff(), 1e-3);
    double area = 0.0;
    for (Eigen::Index t = 0; t < mesh.Triangles.cols(); ++t)
    {
      const Eigen::Vector3d a = mesh.Points.col(mesh.Triangles(0, t));
      area += 0.5 *
        (mesh.Points.col(mesh.Triangles(1, t)) - a)
          .cross(mesh.Points.col(mesh.Triangles(2, t)) - a)
          .norm();
    }
    EXPECT_NEAR(area, 3.0, 0.01);
  }
}

TEST(JacobianTetrahedra, HaveCracksOnlyWithoutRepair)
{
  const Spline s = TurnedSweep();
  const JacobianTree tree(s, Options(JacobianBound::Cones, 0.0, 900));
  ASSERT_EQ(tree.Queue().size(), 900u);
  const JacobianTetrahedra none = MarchTetrahedra(s, tree, CrackRepair::None);
  const JacobianTetrahedra printed = MarchTetrahedra(s, tree, CrackRepair::AsPrinted);
  const JacobianTetrahedra conforming = MarchTetrahedra(s, tree, CrackRepair::Conforming);
  EXPECT_EQ(none.Tetrahedra, 12 * 900);
  EXPECT_EQ(none.RepairedCells, 0);
  EXPECT_GT(none.OpenEdges, 20);
  EXPECT_GT(printed.RepairedCells, 0);
  EXPECT_GT(printed.Tetrahedra, none.Tetrahedra);
  EXPECT_GE(conforming.RepairedCells, printed.RepairedCells);
  EXPECT_EQ(conforming.OpenEdges, 0);
  for (const unsigned seed : { 1u, 2u, 3u })
  {
    const Spline folded = Folded(seed, seed == 2);
    for (const JacobianBound bound : AllBounds)
    {
      const JacobianTree wild(folded, Options(bound, 0.0, 400));
      EXPECT_EQ(MarchTetrahedra(folded, wild).OpenEdges, 0) << seed;
    }
  }
}

// FIGURE 9: a half of a larger face is split into three triangles, so that the smaller cell has one
// tetrahedron more.
TEST(JacobianTetrahedra, SplitHalfAFaceInThreeAsPrinted)
{
  const Spline s = TurnedSweep();
  int trees = 0;
  for (std::size_t cells = 2; cells < 40; ++cells)
  {
    const JacobianTree tree(s, Options(JacobianBound::Cones, 0.0, cells));
    std::int64_t expected = 0;
    bool isSimple = true;
    // Abutting faces, from the boxes alone.
    for (const int c : tree.Queue())
    {
      const ParameterBox& own = At(tree, c).Box;
      expected += 12;
      for (const int n : tree.Queue())
      {
        const ParameterBox& other = At(tree, n).Box;
        for (std::size_t a = 0; a < 3; ++a)
        {
          const std::size_t b = (a + 1) % 3;
          const std::size_t d = (a + 2) % 3;
          const bool touch = own.High[a] == other.Low[a] || own.Low[a] == other.High[a];
          const bool inside = other.Low[b] <= own.Low[b] && own.High[b] <= other.High[b] &&
            other.Low[d] <= own.Low[d] && own.High[d] <= other.High[d];
          const double share = (own.High[b] - own.Low[b]) * (own.High[d] - own.Low[d]) /
            ((other.High[b] - other.Low[b]) * (other.High[d] - other.Low[d]));
          expected += touch && inside && share == 0.5 ? 1 : 0;
          // Smaller parts may or may not meet the diagonal.
          isSimple = isSimple && (!touch || !inside || share >= 0.5);
        }
      }
    }
    if (isSimple && expected > 12 * static_cast<std::int64_t>(cells))
    {
      ++trees;
      EXPECT_EQ(MarchTetrahedra(s, tree, CrackRepair::AsPrinted).Tetrahedra, expected) << cells;
    }
  }
  EXPECT_GT(trees, 3);
}

TEST(JacobianTetrahedra, AsPrintedMoveCornersWithinLargerFaces)
{
  const JacobianTree tree(TurnedSweep(), Options(JacobianBound::Cones, 0.0, 300));
  const JacobianComplex complex = MakeComplex(tree, CrackRepair::AsPrinted);
  ASSERT_GT(complex.Interpolated.size(), 20u);
  for (const JacobianComplex::Hanging& hanging : complex.Interpolated)
  {
    // The weights are the barycentric coordinates in the parameter domain.
    std::array<double, 3> at{};
    for (std::size_t i = 0; i < 3; ++i)
    {
      EXPECT_GE(hanging.Weights[i], 0.0);
      const auto& corner = complex.Parameters[static_cast<std::size_t>(hanging.From[i])];
      for (std::size_t d = 0; d < 3; ++d)
      {
        at[d] += hanging.Weights[i] * corner[d];
      }
    }
    const auto& expected = complex.Parameters[static_cast<std::size_t>(hanging.Vertex)];
    for (std::size_t d = 0; d < 3; ++d)
    {
      EXPECT_NEAR(at[d], expected[d], 1e-15);
    }
  }
}

TEST(JacobianTree, OfRationalCellsDiscardsNoZero)
{
  // Few splits of volumes with wild weights, which a bound that forgets the weights gets wrong.
  std::mt19937 random(9);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  int empty = 0;
  for (int run = 0; run < 6000; ++run)
  {
    const double noise = 0.05 + 0.05 * (run % 6);
    const double spread = 0.1 + 0.3 * (run % 5);
    const auto move = [&] { return noise * unit(random); };
    Eigen::MatrixXd points(3, 8);
    Eigen::VectorXd weights(8);
    for (int i = 0; i < 8; ++i)
    {
      points.col(i) << i % 2 + move(), i / 2 % 2 + move(), i / 4 + move();
      weights[i] = std::exp(spread * unit(random));
    }
    const KnotVector k = KnotVector::Uniform(1, 2);
    const Spline s({ k, k, k }, points, weights);
    const JacobianTree tree(s, Options(JacobianBound::ConesInThreeOrders, 0.0, 2));
    if (!tree.Queue().empty())
    {
      continue;
    }
    ++empty;
    const JacobianField field(s);
    for (int i = 0; i < 125; ++i)
    {
      const std::array<double, 3> at{ i % 5 / 4.0, i / 5 % 5 / 4.0, i / 25 / 4.0 };
      double value = 0.0;
      field.Evaluate(1, at.data(), &value);
      ASSERT_GT(value, 0.0) << "run " << run;
    }
  }
  EXPECT_GT(empty, 20);
}

TEST(JacobianTetrahedra, TurnTowardsGrowingJ)
{
  const Spline s = Folded(1, false);
  const JacobianTree tree(s, Options(JacobianBound::Bernstein, 0.0, 2000));
  const JacobianTetrahedra mesh = MarchTetrahedra(s, tree);
  const JacobianField field(s);
  double agree = 0.0;
  double all = 0.0;
  for (Eigen::Index t = 0; t < mesh.Triangles.cols(); ++t)
  {
    const Eigen::Vector3d a = mesh.Parameters.col(mesh.Triangles(0, t));
    const Eigen::Vector3d b = mesh.Parameters.col(mesh.Triangles(1, t));
    const Eigen::Vector3d c = mesh.Parameters.col(mesh.Triangles(2, t));
    const Eigen::Vector3d normal = (b - a).cross(c - a);
    const Eigen::Vector3d centre = (a + b + c) / 3.0;
    double value = 0.0;
    Eigen::Vector3d gradient;
    field.EvaluateWithGradient(1, centre.data(), &value, gradient.data());
    all += normal.norm();
    agree += normal.dot(gradient) > 0.0 ? normal.norm() : 0.0;
  }
  // But for slivers of the linear interpolant.
  EXPECT_GT(agree, 0.98 * all);
}

TEST(JacobianTree, RefusesWhatIsNoVolumeAndWidthsThatAreNone)
{
  Eigen::MatrixXd line(3, 2);
  line << 0, 1, 0, 0, 0, 0;
  const Spline curve({ KnotVector::Uniform(1, 2), KnotVector(), KnotVector() }, line);
  EXPECT_THROW(JacobianTree{ curve }, Error);
  EXPECT_THROW(JacobianTree(TurnedSweep(), Options(JacobianBound::Cones, -1.0, 10)), Error);
  EXPECT_THROW(JacobianTree(TurnedSweep(),
                 Options(JacobianBound::Cones, std::numeric_limits<double>::quiet_NaN(), 10)),
    Error);
}

TEST(JacobianTree, StopsWhenToldTo)
{
  JacobianTreeOptions options = Options(JacobianBound::Cones, 0.0, 1000);
  options.Abort = [](std::size_t cells) { return cells >= 10; };
  EXPECT_LE(JacobianTree(TurnedSweep(), options).Queue().size(), 11u);
}
