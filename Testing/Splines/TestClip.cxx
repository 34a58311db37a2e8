// SPDX-License-Identifier: BSD-3-Clause
#include "Clip.h"
#include "Error.h"
#include "ParameterField.h"
#include "QuadricField.h"
#include "SampledField.h"
#include "SimplexCutWorker.h"
#include "Splines/Models.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <random>
#include <thread>

using namespace hyperpatch;

namespace
{

constexpr double Pi = 3.14159265358979323846;

using Fields = std::vector<std::shared_ptr<const ScalarField>>;

Quadric Plane(const Eigen::Vector3d& normal, double offset)
{
  return { Eigen::MatrixXd(), normal, -offset, Eigen::VectorXd() };
}

Quadric Sphere(const Eigen::Vector3d& centre, double radius)
{
  return { Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero(), -radius * radius, centre };
}

/// The box between two corners, of one element of degree 1.
Spline Box(const Eigen::Vector3d& low, const Eigen::Vector3d& high)
{
  const KnotVector line = KnotVector::Uniform(1, 2);
  Eigen::MatrixXd points(3, 8);
  for (int c = 0; c < 8; ++c)
  {
    points.col(c) << (c & 1 ? high : low)[0], (c & 2 ? high : low)[1], (c & 4 ? high : low)[2];
  }
  return Spline({ line, line, line }, points);
}

/// A patch and what is cut from it.
struct Model
{
  Patch Body;
  std::shared_ptr<const PreparedAggregate> Prepared;

  explicit Model(const Spline& geometry, std::vector<Attribute> attributes = {})
    : Body{ 0, Aggregate(geometry, std::move(attributes)) }
    , Prepared(std::make_shared<const PreparedAggregate>(this->Body.Body))
  {
  }
  Model(const Model&) = delete;

  [[nodiscard]] Fields Quadrics(const std::vector<Quadric>& quadrics) const
  {
    Fields fields;
    for (const Quadric& q : quadrics)
    {
      fields.push_back(std::make_shared<QuadricField>(this->Prepared->Geometry(), q, true));
    }
    return fields;
  }
  [[nodiscard]] ClipMesh Clipped(const Fields& fields, const ClipOptions& options = {}) const
  {
    return Clip(this->Body, this->Prepared, fields, options);
  }
};

/// Volume, area or length of a cell, signed in a volume.
double Size(const ClipMesh& mesh, Eigen::Index cell)
{
  const auto n = mesh.Cells.rows();
  const auto point = [&](Eigen::Index i) -> Eigen::Vector3d
  { return mesh.Points.col(mesh.Cells(i, cell)); };
  if (n == 2)
  {
    return (point(1) - point(0)).norm();
  }
  const Eigen::Vector3d normal = (point(1) - point(0)).cross(point(2) - point(0));
  return n == 3 ? 0.5 * normal.norm() : normal.dot(point(3) - point(0)) / 6.0;
}

double Total(const ClipMesh& mesh)
{
  double sum = 0.0;
  for (Eigen::Index c = 0; c < mesh.Cells.cols(); ++c)
  {
    sum += Size(mesh, c);
  }
  return sum;
}

/// Facets of one cell alone, as points.
std::vector<std::vector<std::int64_t>> OpenFacets(const ClipMesh& mesh)
{
  std::map<std::vector<std::int64_t>, int> cellsOf;
  for (Eigen::Index c = 0; c < mesh.Cells.cols(); ++c)
  {
    for (Eigen::Index left = 0; left < mesh.Cells.rows(); ++left)
    {
      std::vector<std::int64_t> facet;
      for (Eigen::Index i = 0; i < mesh.Cells.rows(); ++i)
      {
        if (i != left)
        {
          facet.push_back(mesh.Cells(i, c));
        }
      }
      std::sort(facet.begin(), facet.end());
      ++cellsOf[facet];
    }
  }
  std::vector<std::vector<std::int64_t>> open;
  for (const auto& [facet, cells] : cellsOf)
  {
    EXPECT_LE(cells, 2);
    if (cells == 1)
    {
      open.push_back(facet);
    }
  }
  return open;
}

/// Cells have positive volume, and facets of one cell lie in the sides of the patch or where a
/// field is 0: no face hangs on another, no point inside another's face or edge.
void ExpectConforming(const Model& model, const ClipMesh& mesh, const Fields& fields)
{
  ASSERT_GT(mesh.Cells.cols(), 0);
  for (Eigen::Index c = 0; c < mesh.Cells.cols(); ++c)
  {
    EXPECT_GT(Size(mesh, c), 0.0);
  }
  for (const auto& facet : OpenFacets(mesh))
  {
    bool lies = false;
    for (int d = 0; d < 3; ++d)
    {
      const KnotVector& knots = model.Body.Body.Geometry().Knots(d);
      for (const double end : { knots.First(), knots.Last() })
      {
        lies = lies ||
          (knots.Degree() > 0 &&
            std::all_of(facet.begin(), facet.end(),
              [&](std::int64_t i) { return mesh.Parameters(d, i) == end; }));
      }
    }
    for (const auto& field : fields)
    {
      lies = lies ||
        std::all_of(facet.begin(), facet.end(),
          [&](std::int64_t i)
          {
            double value = 0.0;
            field->Evaluate(1, mesh.Parameters.col(i).data(), &value);
            return std::abs(value) < 1e-12;
          });
    }
    EXPECT_TRUE(lies);
  }
}

}

