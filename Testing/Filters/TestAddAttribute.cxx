// SPDX-License-Identifier: BSD-3-Clause
#include "Models.h"
#include "NURBSConversion.h"
#include "vtkNURBSAddAttribute.h"

#include "vtkCallbackCommand.h"
#include "vtkCommand.h"
#include "vtkDoubleArray.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkTable.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

using namespace hyperpatch;

namespace
{

constexpr double Epsilon = std::numeric_limits<double>::epsilon();

/// A rational quarter tube (id 3) and a dented polynomial cube with 5 control points per direction
/// (id 4), which has an attribute `Old`.
MultiPatch Model()
{
  std::mt19937 random(6);
  std::uniform_real_distribution<double> dent(-0.03, 0.03);
  const KnotVector knots = KnotVector::Uniform(2, 5);
  Eigen::MatrixXd points(3, 125);
  for (Eigen::Index i = 0; i < 125; ++i)
  {
    const auto c = static_cast<int>(i);
    points.col(i) << knots.Greville(c % 5) + dent(random), knots.Greville(c / 5 % 5) + dent(random),
      knots.Greville(c / 25) + dent(random);
  }
  const std::array<KnotVector, 3> all{ knots, knots, knots };
  MultiPatch model;
  model.Patches.push_back({ 3, Aggregate(models::QuarterTube()) });
  model.Patches.push_back({ 4,
    Aggregate(Spline(all, points), { { "Old", models::RandomSpline(random, all, 1, false) } }) });
  return model;
}

struct Addition
{
  explicit Addition(const MultiPatch& model)
  {
    ToVTK(model, this->Input);
    this->Filter->SetInputDataObject(this->Input);
    this->Filter->SetController(nullptr);
    vtkNew<vtkCallbackCommand> errors;
    errors->SetClientData(this);
    errors->SetCallback([](vtkObject*, unsigned long, void* self, void* text)
      { static_cast<Addition*>(self)->Errors.emplace_back(static_cast<const char*>(text)); });
    this->Filter->AddObserver(vtkCommand::ErrorEvent, errors);
  }

  MultiPatch Update()
  {
    this->Filter->Update();
    return FromVTK(this->Filter->GetOutputDataObject(0));
  }

  double Reported(const char* column, vtkIdType row)
  {
    return vtkTable::SafeDownCast(this->Filter->GetOutputDataObject(1))
      ->GetValueByName(row, column)
      .ToDouble();
  }

  void ExpectError(const std::string& text)
  {
    EXPECT_TRUE(this->Update().Patches.empty());
    auto report = vtkTable::SafeDownCast(this->Filter->GetOutputDataObject(1));
    EXPECT_EQ(report->GetNumberOfRows(), 0);
    ASSERT_EQ(this->Errors.size(), 1u);
    EXPECT_NE(this->Errors[0].find(text), std::string::npos) << this->Errors[0];
    this->Errors.clear();
  }

  vtkNew<vtkPartitionedDataSetCollection> Input;
  vtkNew<vtkNURBSAddAttribute> Filter;
  std::vector<std::string> Errors;
};

/// x + 2 y - z on [-5, 5]^3.
vtkNew<vtkImageData> LinearImage(double half = 5.0)
{
  vtkNew<vtkImageData> image;
  image->SetDimensions(4, 4, 4);
  image->SetOrigin(-half, -half, -half);
  image->SetSpacing(2.0 * half / 3.0, 2.0 * half / 3.0, 2.0 * half / 3.0);
  vtkNew<vtkDoubleArray> values;
  values->SetName("Linear");
  for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i)
  {
    const double* x = image->GetPoint(i);
    values->InsertNextValue(x[0] + 2.0 * x[1] - x[2]);
  }
  image->GetPointData()->AddArray(values);
  return image;
}

}

