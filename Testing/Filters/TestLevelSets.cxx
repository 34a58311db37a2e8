// SPDX-License-Identifier: BSD-3-Clause
// Boxes in NURBS Slice, what NURBS Contour draws besides attributes, and NURBS Clip.
#include "Evaluator.h"
#include "FilterRun.h"
#include "Measures.h"
#include "Splines/TurnedPatches.h"
#include "vtkNURBSClip.h"
#include "vtkNURBSContour.h"
#include "vtkNURBSSlice.h"

#include "vtkBox.h"
#include "vtkCell.h"
#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkCylinder.h"
#include "vtkDataObject.h"
#include "vtkMath.h"
#include "vtkPlane.h"
#include "vtkPointData.h"
#include "vtkSMPTools.h"
#include "vtkSphere.h"
#include "vtkSuperquadric.h"
#include "vtkTetra.h"
#include "vtkTransform.h"
#include "vtkTriangle.h"
#include "vtkUnstructuredGrid.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

using namespace hyperpatch;

namespace
{

using Point = std::array<double, 3>;

Point PointAt(vtkDataSet* mesh, vtkIdType i)
{
  Point x{};
  mesh->GetPoint(i, x.data());
  return x;
}

double Area(vtkDataSet* mesh)
{
  double area = 0.0;
  for (vtkIdType c = 0; c < mesh->GetNumberOfCells(); ++c)
  {
    area += vtkTriangle::SafeDownCast(mesh->GetCell(c))->ComputeArea();
  }
  return area;
}

/// Edges of triangles by the coordinates of their ends, and how many triangles have them.
std::map<std::array<Point, 2>, int> Edges(vtkDataSet* mesh)
{
  std::map<std::array<Point, 2>, int> edges;
  for (vtkIdType c = 0; c < mesh->GetNumberOfCells(); ++c)
  {
    for (int k = 0; k < 3; ++k)
    {
      Point a = PointAt(mesh, mesh->GetCell(c)->GetPointId(k));
      Point b = PointAt(mesh, mesh->GetCell(c)->GetPointId((k + 1) % 3));
      ++edges[{ std::min(a, b), std::max(a, b) }];
    }
  }
  return edges;
}

double Volume(vtkDataSet* mesh)
{
  double volume = 0.0;
  for (vtkIdType c = 0; c < mesh->GetNumberOfCells(); ++c)
  {
    EXPECT_EQ(mesh->GetCellType(c), VTK_TETRA);
    std::array<Point, 4> x;
    for (std::size_t k = 0; k < 4; ++k)
    {
      x[k] = PointAt(mesh, mesh->GetCell(c)->GetPointId(static_cast<int>(k)));
    }
    const double cell = vtkTetra::ComputeVolume(x[0].data(), x[1].data(), x[2].data(), x[3].data());
    EXPECT_GT(cell, 0.0);
    volume += cell;
  }
  return volume;
}

vtkUnstructuredGrid* Updated(FilterRun<vtkNURBSClip>& run)
{
  run.F->Update();
  return vtkUnstructuredGrid::SafeDownCast(run.F->GetOutputDataObject(0));
}

/// The unit cube with a bend that is none: the geometry is the identity, in many elements.
Spline Cube(int degree, int size)
{
  const KnotVector k = KnotVector::Uniform(degree, size);
  const Eigen::Index n = k.Size();
  Eigen::MatrixXd points(3, n * n * n);
  for (Eigen::Index c = 0; c < points.cols(); ++c)
  {
    points.col(c) << k.Greville(static_cast<int>(c % n)), k.Greville(static_cast<int>(c / n % n)),
      k.Greville(static_cast<int>(c / (n * n)));
  }
  return Spline({ k, k, k }, points);
}

constexpr int Points = vtkDataObject::FIELD_ASSOCIATION_POINTS;

}