TEST(Clip, AnObliquePlaneCutsABoxExactly)
{
  const Model model(Box({ 0, 0, 0 }, { 1, 2, 3 }));
  // x + y + z <= 1 leaves a corner of volume 1/6, whichever side is turned in.
  const Fields fields = model.Quadrics({ Plane({ 1, 1, 1 }, 1.0) });
  ClipOptions options;
  const ClipMesh inside = model.Clipped(fields, options);
  options.KeepInside = false;
  const ClipMesh outside = model.Clipped(fields, options);
  EXPECT_NEAR(Total(inside), 1.0 / 6.0, 1e-14);
  EXPECT_NEAR(Total(outside), 6.0 - 1.0 / 6.0, 1e-13);
  for (const ClipMesh* mesh : { &inside, &outside })
  {
    ExpectConforming(model, *mesh, fields);
    EXPECT_TRUE(mesh->Certificate.ToleranceReached);
    EXPECT_EQ(mesh->Certificate.UndecidedCells, 0);
    EXPECT_LE(mesh->Certificate.LargestResidual, 1e-14);
    EXPECT_LE(mesh->Certificate.LargestError, 1e-14);
  }
}

TEST(Clip, SpheresInACurvedVolumeConvergeToTheirVolume)
{
  // A ball inside the quarter tube, and what it leaves of it.
  const Model model(models::QuarterTube());
  const Eigen::Vector3d centre = model.Body.Body.Geometry().Evaluate(0.5, 0.5, 0.5).head<3>();
  const double radius = 0.3;
  const Fields fields = model.Quadrics({ Sphere(centre, radius) });
  double last = INFINITY;
  for (const double tolerance : { 1e-2, 1e-3 })
  {
    ClipOptions options;
    options.Tolerance = tolerance;
    const ClipMesh ball = model.Clipped(fields, options);
    ExpectConforming(model, ball, fields);
    EXPECT_TRUE(ball.Certificate.ToleranceReached);
    EXPECT_EQ(ball.Certificate.UndecidedCells, 0);
    const double error = std::abs(Total(ball) - 4.0 / 3.0 * Pi * std::pow(radius, 3));
    EXPECT_LE(error, tolerance * 4.0 * Pi * radius * radius);
    EXPECT_LT(error, last);
    last = error;
  }
}

TEST(Clip, APlaneHalvesAQuarterTube)
{
  const Model model(models::QuarterTube());
  // The plane x = y, through the axis.
  const Fields fields = model.Quadrics({ Plane({ 1, -1, 0 }, 0.0) });
  for (const double tolerance : { 1e-2, 3e-3, 1e-3 })
  {
    ClipOptions options;
    options.Tolerance = tolerance;
    const ClipMesh a = model.Clipped(fields, options);
    options.KeepInside = false;
    const ClipMesh b = model.Clipped(fields, options);
    ExpectConforming(model, a, fields);
    const Eigen::AlignedBox3d bounds(
      model.Body.Body.Geometry().Coefficients().rowwise().minCoeff().head<3>(),
      model.Body.Body.Geometry().Coefficients().rowwise().maxCoeff().head<3>());
    EXPECT_NEAR(Total(a), Total(b), 4.0 * tolerance * bounds.volume());
    for (Eigen::Index i = 0; i < a.Points.cols(); ++i)
    {
      EXPECT_LE(a.Points(0, i) - a.Points(1, i), 1e-14);
    }
  }
}