TEST(AddAttribute, AFormulaOfThePositionIsInterpolatedAtGrevillePoints)
{
  const MultiPatch model = Model();
  Addition run(model);
  run.Filter->SetAttributeName("Length");
  run.Filter->SetExpression("sqrt(x^2 + y^2 + z^2)");
  const MultiPatch result = run.Update();
  ASSERT_TRUE(run.Errors.empty()) << run.Errors[0];
  ASSERT_EQ(result.Patches.size(), 2u);
  for (const Patch& patch : result.Patches)
  {
    const Spline* field = patch.Body.FindAttribute("Length");
    ASSERT_NE(field, nullptr);
    EXPECT_EQ(field->Knots(), patch.Body.Geometry().Knots());
    for (int i = 0; i < field->Knots(0).Size(); ++i)
    {
      const double u = field->Knots(0).Greville(i);
      const double v = field->Knots(1).Greville(1);
      const double w = field->Knots(2).Greville(0);
      EXPECT_NEAR(
        field->Evaluate(u, v, w)[0], patch.Body.Geometry().Evaluate(u, v, w).norm(), 100 * Epsilon);
    }
  }
  EXPECT_NE(result.Patches[1].Body.FindAttribute("Old"), nullptr);
  EXPECT_EQ(run.Reported("PatchId", 1), 4);
  EXPECT_GT(run.Reported("MaximumError", 0), 1e-5);
  EXPECT_LE(run.Reported("RMSError", 0), run.Reported("MaximumError", 0));

  // A finer basis of its own has a smaller error.
  const double before = run.Reported("MaximumError", 0);
  run.Filter->SetBasis(vtkNURBSAddAttribute::UNIFORM);
  run.Filter->SetControlPoints(10, 11, 12);
  EXPECT_EQ(run.Update().Patches.at(0).Body.FindAttribute("Length")->Sizes(),
    (std::array<int, 3>{ 10, 11, 12 }));
  EXPECT_LT(run.Reported("MaximumError", 0), 0.1 * before);
}

TEST(AddAttribute, AnUnclampedBasisIsClamped)
{
  // A closed curve, periodic: its outer Greville points lie outside the domain.
  const int n = 6;
  Eigen::MatrixXd points(3, n + 3);
  std::vector<double> knots;
  for (int i = 0; i < n + 3; ++i)
  {
    points.col(i) << std::cos(i), std::sin(i), 0.1 * (i % n);
  }
  for (int i = 0; i < n + 7; ++i)
  {
    knots.push_back(i);
  }
  MultiPatch model;
  model.Patches.push_back({ 0, Aggregate(Spline({ KnotVector(3, knots), {}, {} }, points)) });
  Addition run(model);
  run.Filter->SetExpression("x + 2*u");
  const MultiPatch result = run.Update();
  ASSERT_TRUE(run.Errors.empty()) << run.Errors[0];
  const Patch& patch = result.Patches.at(0);
  EXPECT_EQ(patch.Body.Geometry().Knots(0).Knots(), knots);
  const Spline& field = *patch.Body.FindAttribute("Attribute");
  for (double u = 3.0; u <= 9.0; u += 0.25)
  {
    // The space is the same one, so the formula is in it.
    EXPECT_NEAR(
      field.Evaluate(u)[0], patch.Body.Geometry().Evaluate(u)[0] + 2.0 * u, 1000 * Epsilon);
  }
}

