// SPDX-License-Identifier: BSD-3-Clause
#include "JacobianField.h"
#include "Models.h"
#include "NURBSConversion.h"
#include "Operators.h"
#include "vtkNURBSJacobianBoundary.h"

#include "vtkCallbackCommand.h"
#include "vtkCellData.h"
#include "vtkCommand.h"
#include "vtkFieldData.h"
#include "vtkIdList.h"
#include "vtkNew.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkStructuredGrid.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <string>
#include <vector>

using namespace hyperpatch;

namespace
{

using Fold = vtkNURBSJacobianBoundary;

MultiPatch Alone(const Spline& geometry, std::vector<Attribute> attributes = {})
{
  MultiPatch model;
  model.Patches.push_back({ 4, Aggregate(geometry, std::move(attributes)) });
  return model;
}

/// The filter on a model, and what it says.
struct FilterRun
{
  explicit FilterRun(const MultiPatch& model)
  {
    ToVTK(model, this->Input);
    this->Filter->SetInputDataObject(this->Input);
    vtkNew<vtkCallbackCommand> listener;
    listener->SetClientData(this);
    listener->SetCallback([](vtkObject*, unsigned long, void* self, void* text)
      { static_cast<FilterRun*>(self)->Said.emplace_back(static_cast<const char*>(text)); });
    this->Filter->AddObserver(vtkCommand::ErrorEvent, listener);
    this->Filter->AddObserver(vtkCommand::WarningEvent, listener);
  }

  vtkPolyData* Update()
  {
    this->Filter->Update();
    return vtkPolyData::SafeDownCast(this->Filter->GetOutputDataObject(0));
  }