TEST(NURBSSlice, TheSidesOfABoxEndWhereTheyMeet)
{
  // Wholly inside of one cube, turned: its area is known, and it is closed.
  FilterRun<vtkNURBSSlice> run(Alone(Cube(2, 5)));
  vtkNew<vtkTransform> turn;
  turn->Translate(0.5, 0.5, 0.5);
  turn->RotateWXYZ(33.0, 1.0, 2.0, -0.5);
  turn->Inverse();
  vtkNew<vtkBox> box;
  box->SetBounds(-0.3, 0.2, -0.25, 0.25, -0.1, 0.3);
  box->SetTransform(turn);
  run.F->SetSliceFunction(box);
  for (const double offset : { 0.0, -0.05 })
  {
    run.F->SetOffsetValue(0, offset);
    vtkPolyData* mesh = run.Update();
    ASSERT_TRUE(run.Errors.empty());
    const double a = 0.5 + 2.0 * offset;
    const double b = 0.5 + 2.0 * offset;
    const double c = 0.4 + 2.0 * offset;
    EXPECT_NEAR(Area(mesh), 2.0 * (a * b + b * c + c * a), 1e-12);
    EXPECT_EQ(FieldNumber(mesh, "UndecidedCells"), 0);
    for (const auto& [edge, triangles] : Edges(mesh))
    {
      EXPECT_EQ(triangles, 2);
    }
    for (vtkIdType i = 0; i < mesh->GetNumberOfPoints(); ++i)
    {
      EXPECT_NEAR(box->FunctionValue(PointAt(mesh, i).data()), offset, 1e-13);
    }
  }
}

TEST(NURBSSlice, BoxesInCurvedVolumesHaveNoCracksAtTheirEdges)
{
  FilterRun<vtkNURBSSlice> run(Alone(models::QuarterTube()));
  vtkNew<vtkBox> box;
  box->SetBounds(0.5, 1.2, 0.5, 1.3, -1.0, 0.6);
  run.F->SetSliceFunction(box);
  run.F->SetTolerance(1e-4);
  vtkPolyData* mesh = run.Update();
  ASSERT_GT(mesh->GetNumberOfCells(), 10);
  const double inner = 1.0;
  for (const auto& [edge, triangles] : Edges(mesh))
  {
    if (triangles == 2)
    {
      continue;
    }
    // Where the model ends.
    const auto& [p, q] = edge;
    const bool bottom = std::abs(p[2]) + std::abs(q[2]) < 1e-12;
    const bool arc = std::abs(std::hypot(p[0], p[1]) - inner) < 1e-12 &&
      std::abs(std::hypot(q[0], q[1]) - inner) < 1e-12;
    const bool outer = std::abs(std::hypot(p[0], p[1]) - 2.0) < 1e-12 &&
      std::abs(std::hypot(q[0], q[1]) - 2.0) < 1e-12;
    EXPECT_TRUE(triangles == 1 && (bottom || arc || outer))
      << p[0] << " " << p[1] << " " << p[2] << ", " << q[0] << " " << q[1] << " " << q[2];
  }
  for (vtkIdType i = 0; i < mesh->GetNumberOfPoints(); ++i)
  {
    EXPECT_NEAR(box->FunctionValue(PointAt(mesh, i).data()), 0.0, 1e-12);
  }
}

TEST(NURBSContour, CoordinatesAreThoseOfThePoints)
{
  FilterRun<vtkNURBSContour> run(TwoTubes());
  run.F->SetContourOf(vtkNURBSContour::COORDINATES);
  run.F->SetComponent(2);
  run.F->SetValue(0, 0.25);
  run.F->SetValue(1, 5.5);
  vtkPolyData* mesh = run.Update();
  ASSERT_TRUE(run.Errors.empty());
  ASSERT_GT(mesh->GetNumberOfCells(), 0);
  for (vtkIdType c = 0; c < mesh->GetNumberOfCells(); ++c)
  {
    const auto index =
      static_cast<int>(mesh->GetCellData()->GetArray("ContourIndex")->GetTuple1(c));
    EXPECT_EQ(mesh->GetCellData()->GetArray("PatchId")->GetTuple1(c), index == 0 ? 3 : 8);
    for (int k = 0; k < 3; ++k)
    {
      EXPECT_NEAR(PointAt(mesh, mesh->GetCell(c)->GetPointId(k))[2], run.F->GetValue(index), 1e-14);
    }
  }
  // The distance from the origin is the radius of a sphere.
  run.F->SetComponent(-1);
  run.F->SetNumberOfContours(1);
  run.F->SetValue(0, 1.5);
  mesh = run.Update();
  ASSERT_GT(mesh->GetNumberOfCells(), 0);
  for (vtkIdType i = 0; i < mesh->GetNumberOfPoints(); ++i)
  {
    const Point x = PointAt(mesh, i);
    EXPECT_NEAR(vtkMath::Norm(x.data()), 1.5, 1e-12);
  }
}

