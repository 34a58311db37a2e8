// SPDX-License-Identifier: BSD-3-Clause
#include "NURBSConversion.h"
#include "vtkNURBSContour.h"
#include "vtkNURBSFit.h"

#include "vtkCallbackCommand.h"
#include "vtkCommand.h"
#include "vtkDoubleArray.h"
#include "vtkFloatArray.h"
#include "vtkIdTypeArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkMultiBlockDataSet.h"
#include "vtkNew.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkRectilinearGrid.h"
#include "vtkShortArray.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStringArray.h"
#include "vtkStructuredGrid.h"
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

const double HalfPi = std::acos(0.0);
constexpr double Epsilon = std::numeric_limits<double>::epsilon();

double Wave(const double* x)
{
  return std::sin(2.0 * x[0] + x[1]) + 0.3 * x[2] * x[2];
}

/// Adds Wave of the points as an array of the given type.
template <typename Array>
void AddWave(vtkDataSet* data, const char* name, double scale = 1.0)
{
  vtkNew<Array> array;
  array->SetName(name);
  for (vtkIdType i = 0; i < data->GetNumberOfPoints(); ++i)
  {
    array->InsertNextValue(static_cast<typename Array::ValueType>(scale * Wave(data->GetPoint(i))));
  }
  data->GetPointData()->AddArray(array);
}

vtkNew<vtkImageData> Image(int nx = 20, int ny = 14, int nz = 9)
{
  vtkNew<vtkImageData> image;
  image->SetExtent(3, 3 + nx - 1, -2, ny - 3, 0, nz - 1);
  image->SetOrigin(0.5, -0.25, 1.0);
  image->SetSpacing(0.1, 0.15, 0.2);
  // A rotation about z.
  image->SetDirectionMatrix(0.8, -0.6, 0.0, 0.6, 0.8, 0.0, 0.0, 0.0, 1.0);
  AddWave<vtkDoubleArray>(image, "Wave");
  return image;
}

/// A quarter ring, right-handed, left-handed if mirrored.
vtkNew<vtkStructuredGrid> Ring(double mirror = 1.0)
{
  vtkNew<vtkStructuredGrid> grid;
  grid->SetDimensions(11, 21, 7);
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (int k = 0; k < 7; ++k)
  {
    for (int j = 0; j < 21; ++j)
    {
      for (int i = 0; i < 11; ++i)
      {
        const double r = 1.0 + 0.05 * i + 0.01 * i * i;
        const double angle = HalfPi * j / 20.0;
        points->InsertNextPoint(r * std::cos(angle), r * std::sin(angle), mirror * 0.2 * k);
      }
    }
  }
  grid->SetPoints(points);
  AddWave<vtkFloatArray>(grid, "Wave");
  return grid;
}

vtkNew<vtkPolyData> Cloud(int count)
{
  std::mt19937 random(3);
  std::uniform_real_distribution<double> coordinate(-1.0, 1.0);
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (int i = 0; i < count; ++i)
  {
    points->InsertNextPoint(coordinate(random), coordinate(random), coordinate(random));
  }
  vtkNew<vtkPolyData> cloud;
  cloud->SetPoints(points);
  AddWave<vtkDoubleArray>(cloud, "Wave");
  return cloud;
}

struct Fit
{
  explicit Fit(vtkDataObject* data)
  {
    this->Filter->SetInputDataObject(data);
    this->Filter->SetController(nullptr);
    vtkNew<vtkCallbackCommand> messages;
    messages->SetClientData(this);
    messages->SetCallback([](vtkObject*, unsigned long, void* self, void* text)
      { static_cast<Fit*>(self)->Messages.emplace_back(static_cast<const char*>(text)); });
    this->Filter->AddObserver(vtkCommand::ErrorEvent, messages);
    this->Filter->AddObserver(vtkCommand::WarningEvent, messages);
  }

  MultiPatch Update()
  {
    this->Filter->Update();
    return FromVTK(this->Filter->GetOutputDataObject(0));
  }

  [[nodiscard]] vtkTable* Report()
  {
    return vtkTable::SafeDownCast(this->Filter->GetOutputDataObject(1));
  }

  [[nodiscard]] double Reported(const char* column, vtkIdType row = 0)
  {
    return this->Report()->GetValueByName(row, column).ToDouble();
  }

