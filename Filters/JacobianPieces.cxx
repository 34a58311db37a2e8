// SPDX-License-Identifier: BSD-3-Clause
#include "JacobianPieces.h"

#include "Aggregate.h"
#include "JacobianField.h"
#include "vtkNURBSJacobianBoundary.h"

#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkIdList.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <set>
#include <utility>

namespace
{

using Parameter = std::array<double, 3>;

/// What is asked of the mesh again and again.
class Mesh
{
public:
  explicit Mesh(vtkPolyData* mesh)
    : Data(mesh)
    , Patches(mesh->GetCellData()->GetArray("PatchId"))
    , Pieces(mesh->GetCellData()->GetArray("Piece"))
    , Parameters(mesh->GetPointData()->GetArray("ParametricCoordinates"))
  {
  }

  [[nodiscard]] vtkIdType Points() const { return this->Data->GetNumberOfPoints(); }
  [[nodiscard]] vtkIdType Cells() const { return this->Data->GetNumberOfCells(); }
  [[nodiscard]] int Patch(vtkIdType cell) const
  {
    return static_cast<int>(this->Patches->GetComponent(cell, 0));
  }
  [[nodiscard]] int Piece(vtkIdType cell) const
  {
    return static_cast<int>(this->Pieces->GetComponent(cell, 0));
  }
  [[nodiscard]] Parameter ParameterOf(vtkIdType point) const
  {
    Parameter at{};
    this->Parameters->GetTuple(point, at.data());
    return at;
  }
  /// Calls body(cell, points of the cell) for all cells.
  template <class Body>
  void ForCells(const Body& body) const
  {
    vtkNew<vtkIdList> corners;
    for (vtkIdType cell = 0; cell < this->Cells(); ++cell)
    {
      this->Data->GetCellPoints(cell, corners);
      body(cell, *corners);
    }
  }

private:
  vtkPolyData* Data;
  vtkDataArray* Patches;
  vtkDataArray* Pieces;
  vtkDataArray* Parameters;
};

/// Sets that grow together, of 0 .. count - 1; each is known by its least member.
class Union
{
public:
  explicit Union(std::size_t count)
    : Parents(count)
  {
    std::iota(this->Parents.begin(), this->Parents.end(), std::size_t{ 0 });
  }

  std::size_t Find(std::size_t i)
  {
    while (this->Parents[i] != i)
    {
      this->Parents[i] = this->Parents[this->Parents[i]];
      i = this->Parents[i];
    }
    return i;
  }

  void Join(std::size_t a, std::size_t b)
  {
    a = this->Find(a);
    b = this->Find(b);
    this->Parents[std::max(a, b)] = std::min(a, b);
  }

private:
  std::vector<std::size_t> Parents;
};

/// What decides whether points of different blocks and ranks are one: patch, piece, parameters. The
/// same point differs by round-off from rank to rank, so these are rounded to single precision.
using PointKey = std::array<double, 5>;

/// Whether a patch has one piece of that kind at most, however it is divided.
bool IsWhole(int piece)
{
  return piece < vtkNURBSJacobianBoundary::KNOT_PLANE || piece == vtkNURBSJacobianBoundary::CELLS;
}

PointKey KeyOf(int patch, int piece, const Parameter& at)
{
  PointKey key{ static_cast<double>(patch), static_cast<double>(piece) };
  for (std::size_t d = 0; d < 3; ++d)
  {
    key[2 + d] = static_cast<float>(at[d]);
  }
  return key;
}

/// Values of parameters on which the parts of a patch here may meet others: cuts and C0 knot
/// planes.
std::map<int, std::array<std::set<float>, 3>> SeamsOf(const hyperpatch::MultiPatch& model)
{
  std::map<int, std::array<std::set<float>, 3>> seams;
  for (const hyperpatch::Patch& patch : model.Patches)
  {
    for (std::size_t d = 0; d < 3; ++d)
    {
      const hyperpatch::KnotVector& knots = patch.Body.Geometry().Knots()[d];
      std::set<float>& at = seams[patch.Id][d];
      for (const double crease : knots.Creases())
      {
        at.insert(static_cast<float>(crease));
      }
      if (!patch.IsDomainFace[2 * d])
      {
        at.insert(static_cast<float>(knots.First()));
      }
      if (!patch.IsDomainFace[2 * d + 1])
      {
        at.insert(static_cast<float>(knots.Last()));
      }
    }
  }
  return seams;
}

}

