// SPDX-License-Identifier: BSD-3-Clause
#include "NURBSConversion.h"

#include "Error.h"
#include "Evaluator.h"
#include "Measures.h"
#include "Operators.h"
#include "Reparametrise.h"

#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkCompositeDataIterator.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkHigherOrderHexahedron.h"
#include "vtkInformation.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkSmartPointer.h"
#include "vtkStringArray.h"
#include "vtkStructuredGrid.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <type_traits>
#include <utility>

namespace hyperpatch
{

namespace
{

constexpr const char* GeometryName = "Geometry";
constexpr const char* WeightName = "Weight";
constexpr const char* LayoutName = "SplineLayout";
constexpr const char* KnotsName = "Knots";
constexpr const char* InterfacesName = "Interfaces";
constexpr const char* BoundaryNamesName = "BoundaryNames";
constexpr const char* BoundarySidesName = "BoundarySides";
constexpr const char* BezierWeightName = "RationalWeights";
constexpr const char* BezierDegreesName = "HigherOrderDegrees";
constexpr const char* PatchIdName = "PatchId";

/// The integers of SplineLayout, in this order.
struct Layout
{
  static constexpr int CurrentVersion = 1;
  static constexpr int Size = 18;
  enum RoleType
  {
    Geometry = 0,
    Attribute = 1
  };

  int Version = CurrentVersion;
  int Role = Geometry;
  int PatchId = 0;
  std::array<int, 3> Dimensions{ 1, 1, 1 };
  std::array<int, 3> Degrees{ 0, 0, 0 };
  int Rational = 0;
  std::array<int, 3> FirstSpan{ 0, 0, 0 };
  std::array<int, 3> WholeSpans{ 0, 0, 0 };
  int DomainFaces = 0;
  int RelativeHandedness = 1;

  [[nodiscard]] std::array<int, Size> Pack() const
  {
    return { this->Version, this->Role, this->PatchId, this->Dimensions[0], this->Dimensions[1],
      this->Dimensions[2], this->Degrees[0], this->Degrees[1], this->Degrees[2], this->Rational,
      this->FirstSpan[0], this->FirstSpan[1], this->FirstSpan[2], this->WholeSpans[0],
      this->WholeSpans[1], this->WholeSpans[2], this->DomainFaces, this->RelativeHandedness };
  }

  [[nodiscard]] static Layout Unpack(const std::array<int, Size>& v)
  {
    return { v[0], v[1], v[2], { v[3], v[4], v[5] }, { v[6], v[7], v[8] }, v[9],
      { v[10], v[11], v[12] }, { v[13], v[14], v[15] }, v[16], v[17] };
  }