  vtkNew<vtkPartitionedDataSetCollection> Input;
  vtkNew<Fold> Filter;
  std::vector<std::string> Said;
};

int CellNumber(vtkPolyData* mesh, const char* name, vtkIdType cell)
{
  return static_cast<int>(mesh->GetCellData()->GetArray(name)->GetComponent(cell, 0));
}

double PointNumber(vtkPolyData* mesh, const char* name, vtkIdType point)
{
  return mesh->GetPointData()->GetArray(name)->GetComponent(point, 0);
}

double FieldNumber(vtkPolyData* mesh, const char* name)
{
  return mesh->GetFieldData()->GetArray(name)->GetComponent(0, 0);
}

std::vector<vtkIdType> PointsOf(vtkPolyData* mesh, vtkIdType cell)
{
  vtkNew<vtkIdList> ids;
  mesh->GetCellPoints(cell, ids);
  return { ids->begin(), ids->end() };
}

Eigen::Vector3d Point(vtkPolyData* mesh, vtkIdType point)
{
  return Eigen::Vector3d(mesh->GetPoint(point));
}

double Area(vtkPolyData* mesh, int piece)
{
  double area = 0.0;
  for (vtkIdType c = 0; c < mesh->GetNumberOfCells(); ++c)
  {
    const std::vector<vtkIdType> p = PointsOf(mesh, c);
    if (CellNumber(mesh, "Piece", c) == piece && p.size() == 3)
    {
      const Eigen::Vector3d a = Point(mesh, p[0]);
      area += 0.5 * (Point(mesh, p[1]) - a).cross(Point(mesh, p[2]) - a).norm();
    }
  }
  return area;
}

std::set<int> Values(vtkPolyData* mesh, const char* name)
{
  std::set<int> values;
  for (vtkIdType c = 0; c < mesh->GetNumberOfCells(); ++c)
  {
    values.insert(CellNumber(mesh, name, c));
  }
  return values;
}

/// Joy & Duchaineau's Figure 1 with the half circle as two quadratic arcs, which meet in a double
/// knot at u = 1/2.
Spline SweptTwoArcs()
{
  const double r = std::sqrt(0.5);
  const double arcs[5][3] = { { 1, 0, 1 }, { 1, 1, r }, { 0, 1, 1 }, { -1, 1, r }, { -1, 0, 1 } };
  Eigen::MatrixXd points(3, 20);
  Eigen::VectorXd weights(20);
  for (int n = 0; n < 20; ++n)
  {
    points.col(n) << arcs[n % 5][0] + 3.0 * (n / 10), arcs[n % 5][1], n / 5 % 2;
    weights[n] = arcs[n % 5][2];
  }
  return Spline({ KnotVector(2, { 0, 0, 0, 0.5, 0.5, 1, 1, 1 }), KnotVector::Uniform(1, 2),
                  KnotVector::Uniform(1, 2) },
    points, weights);
}

/// x = 2 u up to u = 1/2 and turns back where (v, w) is in the circle of radius 0.3 around the
/// middle; y = v, z = w. So det J is 2 below the knot plane, and above it the polynomial of the
/// circle, everywhere.
Spline Dent(int pieces)
{
  const double square[3] = { 0.25, -0.25, 0.25 };
  Eigen::MatrixXd points(3, 27);
  for (int i = 0; i < 27; ++i)
  {
    const int u = i % 3;
    const double slope = square[i / 3 % 3] + square[i / 9] - 0.09;
    points.col(i) << (u == 0 ? 0.0
        : u == 1             ? 1.0
                             : 1.0 + 0.5 * slope),
      i / 3 % 3 / 2.0, i / 9 / 2.0;
  }
  const KnotVector k = KnotVector::Uniform(2, 3);
  const Spline s({ KnotVector(1, { 0, 0, 0.5, 1, 1 }), k, k }, points);
  return RefineUniformly(s, { 1, pieces, pieces });
}

/// x goes forth, back and forth again with u: two sheets.
Spline Zigzag()
{
  Eigen::MatrixXd points(3, 16);
  const double x[4] = { 0.0, 2.0, -1.0, 1.0 };
  for (int i = 0; i < 16; ++i)
  {
    points.col(i) << x[i % 4], i / 4 % 2, i / 8;
  }
  return Spline(
    { KnotVector::Uniform(3, 4), KnotVector::Uniform(1, 2), KnotVector::Uniform(1, 2) }, points);
}

Spline Mirrored(const Spline& s)
{
  Eigen::MatrixXd points = s.Coefficients();
  points.row(2) = -points.row(2);
  return Spline(s.Knots(), points, s.Weights());
}

void ExpectFigureOne(vtkPolyData* mesh)
{
  Eigen::AlignedBox<double, 3> box;
  for (vtkIdType c = 0; c < mesh->GetNumberOfCells(); ++c)
  {
    for (const vtkIdType p : PointsOf(mesh, c))
    {
      if (CellNumber(mesh, "Piece", c) == Fold::SHEET)
      {
        EXPECT_NEAR(Point(mesh, p)[1], 1.0, 1e-12);
        EXPECT_NEAR(PointNumber(mesh, "JacobianDeterminant", p), 0.0, 1e-12);
        box.extend(Point(mesh, p));
      }
    }
  }
  ASSERT_FALSE(box.isEmpty());
  EXPECT_LT((box.min() - Eigen::Vector3d(0, 1, 0)).norm(), 1e-12);
  EXPECT_LT((box.max() - Eigen::Vector3d(3, 1, 1)).norm(), 1e-12);
  EXPECT_NEAR(Area(mesh, Fold::SHEET), 3.0, 1e-12);
  EXPECT_EQ(Values(mesh, "Piece"), (std::set<int>{ 0, 1, 2, 3, 4, 5, Fold::SHEET }));
  EXPECT_EQ(Values(mesh, "PieceId"), (std::set<int>{ 0, 1, 2, 3, 4, 5, 6 }));
}

}

TEST(JacobianBoundary, OfFigureOneHasTheRectangleAsItsSheet)
{
  for (const double tolerance : { 1e-2, 1e-4 })
  {
    FilterRun run(Alone(models::SweptHalfCylinder()));
    run.Filter->SetTolerance(tolerance);
    ExpectFigureOne(run.Update());
    EXPECT_EQ(FieldNumber(run.Update(), "UndecidedCells"), 0.0);
    EXPECT_TRUE(run.Said.empty());
  }
}

TEST(JacobianBoundary, OfFigureOneAsTwoArcsIsTheSame)
{
  FilterRun run(Alone(SweptTwoArcs()));
  ExpectFigureOne(run.Update());
  EXPECT_TRUE(run.Said.empty());
}