void JacobianPieces::RemoveSheetsInFaces(const hyperpatch::MultiPatch& model, vtkPolyData* output)
{
  const Mesh mesh(output);
  std::set<vtkIdType> removed;
  for (const hyperpatch::Patch& patch : model.Patches)
  {
    // Triangles with their corners in a face. At its border a sheet may have some whose inside is
    // not in it: there det J is not 0.
    std::vector<vtkIdType> cells;
    std::vector<double> middles;
    mesh.ForCells(
      [&](vtkIdType cell, vtkIdList& corners)
      {
        if (mesh.Patch(cell) != patch.Id || mesh.Piece(cell) != vtkNURBSJacobianBoundary::SHEET)
        {
          return;
        }
        Parameter middle{};
        std::array<bool, 6> isIn = patch.IsDomainFace;
        for (const vtkIdType corner : corners)
        {
          const Parameter at = mesh.ParameterOf(corner);
          for (std::size_t side = 0; side < isIn.size(); ++side)
          {
            const hyperpatch::KnotVector& knots = patch.Body.Geometry().Knots()[side / 2];
            isIn[side] =
              isIn[side] && at[side / 2] == (side % 2 == 0 ? knots.First() : knots.Last());
          }
          for (std::size_t d = 0; d < 3; ++d)
          {
            middle[d] += at[d] / 3.0;
          }
        }
        const auto side = std::find(isIn.begin(), isIn.end(), true);
        if (side != isIn.end())
        {
          const auto d = static_cast<std::size_t>(side - isIn.begin()) / 2;
          middle[d] = mesh.ParameterOf(corners.GetId(0))[d];
          cells.push_back(cell);
          middles.insert(middles.end(), middle.begin(), middle.end());
        }
      });
    if (cells.empty())
    {
      continue;
    }
    std::vector<double> values(cells.size());
    hyperpatch::JacobianField(patch.Body.Geometry())
      .Evaluate(cells.size(), middles.data(), values.data());
    for (std::size_t i = 0; i < cells.size(); ++i)
    {
      if (values[i] == 0.0)
      {
        removed.insert(cells[i]);
      }
    }
  }
  if (removed.empty())
  {
    return;
  }
  vtkNew<vtkIdList> kept;
  for (vtkIdType cell = 0; cell < mesh.Cells(); ++cell)
  {
    if (removed.count(cell) == 0)
    {
      kept->InsertNextId(cell);
    }
  }
  vtkNew<vtkPolyData> rest;
  rest->AllocateCopy(output);
  vtkNew<vtkPoints> points;
  points->SetDataType(output->GetPoints()->GetDataType());
  rest->SetPoints(points);
  rest->GetPointData()->CopyAllocate(output->GetPointData());
  rest->GetCellData()->CopyAllocate(output->GetCellData());
  rest->CopyCells(output, kept);
  rest->GetFieldData()->ShallowCopy(output->GetFieldData());
  output->ShallowCopy(rest);
}

void JacobianPieces::AddDeterminant(const hyperpatch::MultiPatch& model, vtkPolyData* output)
{
  const Mesh mesh(output);
  vtkNew<vtkDoubleArray> values;
  values->SetName("JacobianDeterminant");
  values->SetNumberOfTuples(mesh.Points());
  values->Fill(0.0);

  const auto count = static_cast<std::size_t>(mesh.Points());
  std::vector<int> patchOf(count, -1);
  std::vector<int> pieceOf(count, -1);
  mesh.ForCells(
    [&](vtkIdType cell, vtkIdList& corners)
    {
      for (const vtkIdType point : corners)
      {
        patchOf[static_cast<std::size_t>(point)] = mesh.Patch(cell);
        pieceOf[static_cast<std::size_t>(point)] = mesh.Piece(cell);
      }
    });
  for (const hyperpatch::Patch& patch : model.Patches)
  {
    const hyperpatch::Spline& geometry = patch.Body.Geometry();
    if (geometry.Dimension() < 3)
    {
      continue;
    }
    std::array<std::vector<double>, 3> creases;
    for (std::size_t d = 0; d < 3; ++d)
    {
      creases[d] = geometry.Knots()[d].Creases();
    }
    std::vector<vtkIdType> points;
    std::vector<double> parameters;
    for (std::size_t i = 0; i < count; ++i)
    {
      const auto point = static_cast<vtkIdType>(i);
      const Parameter at = mesh.ParameterOf(point);
      bool isHere = patchOf[i] == patch.Id && pieceOf[i] != vtkNURBSJacobianBoundary::KNOT_PLANE;
      for (std::size_t d = 0; d < 3; ++d)
      {
        const hyperpatch::KnotVector& knots = geometry.Knots()[d];
        isHere = isHere && knots.First() <= at[d] && at[d] <= knots.Last() &&
          // A sheet that ends there is one of the limit from its own side.
          (pieceOf[i] != vtkNURBSJacobianBoundary::SHEET ||
            !std::binary_search(creases[d].begin(), creases[d].end(), at[d]));
      }
      if (isHere)
      {
        points.push_back(point);
        parameters.insert(parameters.end(), at.begin(), at.end());
      }
    }
    std::vector<double> here(points.size());
    hyperpatch::JacobianField(geometry).Evaluate(points.size(), parameters.data(), here.data());
    for (std::size_t i = 0; i < points.size(); ++i)
    {
      values->SetValue(points[i], here[i]);
    }
  }
  output->GetPointData()->AddArray(values);
}