TEST(Clip, BoxesAndWhatTheyLeaveFillTheModel)
{
  const Model model(Box({ 0, 0, 0 }, { 1, 1, 1 }));
  const Eigen::Matrix3d turn =
    Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  const Eigen::Vector3d centre(0.45, 0.5, 0.55);
  const Eigen::Vector3d half(0.2, 0.25, 0.15);
  std::vector<Quadric> sides;
  for (int d = 0; d < 3; ++d)
  {
    for (const double sign : { 1.0, -1.0 })
    {
      const Eigen::Vector3d normal = sign * turn.col(d);
      sides.push_back(Plane(normal, normal.dot(centre) + half[d]));
    }
  }
  const Fields fields = model.Quadrics(sides);
  ClipOptions options;
  const ClipMesh inside = model.Clipped(fields, options);
  options.KeepInside = false;
  const ClipMesh outside = model.Clipped(fields, options);
  EXPECT_NEAR(Total(inside), 8.0 * half.prod(), 1e-14);
  EXPECT_NEAR(Total(inside) + Total(outside), 1.0, 1e-13);
  ExpectConforming(model, inside, fields);
  ExpectConforming(model, outside, fields);
}

TEST(Clip, SurfacesGiveTrianglesAndCurvesSegments)
{
  const KnotVector line = KnotVector::Uniform(1, 2);
  Eigen::MatrixXd square(3, 4);
  square << 0, 1, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0;
  const Model surface(Spline({ line, line, {} }, square));
  ClipOptions options;
  options.Tolerance = 1e-4;
  const ClipMesh disk =
    surface.Clipped(surface.Quadrics({ Sphere({ 0.5, 0.5, 0.0 }, 0.3) }), options);
  ASSERT_EQ(disk.Cells.rows(), 3);
  EXPECT_NEAR(Total(disk), Pi * 0.09, 1e-4 * 2.0 * Pi * 0.3);
  EXPECT_LE(disk.Certificate.LargestError, 1e-4);

  Eigen::MatrixXd ends(3, 2);
  ends << 0, 2, 0, 0, 0, 0;
  const Model curve(Spline({ line, {}, {} }, ends));
  const ClipMesh part = curve.Clipped(curve.Quadrics({ Plane({ 1, 0, 0 }, 0.7) }));
  ASSERT_EQ(part.Cells.rows(), 2);
  EXPECT_NEAR(Total(part), 0.7, 1e-15);
}

TEST(Clip, ZerosInFacesAndKnotPlanesLeaveWholeElements)
{
  const KnotVector knots(1, { 0, 0, 0.5, 1, 1 });
  const KnotVector line = KnotVector::Uniform(1, 2);
  Eigen::MatrixXd points(3, 12);
  for (int c = 0; c < 12; ++c)
  {
    points.col(c) << 0.5 * (c % 3), c / 3 % 2, c / 6;
  }
  const Model model(Spline({ knots, line, line }, points));
  for (const double at : { 0.0, 0.5, 1.0 })
  {
    const Fields fields = model.Quadrics({ Plane({ 1, 0, 0 }, at) });
    ClipOptions options;
    const ClipMesh inside = model.Clipped(fields, options);
    options.KeepInside = false;
    const ClipMesh outside = model.Clipped(fields, options);
    EXPECT_NEAR(Total(inside), at, 1e-14);
    EXPECT_NEAR(Total(outside), 1.0 - at, 1e-14);
    EXPECT_EQ(inside.Certificate.UndecidedCells, 0);
  }
}

