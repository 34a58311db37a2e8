// SPDX-License-Identifier: BSD-3-Clause
#include "ZeroSetWorker.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <utility>

namespace hyperpatch
{

namespace
{

/// So many cells are gone through between two looks for an abort.
constexpr Eigen::Index Step = 1 << 12;

}

unsigned ZeroSet::Worker::SidesOf(const std::array<Index, 2>& edge) const
{
  unsigned sides = 0;
  for (const int d : this->Axes)
  {
    const double a = this->Shared.Parameters(d, edge[0]);
    const bool same = a == this->Shared.Parameters(d, edge[1]);
    sides |= same && a == this->Low[d] ? 1u << (2 * d) : 0u;
    sides |= same && a == this->High[d] ? 2u << (2 * d) : 0u;
  }
  return sides;
}

std::vector<ZeroSet::Worker::CrowdedEdge> ZeroSet::Worker::FindOpenEdges()
{
  // Inner points are of one piece, whose edges at them are shared by its own triangles.
  Numbering numbers;
  struct Passed
  {
    Index Low, High;
    int Up, Down; ///< how often it is passed
  };
  std::vector<Passed> edges;
  const bool isMirrored = this->Options.Handedness < 0;
  for (std::size_t leaf = 0; leaf < this->Pieces.size(); ++leaf)
  {
    if (leaf % Step == 0 && this->Options.Abort())
    {
      return {};
    }
    const Facets& piece = this->Pieces[leaf];
    for (const auto& cell : piece.Cells)
    {
      for (std::size_t k = 0; k < 3; ++k)
      {
        if (cell[k] < 0 || cell[(k + 1) % 3] < 0)
        {
          continue;
        }
        const Index a = piece.Loops[static_cast<std::size_t>(cell[k])];
        const Index b = piece.Loops[static_cast<std::size_t>(cell[(k + 1) % 3])];
        // What has no length is open for nobody.
        if (this->Shared.Points.col(a) != this->Shared.Points.col(b))
        {
          const auto [low, high] = std::minmax(a, b);
          const auto [number, isNew] =
            numbers.Number({ static_cast<int>(low), static_cast<int>(high), 0, 0 });
          if (isNew)
          {
            edges.push_back({ low, high, 0, 0 });
          }
          Passed& edge = edges[static_cast<std::size_t>(number)];
          ++((a < b) != isMirrored ? edge.Up : edge.Down);
        }
      }
    }
  }
  this->OpenEdges.clear();
  std::vector<CrowdedEdge> crowded;
  for (const Passed& edge : edges)
  {
    for (int left = edge.Up - edge.Down; left != 0; left += left > 0 ? -1 : 1)
    {
      this->OpenEdges.push_back(
        { left > 0 ? edge.Low : edge.High, left > 0 ? edge.High : edge.Low });
    }
    if (std::max(edge.Up, edge.Down) > 1)
    {
      crowded.push_back({ { edge.Low, edge.High }, std::max(edge.Up, edge.Down) });
    }
  }
  return crowded;
}

void ZeroSet::Worker::AddUndecided(const ParameterBox& box)
{
  ++this->Certificate.UndecidedCells;
  if (this->UndecidedBoxes.size() < MostListed)
  {
    this->UndecidedBoxes.push_back(box);
  }
}

std::vector<ZeroSet::Worker::Index> ZeroSet::Worker::FindCrossings() const
{
  std::vector<Index> begins;
  for (const auto& edge : this->OpenEdges)
  {
    begins.push_back(edge[0]);
  }
  std::sort(begins.begin(), begins.end());
  std::vector<Index> crossings;
  for (std::size_t i = 1; i < begins.size(); ++i)
  {
    if (begins[i] == begins[i - 1])
    {
      crossings.push_back(begins[i]);
    }
  }
  return crossings;
}

bool ZeroSet::Worker::Assemble()
{
  this->Certificate = this->Taken;
  this->UndecidedBoxes.clear();
  for (const Box& box : this->Undecided)
  {
    this->AddUndecided(this->Parameters(box));
  }
  this->Certificate.ToleranceReached = !this->WasCapped;
  const int axes = static_cast<int>(this->Axes.size());
  this->OpenEdges.clear();
  std::vector<char> isSingular(static_cast<std::size_t>(this->Shared.Count()), 0);
  if (axes == 3)
  {
    const std::vector<Index> crowded = this->PartSheets(this->FindOpenEdges());
    const std::vector<Index> crossings = this->FindCrossings();
    for (const auto& points : { crowded, crossings })
    {
      for (const Index point : points)
      {
        isSingular[static_cast<std::size_t>(point)] = 1;
      }
    }
  }
  // Cells as shared points >= 0 or inner points of all pieces together < 0.
  std::vector<Index> indices;
  std::vector<std::size_t> leafOf; // per cell
  Index inner = 0;
  std::vector<Index> firstInner(this->Pieces.size());
  for (std::size_t leaf = 0; leaf < this->Pieces.size(); ++leaf)
  {
    if (leaf % Step == 0 && this->Options.Abort())
    {
      return false;
    }
    const Facets& piece = this->Pieces[leaf];
    firstInner[leaf] = inner;
    for (const auto& cell : piece.Cells)
    {
      for (const Index corner : cell)
      {
        indices.push_back(
          corner < 0 ? corner - inner : piece.Loops[static_cast<std::size_t>(corner)]);
      }
      leafOf.push_back(leaf);
    }
    inner += piece.Inner.Count();
    const bool isDoubtful = piece.Failed != 0 ||
      std::any_of(piece.Loops.begin(), piece.Loops.end(),
        [&isSingular](Index point) { return isSingular[static_cast<std::size_t>(point)] != 0; });
    if (this->Leaves[leaf].IsCertified && isDoubtful)
    {
      this->AddUndecided(this->Parameters(this->Leaves[leaf].At));
    }
    this->Certificate.CertifiedCells +=
      this->Leaves[leaf].IsCertified && !isDoubtful && !piece.Cells.empty() ? 1 : 0;
    this->Certificate.LargestError = std::max(this->Certificate.LargestError, piece.Error);
    this->Certificate.LargestAttributeError =
      std::max(this->Certificate.LargestAttributeError, piece.AttributeError);
    this->Certificate.ToleranceReached =
      this->Certificate.ToleranceReached && piece.IsWithinTolerance;
  }
  for (std::size_t c = 0; c < this->Curves.size(); ++c)
  {
    const Curve& curve = this->Curves[c];
    if (this->CurveOf[c] == static_cast<Index>(c))
    {
      this->Certificate.LargestError =
        std::max(this->Certificate.LargestError, curve.Measured.Distance);
      this->Certificate.LargestAttributeError =
        std::max(this->Certificate.LargestAttributeError, curve.Measured.Attribute);
      this->Certificate.ToleranceReached = this->Certificate.ToleranceReached && !curve.HasFailed &&
        curve.Measured.Distance <= this->Options.Tolerance && curve.Measured.Attribute <= 1.0;
      Index from = curve.From;
      for (Index i = 0; i <= curve.Count && axes == 2; ++i)
      {
        const Index to = i < curve.Count ? curve.First + i : curve.To;
        const auto [begin, end] = this->AreLinesTurned ? std::pair(to, from) : std::pair(from, to);
        indices.insert(indices.end(), { begin, end });
        leafOf.push_back(0);
        from = to;
      }
    }
  }
  if (axes == 1)
  {
    for (Index v = 0; v < static_cast<Index>(this->Vertices.size()); ++v)
    {
      indices.push_back(v);
      leafOf.push_back(0);
    }
  }
  const auto count = static_cast<Index>(leafOf.size());
  if (axes == 3 && this->Options.Handedness < 0)
  {
    for (Index c = 0; c < count; ++c)
    {
      std::swap(
        indices[static_cast<std::size_t>(3 * c + 1)], indices[static_cast<std::size_t>(3 * c + 2)]);
    }
  }

  // Shared points that are used, once per side of the creases they lie on.
  const Index shared = this->Shared.Count();
  std::vector<Index> place(static_cast<std::size_t>(shared), -1);
  std::vector<std::pair<Index, int>> columns; // shared point, bits of the sides it is below of
  Numbering copies;
  std::vector<Index> columnOf; // of the copies
  const auto sidesOf = [&](Index point, std::size_t leaf)
  {
    int below = 0;
    for (const int d : this->Axes)
    {
      const auto D = static_cast<std::size_t>(d);
      const Box& box = this->Leaves[leaf].At;
      const int end = box.Low[D] + box.Size;
      const CellLines& lines = this->Lines[D];
      if (end < lines.Length() && lines.IsCrease(end) &&
        this->Shared.Parameters(d, point) == lines.Parameter(end))
      {
        below |= 1 << d;
      }
    }
    return below;
  };
  for (Index c = 0; c < count; ++c)
  {
    if (c % Step == 0 && this->Options.Abort())
    {
      return false;
    }
    for (int k = 0; k < axes; ++k)
    {
      Index& corner = indices[static_cast<std::size_t>(axes * c + k)];
      if (corner < 0)
      {
        continue;
      }
      const int below = axes == 3 ? sidesOf(corner, leafOf[static_cast<std::size_t>(c)]) : 0;
      const auto next = static_cast<Index>(columns.size());
      if (below == 0)
      {
        Index& at = place[static_cast<std::size_t>(corner)];
        if (at < 0)
        {
          at = next;
          columns.emplace_back(corner, 0);
        }
        corner = at;
      }
      else
      {
        const auto [number, isNew] =
          copies.Number({ static_cast<int>(corner), static_cast<int>(corner >> 32), below, 0 });
        if (isNew)
        {
          columns.emplace_back(corner, below);
          columnOf.push_back(next);
        }
        corner = columnOf[static_cast<std::size_t>(number)];
      }
    }
  }
  const auto outer = static_cast<Index>(columns.size());

  Samples all;
  all.Resize(*this, outer + inner);
  Samples one; // the side below a crease
  one.Resize(*this, 1);
  for (Index i = 0; i < outer; ++i)
  {
    if (i % Step == 0 && this->Options.Abort())
    {
      return false;
    }
    const auto [point, below] = columns[static_cast<std::size_t>(i)];
    this->Copy(this->Shared, point, all, i, 1);
    if (below != 0)
    {
      for (int d = 0; d < 3; ++d)
      {
        double& x = all.Parameters(d, i);
        one.Parameters(d, 0) = below >> d & 1 ? std::nextafter(x, -INFINITY) : x;
      }
      this->Evaluate(one, 0, 1);
      all.Normals.col(i) = one.Normals.col(0);
      for (std::size_t a = 0; a < all.Attributes.size(); ++a)
      {
        all.Attributes[a].col(i) = one.Attributes[a].col(0);
      }
    }
  }
  for (std::size_t leaf = 0; leaf < this->Pieces.size(); ++leaf)
  {
    if (leaf % Step == 0 && this->Options.Abort())
    {
      return false;
    }
    const Samples& piece = this->Pieces[leaf].Inner;
    this->Copy(piece, 0, all, outer + firstInner[leaf], piece.Count());
  }
  for (Index& corner : indices)
  {
    corner = corner < 0 ? outer - 1 - corner : corner;
  }
  this->Mesh.Parameters = std::move(all.Parameters);
  this->Mesh.Points = std::move(all.Points);
  this->Mesh.Normals = std::move(all.Normals);
  this->Mesh.Attributes = std::move(all.Attributes);
  this->Mesh.Cells = Eigen::Map<const Eigen::Matrix<Index, Eigen::Dynamic, Eigen::Dynamic>>(
    indices.data(), axes, count);

  // The knot span of each cell's centre.
  this->Mesh.Elements.resize(3, count);
  for (int d = 0; d < 3; ++d)
  {
    const std::vector<double> breaks = this->Body.Geometry().Knots(d).Breaks();
    for (Index c = 0; c < count; ++c)
    {
      if (c % Step == 0 && this->Options.Abort())
      {
        return false;
      }
      double sum = 0.0;
      for (int k = 0; k < axes; ++k)
      {
        sum += this->Mesh.Parameters(d, this->Mesh.Cells(k, c));
      }
      const auto span =
        std::upper_bound(breaks.begin() + 1, breaks.end() - 1, sum / axes) - breaks.begin() - 1;
      this->Mesh.Elements(d, c) = static_cast<int>(span);
    }
  }
  if (this->LargestValue > 0.0 && all.Residuals.size() > 0)
  {
    this->Certificate.LargestResidual = all.Residuals.maxCoeff() / this->LargestValue;
  }
  this->MendNormals();
  return !this->Options.Abort();
}

void ZeroSet::Worker::MendNormals()
{
  // Where the Jacobian has no rank at a pole there is no normal; take that of the triangles around.
  if (this->Axes.size() != 3)
  {
    return;
  }
  std::vector<std::pair<Index, Index>> lost;
  for (Index c = 0; c < this->Mesh.Cells.cols(); ++c)
  {
    for (int k = 0; k < 3; ++k)
    {
      if (this->Mesh.Normals.col(this->Mesh.Cells(k, c)).isZero(0.0))
      {
        lost.emplace_back(this->Mesh.Cells(k, c), c);
      }
    }
  }
  std::sort(lost.begin(), lost.end());
  for (std::size_t i = 0; i < lost.size();)
  {
    const Index v = lost[i].first;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (; i < lost.size() && lost[i].first == v; ++i)
    {
      const auto cell = this->Mesh.Cells.col(lost[i].second);
      const Eigen::Vector3d a = this->Mesh.Points.col(cell[0]);
      sum += (Eigen::Vector3d(this->Mesh.Points.col(cell[1])) - a)
               .cross(Eigen::Vector3d(this->Mesh.Points.col(cell[2])) - a);
    }
    this->Mesh.Normals.col(v) = sum.norm() > 0.0 ? Eigen::Vector3d(sum.normalized()) : sum;
  }
}

}
