// SPDX-License-Identifier: BSD-3-Clause
#include "NURBSMeshOutput.h"

#include "ArrayNames.h"
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
#include <iterator>
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

unsigned char CellType(Eigen::Index corners)
{
  return corners == 8 ? VTK_HEXAHEDRON
    : corners == 4    ? VTK_TETRA
    : corners == 3    ? VTK_TRIANGLE
    : corners == 2    ? VTK_LINE
                      : VTK_VERTEX;
}

/// So many points or cells are worked on between two looks for Cancel.
constexpr vtkIdType Step = 1 << 14;

/// Copying, in pieces that wait for nothing and for which nobody waits long.
class Copies
{
public:
  using Function = std::function<void(vtkIdType begin, vtkIdType end)>;

  void Add(vtkIdType count, Function function)
  {
    for (vtkIdType begin = 0; begin < count; begin += Step)
    {
      this->Ranges.push_back({ this->Functions.size(), begin, std::min(begin + Step, count) });
    }
    this->Functions.push_back(std::move(function));
  }

  void Run(const hyperpatch::ParallelFor& parallelFor) const
  {
    parallelFor(static_cast<std::ptrdiff_t>(this->Ranges.size()), 1,
      [this](std::ptrdiff_t begin, std::ptrdiff_t end)
      {
        for (auto r = static_cast<std::size_t>(begin); r < static_cast<std::size_t>(end); ++r)
        {
          const Range& range = this->Ranges[r];
          this->Functions[range.Function](range.Begin, range.End);
        }
      });
  }

private:
  struct Range
  {
    std::size_t Function;
    vtkIdType Begin, End;
  };
  std::vector<Function> Functions;
  std::vector<Range> Ranges;
};

/// Columns [begin, end) into the tuples from `first + begin` on.
template <typename Matrix>
void CopyColumns(
  const Matrix& from, vtkIdType begin, vtkIdType end, vtkDoubleArray* to, vtkIdType first)
{
  const Eigen::Index rows = from.rows();
  std::copy_n(
    from.data() + rows * begin, rows * (end - begin), to->GetPointer(rows * (first + begin)));
}

/// Cells, of which all are announced before the first is added.
class CellList
{
public:
  struct Place
  {
    vtkIdType Cell, Corner;
  };

  void Reserve(const NURBSMeshOutput::Cells& cells)
  {
    this->Cells += cells.cols();
    this->Corners += cells.size();
  }

  /// Where the cells go to; Copy() takes them there.
  Place Add(const NURBSMeshOutput::Cells& cells)
  {
    if (this->Ends->GetNumberOfValues() == 0)
    {
      this->Ids->SetNumberOfValues(this->Corners);
      this->Ends->SetNumberOfValues(this->Cells + 1);
      this->Cells = this->Corners = 0;
      this->Ends->SetValue(0, 0);
    }
    const Place place{ this->Cells, this->Corners };
    this->Reserve(cells);
    return place;
  }

  void Copy(const NURBSMeshOutput::Cells& cells, vtkIdType begin, vtkIdType end, Place place)
  {
    static_assert(sizeof(vtkIdType) == sizeof(std::int64_t), "64-bit ids are needed");
    const Eigen::Index rows = cells.rows();
    std::copy_n(cells.data() + rows * begin, rows * (end - begin),
      this->Ids->GetPointer(place.Corner + rows * begin));
    vtkIdType* const ends = this->Ends->GetPointer(place.Cell + 1);
    for (vtkIdType c = begin; c < end; ++c)
    {
      ends[c] = place.Corner + rows * (c + 1);
    }
  }

  [[nodiscard]] vtkSmartPointer<vtkCellArray> Make() const
  {
    auto cells = vtkSmartPointer<vtkCellArray>::New();
    if (this->Cells > 0)
    {
      cells->SetData(this->Ends, this->Ids);
    }
    return cells;
  }

private:
  vtkIdType Cells = 0;
  vtkIdType Corners = 0;
  vtkNew<vtkIdTypeArray> Ends, Ids;
};

}

NURBSMeshOutput::NURBSMeshOutput(
  std::map<std::string, int> components, std::vector<std::string> labels)
  : Components(std::move(components))
  , Labels(std::move(labels))
{
}