TEST(Clip, APointEndsInBoundedTimeAndIsUndecided)
{
  const Model model(models::QuarterTube());
  ClipOptions options;
  options.Tolerance = 1e-2;
  const Fields fields = model.Quadrics({ Sphere({ 1.1, 1.0, 0.4 }, 0.0) });
  const ClipMesh inside = model.Clipped(fields, options);
  EXPECT_EQ(inside.Cells.cols(), 0);
  EXPECT_GT(inside.Certificate.UndecidedCells, 0);
  EXPECT_LT(inside.Certificate.UndecidedCells, 1000);
  EXPECT_TRUE(inside.Certificate.ToleranceReached);
  options.KeepInside = false;
  EXPECT_NEAR(Total(model.Clipped(fields, options)), 3.0 * Pi / 4.0, 5e-2);
}

TEST(Clip, LeftHandedPatchesHavePositiveCells)
{
  const Spline tube = models::QuarterTube();
  Eigen::MatrixXd mirrored = tube.Coefficients();
  mirrored.row(2) *= -1.0;
  const Model model(Spline(tube.Knots(), mirrored, tube.Weights()));
  ClipOptions options;
  options.Handedness = -1;
  const Fields fields = model.Quadrics({ Plane({ 1, 0, 0.5 }, 0.8) });
  ExpectConforming(model, model.Clipped(fields, options), fields);
}

TEST(Clip, InterpolationKeepsToTheTolerances)
{
  std::mt19937 random(3);
  std::exponential_distribution<double> share;
  const KnotVector k = KnotVector::Uniform(3, 6);
  const KnotVector l = KnotVector::Uniform(2, 4);
  const Spline attribute = models::RandomSpline(random, { l, k, l }, 2, false);
  const Model model(models::QuarterTube(), { { "Field", attribute } });
  const auto field = std::make_shared<QuadricField>(
    model.Prepared->Attributes()[0], ComponentEquals(attribute, 1, 0.1), false);
  ClipOptions options;
  options.Tolerance = 5e-3;
  options.AttributeTolerances = { 0.05 };
  const ClipMesh mesh = model.Clipped({ field }, options);
  ExpectConforming(model, mesh, { field });
  EXPECT_TRUE(mesh.Certificate.ToleranceReached);
  const Evaluator& geometry = model.Prepared->Geometry()->Evaluator();
  const Evaluator& values = model.Prepared->Attributes()[0]->Evaluator();
  double worst = 0.0;
  double worstValue = 0.0;
  for (Eigen::Index c = 0; c < mesh.Cells.cols(); ++c)
  {
    for (int sample = 0; sample < 4; ++sample)
    {
      Eigen::Vector4d weights(share(random), share(random), share(random), share(random));
      weights /= weights.sum();
      Eigen::Vector3d u = Eigen::Vector3d::Zero();
      Eigen::Vector3d x = Eigen::Vector3d::Zero();
      Eigen::Vector2d value = Eigen::Vector2d::Zero();
      for (int i = 0; i < 4; ++i)
      {
        u += weights[i] * mesh.Parameters.col(mesh.Cells(i, c));
        x += weights[i] * mesh.Points.col(mesh.Cells(i, c));
        value += weights[i] * mesh.Attributes[0].col(mesh.Cells(i, c));
      }
      Eigen::Vector3d exact;
      Eigen::Vector2d exactValue;
      geometry.Evaluate(1, u.data(), exact.data());
      values.Evaluate(1, u.data(), exactValue.data());
      worst = std::max(worst, (x - exact).norm());
      worstValue = std::max(worstValue, (value - exactValue).cwiseAbs().maxCoeff());
    }
  }
  EXPECT_LE(worst, options.Tolerance);
  EXPECT_LE(worstValue, options.AttributeTolerances[0]);
}