  void ExpectError(const std::string& text)
  {
    EXPECT_TRUE(this->Update().Patches.empty());
    EXPECT_EQ(this->Report()->GetNumberOfRows(), 0);
    ASSERT_EQ(this->Messages.size(), 1u);
    EXPECT_NE(this->Messages[0].find(text), std::string::npos) << this->Messages[0];
    this->Messages.clear();
  }

  vtkNew<vtkNURBSFit> Filter;
  std::vector<std::string> Messages;
};

/// The largest error of an attribute at the points of the data, whose parameters are given.
double ErrorAtPoints(const Patch& patch, vtkDataSet* data, int nx, int ny)
{
  double error = 0.0;
  for (vtkIdType i = 0; i < data->GetNumberOfPoints(); ++i)
  {
    const double u = static_cast<double>(i % nx);
    const double v = static_cast<double>(i / nx % ny);
    const double w = static_cast<double>(i / nx / ny);
    double x[3];
    data->GetPoint(i, x);
    const Eigen::Vector3d point = patch.Body.Geometry().Evaluate(u, v, w);
    error = std::max(error, (point - Eigen::Map<Eigen::Vector3d>(x)).norm());
    error =
      std::max(error, std::abs(patch.Body.FindAttribute("Wave")->Evaluate(u, v, w)[0] - Wave(x)));
  }
  return error;
}

}

TEST(Fit, ImagesAreInterpolatedInTheirOwnFrame)
{
  const auto image = Image();
  for (int degree : { 1, 2, 3, 5 })
  {
    Fit fit(image);
    fit.Filter->SetDegree(degree, degree, degree);
    const MultiPatch model = fit.Update();
    ASSERT_TRUE(fit.Messages.empty()) << fit.Messages[0];
    ASSERT_EQ(model.Patches.size(), 1u);
    const Patch& patch = model.Patches[0];
    EXPECT_EQ(patch.Body.Geometry().Degrees(), (std::array<int, 3>{ 1, 1, 1 }));
    EXPECT_EQ(patch.Body.FindAttribute("Wave")->Sizes(), (std::array<int, 3>{ 20, 14, 9 }));
    EXPECT_LE(ErrorAtPoints(patch, image, 20, 14), 1e4 * Epsilon);
    ASSERT_EQ(fit.Report()->GetNumberOfRows(), 1);
    EXPECT_LE(fit.Reported("MaximumError"), 1e4 * Epsilon);
    EXPECT_EQ(fit.Reported("Samples"), 20 * 14 * 9);
    EXPECT_EQ(fit.Reported("ControlPoints"), 20 * 14 * 9);
    EXPECT_TRUE(std::isnan(fit.Reported("JacobianLower")));
    EXPECT_EQ(fit.Reported("InvalidElements"), -1);
  }
}

TEST(Fit, ReportIsFieldDataToo)
{
  const auto image = Image();
  Fit fit(image);
  fit.Update();
  vtkFieldData* field = fit.Filter->GetOutputDataObject(0)->GetFieldData();
  EXPECT_EQ(
    vtkStringArray::SafeDownCast(field->GetAbstractArray("Attribute"))->GetValue(0), "Wave");
  EXPECT_EQ(field->GetArray("RMSError")->GetTuple1(0), fit.Reported("RMSError"));
}

TEST(Fit, SlicesAndLinesHaveFewerDirections)
{
  const auto image = Image(20, 1, 9);
  const MultiPatch surface = Fit(image).Update();
  EXPECT_EQ(surface.Patches.at(0).Body.Geometry().Dimension(), 2);
  EXPECT_LE(ErrorAtPoints(surface.Patches[0], image, 20, 1), 1e4 * Epsilon);
}

