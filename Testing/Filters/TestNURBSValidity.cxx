// SPDX-License-Identifier: BSD-3-Clause
#include "Models.h"
#include "NURBSConversion.h"
#include "Operators.h"
#include "ValidityModels.h"
#include "vtkNURBSValidity.h"

#include "vtkCallbackCommand.h"
#include "vtkCell.h"
#include "vtkCellData.h"
#include "vtkCommand.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkNew.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkSMPTools.h"
#include "vtkStringArray.h"
#include "vtkStructuredGrid.h"
#include "vtkTable.h"
#include "vtkUnstructuredGrid.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

using namespace hyperpatch;

namespace
{

struct Testee
{
  explicit Testee(const MultiPatch& model)
  {
    this->Take(model);
    this->Listen();
  }
  explicit Testee(vtkDataObject* input)
  {
    this->Filter->SetInputDataObject(input);
    this->Listen();
  }

  void Listen()
  {
    vtkNew<vtkCallbackCommand> messages;
    messages->SetClientData(this);
    messages->SetCallback([](vtkObject*, unsigned long, void* self, void* text)
      { static_cast<Testee*>(self)->Messages.emplace_back(static_cast<const char*>(text)); });
    this->Filter->AddObserver(vtkCommand::ErrorEvent, messages);
    this->Filter->AddObserver(vtkCommand::WarningEvent, messages);
  }

  void Take(const MultiPatch& model)
  {
    vtkNew<vtkPartitionedDataSetCollection> input;
    ToVTK(model, input);
    this->Filter->SetInputDataObject(input);
  }

  vtkUnstructuredGrid* Mesh()
  {
    this->Filter->Update();
    return vtkUnstructuredGrid::SafeDownCast(this->Filter->GetOutputDataObject(0));
  }
  vtkTable* Table()
  {
    this->Filter->Update();
    return vtkTable::SafeDownCast(this->Filter->GetOutputDataObject(1));
  }
  double Cell(const char* name, vtkIdType cell, int component = 0)
  {
    return this->Mesh()->GetCellData()->GetArray(name)->GetComponent(cell, component);
  }
  double Field(const char* name)
  {
    return this->Mesh()->GetFieldData()->GetArray(name)->GetTuple1(0);
  }
  double Entry(const char* column, vtkIdType row)
  {
    return this->Table()->GetValueByName(row, column).ToDouble();
  }
  std::string Note(vtkIdType row) { return this->Table()->GetValueByName(row, "Note").ToString(); }

  vtkNew<vtkNURBSValidity> Filter;
  std::vector<std::string> Messages;
};

MultiPatch Model(const std::vector<Spline>& geometries)
{
  MultiPatch model;
  for (const Spline& geometry : geometries)
  {
    model.Patches.push_back({ static_cast<int>(3 + model.Patches.size()), Aggregate(geometry) });
  }
  return model;
}

Spline Moved(const Spline& spline, const Eigen::Vector3d& by)
{
  return Spline(spline.Knots(), spline.Coefficients().colwise() + by, spline.Weights());
}

Spline Mirrored(const Spline& spline)
{
  Eigen::MatrixXd points = spline.Coefficients();
  points.row(2) *= -1.0;
  return Spline(spline.Knots(), points, spline.Weights());
}

}

