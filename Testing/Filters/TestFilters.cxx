// SPDX-License-Identifier: BSD-3-Clause
#include "Error.h"
#include "Evaluator.h"
#include "FilterRun.h"
#include "Measures.h"
#include "Models.h"
#include "NURBSConversion.h"
#include "ZeroSet.h"
#include "vtkNURBSContour.h"
#include "vtkNURBSJacobianBoundary.h"
#include "vtkNURBSSlice.h"
#include "vtkNURBSTessellate.h"

#include "vtkBox.h"
#include "vtkCallbackCommand.h"
#include "vtkCellData.h"
#include "vtkCellTypes.h"
#include "vtkCommand.h"
#include "vtkCylinder.h"
#include "vtkFieldData.h"
#include "vtkMassProperties.h"
#include "vtkNew.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkPlane.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkSMPTools.h"
#include "vtkSphere.h"
#include "vtkSuperquadric.h"
#include "vtkTransform.h"
#include "vtkUnstructuredGrid.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <set>
#include <string>
#include <vector>

using namespace hyperpatch;

namespace
{

void ExpectPromisedArrays(vtkPolyData* mesh)
{
  for (const char* name : { "Normals", "ParametricCoordinates", "Temperature", "Velocity" })
  {
    vtkDataArray* array = mesh->GetPointData()->GetArray(name);
    ASSERT_NE(array, nullptr) << name;
    EXPECT_EQ(array->GetNumberOfTuples(), mesh->GetNumberOfPoints()) << name;
    EXPECT_EQ(array->GetDataType(), VTK_DOUBLE) << name;
  }
  for (const char* name : { "PatchId", "ElementId" })
  {
    vtkDataArray* array = mesh->GetCellData()->GetArray(name);
    ASSERT_NE(array, nullptr) << name;
    EXPECT_EQ(array->GetNumberOfTuples(), mesh->GetNumberOfCells()) << name;
  }
  EXPECT_EQ(mesh->GetPoints()->GetDataType(), VTK_DOUBLE);
}

/// Points, normals and attributes are those of the model at the parametric coordinates.
void ExpectExact(vtkPolyData* mesh, const MultiPatch& model)
{
  vtkPointData* data = mesh->GetPointData();
  for (vtkIdType c = 0; c < mesh->GetNumberOfCells(); ++c)
  {
    const int id = static_cast<int>(mesh->GetCellData()->GetArray("PatchId")->GetTuple1(c));
    const auto patch = std::find_if(
      model.Patches.begin(), model.Patches.end(), [id](const Patch& p) { return p.Id == id; });
    ASSERT_NE(patch, model.Patches.end());
    for (vtkIdType k = 0; k < mesh->GetCell(c)->GetNumberOfPoints(); ++k)
    {
      const vtkIdType v = mesh->GetCell(c)->GetPointId(static_cast<int>(k));
      double p[3];
      data->GetArray("ParametricCoordinates")->GetTuple(v, p);
      const Eigen::VectorXd x = patch->Body.Geometry().Evaluate(p[0], p[1], p[2]);
      EXPECT_NEAR((x - Eigen::Vector3d(mesh->GetPoint(v))).norm(), 0.0, 1e-13);
      double n[3];
      data->GetArray("Normals")->GetTuple(v, n);
      EXPECT_NEAR(Eigen::Vector3d(n).norm(), 1.0, 1e-12);
      const Spline* temperature = patch->Body.FindAttribute("Temperature");
      const double value = data->GetArray("Temperature")->GetTuple1(v);
      if (temperature)
      {
        EXPECT_NEAR(value, temperature->Evaluate(p[0], p[1], p[2])[0], 1e-13);
      }
      else
      {
        EXPECT_TRUE(std::isnan(value));
      }
    }
  }
}

}

