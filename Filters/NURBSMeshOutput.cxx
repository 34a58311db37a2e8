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
#include <array>
#include <cmath>
#include <limits>
#include <tuple>
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
  CellBlock block{ cells.array() + this->LastOffset, {}, patch.Id, labels,
    this->Points.size() - 1 };
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

void NURBSMeshOutput::MergePoints(std::size_t begin)
{
  std::int64_t offset = 0;
  for (std::size_t b = 0; b < begin; ++b)
  {
    offset += this->Points[b].Points.cols();
  }
  const std::int64_t count = this->NumberOfPoints - offset;
  PointBlock merged;
  merged.Parameters.resize(3, count);
  merged.Points.resize(3, count);
  merged.Normals.resize(3, count);
  for (const auto& [name, components] : this->Components)
  {
    merged.Attributes.emplace(
      name, Eigen::MatrixXd::Constant(components, count, std::numeric_limits<double>::quiet_NaN()));
  }
  // Points of one block have cells of one label.
  std::vector<int> labels(this->Points.size(), 0);
  for (const CellBlock& block : this->Blocks)
  {
    labels[block.Points] = block.Labels[0][0];
  }
  std::map<std::tuple<int, double, double, double>, std::int64_t> numbers;
  std::vector<std::int64_t> numberOf;
  std::int64_t size = 0;
  for (std::size_t b = begin; b < this->Points.size(); ++b)
  {
    const PointBlock& block = this->Points[b];
    for (Eigen::Index i = 0; i < block.Points.cols(); ++i)
    {
      const auto x = block.Points.col(i);
      const auto [at, isNew] = numbers.try_emplace({ labels[b], x[0], x[1], x[2] }, size);
      numberOf.push_back(at->second);
      if (!isNew)
      {
        merged.Normals.col(at->second) += block.Normals.col(i);
        continue;
      }
      merged.Parameters.col(size) = block.Parameters.col(i);
      merged.Points.col(size) = x;
      merged.Normals.col(size) = block.Normals.col(i);
      for (auto& [name, values] : merged.Attributes)
      {
        const auto found = block.Attributes.find(name);
        if (found != block.Attributes.end() && found->second.rows() == values.rows())
        {
          values.col(size) = found->second.col(i);
        }
      }
      ++size;
    }
  }
  merged.Parameters.conservativeResize(3, size);
  merged.Points.conservativeResize(3, size);
  merged.Normals.conservativeResize(3, size);
  for (auto& entry : merged.Attributes)
  {
    entry.second.conservativeResize(entry.second.rows(), size);
  }
  for (Eigen::Index i = 0; i < size; ++i)
  {
    // Two sides of opposite normals, as in a fold, have no mean.
    merged.Normals.col(i) = merged.Normals.col(i).stableNormalized();
  }
  for (CellBlock& block : this->Blocks)
  {
    if (block.Points < begin)
    {
      continue;
    }
    block.Points = begin;
    Eigen::Index kept = 0;
    for (Eigen::Index c = 0; c < block.Indices.cols(); ++c)
    {
      bool isWhole = true;
      for (Eigen::Index k = 0; k < block.Indices.rows(); ++k)
      {
        std::int64_t& corner = block.Indices(k, c);
        corner = offset + numberOf[static_cast<std::size_t>(corner - offset)];
        isWhole = isWhole && (k == 0 || corner != block.Indices(k - 1, c));
      }
      isWhole = isWhole &&
        (block.Indices.rows() == 1 ||
          block.Indices(0, c) != block.Indices(block.Indices.rows() - 1, c));
      if (isWhole)
      {
        block.Indices.col(kept) = block.Indices.col(c);
        block.ElementIds[static_cast<std::size_t>(kept++)] =
          block.ElementIds[static_cast<std::size_t>(c)];
      }
    }
    block.Indices.conservativeResize(Eigen::NoChange, kept);
    block.ElementIds.resize(static_cast<std::size_t>(kept));
  }
  this->Points.resize(begin);
  this->Points.push_back(std::move(merged));
  this->NumberOfPoints = offset + size;
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
          : rows == 4                  ? VTK_TETRA
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
