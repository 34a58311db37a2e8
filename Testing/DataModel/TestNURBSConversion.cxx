// SPDX-License-Identifier: BSD-3-Clause
#include "Error.h"
#include "Measures.h"
#include "Models.h"
#include "NURBSConversion.h"

#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkGenericCell.h"
#include "vtkHigherOrderHexahedron.h"
#include "vtkIdList.h"
#include "vtkInformation.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkPartitionedDataSet.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkStructuredGrid.h"
#include "vtkUnstructuredGrid.h"

#include <gtest/gtest.h>

#include <limits>

using namespace hyperpatch;

namespace
{

constexpr double Eps = std::numeric_limits<double>::epsilon();

Attribute SameBasisAttribute(
  std::mt19937& random, const Spline& geometry, const std::string& name, int components)
{
  Spline field = models::RandomSpline(random, geometry.Knots(), components, false);
  return { name, Spline(geometry.Knots(), field.Coefficients(), geometry.Weights()) };
}

/// A cubic field on the domain of a geometry, in a basis of its own.
Attribute OwnBasisAttribute(
  std::mt19937& random, const Spline& geometry, const std::string& name, bool rational)
{
  std::array<KnotVector, 3> knots;
  for (int d = 0; d < 3; ++d)
  {
    const KnotVector& k = geometry.Knots(d);
    knots[static_cast<std::size_t>(d)] = KnotVector::Uniform(3, 5 + d, k.First(), k.Last());
  }
  return { name, models::RandomSpline(random, knots, 1, rational) };
}

Spline RandomVolume(std::mt19937& random, bool rational)
{
  return models::RandomSpline(random,
    { models::RandomKnots(random, 2, 7, true), models::RandomKnots(random, 3, 8, false),
      models::RandomKnots(random, 1, 4, true) },
    3, rational);
}

/// Three patches: `T` in its own basis in patches 5 and 9, in the geometry's in patch 7.
MultiPatch TwoBases(std::mt19937& random)
{
  MultiPatch model;
  for (const int id : { 5, 7, 9 })
  {
    Spline geometry = RandomVolume(random, id != 7);
    const Attribute displacement = SameBasisAttribute(random, geometry, "Displacement", 3);
    const Attribute t = id == 7 ? SameBasisAttribute(random, geometry, "T", 1)
                                : OwnBasisAttribute(random, geometry, "T", id == 9);
    model.Patches.push_back({ id, Aggregate(geometry, { displacement, t }) });
  }
  model.Interfaces = { { { 5, 2, 7, 1, 0, 1, 2, 1, 1, 1 } }, { { 7, 2, 9, 1, 0, 1, 2, 1, 0, 1 } } };
  model.Boundaries = { { "inlet", { { 5, 0 } } }, { "walls", { { 5, 2 }, { 7, 3 } } },
    { "empty", {} } };
  return model;
}

void ExpectSame(const MultiPatch& a, const MultiPatch& b)
{
  ASSERT_EQ(a.Patches.size(), b.Patches.size());
  for (std::size_t p = 0; p < a.Patches.size(); ++p)
  {
    const Patch& x = a.Patches[p];
    const Patch& y = b.Patches[p];
    EXPECT_EQ(x.Id, y.Id);
    EXPECT_EQ(x.FirstSpan, y.FirstSpan);
    EXPECT_EQ(x.WholeSpans, y.WholeSpans);
    EXPECT_EQ(x.IsDomainFace, y.IsDomainFace);
    EXPECT_EQ(x.WholeHandedness, y.WholeHandedness);
    EXPECT_TRUE(x.Body.Geometry() == y.Body.Geometry());
    ASSERT_EQ(x.Body.Attributes().size(), y.Body.Attributes().size());
    for (const Attribute& attribute : x.Body.Attributes())
    {
      const Spline* other = y.Body.FindAttribute(attribute.Name);
      ASSERT_NE(other, nullptr) << attribute.Name;
      EXPECT_TRUE(attribute.Field == *other) << attribute.Name;
    }
  }
  ASSERT_EQ(a.Interfaces.size(), b.Interfaces.size());
  for (std::size_t i = 0; i < a.Interfaces.size(); ++i)
  {
    EXPECT_EQ(a.Interfaces[i].Values, b.Interfaces[i].Values);
  }
  ASSERT_EQ(a.Boundaries.size(), b.Boundaries.size());
  for (std::size_t i = 0; i < a.Boundaries.size(); ++i)
  {
    EXPECT_EQ(a.Boundaries[i].Name, b.Boundaries[i].Name);
    EXPECT_EQ(a.Boundaries[i].Sides, b.Boundaries[i].Sides);
  }
}

vtkNew<vtkPartitionedDataSetCollection> MakeCollection(const MultiPatch& model)
{
  vtkNew<vtkPartitionedDataSetCollection> collection;
  ToVTK(model, collection);
  return collection;
}

vtkStructuredGrid* Grid(
  vtkPartitionedDataSetCollection* collection, unsigned int dataset, unsigned int partition = 0)
{
  return vtkStructuredGrid::SafeDownCast(collection->GetPartition(dataset, partition));
}

MultiPatch OnePatch(const Spline& geometry, std::vector<Attribute> attributes = {})
{
  MultiPatch model;
  model.Patches.push_back({ 0, Aggregate(geometry, std::move(attributes)) });
  return model;
}

/// The message with which FromVTK refuses the data.
std::string Refusal(vtkDataObject* data)
{
  try
  {
    (void)FromVTK(data);
  }
  catch (const Error& error)
  {
    return error.what();
  }
  return "(accepted)";
}

void ExpectRefused(vtkDataObject* data, const std::string& part)
{
  EXPECT_NE(Refusal(data).find(part), std::string::npos) << Refusal(data);
}

}