TEST(NURBSSlice, PointsLieOnThePlaneAndOnTheSpline)
{
  const MultiPatch model = TwoTubes();
  FilterRun<vtkNURBSSlice> run(model);
  vtkNew<vtkPlane> plane;
  plane->SetOrigin(0.2, 0.3, 0.5);
  plane->SetNormal(0.3, 0.1, 1.0);
  run.F->SetSliceFunction(plane);
  run.F->SetOffsetValue(0, 0.0);
  run.F->SetOffsetValue(1, 5.1);
  vtkPolyData* mesh = run.Update();
  ASSERT_GT(mesh->GetNumberOfCells(), 0);
  ExpectPromisedArrays(mesh);
  ExpectExact(mesh, model);
  std::set<int> patches;
  for (vtkIdType c = 0; c < mesh->GetNumberOfCells(); ++c)
  {
    patches.insert(static_cast<int>(mesh->GetCellData()->GetArray("PatchId")->GetTuple1(c)));
    const double offset = run.F->GetOffsetValue(
      static_cast<int>(mesh->GetCellData()->GetArray("SliceIndex")->GetTuple1(c)));
    for (int k = 0; k < 3; ++k)
    {
      // Diagonal and coordinates are about 6.
      EXPECT_NEAR(
        plane->EvaluateFunction(mesh->GetPoint(mesh->GetCell(c)->GetPointId(k))), offset, 1e-12);
    }
  }
  EXPECT_EQ(patches, (std::set<int>{ 3, 8 }));
  EXPECT_EQ(FieldNumber(mesh, "UndecidedCells"), 0);
  EXPECT_EQ(FieldNumber(mesh, "ToleranceReached"), 1);
  EXPECT_TRUE(run.Errors.empty());
}

TEST(NURBSSlice, AModelFarFromTheOriginIsSlicedAsWell)
{
  Spline tube = models::QuarterTube();
  Eigen::MatrixXd moved = tube.Coefficients();
  moved.colwise() += Eigen::Vector3d(1e6, -2e6, 3e5);
  FilterRun<vtkNURBSSlice> run(Alone(Spline(tube.Knots(), moved, tube.Weights())));
  vtkNew<vtkPlane> plane;
  plane->SetOrigin(1e6, -2e6, 3e5 + 0.5);
  plane->SetNormal(0.1, 0.2, 1.0);
  run.F->SetSliceFunction(plane);
  vtkPolyData* mesh = run.Update();
  ASSERT_GT(mesh->GetNumberOfCells(), 0);
  for (vtkIdType v = 0; v < mesh->GetNumberOfPoints(); ++v)
  {
    EXPECT_NEAR(plane->EvaluateFunction(mesh->GetPoint(v)), 0.0, 1e-12 * 2e6);
  }
}

TEST(NURBSSlice, SpheresAndCylindersAreExactAndOtherFunctionsAreSampled)
{
  FilterRun<vtkNURBSSlice> run(TwoTubes());
  vtkNew<vtkSphere> sphere;
  sphere->SetCenter(1.0, 1.0, 0.5);
  sphere->SetRadius(0.4);
  vtkNew<vtkTransform> transform;
  transform->RotateX(90.0);
  transform->Translate(0.1, 0.0, 0.0);
  vtkNew<vtkCylinder> cylinder;
  cylinder->SetTransform(transform);
  cylinder->SetRadius(1.4);
  for (vtkImplicitFunction* function :
    std::initializer_list<vtkImplicitFunction*>{ sphere, cylinder })
  {
    run.F->SetSliceFunction(function);
    vtkPolyData* mesh = run.Update();
    ASSERT_GT(mesh->GetNumberOfCells(), 10) << function->GetClassName();
    EXPECT_EQ(FieldNumber(mesh, "UndecidedCells"), 0) << function->GetClassName();
    for (vtkIdType v = 0; v < mesh->GetNumberOfPoints(); ++v)
    {
      double x[3];
      mesh->GetPoint(v, x);
      EXPECT_NEAR(function->FunctionValue(x), 0.0, 1e-12) << function->GetClassName();
    }
  }
  vtkNew<vtkSuperquadric> superquadric;
  superquadric->SetCenter(1.0, 1.0, 0.5);
  superquadric->SetSize(0.4);
  run.F->SetSliceFunction(superquadric);
  run.F->SetTolerance(1e-2);
  vtkPolyData* mesh = run.Update();
  ASSERT_GT(mesh->GetNumberOfCells(), 10);
  EXPECT_GT(FieldNumber(mesh, "UndecidedCells"), 0);
  vtkDataArray* boxes = mesh->GetFieldData()->GetArray("UndecidedBoxes");
  ASSERT_NE(boxes, nullptr);
  ASSERT_EQ(boxes->GetNumberOfComponents(), 7);
  // Of each of the two patches no more than that are listed.
  EXPECT_EQ(boxes->GetNumberOfTuples(),
    std::min(FieldNumber(mesh, "UndecidedCells"), 2.0 * hyperpatch::ZeroSet::MostListed));
  for (vtkIdType b = 0; b < boxes->GetNumberOfTuples(); ++b)
  {
    for (int d = 0; d < 3; ++d)
    {
      EXPECT_LT(boxes->GetComponent(b, 1 + 2 * d), boxes->GetComponent(b, 2 + 2 * d));
    }
  }
  for (vtkIdType v = 0; v < mesh->GetNumberOfPoints(); ++v)
  {
    double x[3];
    mesh->GetPoint(v, x);
    EXPECT_NEAR(superquadric->FunctionValue(x), 0.0, 1e-11);
  }
}

