// SPDX-License-Identifier: BSD-3-Clause
// What the modelling filters add to the operators of Splines/Modelling.h: pipelines, pieces,
// errors.
#include "Models.h"
#include "NURBSConversion.h"
#include "vtkNURBSAppend.h"
#include "vtkNURBSContour.h"
#include "vtkNURBSCurve.h"
#include "vtkNURBSCurveThroughPoints.h"
#include "vtkNURBSExtrude.h"
#include "vtkNURBSLoft.h"
#include "vtkNURBSPrimitive.h"
#include "vtkNURBSRefine.h"
#include "vtkNURBSRevolve.h"
#include "vtkNURBSRule.h"
#include "vtkNURBSSweep.h"

#include "vtkCallbackCommand.h"
#include "vtkCellArray.h"
#include "vtkCommand.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkNew.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkStructuredGrid.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

using namespace hyperpatch;

namespace
{

constexpr double Epsilon = std::numeric_limits<double>::epsilon();

MultiPatch Updated(vtkAlgorithm* filter)
{
  filter->Update();
  return FromVTK(filter->GetOutputDataObject(0));
}

/// The errors of a filter while it lives.
class Errors
{
public:
  explicit Errors(vtkAlgorithm* filter)
  {
    vtkNew<vtkCallbackCommand> command;
    command->SetClientData(this);
    command->SetCallback([](vtkObject*, unsigned long, void* self, void* text)
      { static_cast<Errors*>(self)->Texts.emplace_back(static_cast<const char*>(text)); });
    filter->AddObserver(vtkCommand::ErrorEvent, command);
  }

  std::vector<std::string> Texts;
};

/// One error with that text, and no patches.
void ExpectRefused(vtkAlgorithm* filter, const std::string& text)
{
  const Errors errors(filter);
  filter->Modified();
  EXPECT_TRUE(Updated(filter).Patches.empty()) << text;
  ASSERT_EQ(errors.Texts.size(), 1u) << text;
  EXPECT_NE(errors.Texts[0].find(text), std::string::npos) << errors.Texts[0];
  filter->RemoveObservers(vtkCommand::ErrorEvent);
}

/// A line along x from 0 or 0.1 to 1, with an index of refraction along it.
void MakeLine(vtkNURBSCurve* line, double from)
{
  line->SetNumberOfPoints(2);
  line->SetPoint(0, from, 0, 0);
  line->SetPoint(1, 1, 0, 0);
  line->SetAttributeName("Index");
  line->SetNumberOfAttributeValues(4);
  const double values[] = { 1.6, 1.58, 1.45, 1.5 };
  for (int i = 0; i < 4; ++i)
  {
    line->SetAttributeValue(i, values[i]);
  }
}

void SetInput(vtkAlgorithm* filter, const Spline& spline)
{
  MultiPatch model;
  model.Patches.push_back({ 0, Aggregate(spline) });
  vtkNew<vtkPartitionedDataSetCollection> lattice;
  ToVTK(model, lattice);
  filter->SetInputDataObject(lattice);
}

vtkSmartPointer<vtkPolyData> Polyline(const Eigen::MatrixXd& points)
{
  vtkNew<vtkPoints> places;
  places->SetDataTypeToDouble();
  vtkNew<vtkCellArray> lines;
  vtkNew<vtkDoubleArray> heat;
  heat->SetName("Heat");
  lines->InsertNextCell(static_cast<int>(points.cols()));
  for (Eigen::Index i = 0; i < points.cols(); ++i)
  {
    lines->InsertCellPoint(places->InsertNextPoint(points.col(i).data()));
    heat->InsertNextValue(static_cast<double>(i * i));
  }
  auto data = vtkSmartPointer<vtkPolyData>::New();
  data->SetPoints(places);
  data->SetLines(lines);
  data->GetPointData()->AddArray(heat);
  return data;
}

/// An element-wise rich model: two patches that share a face, one attribute of each kind.
MultiPatch TwoPatches()
{
  std::mt19937 random(8);
  const Spline tube = models::QuarterTube();
  const Spline shared(tube.Knots(), Eigen::MatrixXd::Random(2, 12), tube.Weights());
  const Spline own = models::RandomSpline(
    random, { KnotVector::Uniform(2, 5), KnotVector::Uniform(1, 3), {} }, 1, false);
  MultiPatch model;
  for (const int id : { 0, 1 })
  {
    Eigen::MatrixXd points = tube.Coefficients();
    points.row(2).array() += id;
    model.Patches.push_back({ id,
      Aggregate(
        Spline(tube.Knots(), points, tube.Weights()), { { "Own", own }, { "Shared", shared } }) });
  }
  model.Interfaces = { { { 0, 6, 1, 5, 0, 1, 2, 1, 1, 1 } } };
  model.Boundaries = { { "inside", { { 0, 0 }, { 1, 0 } } }, { "foot", { { 0, 4 } } } };
  return model;
}

}