TEST(Fit, RectilinearGridsKeepTheirCoordinates)
{
  vtkNew<vtkRectilinearGrid> grid;
  grid->SetDimensions(9, 8, 7);
  for (int d = 0; d < 3; ++d)
  {
    vtkNew<vtkFloatArray> coordinates;
    for (int i = 0; i < 9 - d; ++i)
    {
      coordinates->InsertNextValue(
        0.05f * static_cast<float>(i * i) + 0.1f * static_cast<float>(i));
    }
    d == 0     ? grid->SetXCoordinates(coordinates)
      : d == 1 ? grid->SetYCoordinates(coordinates)
               : grid->SetZCoordinates(coordinates);
  }
  AddWave<vtkDoubleArray>(grid, "Wave");
  const MultiPatch model = Fit(grid).Update();
  ASSERT_EQ(model.Patches.size(), 1u);
  // Parameters are coordinates: the map is the identity.
  const Patch& patch = model.Patches[0];
  for (vtkIdType i = 0; i < grid->GetNumberOfPoints(); ++i)
  {
    double x[3];
    grid->GetPoint(i, x);
    EXPECT_LE(
      (patch.Body.Geometry().Evaluate(x[0], x[1], x[2]) - Eigen::Map<Eigen::Vector3d>(x)).norm(),
      100 * Epsilon);
    EXPECT_NEAR(
      patch.Body.FindAttribute("Wave")->Evaluate(x[0], x[1], x[2])[0], Wave(x), 1e4 * Epsilon);
  }

  grid->GetXCoordinates()->SetTuple1(4, grid->GetXCoordinates()->GetTuple1(5));
  Fit(grid).ExpectError("sites 4 and 5");
}

TEST(Fit, StructuredGridsAreFittedWithTheirFields)
{
  for (double mirror : { 1.0, -1.0 })
  {
    const auto ring = Ring(mirror);
    for (int parameters : { vtkNURBSFit::CHORD_LENGTH, vtkNURBSFit::UNIFORM })
    {
      Fit fit(ring);
      fit.Filter->SetSampleParameters(parameters);
      const MultiPatch model = fit.Update();
      ASSERT_EQ(model.Patches.size(), 1u);
      // One lattice for both.
      EXPECT_EQ(vtkPartitionedDataSetCollection::SafeDownCast(fit.Filter->GetOutputDataObject(0))
                  ->GetNumberOfPartitionedDataSets(),
        1u);
      ASSERT_EQ(fit.Report()->GetNumberOfRows(), 2);
      EXPECT_EQ(fit.Report()->GetValueByName(0, "Attribute").ToString(), "Points");
      EXPECT_LE(fit.Reported("MaximumError", 0), 1e4 * Epsilon);
      EXPECT_LE(fit.Reported("MaximumError", 1), 1e4 * Epsilon);
      EXPECT_EQ(fit.Reported("InvalidElements"), 0);
      EXPECT_EQ(fit.Reported("UndecidedElements"), 0);
      EXPECT_GT(fit.Reported("JacobianLower"), 0.0);
      EXPECT_GE(fit.Reported("JacobianUpper"), fit.Reported("JacobianLower"));
      if (parameters == vtkNURBSFit::UNIFORM)
      {
        // x, y are r(u) (cos, sin)(pi v / 40), z = w / 5: the least det J is at u = 0. It is
        // enclosed to 1 % of the largest one in its element, which is the double.
        const double least = 0.05 * HalfPi / 20.0 * 0.2;
        EXPECT_NEAR(fit.Reported("JacobianLower"), least, 0.03 * least);
        EXPECT_NEAR(fit.Reported("JacobianUpper"), least, 0.03 * least);
      }
    }
  }
}

TEST(Fit, FoldedGridsAreReported)
{
  const auto ring = Ring();
  // Two layers swapped.
  vtkPoints* points = ring->GetPoints();
  for (int j = 0; j < 21; ++j)
  {
    for (int i = 0; i < 11; ++i)
    {
      const vtkIdType a = i + 11 * (j + 21 * 3);
      const vtkIdType b = a + 11 * 21;
      double x[3];
      double y[3];
      points->GetPoint(a, x);
      points->GetPoint(b, y);
      points->SetPoint(a, y);
      points->SetPoint(b, x);
    }
  }
  Fit fit(ring);
  fit.Update();
  EXPECT_GT(fit.Reported("InvalidElements"), 0);
  EXPECT_LT(fit.Reported("JacobianUpper"), 0.0);
}

TEST(Fit, DeterminantsThatVanishAreNoNumbers)
{
  // Volumes of 1e-360 are zero: nothing is certain but that.
  const auto ring = Ring();
  vtkPoints* points = ring->GetPoints();
  for (vtkIdType i = 0; i < points->GetNumberOfPoints(); ++i)
  {
    double x[3];
    points->GetPoint(i, x);
    points->SetPoint(i, 1e-120 * x[0], 1e-120 * x[1], 1e-120 * x[2]);
  }
  Fit fit(ring);
  EXPECT_EQ(fit.Update().Patches.size(), 1u);
  EXPECT_LE(fit.Reported("RelativeError"), 1e4 * Epsilon);
  EXPECT_EQ(fit.Reported("InvalidElements"), 0);
  EXPECT_GT(fit.Reported("UndecidedElements"), 0);
  EXPECT_FALSE(fit.Reported("JacobianLower") > 0.0);
}

