// SPDX-License-Identifier: BSD-3-Clause
#include "JacobianPieces.h"

#include "Aggregate.h"
#include "ArrayNames.h"
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
  Mesh(vtkPolyData* mesh, const JacobianPieces::Check& check)
    : Data(mesh)
    , MayGoOn(check)
    , Patches(mesh->GetCellData()->GetArray(hyperpatch::names::PatchId))
    , Pieces(mesh->GetCellData()->GetArray(hyperpatch::names::Piece))
    , Parameters(mesh->GetPointData()->GetArray(hyperpatch::names::ParametricCoordinates))
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
      this->CheckAt(cell);
      this->Data->GetCellPoints(cell, corners);
      body(cell, *corners);
    }
  }

  /// In loops over cells or points.
  void CheckAt(vtkIdType index) const
  {
    if (index % Batch == 0)
    {
      this->MayGoOn();
    }
  }

  static constexpr vtkIdType Batch = 16384;

private:
  vtkPolyData* Data;
  const JacobianPieces::Check& MayGoOn;
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

/// The parts here of each patch, as indices of the model's.
std::map<int, std::vector<std::size_t>> PartsOf(const hyperpatch::MultiPatch& model)
{
  std::map<int, std::vector<std::size_t>> parts;
  for (std::size_t i = 0; i < model.Patches.size(); ++i)
  {
    parts[model.Patches[i].Id].push_back(i);
  }
  return parts;
}