TEST(NURBSSlice, WithoutAFunctionIsAnError)
{
  FilterRun<vtkNURBSSlice> run(TwoTubes());
  vtkPolyData* mesh = run.Update();
  EXPECT_EQ(mesh->GetNumberOfPoints(), 0);
  ASSERT_GE(run.Errors.size(), 1u);
  EXPECT_NE(run.Errors[0].find("set SliceFunction"), std::string::npos);
}

TEST(NURBSSlice, FarSpheresAreExactAndBoxesInsideOneElementAreFound)
{
  Spline tube = models::QuarterTube();
  Eigen::MatrixXd moved = tube.Coefficients();
  moved.colwise() += Eigen::Vector3d(1e6, -2e6, 3e5);
  FilterRun<vtkNURBSSlice> far(Alone(Spline(tube.Knots(), moved, tube.Weights())));
  vtkNew<vtkSphere> sphere;
  sphere->SetCenter(1e6 + 1.0, -2e6 + 1.0, 3e5 + 0.5);
  sphere->SetRadius(0.4);
  far.F->SetSliceFunction(sphere);
  vtkPolyData* ball = far.Update();
  ASSERT_GT(ball->GetNumberOfCells(), 100);
  for (vtkIdType v = 0; v < ball->GetNumberOfPoints(); ++v)
  {
    EXPECT_NEAR(sphere->EvaluateFunction(ball->GetPoint(v)), 0.0, 1e-12 * 2e6);
  }

  FilterRun<vtkNURBSSlice> run(Alone(models::QuarterTube()));
  vtkNew<vtkBox> box;
  box->SetBounds(0.9, 1.2, 0.9, 1.2, 0.4, 0.6);
  run.F->SetSliceFunction(box);
  run.F->SetTolerance(1e-2);
  EXPECT_GT(run.Update()->GetNumberOfCells(), 0);
}

TEST(NURBSSlice, NumbersThatAreNoneAreRefused)
{
  vtkNew<vtkPlane> plane;
  plane->SetNormal(0, 0, 1);
  plane->SetOrigin(0, 0, 0.5);
  const auto expectError = [](FilterRun<vtkNURBSSlice>& run, const char* part)
  {
    EXPECT_EQ(run.Update()->GetNumberOfPoints(), 0);
    ASSERT_GE(run.Errors.size(), 1u);
    EXPECT_NE(run.Errors[0].find(part), std::string::npos) << run.Errors[0];
  };
  FilterRun<vtkNURBSSlice> offset(TwoTubes());
  offset.F->SetSliceFunction(plane);
  offset.F->SetOffsetValue(0, NAN);
  expectError(offset, "offset value");
  FilterRun<vtkNURBSSlice> tolerance(TwoTubes());
  tolerance.F->SetSliceFunction(plane);
  tolerance.F->SetTolerance(NAN);
  expectError(tolerance, "Tolerance");
  FilterRun<vtkNURBSSlice> normal(TwoTubes());
  vtkNew<vtkPlane> none;
  none->SetNormal(0, 0, 0);
  normal.F->SetSliceFunction(none);
  expectError(normal, "normal");
}