TEST(NURBSConversion, RoundTripIsExact)
{
  std::mt19937 random(1);
  const MultiPatch model = TwoBases(random);
  ExpectSame(model, FromVTK(MakeCollection(model)));
}

TEST(NURBSConversion, ArraysOfDoublesAreSharedAndOutliveTheData)
{
  MultiPatch model;
  std::mt19937 random(21);
  const Spline volume = RandomVolume(random, true);
  model.Patches.push_back({ 0, Aggregate(volume, { SameBasisAttribute(random, volume, "T", 1) }) });
  MultiPatch shared;
  {
    vtkNew<vtkPartitionedDataSetCollection> collection;
    ToVTK(model, collection);
    auto grid = vtkStructuredGrid::SafeDownCast(collection->GetPartitionAsDataObject(0, 0));
    shared = FromVTK(collection);
    const Aggregate& body = shared.Patches[0].Body;
    EXPECT_EQ(body.Geometry().Coefficients().data(), grid->GetPoints()->GetVoidPointer(0));
    const auto pointer = [grid](const char* name)
    { return grid->GetPointData()->GetArray(name)->GetVoidPointer(0); };
    EXPECT_EQ(body.Geometry().Weights().data(), pointer("Weight"));
    EXPECT_EQ(body.FindAttribute("T")->Coefficients().data(), pointer("T"));
    EXPECT_EQ(body.FindAttribute("T")->Weights().data(), pointer("Weight"));
  }
  EXPECT_TRUE(shared.Patches[0].Body.Geometry() == volume);
}

TEST(NURBSConversion, ArraysOfOtherTypesAreConverted)
{
  MultiPatch model;
  model.Patches.push_back({ 0, Aggregate(models::QuarterTube()) });
  vtkNew<vtkPartitionedDataSetCollection> collection;
  ToVTK(model, collection);
  auto grid = vtkStructuredGrid::SafeDownCast(collection->GetPartitionAsDataObject(0, 0));
  vtkNew<vtkPoints> points;
  points->SetDataTypeToFloat();
  points->SetNumberOfPoints(grid->GetNumberOfPoints());
  for (vtkIdType i = 0; i < points->GetNumberOfPoints(); ++i)
  {
    points->SetPoint(i, grid->GetPoint(i));
  }
  grid->SetPoints(points);
  const Eigen::MatrixXd expected = models::QuarterTube().Coefficients();
  const Eigen::MatrixXd found = FromVTK(collection).Patches[0].Body.Geometry().Coefficients();
  EXPECT_LE((found - expected).cwiseAbs().maxCoeff(),
    std::numeric_limits<float>::epsilon() * expected.cwiseAbs().maxCoeff());
}