TEST(NURBSContour, IsoParametricSurfacesOfATubeAreCylinders)
{
  FilterRun<vtkNURBSContour> run(TwoTubes());
  run.F->SetContourOf(vtkNURBSContour::PARAMETRIC_COORDINATES);
  run.F->SetValue(0, 0.25);
  vtkPolyData* mesh = run.Update();
  ASSERT_TRUE(run.Errors.empty());
  ASSERT_GT(mesh->GetNumberOfCells(), 0);
  EXPECT_EQ(FieldNumber(mesh, "UndecidedCells"), 0);
  for (vtkIdType i = 0; i < mesh->GetNumberOfPoints(); ++i)
  {
    const Point x = PointAt(mesh, i);
    EXPECT_NEAR(std::hypot(x[0], x[1]), 1.25, 1e-14);
    EXPECT_EQ(mesh->GetPointData()->GetArray("ParametricCoordinates")->GetComponent(i, 0), 0.25);
  }
  // Two quarter cylinders of height 1, to the tolerance.
  EXPECT_NEAR(Area(mesh), 2.0 * 0.5 * vtkMath::Pi() * 1.25, 1e-2);
  run.F->SetComponent(-1);
  EXPECT_EQ(run.Update()->GetNumberOfCells(), 0);
  ASSERT_GE(run.Errors.size(), 1u);
  EXPECT_NE(run.Errors[0].find("component -1"), std::string::npos);
}

TEST(NURBSContour, TheJacobianDeterminantHasTheValue)
{
  const Spline tube = models::QuarterTube();
  FilterRun<vtkNURBSContour> run(Alone(tube));
  run.F->SetContourOf(vtkNURBSContour::JACOBIAN_DETERMINANT);
  // det J = r dr/du d(angle)/dv, and nothing of w: symmetric in v.
  run.F->SetValue(0, 2.2);
  vtkPolyData* mesh = run.Update();
  ASSERT_TRUE(run.Errors.empty());
  ASSERT_GT(mesh->GetNumberOfCells(), 0);
  EXPECT_EQ(FieldNumber(mesh, "UndecidedCells"), 0);
  const Evaluator evaluator(tube);
  for (vtkIdType i = 0; i < mesh->GetNumberOfPoints(); ++i)
  {
    Point u{};
    mesh->GetPointData()->GetArray("ParametricCoordinates")->GetTuple(i, u.data());
    Eigen::Vector3d x;
    Eigen::Matrix3d J;
    evaluator.EvaluateWithDerivatives(1, u.data(), x.data(), J.data());
    EXPECT_NEAR(J.determinant(), 2.2, 1e-12);
  }
}

TEST(NURBSContour, TheToleranceOfTheContouredScalarDoesNotApply)
{
  // A plane by a scalar that is z; only the scalar would ask for small triangles elsewhere.
  const Spline cube = Cube(1, 2);
  const Spline wave = Cube(3, 12);
  const KnotVector k = wave.Knots(0);
  Eigen::MatrixXd values =
    wave.Coefficients().row(2) + 0.03 * (20.0 * wave.Coefficients().row(0)).array().sin().matrix();
  MultiPatch model;
  model.Patches.push_back({ 0, Aggregate(cube, { { "Wave", Spline({ k, k, k }, values) } }) });
  FilterRun<vtkNURBSContour> run(model);
  run.F->SetInputArrayToProcess(0, 0, 0, Points, "Wave");
  run.F->SetValue(0, 0.5);
  run.F->SetTolerance(1e-2);
  run.F->SetAttributeTolerance(0.0);
  const vtkIdType off = run.Update()->GetNumberOfCells();
  run.F->SetAttributeTolerance(1e-4);
  EXPECT_EQ(run.Update()->GetNumberOfCells(), off);
}