void NURBSMeshOutput::AddPoints(const hyperpatch::Patch& patch, Eigen::Matrix3Xd parameters,
  Eigen::Matrix3Xd points, Eigen::Matrix3Xd normals, std::vector<Eigen::MatrixXd> attributes)
{
  PointBlock block{ std::move(parameters), std::move(points), std::move(normals), {} };
  block.Attributes.resize(this->Components.size());
  for (std::size_t a = 0; a < attributes.size(); ++a)
  {
    const auto found = this->Components.find(patch.Body.Attributes()[a].Name);
    if (found != this->Components.end() && found->second == attributes[a].rows())
    {
      const auto index = std::distance(this->Components.begin(), found);
      block.Attributes[static_cast<std::size_t>(index)] = std::move(attributes[a]);
    }
  }
  this->LastOffset = this->NumberOfPoints;
  this->NumberOfPoints += block.Points.cols();
  this->Points.push_back(std::move(block));
}

void NURBSMeshOutput::AddCells(const hyperpatch::Patch& patch, Cells cells,
  Eigen::Matrix3Xi elements, std::vector<std::vector<int>> labels)
{
  if (cells.cols() == 0)
  {
    return;
  }
  if (this->LastOffset > 0)
  {
    cells.array() += this->LastOffset;
  }
  CellBlock block{ std::move(cells), std::move(elements), {}, patch.Id, std::move(labels),
    this->Points.size() - 1 };
  for (std::size_t d = 0; d < 3; ++d)
  {
    const auto own = static_cast<int>(patch.Body.Geometry().Knots()[d].Spans().size());
    block.Spans[d] = patch.WholeSpans[d] > 0 ? patch.WholeSpans[d] : own;
  }
  this->Blocks.push_back(std::move(block));
}

void NURBSMeshOutput::MergePoints(std::size_t begin, const std::function<void()>& check)
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
    merged.Attributes.push_back(
      Eigen::MatrixXd::Constant(components, count, std::numeric_limits<double>::quiet_NaN()));
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
      if (numberOf.size() % Step == 0)
      {
        check();
      }
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
      for (std::size_t a = 0; a < merged.Attributes.size(); ++a)
      {
        if (block.Attributes[a].cols() > 0)
        {
          merged.Attributes[a].col(size) = block.Attributes[a].col(i);
        }
      }
      ++size;
    }
  }
  merged.Parameters.conservativeResize(3, size);
  merged.Points.conservativeResize(3, size);
  merged.Normals.conservativeResize(3, size);
  for (Eigen::MatrixXd& values : merged.Attributes)
  {
    values.conservativeResize(values.rows(), size);
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
        block.Elements.col(kept++) = block.Elements.col(c);
      }
    }
    block.Indices.conservativeResize(Eigen::NoChange, kept);
    block.Elements.conservativeResize(Eigen::NoChange, kept);
    check();
  }
  this->Points.resize(begin);
  this->Points.push_back(std::move(merged));
  this->NumberOfPoints = offset + size;
}

void NURBSMeshOutput::Fill(vtkPointSet* output, const hyperpatch::ParallelFor& parallelFor) const
{
  this->FillPoints(output, parallelFor);
  this->FillCells(output, parallelFor);
}

void NURBSMeshOutput::FillPoints(
  vtkPointSet* output, const hyperpatch::ParallelFor& parallelFor) const
{
  const auto n = static_cast<vtkIdType>(this->NumberOfPoints);
  const auto coordinates = NewArray("Points", 3, n);
  const auto normals = NewArray(hyperpatch::names::Normals, 3, n);
  const auto parameters = NewArray(hyperpatch::names::ParametricCoordinates, 3, n);
  std::vector<vtkSmartPointer<vtkDoubleArray>> attributes;
  for (const auto& [name, components] : this->Components)
  {
    attributes.push_back(NewArray(name.c_str(), components, n));
  }
  bool haveNormals = true;
  Copies copies;
  vtkIdType first = 0;
  for (const PointBlock& block : this->Points)
  {
    const bool hasNormals = block.Normals.cols() == block.Points.cols();
    haveNormals = haveNormals && hasNormals;
    copies.Add(block.Points.cols(),
      [&, hasNormals, first](vtkIdType begin, vtkIdType end)
      {
        CopyColumns(block.Points, begin, end, coordinates, first);
        CopyColumns(block.Parameters, begin, end, parameters, first);
        if (hasNormals)
        {
          CopyColumns(block.Normals, begin, end, normals, first);
        }
        for (std::size_t a = 0; a < attributes.size(); ++a)
        {
          if (block.Attributes[a].cols() > 0)
          {
            CopyColumns(block.Attributes[a], begin, end, attributes[a], first);
            continue;
          }
          const int components = attributes[a]->GetNumberOfComponents();
          std::fill_n(attributes[a]->GetPointer(components * (first + begin)),
            components * (end - begin), std::nan(""));
        }
      });
    first += block.Points.cols();
  }
  copies.Run(parallelFor);
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->SetData(coordinates);
  output->SetPoints(points);
  if (haveNormals)
  {
    output->GetPointData()->SetNormals(normals);
  }
  output->GetPointData()->AddArray(parameters);
  for (const auto& array : attributes)
  {
    output->GetPointData()->AddArray(array);
  }
}