TEST(NURBSConversion, PartsKeepTheirPlaceInThePatch)
{
  std::mt19937 random(2);
  MultiPatch model = TwoBases(random);
  model.Patches[0].FirstSpan = { 1, 0, 2 };
  model.Patches[0].WholeSpans = { 9, 8, 7 };
  model.Patches[0].IsDomainFace = { false, true, false, false, true, true };
  model.Patches[0].WholeHandedness = -1;
  ExpectSame(model, FromVTK(MakeCollection(model)));
}

TEST(NURBSConversion, MirroringAPartMirrorsThePatch)
{
  MultiPatch model = OnePatch(models::QuarterTube());
  const int handedness = Handedness(models::QuarterTube());
  ASSERT_NE(handedness, 0);
  model.Patches[0].WholeSpans = { 2, 1, 1 };
  model.Patches[0].WholeHandedness = -handedness; // the part is where a folded patch is turned
  const auto collection = MakeCollection(model);
  vtkPoints* points = Grid(collection, 0)->GetPoints();
  for (vtkIdType i = 0; i < points->GetNumberOfPoints(); ++i)
  {
    const double* x = points->GetPoint(i);
    points->SetPoint(i, -x[0], x[1], x[2]);
  }
  EXPECT_EQ(FromVTK(collection).Patches[0].WholeHandedness, handedness);
}

TEST(NURBSConversion, CurvesAndSurfacesAreLatticesOfOneLayer)
{
  std::mt19937 random(3);
  const KnotVector u = models::RandomKnots(random, 3, 6, true);
  const KnotVector v = models::RandomKnots(random, 2, 4, true);
  const MultiPatch surface =
    OnePatch(models::RandomSpline(random, { u, v, KnotVector() }, 3, true));
  const auto collection = MakeCollection(surface);
  int dimensions[3];
  Grid(collection, 0)->GetDimensions(dimensions);
  EXPECT_EQ(dimensions[0], 6);
  EXPECT_EQ(dimensions[1], 4);
  EXPECT_EQ(dimensions[2], 1);
  ExpectSame(surface, FromVTK(collection));
  const MultiPatch curve =
    OnePatch(models::RandomSpline(random, { u, KnotVector(), KnotVector() }, 3, false));
  ExpectSame(curve, FromVTK(MakeCollection(curve)));
}

TEST(NURBSConversion, PlanarGeometryGetsZeroAsThirdCoordinate)
{
  std::mt19937 random(4);
  const KnotVector u = models::RandomKnots(random, 2, 4, true);
  const Spline plane = models::RandomSpline(random, { u, u, KnotVector() }, 2, false);
  const Spline back = FromVTK(MakeCollection(OnePatch(plane))).Patches[0].Body.Geometry();
  EXPECT_EQ(back.Coefficients().topRows(2), plane.Coefficients());
  EXPECT_EQ(back.Coefficients().row(2).norm(), 0.0);
}

TEST(NURBSConversion, DatasetsAreNamed)
{
  std::mt19937 random(5);
  const auto collection = MakeCollection(TwoBases(random));
  ASSERT_EQ(collection->GetNumberOfPartitionedDataSets(), 2u);
  EXPECT_STREQ(collection->GetMetaData(0u)->Get(vtkCompositeDataSet::NAME()), "Geometry");
  EXPECT_STREQ(collection->GetMetaData(1u)->Get(vtkCompositeDataSet::NAME()), "T");
  EXPECT_EQ(collection->GetNumberOfPartitions(0), 3u);
  EXPECT_EQ(collection->GetNumberOfPartitions(1), 2u);
}

TEST(NURBSConversion, OrderOfPartitionsAndNullsBetweenMakeNoDifference)
{
  std::mt19937 random(6);
  const MultiPatch model = TwoBases(random);
  const auto collection = MakeCollection(model);
  vtkNew<vtkPartitionedDataSetCollection> shuffled;
  shuffled->SetNumberOfPartitionedDataSets(3);
  shuffled->SetPartition(0, 1, Grid(collection, 1, 1));
  shuffled->SetPartition(0, 4, Grid(collection, 1, 0));
  shuffled->SetPartition(2, 2, Grid(collection, 0, 0));
  shuffled->SetPartition(2, 3, Grid(collection, 0, 1));
  shuffled->SetPartition(2, 7, Grid(collection, 0, 2));
  MultiPatch back = FromVTK(shuffled);
  back.Interfaces = model.Interfaces;
  back.Boundaries = model.Boundaries;
  ExpectSame(model, back);
}