TEST(NURBSClip, APlaneLeavesTheExactPartOfABox)
{
  MultiPatch model = Alone(Cube(2, 5));
  FilterRun<vtkNURBSClip> run(model);
  vtkNew<vtkPlane> plane;
  plane->SetOrigin(0.25, 0.25, 0.25);
  plane->SetNormal(1.0, 1.0, 1.0);
  run.F->SetClipFunction(plane);
  vtkUnstructuredGrid* mesh = Updated(run);
  ASSERT_TRUE(run.Errors.empty());
  EXPECT_NEAR(Volume(mesh), std::pow(0.75, 3) / 6.0, 1e-14);
  EXPECT_EQ(FieldNumber(mesh, "UndecidedCells"), 0);
  EXPECT_EQ(FieldNumber(mesh, "ToleranceReached"), 1);
  run.F->InvertOff();
  mesh = Updated(run);
  EXPECT_NEAR(Volume(mesh), 1.0 - std::pow(0.75, 3) / 6.0, 1e-13);
}

TEST(NURBSClip, CarriesAttributesAndIds)
{
  const MultiPatch model = TwoTubes();
  FilterRun<vtkNURBSClip> run(model);
  vtkNew<vtkSphere> sphere;
  sphere->SetCenter(1.0, 1.0, 0.5);
  sphere->SetRadius(0.6);
  run.F->SetClipFunction(sphere);
  run.F->InvertOff();
  run.F->SetTolerance(1e-2);
  run.F->SetAttributeTolerance(0.1);
  vtkUnstructuredGrid* mesh = Updated(run);
  ASSERT_TRUE(run.Errors.empty());
  ASSERT_TRUE(run.Warnings.empty());
  EXPECT_GT(Volume(mesh), 0.0);
  for (vtkIdType c = 0; c < mesh->GetNumberOfCells(); ++c)
  {
    const int id = static_cast<int>(mesh->GetCellData()->GetArray("PatchId")->GetTuple1(c));
    const Patch& patch = model.Patches[id == 3 ? 0 : 1];
    EXPECT_EQ(mesh->GetCellData()->GetArray("ElementId")->GetTuple1(c), 0);
    for (int k = 0; k < 4; ++k)
    {
      const vtkIdType i = mesh->GetCell(c)->GetPointId(k);
      Point u{};
      mesh->GetPointData()->GetArray("ParametricCoordinates")->GetTuple(i, u.data());
      const Point x = PointAt(mesh, i);
      const Eigen::VectorXd exact = patch.Body.Geometry().Evaluate(u[0], u[1], u[2]);
      EXPECT_NEAR((exact - Eigen::Vector3d(x.data())).norm(), 0.0, 1e-13);
      const double value = mesh->GetPointData()->GetArray("Temperature")->GetTuple1(i);
      if (id == 3)
      {
        EXPECT_NEAR(
          value, patch.Body.FindAttribute("Temperature")->Evaluate(u[0], u[1], u[2])[0], 1e-13);
      }
      else
      {
        EXPECT_TRUE(std::isnan(value));
      }
      EXPECT_GE(sphere->FunctionValue(x.data()), -1e-12);
    }
  }
}

TEST(NURBSClip, ByAttributesCoordinatesParametersAndDetJ)
{
  FilterRun<vtkNURBSClip> run(TwoTubes());
  run.F->SetInputArrayToProcess(0, 0, 0, Points, "Temperature");
  vtkUnstructuredGrid* mesh = Updated(run);
  ASSERT_TRUE(run.Errors.empty());
  ASSERT_GT(mesh->GetNumberOfCells(), 0);
  double last = -INFINITY;
  for (vtkIdType i = 0; i < mesh->GetNumberOfPoints(); ++i)
  {
    last = std::max(last, mesh->GetPointData()->GetArray("Temperature")->GetTuple1(i));
  }
  EXPECT_NEAR(last, 0.0, 1e-13);

  // Half of each tube by an angle; an eighth by the middle of the radius counts more outside.
  run.F->SetClipBy(vtkNURBSClip::PARAMETRIC_COORDINATES);
  run.F->SetComponent(1);
  run.F->SetValue(0.5);
  run.F->SetTolerance(3e-4);
  const double half = 0.5 * 2.0 * 3.0 / 4.0 * vtkMath::Pi();
  run.F->SetAttributeTolerance(0.1);
  EXPECT_NEAR(Volume(Updated(run)), half, 3e-3);
  run.F->SetComponent(0);
  EXPECT_NEAR(Volume(Updated(run)), 2.0 * (1.5 * 1.5 - 1.0) / 4.0 * vtkMath::Pi(), 3e-3);
  run.F->SetClipBy(vtkNURBSClip::COORDINATES);
  run.F->SetComponent(2);
  run.F->SetValue(0.25);
  EXPECT_NEAR(Volume(Updated(run)), 0.25 * 3.0 / 4.0 * vtkMath::Pi(), 3e-3);
  run.F->SetTolerance(1e-3);
  run.F->SetClipBy(vtkNURBSClip::JACOBIAN_DETERMINANT);
  run.F->SetValue(2.2);
  const double below = Volume(Updated(run));
  run.F->InvertOff();
  EXPECT_NEAR(below + Volume(Updated(run)), 2.0 * 3.0 / 4.0 * vtkMath::Pi(), 2e-2);
  EXPECT_GT(below, 0.5);
  EXPECT_TRUE(run.Errors.empty());
}