void NURBSMeshOutput::FillCells(
  vtkPointSet* output, const hyperpatch::ParallelFor& parallelFor) const
{
  // Cells of fewer points come first: vertices, lines, polygons is the order of vtkPolyData.
  std::vector<const CellBlock*> blocks;
  for (const CellBlock& block : this->Blocks)
  {
    blocks.push_back(&block);
  }
  std::stable_sort(blocks.begin(), blocks.end(),
    [](const CellBlock* a, const CellBlock* b) { return a->Indices.rows() < b->Indices.rows(); });

  // By the number of corners; in an unstructured grid all in one.
  auto* const mesh = vtkPolyData::SafeDownCast(output);
  std::map<Eigen::Index, CellList> lists;
  const auto listOf = [&lists, mesh](const CellBlock& block) -> CellList&
  { return lists[mesh ? block.Indices.rows() : 0]; };
  vtkIdType count = 0;
  for (const CellBlock* block : blocks)
  {
    listOf(*block).Reserve(block->Indices);
    count += block->Indices.cols();
  }
  const auto newArray = [count](auto array, const char* name)
  {
    array->SetName(name);
    array->SetNumberOfTuples(count);
    return array;
  };
  const auto patchIds = newArray(vtkSmartPointer<vtkIntArray>::New(), hyperpatch::names::PatchId);
  const auto elementIds =
    newArray(vtkSmartPointer<vtkIdTypeArray>::New(), hyperpatch::names::ElementId);
  const auto types = newArray(vtkSmartPointer<vtkUnsignedCharArray>::New(), nullptr);
  std::vector<vtkSmartPointer<vtkIntArray>> labels;
  for (const std::string& name : this->Labels)
  {
    labels.push_back(newArray(vtkSmartPointer<vtkIntArray>::New(), name.c_str()));
  }
  Copies copies;
  vtkIdType first = 0;
  for (const CellBlock* block : blocks)
  {
    CellList& list = listOf(*block);
    const CellList::Place place = list.Add(block->Indices);
    copies.Add(block->Indices.cols(),
      [&, block, place, first](vtkIdType begin, vtkIdType end)
      {
        const vtkIdType size = end - begin;
        list.Copy(block->Indices, begin, end, place);
        std::fill_n(types->GetPointer(first + begin), size, CellType(block->Indices.rows()));
        std::fill_n(patchIds->GetPointer(first + begin), size, block->PatchId);
        const auto& spans = block->Spans;
        for (vtkIdType c = begin; c < end; ++c)
        {
          const auto element = block->Elements.col(c);
          elementIds->SetValue(
            first + c, element[0] + spans[0] * (element[1] + spans[1] * element[2]));
        }
        for (std::size_t l = 0; l < labels.size(); ++l)
        {
          const std::vector<int>& values = block->Labels[l];
          int* const to = labels[l]->GetPointer(first + begin);
          values.size() == 1 ? std::fill_n(to, size, values[0])
                             : std::copy_n(values.data() + begin, size, to);
        }
      });
    first += block->Indices.cols();
  }
  copies.Run(parallelFor);
  if (mesh)
  {
    for (const auto& [rows, list] : lists)
    {
      const auto cells = list.Make();
      rows == 1 ? mesh->SetVerts(cells) : rows == 2 ? mesh->SetLines(cells) : mesh->SetPolys(cells);
    }
  }
  else if (auto* grid = vtkUnstructuredGrid::SafeDownCast(output))
  {
    grid->SetCells(types, lists[0].Make());
  }
  output->GetCellData()->AddArray(patchIds);
  output->GetCellData()->AddArray(elementIds);
  for (const auto& array : labels)
  {
    output->GetCellData()->AddArray(array);
  }
}