TEST(ModellingPipeline, AnEditOfTheAttributeCurveReachesTheSolid)
{
  // Martin & Cohen's Figure 1: line and attribute, disk, volume.
  vtkNew<vtkNURBSCurve> line;
  MakeLine(line, 0.0);
  vtkNew<vtkNURBSRevolve> disk;
  disk->SetInputConnection(line->GetOutputPort());
  disk->SetAxisDirection(0, 0, 1);
  vtkNew<vtkNURBSExtrude> lens;
  lens->SetInputConnection(disk->GetOutputPort());
  lens->SetVector(0, 0, 0.5);
  const auto indexAt = [&lens](double u, double v, double w)
  {
    const MultiPatch model = Updated(lens);
    EXPECT_EQ(model.Patches.size(), 1u);
    const Spline* field = model.Patches[0].Body.FindAttribute("Index");
    return field->Evaluate(u, v, w)[0];
  };
  // A cubic Bezier curve: at 1/2 (1 3 3 1)/8 of the coefficients.
  const double before = (1.6 + 3 * 1.58 + 3 * 1.45 + 1.5) / 8;
  EXPECT_NEAR(indexAt(0.5, 0.1, 0.9), before, 4 * Epsilon);
  EXPECT_EQ(indexAt(0.5, 0.7, 0.2), indexAt(0.5, 0.1, 0.9));

  line->SetAttributeValue(2, 1.55);
  EXPECT_NEAR(indexAt(0.5, 0.1, 0.9), before + 3 * (1.55 - 1.45) / 8, 4 * Epsilon);

  line->SetPoint(1, 2, 0, 0);
  const Spline solid = Updated(lens).Patches[0].Body.Geometry();
  EXPECT_NEAR(solid.Evaluate(1, 0.3, 1).head(2).norm(), 2.0, 4 * Epsilon);
  // The two ends of the full turn are one face.
  ASSERT_EQ(Updated(lens).Interfaces.size(), 1u);
  EXPECT_EQ(
    Updated(lens).Interfaces[0].Values, (std::array<int, 10>{ 0, 3, 0, 4, 0, 1, 2, 1, 1, 1 }));
}

TEST(ModellingPipeline, AnAttributeThatIsConstantInADirectionCanBeContoured)
{
  vtkNew<vtkNURBSCurve> line;
  MakeLine(line, 0.1);
  line->SetNumberOfAttributeValues(2);
  line->SetAttributeValue(0, 1.0);
  line->SetAttributeValue(1, 2.0);
  vtkNew<vtkNURBSRevolve> disk;
  disk->SetInputConnection(line->GetOutputPort());
  disk->SetAxisDirection(0, 0, 1);
  vtkNew<vtkNURBSExtrude> lens;
  lens->SetInputConnection(disk->GetOutputPort());
  vtkNew<vtkNURBSContour> contour;
  contour->SetInputConnection(lens->GetOutputPort());
  contour->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "Index");
  contour->SetNumberOfContours(1);
  contour->SetValue(0, 1.5);
  contour->Update();
  auto surface = vtkPolyData::SafeDownCast(contour->GetOutputDataObject(0));
  ASSERT_GT(surface->GetNumberOfPoints(), 10);
  for (vtkIdType i = 0; i < surface->GetNumberOfPoints(); ++i)
  {
    double x[3];
    surface->GetPoint(i, x);
    EXPECT_NEAR(std::hypot(x[0], x[1]), 0.55, 20 * Epsilon);
  }
}