void JacobianPieces::AddIds(const hyperpatch::MultiPatch& model, vtkPolyData* output,
  const std::function<std::vector<double>(const std::vector<double>&)>& allGather)
{
  // Pieces of this rank: over cells, and over points that blocks have in common.
  const Mesh mesh(output);
  Union joined(static_cast<std::size_t>(mesh.Points()));
  std::map<PointKey, std::size_t> seam;
  std::map<std::pair<int, int>, std::size_t> faces;
  const auto seams = SeamsOf(model);
  mesh.ForCells(
    [&](vtkIdType cell, vtkIdList& corners)
    {
      const int patch = mesh.Patch(cell);
      const int piece = mesh.Piece(cell);
      const auto first = static_cast<std::size_t>(corners.GetId(0));
      // A face is the image of a rectangle, all of one piece, and so are the cells of a patch.
      if (IsWhole(piece))
      {
        joined.Join(faces.emplace(std::make_pair(patch, piece), first).first->second, first);
      }
      for (const vtkIdType corner : corners)
      {
        const auto point = static_cast<std::size_t>(corner);
        joined.Join(first, point);
        const Parameter at = mesh.ParameterOf(corner);
        bool isOnSeam = false;
        for (std::size_t d = 0; d < 3; ++d)
        {
          isOnSeam = isOnSeam || seams.at(patch)[d].count(static_cast<float>(at[d])) > 0;
        }
        if (isOnSeam && !IsWhole(piece))
        {
          joined.Join(seam.emplace(KeyOf(patch, piece, at), point).first->second, point);
        }
      }
    });

  // Their least points, and the points where other ranks may go on: key and piece of this rank.
  std::map<std::size_t, PointKey> least;
  mesh.ForCells(
    [&](vtkIdType cell, vtkIdList& corners)
    {
      PointKey& known =
        least
          .emplace(joined.Find(static_cast<std::size_t>(corners.GetId(0))),
            KeyOf(mesh.Patch(cell), mesh.Piece(cell), mesh.ParameterOf(corners.GetId(0))))
          .first->second;
      for (const vtkIdType corner : corners)
      {
        known =
          std::min(known, KeyOf(mesh.Patch(cell), mesh.Piece(cell), mesh.ParameterOf(corner)));
      }
    });
  std::vector<double> records;
  const auto add = [&records, &least](const PointKey& key, std::size_t root)
  {
    const PointKey& piece = least.at(root);
    records.insert(records.end(), key.begin(), key.end());
    records.insert(records.end(), piece.begin(), piece.end());
  };
  for (const auto& [root, key] : least)
  {
    // Faces and cells meet themselves on other ranks wherever they are.
    const bool isWhole =
      key[1] < vtkNURBSJacobianBoundary::KNOT_PLANE || key[1] == vtkNURBSJacobianBoundary::CELLS;
    add(isWhole ? PointKey{ key[0], key[1] } : key, root);
  }
  for (const auto& [key, point] : seam)
  {
    add(key, joined.Find(point));
  }
  records = allGather(records);

  // The same on all ranks: pieces by their least points, joined where they share a point.
  constexpr std::size_t Length = 2 * std::tuple_size<PointKey>::value;
  const auto keyAt = [&records](std::size_t from)
  {
    PointKey key{};
    std::copy_n(records.begin() + static_cast<std::ptrdiff_t>(from), key.size(), key.begin());
    return key;
  };
  std::map<PointKey, std::size_t> number;
  for (std::size_t r = 0; r < records.size(); r += Length)
  {
    number.emplace(keyAt(r + Length / 2), 0);
  }
  std::size_t next = 0;
  for (auto& entry : number)
  {
    entry.second = next++;
  }
  Union all(number.size());
  std::map<PointKey, std::size_t> meeting;
  for (std::size_t r = 0; r < records.size(); r += Length)
  {
    const std::size_t piece = number.at(keyAt(r + Length / 2));
    all.Join(meeting.emplace(keyAt(r), piece).first->second, piece);
  }
  std::map<std::size_t, int> ids;
  for (std::size_t i = 0; i < number.size(); ++i)
  {
    ids.emplace(all.Find(i), static_cast<int>(ids.size()));
  }

  vtkNew<vtkIntArray> array;
  array->SetName("PieceId");
  array->SetNumberOfTuples(mesh.Cells());
  mesh.ForCells(
    [&](vtkIdType cell, vtkIdList& corners)
    {
      const std::size_t root = joined.Find(static_cast<std::size_t>(corners.GetId(0)));
      array->SetValue(cell, ids.at(all.Find(number.at(least.at(root)))));
    });
  output->GetCellData()->AddArray(array);
}