TEST(NURBSClip, BoxesAndWhatTheyLeave)
{
  FilterRun<vtkNURBSClip> run(Alone(Cube(1, 2)));
  vtkNew<vtkTransform> turn;
  turn->Translate(0.5, 0.5, 0.5);
  turn->RotateZ(30.0);
  turn->Inverse();
  vtkNew<vtkBox> box;
  box->SetBounds(-0.2, 0.2, -0.25, 0.25, -0.1, 0.3);
  box->SetTransform(turn);
  run.F->SetClipFunction(box);
  EXPECT_NEAR(Volume(Updated(run)), 0.4 * 0.5 * 0.4, 1e-13);
  run.F->InvertOff();
  EXPECT_NEAR(Volume(Updated(run)), 1.0 - 0.4 * 0.5 * 0.4, 1e-13);
  EXPECT_TRUE(run.Errors.empty());
}

TEST(NURBSClip, FunctionsThatAreSampledAreUndecided)
{
  FilterRun<vtkNURBSClip> run(Alone(Cube(1, 2)));
  vtkNew<vtkSuperquadric> ball;
  ball->SetCenter(0.5, 0.5, 0.5);
  ball->SetSize(0.3);
  run.F->SetClipFunction(ball);
  run.F->SetTolerance(1e-2);
  vtkUnstructuredGrid* mesh = Updated(run);
  EXPECT_NEAR(Volume(mesh), 4.0 / 3.0 * vtkMath::Pi() * std::pow(0.3, 3), 2e-2);
  EXPECT_GT(FieldNumber(mesh, "UndecidedCells"), 0);
}

TEST(NURBSClip, WhatMissesIsEmptyOrWhole)
{
  FilterRun<vtkNURBSClip> run(Alone(Cube(1, 2)));
  vtkNew<vtkPlane> plane;
  plane->SetOrigin(0.0, 0.0, -1.0);
  run.F->SetClipFunction(plane);
  EXPECT_EQ(Updated(run)->GetNumberOfCells(), 0);
  run.F->InvertOff();
  EXPECT_NEAR(Volume(Updated(run)), 1.0, 1e-14);
  EXPECT_TRUE(run.Errors.empty());
  EXPECT_TRUE(run.Warnings.empty());
}

TEST(NURBSClip, MistakesAreNamed)
{
  const auto expectError = [](FilterRun<vtkNURBSClip>& run, const char* part)
  {
    EXPECT_EQ(Updated(run)->GetNumberOfPoints(), 0);
    ASSERT_GE(run.Errors.size(), 1u);
    EXPECT_NE(run.Errors[0].find(part), std::string::npos) << run.Errors[0];
  };
  FilterRun<vtkNURBSClip> name(TwoTubes());
  name.F->SetInputArrayToProcess(0, 0, 0, Points, "Pressure");
  expectError(name, "Temperature, Velocity");
  FilterRun<vtkNURBSClip> value(TwoTubes());
  value.F->SetInputArrayToProcess(0, 0, 0, Points, "Temperature");
  value.F->SetValue(NAN);
  expectError(value, "value to clip at");
  FilterRun<vtkNURBSClip> component(TwoTubes());
  component.F->SetClipBy(vtkNURBSClip::COORDINATES);
  component.F->SetComponent(3);
  expectError(component, "component 3");
  FilterRun<vtkNURBSClip> plane(TwoTubes());
  vtkNew<vtkPlane> infinite;
  infinite->SetOrigin(INFINITY, 0, 0);
  plane.F->SetClipFunction(infinite);
  expectError(plane, "finite");
}

