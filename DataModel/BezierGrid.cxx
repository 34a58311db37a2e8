// SPDX-License-Identifier: BSD-3-Clause
#include "BezierGrid.h"

#include "ArrayNames.h"
#include "Error.h"
#include "ReadArrays.h"

#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkDataArray.h"
#include "vtkHigherOrderHexahedron.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <utility>

namespace hyperpatch
{

namespace
{

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
      (degrees ? "its " + std::string(names::BezierDegrees) : "one degree in all directions") +
      " (" + DimensionsText(order) + ")");
  }
  return order;
}

/// The columns of these numbers, one after the other.
Eigen::MatrixXd Gather(const SharedColumns& all, const std::vector<vtkIdType>& ids)
{
  const Eigen::Map<const Eigen::MatrixXd> from(all.Data.get(), all.Rows, all.Columns);
  Eigen::MatrixXd columns(all.Rows, static_cast<Eigen::Index>(ids.size()));
  for (Eigen::Index i = 0; i < columns.cols(); ++i)
  {
    columns.col(i) = from.col(ids[static_cast<std::size_t>(i)]);
  }
  return columns;
}

}

bool IsBezierGrid(vtkDataObject* data)
{
  auto grid = vtkUnstructuredGrid::SafeDownCast(data);
  return grid && grid->GetNumberOfCells() > 0 && grid->IsHomogeneous() &&
    grid->GetCellType(0) == VTK_BEZIER_HEXAHEDRON;
}

void ReadBezierGrid(vtkUnstructuredGrid* grid, std::vector<Patch>& patches)
{
  const vtkIdType cells = grid->GetNumberOfCells();
  vtkDataArray* degrees = grid->GetCellData()->GetHigherOrderDegrees();
  degrees = degrees ? degrees : grid->GetCellData()->GetArray(names::BezierDegrees);
  vtkDataArray* rational = grid->GetPointData()->GetRationalWeights();
  rational = rational ? rational : grid->GetPointData()->GetArray(names::BezierWeight);
  vtkDataArray* patchIds = grid->GetCellData()->GetArray(names::PatchId);
  const SharedColumns positions = ReadColumns(grid->GetPoints()->GetData());
  const SharedColumns weightsOfAll = rational ? ReadColumns(rational) : SharedColumns();
  std::vector<std::pair<std::string, SharedColumns>> attributes;
  for (vtkDataArray* array : AttributeArrays(grid))
  {
    if (array != rational)
    {
      attributes.emplace_back(array->GetName(), ReadColumns(array));
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
    std::vector<vtkIdType> ids;
    for (int k = 0; k <= order[2]; ++k)
    {
      for (int j = 0; j <= order[1]; ++j)
      {
        for (int i = 0; i <= order[0]; ++i)
        {
          ids.push_back(points[vtkHigherOrderHexahedron::PointIndexFromIJK(i, j, k, order.data())]);
        }
      }
    }
    Eigen::VectorXd weights;
    if (rational)
    {
      weights = Gather(weightsOfAll, ids).row(0);
    }
    std::vector<Attribute> fields;
    for (const auto& [name, values] : attributes)
    {
      fields.push_back({ name, Spline(knots, Gather(values, ids), weights) });
    }
    Spline geometry(knots, Gather(positions, ids), weights);
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

}