TEST(Fit, LeastSquaresCompressesToControlPointsOrTarget)
{
  const auto ring = Ring();
  Fit fit(ring);
  fit.Filter->SetMethodToLeastSquares();
  fit.Filter->SetControlPoints(5, 7, 40);
  const MultiPatch model = fit.Update();
  // No more control points than samples.
  EXPECT_EQ(model.Patches.at(0).Body.Geometry().Sizes(), (std::array<int, 3>{ 5, 7, 7 }));
  EXPECT_LE(fit.Reported("RelativeError", 0), 0.02);
  EXPECT_LE(fit.Reported("RelativeError", 1), 0.02);
  EXPECT_GT(fit.Reported("MaximumError", 0), 0.0);
  EXPECT_GE(fit.Reported("MaximumError", 0), fit.Reported("RMSError", 0));

  fit.Filter->SetFitTo(vtkNURBSFit::TARGET_ERROR);
  vtkIdType before = 0;
  for (double target : { 1e-1, 1e-2, 1e-3, 1e-4 })
  {
    fit.Filter->SetTargetError(target);
    fit.Update();
    EXPECT_LE(fit.Reported("RelativeError", 0), target);
    EXPECT_LE(fit.Reported("RelativeError", 1), target);
    const auto points = static_cast<vtkIdType>(fit.Reported("ControlPoints", 0));
    EXPECT_GE(points, before);
    EXPECT_LT(points, 11 * 21 * 7);
    before = points;
  }
}

TEST(Fit, TargetCanBeOfTheRootMeanSquare)
{
  const auto image = Image();
  // One outlier: no compression to a largest error.
  vtkDataArray* wave = image->GetPointData()->GetArray("Wave");
  wave->SetTuple1(700, wave->GetTuple1(700) + 0.5);
  Fit fit(image);
  fit.Filter->SetMethodToLeastSquares();
  fit.Filter->SetFitTo(vtkNURBSFit::TARGET_ERROR);
  fit.Filter->SetTargetError(0.02);
  fit.Update();
  EXPECT_LE(fit.Reported("RelativeError"), 0.02);
  const double points = fit.Reported("ControlPoints");
  fit.Filter->SetErrorMeasure(vtkNURBSFit::ROOT_MEAN_SQUARE);
  fit.Update();
  EXPECT_LE(fit.Reported("RelativeRMSError"), 0.02);
  EXPECT_GT(fit.Reported("RelativeError"), 0.02);
  EXPECT_LT(fit.Reported("ControlPoints"), 0.5 * points);

  Fit cloud(Cloud(3000));
  cloud.Filter->SetFitTo(vtkNURBSFit::TARGET_ERROR);
  cloud.Filter->SetErrorMeasure(vtkNURBSFit::ROOT_MEAN_SQUARE);
  cloud.Filter->SetTargetError(0.01);
  cloud.Update();
  EXPECT_LE(cloud.Reported("RelativeRMSError"), 0.01);
  EXPECT_TRUE(cloud.Messages.empty());
}

TEST(Fit, SmoothingStraightens)
{
  const auto image = Image();
  Fit fit(image);
  fit.Filter->SetMethodToLeastSquares();
  fit.Filter->SetControlPoints(100, 100, 100);
  double before = -1.0;
  for (double smoothing : { 0.0, 1.0, 1e5 })
  {
    fit.Filter->SetSmoothing(smoothing);
    fit.Update();
    EXPECT_GT(fit.Reported("RMSError"), before);
    before = fit.Reported("RMSError");
  }
}

TEST(Fit, DataCanBeTheControlPoints)
{
  const auto image = Image();
  Fit fit(image);
  fit.Filter->SetMethodToDataAsControlPoints();
  const MultiPatch model = fit.Update();
  const auto points = model.Patches.at(0).Body.FindAttribute("Wave")->Coefficients();
  for (Eigen::Index i = 0; i < points.cols(); ++i)
  {
    EXPECT_EQ(points(0, i), image->GetPointData()->GetArray("Wave")->GetTuple1(i));
  }
  EXPECT_GT(fit.Reported("MaximumError"), 1e-3);
}

