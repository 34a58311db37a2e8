// SPDX-License-Identifier: BSD-3-Clause
#include "NURBSMeshOutput.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkDoubleArray.h"
#include "vtkIdTypeArray.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkUnsignedCharArray.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace
{

vtkSmartPointer<vtkDoubleArray> NewArray(const char* name, int components, vtkIdType tuples)
{
  auto array = vtkSmartPointer<vtkDoubleArray>::New();
  array->SetName(name);
  array->SetNumberOfComponents(components);
  array->SetNumberOfTuples(tuples);
  return array;
}

}

NURBSMeshOutput::NURBSMeshOutput(
  std::map<std::string, int> components, std::vector<std::string> labels)
  : Components(std::move(components))
  , Labels(std::move(labels))
{
}

void NURBSMeshOutput::AddPoints(const hyperpatch::Patch& patch, const Eigen::Matrix3Xd& parameters,
  const Eigen::Matrix3Xd& points, const Eigen::Matrix3Xd& normals,
  const std::vector<Eigen::MatrixXd>& attributes)
{
  PointBlock block{ parameters, points, normals, {} };
  for (std::size_t a = 0; a < attributes.size(); ++a)
  {
    block.Attributes.emplace(patch.Body.Attributes()[a].Name, attributes[a]);
  }
  this->Points.push_back(std::move(block));
  this->LastOffset = this->NumberOfPoints;
  this->NumberOfPoints += points.cols();
}

void NURBSMeshOutput::AddCells(const hyperpatch::Patch& patch, const Cells& cells,
  const Eigen::Matrix3Xi& elements, const std::vector<std::vector<int>>& labels)
{
  if (cells.cols() == 0)
  {
    return;
  }
  CellBlock block{ cells.array() + this->LastOffset, {}, patch.Id, labels };
  std::array<std::int64_t, 3> whole{};
  for (std::size_t d = 0; d < 3; ++d)
  {
    const auto own = static_cast<int>(patch.Body.Geometry().Knots()[d].Spans().size());
    whole[d] = patch.WholeSpans[d] > 0 ? patch.WholeSpans[d] : own;
  }
  block.ElementIds.reserve(static_cast<std::size_t>(cells.cols()));
  for (Eigen::Index c = 0; c < cells.cols(); ++c)
  {
    block.ElementIds.push_back(
      elements(0, c) + whole[0] * (elements(1, c) + whole[1] * elements(2, c)));
  }
  this->Blocks.push_back(std::move(block));
}

void NURBSMeshOutput::Fill(vtkPointSet* output) const
{
  const auto n = static_cast<vtkIdType>(this->NumberOfPoints);
  const auto coordinates = NewArray("Points", 3, n);
  const auto normals = NewArray("Normals", 3, n);
  const auto parameters = NewArray("ParametricCoordinates", 3, n);
  bool haveNormals = true;
  vtkIdType at = 0;
  for (const PointBlock& block : this->Points)
  {
    std::copy_n(block.Points.data(), block.Points.size(), coordinates->GetPointer(3 * at));
    if (block.Normals.cols() == block.Points.cols())
    {
      std::copy_n(block.Normals.data(), block.Normals.size(), normals->GetPointer(3 * at));
    }
    else
    {
      haveNormals = false;
    }
    std::copy_n(block.Parameters.data(), block.Parameters.size(), parameters->GetPointer(3 * at));
    at += block.Points.cols();
  }
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->SetData(coordinates);
  output->SetPoints(points);
  if (haveNormals)
  {
    output->GetPointData()->SetNormals(normals);
  }
  output->GetPointData()->AddArray(parameters);
  for (const auto& [name, components] : this->Components)
  {
    const auto array = NewArray(name.c_str(), components, n);
    double* to = array->GetPointer(0);
    for (const PointBlock& block : this->Points)
    {
      const auto found = block.Attributes.find(name);
      const bool there = found != block.Attributes.end() && found->second.rows() == components;
      to = there ? std::copy_n(found->second.data(), found->second.size(), to)
                 : std::fill_n(to, components * block.Points.cols(), std::nan(""));
    }
    output->GetPointData()->AddArray(array);
  }

  // Cells of fewer points come first: vertices, lines, polygons is the order of vtkPolyData.
  std::vector<const CellBlock*> blocks;
  for (const CellBlock& block : this->Blocks)
  {
    blocks.push_back(&block);
  }
  std::stable_sort(blocks.begin(), blocks.end(),
    [](const CellBlock* a, const CellBlock* b) { return a->Indices.rows() < b->Indices.rows(); });
  vtkNew<vtkIntArray> patchIds;
  patchIds->SetName("PatchId");
  vtkNew<vtkIdTypeArray> elementIds;
  elementIds->SetName("ElementId");
  std::vector<vtkSmartPointer<vtkIntArray>> labels;
  for (const std::string& name : this->Labels)
  {
    labels.push_back(vtkSmartPointer<vtkIntArray>::New());
    labels.back()->SetName(name.c_str());
  }
  std::map<Eigen::Index, vtkSmartPointer<vtkCellArray>> cells;
  vtkNew<vtkUnsignedCharArray> types;
  vtkNew<vtkCellArray> all;
  const auto* polyData = vtkPolyData::SafeDownCast(output);
  for (const CellBlock* block : blocks)
  {
    const Eigen::Index rows = block->Indices.rows();
    vtkSmartPointer<vtkCellArray>& kind = cells[rows];
    if (!kind)
    {
      kind = polyData ? vtkSmartPointer<vtkCellArray>::New() : vtkSmartPointer<vtkCellArray>(all);
    }
    for (Eigen::Index c = 0; c < block->Indices.cols(); ++c)
    {
      static_assert(sizeof(vtkIdType) == sizeof(std::int64_t), "64-bit ids are needed");
      kind->InsertNextCell(static_cast<vtkIdType>(rows),
        reinterpret_cast<const vtkIdType*>(block->Indices.col(c).data()));
      types->InsertNextValue(rows == 8 ? VTK_HEXAHEDRON
          : rows == 3                  ? VTK_TRIANGLE
          : rows == 2                  ? VTK_LINE
                                       : VTK_VERTEX);
      patchIds->InsertNextValue(block->PatchId);
      elementIds->InsertNextValue(block->ElementIds[static_cast<std::size_t>(c)]);
      for (std::size_t l = 0; l < labels.size(); ++l)
      {
        const std::vector<int>& values = block->Labels[l];
        labels[l]->InsertNextValue(
          values.size() == 1 ? values[0] : values[static_cast<std::size_t>(c)]);
      }
    }
  }
  if (auto* mesh = vtkPolyData::SafeDownCast(output))
  {
    const auto set = [&cells](Eigen::Index rows, auto setter)
    {
      if (cells.count(rows))
      {
        setter(cells.at(rows));
      }
    };
    set(1, [mesh](vtkCellArray* c) { mesh->SetVerts(c); });
    set(2, [mesh](vtkCellArray* c) { mesh->SetLines(c); });
    set(3, [mesh](vtkCellArray* c) { mesh->SetPolys(c); });
  }
  else if (auto* grid = vtkUnstructuredGrid::SafeDownCast(output))
  {
    grid->SetCells(types, all);
  }
  output->GetCellData()->AddArray(patchIds);
  output->GetCellData()->AddArray(elementIds);
  for (const auto& array : labels)
  {
    output->GetCellData()->AddArray(array);
  }
}