TEST(NURBSConversion, BareGridIsAModel)
{
  const MultiPatch model = OnePatch(models::QuarterTube());
  const auto collection = MakeCollection(model);
  ExpectSame(model, FromVTK(Grid(collection, 0)));
}

TEST(NURBSConversion, NothingGivesNoPatches)
{
  EXPECT_TRUE(FromVTK(nullptr).Patches.empty());
  vtkNew<vtkPartitionedDataSetCollection> none;
  EXPECT_TRUE(FromVTK(none).Patches.empty());
  vtkNew<vtkStructuredGrid> empty;
  EXPECT_TRUE(FromVTK(empty).Patches.empty());
}

TEST(NURBSConversion, GrevillePointsOfAnAttributeLieInItsPatch)
{
  // The lattice of a tube's attribute shows the tube: all points have a radius in [1, 2]. Far from
  // the origin single precision would show steps.
  std::mt19937 random(7);
  const Spline tube = models::QuarterTube();
  for (const double shift : { 0.0, 1e6 })
  {
    Eigen::MatrixXd moved = tube.Coefficients();
    moved.row(0).array() += shift;
    const Spline geometry(tube.Knots(), moved, tube.Weights());
    const auto collection =
      MakeCollection(OnePatch(geometry, { OwnBasisAttribute(random, geometry, "T", false) }));
    vtkStructuredGrid* lattice = Grid(collection, 1);
    const bool isFar = shift > 0.0;
    EXPECT_EQ(lattice->GetPoints()->GetDataType(), isFar ? VTK_DOUBLE : VTK_FLOAT);
    const double rounding =
      isFar ? 8 * Eps * shift : 4 * static_cast<double>(std::numeric_limits<float>::epsilon());
    for (vtkIdType i = 0; i < lattice->GetNumberOfPoints(); ++i)
    {
      const double* x = lattice->GetPoint(i);
      const double radius = std::hypot(x[0] - shift, x[1]);
      EXPECT_GE(radius, 1 - rounding);
      EXPECT_LE(radius, 2 + rounding);
    }
  }
}

TEST(NURBSConversion, PointsOfAttributesAreNotRead)
{
  std::mt19937 random(7);
  const Spline tube = models::QuarterTube();
  const MultiPatch model = OnePatch(tube, { OwnBasisAttribute(random, tube, "T", false) });
  const auto collection = MakeCollection(model);
  Grid(collection, 1)->GetPoints()->SetPoint(0, NAN, 0.0, 0.0);
  EXPECT_EQ(*FromVTK(collection).Patches.at(0).Body.FindAttribute("T"),
    *model.Patches[0].Body.FindAttribute("T"));
}

TEST(NURBSConversion, KnowsItsOwnData)
{
  const auto collection = MakeCollection(OnePatch(models::QuarterTube()));
  EXPECT_TRUE(IsSplineData(collection));
  EXPECT_TRUE(IsSplineData(Grid(collection, 0)));
  EXPECT_FALSE(IsSplineData(nullptr));
  vtkNew<vtkPolyData> other;
  EXPECT_FALSE(IsSplineData(other));
}

TEST(NURBSConversion, RefusesWhatIsNoLattice)
{
  vtkNew<vtkPoints> points;
  points->InsertNextPoint(0, 0, 0);
  vtkNew<vtkPolyData> other;
  other->SetPoints(points);
  vtkNew<vtkPartitionedDataSetCollection> collection;
  collection->SetPartition(0, 0, other);
  ExpectRefused(collection, "no control lattice: a vtkPolyData");
}

TEST(NURBSConversion, RefusesALatticeOfOtherDimensions)
{
  const auto collection = MakeCollection(OnePatch(models::QuarterTube()));
  Grid(collection, 0)->SetDimensions(2, 2, 3);
  ExpectRefused(collection,
    "changed by an upstream filter (it has 2 x 2 x 3 points, its knots are for 2 x 3 x 2): use "
    "NURBS Refine");
}