TEST(NURBSClip, WhatIsKeptBetweenRunsDoesNotChangeTheResult)
{
  vtkNew<vtkPlane> plane;
  plane->SetOrigin(1.0, 1.0, 0.5);
  FilterRun<vtkNURBSClip> kept(TwoTubes());
  kept.F->SetClipFunction(plane);
  kept.F->SetAttributeTolerance(0.1);
  Updated(kept);
  plane->SetNormal(1.0, 0.3, 0.0);
  for (const double tolerance : { 1e-2, 1e-3 })
  {
    kept.F->SetTolerance(tolerance);
    FilterRun<vtkNURBSClip> fresh(TwoTubes());
    fresh.F->SetClipFunction(plane);
    fresh.F->SetAttributeTolerance(0.1);
    fresh.F->SetTolerance(tolerance);
    EXPECT_EQ(Volume(Updated(kept)), Volume(Updated(fresh)));
  }
  // Another model, with another number of patches.
  vtkNew<vtkPartitionedDataSetCollection> other;
  ToVTK(Alone(Cube(1, 2)), other);
  kept.F->SetInputDataObject(other);
  plane->SetNormal(0.0, 0.0, 1.0);
  EXPECT_NEAR(Volume(Updated(kept)), 0.5, 1e-14);
}

TEST(NURBSClip, PatchesThatMeetHaveTheSameFaces)
{
  const MultiPatch model = models::Split(
    models::Curved(1), { 2, 1, 1 }, { models::Turn::Number(5), models::Turn::Number(38) });
  FilterRun<vtkNURBSClip> run(model);
  vtkNew<vtkPlane> plane;
  plane->SetOrigin(0.5, 0.5, 0.5);
  plane->SetNormal(0.1, 1.0, 0.3);
  run.F->SetClipFunction(plane);
  run.F->SetTolerance(1e-2);
  run.F->SetAttributeTolerance(0.0);
  vtkUnstructuredGrid* mesh = Updated(run);
  ASSERT_TRUE(run.Errors.empty());
  EXPECT_EQ(FieldNumber(mesh, "OpenFacesOnInterfaces"), 0);
  // Faces by the coordinates of their corners: those of both patches at once are the interface's.
  std::map<std::array<Point, 3>, int> patchesOf;
  for (vtkIdType c = 0; c < mesh->GetNumberOfCells(); ++c)
  {
    const int id = static_cast<int>(mesh->GetCellData()->GetArray("PatchId")->GetTuple1(c));
    for (int left = 0; left < 4; ++left)
    {
      std::array<Point, 3> face{};
      for (int k = 0; k < 3; ++k)
      {
        face[static_cast<std::size_t>(k)] =
          PointAt(mesh, mesh->GetCell(c)->GetPointId((left + 1 + k) % 4));
      }
      std::sort(face.begin(), face.end());
      patchesOf[face] |= 1 << id;
    }
  }
  EXPECT_GT(std::count_if(patchesOf.begin(), patchesOf.end(),
              [](const auto& face) { return face.second == 3; }),
    10);
}

TEST(NURBSClip, ThreadsDoNotChangeTheResult)
{
  FilterRun<vtkNURBSClip> run(TwoTubes());
  vtkNew<vtkSphere> sphere;
  sphere->SetCenter(1.0, 1.0, 0.5);
  sphere->SetRadius(0.6);
  run.F->SetClipFunction(sphere);
  run.F->SetAttributeTolerance(0.1);
  std::vector<std::vector<Point>> points;
  for (const int threads : { 1, 4 })
  {
    vtkSMPTools::LocalScope(vtkSMPTools::Config{ threads, "STDThread", false },
      [&]
      {
        run.F->Modified();
        vtkUnstructuredGrid* mesh = Updated(run);
        auto& all = points.emplace_back();
        for (vtkIdType i = 0; i < mesh->GetNumberOfPoints(); ++i)
        {
          all.push_back(PointAt(mesh, i));
        }
      });
  }
  EXPECT_GT(points[0].size(), 100u);
  EXPECT_EQ(points[0], points[1]);
}