  [[nodiscard]] vtkIdType NumberOfKnots() const
  {
    vtkIdType count = 0;
    for (std::size_t d = 0; d < 3; ++d)
    {
      count += this->Dimensions[d] + this->Degrees[d] + 1;
    }
    return count;
  }
};

/// What joins the attribute grids of a patch to its geometry grid.
using PartKey = std::tuple<int, std::array<int, 3>>;

std::string DimensionsText(const std::array<int, 3>& n)
{
  return std::to_string(n[0]) + " x " + std::to_string(n[1]) + " x " + std::to_string(n[2]);
}

bool HasLayout(vtkDataObject* data)
{
  vtkFieldData* field = data->GetFieldData();
  return field && field->GetAbstractArray(LayoutName);
}

bool IsBezierGrid(vtkDataObject* data)
{
  auto grid = vtkUnstructuredGrid::SafeDownCast(data);
  return grid && grid->GetNumberOfCells() > 0 && grid->IsHomogeneous() &&
    grid->GetCellType(0) == VTK_BEZIER_HEXAHEDRON;
}

/// The data itself, or its leaves that are not null.
std::vector<vtkDataObject*> Leaves(vtkDataObject* data)
{
  std::vector<vtkDataObject*> leaves;
  if (auto composite = vtkCompositeDataSet::SafeDownCast(data))
  {
    vtkSmartPointer<vtkCompositeDataIterator> it;
    it.TakeReference(composite->NewIterator());
    for (it->InitTraversal(); !it->IsDoneWithTraversal(); it->GoToNextItem())
    {
      leaves.push_back(it->GetCurrentDataObject());
    }
  }
  else if (data)
  {
    leaves.push_back(data);
  }
  return leaves;
}

//------------------------------------------------------------------------------------------------
// From VTK

/// What an upstream filter has done to a lattice, as the user should hear it.
Error ChangedLattice(const std::string& details)
{
  return Error("the control lattice was changed by an upstream filter (" + details +
    "): use NURBS Refine in its place");
}

Layout ReadLayout(vtkDataObject* grid)
{
  auto array = vtkDataArray::SafeDownCast(grid->GetFieldData()->GetAbstractArray(LayoutName));
  if (!array || array->GetNumberOfValues() < 1)
  {
    throw Error(std::string("the field data array ") + LayoutName + " holds no integers");
  }
  std::array<int, Layout::Size> values{};
  const auto value = [array](int i)
  {
    const int components = array->GetNumberOfComponents();
    return static_cast<int>(array->GetComponent(i / components, i % components));
  };
  if (value(0) != Layout::CurrentVersion || array->GetNumberOfValues() != Layout::Size)
  {
    throw Error(std::string("the field data array ") + LayoutName + " has version " +
      std::to_string(value(0)) + " and " + std::to_string(array->GetNumberOfValues()) +
      " integers, this program knows version " + std::to_string(Layout::CurrentVersion) + " of " +
      std::to_string(Layout::Size));
  }
  for (int i = 0; i < Layout::Size; ++i)
  {
    values[static_cast<std::size_t>(i)] = value(i);
  }
  Layout layout = Layout::Unpack(values);
  for (std::size_t d = 0; d < 3; ++d)
  {
    if (layout.Dimensions[d] < 1 || layout.Degrees[d] < 0 || layout.Degrees[d] > MaxDegree)
    {
      throw Error(std::string("the field data array ") + LayoutName + " of patch " +
        std::to_string(layout.PatchId) + " has the dimensions " +
        DimensionsText(layout.Dimensions) + " and degrees " + DimensionsText(layout.Degrees));
    }
  }
  return layout;
}

std::array<KnotVector, 3> ReadKnots(vtkDataObject* grid, const Layout& layout)
{
  auto array = vtkDataArray::SafeDownCast(grid->GetFieldData()->GetAbstractArray(KnotsName));
  const vtkIdType count = array ? array->GetNumberOfValues() : 0;
  if (count != layout.NumberOfKnots() || (array && array->GetNumberOfComponents() != 1))
  {
    throw ChangedLattice("patch " + std::to_string(layout.PatchId) + " has " +
      std::to_string(count) + " knots, a lattice of " + DimensionsText(layout.Dimensions) +
      " points and these degrees has " + std::to_string(layout.NumberOfKnots()));
  }
  std::array<KnotVector, 3> knots;
  vtkIdType next = 0;
  for (std::size_t d = 0; d < 3; ++d)
  {
    std::vector<double> values(
      static_cast<std::size_t>(layout.Dimensions[d] + layout.Degrees[d] + 1));
    for (double& value : values)
    {
      value = array->GetComponent(next++, 0);
    }
    knots[d] = KnotVector(layout.Degrees[d], std::move(values));
  }
  return knots;
}

/// Column i of the result is tuple point(i) of the array.
template <typename PointOf>
Eigen::MatrixXd ReadColumns(vtkDataArray* array, Eigen::Index count, PointOf&& point)
{
  Eigen::MatrixXd columns(array->GetNumberOfComponents(), count);
  for (Eigen::Index i = 0; i < count; ++i)
  {
    array->GetTuple(point(i), columns.col(i).data());
  }
  return columns;
}

/// All tuples of an array as columns.
Eigen::MatrixXd ReadColumns(vtkDataArray* array)
{
  const vtkIdType count = array->GetNumberOfTuples();
  if (auto doubles = vtkDoubleArray::SafeDownCast(array))
  {
    return Eigen::Map<const Eigen::MatrixXd>(
      doubles->GetPointer(0), array->GetNumberOfComponents(), count);
  }
  return ReadColumns(array, count, [](Eigen::Index i) { return static_cast<vtkIdType>(i); });
}

/// True for point arrays that are fields of the user's.
bool IsAttribute(vtkDataArray* array)
{
  const char* name = array ? array->GetName() : nullptr;
  const std::string text = name ? name : "";
  return !text.empty() && text != WeightName && text != BezierWeightName &&
    text.compare(0, 3, "vtk") != 0;
}

/// A lattice as one spline per array, all in one basis.
struct Lattice
{
  Layout Header;
  std::optional<Spline> Points; ///< of a geometry; those of attributes are for looking at
  std::vector<Attribute> Arrays;
};

Lattice ReadLattice(vtkStructuredGrid* grid)
{
  Layout layout = ReadLayout(grid);
  std::array<int, 3> dimensions{};
  grid->GetDimensions(dimensions.data());
  if (dimensions != layout.Dimensions)
  {
    throw ChangedLattice("it has " + DimensionsText(dimensions) + " points, its knots are for " +
      DimensionsText(layout.Dimensions));
  }
  const std::array<KnotVector, 3> knots = ReadKnots(grid, layout);
  Eigen::VectorXd weights;
  if (layout.Rational)
  {
    vtkDataArray* array = grid->GetPointData()->GetArray(WeightName);
    if (!array || array->GetNumberOfComponents() != 1)
    {
      throw Error("patch " + std::to_string(layout.PatchId) +
        " is rational but its lattice has no point data array " + WeightName +
        ": an upstream filter (Pass Arrays, Point To Cell) has dropped it");
    }
    weights = ReadColumns(array).transpose();
  }
  std::vector<Attribute> arrays;
  for (int a = 0; a < grid->GetPointData()->GetNumberOfArrays(); ++a)
  {
    vtkDataArray* array = grid->GetPointData()->GetArray(a);
    if (IsAttribute(array))
    {
      arrays.push_back({ array->GetName(), Spline(knots, ReadColumns(array), weights) });
    }
  }
  std::optional<Spline> points;
  if (layout.Role == Layout::Geometry)
  {
    points.emplace(knots, ReadColumns(grid->GetPoints()->GetData()), weights);
  }
  return { layout, std::move(points), std::move(arrays) };
}

Spline OnUnitCube(Spline spline)
{
  for (int d = 0; d < 3; ++d)
  {
    spline = ScaleDomain(spline, d);
  }
  return spline;
}

Patch MakePatch(Lattice&& geometry, std::vector<Lattice*> others, Domains domains)
{
  // An array of a geometry grid goes before one of the same name in another basis: filters such as
  // Elevation write to all grids, and only what they write to the geometry is about its points.
  std::vector<Attribute> attributes = std::move(geometry.Arrays);
  for (Lattice* other : others)
  {
    for (Attribute& attribute : other->Arrays)
    {
      const auto sameName = [&attribute](const Attribute& a) { return a.Name == attribute.Name; };
      if (std::none_of(attributes.begin(), attributes.end(), sameName))
      {
        attributes.push_back(std::move(attribute));
      }
    }
  }
  if (domains == Domains::Normalised)
  {
    geometry.Points = OnUnitCube(*std::move(geometry.Points));
    for (Attribute& attribute : attributes)
    {
      attribute.Field = OnUnitCube(std::move(attribute.Field));
    }
  }
  const Layout& layout = geometry.Header;
  Patch patch{ layout.PatchId, Aggregate(*std::move(geometry.Points), std::move(attributes)) };
  patch.FirstSpan = layout.FirstSpan;
  patch.WholeSpans = layout.WholeSpans;
  for (std::size_t side = 0; side < patch.IsDomainFace.size(); ++side)
  {
    patch.IsDomainFace[side] = (layout.DomainFaces >> side) & 1;
  }
  if (layout.WholeSpans != std::array<int, 3>{ 0, 0, 0 })
  {
    patch.WholeHandedness = layout.RelativeHandedness * Handedness(patch.Body.Geometry());
  }
  return patch;
}

/// The four corners of each side of a hexahedron in VTK's order, sides as in Patch.
constexpr int SideCorners[NumberOfSides][4] = { { 0, 3, 4, 7 }, { 1, 2, 5, 6 }, { 0, 1, 4, 5 },
  { 2, 3, 6, 7 }, { 0, 1, 2, 3 }, { 4, 5, 6, 7 } };

using CornerIds = std::array<vtkIdType, 4>;

CornerIds SideOfCell(const vtkIdType* points, std::size_t side)
{
  CornerIds ids{};
  for (std::size_t c = 0; c < ids.size(); ++c)
  {
    ids[c] = points[SideCorners[side][c]];
  }
  std::sort(ids.begin(), ids.end());
  return ids;
}

std::array<int, 3> BezierDegrees(vtkDataArray* degrees, vtkIdType cell, vtkIdType points)
{
  std::array<int, 3> order{};
  if (degrees)
  {
    for (int d = 0; d < 3; ++d)
    {
      order[static_cast<std::size_t>(d)] = static_cast<int>(degrees->GetComponent(cell, d));
    }
  }
  else
  {
    order.fill(static_cast<int>(std::lround(std::cbrt(static_cast<double>(points)))) - 1);
  }
  vtkIdType expected = 1;
  for (const int degree : order)
  {
    if (degree < 1 || degree > MaxDegree)
    {
      expected = 0;
      break;
    }
    expected *= degree + 1;
  }
  if (expected != points)
  {
    throw Error("Bezier hexahedron " + std::to_string(cell) + " has " + std::to_string(points) +
      " points, which do not fit " +
      (degrees ? "its " + std::string(BezierDegreesName) : "one degree in all directions") + " (" +
      DimensionsText(order) + ")");
  }
  return order;
}

void ReadBezierGrid(vtkUnstructuredGrid* grid, std::vector<Patch>& patches)
{
  const vtkIdType cells = grid->GetNumberOfCells();
  vtkDataArray* degrees = grid->GetCellData()->GetHigherOrderDegrees();
  degrees = degrees ? degrees : grid->GetCellData()->GetArray(BezierDegreesName);
  vtkDataArray* rational = grid->GetPointData()->GetRationalWeights();
  rational = rational ? rational : grid->GetPointData()->GetArray(BezierWeightName);
  vtkDataArray* patchIds = grid->GetCellData()->GetArray(PatchIdName);
  std::vector<vtkDataArray*> attributes;
  for (int a = 0; a < grid->GetPointData()->GetNumberOfArrays(); ++a)
  {
    vtkDataArray* array = grid->GetPointData()->GetArray(a);
    if (IsAttribute(array) && array != rational)
    {
      attributes.push_back(array);
    }
  }

  vtkIdType count = 0;
  const vtkIdType* points = nullptr;
  std::map<CornerIds, int> uses;
  for (vtkIdType cell = 0; cell < cells; ++cell)
  {
    grid->GetCellPoints(cell, count, points);
    BezierDegrees(degrees, cell, count);
    for (std::size_t side = 0; side < NumberOfSides; ++side)
    {
      ++uses[SideOfCell(points, side)];
    }
  }
  for (vtkIdType cell = 0; cell < cells; ++cell)
  {
    grid->GetCellPoints(cell, count, points);
    const std::array<int, 3> order = BezierDegrees(degrees, cell, count);
    std::array<KnotVector, 3> knots;
    for (std::size_t d = 0; d < 3; ++d)
    {
      knots[d] = KnotVector::Uniform(order[d], order[d] + 1);
    }
    const auto point = [&order, points](Eigen::Index index)
    {
      const int n = static_cast<int>(index);
      const int i = n % (order[0] + 1);
      const int j = n / (order[0] + 1) % (order[1] + 1);
      const int k = n / ((order[0] + 1) * (order[1] + 1));
      return points[vtkHigherOrderHexahedron::PointIndexFromIJK(i, j, k, order.data())];
    };
    Eigen::VectorXd weights;
    if (rational)
    {
      weights = ReadColumns(rational, count, point).row(0);
    }
    std::vector<Attribute> fields;
    for (vtkDataArray* array : attributes)
    {
      fields.push_back(
        { array->GetName(), Spline(knots, ReadColumns(array, count, point), weights) });
    }
    Spline geometry(knots, ReadColumns(grid->GetPoints()->GetData(), count, point), weights);
    Patch patch{ patchIds ? static_cast<int>(patchIds->GetComponent(cell, 0)) : 0,
      Aggregate(std::move(geometry), std::move(fields)) };
    patch.FirstSpan = { static_cast<int>(cell), 0, 0 };
    patch.WholeSpans = { static_cast<int>(cells), 1, 1 };
    for (std::size_t side = 0; side < NumberOfSides; ++side)
    {
      patch.IsDomainFace[side] = uses[SideOfCell(points, side)] == 1;
    }
    patches.push_back(std::move(patch));
  }
}

void ReadTopology(vtkFieldData* field, MultiPatch& model)
{
  auto interfaces = vtkIntArray::SafeDownCast(field->GetAbstractArray(InterfacesName));
  auto names = vtkStringArray::SafeDownCast(field->GetAbstractArray(BoundaryNamesName));
  auto sides = vtkIntArray::SafeDownCast(field->GetAbstractArray(BoundarySidesName));
  if (interfaces && interfaces->GetNumberOfComponents() == 10)
  {
    for (vtkIdType i = 0; i < interfaces->GetNumberOfTuples(); ++i)
    {
      Interface item{};
      interfaces->GetTypedTuple(i, item.Values.data());
      model.Interfaces.push_back(item);
    }
  }
  if (!names || !sides || sides->GetNumberOfComponents() != 3)
  {
    return;
  }
  for (vtkIdType i = 0; i < names->GetNumberOfValues(); ++i)
  {
    model.Boundaries.push_back({ names->GetValue(i), {} });
  }
  for (vtkIdType i = 0; i < sides->GetNumberOfTuples(); ++i)
  {
    std::array<int, 3> item{};
    sides->GetTypedTuple(i, item.data());
    if (item[0] < 0 || item[0] >= names->GetNumberOfValues())
    {
      throw Error(std::string("the field data array ") + BoundarySidesName + " names boundary " +
        std::to_string(item[0]) + " of " + std::to_string(names->GetNumberOfValues()));
    }
    model.Boundaries[static_cast<std::size_t>(item[0])].Sides.push_back({ item[1], item[2] });
  }
}

//------------------------------------------------------------------------------------------------
// Pieces

/// A half-open range of spans per direction.
struct Block
{
  std::array<int, 3> Begin;
  std::array<int, 3> End;

