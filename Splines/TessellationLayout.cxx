// SPDX-License-Identifier: BSD-3-Clause
#include "TessellationWorker.h"

#include <algorithm>
#include <cmath>

namespace hyperpatch::tessellation
{

namespace
{

// The share of the tolerance that the points of an element's edge may use. The strip beside the
// edge needs the rest (see StripWidth).
constexpr double EdgeShare = 0.75;
// The share of the inner row in a strip beside an edge that is coarser than the row.
constexpr double RowShare = 0.4;

/// The widest step in the second direction of a strip beside an element's edge so that its
/// triangles are within the tolerance. Merging by midpoints makes no triangle wider than the larger
/// of the edge's step and the row's; call that H.
///
/// (1) The bound of the whole element on H x width, if that is enough. (2) Otherwise the edge may
/// be coarse because the field bends less there: split f into the edge curve E(u), whose error is
/// at most e = H^2 E_uu, and the rest, which vanishes on the edge; with r = 2 H width UV + width^2
/// VV, triangles that stand on the edge are wrong by at most e + r, those that stand on the row by
/// at most s i + 4 s (1 - s) (e + r) at height s, where i = row^2 UU is the error of the row. The
/// largest value of that is at most 1 if e + r <= (1 - i/2 + sqrt(1 - i)) / 2.
double StripWidth(const Bend& bend, const EdgeBend& edge, double edgeStep, double rowStep)
{
  // All points of a collapsed edge are the same one: it is as fine as the row.
  const double step = edge.Constant ? rowStep : std::max(edgeStep, rowStep);
  const double direct = bend.Height(step, 1.0 - step * step * bend.UU);
  const double row = rowStep * rowStep * bend.UU;
  if (row > 1.0)
  {
    return direct;
  }
  const double budget = 0.5 * (1.0 - 0.5 * row + std::sqrt(1.0 - row));
  return std::max(direct, bend.Height(step, budget - step * step * edge.UU));
}

/// Equal steps for the inside of an element: the fewest segments, near enough, so that all fields
/// fit. Treats both directions alike, so that a neighbour with u and v exchanged agrees.
std::array<int, 2> InnerSegments(const Bend* bends, std::size_t count, int maximum, bool& limited)
{
  Bend most;
  for (std::size_t k = 0; k < count; ++k)
  {
    most = { std::max(most.UU, bends[k].UU), std::max(most.UV, bends[k].UV),
      std::max(most.VV, bends[k].VV) };
  }
  const double su = std::sqrt(most.UU + most.UV);
  const double sv = std::sqrt(most.VV + most.UV);
  // Steps x / su and x / sv share the error evenly; x as large as it may be.
  double worst = 0.0;
  for (std::size_t k = 0; k < count; ++k)
  {
    const Bend& b = bends[k];
    worst = std::max(worst,
      (su > 0.0 ? b.UU / (su * su) : 0.0) + (sv > 0.0 ? b.VV / (sv * sv) : 0.0) +
        (su > 0.0 && sv > 0.0 ? 2.0 * b.UV / (su * sv) : 0.0));
  }
  double h[2] = { 1.0, 1.0 };
  if (worst > 0.0)
  {
    const double x = 1.0 / std::sqrt(worst);
    h[0] = su > x ? x / su : 1.0;
    h[1] = sv > x ? x / sv : 1.0;
  }
  for (std::size_t d = 0; d < 2; ++d)
  {
    // Where one direction needs no subdivision the other may use all of the tolerance.
    if (h[d] == 1.0 && h[1 - d] < 1.0)
    {
      double height = 1.0;
      for (std::size_t k = 0; k < count; ++k)
      {
        const Bend b = d == 0 ? bends[k] : bends[k].Swapped();
        height = std::min(height, b.Height(1.0, 1.0 - b.UU));
      }
      h[1 - d] = std::max(h[1 - d], height);
    }
  }
  std::array<int, 2> n{ Count(1.0 / h[0], maximum, limited), Count(1.0 / h[1], maximum, limited) };
  const auto fits = [&](int nu, int nv)
  {
    return nu > 0 && nv > 0 &&
      std::all_of(bends, bends + count, [&](const Bend& b) { return b.Fits(1.0 / nu, 1.0 / nv); });
  };
  while (true)
  {
    const bool u = fits(n[0] - 1, n[1]);
    const bool v = fits(n[0], n[1] - 1);
    if (u && (!v || n[0] < n[1]))
    {
      --n[0];
    }
    else if (v && (!u || n[1] < n[0]))
    {
      --n[1];
    }
    else
    {
      return n;
    }
  }
}

/// \param low, high greatest widths of the first and last strip \param step greatest in between
Row InnerRow(double low, double high, double step, int maximum, bool& limited)
{
  const double between = 1.0 - low - high;
  if (between <= Slack)
  {
    const double middle = 0.5 * (low + 1.0 - high);
    return { 1, middle, middle };
  }
  return { 1 + Count(between / step, maximum, limited), low, 1.0 - high };
}

}

int Count(double segments, int maximum, bool& limited)
{
  const double count = std::ceil(segments - Slack);
  limited = limited || count > maximum;
  return static_cast<int>(std::clamp(count, 1.0, static_cast<double>(maximum)));
}

void Face::MeasureBends()
{
  const std::size_t fields = this->D.NumberOfBounds;
  this->CellBends.resize(this->NumberOfCells() * fields);
  this->EdgeBends.resize(this->NumberOfEdges() * fields);
  // Of the pairs uu, uv, uw, vv, vw, ww.
  const std::size_t uu = this->A == 0 ? 0 : 3;
  const std::size_t uv = this->A == 0 ? this->B : 4;
  const std::size_t vv = this->B == 1 ? 3 : 5;
  this->ForCells(
    [&](std::ptrdiff_t begin, std::ptrdiff_t end)
    {
      ChordBound bound;
      Eigen::MatrixXd points;
      Eigen::MatrixXd row;
      for (std::ptrdiff_t c = begin; c < end; ++c)
      {
        const int i = static_cast<int>(c % this->Nu);
        const int j = static_cast<int>(c / this->Nu);
        std::size_t k = 0;
        for (const Domain::Measured& field : this->D.Fields)
        {
          const Spline& spline = this->D.Splines[field.Index];
          const auto degrees = spline.Degrees();
          this->D.Extract(field, this->Triple(i, j), points);
          const double scale = 1.0 / (8.0 * field.Tolerance);
          Bend* bends = this->CellBends.data() + static_cast<std::size_t>(c) * fields + k;
          std::size_t count = 0;
          for (const ChordBound::Bound& b :
            bound(points, degrees, spline.IsRational(), field.Norm, Halvings[1]))
          {
            bends[count++] = { scale * b.Second[uu], scale * b.Second[uv], scale * b.Second[vv] };
          }
          const int na = degrees[this->A] + 1;
          const int nb = degrees[this->B] + 1;
          const auto edge = [&](std::size_t id, int size, int first, int stride)
          {
            row.resize(points.rows(), size);
            for (int q = 0; q < size; ++q)
            {
              row.col(q) = points.col(first + q * stride);
            }
            this->D.BoundEdge(field, row, bound, this->EdgeBends.data() + id * fields + k);
          };
          // Each edge once: by the cell that it is the low edge of, or by the last cell.
          edge(this->EdgeU(i, j), na, 0, 1);
          edge(this->EdgeV(i, j), nb, 0, na);
          if (j + 1 == this->Nv)
          {
            edge(this->EdgeU(i, j + 1), na, na * (nb - 1), 1);
          }
          if (i + 1 == this->Nu)
          {
            edge(this->EdgeV(i + 1, j), nb, na - 1, na);
          }
          k += count;
        }
      }
    });
}

bool Face::CanMergeEdges(std::size_t cell, std::size_t low, std::size_t high, bool swapped) const
{
  const std::size_t fields = this->D.NumberOfBounds;
  for (std::size_t k = 0; k < fields; ++k)
  {
    const Bend& bend = this->CellBends[cell * fields + k];
    double step = 0.0;
    for (std::size_t e : { low, high })
    {
      if (!this->EdgeBends[e * fields + k].Constant)
      {
        step = std::max(step, 1.0 / this->EdgeSegments[e]);
      }
    }
    if (!(swapped ? bend.Swapped() : bend).Fits(step, 1.0))
    {
      return false;
    }
  }
  return true;
}

ElementLayout Face::LayOutCell(int i, int j, bool& limited) const
{
  const std::size_t fields = this->D.NumberOfBounds;
  const std::size_t cell = this->Cell(i, j);
  const auto edges = this->Edges(i, j);
  ElementLayout layout;
  for (int d = 0; d < 2; ++d)
  {
    // The edges across must have no points of their own.
    const std::size_t across = d == 0 ? 2 : 0;
    if (this->EdgeSegments[edges[across]] == 1 && this->EdgeSegments[edges[across + 1]] == 1 &&
      this->CanMergeEdges(cell, edges[2 - across], edges[3 - across], d == 1))
    {
      layout.Kind = d;
      return layout;
    }
  }
  const int maximum = this->Options.MaximumSubdivision;
  const Bend* bends = this->CellBends.data() + cell * fields;
  const auto segments = InnerSegments(bends, fields, maximum, limited);
  double steps[2] = { 1.0 / segments[0], 1.0 / segments[1] };
  const auto width = [&](std::size_t e, std::size_t k)
  {
    const bool swapped = e >= 2;
    return StripWidth(swapped ? bends[k].Swapped() : bends[k],
      this->EdgeBends[edges[e] * fields + k], 1.0 / this->EdgeSegments[edges[e]],
      steps[swapped ? 1 : 0]);
  };
  // A row beside an edge that is too coarse for it must leave the edge a share.
  const double before[2] = { steps[0], steps[1] };
  for (std::size_t e = 0; e < 4; ++e)
  {
    const std::size_t along = e / 2;
    for (std::size_t k = 0; k < fields; ++k)
    {
      const double uu = along == 0 ? bends[k].UU : bends[k].VV;
      if (uu > 0.0 && width(e, k) < 0.25 * before[1 - along])
      {
        steps[along] = std::min(steps[along], std::sqrt(RowShare / uu));
      }
    }
  }
  double widths[4];
  for (std::size_t e = 0; e < 4; ++e)
  {
    widths[e] = steps[1 - e / 2];
    for (std::size_t k = 0; k < fields; ++k)
    {
      widths[e] = std::min(widths[e], width(e, k));
    }
    limited = limited || widths[e] < Slack;
    widths[e] = std::max(widths[e], Slack);
  }
  layout.Rows[0] = InnerRow(widths[2], widths[3], steps[0], maximum, limited);
  layout.Rows[1] = InnerRow(widths[0], widths[1], steps[1], maximum, limited);
  return layout;
}

void Face::LayOut()
{
  const std::size_t fields = this->D.NumberOfBounds;
  this->EdgeSegments.resize(this->NumberOfEdges());
  this->FirstOnEdge.resize(this->NumberOfEdges());
  Id points = this->Corner(0, this->Nv + 1);
  for (std::size_t e = 0; e < this->NumberOfEdges(); ++e)
  {
    double most = 0.0;
    for (std::size_t k = 0; k < fields; ++k)
    {
      most = std::max(most, this->EdgeBends[e * fields + k].UU);
    }
    this->EdgeSegments[e] =
      Count(std::sqrt(most / EdgeShare), this->Options.MaximumSubdivision, this->Mesh.LimitReached);
    this->FirstOnEdge[e] = points;
    points += this->EdgeSegments[e] - 1;
  }
  this->Layouts.resize(this->NumberOfCells());
  std::vector<char> limited(this->NumberOfCells(), 0);
  this->ForCells(
    [&](std::ptrdiff_t begin, std::ptrdiff_t end)
    {
      for (std::ptrdiff_t c = begin; c < end; ++c)
      {
        bool limit = false;
        this->Layouts[static_cast<std::size_t>(c)] =
          this->LayOutCell(static_cast<int>(c % this->Nu), static_cast<int>(c / this->Nu), limit);
        limited[static_cast<std::size_t>(c)] = limit;
      }
    });
  this->FirstInside.resize(this->NumberOfCells());
  this->FirstTriangle.resize(this->NumberOfCells());
  Id triangles = 0;
  for (int j = 0; j < this->Nv; ++j)
  {
    for (int i = 0; i < this->Nu; ++i)
    {
      const std::size_t c = this->Cell(i, j);
      const ElementLayout& layout = this->Layouts[c];
      this->Mesh.LimitReached = this->Mesh.LimitReached || limited[c];
      this->FirstInside[c] = points;
      this->FirstTriangle[c] = triangles;
      points += layout.NumberOfPoints();
      const auto edges = this->Edges(i, j);
      for (std::size_t e = 0; e < 4; ++e)
      {
        const bool used = layout.Kind == 2 || layout.Kind == static_cast<int>(e / 2);
        triangles += used ? this->EdgeSegments[edges[e]] : 0;
      }
      if (layout.Kind == 2)
      {
        const Id nu = layout.Rows[0].Points - 1;
        const Id nv = layout.Rows[1].Points - 1;
        triangles += 2 * (nu * nv + nu + nv);
      }
    }
  }
  this->Mesh.Parameters.resize(3, points);
  this->Mesh.Triangles.resize(3, triangles);
  this->Mesh.TriangleElements.resize(3, triangles);
  this->Mesh.TriangleSides.assign(static_cast<std::size_t>(triangles), this->Side);
}

}