/// det J at the parameters, three numbers each.
std::vector<double> DeterminantsAt(const hyperpatch::Spline& geometry,
  const std::vector<double>& parameters, const JacobianPieces::Check& check)
{
  const hyperpatch::JacobianField field(geometry);
  std::vector<double> values(parameters.size() / 3);
  for (std::size_t begin = 0; begin < values.size(); begin += Mesh::Batch)
  {
    check();
    const std::size_t count = std::min<std::size_t>(Mesh::Batch, values.size() - begin);
    field.Evaluate(count, parameters.data() + 3 * begin, values.data() + begin);
  }
  return values;
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

void JacobianPieces::RemoveSheetsInFaces(
  const hyperpatch::MultiPatch& model, vtkPolyData* output, const Check& check)
{
  const Mesh mesh(output, check);
  // Triangles with their corners in a face. At its border a sheet may have some whose inside is not
  // in it: there det J is not 0.
  struct InFaces
  {
    std::vector<vtkIdType> Cells;
    std::vector<double> Middles;
  };
  std::vector<InFaces> candidates(model.Patches.size());
  const auto parts = PartsOf(model);
  mesh.ForCells(
    [&](vtkIdType cell, vtkIdList& corners)
    {
      if (mesh.Piece(cell) != vtkNURBSJacobianBoundary::SHEET)
      {
        return;
      }
      for (const std::size_t part : parts.at(mesh.Patch(cell)))
      {
        const hyperpatch::Patch& patch = model.Patches[part];
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
          InFaces& here = candidates[part];
          here.Cells.push_back(cell);
          here.Middles.insert(here.Middles.end(), middle.begin(), middle.end());
        }
      }
    });
  std::set<vtkIdType> removed;
  for (std::size_t part = 0; part < candidates.size(); ++part)
  {
    const auto& [cells, middles] = candidates[part];
    if (cells.empty())
    {
      continue;
    }
    const std::vector<double> values =
      DeterminantsAt(model.Patches[part].Body.Geometry(), middles, check);
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

void JacobianPieces::AddDeterminant(
  const hyperpatch::MultiPatch& model, vtkPolyData* output, const Check& check)
{
  const Mesh mesh(output, check);
  vtkNew<vtkDoubleArray> values;
  values->SetName(hyperpatch::names::JacobianDeterminant);
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

  struct PointsOfPart
  {
    std::array<std::vector<double>, 3> Creases;
    std::vector<vtkIdType> Points;
    std::vector<double> Parameters;
  };
  std::vector<PointsOfPart> work(model.Patches.size());
  for (std::size_t part = 0; part < work.size(); ++part)
  {
    for (std::size_t d = 0; d < 3; ++d)
    {
      work[part].Creases[d] = model.Patches[part].Body.Geometry().Knots()[d].Creases();
    }
  }
  const auto parts = PartsOf(model);
  for (std::size_t i = 0; i < count; ++i)
  {
    const auto point = static_cast<vtkIdType>(i);
    mesh.CheckAt(point);
    if (patchOf[i] < 0 || pieceOf[i] == vtkNURBSJacobianBoundary::KNOT_PLANE)
    {
      continue;
    }
    const Parameter at = mesh.ParameterOf(point);
    for (const std::size_t part : parts.at(patchOf[i]))
    {
      const hyperpatch::Spline& geometry = model.Patches[part].Body.Geometry();
      bool isHere = geometry.Dimension() == 3;
      for (std::size_t d = 0; isHere && d < 3; ++d)
      {
        const hyperpatch::KnotVector& knots = geometry.Knots()[d];
        const std::vector<double>& creases = work[part].Creases[d];
        isHere = knots.First() <= at[d] && at[d] <= knots.Last() &&
          // A sheet that ends there is one of the limit from its own side.
          (pieceOf[i] != vtkNURBSJacobianBoundary::SHEET ||
            !std::binary_search(creases.begin(), creases.end(), at[d]));
      }
      if (isHere)
      {
        work[part].Points.push_back(point);
        work[part].Parameters.insert(work[part].Parameters.end(), at.begin(), at.end());
      }
    }
  }
  for (std::size_t part = 0; part < work.size(); ++part)
  {
    if (work[part].Points.empty())
    {
      continue;
    }
    const std::vector<double> here =
      DeterminantsAt(model.Patches[part].Body.Geometry(), work[part].Parameters, check);
    for (std::size_t i = 0; i < here.size(); ++i)
    {
      values->SetValue(work[part].Points[i], here[i]);
    }
  }
  output->GetPointData()->AddArray(values);
}

void JacobianPieces::AddIds(const hyperpatch::MultiPatch& model, vtkPolyData* output,
  const std::function<std::vector<double>(const std::vector<double>&)>& allGather,
  const Check& check)
{
  // Pieces of this rank: over cells, and over points that blocks have in common.
  const Mesh mesh(output, check);
  const auto count = static_cast<std::size_t>(mesh.Points());
  Union joined(count);
  // Patch and piece of every point; a point is of one block, and so of one of each.
  constexpr std::array<int, 2> Nowhere{ -1, -1 };
  std::vector<std::array<int, 2>> home(count, Nowhere);
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
        if (home[point] != Nowhere)
        {
          continue;
        }
        home[point] = { patch, piece };
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

  // The pieces of this rank in the order of their first points, and the least keys of their points.
  std::vector<std::size_t> pieceOf(count);
  std::vector<PointKey> least;
  for (std::size_t point = 0; point < count; ++point)
  {
    mesh.CheckAt(static_cast<vtkIdType>(point));
    if (home[point] == Nowhere)
    {
      continue;
    }
    const PointKey key =
      KeyOf(home[point][0], home[point][1], mesh.ParameterOf(static_cast<vtkIdType>(point)));
    // A piece is known by its first point.
    const std::size_t root = joined.Find(point);
    if (root == point)
    {
      pieceOf[point] = least.size();
      least.push_back(key);
    }
    else
    {
      pieceOf[point] = pieceOf[root];
      least[pieceOf[root]] = std::min(least[pieceOf[root]], key);
    }
  }
  // What the ranks tell each other: the pieces, and the points where others may go on.
  std::vector<double> records;
  const auto add = [&records](const PointKey& key, const PointKey& piece)
  {
    records.insert(records.end(), key.begin(), key.end());
    records.insert(records.end(), piece.begin(), piece.end());
  };
  for (const PointKey& key : least)
  {
    // Faces and cells meet themselves on other ranks wherever they are.
    const bool isWhole =
      key[1] < vtkNURBSJacobianBoundary::KNOT_PLANE || key[1] == vtkNURBSJacobianBoundary::CELLS;
    add(isWhole ? PointKey{ key[0], key[1] } : key, key);
  }
  for (const auto& [key, point] : seam)
  {
    add(key, least[pieceOf[point]]);
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

  std::vector<int> idOf;
  for (const PointKey& key : least)
  {
    idOf.push_back(ids.at(all.Find(number.at(key))));
  }
  vtkNew<vtkIntArray> array;
  array->SetName(hyperpatch::names::PieceId);
  array->SetNumberOfTuples(mesh.Cells());
  mesh.ForCells([&](vtkIdType cell, vtkIdList& corners)
    { array->SetValue(cell, idOf[pieceOf[static_cast<std::size_t>(corners.GetId(0))]]); });
  output->GetCellData()->AddArray(array);
}