  [[nodiscard]] int Length(std::size_t d) const { return this->End[d] - this->Begin[d]; }
  [[nodiscard]] double Elements() const
  {
    return static_cast<double>(this->Length(0)) * this->Length(1) * this->Length(2);
  }
};

Block WholeBlock(const Spline& geometry)
{
  Block block{ { 0, 0, 0 }, {} };
  for (std::size_t d = 0; d < 3; ++d)
  {
    block.End[d] = static_cast<int>(geometry.Knots(static_cast<int>(d)).Spans().size());
  }
  return block;
}

/// Halves a block, along its longest direction, until there are `parts`; fewer if it has fewer
/// elements.
void Divide(const Block& block, int parts, std::vector<Block>& blocks)
{
  std::size_t longest = 0;
  for (std::size_t d = 1; d < 3; ++d)
  {
    longest = block.Length(d) > block.Length(longest) ? d : longest;
  }
  const int length = block.Length(longest);
  if (parts < 2 || length < 2)
  {
    blocks.push_back(block);
    return;
  }
  const int left = parts / 2;
  const int cut = std::clamp((length * left + parts / 2) / parts, 1, length - 1);
  Block first = block;
  Block second = block;
  first.End[longest] = second.Begin[longest] = block.Begin[longest] + cut;
  Divide(first, left, blocks);
  Divide(second, parts - left, blocks);
}

/// Into how many parts each patch is cut, so that pieces of about the same number of elements can
/// be made of them: one where there are patches enough.
std::vector<int> PartsOfPatches(const std::vector<double>& elements, int numberOfPieces)
{
  double total = 0.0;
  for (const double count : elements)
  {
    total += count;
  }
  std::vector<int> parts;
  int sum = 0;
  for (const double count : elements)
  {
    parts.push_back(std::max(1, static_cast<int>(std::lround(numberOfPieces * count / total))));
    sum += parts.back();
  }
  for (; sum < numberOfPieces; ++sum)
  {
    std::size_t largest = 0;
    for (std::size_t p = 1; p < parts.size(); ++p)
    {
      largest = elements[p] / parts[p] > elements[largest] / parts[largest] ? p : largest;
    }
    ++parts[largest];
  }
  return parts;
}

//------------------------------------------------------------------------------------------------
// To VTK

vtkSmartPointer<vtkDoubleArray> MakeArray(const char* name, const Eigen::MatrixXd& columns)
{
  auto array = vtkSmartPointer<vtkDoubleArray>::New();
  array->SetName(name);
  array->SetNumberOfComponents(static_cast<int>(columns.rows()));
  array->SetNumberOfTuples(columns.cols());
  std::copy_n(columns.data(), columns.size(), array->GetPointer(0));
  return array;
}

/// A geometry of 1 to 3 coordinates with all of them, those that are not there 0.
Spline InSpace(const Spline& geometry)
{
  Eigen::MatrixXd points = Eigen::MatrixXd::Zero(3, geometry.NumberOfControlPoints());
  points.topRows(geometry.Components()) = geometry.Coefficients();
  return Spline(geometry.Knots(), std::move(points), geometry.Weights());
}

/// A lattice without points and attributes.
vtkSmartPointer<vtkStructuredGrid> MakeGrid(const Patch& patch, int role, const Spline& basis)
{
  Layout layout;
  layout.Role = role;
  layout.PatchId = patch.Id;
  layout.Dimensions = basis.Sizes();
  layout.Degrees = basis.Degrees();
  layout.Rational = basis.IsRational();
  layout.FirstSpan = patch.FirstSpan;
  layout.WholeSpans = patch.WholeSpans;
  for (std::size_t side = 0; side < patch.IsDomainFace.size(); ++side)
  {
    layout.DomainFaces |= static_cast<int>(patch.IsDomainFace[side]) << side;
  }
  if (role == Layout::Geometry && patch.WholeSpans != std::array<int, 3>{ 0, 0, 0 })
  {
    layout.RelativeHandedness = patch.WholeHandedness * Handedness(patch.Body.Geometry());
  }

  auto grid = vtkSmartPointer<vtkStructuredGrid>::New();
  grid->SetDimensions(layout.Dimensions.data());
  if (basis.IsRational())
  {
    grid->GetPointData()->AddArray(MakeArray(WeightName, basis.Weights().transpose()));
  }

  vtkNew<vtkIntArray> header;
  header->SetName(LayoutName);
  for (const int value : layout.Pack())
  {
    header->InsertNextValue(value);
  }
  vtkNew<vtkDoubleArray> knots;
  knots->SetName(KnotsName);
  for (const KnotVector& direction : basis.Knots())
  {
    for (const double knot : direction.Knots())
    {
      knots->InsertNextValue(knot);
    }
  }
  grid->GetFieldData()->AddArray(header);
  grid->GetFieldData()->AddArray(knots);
  return grid;
}

/// Greville points of a basis, mapped through a geometry in space, for looking at. They may be as
/// many as the voxels of an image, so their precision is single where that shows no difference.
vtkSmartPointer<vtkPoints> GrevillePoints(
  const Spline& geometry, const std::array<KnotVector, 3>& basis)
{
  std::array<std::vector<double>, 3> parameters;
  for (std::size_t d = 0; d < 3; ++d)
  {
    const KnotVector& knots = basis[d];
    for (int i = 0; i < knots.Size(); ++i)
    {
      // Of an unclamped basis, the outer ones lie outside the domain.
      parameters[d].push_back(std::clamp(knots.Greville(i), knots.First(), knots.Last()));
    }
  }
  const Eigen::MatrixXd& control = geometry.Coefficients();
  const double diagonal = (control.rowwise().maxCoeff() - control.rowwise().minCoeff()).norm();
  const double largest = control.cwiseAbs().maxCoeff();
  const bool isSingle = std::numeric_limits<float>::epsilon() * largest <= 1e-6 * diagonal &&
    largest < std::numeric_limits<float>::max();

  const Evaluator evaluator(geometry);
  const auto layer = static_cast<Eigen::Index>(parameters[0].size() * parameters[1].size());
  const Eigen::Index layers = static_cast<Eigen::Index>(parameters[2].size());
  auto points = vtkSmartPointer<vtkPoints>::New();
  points->SetDataType(isSingle ? VTK_FLOAT : VTK_DOUBLE);
  points->SetNumberOfPoints(layer * layers);
  const auto fill = [&](auto* target)
  {
    std::vector<double> values(static_cast<std::size_t>(3 * layer));
    for (Eigen::Index k = 0; k < layers; ++k)
    {
      const double w = parameters[2][static_cast<std::size_t>(k)];
      evaluator.EvaluateGrid({ parameters[0], parameters[1], { w } }, values.data());
      using Number = std::remove_pointer_t<decltype(target)>;
      std::transform(values.begin(), values.end(), target + 3 * layer * k,
        [](double x) { return static_cast<Number>(x); });
    }
  };
  isSingle ? fill(static_cast<float*>(points->GetVoidPointer(0)))
           : fill(static_cast<double*>(points->GetVoidPointer(0)));
  return points;
}

void WriteTopology(const MultiPatch& model, vtkFieldData* field)
{
  vtkNew<vtkIntArray> interfaces;
  interfaces->SetName(InterfacesName);
  interfaces->SetNumberOfComponents(10);
  for (const Interface& item : model.Interfaces)
  {
    interfaces->InsertNextTypedTuple(item.Values.data());
  }
  vtkNew<vtkStringArray> names;
  names->SetName(BoundaryNamesName);
  vtkNew<vtkIntArray> sides;
  sides->SetName(BoundarySidesName);
  sides->SetNumberOfComponents(3);
  for (std::size_t i = 0; i < model.Boundaries.size(); ++i)
  {
    names->InsertNextValue(model.Boundaries[i].Name);
    for (const std::array<int, 2>& side : model.Boundaries[i].Sides)
    {
      const int item[3] = { static_cast<int>(i), side[0], side[1] };
      sides->InsertNextTypedTuple(item);
    }
  }
  if (interfaces->GetNumberOfTuples() > 0)
  {
    field->AddArray(interfaces);
  }
  if (names->GetNumberOfValues() > 0)
  {
    field->AddArray(names);
    field->AddArray(sides);
  }
}

}

bool IsSplineData(vtkDataObject* data)
{
  const std::vector<vtkDataObject*> leaves = Leaves(data);
  return std::any_of(leaves.begin(), leaves.end(),
    [](vtkDataObject* leaf)
    { return IsBezierGrid(leaf) || (vtkStructuredGrid::SafeDownCast(leaf) && HasLayout(leaf)); });
}

MultiPatch FromVTK(vtkDataObject* data, Domains domains)
{
  MultiPatch model;
  std::vector<Lattice> geometries;
  std::map<PartKey, std::vector<Lattice>> attributes;
  for (vtkDataObject* leaf : Leaves(data))
  {
    if (leaf->GetNumberOfElements(vtkDataObject::POINT) == 0)
    {
      continue;
    }
    auto grid = vtkStructuredGrid::SafeDownCast(leaf);
    if (grid && HasLayout(grid))
    {
      Lattice lattice = ReadLattice(grid);
      if (lattice.Header.Role == Layout::Geometry)
      {
        geometries.push_back(std::move(lattice));
      }
      else
      {
        attributes[{ lattice.Header.PatchId, lattice.Header.FirstSpan }].push_back(
          std::move(lattice));
      }
    }
    else if (IsBezierGrid(leaf))
    {
      ReadBezierGrid(vtkUnstructuredGrid::SafeDownCast(leaf), model.Patches);
    }
    else if (HasLayout(leaf))
    {
      throw ChangedLattice("it is a " + std::string(leaf->GetClassName()) + " now");
    }
    else
    {
      throw Error("the input is no control lattice: a " + std::string(leaf->GetClassName()) +
        " without the field data array " + LayoutName +
        " (expected is the output of BSpline Reader or another NURBS filter, or Bezier "
        "hexahedra)");
    }
  }

  if (geometries.empty() && !attributes.empty())
  {
    throw Error("the input has attributes but no geometry: let the dataset " +
      std::string(GeometryName) + " through (Extract Block has dropped it)");
  }
  std::set<PartKey> seen;
  for (Lattice& geometry : geometries)
  {
    const PartKey key{ geometry.Header.PatchId, geometry.Header.FirstSpan };
    if (!seen.insert(key).second)
    {
      throw Error("patch " + std::to_string(geometry.Header.PatchId) +
        " occurs twice: use NURBS Append to join models");
    }
    std::vector<Lattice*> others;
    const auto found = attributes.find(key);
    if (found != attributes.end())
    {
      for (Lattice& other : found->second)
      {
        others.push_back(&other);
      }
    }
    model.Patches.push_back(MakePatch(std::move(geometry), others, domains));
  }
  if (data && data->GetFieldData())
  {
    ReadTopology(data->GetFieldData(), model);
  }
  return model;
}

std::vector<std::string> OwnBasisAttributes(const MultiPatch& model)
{
  std::set<std::string> names;
  for (const Patch& patch : model.Patches)
  {
    for (const Attribute& attribute : patch.Body.Attributes())
    {
      if (!SharesBasis(patch.Body.Geometry(), attribute.Field))
      {
        names.insert(attribute.Name);
      }
    }
  }
  return { names.begin(), names.end() };
}

void ToVTK(MultiPatch model, vtkPartitionedDataSetCollection* output,
  const std::vector<std::string>& attributeDatasets)
{
  std::vector<std::string> own = OwnBasisAttributes(model);
  own.insert(own.end(), attributeDatasets.begin(), attributeDatasets.end());
  std::sort(own.begin(), own.end());
  own.erase(std::unique(own.begin(), own.end()), own.end());

  output->Initialize();
  const auto nameDataset = [output](unsigned int index, const char* name)
  { output->GetMetaData(index)->Set(vtkCompositeDataSet::NAME(), name); };
  output->SetNumberOfPartitionedDataSets(1 + static_cast<unsigned int>(own.size()));
  nameDataset(0, GeometryName);
  for (std::size_t i = 0; i < own.size(); ++i)
  {
    nameDataset(1 + static_cast<unsigned int>(i), own[i].c_str());
  }

  std::vector<unsigned int> partitions(1 + own.size(), 0);
  const auto append = [&](std::size_t dataset, vtkStructuredGrid* grid)
  { output->SetPartition(static_cast<unsigned int>(dataset), partitions[dataset]++, grid); };
  for (Patch& patch : model.Patches)
  {
    // Attributes are large: each goes as soon as it is copied.
    std::vector<Attribute> attributes = std::move(patch.Body).Attributes();
    const Spline geometry = InSpace(patch.Body.Geometry());
    const auto grid = MakeGrid(patch, Layout::Geometry, geometry);
    vtkNew<vtkPoints> points;
    points->SetData(MakeArray("Points", geometry.Coefficients()));
    grid->SetPoints(points);
    append(0, grid);
    // Attributes in one basis have their points in common.
    std::vector<std::pair<std::array<KnotVector, 3>, vtkSmartPointer<vtkPoints>>> made;
    const auto pointsOf = [&](const std::array<KnotVector, 3>& basis) -> vtkPoints*
    {
      for (const auto& [knots, shared] : made)
      {
        if (knots == basis)
        {
          return shared;
        }
      }
      made.emplace_back(basis, GrevillePoints(geometry, basis));
      return made.back().second;
    };
    for (Attribute& item : attributes)
    {
      const std::string name = item.Name;
      std::optional<Spline> field = std::move(item.Field);
      const auto values = MakeArray(name.c_str(), field->Coefficients());
      if (!IsAttribute(values))
      {
        throw Error("an attribute cannot be named \"" + name + "\": rename it");
      }
      if (SharesBasis(geometry, *field))
      {
        grid->GetPointData()->AddArray(values);
        continue;
      }
      const auto lattice = MakeGrid(patch, Layout::Attribute, *field);
      lattice->GetPointData()->AddArray(values);
      const std::array<KnotVector, 3> knots = field->Knots();
      field.reset();
      lattice->SetPoints(pointsOf(knots));
      const auto found = std::lower_bound(own.begin(), own.end(), name);
      append(1 + static_cast<std::size_t>(found - own.begin()), lattice);
    }
  }
  WriteTopology(model, output->GetFieldData());
}

MultiPatch ExtractPiece(const MultiPatch& model, int piece, int numberOfPieces)
{
  MultiPatch result;
  result.Interfaces = model.Interfaces;
  result.Boundaries = model.Boundaries;
  if (model.Patches.empty())
  {
    return result;
  }
  std::vector<double> elements;
  for (const Patch& patch : model.Patches)
  {
    elements.push_back(WholeBlock(patch.Body.Geometry()).Elements());
  }
  const std::vector<int> parts = PartsOfPatches(elements, numberOfPieces);

  std::vector<std::pair<std::size_t, Block>> blocks;
  double total = 0.0;
  for (std::size_t p = 0; p < parts.size(); ++p)
  {
    std::vector<Block> own;
    Divide(WholeBlock(model.Patches[p].Body.Geometry()), parts[p], own);
    for (const Block& block : own)
    {
      blocks.emplace_back(p, block);
    }
    total += elements[p];
  }

  double before = 0.0;
  for (std::size_t b = 0; b < blocks.size(); ++b)
  {
    const auto& [p, block] = blocks[b];
    const double middle = before + 0.5 * block.Elements();
    before += block.Elements();
    const int owner = blocks.size() <= static_cast<std::size_t>(numberOfPieces)
      ? static_cast<int>(b)
      : static_cast<int>(numberOfPieces * middle / total);
    if (owner != piece)
    {
      continue;
    }
    const Patch& patch = model.Patches[p];
    result.Patches.push_back(parts[p] == 1 ? patch : RestrictPatch(patch, block.Begin, block.End));
  }
  return result;
}

}