TEST(JacobianBoundary, HasThePartsOfKnotPlanesWhereTheSignJumps)
{
  for (const bool mirrored : { false, true })
  {
    const Spline dent = mirrored ? Mirrored(Dent(2)) : Dent(2);
    // w is an attribute in a basis of its own.
    Eigen::MatrixXd values(1, 2);
    values << 0.0, 1.0;
    FilterRun run(Alone(dent,
      { { "Height",
        Spline(
          { KnotVector::Uniform(1, 2, 0, 1), KnotVector::Uniform(1, 2), KnotVector::Uniform(1, 2) },
          []
          {
            Eigen::MatrixXd c(1, 8);
            c << 0, 0, 0, 0, 1, 1, 1, 1;
            return c;
          }()) } }));
    run.Filter->SetTolerance(1e-4);
    vtkPolyData* mesh = run.Update();
    EXPECT_NEAR(Area(mesh, Fold::KNOT_PLANE), std::acos(-1.0) * 0.09, 1e-3);
    EXPECT_LE(FieldNumber(mesh, "LargestError"), 1e-4 * 2.0);
    std::map<std::array<double, 3>, int> border;
    for (vtkIdType c = 0; c < mesh->GetNumberOfCells(); ++c)
    {
      for (const vtkIdType p : PointsOf(mesh, c))
      {
        const Eigen::Vector3d at = Point(mesh, p);
        const double z = mirrored ? -at[2] : at[2];
        const double r = std::hypot(at[1] - 0.5, z - 0.5);
        if (CellNumber(mesh, "Piece", c) == Fold::KNOT_PLANE)
        {
          ASSERT_NEAR(at[0], 1.0, 1e-15);
          ASSERT_LT(r, 0.3 + 1e-12);
          ASSERT_EQ(PointNumber(mesh, "JacobianDeterminant", p), 0.0);
          ASSERT_NEAR(PointNumber(mesh, "Height", p), z, 1e-14);
          // Where det J grows: 2 below the plane and negative above it, or the other way round.
          ASSERT_NEAR(
            mesh->GetPointData()->GetNormals()->GetComponent(p, 0), mirrored ? 1.0 : -1.0, 1e-12);
        }
        // det J does not depend on u above the plane: the sheet is the cylinder over the circle.
        if (CellNumber(mesh, "Piece", c) == Fold::SHEET)
        {
          ASSERT_NEAR(r, 0.3, 1e-12);
          ASSERT_NEAR(at[0], 1.0, 1e-12);
        }
      }
    }
    const std::set<int> pieces = Values(mesh, "Piece");
    EXPECT_EQ(pieces.count(Fold::KNOT_PLANE), 1u);
    EXPECT_EQ(Values(mesh, "PieceId").size(), pieces.size());
    run.Filter->KnotPlanesOff();
    EXPECT_EQ(Values(run.Update(), "Piece").count(Fold::KNOT_PLANE), 0u);
  }
}

TEST(JacobianBoundary, NumbersConnectedPieces)
{
  MultiPatch model = Alone(Zigzag());
  model.Patches.push_back({ 2, Aggregate(models::SweptHalfCylinder()) });
  FilterRun run(model);
  vtkPolyData* mesh = run.Update();
  // 6 faces and one sheet of patch 2, then 6 faces and two sheets of patch 4.
  std::map<int, std::set<std::array<int, 2>>> found;
  for (vtkIdType c = 0; c < mesh->GetNumberOfCells(); ++c)
  {
    found[CellNumber(mesh, "PieceId", c)].insert(
      { CellNumber(mesh, "PatchId", c), CellNumber(mesh, "Piece", c) });
  }
  ASSERT_EQ(found.size(), 15u);
  for (int id = 0; id < 15; ++id)
  {
    const std::array<int, 2> expected{ id < 7 ? 2 : 4,
      id < 7 ? (id == 6 ? int{ Fold::SHEET } : id) : (id < 13 ? id - 7 : int{ Fold::SHEET }) };
    EXPECT_EQ(found[id], (std::set<std::array<int, 2>>{ expected })) << id;
  }
  // The two sheets by their least u.
  std::array<double, 2> largest{ 0.0, 0.0 };
  for (vtkIdType c = 0; c < mesh->GetNumberOfCells(); ++c)
  {
    const int id = CellNumber(mesh, "PieceId", c);
    for (const vtkIdType p : PointsOf(mesh, c))
    {
      if (id >= 13)
      {
        double& u = largest[static_cast<std::size_t>(id - 13)];
        u = std::max(u, PointNumber(mesh, "ParametricCoordinates", p));
      }
    }
  }
  EXPECT_LT(largest[0], 0.5);
  EXPECT_GT(largest[1], 0.5);
}

