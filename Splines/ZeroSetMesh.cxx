// SPDX-License-Identifier: BSD-3-Clause
#include "ZeroSetWorker.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace hyperpatch
{

namespace
{

/// So many pieces are gone through between two looks for an abort, in a row and in parallel.
constexpr std::int64_t Step = 1 << 12;
constexpr std::int64_t Grain = 64;

/// Numbers points, once per set of sides on which there is one of its own.
class Columns
{
public:
  using Index = std::int64_t;

  explicit Columns(Index points)
    : Place(static_cast<std::size_t>(points), -1)
  {
  }

  void Add(Index point, int sides)
  {
    Index& place = this->Place[static_cast<std::size_t>(point)];
    const bool isNew = sides == 0 ? place < 0 : this->Copies.Number(KeyOf(point, sides)).second;
    if (isNew)
    {
      sides == 0 ? static_cast<void>(place = this->Count()) : this->OfCopy.push_back(this->Count());
      this->Points.emplace_back(point, sides);
    }
  }

  [[nodiscard]] Index Find(Index point, int sides) const
  {
    return sides == 0
      ? this->Place[static_cast<std::size_t>(point)]
      : this->OfCopy[static_cast<std::size_t>(this->Copies.Find(KeyOf(point, sides)))];
  }

  [[nodiscard]] Index Count() const { return static_cast<Index>(this->Points.size()); }
  /// The point and its sides.
  [[nodiscard]] const std::pair<Index, int>& operator[](Index column) const
  {
    return this->Points[static_cast<std::size_t>(column)];
  }

private:
  static Numbering::Key KeyOf(Index point, int sides)
  {
    return { static_cast<int>(point), static_cast<int>(point >> 32), sides, 0 };
  }

  std::vector<Index> Place; ///< of points without sides
  Numbering Copies;         ///< of the others
  std::vector<Index> OfCopy;
  std::vector<std::pair<Index, int>> Points;
};

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
  // Edges by ranges of their lower ends, as each chunk of the pieces passes them. Inner points are
  // of one piece, whose edges at them are shared by its own triangles.
  struct Passed
  {
    int Low, High;
    bool IsUp;
  };
  constexpr Index Ranges = 32;
  constexpr Index Chunk = 8 * Grain;
  const auto count = static_cast<Index>(this->Pieces.size());
  const Index perRange = this->Shared.Count() / Ranges + 1;
  std::vector<std::array<std::vector<Passed>, Ranges>> passed(
    static_cast<std::size_t>((count + Chunk - 1) / Chunk));
  const bool isMirrored = this->Options.Handedness < 0;
  this->Parallel(count, Chunk,
    [&](Index begin, Index end)
    {
      auto& own = passed[static_cast<std::size_t>(begin / Chunk)];
      for (Index leaf = begin; leaf < end; ++leaf)
      {
        const Facets& piece = this->Pieces[static_cast<std::size_t>(leaf)];
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
              own[static_cast<std::size_t>(low / perRange)].push_back(
                { static_cast<int>(low), static_cast<int>(high), (a < b) != isMirrored });
            }
          }
        }
      }
    });
  std::array<std::vector<std::array<Index, 2>>, Ranges> open;
  std::array<std::vector<CrowdedEdge>, Ranges> crowded;
  this->Parallel(Ranges, 1,
    [&](Index range, Index /*end*/)
    {
      const auto r = static_cast<std::size_t>(range);
      std::vector<Passed> edges;
      for (const auto& chunk : passed)
      {
        edges.insert(edges.end(), chunk[r].begin(), chunk[r].end());
      }
      std::sort(edges.begin(), edges.end(),
        [](const Passed& a, const Passed& b)
        { return a.Low != b.Low ? a.Low < b.Low : a.High < b.High; });
      for (std::size_t first = 0, i = 0; first < edges.size(); first = i)
      {
        const Index low = edges[first].Low;
        const Index high = edges[first].High;
        std::array<int, 2> times{}; // down and up
        for (; i < edges.size() && edges[i].Low == low && edges[i].High == high; ++i)
        {
          ++times[edges[i].IsUp ? 1 : 0];
        }
        for (int left = times[1] - times[0]; left != 0; left += left > 0 ? -1 : 1)
        {
          open[r].push_back({ left > 0 ? low : high, left > 0 ? high : low });
        }
        const int most = std::max(times[0], times[1]);
        if (most > 1)
        {
          crowded[r].push_back({ { low, high }, most });
        }
      }
    });
  this->OpenEdges.clear();
  std::vector<CrowdedEdge> all;
  for (std::size_t r = 0; r < Ranges; ++r)
  {
    this->OpenEdges.insert(this->OpenEdges.end(), open[r].begin(), open[r].end());
    all.insert(all.end(), crowded[r].begin(), crowded[r].end());
  }
  return all;
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
  this->OpenEdges.clear();
  std::vector<char> isSingular(static_cast<std::size_t>(this->Shared.Count()), 0);
  if (this->Axes.size() == 3)
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
  for (std::size_t leaf = 0; leaf < this->Pieces.size(); ++leaf)
  {
    const Facets& piece = this->Pieces[leaf];
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
    }
  }
  if (!(this->Axes.size() == 3 ? this->MeshPieces() : this->MeshCurves()))
  {
    return false;
  }
  this->Pieces.clear();
  this->MendNormals();
  return !this->Options.Abort();
}

