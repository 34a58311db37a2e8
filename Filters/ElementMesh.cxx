// SPDX-License-Identifier: BSD-3-Clause
#include "ElementMesh.h"

#include "ArrayNames.h"
#include "Evaluator.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkDoubleArray.h"
#include "vtkIdTypeArray.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkSmartPointer.h"
#include "vtkUnsignedCharArray.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace
{

/// The points of VTK_TRIQUADRATIC_HEXAHEDRON on a grid of 3^3; the first 8 are those of
/// VTK_HEXAHEDRON.
constexpr int Nodes[27][3] = { { 0, 0, 0 }, { 2, 0, 0 }, { 2, 2, 0 }, { 0, 2, 0 }, { 0, 0, 2 },
  { 2, 0, 2 }, { 2, 2, 2 }, { 0, 2, 2 }, { 1, 0, 0 }, { 2, 1, 0 }, { 1, 2, 0 }, { 0, 1, 0 },
  { 1, 0, 2 }, { 2, 1, 2 }, { 1, 2, 2 }, { 0, 1, 2 }, { 0, 0, 1 }, { 2, 0, 1 }, { 2, 2, 1 },
  { 0, 2, 1 }, { 0, 1, 1 }, { 2, 1, 1 }, { 1, 0, 1 }, { 1, 2, 1 }, { 1, 1, 0 }, { 1, 1, 2 },
  { 1, 1, 1 } };

vtkSmartPointer<vtkDoubleArray> Triples(const char* name, const std::vector<double>& values)
{
  auto array = vtkSmartPointer<vtkDoubleArray>::New();
  array->SetName(name);
  array->SetNumberOfComponents(3);
  array->SetNumberOfTuples(static_cast<vtkIdType>(values.size() / 3));
  std::copy(values.begin(), values.end(), array->GetPointer(0));
  return array;
}

}

void ElementMesh::Add(const hyperpatch::Patch& patch, int handedness)
{
  const hyperpatch::Spline& geometry = patch.Body.Geometry();
  const std::array<int, 3> p = geometry.Degrees();
  const bool isLinear = !geometry.IsRational() && std::max({ p[0], p[1], p[2] }) == 1;
  const std::size_t step = isLinear ? 1 : 2;
  std::array<std::vector<double>, 3> lines;
  std::array<std::int64_t, 3> spans{};
  std::array<std::int64_t, 3> whole{};
  for (std::size_t d = 0; d < 3; ++d)
  {
    const std::vector<double> breaks = geometry.Knots()[d].Breaks();
    spans[d] = static_cast<std::int64_t>(breaks.size()) - 1;
    whole[d] = patch.WholeSpans[d] > 0 ? patch.WholeSpans[d] : spans[d];
    for (std::size_t i = 0; i + 1 < breaks.size(); ++i)
    {
      lines[d].push_back(breaks[i]);
      if (!isLinear)
      {
        lines[d].push_back(0.5 * (breaks[i] + breaks[i + 1]));
      }
    }
    lines[d].push_back(breaks.back());
  }
  const auto first = static_cast<std::int64_t>(this->Points.size() / 3);
  const std::size_t count = lines[0].size() * lines[1].size() * lines[2].size();
  this->Points.resize(this->Points.size() + 3 * count);
  hyperpatch::Evaluator(geometry).EvaluateGrid(
    lines, this->Points.data() + 3 * static_cast<std::size_t>(first));
  for (const double w : lines[2])
  {
    for (const double v : lines[1])
    {
      for (const double u : lines[0])
      {
        this->Parameters.insert(this->Parameters.end(), { u, v, w });
      }
    }
  }
  const auto nu = static_cast<std::int64_t>(lines[0].size());
  const auto nv = static_cast<std::int64_t>(lines[1].size());
  const auto stride = static_cast<std::int64_t>(step);
  for (std::int64_t k = 0; k < spans[2]; ++k)
  {
    for (std::int64_t j = 0; j < spans[1]; ++j)
    {
      for (std::int64_t i = 0; i < spans[0]; ++i)
      {
        for (int n = 0; n < (isLinear ? 8 : 27); ++n)
        {
          const auto& node = Nodes[n];
          const int across = handedness < 0 ? 2 - node[0] : node[0];
          this->Connectivity.push_back(first + i * stride + across * stride / 2 +
            nu * (j * stride + node[1] * stride / 2 + nv * (k * stride + node[2] * stride / 2)));
        }
        this->Types.push_back(isLinear ? VTK_HEXAHEDRON : VTK_TRIQUADRATIC_HEXAHEDRON);
        this->PatchIds.push_back(patch.Id);
        this->ElementIds.push_back(patch.FirstSpan[0] + i +
          whole[0] * (patch.FirstSpan[1] + j + whole[1] * (patch.FirstSpan[2] + k)));
      }
    }
  }
}

void ElementMesh::Fill(vtkUnstructuredGrid* output) const
{
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->SetData(Triples("Points", this->Points));
  output->SetPoints(points);
  output->GetPointData()->AddArray(
    Triples(hyperpatch::names::ParametricCoordinates, this->Parameters));

  vtkNew<vtkIdTypeArray> connectivity;
  connectivity->SetNumberOfValues(static_cast<vtkIdType>(this->Connectivity.size()));
  std::copy(this->Connectivity.begin(), this->Connectivity.end(), connectivity->GetPointer(0));
  const auto n = static_cast<vtkIdType>(this->Types.size());
  vtkNew<vtkIdTypeArray> offsets;
  vtkNew<vtkUnsignedCharArray> types;
  vtkNew<vtkIntArray> patchIds;
  vtkNew<vtkIdTypeArray> elementIds;
  offsets->SetNumberOfValues(n + 1);
  types->SetNumberOfValues(n);
  patchIds->SetName(hyperpatch::names::PatchId);
  patchIds->SetNumberOfValues(n);
  elementIds->SetName(hyperpatch::names::ElementId);
  elementIds->SetNumberOfValues(n);
  vtkIdType offset = 0;
  for (vtkIdType i = 0; i < n; ++i)
  {
    const auto e = static_cast<std::size_t>(i);
    offsets->SetValue(i, offset);
    offset += this->Types[e] == VTK_HEXAHEDRON ? 8 : 27;
    types->SetValue(i, static_cast<unsigned char>(this->Types[e]));
    patchIds->SetValue(i, this->PatchIds[e]);
    elementIds->SetValue(i, this->ElementIds[e]);
  }
  offsets->SetValue(n, offset);
  vtkNew<vtkCellArray> cells;
  cells->SetData(offsets, connectivity);
  output->SetCells(types, cells);
  output->GetCellData()->AddArray(patchIds);
  output->GetCellData()->AddArray(elementIds);
}