TEST(NURBSValidity, GivesEveryElementItsArrays)
{
  const Spline tube = RefineUniformly(models::QuarterTube(), { 2, 3, 1 });
  Testee run(Model({ tube }));
  ASSERT_EQ(run.Mesh()->GetNumberOfCells(), 6);
  EXPECT_EQ(run.Mesh()->GetCell(0)->GetCellType(), VTK_TRIQUADRATIC_HEXAHEDRON);
  EXPECT_EQ(run.Mesh()->GetNumberOfPoints(), 5 * 7 * 3);
  for (vtkIdType e = 0; e < 6; ++e)
  {
    EXPECT_EQ(run.Cell("PatchId", e), 3);
    EXPECT_EQ(run.Cell("ElementId", e), static_cast<double>(e));
    EXPECT_EQ(run.Cell("Verdict", e), 1);
    EXPECT_TRUE(std::isnan(run.Cell("WitnessParameters", e)));
    EXPECT_EQ(run.Cell("Handedness", e), 1);
    EXPECT_EQ(run.Cell("Degenerate", e), 0);
    EXPECT_EQ(run.Cell("CondeTorres", e), 1);
    // det J = r theta'(v), 1 <= r <= 2, theta' from sqrt(2) to 8 (sqrt(2) - 1) / 2.
    EXPECT_GE(run.Cell("MinimumJacobianLower", e), 1.4);
    EXPECT_LE(run.Cell("MinimumJacobianLower", e), run.Cell("MinimumJacobianUpper", e));
    EXPECT_LE(run.Cell("MinimumJacobianUpper", e), run.Cell("MaximumJacobianUpper", e));
    EXPECT_LE(run.Cell("MaximumJacobianUpper", e), 3.4);
    EXPECT_GE(run.Cell("ScaledJacobianLower", e), 0.95);
    EXPECT_LE(run.Cell("ScaledJacobianUpper", e), 1.0);
  }
  EXPECT_EQ(run.Field("GloballyInjective"), 1);
  EXPECT_EQ(run.Field("TestedElements"), 6);
  // Points are on the exact volume.
  vtkUnstructuredGrid* mesh = run.Mesh();
  for (vtkIdType i = 0; i < mesh->GetNumberOfPoints(); ++i)
  {
    const double* t = mesh->GetPointData()->GetArray("ParametricCoordinates")->GetTuple3(i);
    const Eigen::Vector3d exact = tube.Evaluate(t[0], t[1], t[2]);
    EXPECT_LT((Eigen::Vector3d(mesh->GetPoint(i)) - exact).norm(), 1e-14);
  }
  EXPECT_TRUE(run.Messages.empty());
}

TEST(NURBSValidity, CellsHaveTheRightVolumeForBothHandednesses)
{
  // Trilinear: plain hexahedra.
  const Spline box =
    models::BezierVolume({ 1, 1, 1 }, [](int i, int j, int k) { return Eigen::Vector3d(i, j, k); });
  Testee run(Model({ box, Mirrored(Moved(box, { 5, 0, 0 })) }));
  for (vtkIdType cell = 0; cell < 2; ++cell)
  {
    EXPECT_EQ(run.Mesh()->GetCell(cell)->GetCellType(), VTK_HEXAHEDRON);
    double centre[3];
    double derivatives[9];
    double weights[8];
    double x[3];
    int subId = 0;
    run.Mesh()->GetCell(cell)->GetParametricCenter(centre);
    run.Mesh()->GetCell(cell)->EvaluateLocation(subId, centre, x, weights);
    double coordinates[24];
    for (int i = 0; i < 8; ++i)
    {
      run.Mesh()->GetCell(cell)->GetPoints()->GetPoint(i, coordinates + 3 * i);
    }
    // The gradient of x in x is 1 for any cell that is not flat; its first edges turn right.
    run.Mesh()->GetCell(cell)->Derivatives(0, centre, coordinates, 3, derivatives);
    EXPECT_NEAR(derivatives[0], 1.0, 1e-14);
    const Eigen::Map<const Eigen::Matrix<double, 3, 8>> p(coordinates);
    EXPECT_GT((p.col(1) - p.col(0)).cross(p.col(3) - p.col(0)).dot(p.col(4) - p.col(0)), 0.9);
  }
  EXPECT_EQ(run.Cell("Handedness", 0), 1);
  EXPECT_EQ(run.Cell("Handedness", 1), -1);
  EXPECT_EQ(run.Cell("Verdict", 1), 1);
  EXPECT_NEAR(run.Cell("MinimumJacobianLower", 1), -1.0, 1e-12);
  EXPECT_NEAR(run.Cell("ScaledJacobianUpper", 1), 1.0, 1e-6);
}

