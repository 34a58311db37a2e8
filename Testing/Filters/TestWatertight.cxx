// SPDX-License-Identifier: BSD-3-Clause
#include "NURBSConversion.h"
#include "Operators.h"
#include "Primitives.h"
#include "vtkNURBSContour.h"
#include "vtkNURBSJacobianBoundary.h"
#include "vtkNURBSSlice.h"

#include "vtkBezierHexahedron.h"
#include "vtkCell.h"
#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkHigherOrderHexahedron.h"
#include "vtkMassProperties.h"
#include "vtkNew.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkPlane.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSMPTools.h"
#include "vtkSphere.h"
#include "vtkUnstructuredGrid.h"

#include <gtest/gtest.h>

#include <array>
#include <map>
#include <set>
#include <vector>

using namespace hyperpatch;

namespace
{

constexpr double Pi = 3.14159265358979323846;

using Point = std::array<double, 3>;

/// What is left of a surface's edges when points of the same bits are one.
struct Topology
{
  long Open = 0;
  long Twice = 0; ///< edges used more than once in one direction
  long Euler = 0;
  std::size_t Points = 0;
};

Topology Inspect(vtkPolyData* mesh)
{
  std::map<Point, vtkIdType> numbers;
  std::vector<vtkIdType> numberOf;
  for (vtkIdType v = 0; v < mesh->GetNumberOfPoints(); ++v)
  {
    Point x{};
    mesh->GetPoint(v, x.data());
    numberOf.push_back(
      numbers.try_emplace(x, static_cast<vtkIdType>(numbers.size())).first->second);
  }
  std::map<std::pair<vtkIdType, vtkIdType>, int> edges;
  for (vtkIdType c = 0; c < mesh->GetNumberOfCells(); ++c)
  {
    vtkCell* cell = mesh->GetCell(c);
    for (int k = 0; k < 3; ++k)
    {
      ++edges[{ numberOf[static_cast<std::size_t>(cell->GetPointId(k))],
        numberOf[static_cast<std::size_t>(cell->GetPointId((k + 1) % 3))] }];
    }
  }
  Topology topology;
  topology.Points = numbers.size();
  long undirected = 0;
  for (const auto& [edge, count] : edges)
  {
    const bool isOpen = edges.count({ edge.second, edge.first }) == 0;
    topology.Open += isOpen ? 1 : 0;
    topology.Twice += count > 1 ? 1 : 0;
    undirected += isOpen || edge.first < edge.second ? 1 : 0;
  }
  topology.Euler =
    static_cast<long>(numbers.size()) - undirected + static_cast<long>(mesh->GetNumberOfCells());
  return topology;
}

double FieldNumber(vtkDataObject* data, const char* name)
{
  return data->GetFieldData()->GetArray(name)->GetTuple1(0);
}

void ExpectNoCrack(vtkPolyData* mesh)
{
  const Topology topology = Inspect(mesh);
  EXPECT_EQ(FieldNumber(mesh, "OpenEdgesInside"), 0);
  EXPECT_EQ(FieldNumber(mesh, "OpenEdgesOnInterfaces"), 0);
  EXPECT_EQ(FieldNumber(mesh, "OpenEdgesOnBoundary"), topology.Open);
  EXPECT_EQ(topology.Twice, 0);
}

/// A ball of seven patches with x + z / 2 as an attribute.
MultiPatch Ball()
{
  MultiPatch model = MakeSphere(1.0, Parametrisation::Patches);
  for (Patch& patch : model.Patches)
  {
    const Spline& g = patch.Body.Geometry();
    Eigen::MatrixXd height = g.Coefficients().row(0) + 0.5 * g.Coefficients().row(2);
    patch.Body = Aggregate(g, { { "Height", Spline(g.Knots(), height, g.Weights()) } });
  }
  return model;
}

template <typename Filter>
struct Pipeline
{
  explicit Pipeline(const MultiPatch& model)
  {
    ToVTK(model, this->Input);
    this->F->SetInputDataObject(this->Input);
  }
  vtkPolyData* Update()
  {
    this->F->Update();
    return vtkPolyData::SafeDownCast(this->F->GetOutputDataObject(0));
  }
  vtkNew<vtkPartitionedDataSetCollection> Input;
  vtkNew<Filter> F;
};

}