TEST(NURBSConversion, RefusesAWrongNumberOfKnots)
{
  const auto collection = MakeCollection(OnePatch(models::QuarterTube()));
  vtkDoubleArray::SafeDownCast(Grid(collection, 0)->GetFieldData()->GetArray("Knots"))
    ->InsertNextValue(2.0);
  ExpectRefused(collection, "has 15 knots, a lattice of 2 x 3 x 2 points");
}

TEST(NURBSConversion, RefusesALatticeWithoutItsWeights)
{
  const auto collection = MakeCollection(OnePatch(models::QuarterTube()));
  Grid(collection, 0)->GetPointData()->RemoveArray("Weight");
  ExpectRefused(collection, "no point data array Weight: an upstream filter (Pass Arrays");
}

TEST(NURBSConversion, RefusesWeightsThatAreNotPositive)
{
  const auto collection = MakeCollection(OnePatch(models::QuarterTube()));
  Grid(collection, 0)->GetPointData()->GetArray("Weight")->SetComponent(3, 0, 0.0);
  ExpectRefused(collection, "weight");
}

TEST(NURBSConversion, RefusesAnAttributeOfAnotherDomain)
{
  std::mt19937 random(8);
  const Spline tube = models::QuarterTube();
  const auto collection =
    MakeCollection(OnePatch(tube, { OwnBasisAttribute(random, tube, "T", false) }));
  vtkDataArray* knots = Grid(collection, 1)->GetFieldData()->GetArray("Knots");
  for (vtkIdType i = 0; i < 9; ++i)
  {
    knots->SetComponent(i, 0, 2.0 * knots->GetComponent(i, 0));
  }
  ExpectRefused(collection, "use Normalise Domains");
}

TEST(NURBSConversion, RefusesAttributesWithoutGeometry)
{
  std::mt19937 random(9);
  const Spline tube = models::QuarterTube();
  const auto collection =
    MakeCollection(OnePatch(tube, { OwnBasisAttribute(random, tube, "T", false) }));
  collection->SetPartition(0, 0, nullptr);
  ExpectRefused(collection, "attributes but no geometry");
}

TEST(NURBSConversion, RefusesAPatchThatOccursTwice)
{
  const auto collection = MakeCollection(OnePatch(models::QuarterTube()));
  collection->SetPartition(0, 1, Grid(collection, 0));
  ExpectRefused(collection, "patch 0 occurs twice");
}

TEST(NURBSConversion, RefusesALatticeThatIsNoGridAnyMore)
{
  const auto collection = MakeCollection(OnePatch(models::QuarterTube()));
  vtkNew<vtkUnstructuredGrid> threshold;
  threshold->SetPoints(Grid(collection, 0)->GetPoints());
  threshold->GetFieldData()->ShallowCopy(Grid(collection, 0)->GetFieldData());
  ExpectRefused(threshold, "it is a vtkUnstructuredGrid now");
  EXPECT_FALSE(IsSplineData(threshold));
}

TEST(NURBSConversion, RefusesALayoutOfAnotherVersion)
{
  const auto collection = MakeCollection(OnePatch(models::QuarterTube()));
  Grid(collection, 0)->GetFieldData()->GetArray("SplineLayout")->SetComponent(0, 0, 2);
  ExpectRefused(collection, "has version 2");
}

TEST(NURBSConversion, ReservedNamesAreRefused)
{
  std::mt19937 random(10);
  const Spline tube = models::QuarterTube();
  for (const char* name : { "Weight", "vtkGhostType" })
  {
    EXPECT_THROW(
      MakeCollection(OnePatch(tube, { SameBasisAttribute(random, tube, name, 1) })), Error);
  }
}

//------------------------------------------------------------------------------------------------
// Pieces