TEST(AddAttribute, ReportedErrorIsThatOfTheFormula)
{
  Addition run(Model());
  run.Filter->SetExpression("sin(3*x) + y*z");
  run.Filter->SetBasis(vtkNURBSAddAttribute::UNIFORM);
  run.Filter->SetControlPoints(7, 7, 7);
  const MultiPatch result = run.Update();
  for (std::size_t p = 0; p < 2; ++p)
  {
    const Patch& patch = result.Patches.at(p);
    const Spline* field = patch.Body.FindAttribute("Attribute");
    std::mt19937 random(9);
    std::uniform_real_distribution<double> parameter(0.0, 1.0);
    double largest = 0.0;
    for (int i = 0; i < 4000; ++i)
    {
      double t[3];
      for (int d = 0; d < 3; ++d)
      {
        const KnotVector& knots = field->Knots(d);
        t[d] = knots.First() + (knots.Last() - knots.First()) * parameter(random);
      }
      const Eigen::VectorXd x = patch.Body.Geometry().Evaluate(t[0], t[1], t[2]);
      largest = std::max(largest,
        std::abs(field->Evaluate(t[0], t[1], t[2])[0] - std::sin(3.0 * x[0]) - x[1] * x[2]));
    }
    const double reported = run.Reported("MaximumError", static_cast<vtkIdType>(p));
    EXPECT_GT(reported, 0.3 * largest);
    EXPECT_LT(reported, 1.5 * largest);
  }
}

TEST(AddAttribute, FormulasOfParametersAndVectors)
{
  Addition run(Model());
  run.Filter->SetAttributeName("Old");
  run.Filter->SetExpression("u - 2*v + w");
  const MultiPatch scalar = run.Update();
  // It replaces the one that is there. Linear functions of the parameters are met exactly.
  EXPECT_EQ(scalar.Patches.at(1).Body.Attributes().size(), 1u);
  EXPECT_NEAR(scalar.Patches[1].Body.FindAttribute("Old")->Evaluate(0.3, 0.4, 0.9)[0],
    0.3 - 0.8 + 0.9, 100 * Epsilon);
  EXPECT_LE(run.Reported("MaximumError", 1), 100 * Epsilon);

  run.Filter->SetExpression("2*coords + w*kHat");
  const MultiPatch vector = run.Update();
  ASSERT_TRUE(run.Errors.empty()) << run.Errors[0];
  // Of polynomial geometry in its own basis: exact.
  const Eigen::VectorXd x = vector.Patches[1].Body.Geometry().Evaluate(0.2, 0.7, 0.5);
  const Eigen::VectorXd value =
    vector.Patches[1].Body.FindAttribute("Old")->Evaluate(0.2, 0.7, 0.5);
  ASSERT_EQ(value.size(), 3);
  EXPECT_LE((value - 2.0 * x - Eigen::Vector3d(0.0, 0.0, 0.5)).norm(), 100 * Epsilon);
}

TEST(AddAttribute, ADataSetIsProbedAtGrevillePoints)
{
  const auto image = LinearImage();
  Addition run(Model());
  run.Filter->SetAttributeFrom(vtkNURBSAddAttribute::DATA_SET);
  run.Filter->SetInputDataObject(1, image);
  const MultiPatch result = run.Update();
  ASSERT_TRUE(run.Errors.empty()) << run.Errors[0];
  // Linear functions pass through probing and, on polynomial geometry, through its basis.
  const Patch& cube = result.Patches.at(1);
  const Eigen::VectorXd x = cube.Body.Geometry().Evaluate(0.2, 0.7, 0.5);
  EXPECT_NEAR(cube.Body.FindAttribute("Attribute")->Evaluate(0.2, 0.7, 0.5)[0],
    x[0] + 2.0 * x[1] - x[2], 1e3 * Epsilon);
  EXPECT_LE(run.Reported("MaximumError", 1), 1e3 * Epsilon);
}

TEST(AddAttribute, PointsOutsideTheDataAreRefusedOrFilled)
{
  const auto image = LinearImage(0.9);
  Addition run(Model());
  run.Filter->SetAttributeFrom(vtkNURBSAddAttribute::DATA_SET);
  run.Filter->SetInputDataObject(1, image);
  run.ExpectError("no (finite) value at");
  run.Filter->SetMissingSamples(vtkNURBSAddAttribute::LEAVE_OUT);
  const MultiPatch cube{ { Model().Patches[1] }, {}, {} };
  ToVTK(cube, run.Input);
  run.Input->Modified();
  const MultiPatch result = run.Update();
  ASSERT_EQ(result.Patches.size(), 1u);
  const auto points = result.Patches[0].Body.FindAttribute("Attribute")->Coefficients();
  EXPECT_TRUE(points.allFinite());
  EXPECT_LE(points.cwiseAbs().maxCoeff(), 10.0);
}