TEST(ModellingPipeline, PiecesAddUpToTheWhole)
{
  vtkNew<vtkNURBSPrimitive> primitive;
  primitive->SetShape(vtkNURBSPrimitive::TUBE);
  vtkNew<vtkNURBSRefine> refine;
  refine->SetInputConnection(primitive->GetOutputPort());
  const MultiPatch whole = Updated(refine);
  std::size_t elements = 0;
  for (int piece = 0; piece < 3; ++piece)
  {
    refine->UpdatePiece(piece, 3, 0);
    for (const Patch& patch : FromVTK(refine->GetOutputDataObject(0)).Patches)
    {
      EXPECT_EQ(patch.Id, 0);
      std::size_t count = 1;
      for (const KnotVector& knots : patch.Body.Geometry().Knots())
      {
        count *= knots.Spans().size();
      }
      elements += count;
    }
  }
  // A tube has four arcs; 2 x 2 x 2 parts of each.
  EXPECT_EQ(elements, 32u);
  EXPECT_EQ(whole.Interfaces.size(), 1u);
}

TEST(ModellingPipeline, EmptyInputGivesEmptyOutputWithoutAMessage)
{
  vtkNew<vtkPartitionedDataSetCollection> nothing;
  vtkNew<vtkNURBSExtrude> extrude;
  vtkNew<vtkNURBSAppend> append;
  vtkNew<vtkNURBSRefine> refine;
  for (vtkAlgorithm* filter : { static_cast<vtkAlgorithm*>(extrude.Get()),
         static_cast<vtkAlgorithm*>(append.Get()), static_cast<vtkAlgorithm*>(refine.Get()) })
  {
    const Errors errors(filter);
    filter->SetInputDataObject(nothing);
    EXPECT_TRUE(Updated(filter).Patches.empty());
    EXPECT_TRUE(errors.Texts.empty());
    filter->RemoveObservers(vtkCommand::ErrorEvent);
  }
}

TEST(ModellingPipeline, BadInputIsOneErrorAndEmptyOutput)
{
  vtkNew<vtkNURBSCurve> curve;
  vtkNew<vtkNURBSExtrude> surface;
  surface->SetInputConnection(curve->GetOutputPort());
  vtkNew<vtkNURBSExtrude> volume;
  volume->SetInputConnection(surface->GetOutputPort());
  volume->SetVector(0, 2, 0);

  vtkNew<vtkNURBSExtrude> extrude;
  extrude->SetInputConnection(volume->GetOutputPort());
  ExpectRefused(extrude, "a section has one or two directions, not 3");
  extrude->SetInputConnection(curve->GetOutputPort());
  extrude->SetVector(0, 0, 0);
  ExpectRefused(extrude, "not zero");

  vtkNew<vtkNURBSRevolve> revolve;
  revolve->SetInputConnection(curve->GetOutputPort());
  revolve->SetAxisPoint(1, 0, 0);
  ExpectRefused(revolve, "crosses the axis of revolution");

  vtkNew<vtkNURBSRule> rule;
  rule->SetInputConnection(curve->GetOutputPort());
  ExpectRefused(rule, "there are 1 sections");
  rule->AddInputConnection(surface->GetOutputPort());
  ExpectRefused(rule, "not some of both");

  vtkNew<vtkNURBSLoft> loft;
  loft->SetInputConnection(curve->GetOutputPort());
  ExpectRefused(loft, "two sections at least");

  vtkNew<vtkNURBSSweep> sweep;
  sweep->SetInputConnection(curve->GetOutputPort());
  sweep->SetPathConnection(surface->GetOutputPort());
  ExpectRefused(sweep, "it must be a curve");
  vtkNew<vtkNURBSPrimitive> cylinder;
  cylinder->SetShape(vtkNURBSPrimitive::CYLINDER);
  sweep->SetPathConnection(cylinder->GetOutputPort());
  ExpectRefused(sweep, "the path has 5 patches");

  vtkNew<vtkNURBSPrimitive> cone;
  cone->SetShape(vtkNURBSPrimitive::CONE);
  cone->SetTopRadius(0);
  ExpectRefused(cone, "choose Poles");

  curve->SetNumberOfPoints(1);
  ExpectRefused(curve, "at least 2 coefficients");
  curve->SetNumberOfPoints(4);
  curve->SetDegree(0);
  ExpectRefused(curve, "degree 1 at least");
  curve->SetDegree(3);
  curve->SetNumberOfWeights(2);
  ExpectRefused(curve, "2 weights for 4 control points");
  curve->SetNumberOfWeights(0);
  curve->SetNumberOfKnots(3);
  ExpectRefused(curve, "4 points of degree 3 need 8");
}