TEST(Watertight, ASphereInSevenPatchesIsClosedAndItsPointsCanBeMerged)
{
  Pipeline<vtkNURBSSlice> run(Ball());
  vtkNew<vtkSphere> sphere;
  sphere->SetCenter(0.1, 0.05, 0.02);
  sphere->SetRadius(0.6);
  run.F->SetSliceFunction(sphere);
  run.F->SetTolerance(1e-3);
  vtkPolyData* mesh = run.Update();
  ExpectNoCrack(mesh);
  Topology topology = Inspect(mesh);
  EXPECT_EQ(topology.Open, 0);
  EXPECT_EQ(topology.Euler, 2);
  const auto apart = static_cast<std::size_t>(mesh->GetNumberOfPoints());
  const vtkIdType cells = mesh->GetNumberOfCells();
  EXPECT_GT(apart, topology.Points);

  run.F->MergePointsOn();
  mesh = run.Update();
  EXPECT_EQ(static_cast<std::size_t>(mesh->GetNumberOfPoints()), topology.Points);
  EXPECT_EQ(mesh->GetNumberOfCells(), cells);
  EXPECT_EQ(mesh->GetCellData()->GetArray("PatchId")->GetNumberOfTuples(), cells);
  for (vtkIdType v = 0; v < mesh->GetNumberOfPoints(); ++v)
  {
    double x[3];
    mesh->GetPoint(v, x);
    double n[3];
    mesh->GetPointData()->GetNormals()->GetTuple(v, n);
    EXPECT_NEAR(n[0] * (x[0] - 0.1) + n[1] * (x[1] - 0.05) + n[2] * (x[2] - 0.02), 0.6, 1e-9);
    EXPECT_NEAR(mesh->GetPointData()->GetArray("Height")->GetTuple1(v), x[0] + 0.5 * x[2], 1e-12);
  }
  vtkNew<vtkMassProperties> mass;
  mass->SetInputData(mesh);
  // All chords are inside: less, by at most the tolerance of 1e-3 sqrt(12) times the area.
  const double exact = 4.0 / 3.0 * Pi * 0.216;
  EXPECT_LT(mass->GetVolume(), exact);
  EXPECT_NEAR(mass->GetVolume(), exact, 1e-3 * std::sqrt(12.0) * 4.0 * Pi * 0.36);
}

TEST(Watertight, IsosurfacesCloseOnlyWhereTheirAttributeAgrees)
{
  MultiPatch model = Ball();
  {
    Pipeline<vtkNURBSContour> run(model);
    run.F->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "Height");
    run.F->SetValue(0, 0.1);
    vtkPolyData* mesh = run.Update();
    ExpectNoCrack(mesh);
    EXPECT_EQ(Inspect(mesh).Euler, 1);
  }
  // Another height in the patch in the middle, which all others surround.
  Patch& middle = model.Patches[0];
  const Spline& g = middle.Body.Geometry();
  const Spline& height = middle.Body.Attributes()[0].Field;
  middle.Body = Aggregate(g,
    { { "Height",
      Spline(height.Knots(), height.Coefficients().array() + 0.05, height.Weights()) } });
  Pipeline<vtkNURBSContour> run(model);
  run.F->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "Height");
  run.F->SetValue(0, 0.1);
  vtkPolyData* mesh = run.Update();
  EXPECT_GT(FieldNumber(mesh, "OpenEdgesOnInterfaces"), 0);
  EXPECT_EQ(FieldNumber(mesh, "OpenEdgesInside"), 0);
  EXPECT_EQ(FieldNumber(mesh, "OpenEdgesOnInterfaces") + FieldNumber(mesh, "OpenEdgesOnBoundary"),
    Inspect(mesh).Open);
}