TEST(NURBSValidity, TheTableHasARowPerPatchAndOneForAll)
{
  const Spline tube = models::QuarterTube();
  Testee run(Model({ tube, Mirrored(Moved(tube, { 0, 0, 2 })),
    Moved(models::SweptHalfCylinder(), { 20, 0, 0 }) }));
  ASSERT_EQ(run.Table()->GetNumberOfRows(), 4);
  EXPECT_EQ(run.Table()->GetValueByName(0, "Name").ToString(), "Patch 3");
  EXPECT_EQ(run.Table()->GetValueByName(3, "Name").ToString(), "All");
  EXPECT_EQ(run.Entry("PatchId", 3), -1);
  EXPECT_EQ(run.Entry("Elements", 3), 3);
  EXPECT_EQ(run.Entry("Valid", 3), 2);
  EXPECT_EQ(run.Entry("Invalid", 2), 1);
  EXPECT_EQ(run.Entry("Handedness", 1), -1);
  EXPECT_EQ(run.Entry("Handedness", 3), 0);
  EXPECT_EQ(run.Table()->GetValueByName(0, "CondeTorresForm").ToString(), "Bezier form");
  EXPECT_EQ(run.Note(0), "");
  EXPECT_NE(run.Note(1).find("det J < 0 everywhere"), std::string::npos);
  EXPECT_NE(run.Note(1).find("Reverse Direction of NURBS Refine"), std::string::npos);
  EXPECT_NE(run.Note(2).find("1 element not valid"), std::string::npos);
  EXPECT_NE(run.Note(3).find("both handedness: 1 of 3"), std::string::npos);
  EXPECT_NE(run.Note(3).find("not one to one"), std::string::npos);
  EXPECT_LT(run.Entry("MinimumJacobianUpper", 3), 0.0);
  EXPECT_GT(run.Entry("MaximumJacobianLower", 3), 0.0);
  EXPECT_EQ(run.Field("InvalidElements"), 1);
}

TEST(NURBSValidity, AFoldHasWitnessAndDoublePoint)
{
  const Spline spline = models::SweptHalfCylinder();
  Testee run(Model({ spline }));
  EXPECT_EQ(run.Cell("Verdict", 0), -1);
  EXPECT_FALSE(std::isnan(run.Cell("WitnessParameters", 0, 2)));
  EXPECT_EQ(run.Field("GloballyInjective"), -1);
  vtkFieldData* fields = run.Mesh()->GetFieldData();
  ASSERT_NE(fields->GetArray("DoublePoint"), nullptr);
  const Eigen::Vector3d image(fields->GetArray("DoublePoint")->GetTuple3(0));
  for (int i = 0; i < 2; ++i)
  {
    EXPECT_EQ(fields->GetArray("DoublePointPatches")->GetTuple1(i), 3);
    const double* t = fields->GetArray("DoublePointParameters")->GetTuple3(i);
    EXPECT_LT((spline.Evaluate(t[0], t[1], t[2]) - image).norm(), 1e-12);
  }
}

TEST(NURBSValidity, DegenerateFacesAreSaid)
{
  Eigen::MatrixXd points = models::QuarterTube().Coefficients();
  for (int i = 0; i < 12; i += 2)
  {
    points.col(i).head<2>().setZero();
  }
  Testee run(
    Model({ Spline(models::QuarterTube().Knots(), points, models::QuarterTube().Weights()) }));
  EXPECT_EQ(run.Cell("Verdict", 0), 1);
  EXPECT_EQ(run.Cell("Degenerate", 0), 1);
  EXPECT_EQ(run.Field("GloballyInjective"), 1);
  EXPECT_NE(run.Note(0).find("det J = 0"), std::string::npos);
  EXPECT_NE(run.Note(1).find("collapsed"), std::string::npos);
}

TEST(NURBSValidity, BoundsThatStayWiderThanTheToleranceAreSaid)
{
  std::mt19937 random(6);
  const KnotVector k = KnotVector::Uniform(3, 4);
  Testee run(Model({ models::RandomSpline(random, { k, k, k }, 3, false) }));
  run.Filter->SetScaledTolerance(1e-4);
  EXPECT_NE(
    run.Note(0).find("scaled Jacobian wider than Scaled Tolerance on 1 element"), std::string::npos)
    << run.Note(0);
  EXPECT_EQ(run.Note(0).find("bounds of det J"), std::string::npos);
  run.Filter->SetTolerance(1e-9);
  EXPECT_NE(
    run.Note(0).find("bounds of det J wider than Tolerance on 1 element"), std::string::npos)
    << run.Note(0);
  run.Filter->SetTolerance(0.01);
  run.Filter->SetScaledTolerance(0.9);
  EXPECT_EQ(run.Note(0).find("wider"), std::string::npos) << run.Note(0);
}