TEST(ModellingPipeline, ACurveTakesWeightsAndKnots)
{
  vtkNew<vtkNURBSCurve> curve;
  curve->SetDegree(2);
  curve->SetNumberOfPoints(3);
  const double points[3][2] = { { 1, 0 }, { 1, 1 }, { 0, 1 } };
  const double weights[] = { 1, std::sqrt(0.5), 1 };
  curve->SetNumberOfWeights(3);
  curve->SetNumberOfKnots(6);
  for (int i = 0; i < 3; ++i)
  {
    curve->SetPoint(i, points[i][0], points[i][1], 0);
    curve->SetWeight(i, weights[i]);
    curve->SetKnot(i, 2);
    curve->SetKnot(3 + i, 5);
  }
  curve->SetAttributeName("A");
  const Aggregate body = Updated(curve).Patches[0].Body;
  EXPECT_NEAR(body.Geometry().Evaluate(3.3).norm(), 1.0, 4 * Epsilon);
  EXPECT_NEAR(body.FindAttribute("A")->Evaluate(3.5)[0], 0.5, 4 * Epsilon);
}

TEST(CurveThroughPoints, PassesThroughThePointsWithTheirArrays)
{
  Eigen::MatrixXd points(3, 6);
  points << 0, 1, 2, 2, 3, 5, 0, 1, 0, 2, 2, 1, 0, 0, 1, 1, 3, 3;
  vtkNew<vtkNURBSCurveThroughPoints> curve;
  curve->SetInputDataObject(Polyline(points));
  for (const int degree : { 1, 2, 3, 5, 9 })
  {
    curve->SetDegree(degree);
    const Aggregate body = Updated(curve).Patches[0].Body;
    EXPECT_EQ(body.Geometry().Knots(0).Degree(), std::min(degree, 5));
    double length = 0.0;
    double total = 0.0;
    for (Eigen::Index i = 1; i < 6; ++i)
    {
      total += (points.col(i) - points.col(i - 1)).norm();
    }
    for (Eigen::Index i = 0; i < 6; ++i)
    {
      length += i > 0 ? (points.col(i) - points.col(i - 1)).norm() : 0.0;
      const double t = length / total;
      EXPECT_LE((body.Geometry().Evaluate(t) - points.col(i)).norm(), 1e-12);
      EXPECT_NEAR(body.FindAttribute("Heat")->Evaluate(t)[0], static_cast<double>(i * i), 1e-11);
    }
  }
}

TEST(CurveThroughPoints, BadLinesAreNamed)
{
  Eigen::MatrixXd points(3, 4);
  points << 0, 1, 1, 2, 0, 1, 1, 0, 0, 0, 0, 1;
  vtkNew<vtkNURBSCurveThroughPoints> curve;
  curve->SetInputDataObject(Polyline(points));
  ExpectRefused(curve, "line 0: ");
  curve->SetSpacing(vtkNURBSCurveThroughPoints::UNIFORM);
  EXPECT_EQ(Updated(curve).Patches.size(), 1u);

  points(0, 2) = 3.0;
  const auto data = Polyline(points);
  data->GetPointData()->GetArray("Heat")->SetComponent(2, 0, NAN);
  curve->SetInputDataObject(data);
  ExpectRefused(curve, "array \"Heat\" has a number at point 2 that is not finite");

  vtkNew<vtkPolyData> cloud;
  cloud->SetPoints(data->GetPoints());
  curve->SetInputDataObject(cloud);
  ExpectRefused(curve, "no lines");
}