TEST(Fit, PointsWithoutAGridAreScatteredData)
{
  const auto cloud = Cloud(5000);
  Fit fit(cloud);
  const MultiPatch model = fit.Update();
  ASSERT_EQ(model.Patches.size(), 1u);
  EXPECT_EQ(model.Patches[0].Body.Geometry().Degrees(), (std::array<int, 3>{ 1, 1, 1 }));
  EXPECT_LE(fit.Reported("RelativeError"), 0.1);
  const double x[3] = { 0.1, -0.2, 0.3 };
  EXPECT_NEAR(
    model.Patches[0].Body.FindAttribute("Wave")->Evaluate(x[0], x[1], x[2])[0], Wave(x), 0.05);

  fit.Filter->SetFitTo(vtkNURBSFit::TARGET_ERROR);
  fit.Filter->SetTargetError(0.02);
  fit.Update();
  EXPECT_LE(fit.Reported("RelativeError"), 0.02);
  EXPECT_TRUE(fit.Messages.empty());
  fit.Filter->SetTargetError(1e-12);
  fit.Update();
  ASSERT_EQ(fit.Messages.size(), 1u);
  EXPECT_NE(fit.Messages[0].find("relative error"), std::string::npos);

  Fit image(Image());
  image.Filter->SetMethodToScatteredData();
  image.Update();
  EXPECT_LE(image.Reported("RelativeError"), 0.1);
}

TEST(Fit, BlocksArePatches)
{
  vtkNew<vtkMultiBlockDataSet> blocks;
  blocks->SetBlock(0, Ring());
  blocks->SetBlock(2, Image());
  const MultiPatch model = Fit(blocks).Update();
  ASSERT_EQ(model.Patches.size(), 2u);
  EXPECT_EQ(model.Patches[0].Id, 0);
  EXPECT_EQ(model.Patches[1].Id, 2);
}

TEST(Fit, FacesThatCoincideAreInterfaces)
{
  // A closed ring, whose last layer along v is the first one, and a box above another.
  vtkNew<vtkStructuredGrid> ring;
  ring->SetDimensions(5, 13, 4);
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  for (int i = 0; i < 5 * 13 * 4; ++i)
  {
    const double r = 1.0 + 0.2 * (i % 5);
    const double angle = HalfPi * (i / 5 % 13 % 12) / 3.0;
    points->InsertNextPoint(r * std::cos(angle), r * std::sin(angle), 0.1 * (i / 65));
  }
  ring->SetPoints(points);
  const MultiPatch closed = Fit(ring).Update();
  ASSERT_EQ(closed.Interfaces.size(), 1u);
  EXPECT_EQ(closed.Interfaces[0].Values, (std::array<int, 10>{ 0, 3, 0, 4, 0, 1, 2, 1, 1, 1 }));

  vtkNew<vtkMultiBlockDataSet> blocks;
  blocks->SetBlock(0, Image());
  const auto above = Image();
  above->SetOrigin(0.5, -0.25, 1.0 + 8 * 0.2);
  blocks->SetBlock(1, above);
  const MultiPatch tower = Fit(blocks).Update();
  ASSERT_EQ(tower.Interfaces.size(), 1u);
  EXPECT_EQ(tower.Interfaces[0].Values, (std::array<int, 10>{ 0, 6, 1, 5, 0, 1, 2, 1, 1, 1 }));
}

TEST(Fit, ArraysAreChosenByName)
{
  const auto image = Image();
  AddWave<vtkShortArray>(image, "Counts", 1000.0);
  Fit fit(image);
  EXPECT_EQ(fit.Update().Patches.at(0).Body.Attributes().size(), 2u);
  fit.Filter->AddPointArray("Counts");
  const MultiPatch one = fit.Update();
  ASSERT_EQ(one.Patches.at(0).Body.Attributes().size(), 1u);
  EXPECT_EQ(one.Patches[0].Body.Attributes()[0].Name, "Counts");
  EXPECT_LE(fit.Reported("RelativeError"), 1e4 * Epsilon);
  fit.Filter->AddPointArray("Missing");
  fit.ExpectError("no numeric point array \"Missing\"");
  fit.Filter->ClearPointArrays();
  EXPECT_EQ(fit.Update().Patches.size(), 1u);
}