bool ZeroSet::Worker::MeshPieces()
{
  // Where the cells and inner points of each piece begin.
  const auto count = static_cast<Index>(this->Pieces.size());
  std::vector<Index> firstCell(this->Pieces.size());
  std::vector<Index> firstInner(this->Pieces.size());
  Index cells = 0;
  Index inner = 0;
  for (std::size_t leaf = 0; leaf < this->Pieces.size(); ++leaf)
  {
    firstCell[leaf] = cells;
    firstInner[leaf] = inner;
    cells += static_cast<Index>(this->Pieces[leaf].Cells.size());
    inner += this->Pieces[leaf].Inner.Count();
  }
  // The sides of creases that a leaf is below of, of which a point lies on some.
  const auto creasesAbove = [this](const Box& box)
  {
    int above = 0;
    for (int d = 0; d < 3; ++d)
    {
      const CellLines& lines = this->Lines[static_cast<std::size_t>(d)];
      const int end = box.Low[static_cast<std::size_t>(d)] + box.Size;
      above |= end < lines.Length() && lines.IsCrease(end) ? 1 << d : 0;
    }
    return above;
  };
  const auto sidesOf = [this](Index point, const Box& box, int above)
  {
    int below = 0;
    for (int d = 0; above >> d != 0; ++d)
    {
      const bool isOn = (above >> d & 1) != 0 &&
        this->Shared.Parameters(d, point) ==
          this->Line(d, box.Low[static_cast<std::size_t>(d)] + box.Size);
      below |= isOn ? 1 << d : 0;
    }
    return below;
  };
  Columns columns(this->Shared.Count());
  for (std::size_t leaf = 0; leaf < this->Pieces.size(); ++leaf)
  {
    if (leaf % Step == 0 && this->Options.Abort())
    {
      return false;
    }
    const Facets& piece = this->Pieces[leaf];
    const Box& box = this->Leaves[leaf].At;
    const int above = creasesAbove(box);
    for (const auto& cell : piece.Cells)
    {
      for (const Index corner : cell)
      {
        if (corner >= 0)
        {
          const Index point = piece.Loops[static_cast<std::size_t>(corner)];
          columns.Add(point, sidesOf(point, box, above));
        }
      }
    }
  }

  const Index outer = columns.Count();
  Samples all;
  all.Resize(*this, outer + inner);
  const auto copyShared = [&](Index begin, Index end)
  {
    Samples one; // the side below a crease
    one.Resize(*this, 1);
    for (Index i = begin; i < end; ++i)
    {
      const auto [point, below] = columns[i];
      this->Copy(this->Shared, point, all, i, 1);
      if (below == 0)
      {
        continue;
      }
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
  };
  const bool isMirrored = this->Options.Handedness < 0;
  this->Mesh.Cells.resize(3, cells);
  const auto copyPieces = [&](Index begin, Index end)
  {
    for (auto leaf = static_cast<std::size_t>(begin); leaf < static_cast<std::size_t>(end); ++leaf)
    {
      const Facets& piece = this->Pieces[leaf];
      const Box& box = this->Leaves[leaf].At;
      const int above = creasesAbove(box);
      const Index own = outer + firstInner[leaf];
      this->Copy(piece.Inner, 0, all, own, piece.Inner.Count());
      Index at = firstCell[leaf];
      for (const auto& cell : piece.Cells)
      {
        for (Index k = 0; k < 3; ++k)
        {
          const Index corner = cell[static_cast<std::size_t>(isMirrored ? (3 - k) % 3 : k)];
          if (corner < 0)
          {
            this->Mesh.Cells(k, at) = own - 1 - corner;
            continue;
          }
          const Index point = piece.Loops[static_cast<std::size_t>(corner)];
          this->Mesh.Cells(k, at) = columns.Find(point, sidesOf(point, box, above));
        }
        ++at;
      }
    }
  };
  return this->Parallel(outer, Batch, copyShared) && this->Parallel(count, Grain, copyPieces) &&
    this->TakePoints(std::move(all));
}

bool ZeroSet::Worker::MeshCurves()
{
  // Segments of the curves in a surface, the vertices on a curve.
  std::vector<Index> indices;
  for (std::size_t c = 0; c < this->Curves.size() && this->Axes.size() == 2; ++c)
  {
    const Curve& curve = this->Curves[c];
    Index from = curve.From;
    for (Index i = 0; i <= curve.Count && this->CurveOf[c] == static_cast<Index>(c); ++i)
    {
      const Index to = i < curve.Count ? curve.First + i : curve.To;
      const auto [begin, end] = this->AreLinesTurned ? std::pair(to, from) : std::pair(from, to);
      indices.insert(indices.end(), { begin, end });
      from = to;
    }
  }
  for (std::size_t v = 0; v < this->Vertices.size() && this->Axes.size() == 1; ++v)
  {
    indices.push_back(static_cast<Index>(v));
  }
  Columns columns(this->Shared.Count());
  for (Index& point : indices)
  {
    columns.Add(point, 0);
    point = columns.Find(point, 0);
  }
  const auto axes = static_cast<Index>(this->Axes.size());
  this->Mesh.Cells = Eigen::Map<const Eigen::Matrix<Index, Eigen::Dynamic, Eigen::Dynamic>>(
    indices.data(), axes, static_cast<Index>(indices.size()) / axes);
  Samples all;
  all.Resize(*this, columns.Count());
  for (Index i = 0; i < columns.Count(); ++i)
  {
    this->Copy(this->Shared, columns[i].first, all, i, 1);
  }
  return this->TakePoints(std::move(all));
}

bool ZeroSet::Worker::TakePoints(Samples&& points)
{
  if (this->LargestValue > 0.0 && points.Count() > 0)
  {
    this->Certificate.LargestResidual = points.Residuals.maxCoeff() / this->LargestValue;
  }
  this->Mesh.Parameters = std::move(points.Parameters);
  this->Mesh.Points = std::move(points.Points);
  this->Mesh.Normals = std::move(points.Normals);
  this->Mesh.Attributes = std::move(points.Attributes);

  // The knot span of each cell's centre.
  const Index axes = this->Mesh.Cells.rows();
  this->Mesh.Elements.resize(3, this->Mesh.Cells.cols());
  std::array<std::vector<double>, 3> breaks;
  for (int d = 0; d < 3; ++d)
  {
    breaks[static_cast<std::size_t>(d)] = this->Body.Geometry().Knots(d).Breaks();
  }
  return this->Parallel(this->Mesh.Cells.cols(), Step,
    [&](Index begin, Index end)
    {
      for (Index c = begin; c < end; ++c)
      {
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        for (Index k = 0; k < axes; ++k)
        {
          sum += this->Mesh.Parameters.col(this->Mesh.Cells(k, c));
        }
        for (int d = 0; d < 3; ++d)
        {
          const std::vector<double>& b = breaks[static_cast<std::size_t>(d)];
          const double centre = sum[d] / static_cast<double>(axes);
          const auto span = std::upper_bound(b.begin() + 1, b.end() - 1, centre) - b.begin() - 1;
          this->Mesh.Elements(d, c) = static_cast<int>(span);
        }
      }
    });
}

void ZeroSet::Worker::MendNormals()
{
  // Where the Jacobian has no rank at a pole there is no normal; take that of the triangles around.
  if (this->Axes.size() != 3 || !(this->Mesh.Normals.colwise().squaredNorm().array() == 0.0).any())
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