TEST(Append, JoinsModelsWithTheirTopology)
{
  vtkNew<vtkPartitionedDataSetCollection> two;
  ToVTK(TwoPatches(), two);
  MultiPatch above = TwoPatches();
  for (Patch& patch : above.Patches)
  {
    const Spline& g = patch.Body.Geometry();
    Eigen::MatrixXd points = g.Coefficients();
    points.row(2).array() += 2;
    patch.Body = Aggregate(Spline(g.Knots(), points, g.Weights()));
  }
  vtkNew<vtkPartitionedDataSetCollection> others;
  ToVTK(above, others);
  vtkNew<vtkNURBSAppend> append;
  append->SetInputDataObject(two);
  append->AddInputDataObject(others);
  const MultiPatch all = Updated(append);
  ASSERT_EQ(all.Patches.size(), 4u);
  for (int i = 0; i < 4; ++i)
  {
    EXPECT_EQ(all.Patches[static_cast<std::size_t>(i)].Id, i);
    EXPECT_EQ(all.Patches[static_cast<std::size_t>(i)].Body.FindAttribute("Own") != nullptr, i < 2);
  }
  // Two came along, one is found between the models.
  ASSERT_EQ(all.Interfaces.size(), 3u);
  EXPECT_EQ(all.Interfaces[1].Values[0], 2);
  EXPECT_EQ(all.Interfaces[2].Values, (std::array<int, 10>{ 1, 6, 2, 5, 0, 1, 2, 1, 1, 1 }));
  ASSERT_EQ(all.Boundaries.size(), 2u);
  EXPECT_EQ(all.Boundaries[0].Sides.size(), 4u);

  append->SetInterfaceTolerance(2.0);
  ExpectRefused(append, "tolerance of interfaces");
}

class Refining : public testing::Test
{
protected:
  Refining()
    : Before(TwoPatches())
  {
    ToVTK(this->Before, this->Input);
    this->Filter->SetInputDataObject(this->Input);
  }

  /// Model and attributes are the same maps, at parameters changed by the function.
  template <typename ParametersBefore>
  void ExpectSameMaps(const MultiPatch& after, ParametersBefore&& before) const
  {
    ASSERT_EQ(after.Patches.size(), 2u);
    for (std::size_t p = 0; p < 2; ++p)
    {
      const Aggregate& a = after.Patches[p].Body;
      const Aggregate& b = this->Before.Patches[p].Body;
      for (const std::array<double, 3>& t : std::vector<std::array<double, 3>>{
             { 0, 0, 0 }, { 0.2, 0.3, 0.7 }, { 1, 0.6, 0.1 }, { 0.5, 1, 1 } })
      {
        const std::array<double, 3> s = before(t);
        const auto differ = [&](const Spline& x, const Spline& y)
        { return (x.Evaluate(t[0], t[1], t[2]) - y.Evaluate(s[0], s[1], s[2])).norm(); };
        // Values up to 3 after a dozen convex combinations.
        EXPECT_LE(differ(a.Geometry(), b.Geometry()), 50 * Epsilon);
        for (const char* name : { "Own", "Shared" })
        {
          EXPECT_LE(differ(*a.FindAttribute(name), *b.FindAttribute(name)), 50 * Epsilon);
        }
      }
    }
  }

  static std::array<double, 3> Same(const std::array<double, 3>& t) { return t; }

  MultiPatch Before;
  vtkNew<vtkPartitionedDataSetCollection> Input;
  vtkNew<vtkNURBSRefine> Filter;
};