TEST(Watertight, BezierCellsShareTheirSurface)
{
  // 2 x 2 x 2 biquadratic cells that share points, as another tool writes them.
  vtkNew<vtkUnstructuredGrid> grid;
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (int n = 0; n < 125; ++n)
  {
    const double u = 0.25 * (n % 5);
    const double v = 0.25 * (n / 5 % 5);
    const double w = 0.25 * (n / 25);
    points->InsertNextPoint(
      u + 0.05 * std::sin(5.0 * v), v + 0.05 * std::sin(4.0 * w), w + 0.05 * u * u);
  }
  grid->SetPoints(points);
  grid->Allocate(8);
  const int order[3] = { 2, 2, 2 };
  for (int c = 0; c < 8; ++c)
  {
    std::array<vtkIdType, 27> ids{};
    for (int n = 0; n < 27; ++n)
    {
      const int i = n % 3;
      const int j = n / 3 % 3;
      const int k = n / 9;
      ids[static_cast<std::size_t>(vtkHigherOrderHexahedron::PointIndexFromIJK(i, j, k, order))] =
        2 * (c % 2) + i + 5 * (2 * (c / 2 % 2) + j + 5 * (2 * (c / 4) + k));
    }
    grid->InsertNextCell(VTK_BEZIER_HEXAHEDRON, 27, ids.data());
  }
  vtkNew<vtkNURBSSlice> slice;
  slice->SetInputDataObject(grid);
  vtkNew<vtkSphere> sphere;
  sphere->SetCenter(0.52, 0.5, 0.55);
  sphere->SetRadius(0.3);
  slice->SetSliceFunction(sphere);
  slice->Update();
  auto* mesh = vtkPolyData::SafeDownCast(slice->GetOutputDataObject(0));
  ExpectNoCrack(mesh);
  EXPECT_EQ(Inspect(mesh).Open, 0);
  EXPECT_EQ(Inspect(mesh).Euler, 2);
}

TEST(Watertight, ThreadsDoNotChangeTheSurface)
{
  const MultiPatch model = Ball();
  const auto draw = [&model](int threads)
  {
    std::vector<Point> points;
    vtkSMPTools::LocalScope(vtkSMPTools::Config{ threads, "STDThread", false },
      [&]
      {
        Pipeline<vtkNURBSContour> run(model);
        run.F->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "Height");
        run.F->SetValue(0, 0.1);
        run.F->SetValue(1, -0.3);
        vtkPolyData* mesh = run.Update();
        for (vtkIdType c = 0; c < mesh->GetNumberOfCells(); ++c)
        {
          for (int k = 0; k < 3; ++k)
          {
            points.emplace_back();
            mesh->GetPoint(mesh->GetCell(c)->GetPointId(k), points.back().data());
          }
        }
      });
    return points;
  };
  const std::vector<Point> one = draw(1);
  EXPECT_FALSE(one.empty());
  EXPECT_EQ(one, draw(3));
}

TEST(Watertight, SheetsOfDetJKeepTheirPointsPerSideUnlessMerged)
{
  // A cubic that folds at two places in u, with a C0 knot in v that the sheets cross.
  const KnotVector u = KnotVector::Uniform(3, 4);
  const KnotVector v(2, { 0, 0, 0, 0.5, 0.5, 1, 1, 1 });
  const KnotVector w = KnotVector::Uniform(1, 2);
  Eigen::MatrixXd points(3, 40);
  const double x[4] = { 0.0, 1.6, -0.6, 1.0 };
  for (int i = 0; i < 40; ++i)
  {
    points.col(i) << x[i % 4], v.Greville(i / 4 % 5), i / 20;
  }
  MultiPatch model;
  model.Patches.push_back({ 0, Aggregate(Spline({ u, v, w }, points)) });
  Pipeline<vtkNURBSJacobianBoundary> run(model);
  run.F->FacesOff();
  const vtkIdType apart = run.Update()->GetNumberOfPoints();
  run.F->MergePointsOn();
  EXPECT_GT(run.Update()->GetNumberOfCells(), 0);
  EXPECT_LT(run.Update()->GetNumberOfPoints(), apart);
}