TEST(NURBSValidity, WhatIsNotAskedForIsNotThere)
{
  Testee run(Model({ models::QuarterTube() }));
  run.Filter->SetTolerance(0.0);
  run.Filter->SetScaledTolerance(0.0);
  run.Filter->GlobalInjectivityOff();
  run.Filter->CondeTorresOff();
  vtkCellData* cells = run.Mesh()->GetCellData();
  for (const char* name :
    { "MinimumJacobianLower", "MaximumJacobianUpper", "ScaledJacobianLower", "CondeTorres" })
  {
    EXPECT_EQ(cells->GetArray(name), nullptr) << name;
  }
  EXPECT_EQ(run.Mesh()->GetFieldData()->GetArray("GloballyInjective"), nullptr);
  EXPECT_EQ(run.Cell("Verdict", 0), 1);
  EXPECT_EQ(run.Table()->GetColumnByName("CondeTorres"), nullptr);
  EXPECT_TRUE(std::isnan(run.Entry("MinimumJacobianLower", 0)));
}

TEST(NURBSValidity, OnlyWhatAnEditReachesIsTestedAgain)
{
  const KnotVector knots = KnotVector::Uniform(3, 11);
  Eigen::MatrixXd points(3, 11 * 11 * 11);
  for (int i = 0; i < points.cols(); ++i)
  {
    points.col(i) << knots.Greville(i % 11), knots.Greville(i / 11 % 11), knots.Greville(i / 121);
  }
  Testee run(Model({ Spline({ knots, knots, knots }, points) }));
  EXPECT_EQ(run.Field("TestedElements"), 512);
  const double pairs = run.Field("TestedPairs");
  EXPECT_GT(pairs, 512 * 8);
  points(2, 5 + 55 + 605) += 0.02;
  run.Take(Model({ Spline({ knots, knots, knots }, points) }));
  EXPECT_EQ(run.Field("TestedElements"), 64);
  EXPECT_LT(run.Field("TestedPairs"), 0.5 * pairs);
  EXPECT_EQ(run.Field("GloballyInjective"), 1);
  EXPECT_EQ(run.Entry("Valid", 1), 512);
  // The same numbers as without knowledge.
  Testee fresh(Model({ Spline({ knots, knots, knots }, points) }));
  for (vtkIdType e = 0; e < 512; ++e)
  {
    EXPECT_EQ(run.Cell("MinimumJacobianLower", e), fresh.Cell("MinimumJacobianLower", e));
  }
  // Another question is another test.
  run.Filter->SetTolerance(0.1);
  EXPECT_EQ(run.Field("TestedElements"), 512);
}

TEST(NURBSValidity, ThreadsChangeNothing)
{
  std::mt19937 random(5);
  const KnotVector knots = KnotVector::Uniform(2, 7);
  Eigen::MatrixXd points =
    0.1 * models::RandomSpline(random, { knots, knots, knots }, 3, false).Coefficients();
  for (int i = 0; i < points.cols(); ++i)
  {
    points.col(i) +=
      5 * Eigen::Vector3d(knots.Greville(i % 7), knots.Greville(i / 7 % 7), knots.Greville(i / 49));
  }
  const MultiPatch model = Model({ Spline({ knots, knots, knots }, points) });
  Testee many(model);
  many.Filter->Update();
  Testee one(model);
  vtkSMPTools::LocalScope(
    vtkSMPTools::Config{ 1, "STDThread", false }, [&] { one.Filter->Update(); });
  for (const char* name :
    { "Verdict", "MinimumJacobianLower", "ScaledJacobianUpper", "CondeTorres" })
  {
    for (vtkIdType e = 0; e < many.Mesh()->GetNumberOfCells(); ++e)
    {
      EXPECT_EQ(many.Cell(name, e), one.Cell(name, e));
    }
  }
  EXPECT_EQ(many.Field("GloballyInjective"), one.Field("GloballyInjective"));
}