TEST_F(Refining, ChangesTheBasisAndNotTheMap)
{
  for (const int operation : { vtkNURBSRefine::REFINE_UNIFORMLY, vtkNURBSRefine::INSERT_KNOTS,
         vtkNURBSRefine::ELEVATE_DEGREES, vtkNURBSRefine::SPLIT_TO_BEZIER })
  {
    for (const int bases :
      { vtkNURBSRefine::ALL_BASES, vtkNURBSRefine::GEOMETRY, vtkNURBSRefine::ATTRIBUTES })
    {
      this->Filter->SetOperation(operation);
      this->Filter->SetBases(bases);
      const MultiPatch after = Updated(this->Filter);
      this->ExpectSameMaps(after, Same);
      const Aggregate& a = after.Patches[0].Body;
      const Aggregate& b = this->Before.Patches[0].Body;
      const bool geometry = bases != vtkNURBSRefine::ATTRIBUTES;
      const bool attributes = bases != vtkNURBSRefine::GEOMETRY;
      if (operation != vtkNURBSRefine::SPLIT_TO_BEZIER)
      {
        EXPECT_EQ(a.Geometry().Knots() != b.Geometry().Knots(), geometry) << operation;
      }
      EXPECT_EQ(a.FindAttribute("Own")->Knots() != b.FindAttribute("Own")->Knots(), attributes);
      EXPECT_TRUE(SharesBasis(a.Geometry(), *a.FindAttribute("Shared")));
      // The direction in which it is constant stays out.
      EXPECT_EQ(a.FindAttribute("Own")->Knots(2).Degree(), 0);
      EXPECT_EQ(after.Interfaces.size(), 1u);
      EXPECT_EQ(after.Boundaries.size(), 2u);
    }
  }
}

TEST_F(Refining, RestrictsToABox)
{
  this->Filter->SetOperation(vtkNURBSRefine::RESTRICT_TO_BOX);
  this->Filter->SetParameterBox(0, 0.5, 0.25, 0.75, 0, 1);
  const MultiPatch after = Updated(this->Filter);
  const Spline& g = after.Patches[1].Body.Geometry();
  EXPECT_EQ(g.Knots(0).Last(), 0.5);
  EXPECT_EQ(g.Knots(1).First(), 0.25);
  const Eigen::VectorXd expected = this->Before.Patches[1].Body.Geometry().Evaluate(0.4, 0.3, 0.9);
  EXPECT_LE((g.Evaluate(0.4, 0.3, 0.9) - expected).norm(), 50 * Epsilon);
  EXPECT_NEAR(after.Patches[0].Body.FindAttribute("Own")->Evaluate(0.4, 0.3)[0],
    this->Before.Patches[0].Body.FindAttribute("Own")->Evaluate(0.4, 0.3)[0], 50 * Epsilon);
  // The patches still meet, and both boundaries keep their sides.
  EXPECT_EQ(after.Interfaces.size(), 1u);
  EXPECT_EQ(after.Boundaries.size(), 2u);

  this->Filter->SetParameterBox(0.1, 1, 0, 1, 0, 0.5);
  const MultiPatch apart = Updated(this->Filter);
  EXPECT_TRUE(apart.Interfaces.empty());
  ASSERT_EQ(apart.Boundaries.size(), 1u);
  EXPECT_EQ(apart.Boundaries[0].Name, "foot");

  this->Filter->SetParameterBox(0, 2, 0, 1, 0, 1);
  ExpectRefused(this->Filter, "not inside the domain");
}

TEST_F(Refining, ReversesAndSwapsDirections)
{
  this->Filter->SetOperation(vtkNURBSRefine::REVERSE_DIRECTION);
  this->Filter->SetDirection(vtkNURBSRefine::V);
  this->ExpectSameMaps(Updated(this->Filter),
    [](const std::array<double, 3>& t) {
      return std::array<double, 3>{ t[0], 1 - t[1], t[2] };
    });
  this->Filter->SetOperation(vtkNURBSRefine::SWAP_DIRECTIONS);
  this->Filter->SetOtherDirection(vtkNURBSRefine::W);
  const MultiPatch after = Updated(this->Filter);
  this->ExpectSameMaps(after,
    [](const std::array<double, 3>& t) {
      return std::array<double, 3>{ t[0], t[2], t[1] };
    });
  EXPECT_EQ(after.Interfaces[0].Values, (std::array<int, 10>{ 0, 4, 1, 3, 0, 1, 2, 1, 1, 1 }));
  EXPECT_EQ(after.Boundaries[1].Sides[0], (std::array<int, 2>{ 0, 2 }));
}