TEST(Clip, TheCutAndTheOuterBoundaryAreWithinTheTolerance)
{
  // All of the boundary is known in closed form: cylinders of radii 1 and 2, planes and the sphere.
  const Model model(models::QuarterTube());
  const Eigen::Vector3d centre(1.1, 1.0, 0.4);
  const double radius = 0.5;
  const Fields fields = model.Quadrics({ Sphere(centre, radius) });
  for (const bool inside : { true, false })
  {
    for (const double tolerance : { 2e-2, 2e-3 })
    {
      ClipOptions options;
      options.Tolerance = tolerance;
      options.KeepInside = inside;
      const ClipMesh mesh = model.Clipped(fields, options);
      ExpectConforming(model, mesh, fields);
      EXPECT_TRUE(mesh.Certificate.ToleranceReached);
      double worst = 0.0;
      int onTheCut = 0;
      for (const auto& facet : OpenFacets(mesh))
      {
        const auto liesIn = [&](int d, double end)
        {
          return std::all_of(facet.begin(), facet.end(),
            [&](std::int64_t i) { return mesh.Parameters(d, i) == end; });
        };
        const auto distance = [&](const Eigen::Vector3d& x)
        {
          const double r = x.head<2>().norm();
          return liesIn(0, 0.0) ? r - 1.0
            : liesIn(0, 1.0)    ? r - 2.0
            : liesIn(1, 0.0)    ? x[1]
            : liesIn(1, 1.0)    ? x[0]
            : liesIn(2, 0.0)    ? x[2]
            : liesIn(2, 1.0)    ? x[2] - 1.0
                                : (x - centre).norm() - radius;
        };
        onTheCut += liesIn(0, 0.0) || liesIn(0, 1.0) || liesIn(1, 0.0) || liesIn(1, 1.0) ||
            liesIn(2, 0.0) || liesIn(2, 1.0)
          ? 0
          : 1;
        for (int i = 0; i <= 6; ++i)
        {
          for (int j = 0; i + j <= 6; ++j)
          {
            const Eigen::Vector3d x =
              (i * mesh.Points.col(facet[0]) + j * mesh.Points.col(facet[1]) +
                (6 - i - j) * mesh.Points.col(facet[2])) /
              6.0;
            worst = std::max(worst, std::abs(distance(x)));
          }
        }
      }
      EXPECT_GT(onTheCut, 10);
      EXPECT_LE(worst, tolerance);
    }
  }
}

TEST(Clip, ThreadsDoNotChangeTheResult)
{
  const Model model(models::QuarterTube());
  const Fields fields = model.Quadrics({ Sphere({ 1.0, 1.0, 0.5 }, 0.6) });
  ClipOptions options;
  options.Tolerance = 5e-3;
  const ClipMesh one = model.Clipped(fields, options);
  options.For = [](std::ptrdiff_t count, std::ptrdiff_t grain,
                  const std::function<void(std::ptrdiff_t, std::ptrdiff_t)>& body)
  {
    std::atomic<std::ptrdiff_t> next{ 0 };
    const auto work = [&]
    {
      for (std::ptrdiff_t begin = next.fetch_add(grain); begin < count;
           begin = next.fetch_add(grain))
      {
        body(begin, std::min(count, begin + grain));
      }
    };
    std::thread other(work);
    work();
    other.join();
  };
  const ClipMesh two = model.Clipped(fields, options);
  EXPECT_EQ(one.Points, two.Points);
  EXPECT_EQ(one.Cells, two.Cells);
  EXPECT_EQ(one.Certificate.LargestError, two.Certificate.LargestError);
}

TEST(Clip, AbortStopsTheWork)
{
  const Model model(models::QuarterTube());
  ClipOptions options;
  int asked = 0;
  options.Abort = [&asked] { return ++asked > 3; };
  const ClipMesh mesh = model.Clipped(model.Quadrics({ Sphere({ 1.0, 1.0, 0.5 }, 0.6) }), options);
  EXPECT_EQ(mesh.Cells.cols(), 0);
}

TEST(Clip, ALimitOnCellsIsToldOf)
{
  const Model model(models::QuarterTube());
  ClipOptions options;
  options.MaximumCells = 2000;
  const ClipMesh mesh = model.Clipped(model.Quadrics({ Sphere({ 1.0, 1.0, 0.5 }, 0.6) }), options);
  EXPECT_GT(mesh.Cells.cols(), 0);
  EXPECT_FALSE(mesh.Certificate.ToleranceReached);
}

TEST(Clip, MistakesAreErrors)
{
  const Model model(models::QuarterTube());
  ClipOptions options;
  options.Tolerance = 0.0;
  EXPECT_THROW((void)model.Clipped(model.Quadrics({ Plane({ 1, 0, 0 }, 1.0) }), options), Error);
  const std::vector<Quadric> many(SimplexCut::MaximumFields + 1, Plane({ 1, 0, 0 }, 1.0));
  EXPECT_THROW((void)model.Clipped(model.Quadrics(many)), Error);
}