TEST(Fit, MissingSamplesAreRefusedOrLeftOut)
{
  const auto image = Image();
  vtkDataArray* wave = image->GetPointData()->GetArray("Wave");
  const vtkIdType point = 5 + 20 * (6 + 14 * 4);
  const double value = wave->GetTuple1(point);
  wave->SetTuple1(point, NAN);
  Fit fit(image);
  fit.ExpectError("Wave has a value that is not finite at point 1245 (5, 6, 4)");

  fit.Filter->SetMissingSamples(vtkNURBSFit::LEAVE_OUT);
  for (int method : { vtkNURBSFit::INTERPOLATE, vtkNURBSFit::LEAST_SQUARES,
         vtkNURBSFit::DATA_AS_CONTROL_POINTS, vtkNURBSFit::SCATTERED_DATA })
  {
    fit.Filter->SetMethod(method);
    fit.Filter->SetControlPoints(8, 8, 8);
    const MultiPatch model = fit.Update();
    ASSERT_EQ(model.Patches.size(), 1u) << method;
    EXPECT_EQ(fit.Reported("Samples"), 20 * 14 * 9 - 1);
    if (method == vtkNURBSFit::LEAST_SQUARES)
    {
      const double filled = model.Patches[0].Body.FindAttribute("Wave")->Evaluate(5, 6, 4)[0];
      EXPECT_NEAR(filled, value, 0.01);
    }
  }

  wave->Fill(NAN);
  image->Modified();
  fit.ExpectError("the array Wave: no sample is a finite number");
  fit.Filter->SetMethodToInterpolate();
  fit.ExpectError("the array Wave: no sample is a finite number");

  const auto cloud = Cloud(100);
  cloud->GetPointData()->GetArray("Wave")->SetTuple1(7, NAN);
  Fit(cloud).ExpectError("not finite at point 7");
  cloud->GetPoints()->SetPoint(3, NAN, 0, 0);
  Fit(cloud).ExpectError("point 3 has a coordinate");
  const auto ring = Ring();
  ring->GetPoints()->SetPoint(13, 0, INFINITY, 0);
  Fit(ring).ExpectError("not finite at point 13 (2, 1, 0)");
}

TEST(Fit, RefusesWhatCannotBeFitted)
{
  Fit few(Image(20, 14, 3));
  few.ExpectError("direction 2 of the grid: 3 samples are too few for degree 3");
  few.Filter->SetMethodToLeastSquares();
  few.ExpectError("direction 2");
  few.Filter->SetDegree(3, 3, 2);
  EXPECT_EQ(few.Update().Patches.size(), 1u);
  few.Filter->SetControlPoints(2, 16, 16);
  few.ExpectError("direction 0 of the grid: 2 control points are too few for degree 3");
  few.Filter->SetDegree(0, 3, 3);
  few.ExpectError("degree 0");

  const auto image = Image();
  Fit options(image);
  options.Filter->SetMethodToLeastSquares();
  options.Filter->SetSmoothing(-1.0);
  options.ExpectError("smoothing");
  options.Filter->SetTargetError(0.0);
  options.ExpectError("Target Error");
  image->GetPointData()->Initialize();
  Fit(image).ExpectError("no numeric point array");

  vtkNew<vtkStructuredGrid> flat;
  flat->SetDimensions(5, 5, 5);
  vtkNew<vtkPoints> points;
  for (int i = 0; i < 125; ++i)
  {
    points->InsertNextPoint(i % 5, i / 5 % 5 == 3 ? 2 : i / 5 % 5, i / 25);
  }
  flat->SetPoints(points);
  Fit(flat).ExpectError("index 2 and 3 along direction 1");

  vtkNew<vtkPolyData> one;
  vtkNew<vtkPoints> same;
  same->InsertNextPoint(1, 2, 3);
  same->InsertNextPoint(1, 2, 3);
  one->SetPoints(same);
  AddWave<vtkDoubleArray>(one, "Wave");
  Fit(one).ExpectError("all points coincide");

  Fit lattice(Image());
  lattice.Update();
  Fit(lattice.Filter->GetOutputDataObject(0)).ExpectError("spline model already");
}