TEST(NURBSSlice, AttributesThatJumpAskForNothing)
{
  MultiPatch model;
  const KnotVector steps(0, { 0, 0.5, 1 });
  Eigen::MatrixXd material(1, 2);
  material << 1, 2;
  model.Patches.push_back({ 0,
    Aggregate(models::QuarterTube(),
      { { "Material", Spline({ steps, KnotVector(), KnotVector() }, material) },
        { "Normals", models::QuarterTube() } }) });
  FilterRun<vtkNURBSSlice> run(model);
  vtkNew<vtkPlane> plane;
  plane->SetNormal(0.2, 0.3, 1);
  plane->SetOrigin(1, 1, 0.5);
  run.F->SetSliceFunction(plane);
  vtkPolyData* mesh = run.Update();
  EXPECT_GT(mesh->GetNumberOfCells(), 0);
  EXPECT_LT(mesh->GetNumberOfCells(), 2000);
  // The name of an output array is not for attributes; that is said.
  ASSERT_EQ(run.Warnings.size(), 1u);
  EXPECT_NE(run.Warnings[0].find("Normals"), std::string::npos);
  EXPECT_EQ(mesh->GetPointData()->GetArray("Normals")->GetNumberOfComponents(), 3);
}

TEST(NURBSSlice, AChangedFunctionIsSeen)
{
  FilterRun<vtkNURBSSlice> run(TwoTubes());
  vtkNew<vtkPlane> plane;
  plane->SetOrigin(0, 0, 0.5);
  run.F->SetSliceFunction(plane);
  EXPECT_GT(run.Update()->GetNumberOfCells(), 0);
  plane->SetOrigin(0, 0, 50);
  EXPECT_EQ(run.Update()->GetNumberOfCells(), 0);
  EXPECT_TRUE(run.Errors.empty());
}

TEST(NURBSContour, PointsHaveTheValue)
{
  const MultiPatch model = TwoTubes();
  FilterRun<vtkNURBSContour> run(model);
  run.F->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "Temperature");
  run.F->SetValue(0, -0.1);
  run.F->SetValue(1, 0.2);
  vtkPolyData* mesh = run.Update();
  ASSERT_GT(mesh->GetNumberOfCells(), 0);
  ExpectPromisedArrays(mesh);
  ExpectExact(mesh, model);
  for (vtkIdType c = 0; c < mesh->GetNumberOfCells(); ++c)
  {
    const double value = run.F->GetValue(
      static_cast<int>(mesh->GetCellData()->GetArray("ContourIndex")->GetTuple1(c)));
    for (int k = 0; k < 3; ++k)
    {
      const vtkIdType v = mesh->GetCell(c)->GetPointId(k);
      EXPECT_NEAR(mesh->GetPointData()->GetArray("Temperature")->GetTuple1(v), value, 1e-13);
    }
  }
}

TEST(NURBSContour, ComponentsAndMagnitudesOfVectors)
{
  FilterRun<vtkNURBSContour> run(TwoTubes());
  run.F->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "Velocity");
  run.F->SetValue(0, 2.4);
  for (int component : { 0, 1, -1 })
  {
    run.F->SetComponent(component);
    vtkPolyData* mesh = run.Update();
    ASSERT_GT(mesh->GetNumberOfCells(), 0) << component;
    for (vtkIdType v = 0; v < mesh->GetNumberOfPoints(); ++v)
    {
      double velocity[3];
      mesh->GetPointData()->GetArray("Velocity")->GetTuple(v, velocity);
      const double value = component < 0 ? Eigen::Vector3d(velocity).norm() : velocity[component];
      EXPECT_NEAR(value, 2.4, 1e-13) << component;
    }
  }
  EXPECT_TRUE(run.Errors.empty());
}

TEST(NURBSContour, MistakesAreNamed)
{
  FilterRun<vtkNURBSContour> run(TwoTubes());
  run.F->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "Pressure");
  run.F->SetValue(0, 0.0);
  EXPECT_EQ(run.Update()->GetNumberOfPoints(), 0);
  ASSERT_GE(run.Errors.size(), 1u);
  EXPECT_NE(run.Errors[0].find("Pressure"), std::string::npos);
  EXPECT_NE(run.Errors[0].find("Temperature, Velocity"), std::string::npos);
  run.Errors.clear();
  run.F->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "Velocity");
  run.F->SetComponent(3);
  EXPECT_EQ(run.Update()->GetNumberOfPoints(), 0);
  ASSERT_GE(run.Errors.size(), 1u);
  EXPECT_NE(run.Errors[0].find("component 3"), std::string::npos);
}

TEST(NURBSContour, ARangeThatMissesIsEmpty)
{
  FilterRun<vtkNURBSContour> run(TwoTubes());
  run.F->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "Temperature");
  run.F->SetValue(0, 77.0);
  EXPECT_EQ(run.Update()->GetNumberOfPoints(), 0);
  EXPECT_TRUE(run.Errors.empty());
}