namespace
{

double RelativeDifference(const Spline& a, const Spline& b, const std::array<double, 3>& t)
{
  const Eigen::VectorXd x = a.Evaluate(t[0], t[1], t[2]);
  const Eigen::VectorXd y = b.Evaluate(t[0], t[1], t[2]);
  return (x - y).norm() / a.Coefficients().colwise().norm().maxCoeff();
}

int Elements(const Spline& spline)
{
  std::size_t count = 1;
  for (const KnotVector& knots : spline.Knots())
  {
    count *= knots.Spans().size();
  }
  return static_cast<int>(count);
}

const Patch& PatchOf(const MultiPatch& model, int id)
{
  return *std::find_if(model.Patches.begin(), model.Patches.end(),
    [id](const Patch& patch) { return patch.Id == id; });
}

}

TEST(Pieces, TogetherAreTheWhole)
{
  std::mt19937 random(11);
  const MultiPatch model = TwoBases(random);
  int whole = 0;
  for (const Patch& patch : model.Patches)
  {
    whole += Elements(patch.Body.Geometry());
  }
  for (const int pieces : { 1, 2, 3, 5, 8 })
  {
    int elements = 0;
    for (int piece = 0; piece < pieces; ++piece)
    {
      const MultiPatch part = ExtractPiece(model, piece, pieces);
      EXPECT_FALSE(part.Patches.empty());
      EXPECT_EQ(part.Interfaces.size(), model.Interfaces.size());
      for (const Patch& patch : part.Patches)
      {
        const Spline& geometry = patch.Body.Geometry();
        const Patch& origin = PatchOf(model, patch.Id);
        elements += Elements(geometry);
        std::array<double, 3> middle{};
        for (int d = 0; d < 3; ++d)
        {
          const KnotVector& k = geometry.Knots(d);
          middle[static_cast<std::size_t>(d)] = 0.3 * k.First() + 0.7 * k.Last();
        }
        EXPECT_LE(RelativeDifference(origin.Body.Geometry(), geometry, middle), 8 * Eps);
        for (const Attribute& attribute : patch.Body.Attributes())
        {
          // A field in another basis may be cut by knot insertion: a few times degree x eps.
          EXPECT_LE(
            RelativeDifference(*origin.Body.FindAttribute(attribute.Name), attribute.Field, middle),
            64 * Eps);
        }
      }
      ExpectSame(part, FromVTK(MakeCollection(part)));
    }
    EXPECT_EQ(elements, whole) << pieces;
  }
}

TEST(Pieces, CutsAreNoDomainFaces)
{
  std::mt19937 random(12);
  const MultiPatch model = OnePatch(RandomVolume(random, true));
  int faces = 0;
  for (int piece = 0; piece < 2; ++piece)
  {
    const MultiPatch part = ExtractPiece(model, piece, 2);
    ASSERT_EQ(part.Patches.size(), 1u);
    for (const bool face : part.Patches[0].IsDomainFace)
    {
      faces += face;
    }
    EXPECT_EQ(part.Patches[0].WholeHandedness, Handedness(model.Patches[0].Body.Geometry()));
    for (std::size_t d = 0; d < 3; ++d)
    {
      EXPECT_EQ(part.Patches[0].WholeSpans[d],
        static_cast<int>(
          model.Patches[0].Body.Geometry().Knots(static_cast<int>(d)).Spans().size()));
    }
  }
  EXPECT_EQ(faces, 10);
}

TEST(Pieces, HaveTheSameListOfDatasets)
{
  std::mt19937 random(13);
  const MultiPatch model = TwoBases(random);
  for (int piece = 0; piece < 3; ++piece)
  {
    vtkNew<vtkPartitionedDataSetCollection> collection;
    ToVTK(ExtractPiece(model, piece, 3), collection, OwnBasisAttributes(model));
    EXPECT_EQ(collection->GetNumberOfPartitionedDataSets(), 2u);
  }
}

TEST(Pieces, MorePiecesThanElementsLeaveSomeEmpty)
{
  const MultiPatch model = OnePatch(models::QuarterTube());
  EXPECT_EQ(ExtractPiece(model, 0, 4).Patches.size(), 1u);
  EXPECT_TRUE(ExtractPiece(model, 3, 4).Patches.empty());
}

//------------------------------------------------------------------------------------------------
// Bezier hexahedra