TEST(Fit, WarnsWhereRoundingSpoilsAnInterpolant)
{
  // A polynomial through 21 equidistant points runs away between them.
  const auto image = Image(21, 21, 1);
  std::mt19937 random(1);
  vtkDataArray* wave = image->GetPointData()->GetArray("Wave");
  for (vtkIdType i = 0; i < wave->GetNumberOfTuples(); ++i)
  {
    wave->SetTuple1(i, std::uniform_real_distribution<double>()(random));
  }
  Fit fit(image);
  fit.Filter->SetDegree(20, 20, 3);
  fit.Update();
  ASSERT_EQ(fit.Messages.size(), 1u);
  EXPECT_NE(fit.Messages[0].find("Take a lower degree"), std::string::npos) << fit.Messages[0];
  fit.Messages.clear();
  fit.Filter->SetDegree(5, 5, 3);
  fit.Update();
  EXPECT_TRUE(fit.Messages.empty());
  // Of samples far from zero the last digits are rounding anyway.
  for (vtkIdType i = 0; i < wave->GetNumberOfTuples(); ++i)
  {
    wave->SetTuple1(i, 1e9 + 1e-2 * std::uniform_real_distribution<double>()(random));
  }
  wave->Modified();
  image->Modified();
  fit.Update();
  EXPECT_GT(fit.Reported("RelativeError"), 1e-9);
  EXPECT_TRUE(fit.Messages.empty());
}

TEST(Fit, EmptyInputGivesEmptyOutput)
{
  vtkNew<vtkPolyData> nothing;
  Fit fit(nothing);
  EXPECT_TRUE(fit.Update().Patches.empty());
  EXPECT_TRUE(fit.Messages.empty());
}

TEST(Fit, PiecesMakeUpTheWhole)
{
  const auto ring = Ring();
  Fit whole(ring);
  const auto elements = whole.Update().Patches.at(0).Body.Geometry().Knots(0).Spans().size() *
    whole.Update().Patches[0].Body.Geometry().Knots(1).Spans().size() *
    whole.Update().Patches[0].Body.Geometry().Knots(2).Spans().size();
  std::size_t sum = 0;
  for (int piece = 0; piece < 3; ++piece)
  {
    Fit fit(ring);
    fit.Filter->UpdatePiece(piece, 3, 0);
    for (const Patch& patch : FromVTK(fit.Filter->GetOutputDataObject(0)).Patches)
    {
      const Spline& part = patch.Body.Geometry();
      sum +=
        part.Knots(0).Spans().size() * part.Knots(1).Spans().size() * part.Knots(2).Spans().size();
    }
    EXPECT_EQ(fit.Report()->GetNumberOfRows(), piece == 0 ? 2 : 0);
  }
  EXPECT_EQ(sum, elements);
}

TEST(Fit, ContoursOfTheFitAreThoseOfTheData)
{
  // A distance field: its isosurface is a sphere.
  vtkNew<vtkImageData> image;
  image->SetDimensions(30, 30, 30);
  image->SetSpacing(0.1, 0.1, 0.1);
  vtkNew<vtkFloatArray> squares;
  squares->SetName("Squares");
  for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i)
  {
    const double* x = image->GetPoint(i);
    squares->InsertNextValue(static_cast<float>(
      std::pow(x[0] - 1.4, 2.0) + std::pow(x[1] - 1.5, 2.0) + std::pow(x[2] - 1.45, 2.0)));
  }
  image->GetPointData()->AddArray(squares);
  vtkNew<vtkNURBSFit> fit;
  fit->SetInputData(image);
  vtkNew<vtkNURBSContour> contour;
  contour->SetInputConnection(fit->GetOutputPort());
  contour->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "Squares");
  contour->SetNumberOfContours(1);
  contour->SetValue(0, 1.0);
  contour->Update();
  auto surface = vtkPolyData::SafeDownCast(contour->GetOutputDataObject(0));
  ASSERT_GT(surface->GetNumberOfPoints(), 100);
  for (vtkIdType i = 0; i < surface->GetNumberOfPoints(); ++i)
  {
    const double* x = surface->GetPoint(i);
    // The samples are floats of magnitude up to 6.
    EXPECT_NEAR(std::hypot(x[0] - 1.4, x[1] - 1.5, x[2] - 1.45), 1.0, 1e-5);
  }
}
