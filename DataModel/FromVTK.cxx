// SPDX-License-Identifier: BSD-3-Clause
#include "ArrayNames.h"
#include "BezierGrid.h"
#include "Error.h"
#include "LatticeLayout.h"
#include "Measures.h"
#include "NURBSConversion.h"
#include "ReadArrays.h"
#include "Reparametrise.h"

#include "vtkCompositeDataIterator.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkIntArray.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkSmartPointer.h"
#include "vtkStringArray.h"
#include "vtkStructuredGrid.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace hyperpatch
{

namespace
{

/// What joins the attribute grids of a patch to its geometry grid.
using PartKey = std::tuple<int, std::array<int, 3>>;

bool HasLayout(vtkDataObject* data)
{
  vtkFieldData* field = data->GetFieldData();
  return field && field->GetAbstractArray(names::Layout);
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

/// What an upstream filter has done to a lattice, as the user should hear it.
Error ChangedLattice(const std::string& details)
{
  return Error("the control lattice was changed by an upstream filter (" + details +
    "): use NURBS Refine in its place");
}

LatticeLayout ReadLayout(vtkDataObject* grid)
{
  auto array = vtkDataArray::SafeDownCast(grid->GetFieldData()->GetAbstractArray(names::Layout));
  if (!array || array->GetNumberOfValues() < 1)
  {
    throw Error(std::string("the field data array ") + names::Layout + " holds no integers");
  }
  std::array<int, LatticeLayout::Size> values{};
  const auto value = [array](int i)
  {
    const int components = array->GetNumberOfComponents();
    return static_cast<int>(array->GetComponent(i / components, i % components));
  };
  if (value(0) != LatticeLayout::CurrentVersion ||
    array->GetNumberOfValues() != LatticeLayout::Size)
  {
    throw Error(std::string("the field data array ") + names::Layout + " has version " +
      std::to_string(value(0)) + " and " + std::to_string(array->GetNumberOfValues()) +
      " integers, this program knows version " + std::to_string(LatticeLayout::CurrentVersion) +
      " of " + std::to_string(LatticeLayout::Size));
  }
  for (int i = 0; i < LatticeLayout::Size; ++i)
  {
    values[static_cast<std::size_t>(i)] = value(i);
  }
  LatticeLayout layout = LatticeLayout::Unpack(values);
  for (std::size_t d = 0; d < 3; ++d)
  {
    if (layout.Dimensions[d] < 1 || layout.Degrees[d] < 0 || layout.Degrees[d] > MaxDegree)
    {
      throw Error(std::string("the field data array ") + names::Layout + " of patch " +
        std::to_string(layout.PatchId) + " has the dimensions " +
        DimensionsText(layout.Dimensions) + " and degrees " + DimensionsText(layout.Degrees));
    }
  }
  return layout;
}

std::array<KnotVector, 3> ReadKnots(vtkDataObject* grid, const LatticeLayout& layout)
{
  auto array = vtkDataArray::SafeDownCast(grid->GetFieldData()->GetAbstractArray(names::Knots));
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

/// A lattice as one spline per array, all in one basis.
struct Lattice
{
  LatticeLayout Header;
  std::optional<Spline> Points; ///< of a geometry; those of attributes are for looking at
  std::vector<Attribute> Arrays;
};

Lattice ReadLattice(vtkStructuredGrid* grid)
{
  LatticeLayout layout = ReadLayout(grid);
  std::array<int, 3> dimensions{};
  grid->GetDimensions(dimensions.data());
  if (dimensions != layout.Dimensions)
  {
    throw ChangedLattice("it has " + DimensionsText(dimensions) + " points, its knots are for " +
      DimensionsText(layout.Dimensions));
  }
  const std::array<KnotVector, 3> knots = ReadKnots(grid, layout);
  SharedColumns weights;
  if (layout.Rational)
  {
    vtkDataArray* array = grid->GetPointData()->GetArray(names::Weight);
    if (!array || array->GetNumberOfComponents() != 1)
    {
      throw Error("patch " + std::to_string(layout.PatchId) +
        " is rational but its lattice has no point data array " + names::Weight +
        ": an upstream filter (Pass Arrays, Point To Cell) has dropped it");
    }
    weights = ReadColumns(array);
  }
  std::vector<Attribute> arrays;
  for (vtkDataArray* array : AttributeArrays(grid))
  {
    arrays.push_back({ array->GetName(), Spline(knots, ReadColumns(array), weights) });
  }
  std::optional<Spline> points;
  if (layout.Role == LatticeLayout::Geometry)
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
  const LatticeLayout& layout = geometry.Header;
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

void ReadTopology(vtkFieldData* field, MultiPatch& model)
{
  auto interfaces = vtkIntArray::SafeDownCast(field->GetAbstractArray(names::Interfaces));
  auto names = vtkStringArray::SafeDownCast(field->GetAbstractArray(names::BoundaryNames));
  auto sides = vtkIntArray::SafeDownCast(field->GetAbstractArray(names::BoundarySides));
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
      throw Error(std::string("the field data array ") + names::BoundarySides + " names boundary " +
        std::to_string(item[0]) + " of " + std::to_string(names->GetNumberOfValues()));
    }
    model.Boundaries[static_cast<std::size_t>(item[0])].Sides.push_back({ item[1], item[2] });
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
      if (lattice.Header.Role == LatticeLayout::Geometry)
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
        " without the field data array " + names::Layout +
        " (expected is the output of BSpline Reader or another NURBS filter, or Bezier "
        "hexahedra)");
    }
  }

  if (geometries.empty() && !attributes.empty())
  {
    throw Error("the input has attributes but no geometry: let the dataset " +
      std::string(names::Geometry) + " through (Extract Block has dropped it)");
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

}