TEST(AddAttribute, ALatticeHoldsTheCoefficients)
{
  const auto image = LinearImage();
  Addition run(Model());
  run.Filter->SetAttributeFrom(vtkNURBSAddAttribute::LATTICE);
  run.Filter->SetPointArray("Linear");
  run.Filter->SetInputDataObject(1, image);
  run.ExpectError("the lattice has 4 points along direction 0, the basis of patch 3 2");
  run.Filter->SetBasis(vtkNURBSAddAttribute::UNIFORM);
  const MultiPatch result = run.Update();
  for (const Patch& patch : result.Patches)
  {
    const Spline* field = patch.Body.FindAttribute("Attribute");
    ASSERT_NE(field, nullptr);
    EXPECT_EQ(field->Degrees(), (std::array<int, 3>{ 3, 3, 3 }));
    for (Eigen::Index i = 0; i < 64; ++i)
    {
      EXPECT_EQ(
        field->Coefficients()(0, i), image->GetPointData()->GetArray("Linear")->GetTuple1(i));
    }
  }

  // A spline model is a lattice with knots.
  const MultiPatch cube{ { Model().Patches[1] }, {}, {} };
  Addition copy(cube);
  vtkNew<vtkPartitionedDataSetCollection> other;
  ToVTK(Model(), other);
  copy.Filter->SetAttributeName("Copy");
  copy.Filter->SetPointArray("Old");
  copy.Filter->SetAttributeFrom(vtkNURBSAddAttribute::LATTICE);
  copy.Filter->SetInputDataObject(1, other);
  const MultiPatch copied = copy.Update();
  EXPECT_EQ(
    *copied.Patches.at(0).Body.FindAttribute("Copy"), *copied.Patches[0].Body.FindAttribute("Old"));
  copy.Filter->SetPointArray("New");
  copy.ExpectError("no attribute \"New\" of patch 4");
}

TEST(AddAttribute, RefusesWhatItCannotUse)
{
  Addition run(Model());
  run.Filter->SetExpression("sin(x");
  run.ExpectError("\"sin(x\" does not parse");
  run.Filter->SetExpression("x + temperature");
  run.ExpectError("does not parse");
  run.Filter->SetExpression("");
  run.ExpectError("does not parse");
  run.Filter->SetExpression("1/(x - x)");
  run.ExpectError("no finite value at 12 of 12 Greville points");
  run.Filter->SetExpression("x");
  run.Filter->SetAttributeName("");
  run.ExpectError("name");
  run.Filter->SetAttributeName("Weight");
  run.ExpectError("Weight");
  run.Filter->SetAttributeName("A");
  run.Filter->SetBasis(vtkNURBSAddAttribute::UNIFORM);
  run.Filter->SetControlPoints(16, 3, 16);
  run.ExpectError("3 control points along direction 1");
  run.Filter->SetAttributeFrom(vtkNURBSAddAttribute::DATA_SET);
  run.ExpectError("second input is needed");
  const auto image = LinearImage();
  run.Filter->SetInputDataObject(1, image);
  run.Filter->SetPointArray("Quadratic");
  run.ExpectError("no numeric point array \"Quadratic\"; there are Linear");
  run.Filter->SetInputDataObject(1, run.Input);
  run.ExpectError("NURBS Tessellate");
  vtkNew<vtkPolyData> points;
  run.Filter->SetInputDataObject(1, points);
  run.Filter->SetAttributeFrom(vtkNURBSAddAttribute::LATTICE);
  run.ExpectError("a lattice must be");
}