TEST(NURBSValidity, ManyPatchesThatTouchAreOneToOne)
{
  std::vector<Spline> boxes;
  for (int i = 0; i < 100; ++i)
  {
    const Eigen::Vector3d low(i % 5, i / 5 % 5, i / 25);
    boxes.push_back(models::BezierVolume({ 1, 1, 1 },
      [&low](int u, int v, int w) -> Eigen::Vector3d { return low + Eigen::Vector3d(u, v, w); }));
  }
  Testee run(Model(boxes));
  EXPECT_EQ(run.Entry("Valid", 100), 100);
  EXPECT_EQ(run.Entry("CondeTorres", 100), 100);
  EXPECT_EQ(run.Field("GloballyInjective"), 1);
  // One moved into its neighbour.
  boxes[42] = Moved(boxes[42], { 0.1, 0, 0 });
  run.Take(Model(boxes));
  EXPECT_EQ(run.Field("TestedElements"), 1);
  EXPECT_EQ(run.Field("GloballyInjective"), -1);
  // And back: double points are looked for anew.
  boxes[42] = Moved(boxes[42], { -0.1, 0, 0 });
  run.Take(Model(boxes));
  EXPECT_EQ(run.Field("GloballyInjective"), 1);
}

TEST(NURBSValidity, EmptyInputGivesEmptyOutputAndSurfacesAWarning)
{
  Testee empty(MultiPatch{});
  EXPECT_EQ(empty.Mesh()->GetNumberOfCells(), 0);
  EXPECT_EQ(empty.Table()->GetNumberOfRows(), 0);
  EXPECT_TRUE(empty.Messages.empty());

  const KnotVector line = KnotVector::Uniform(1, 2);
  Eigen::MatrixXd corners(3, 4);
  corners << 0, 1, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0;
  Testee surface(Model({ Spline({ line, line, KnotVector() }, corners), models::QuarterTube() }));
  EXPECT_EQ(surface.Mesh()->GetNumberOfCells(), 1);
  ASSERT_EQ(surface.Messages.size(), 1u);
  EXPECT_NE(surface.Messages[0].find("1 patches are curves or surfaces"), std::string::npos);
}

TEST(NURBSValidity, BadInputIsOneErrorAndEmptyOutput)
{
  vtkNew<vtkPartitionedDataSetCollection> good;
  ToVTK(Model({ models::QuarterTube() }), good);
  auto grid = vtkStructuredGrid::SafeDownCast(good->GetPartition(0, 0));
  // Knots that do not fit.
  vtkNew<vtkStructuredGrid> cut;
  cut->DeepCopy(grid);
  auto knots = cut->GetFieldData()->GetArray("Knots");
  knots->SetNumberOfTuples(knots->GetNumberOfTuples() - 1);
  // Weights of mixed sign.
  vtkNew<vtkStructuredGrid> mixed;
  mixed->DeepCopy(grid);
  mixed->GetPointData()->GetArray("Weight")->SetTuple1(3, -1.0);
  vtkNew<vtkStructuredGrid> infinite;
  infinite->DeepCopy(grid);
  infinite->GetPoints()->SetPoint(2, 0.0, std::nan(""), 0.0);
  const std::vector<std::pair<vtkStructuredGrid*, std::string>> cases{ { cut, "nots" },
    { mixed, "weight 3 is -1" }, { infinite, "finite" } };
  for (const auto& [bad, text] : cases)
  {
    Testee run(bad);
    EXPECT_EQ(run.Mesh()->GetNumberOfCells(), 0);
    EXPECT_EQ(run.Table()->GetNumberOfRows(), 0);
    ASSERT_FALSE(run.Messages.empty());
    EXPECT_NE(run.Messages[0].find(text), std::string::npos) << run.Messages[0];
  }
}

TEST(NURBSValidity, CoincidentControlPointsAreNoReasonToFail)
{
  // Zero derivative vectors inside and a flat volume.
  Eigen::MatrixXd points = ElevateDegree(models::QuarterTube(), 2, 2).Coefficients();
  points.rightCols(12).row(2).setZero();
  Testee flat(Model({ Spline(ElevateDegree(models::QuarterTube(), 2, 2).Knots(),
    Eigen::MatrixXd::Zero(3, points.cols()),
    ElevateDegree(models::QuarterTube(), 2, 2).Weights()) }));
  EXPECT_EQ(flat.Cell("Verdict", 0), 0);
  EXPECT_EQ(flat.Field("GloballyInjective"), 0);
  EXPECT_EQ(flat.Entry("Undecided", 1), 1);
  EXPECT_TRUE(flat.Messages.empty());
}