namespace
{

/// Two cells side by side in x that share a face, degrees (2, 3, 1), rational, with random
/// interior.
vtkNew<vtkUnstructuredGrid> MakeBezierGrid(std::mt19937& random)
{
  const int order[3] = { 2, 3, 1 };
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  vtkNew<vtkDoubleArray> weights;
  weights->SetName("RationalWeights");
  std::uniform_real_distribution<double> noise(-0.1, 0.1);
  // The lattice of both cells: 5 x 4 x 2 points.
  for (int k = 0; k <= 1; ++k)
  {
    for (int j = 0; j <= 3; ++j)
    {
      for (int i = 0; i <= 4; ++i)
      {
        points->InsertNextPoint(i + noise(random), j + noise(random), k + noise(random));
        weights->InsertNextValue(1.0 + noise(random));
      }
    }
  }
  vtkNew<vtkUnstructuredGrid> grid;
  grid->SetPoints(points);
  for (int cell = 0; cell < 2; ++cell)
  {
    vtkIdType ids[24];
    for (int k = 0; k <= 1; ++k)
    {
      for (int j = 0; j <= 3; ++j)
      {
        for (int i = 0; i <= 2; ++i)
        {
          ids[vtkHigherOrderHexahedron::PointIndexFromIJK(i, j, k, order)] =
            2 * cell + i + 5 * (j + 4 * k);
        }
      }
    }
    grid->InsertNextCell(VTK_BEZIER_HEXAHEDRON, 24, ids);
  }
  vtkNew<vtkDoubleArray> degrees;
  degrees->SetName("HigherOrderDegrees");
  degrees->SetNumberOfComponents(3);
  degrees->InsertNextTuple3(2, 3, 1);
  degrees->InsertNextTuple3(2, 3, 1);
  grid->GetCellData()->SetHigherOrderDegrees(degrees);
  grid->GetPointData()->SetRationalWeights(weights);
  vtkNew<vtkIntArray> patch;
  patch->SetName("PatchId");
  patch->InsertNextValue(4);
  patch->InsertNextValue(4);
  grid->GetCellData()->AddArray(patch);
  return grid;
}

}

TEST(BezierHexahedra, EvaluateAsVTKDoes)
{
  std::mt19937 random(14);
  const auto grid = MakeBezierGrid(random);
  ASSERT_TRUE(IsSplineData(grid));
  const MultiPatch model = FromVTK(grid);
  ASSERT_EQ(model.Patches.size(), 2u);
  vtkNew<vtkGenericCell> cell;
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  for (vtkIdType c = 0; c < 2; ++c)
  {
    const Patch& patch = model.Patches[static_cast<std::size_t>(c)];
    EXPECT_EQ(patch.Id, 4);
    EXPECT_EQ(patch.FirstSpan, (std::array<int, 3>{ static_cast<int>(c), 0, 0 }));
    EXPECT_EQ(patch.WholeSpans, (std::array<int, 3>{ 2, 1, 1 }));
    grid->GetCell(c, cell);
    for (int sample = 0; sample < 20; ++sample)
    {
      const double t[3] = { unit(random), unit(random), unit(random) };
      int subId = 0;
      double x[3];
      std::vector<double> basis(24);
      cell->EvaluateLocation(subId, t, x, basis.data());
      const Eigen::VectorXd y = patch.Body.Geometry().Evaluate(t[0], t[1], t[2]);
      // VTK sums 24 products of coordinates up to 5.
      EXPECT_LE((y - Eigen::Map<Eigen::Vector3d>(x)).norm(), 24 * 5 * Eps);
    }
  }
}

TEST(BezierHexahedra, SharedFacesAreNoDomainFaces)
{
  std::mt19937 random(15);
  const MultiPatch model = FromVTK(MakeBezierGrid(random));
  EXPECT_EQ(
    model.Patches[0].IsDomainFace, (std::array<bool, 6>{ true, false, true, true, true, true }));
  EXPECT_EQ(
    model.Patches[1].IsDomainFace, (std::array<bool, 6>{ false, true, true, true, true, true }));
}

TEST(BezierHexahedra, RefuseDegreesThatDoNotFit)
{
  std::mt19937 random(16);
  const auto grid = MakeBezierGrid(random);
  grid->GetCellData()->RemoveArray("HigherOrderDegrees");
  ExpectRefused(grid, "Bezier hexahedron 0 has 24 points");
}
