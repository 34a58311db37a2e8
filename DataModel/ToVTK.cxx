// SPDX-License-Identifier: BSD-3-Clause
#include "ArrayNames.h"
#include "Error.h"
#include "Evaluator.h"
#include "LatticeLayout.h"
#include "Measures.h"
#include "NURBSConversion.h"

#include "vtkCompositeDataSet.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkInformation.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkSmartPointer.h"
#include "vtkStringArray.h"
#include "vtkStructuredGrid.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <set>
#include <type_traits>
#include <utility>

namespace hyperpatch
{

namespace
{

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
  LatticeLayout layout;
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
  if (role == LatticeLayout::Geometry && patch.WholeSpans != std::array<int, 3>{ 0, 0, 0 })
  {
    layout.RelativeHandedness = patch.WholeHandedness * Handedness(patch.Body.Geometry());
  }

  auto grid = vtkSmartPointer<vtkStructuredGrid>::New();
  grid->SetDimensions(layout.Dimensions.data());
  if (basis.IsRational())
  {
    grid->GetPointData()->AddArray(MakeArray(names::Weight, basis.Weights().transpose()));
  }

  vtkNew<vtkIntArray> header;
  header->SetName(names::Layout);
  const auto packed = layout.Pack();
  header->SetNumberOfValues(LatticeLayout::Size);
  std::copy(packed.begin(), packed.end(), header->GetPointer(0));
  vtkNew<vtkDoubleArray> knots;
  knots->SetName(names::Knots);
  knots->SetNumberOfValues(layout.NumberOfKnots());
  double* next = knots->GetPointer(0);
  for (const KnotVector& direction : basis.Knots())
  {
    next = std::copy(direction.Knots().begin(), direction.Knots().end(), next);
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
  const auto control = geometry.Coefficients();
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
  interfaces->SetName(names::Interfaces);
  interfaces->SetNumberOfComponents(10);
  for (const Interface& item : model.Interfaces)
  {
    interfaces->InsertNextTypedTuple(item.Values.data());
  }
  vtkNew<vtkStringArray> names;
  names->SetName(names::BoundaryNames);
  vtkNew<vtkIntArray> sides;
  sides->SetName(names::BoundarySides);
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
  nameDataset(0, names::Geometry);
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
    const auto grid = MakeGrid(patch, LatticeLayout::Geometry, geometry);
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
      if (!names::IsAttribute(name))
      {
        throw Error("an attribute cannot be named \"" + name + "\": rename it");
      }
      const auto values = MakeArray(name.c_str(), field->Coefficients());
      if (SharesBasis(geometry, *field))
      {
        grid->GetPointData()->AddArray(values);
        continue;
      }
      const auto lattice = MakeGrid(patch, LatticeLayout::Attribute, *field);
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

}