TEST(NURBSJacobianBoundary, SheetOfJoyAndDuchaineausFigureOneIsAFlatRectangle)
{
  FilterRun<vtkNURBSJacobianBoundary> run(Alone(models::SweptHalfCylinder()));
  vtkPolyData* mesh = run.Update();
  std::set<int> pieces;
  Eigen::AlignedBox<double, 3> sheet;
  for (vtkIdType c = 0; c < mesh->GetNumberOfCells(); ++c)
  {
    const int piece = static_cast<int>(mesh->GetCellData()->GetArray("Piece")->GetTuple1(c));
    pieces.insert(piece);
    for (int k = 0; k < 3 && piece == vtkNURBSJacobianBoundary::SHEET; ++k)
    {
      sheet.extend(Eigen::Vector3d(mesh->GetPoint(mesh->GetCell(c)->GetPointId(k))));
    }
  }
  EXPECT_EQ(pieces, (std::set<int>{ 0, 1, 2, 3, 4, 5, vtkNURBSJacobianBoundary::SHEET }));
  EXPECT_NEAR((sheet.min() - Eigen::Vector3d(0, 1, 0)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((sheet.max() - Eigen::Vector3d(3, 1, 1)).norm(), 0.0, 1e-12);
  run.F->FacesOff();
  const vtkIdType alone = run.Update()->GetNumberOfCells();
  EXPECT_GT(alone, 0);
  run.F->SheetOff();
  EXPECT_EQ(run.Update()->GetNumberOfCells(), 0);
}

TEST(NURBSJacobianBoundary, AC0KnotPlaneDividesTheSheet)
{
  // Two halves, |u - 1/2| wide on top: det J is linear in each half and jumps at u = 1/2.
  const KnotVector u(1, { 0, 0, 0.5, 1, 1 });
  const KnotVector v = KnotVector::Uniform(2, 3);
  Eigen::MatrixXd points(3, 18);
  for (int k = 0, n = 0; k < 2; ++k)
  {
    for (int j = 0; j < 3; ++j)
    {
      for (int i = 0; i < 3; ++i, ++n)
      {
        // y = v - v^2, so det J changes sign at v = 1/2; the slope along u differs in both halves.
        points.col(n) << (i < 2 ? i * 0.5 : 2.5), 0.5 * (j == 1), k;
      }
    }
  }
  FilterRun<vtkNURBSJacobianBoundary> run(
    Alone(Spline({ u, v, KnotVector::Uniform(1, 2) }, points)));
  run.F->FacesOff();
  vtkPolyData* mesh = run.Update();
  ASSERT_GT(mesh->GetNumberOfCells(), 1);
  Eigen::AlignedBox<double, 3> sheet;
  for (vtkIdType p = 0; p < mesh->GetNumberOfPoints(); ++p)
  {
    EXPECT_NEAR(mesh->GetPoint(p)[1], 0.25, 1e-14);
    sheet.extend(Eigen::Vector3d(mesh->GetPoint(p)));
  }
  EXPECT_NEAR(sheet.max()[0] - sheet.min()[0], 2.5, 1e-14);
}

TEST(NURBSJacobianBoundary, SurfacesAreLeftOutWithAWarning)
{
  MultiPatch model = Alone(models::QuarterTube());
  std::mt19937 random(1);
  model.Patches.push_back({ 1,
    Aggregate(models::RandomSpline(
      random, { KnotVector::Uniform(2, 4), KnotVector::Uniform(2, 4), KnotVector() }, 3, false)) });
  FilterRun<vtkNURBSJacobianBoundary> run(model);
  EXPECT_GT(run.Update()->GetNumberOfCells(), 0);
  ASSERT_EQ(run.Warnings.size(), 1u);
  EXPECT_NE(run.Warnings[0].find("1 patches"), std::string::npos);
}

TEST(NURBSTessellate, SurfaceIsClosedWithOutwardNormalsAndTheRightVolume)
{
  FilterRun<vtkNURBSTessellate> run(Alone(models::QuarterTube()));
  vtkPolyData* mesh = run.Update();
  vtkNew<vtkMassProperties> mass;
  mass->SetInputData(mesh);
  mass->Update();
  const double exact = std::acos(-1.0) / 4 * 3.0;
  // Chord error times area: 1e-3 of the diagonal 3, curved area about 5.
  EXPECT_NEAR(mass->GetVolume(), exact, 3e-3 * 5);
  for (vtkIdType v = 0; v < mesh->GetNumberOfPoints(); ++v)
  {
    double p[3];
    double n[3];
    mesh->GetPointData()->GetArray("ParametricCoordinates")->GetTuple(v, p);
    mesh->GetPointData()->GetArray("Normals")->GetTuple(v, n);
    EXPECT_TRUE(p[0] == 0 || p[0] == 1 || p[1] == 0 || p[1] == 1 || p[2] == 0 || p[2] == 1);
    EXPECT_NEAR(Eigen::Vector3d(n).norm(), 1.0, 1e-13);
  }
}

TEST(NURBSTessellate, SolidIsMadeOfHexahedraAndCarriesEverything)
{
  FilterRun<vtkNURBSTessellate> run(TwoTubes());
  run.F->SetMeshTypeToSolid();
  run.F->Update();
  auto* grid = vtkUnstructuredGrid::SafeDownCast(run.F->GetOutputDataObject(0));
  ASSERT_NE(grid, nullptr);
  ASSERT_GT(grid->GetNumberOfCells(), 0);
  for (vtkIdType c = 0; c < grid->GetNumberOfCells(); ++c)
  {
    EXPECT_EQ(grid->GetCellType(c), VTK_HEXAHEDRON);
  }
  EXPECT_NE(grid->GetPointData()->GetArray("Temperature"), nullptr);
  EXPECT_NE(grid->GetCellData()->GetArray("ElementId"), nullptr);
  run.F->SetMeshTypeToSurface();
  EXPECT_NE(vtkPolyData::SafeDownCast((run.F->Update(), run.F->GetOutputDataObject(0))), nullptr);
}

TEST(NURBSTessellate, KnotLinesAreLines)
{
  FilterRun<vtkNURBSTessellate> run(TwoTubes());
  run.F->KnotLinesOn();
  vtkPolyData* mesh = run.Update();
  EXPECT_GT(mesh->GetNumberOfLines(), 0);
  EXPECT_EQ(mesh->GetCellData()->GetArray("Side")->GetNumberOfTuples(), mesh->GetNumberOfCells());
  ExpectPromisedArrays(mesh);
  ExpectExact(mesh, TwoTubes());
}

TEST(Filters, ThreadsDoNotChangeTheResult)
{
  const MultiPatch model = TwoTubes();
  const auto runAll = [&model]
  {
    std::vector<vtkSmartPointer<vtkPolyData>> results;
    const auto keep = [&results](vtkPolyData* mesh)
    {
      results.push_back(vtkSmartPointer<vtkPolyData>::New());
      results.back()->DeepCopy(mesh);
    };
    FilterRun<vtkNURBSTessellate> tessellate(model);
    keep(tessellate.Update());
    FilterRun<vtkNURBSSlice> slice(model);
    vtkNew<vtkPlane> plane;
    plane->SetOrigin(0, 0, 0.4);
    plane->SetNormal(0.3, 0.2, 1);
    slice.F->SetSliceFunction(plane);
    keep(slice.Update());
    FilterRun<vtkNURBSContour> contour(model);
    contour.F->SetInputArrayToProcess(
      0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "Temperature");
    contour.F->SetValue(0, 0.05);
    keep(contour.Update());
    FilterRun<vtkNURBSJacobianBoundary> boundary(model);
    keep(boundary.Update());
    return results;
  };
  // A backend that the user chose is left alone by the filters.
  setenv("VTK_SMP_BACKEND_IN_USE", "STDThread", 1);
  std::vector<vtkSmartPointer<vtkPolyData>> one;
  std::vector<vtkSmartPointer<vtkPolyData>> two;
  vtkSMPTools::LocalScope(
    vtkSMPTools::Config{ 1, "STDThread", false }, [&one, &runAll] { one = runAll(); });
  vtkSMPTools::LocalScope(
    vtkSMPTools::Config{ 2, "STDThread", false }, [&two, &runAll] { two = runAll(); });
  unsetenv("VTK_SMP_BACKEND_IN_USE");
  ASSERT_EQ(one.size(), two.size());
  for (std::size_t i = 0; i < one.size(); ++i)
  {
    ASSERT_EQ(one[i]->GetNumberOfPoints(), two[i]->GetNumberOfPoints());
    ASSERT_EQ(one[i]->GetNumberOfCells(), two[i]->GetNumberOfCells());
    for (vtkIdType p = 0; p < one[i]->GetNumberOfPoints(); ++p)
    {
      EXPECT_EQ(Eigen::Vector3d(one[i]->GetPoint(p)), Eigen::Vector3d(two[i]->GetPoint(p)));
    }
    for (vtkIdType c = 0; c < one[i]->GetNumberOfCells(); ++c)
    {
      for (vtkIdType k = 0; k < one[i]->GetCell(c)->GetNumberOfPoints(); ++k)
      {
        EXPECT_EQ(one[i]->GetCell(c)->GetPointId(static_cast<int>(k)),
          two[i]->GetCell(c)->GetPointId(static_cast<int>(k)));
      }
    }
  }
}

TEST(Filters, ProgressGrowsToOneAndAbortEmptiesTheOutput)
{
  const MultiPatch model = TwoTubes();
  FilterRun<vtkNURBSContour> run(model);
  run.F->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "Temperature");
  run.F->SetValue(0, 0.05);
  struct Watch
  {
    std::vector<double> Progress;
    bool Abort = false;
  } watch;
  vtkNew<vtkCallbackCommand> observer;
  observer->SetClientData(&watch);
  observer->SetCallback(
    [](vtkObject* caller, unsigned long, void* data, void* progress)
    {
      auto* w = static_cast<Watch*>(data);
      w->Progress.push_back(*static_cast<double*>(progress));
      if (w->Abort)
      {
        static_cast<vtkAlgorithm*>(caller)->SetAbortExecuteAndUpdateTime();
      }
    });
  run.F->AddObserver(vtkCommand::ProgressEvent, observer);
  EXPECT_GT(run.Update()->GetNumberOfCells(), 0);
  ASSERT_GT(watch.Progress.size(), 3u);
  EXPECT_TRUE(std::is_sorted(watch.Progress.begin(), watch.Progress.end()));
  EXPECT_EQ(watch.Progress.back(), 1.0);
  watch.Abort = true;
  run.F->Modified();
  EXPECT_EQ(run.Update()->GetNumberOfCells(), 0);
}

TEST(Filters, PiecesGiveTheSurfaceOfTheWhole)
{
  // Tessellation decides by what each element's face is made of: pieces need no word of each other.
  std::mt19937 random(9);
  const KnotVector k = KnotVector::Uniform(2, 6);
  Eigen::MatrixXd points(3, 216);
  std::uniform_real_distribution<double> noise(-0.05, 0.05);
  for (int i = 0; i < 216; ++i)
  {
    points.col(i) << k.Greville(i % 6) + noise(random), k.Greville(i / 6 % 6) + noise(random),
      k.Greville(i / 36) + noise(random);
  }
  const MultiPatch model = Alone(Spline({ k, k, k }, points));
  // The tolerance is relative to the model; pieces on one process do not see the others.
  const auto corners = [](vtkPolyData* mesh, std::multiset<std::vector<long>>& triangles)
  {
    for (vtkIdType c = 0; c < mesh->GetNumberOfCells(); ++c)
    {
      std::vector<long> triangle;
      for (int v = 0; v < 3; ++v)
      {
        for (double x : Eigen::Vector3d(mesh->GetPoint(mesh->GetCell(c)->GetPointId(v))))
        {
          triangle.push_back(std::lround(x * 1e9));
        }
      }
      triangles.insert(triangle);
    }
  };
  FilterRun<vtkNURBSTessellate> whole(model);
  std::multiset<std::vector<long>> expected;
  corners(whole.Update(), expected);
  const Bounds all = ControlPointBounds(model);
  const double diagonal =
    (Eigen::Vector3d(all.High.data()) - Eigen::Vector3d(all.Low.data())).norm();
  std::multiset<std::vector<long>> found;
  for (int piece = 0; piece < 3; ++piece)
  {
    const MultiPatch part = ExtractPiece(model, piece, 3);
    const Bounds own = ControlPointBounds(part);
    FilterRun<vtkNURBSTessellate> run(part);
    run.F->SetTolerance(1e-3 * diagonal /
      (Eigen::Vector3d(own.High.data()) - Eigen::Vector3d(own.Low.data())).norm());
    corners(run.Update(), found);
  }
  EXPECT_EQ(found, expected);
}