// The sheet is watertight: its border is on faces and knot planes, and there it is as near to the
// mesh of the face as the tolerance says.
TEST(JacobianBoundary, HasSheetsThatEndOnFaces)
{
  std::mt19937 random(7);
  std::uniform_real_distribution<double> move(-1.3, 1.3);
  Eigen::MatrixXd points(3, 125);
  for (int i = 0; i < 125; ++i)
  {
    points.col(i) << i % 5 + move(random), i / 5 % 5 + move(random), i / 25 + move(random);
  }
  const KnotVector k = KnotVector::Uniform(3, 5);
  FilterRun run(Alone(Spline({ k, k, k }, points)));
  constexpr double Tolerance = 5e-3;
  run.Filter->SetTolerance(Tolerance);
  vtkPolyData* mesh = run.Update();
  const double allowed =
    Tolerance * (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
  std::map<std::array<vtkIdType, 2>, int> uses;
  std::array<std::vector<vtkIdType>, 6> faces;
  for (vtkIdType c = 0; c < mesh->GetNumberOfCells(); ++c)
  {
    const std::vector<vtkIdType> p = PointsOf(mesh, c);
    const int piece = CellNumber(mesh, "Piece", c);
    if (piece < Fold::KNOT_PLANE)
    {
      faces[static_cast<std::size_t>(piece)].push_back(c);
    }
    for (std::size_t i = 0; i < 3 && piece == Fold::SHEET; ++i)
    {
      ++uses[{ std::min(p[i], p[(i + 1) % 3]), std::max(p[i], p[(i + 1) % 3]) }];
    }
  }
  int border = 0;
  for (const auto& [edge, count] : uses)
  {
    ASSERT_LE(count, 2);
    if (count == 2)
    {
      continue;
    }
    std::array<double, 3> a{};
    std::array<double, 3> b{};
    mesh->GetPointData()->GetArray("ParametricCoordinates")->GetTuple(edge[0], a.data());
    mesh->GetPointData()->GetArray("ParametricCoordinates")->GetTuple(edge[1], b.data());
    int side = -1;
    for (int s = 0; s < 6; ++s)
    {
      const auto d = static_cast<std::size_t>(s / 2);
      side = a[d] == s % 2 && b[d] == s % 2 ? s : side;
    }
    ASSERT_GE(side, 0) << "an open edge inside the volume";
    // The vertex is on the exact face, and the mesh of the face within the tolerance of it.
    const Eigen::Vector3d x = Point(mesh, edge[0]);
    double nearest = INFINITY;
    for (const vtkIdType c : faces[static_cast<std::size_t>(side)])
    {
      double closest[3];
      double parameters[3];
      double weights[3];
      double square = 0.0;
      int part = 0;
      mesh->GetCell(c)->EvaluatePosition(x.data(), closest, part, parameters, square, weights);
      nearest = std::min(nearest, std::sqrt(square));
    }
    EXPECT_LE(nearest, allowed);
    ++border;
  }
  EXPECT_GT(border, 10);
}

// det J is 0 all over a face that is collapsed to an axis, and over the face at the fold of half of
// Figure 1: sheets there would be those faces once more.
TEST(JacobianBoundary, HasNoSheetsInFaces)
{
  const Spline tube = models::QuarterTube();
  Eigen::MatrixXd points = tube.Coefficients();
  for (Eigen::Index i = 0; i < points.cols(); i += 2)
  {
    points.col(i).head(2).setZero();
  }
  const Spline half =
    RestrictToBox(models::SweptHalfCylinder(), { 0.0, 0.0, 0.0 }, { 0.5, 1.0, 1.0 });
  const Spline wedge(tube.Knots(), points, tube.Weights());
  for (const Spline& volume : { wedge, half })
  {
    FilterRun run(Alone(volume, { { "Field", volume } }));
    vtkPolyData* mesh = run.Update();
    // A face without area is not drawn.
    EXPECT_EQ(Values(mesh, "Piece"),
      volume == wedge ? (std::set<int>{ 1, 2, 3, 4, 5 }) : (std::set<int>{ 0, 1, 2, 3, 4, 5 }));
    EXPECT_EQ(FieldNumber(mesh, "UndecidedCells"), 0.0);
    ASSERT_NE(mesh->GetPointData()->GetArray("Field"), nullptr);
    EXPECT_EQ(
      mesh->GetPointData()->GetArray("Field")->GetNumberOfTuples(), mesh->GetNumberOfPoints());
    run.Filter->FacesOff();
    EXPECT_EQ(run.Update()->GetNumberOfCells(), 0);
    EXPECT_EQ(run.Said, std::vector<std::string>());
  }
}

TEST(JacobianBoundary, HasTheDeterminantAtItsPoints)
{
  FilterRun run(Alone(models::SweptHalfCylinder()));
  vtkPolyData* mesh = run.Update();
  const Spline geometry = models::SweptHalfCylinder();
  const JacobianField field(geometry);
  double least = 0.0;
  double greatest = 0.0;
  for (vtkIdType p = 0; p < mesh->GetNumberOfPoints(); ++p)
  {
    std::array<double, 3> at{};
    mesh->GetPointData()->GetArray("ParametricCoordinates")->GetTuple(p, at.data());
    double value = 0.0;
    field.Evaluate(1, at.data(), &value);
    ASSERT_EQ(PointNumber(mesh, "JacobianDeterminant", p), value);
    least = std::min(least, value);
    greatest = std::max(greatest, value);
  }
  // 3 times the vertical speed of the half circle, which is 2 at its ends and turns at the top.
  EXPECT_GE(greatest, 6.0 - 1e-12);
  EXPECT_NEAR(least, -greatest, 1e-12);
}

TEST(JacobianBoundary, ByJoyAndDuchaineauIsCountedAndNear)
{
  FilterRun run(Alone(models::SweptHalfCylinder()));
  run.Filter->SetMethod(Fold::JOY_DUCHAINEAU);
  run.Filter->SetMaximumCells(500);
  run.Filter->SetMinimumWidth(0.0);
  for (const int bounds : { Fold::CONES, Fold::CONES_THREE_ORDERS, Fold::BERNSTEIN })
  {
    run.Filter->SetIntervalsFrom(bounds);
    vtkPolyData* mesh = run.Update();
    EXPECT_EQ(FieldNumber(mesh, "Cells"), 500.0);
    EXPECT_GE(FieldNumber(mesh, "Tetrahedra"), 6000.0);
    EXPECT_EQ(FieldNumber(mesh, "OpenEdges"), 0.0);
    vtkDataArray* widths = mesh->GetFieldData()->GetArray("IntervalWidth");
    ASSERT_GT(widths->GetNumberOfTuples(), 100);
    EXPECT_LT(widths->GetComponent(widths->GetNumberOfTuples() - 1, 0), widths->GetComponent(0, 0));
    EXPECT_EQ(mesh->GetFieldData()
                ->GetArray("CellsInQueue")
                ->GetComponent(widths->GetNumberOfTuples() - 1, 0),
      500.0);
    EXPECT_NEAR(Area(mesh, Fold::SHEET), 3.0, 1e-2);
    EXPECT_EQ(Values(mesh, "PieceId").size(), 7u);
    EXPECT_TRUE(mesh->GetPointData()->GetNormals() != nullptr);
  }
  EXPECT_TRUE(run.Said.empty());
}

TEST(JacobianBoundary, ShowsTheCellsOfJoyAndDuchaineau)
{
  FilterRun run(Alone(models::SweptHalfCylinder()));
  run.Filter->SetMethod(Fold::JOY_DUCHAINEAU);
  run.Filter->SetMaximumCells(10);
  run.Filter->ShowCellsOn();
  run.Filter->FacesOff();
  vtkPolyData* mesh = run.Update();
  EXPECT_EQ(mesh->GetNumberOfLines(), 10 * 12 * 4);
  EXPECT_EQ(Values(mesh, "Piece"), (std::set<int>{ Fold::SHEET, Fold::CELLS }));
  EXPECT_EQ(Values(mesh, "PieceId"), (std::set<int>{ 0, 1 }));
  // Only there.
  run.Filter->SetMethod(Fold::CERTIFIED);
  EXPECT_EQ(run.Update()->GetNumberOfLines(), 0);
}

TEST(JacobianBoundary, ByJoyAndDuchaineauEndsAtKnotPlanes)
{
  FilterRun run(Alone(Dent(1)));
  run.Filter->SetMethod(Fold::JOY_DUCHAINEAU);
  run.Filter->SetMaximumCells(2000);
  run.Filter->SetMinimumWidth(0.0);
  vtkPolyData* mesh = run.Update();
  EXPECT_NEAR(Area(mesh, Fold::KNOT_PLANE), std::acos(-1.0) * 0.09, 1e-3);
  for (vtkIdType c = 0; c < mesh->GetNumberOfCells(); ++c)
  {
    for (const vtkIdType p : PointsOf(mesh, c))
    {
      if (CellNumber(mesh, "Piece", c) == Fold::SHEET)
      {
        ASSERT_NEAR(std::hypot(Point(mesh, p)[1] - 0.5, Point(mesh, p)[2] - 0.5), 0.3, 0.02);
      }
    }
  }
}

TEST(JacobianBoundary, ByJoyAndDuchaineauOfAPartIsAnError)
{
  const MultiPatch whole = Alone(RefineUniformly(models::SweptHalfCylinder(), { 2, 2, 2 }));
  FilterRun run(ExtractPiece(whole, 0, 2));
  run.Filter->SetMethod(Fold::JOY_DUCHAINEAU);
  EXPECT_EQ(run.Update()->GetNumberOfCells(), 0);
  ASSERT_EQ(run.Said.size(), 1u);
  EXPECT_NE(run.Said[0].find("split over several processes"), std::string::npos);
}

TEST(JacobianBoundary, OfWhatDoesNotFoldIsItsFaces)
{
  for (const int method : { Fold::CERTIFIED, Fold::JOY_DUCHAINEAU })
  {
    FilterRun run(Alone(models::QuarterTube()));
    run.Filter->SetMethod(method);
    EXPECT_EQ(Values(run.Update(), "Piece"), (std::set<int>{ 0, 1, 2, 3, 4, 5 }));
    run.Filter->FacesOff();
    vtkPolyData* mesh = run.Update();
    EXPECT_EQ(mesh->GetNumberOfCells(), 0);
    EXPECT_NE(mesh->GetCellData()->GetArray("PieceId"), nullptr);
    EXPECT_NE(mesh->GetPointData()->GetArray("JacobianDeterminant"), nullptr);
  }
}

// Patches of both handedness in one model: each one's boundary is that of its mirror image, normals
// of faces outward and those of sheets to growing det J, which the mirror turns round.
TEST(JacobianBoundary, OfMirroredPatchesIsTheMirrorImage)
{
  const Spline right = models::SweptHalfCylinder();
  Eigen::MatrixXd points = right.Coefficients();
  points.row(2) = -points.row(2).array() - 1.0;
  MultiPatch model = Alone(right);
  model.Patches.push_back({ 7, Aggregate(Spline(right.Knots(), points, right.Weights())) });
  for (const int method : { Fold::CERTIFIED, Fold::JOY_DUCHAINEAU })
  {
    FilterRun run(model);
    run.Filter->SetMethod(method);
    vtkPolyData* mesh = run.Update();
    std::map<int, std::map<int, double>> area;
    std::map<int, double> volume;
    for (vtkIdType c = 0; c < mesh->GetNumberOfCells(); ++c)
    {
      const std::vector<vtkIdType> p = PointsOf(mesh, c);
      const Eigen::Vector3d a = Point(mesh, p[0]);
      const Eigen::Vector3d cross = (Point(mesh, p[1]) - a).cross(Point(mesh, p[2]) - a);
      const int patch = CellNumber(mesh, "PatchId", c);
      const int piece = CellNumber(mesh, "Piece", c);
      area[patch][piece] += 0.5 * cross.norm();
      volume[patch] += piece < Fold::KNOT_PLANE ? a.dot(cross) / 6.0 : 0.0;
      Eigen::Vector3d normal;
      mesh->GetPointData()->GetArray("Normals")->GetTuple(p[0], normal.data());
      EXPECT_GE(cross.dot(normal), -1e-12);
    }
    EXPECT_EQ(area[4].size(), 7u);
    for (const auto& [piece, size] : area[4])
    {
      EXPECT_NEAR(area[7][piece], size, 1e-9) << piece;
    }
    // What the faces enclose, folds counted with their sign, is a mirror image too.
    EXPECT_NEAR(volume[4], volume[7], 1e-9);
    EXPECT_TRUE(run.Said.empty());
  }
}

TEST(JacobianBoundary, OfBadInputIsOneErrorAndEmpty)
{
  vtkNew<vtkPartitionedDataSetCollection> good;
  ToVTK(Alone(models::QuarterTube()), good);
  auto grid = vtkStructuredGrid::SafeDownCast(good->GetPartition(0, 0));
  const auto run = [](vtkStructuredGrid* input)
  {
    FilterRun bad(MultiPatch{});
    bad.Filter->SetInputDataObject(input);
    EXPECT_EQ(bad.Update()->GetNumberOfCells(), 0);
    // The second message is of the pipeline.
    return bad.Said.empty() ? std::string() : bad.Said[0];
  };
  vtkNew<vtkStructuredGrid> cut;
  cut->DeepCopy(grid);
  auto knots = cut->GetFieldData()->GetArray("Knots");
  knots->SetNumberOfTuples(knots->GetNumberOfTuples() - 1);
  EXPECT_NE(run(cut).find("nots"), std::string::npos);
  vtkNew<vtkStructuredGrid> mixed;
  mixed->DeepCopy(grid);
  mixed->GetPointData()->GetArray("Weight")->SetTuple1(3, -1.0);
  EXPECT_NE(run(mixed).find("weight 3 is -1"), std::string::npos);
  vtkNew<vtkStructuredGrid> infinite;
  infinite->DeepCopy(grid);
  infinite->GetPoints()->SetPoint(2, 0.0, std::nan(""), 0.0);
  EXPECT_NE(run(infinite).find("finite"), std::string::npos);

  FilterRun empty(MultiPatch{});
  EXPECT_EQ(empty.Update()->GetNumberOfCells(), 0);
  EXPECT_TRUE(empty.Said.empty());

  const KnotVector line = KnotVector::Uniform(1, 2);
  Eigen::MatrixXd corners(3, 4);
  corners << 0, 1, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0;
  FilterRun surface(Alone(Spline({ line, line, KnotVector() }, corners)));
  EXPECT_EQ(surface.Update()->GetNumberOfCells(), 0);
  ASSERT_EQ(surface.Said.size(), 1u);
  EXPECT_NE(surface.Said[0].find("1 patches are curves or surfaces"), std::string::npos);
}

// A volume all of whose control points are one, and one that is flat: nothing to draw, or faces
// that lie on each other; no error, by either method.
TEST(JacobianBoundary, OfVolumesWithoutVolumeIsNoError)
{
  const Spline tube = ElevateDegree(models::QuarterTube(), 2, 2);
  Eigen::MatrixXd flat = tube.Coefficients();
  flat.row(2).setZero();
  for (const Eigen::MatrixXd& points :
    { Eigen::MatrixXd(Eigen::MatrixXd::Zero(3, flat.cols())), flat })
  {
    for (const int method : { Fold::CERTIFIED, Fold::JOY_DUCHAINEAU })
    {
      FilterRun run(Alone(Spline(tube.Knots(), points, tube.Weights())));
      run.Filter->SetMethod(method);
      run.Filter->SetMaximumCells(100);
      vtkPolyData* mesh = run.Update();
      ASSERT_NE(mesh, nullptr);
      for (vtkIdType p = 0; p < mesh->GetNumberOfPoints(); ++p)
      {
        EXPECT_TRUE(Point(mesh, p).allFinite());
      }
      for (const std::string& text : run.Said)
      {
        EXPECT_EQ(text.find("ERROR"), std::string::npos) << text;
      }
    }
  }
}

TEST(JacobianBoundary, OfManyElementsThatMeetWithoutSmoothnessIsFast)
{
  // Degree 1: every knot plane is one of C0, and almost all of the 64,000 blocks go at once.
  const KnotVector k = KnotVector::Uniform(1, 41);
  Eigen::MatrixXd points(3, 41 * 41 * 41);
  for (int i = 0; i < points.cols(); ++i)
  {
    points.col(i) << i % 41, i / 41 % 41, i / 41 / 41;
  }
  points.col(20 + 41 * (20 + 41 * 20))[0] = 21.5;
  FilterRun run(Alone(Spline({ k, k, k }, points)));
  vtkPolyData* mesh = run.Update();
  EXPECT_EQ(
    Values(mesh, "Piece"), (std::set<int>{ 0, 1, 2, 3, 4, 5, Fold::KNOT_PLANE, Fold::SHEET }));
}