TEST_F(Refining, NormalisesDomainsThatDoNotAgree)
{
  // The attribute's lattice gets knots over another domain, as a hand-made file may have.
  bool changed = false;
  for (unsigned int i = 1; i < this->Input->GetNumberOfPartitionedDataSets(); ++i)
  {
    for (unsigned int p = 0; p < this->Input->GetNumberOfPartitions(i); ++p)
    {
      auto knots = vtkDoubleArray::SafeDownCast(
        this->Input->GetPartitionAsDataObject(i, p)->GetFieldData()->GetArray("Knots"));
      for (vtkIdType k = 0; k < knots->GetNumberOfValues(); ++k)
      {
        knots->SetValue(k, 10 * knots->GetValue(k));
        changed = true;
      }
    }
  }
  ASSERT_TRUE(changed);
  ExpectRefused(this->Filter, "use Normalise Domains of NURBS Refine");
  this->Filter->SetOperation(vtkNURBSRefine::NORMALISE_DOMAINS);
  this->ExpectSameMaps(Updated(this->Filter), Same);
}

TEST_F(Refining, RefusesWhatIsNotThere)
{
  this->Filter->SetOperation(vtkNURBSRefine::INSERT_KNOTS);
  this->Filter->SetKnot(0, 1.5);
  ExpectRefused(this->Filter, "outside the domain");
  this->Filter->SetKnot(0, 0.5);
  this->Filter->SetDirection(vtkNURBSRefine::W);
  std::mt19937 random(1);
  SetInput(this->Filter,
    models::RandomSpline(
      random, { KnotVector::Uniform(2, 4), KnotVector::Uniform(1, 2), {} }, 3, false));
  ExpectRefused(this->Filter, "patch 0 has no direction w");
  this->Filter->SetOperation(vtkNURBSRefine::REVERSE_DIRECTION);
  ExpectRefused(this->Filter, "patch 0 has no direction w");
  this->Filter->SetOperation(vtkNURBSRefine::REFINE_UNIFORMLY);
  this->Filter->SetPieces(0, 1, 1);
  ExpectRefused(this->Filter, "into 0 pieces");
  this->Filter->SetOperation(vtkNURBSRefine::ELEVATE_DEGREES);
  this->Filter->SetElevations(-1, 0, 0);
  ExpectRefused(this->Filter, "elevated -1 times");
}

TEST(Sweeping, FollowsItsPathFromWhereTheSectionIs)
{
  vtkNew<vtkNURBSCurve> section;
  section->SetNumberOfPoints(2);
  section->SetPoint(0, 3, 0, 1);
  section->SetPoint(1, 4, 0, 1);
  vtkNew<vtkNURBSCurve> path;
  path->SetNumberOfPoints(2);
  path->SetPoint(0, 3, 0, 1);
  path->SetPoint(1, 3, 0, 4);
  vtkNew<vtkNURBSSweep> sweep;
  sweep->SetInputConnection(section->GetOutputPort());
  sweep->SetPathConnection(path->GetOutputPort());
  sweep->SetTwist(35);
  sweep->SetSections(4);
  const Spline twisted = Updated(sweep).Patches[0].Body.Geometry();
  const double angle = 35 * 3.14159265358979323846 / 180;
  EXPECT_LE((twisted.Evaluate(1, 0) - Eigen::Vector3d(4, 0, 1)).norm(), 10 * Epsilon);
  EXPECT_LE(
    (twisted.Evaluate(1, 1) - Eigen::Vector3d(3 + std::cos(angle), std::sin(angle), 4)).norm(),
    20 * Epsilon);
  sweep->SetOrientation(vtkNURBSSweep::FIXED);
  const Spline straight = Updated(sweep).Patches[0].Body.Geometry();
  EXPECT_EQ(straight.Degrees(), (std::array<int, 3>{ 1, 1, 0 }));
  EXPECT_LE((straight.Evaluate(1, 1) - Eigen::Vector3d(4, 0, 4)).norm(), 10 * Epsilon);
}
