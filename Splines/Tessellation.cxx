// SPDX-License-Identifier: BSD-3-Clause
#include "Tessellation.h"

#include "BezierExtractor.h"
#include "ChordBound.h"
#include "ElementAxis.h"
#include "Error.h"
#include "Evaluator.h"
#include "Operators.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>

namespace hyperpatch
{

namespace
{

using Id = std::int64_t;

// The share of the tolerance that the points of an element's edge may use. The strip beside the
// edge needs the rest (see StripWidth).
constexpr double EdgeShare = 0.75;
// The share of the inner row in a strip beside an edge that is coarser than the row.
constexpr double RowShare = 0.4;
// Keeps counts from flipping by round-off.
constexpr double Slack = 1e-9;
// How often pieces are halved to tighten their bounds: along edges, on faces, in volumes.
constexpr int Halvings[3] = { 2, 2, 1 };
// Below this part of the size of the coordinates, points coincide.
constexpr double Coincident = 1e-14;

/// How much a piece of a field bends, in its own tolerances: linear interpolation on a parameter
/// triangle with legs h_u, h_v is within the tolerance if h_u^2 UU + 2 h_u h_v UV + h_v^2 VV <= 1.
struct Bend
{
  double UU = 0.0;
  double UV = 0.0;
  double VV = 0.0;

  [[nodiscard]] Bend Swapped() const { return { this->VV, this->UV, this->UU }; }
  [[nodiscard]] bool Fits(double hu, double hv) const
  {
    return hu * hu * this->UU + 2.0 * hu * hv * this->UV + hv * hv * this->VV <= 1.0 + Slack;
  }
  /// The largest h_v for this h_u and a right side of `budget` (left of which h_u^2 UU is taken
  /// already); 0 if there is none.
  [[nodiscard]] double Height(double hu, double budget) const
  {
    if (budget <= 0.0)
    {
      return 0.0;
    }
    const double b = this->UV * hu;
    const double denominator = b + std::sqrt(b * b + this->VV * budget);
    return denominator > 0.0 ? budget / denominator : std::numeric_limits<double>::infinity();
  }
};

/// The edge curve of an element: its bend, and whether the field does not change along it.
struct EdgeBend
{
  double UU = 0.0;
  bool Constant = false;
};

int Count(double segments, int maximum, bool& limited)
{
  const double count = std::ceil(segments - Slack);
  limited = limited || count > maximum;
  return static_cast<int>(std::clamp(count, 1.0, static_cast<double>(maximum)));
}

/// Geometry and attributes of a volume, face or curve, and the fields whose error is bounded.
struct Domain
{
  /// A spline of which one or more fields are bounded.
  struct Measured
  {
    std::size_t Index; ///< into Splines
    ChordBound::Norm Norm;
    double Tolerance;
    double Size; ///< of its coefficients
  };

  std::vector<Spline> Splines; ///< geometry first
  std::array<ElementAxis, 3> Axes;
  std::vector<Measured> Fields;
  std::size_t NumberOfBounds = 0; ///< per element: the geometry, and components of attributes

  Domain(std::vector<Spline> splines, const TessellationOptions& options)
    : Splines(std::move(splines))
  {
    std::vector<const Spline*> all;
    for (const Spline& spline : this->Splines)
    {
      all.push_back(&spline);
    }
    for (int d = 0; d < 3; ++d)
    {
      this->Axes[static_cast<std::size_t>(d)] = MakeElementAxis(all, d);
    }
    for (std::size_t s = 0; s < this->Splines.size(); ++s)
    {
      const double tolerance = s == 0         ? options.Tolerance
        : options.AttributeTolerances.empty() ? 0.0
                                              : options.AttributeTolerances[s - 1];
      if (tolerance > 0.0 && std::isfinite(tolerance))
      {
        this->Fields.push_back(
          { s, s == 0 ? ChordBound::Norm::Vector : ChordBound::Norm::Components, tolerance,
            this->Splines[s].Coefficients().cwiseAbs().maxCoeff() });
        this->NumberOfBounds +=
          s == 0 ? 1 : static_cast<std::size_t>(this->Splines[s].Components());
      }
    }
  }

  /// Bezier points of a field on a cell.
  void Extract(const Measured& field, std::array<int, 3> cell, Eigen::MatrixXd& points) const
  {
    const Spline& spline = this->Splines[field.Index];
    std::array<int, 3> spans{};
    std::array<double, 3> low{};
    std::array<double, 3> high{};
    for (std::size_t d = 0; d < 3; ++d)
    {
      const auto c = static_cast<std::size_t>(cell[d]);
      spans[d] = this->Axes[d].Spans[field.Index][c];
      low[d] = this->Axes[d].Breaks[c];
      high[d] = this->Axes[d].Breaks[c + 1];
    }
    BezierExtractor(spline).Extract(spans, low, high, points);
  }

  /// Bends of an edge curve, from its Bezier points; writes one per bound of the field.
  void BoundEdge(
    const Measured& field, const Eigen::MatrixXd& points, ChordBound& bound, EdgeBend* bends) const
  {
    const bool rational = this->Splines[field.Index].IsRational();
    const std::array<int, 3> degrees{ static_cast<int>(points.cols()) - 1, 0, 0 };
    for (const ChordBound::Bound& b : bound(points, degrees, rational, field.Norm, Halvings[0]))
    {
      *bends++ = { b.Second[0] / (8.0 * field.Tolerance), b.Radius <= Coincident * field.Size };
    }
  }

  /// Index of a cell's knot span of the geometry, in the whole patch.
  [[nodiscard]] Eigen::Vector3i Element(std::array<int, 3> cell, std::array<int, 3> first) const
  {
    Eigen::Vector3i element;
    for (std::size_t d = 0; d < 3; ++d)
    {
      element[static_cast<Eigen::Index>(d)] =
        first[d] + this->Axes[d].Spans[0][static_cast<std::size_t>(cell[d])];
    }
    return element;
  }
};

void Check(const Patch& patch, int handedness, const TessellationOptions& options)
{
  CheckTolerances(patch, options.Tolerance, options.AttributeTolerances);
  if (options.MaximumSubdivision < 1)
  {
    throw Error("the maximum subdivision is " + std::to_string(options.MaximumSubdivision) +
      "; it must be at least 1");
  }
  if (handedness != 1 && handedness != -1)
  {
    throw Error("the handedness is " + std::to_string(handedness) + "; it must be 1 or -1");
  }
}

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

/// Points of the inner grid of an element in one direction, at t = First .. Last of the element.
struct Row
{
  int Points = 0; ///< 0: no inner grid
  double First = 0.0;
  double Last = 0.0;

  [[nodiscard]] double At(int i) const
  {
    return this->Points == 1 ? this->First
                             : this->First + (this->Last - this->First) * i / (this->Points - 1);
  }
};

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

struct ElementLayout
{
  /// 2: inner grid and four strips. 0 or 1: the two edges along u or v are merged directly.
  int Kind = 2;
  std::array<Row, 2> Rows;

  [[nodiscard]] Id NumberOfPoints() const
  {
    return static_cast<Id>(this->Rows[0].Points) * this->Rows[1].Points;
  }
};

/// Triangulates between two rows of points (along t, `near` on the right of `far`'s side: counter-
/// clockwise when `far` lies on the left of t) by merging their midpoints, which makes no triangle
/// wider than the larger step of the two.
template <typename Emit>
void MergeRows(const std::vector<std::pair<double, Id>>& near,
  const std::vector<std::pair<double, Id>>& far, const Emit& emit)
{
  std::size_t i = 0;
  std::size_t j = 0;
  while (i + 1 < near.size() || j + 1 < far.size())
  {
    const bool advance = j + 1 == far.size() ||
      (i + 1 < near.size() &&
        near[i].first + near[i + 1].first <= far[j].first + far[j + 1].first + Slack);
    if (advance)
    {
      emit(near[i].second, near[i + 1].second, far[j].second);
      ++i;
    }
    else
    {
      emit(near[i].second, far[j + 1].second, far[j].second);
      ++j;
    }
  }
}

/// One side of a patch: a surface in directions A and B.
class Face
{
public:
  /// \param outward the sign of P_a x P_b in the normal \param element span of the missing
  /// direction \param fixed its parameter
  Face(std::vector<Spline> splines, int missing, double fixed, int element, double outward,
    int side, std::array<int, 3> firstSpan, const TessellationOptions& options)
    : D(std::move(splines), options)
    , Options(options)
    , A(missing == 0 ? 1 : 0)
    , B(missing == 2 ? 1 : 2)
    , Missing(static_cast<std::size_t>(missing))
    , Fixed(fixed)
    , Outward(outward)
    , Side(side)
    , FirstSpan(firstSpan)
    , Nu(D.Axes[A].Cells())
    , Nv(D.Axes[B].Cells())
  {
    // The missing direction of the face has one span, which stands for this one of the volume.
    this->FirstSpan[this->Missing] = element;
  }

  SurfaceMesh Tessellate()
  {
    this->MeasureBends();
    this->LayOut();
    this->PlacePoints();
    this->Triangulate();
    if (this->Options.KnotLines)
    {
      this->DrawKnotLines();
    }
    this->EvaluatePoints();
    this->DropCollapsed();
    return std::move(this->Mesh);
  }

private:
  // Numbering: cells u fastest; corners likewise; edges along u (Nu x (Nv + 1)), then those along v
  // ((Nu + 1) x Nv).
  [[nodiscard]] std::size_t Cell(int i, int j) const
  {
    return static_cast<std::size_t>(i) + static_cast<std::size_t>(this->Nu) * j;
  }
  [[nodiscard]] std::size_t EdgeU(int i, int j) const { return this->Cell(i, j); }
  [[nodiscard]] std::size_t EdgeV(int i, int j) const
  {
    return this->Cell(0, this->Nv + 1) + i + static_cast<std::size_t>(this->Nu + 1) * j;
  }
  [[nodiscard]] std::size_t NumberOfCells() const { return this->Cell(0, this->Nv); }
  [[nodiscard]] std::size_t NumberOfEdges() const { return this->EdgeV(0, this->Nv); }
  [[nodiscard]] Id Corner(int i, int j) const { return i + static_cast<Id>(this->Nu + 1) * j; }
  [[nodiscard]] std::array<int, 3> Triple(int i, int j) const
  {
    std::array<int, 3> cell{};
    cell[this->A] = i;
    cell[this->B] = j;
    return cell;
  }
  /// The edges of a cell: v low, v high, u low, u high.
  [[nodiscard]] std::array<std::size_t, 4> Edges(int i, int j) const
  {
    return { this->EdgeU(i, j), this->EdgeU(i, j + 1), this->EdgeV(i, j), this->EdgeV(i + 1, j) };
  }
  template <typename Body>
  void ForCells(const Body& body) const
  {
    this->Options.For(static_cast<std::ptrdiff_t>(this->NumberOfCells()), 32,
      [&](std::ptrdiff_t begin, std::ptrdiff_t end) { body(begin, end); });
  }

  void MeasureBends()
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

  /// Whether merging the two edges along u directly (v if swapped) is enough.
  [[nodiscard]] bool CanMergeEdges(
    std::size_t cell, std::size_t low, std::size_t high, bool swapped) const
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

  ElementLayout LayOutCell(int i, int j, bool& limited) const
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

  void LayOut()
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
      this->EdgeSegments[e] = Count(
        std::sqrt(most / EdgeShare), this->Options.MaximumSubdivision, this->Mesh.LimitReached);
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

  void PlacePoints()
  {
    const ElementAxis& a = this->D.Axes[this->A];
    const ElementAxis& b = this->D.Axes[this->B];
    const auto place = [&](Id id, double u, double v)
    {
      this->Mesh.Parameters(static_cast<Eigen::Index>(this->A), id) = u;
      this->Mesh.Parameters(static_cast<Eigen::Index>(this->B), id) = v;
      this->Mesh.Parameters(static_cast<Eigen::Index>(this->Missing), id) = this->Fixed;
    };
    for (int j = 0; j <= this->Nv; ++j)
    {
      const double v = b.Breaks[static_cast<std::size_t>(j)];
      for (int i = 0; i <= this->Nu; ++i)
      {
        const double u = a.Breaks[static_cast<std::size_t>(i)];
        place(this->Corner(i, j), u, v);
        const std::size_t eu = i < this->Nu ? this->EdgeU(i, j) : 0;
        for (int k = 1; i < this->Nu && k < this->EdgeSegments[eu]; ++k)
        {
          place(this->FirstOnEdge[eu] + k - 1,
            a.At(i, static_cast<double>(k) / this->EdgeSegments[eu]), v);
        }
        const std::size_t ev = j < this->Nv ? this->EdgeV(i, j) : 0;
        for (int k = 1; j < this->Nv && k < this->EdgeSegments[ev]; ++k)
        {
          place(this->FirstOnEdge[ev] + k - 1, u,
            b.At(j, static_cast<double>(k) / this->EdgeSegments[ev]));
        }
      }
    }
    this->ForCells(
      [&](std::ptrdiff_t begin, std::ptrdiff_t end)
      {
        for (std::ptrdiff_t c = begin; c < end; ++c)
        {
          const auto& rows = this->Layouts[static_cast<std::size_t>(c)].Rows;
          Id id = this->FirstInside[static_cast<std::size_t>(c)];
          for (int q = 0; q < rows[1].Points; ++q)
          {
            for (int p = 0; p < rows[0].Points; ++p)
            {
              place(id++, a.At(static_cast<int>(c % this->Nu), rows[0].At(p)),
                b.At(static_cast<int>(c / this->Nu), rows[1].At(q)));
            }
          }
        }
      });
  }

  /// Point k of an edge of a cell, from its first to its last corner.
  [[nodiscard]] Id OnEdge(int i, int j, std::size_t which, int k) const
  {
    const std::size_t e = this->Edges(i, j)[which];
    const int di = which == 3 ? 1 : 0;
    const int dj = which == 1 ? 1 : 0;
    if (k == 0)
    {
      return this->Corner(i + di, j + dj);
    }
    if (k == this->EdgeSegments[e])
    {
      return which < 2 ? this->Corner(i + 1, j + dj) : this->Corner(i + di, j + 1);
    }
    return this->FirstOnEdge[e] + k - 1;
  }

  void Triangulate()
  {
    this->ForCells(
      [&](std::ptrdiff_t begin, std::ptrdiff_t end)
      {
        std::vector<std::pair<double, Id>> near;
        std::vector<std::pair<double, Id>> far;
        for (std::ptrdiff_t n = begin; n < end; ++n)
        {
          const auto c = static_cast<std::size_t>(n);
          const int i = static_cast<int>(n % this->Nu);
          const int j = static_cast<int>(n / this->Nu);
          const ElementLayout& layout = this->Layouts[c];
          const Eigen::Vector3i element = this->D.Element(this->Triple(i, j), this->FirstSpan);
          const auto& rows = layout.Rows;
          const auto edges = this->Edges(i, j);
          Id id = this->FirstTriangle[c];
          const auto emit = [&](Id p, Id q, Id r)
          {
            this->Mesh.TriangleElements.col(id) = element;
            this->Mesh.Triangles.col(id) << p, (this->Outward > 0.0 ? q : r),
              (this->Outward > 0.0 ? r : q);
            ++id;
          };
          const auto flipped = [&](Id p, Id q, Id r) { emit(p, r, q); };
          const auto fillEdge = [&](std::size_t which, std::vector<std::pair<double, Id>>& row)
          {
            row.clear();
            const int segments = this->EdgeSegments[edges[which]];
            for (int k = 0; k <= segments; ++k)
            {
              row.emplace_back(static_cast<double>(k) / segments, this->OnEdge(i, j, which, k));
            }
          };
          if (layout.Kind < 2)
          {
            fillEdge(layout.Kind == 0 ? 0 : 2, near);
            fillEdge(layout.Kind == 0 ? 1 : 3, far);
            if (layout.Kind == 0)
            {
              MergeRows(near, far, emit);
            }
            else
            {
              MergeRows(near, far, flipped);
            }
            continue;
          }
          const int nu = rows[0].Points;
          const int nv = rows[1].Points;
          const auto inside = [&](int p, int q)
          { return this->FirstInside[c] + p + static_cast<Id>(nu) * q; };
          for (std::size_t which = 0; which < 4; ++which)
          {
            fillEdge(which, near);
            far.clear();
            const int size = which < 2 ? nu : nv;
            for (int k = 0; k < size; ++k)
            {
              far.emplace_back(rows[which / 2].At(k),
                which == 0     ? inside(k, 0)
                  : which == 1 ? inside(k, nv - 1)
                  : which == 2 ? inside(0, k)
                               : inside(nu - 1, k));
            }
            // The inside lies on the left of the lower and of the right edge.
            if (which == 0 || which == 3)
            {
              MergeRows(near, far, emit);
            }
            else
            {
              MergeRows(near, far, flipped);
            }
          }
          for (int q = 0; q + 1 < nv; ++q)
          {
            for (int p = 0; p + 1 < nu; ++p)
            {
              emit(inside(p, q), inside(p + 1, q), inside(p + 1, q + 1));
              emit(inside(p, q), inside(p + 1, q + 1), inside(p, q + 1));
            }
          }
        }
      });
  }

  void DrawKnotLines()
  {
    std::vector<std::array<Id, 2>> lines;
    std::vector<Eigen::Vector3i> elements;
    const auto draw = [&](int i, int j, std::size_t which)
    {
      const int segments = this->EdgeSegments[this->Edges(i, j)[which]];
      for (int k = 0; k < segments; ++k)
      {
        lines.push_back({ this->OnEdge(i, j, which, k), this->OnEdge(i, j, which, k + 1) });
        elements.push_back(this->D.Element(this->Triple(i, j), this->FirstSpan));
      }
    };
    for (int j = 0; j < this->Nv; ++j)
    {
      for (int i = 0; i < this->Nu; ++i)
      {
        if (this->D.Axes[this->B].IsKnot[static_cast<std::size_t>(j)])
        {
          draw(i, j, 0);
        }
        if (this->D.Axes[this->A].IsKnot[static_cast<std::size_t>(i)])
        {
          draw(i, j, 2);
        }
        if (j + 1 == this->Nv)
        {
          draw(i, j, 1);
        }
        if (i + 1 == this->Nu)
        {
          draw(i, j, 3);
        }
      }
    }
    const auto count = static_cast<Eigen::Index>(lines.size());
    this->Mesh.Lines.resize(2, count);
    this->Mesh.LineElements.resize(3, count);
    this->Mesh.LineSides.assign(lines.size(), this->Side);
    for (Eigen::Index l = 0; l < count; ++l)
    {
      this->Mesh.Lines.col(l) << lines[static_cast<std::size_t>(l)][0],
        lines[static_cast<std::size_t>(l)][1];
      this->Mesh.LineElements.col(l) = elements[static_cast<std::size_t>(l)];
    }
  }

  /// P_a x P_b from the derivatives at a point (3 vectors of m numbers).
  [[nodiscard]] Eigen::Vector3d Cross(const double* derivatives) const
  {
    const auto m = static_cast<std::size_t>(this->D.Splines[0].Components());
    Eigen::Vector3d a = Eigen::Vector3d::Zero();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    std::copy_n(derivatives + this->A * m, m, a.data());
    std::copy_n(derivatives + this->B * m, m, b.data());
    return a.cross(b);
  }

  /// The normal where tangents vanish or are parallel: from a little inside the element.
  [[nodiscard]] Eigen::Vector3d LimitNormal(
    const Evaluator& evaluator, const Eigen::Vector3d& parameters, double small) const
  {
    double value[3];
    double derivatives[9];
    for (double inside : { 1e-6, 1e-3, 0.5 })
    {
      Eigen::Vector3d moved = parameters;
      for (std::size_t d : { this->A, this->B })
      {
        const ElementAxis& axis = this->D.Axes[d];
        double& u = moved[static_cast<Eigen::Index>(d)];
        u += inside * (axis.At(axis.Find(u), 0.5) - u);
      }
      evaluator.EvaluateWithDerivatives(1, moved.data(), value, derivatives);
      const Eigen::Vector3d normal = this->Cross(derivatives);
      if (normal.norm() > small)
      {
        return normal.normalized();
      }
    }
    return Eigen::Vector3d::UnitZ();
  }

  void EvaluatePoints()
  {
    SurfaceMesh& mesh = this->Mesh;
    const Eigen::Index count = mesh.Parameters.cols();
    const Spline& geometry = this->D.Splines[0];
    const auto m = static_cast<std::size_t>(geometry.Components());
    mesh.Points.setZero(3, count);
    mesh.Normals.resize(3, count);
    const Evaluator evaluator(geometry);
    const auto length = [&](std::size_t d)
    { return this->D.Axes[d].Breaks.back() - this->D.Axes[d].Breaks.front(); };
    const double size =
      (geometry.Coefficients().rowwise().maxCoeff() - geometry.Coefficients().rowwise().minCoeff())
        .norm();
    const double small = 1e-10 * size * size / (length(this->A) * length(this->B));
    // Blocks of points that stay in the cache.
    constexpr std::ptrdiff_t Block = 128;
    this->Options.For(count, 4 * Block,
      [&](std::ptrdiff_t begin, std::ptrdiff_t end)
      {
        std::vector<double> values(m * Block);
        std::vector<double> derivatives(3 * m * Block);
        for (std::ptrdiff_t first = begin; first < end; first += Block)
        {
          const std::ptrdiff_t size1 = std::min(Block, end - first);
          evaluator.EvaluateWithDerivatives(static_cast<std::size_t>(size1),
            mesh.Parameters.col(first).data(), values.data(), derivatives.data());
          for (std::ptrdiff_t q = 0; q < size1; ++q)
          {
            const auto Q = static_cast<std::size_t>(q);
            std::copy_n(values.data() + m * Q, m, mesh.Points.col(first + q).data());
            Eigen::Vector3d normal = this->Cross(derivatives.data() + 3 * m * Q);
            normal = normal.norm() > small
              ? normal.normalized()
              : this->LimitNormal(evaluator, mesh.Parameters.col(first + q), small);
            mesh.Normals.col(first + q) = this->Outward * normal;
          }
        }
      });
    for (std::size_t s = 1; s < this->D.Splines.size(); ++s)
    {
      const Evaluator attribute(this->D.Splines[s]);
      Eigen::MatrixXd& values = mesh.Attributes.emplace_back(attribute.Components(), count);
      this->Options.For(count, 4 * Block,
        [&](std::ptrdiff_t begin, std::ptrdiff_t end)
        {
          attribute.Evaluate(static_cast<std::size_t>(end - begin),
            mesh.Parameters.col(begin).data(), values.col(begin).data());
        });
    }
  }

  void DropCollapsed()
  {
    SurfaceMesh& mesh = this->Mesh;
    const double small = Coincident * this->D.Fields[0].Size;
    const auto coincide = [&](Id p, Id q)
    { return (mesh.Points.col(p) - mesh.Points.col(q)).norm() <= small; };
    Eigen::Index kept = 0;
    for (Eigen::Index t = 0; t < mesh.Triangles.cols(); ++t)
    {
      const Id p = mesh.Triangles(0, t);
      const Id q = mesh.Triangles(1, t);
      const Id r = mesh.Triangles(2, t);
      if (!coincide(p, q) && !coincide(q, r) && !coincide(r, p))
      {
        mesh.Triangles.col(kept) << p, q, r;
        mesh.TriangleElements.col(kept) = mesh.TriangleElements.col(t).eval();
        ++kept;
      }
    }
    mesh.Triangles.conservativeResize(3, kept);
    mesh.TriangleElements.conservativeResize(3, kept);
    mesh.TriangleSides.resize(static_cast<std::size_t>(kept));
    kept = 0;
    for (Eigen::Index l = 0; l < mesh.Lines.cols(); ++l)
    {
      if (!coincide(mesh.Lines(0, l), mesh.Lines(1, l)))
      {
        mesh.Lines.col(kept) = mesh.Lines.col(l).eval();
        mesh.LineElements.col(kept) = mesh.LineElements.col(l).eval();
        ++kept;
      }
    }
    mesh.Lines.conservativeResize(2, kept);
    mesh.LineElements.conservativeResize(3, kept);
    mesh.LineSides.resize(static_cast<std::size_t>(kept));
  }

  Domain D;
  const TessellationOptions& Options;
  std::size_t A;
  std::size_t B;
  std::size_t Missing;
  double Fixed;
  double Outward;
  int Side;
  std::array<int, 3> FirstSpan;
  int Nu;
  int Nv;
  std::vector<Bend> CellBends;     // per cell and bound
  std::vector<EdgeBend> EdgeBends; // per edge and bound
  std::vector<int> EdgeSegments;
  std::vector<ElementLayout> Layouts;
  std::vector<Id> FirstOnEdge;
  std::vector<Id> FirstInside;
  std::vector<Id> FirstTriangle;
  SurfaceMesh Mesh;
};

/// The spline on a side; one without that direction as it is.
Spline OnSide(const Spline& spline, int side)
{
  return spline.Knots(side / 2).Size() == 1 ? spline : ExtractFace(spline, side);
}

std::vector<Spline> SplinesOnSide(const Aggregate& body, int side)
{
  std::vector<Spline> splines{ OnSide(body.Geometry(), side) };
  for (const Attribute& attribute : body.Attributes())
  {
    splines.push_back(OnSide(attribute.Field, side));
  }
  return splines;
}

std::vector<int> DirectionsWithDegree(const Spline& geometry)
{
  std::vector<int> directions;
  for (int d = 0; d < 3; ++d)
  {
    if (geometry.Knots(d).Degree() > 0)
    {
      directions.push_back(d);
    }
  }
  return directions;
}

template <typename Matrix>
void Append(Matrix& all, const Matrix& part)
{
  const Eigen::Index before = all.cols();
  all.conservativeResize(part.rows(), before + part.cols());
  all.rightCols(part.cols()) = part;
}

/// Appends a side's mesh to that of the patch.
void Append(SurfaceMesh& all, SurfaceMesh&& part)
{
  const Id offset = all.Points.cols();
  part.Triangles.array() += offset;
  part.Lines.array() += offset;
  Append(all.Parameters, part.Parameters);
  Append(all.Points, part.Points);
  Append(all.Normals, part.Normals);
  for (std::size_t a = 0; a < part.Attributes.size(); ++a)
  {
    Append(all.Attributes[a], part.Attributes[a]);
  }
  Append(all.Triangles, part.Triangles);
  Append(all.TriangleElements, part.TriangleElements);
  Append(all.Lines, part.Lines);
  Append(all.LineElements, part.LineElements);
  all.TriangleSides.insert(
    all.TriangleSides.end(), part.TriangleSides.begin(), part.TriangleSides.end());
  all.LineSides.insert(all.LineSides.end(), part.LineSides.begin(), part.LineSides.end());
  all.LimitReached = all.LimitReached || part.LimitReached;
}

SurfaceMesh TessellateCurve(const Patch& patch, int along, const TessellationOptions& options)
{
  Aggregate body = patch.Body;
  SurfaceMesh mesh;
  std::array<double, 3> fixed{};
  std::vector<Spline> splines{ body.Geometry() };
  for (const Attribute& attribute : body.Attributes())
  {
    splines.push_back(attribute.Field);
  }
  for (int d = 0; d < 3; ++d)
  {
    fixed[static_cast<std::size_t>(d)] = body.Geometry().Knots(d).First();
    for (Spline& spline : splines)
    {
      spline = d == along ? spline : OnSide(spline, 2 * d);
    }
  }
  const Domain domain(std::move(splines), options);
  const ElementAxis& axis = domain.Axes[static_cast<std::size_t>(along)];
  std::vector<double> parameters{ axis.Breaks.front() };
  std::vector<Eigen::Vector3i> elements;
  ChordBound bound;
  Eigen::MatrixXd points;
  std::vector<EdgeBend> bends(domain.NumberOfBounds);
  for (int c = 0; c < axis.Cells(); ++c)
  {
    std::array<int, 3> cell{};
    cell[static_cast<std::size_t>(along)] = c;
    double most = 0.0;
    for (const Domain::Measured& field : domain.Fields)
    {
      domain.Extract(field, cell, points);
      std::fill(bends.begin(), bends.end(), EdgeBend{});
      domain.BoundEdge(field, points, bound, bends.data());
      for (const EdgeBend& bend : bends)
      {
        most = std::max(most, bend.UU);
      }
    }
    const int n = Count(std::sqrt(most), options.MaximumSubdivision, mesh.LimitReached);
    for (int k = 1; k <= n; ++k)
    {
      parameters.push_back(axis.At(c, static_cast<double>(k) / n));
      elements.push_back(domain.Element(cell, patch.FirstSpan));
    }
  }
  const auto count = static_cast<Eigen::Index>(parameters.size());
  mesh.Parameters.resize(3, count);
  mesh.Lines.resize(2, count - 1);
  mesh.LineElements.resize(3, count - 1);
  mesh.LineSides.assign(parameters.size() - 1, 4);
  mesh.Normals.setZero(3, count);
  mesh.Points.setZero(3, count);
  for (Eigen::Index i = 0; i < count; ++i)
  {
    mesh.Parameters.col(i) = Eigen::Map<const Eigen::Vector3d>(fixed.data());
    mesh.Parameters(along, i) = parameters[static_cast<std::size_t>(i)];
    if (i > 0)
    {
      mesh.Lines.col(i - 1) << i - 1, i;
      mesh.LineElements.col(i - 1) = elements[static_cast<std::size_t>(i - 1)];
    }
  }
  for (std::size_t s = 0; s < domain.Splines.size(); ++s)
  {
    const Evaluator evaluator(domain.Splines[s]);
    Eigen::MatrixXd values(evaluator.Components(), count);
    evaluator.Evaluate(parameters.size(), mesh.Parameters.data(), values.data());
    if (s == 0)
    {
      mesh.Points.topRows(values.rows()) = values;
    }
    else
    {
      mesh.Attributes.push_back(std::move(values));
    }
  }
  return mesh;
}

}

void CheckTolerances(
  const Patch& patch, double tolerance, const std::vector<double>& attributeTolerances)
{
  const Aggregate& body = patch.Body;
  if (!(tolerance > 0.0) || !std::isfinite(tolerance))
  {
    throw Error("the tolerance is " + std::to_string(tolerance) + "; it must be a positive length");
  }
  if (!attributeTolerances.empty() && attributeTolerances.size() != body.Attributes().size())
  {
    throw Error(std::to_string(attributeTolerances.size()) + " attribute tolerances for " +
      std::to_string(body.Attributes().size()) + " attributes; give one for each, or none");
  }
  for (std::size_t i = 0; i < attributeTolerances.size(); ++i)
  {
    if (!(attributeTolerances[i] >= 0.0))
    {
      throw Error("the tolerance of attribute \"" + body.Attributes()[i].Name + "\" is " +
        std::to_string(attributeTolerances[i]) + "; it must be positive, or 0 for off");
    }
  }
  for (int d = 0; d < 3; ++d)
  {
    const KnotVector& k = body.Geometry().Knots(d);
    if (k.Degree() == 0 && k.Spans().size() > 1)
    {
      throw Error(std::string("the geometry has degree 0 and ") + std::to_string(k.Spans().size()) +
        " spans in direction " + "uvw"[d] + ": it jumps there and has no surface");
    }
  }
}

SurfaceMesh TessellateBoundary(
  const Patch& patch, int handedness, const TessellationOptions& options)
{
  Check(patch, handedness, options);
  const Spline& geometry = patch.Body.Geometry();
  const std::vector<int> directions = DirectionsWithDegree(geometry);
  if (directions.size() == 1)
  {
    return TessellateCurve(patch, directions[0], options);
  }
  if (directions.size() == 2)
  {
    const int missing = 3 - directions[0] - directions[1];
    return Face(SplinesOnSide(patch.Body, 2 * missing), missing, geometry.Knots(missing).First(),
      patch.FirstSpan[static_cast<std::size_t>(missing)], 1.0, 4, patch.FirstSpan, options)
      .Tessellate();
  }
  SurfaceMesh mesh;
  for (const Attribute& attribute : patch.Body.Attributes())
  {
    mesh.Attributes.emplace_back(attribute.Field.Components(), 0);
  }
  for (int side = 0; directions.size() == 3 && side < NumberOfSides; ++side)
  {
    if (!patch.IsDomainFace[static_cast<std::size_t>(side)])
    {
      continue;
    }
    const int d = side / 2;
    const bool last = side % 2 == 1;
    const KnotVector& k = geometry.Knots(d);
    // P_v x P_w and P_u x P_v point along u and w, P_u x P_w against v.
    const double outward = (last ? 1.0 : -1.0) * (d == 1 ? -1.0 : 1.0) * handedness;
    const int element = patch.FirstSpan[static_cast<std::size_t>(d)] +
      (last ? static_cast<int>(k.Spans().size()) - 1 : 0);
    Append(mesh,
      Face(SplinesOnSide(patch.Body, side), d, last ? k.Last() : k.First(), element, outward, side,
        patch.FirstSpan, options)
        .Tessellate());
  }
  return mesh;
}

namespace
{

/// Segments of every cell along each direction of a volume, so that trilinear interpolation is
/// within the tolerances: sum of h_d^2 M_dd / 8 in every element.
std::array<std::vector<int>, 3> SolidSegments(
  const Domain& domain, const TessellationOptions& options, bool& limited)
{
  const std::size_t fields = domain.NumberOfBounds;
  const auto& axes = domain.Axes;
  const std::array<std::ptrdiff_t, 3> cells{ axes[0].Cells(), axes[1].Cells(), axes[2].Cells() };
  const std::ptrdiff_t count = cells[0] * cells[1] * cells[2];
  const auto triple = [&](std::ptrdiff_t c)
  {
    return std::array<int, 3>{ static_cast<int>(c % cells[0]),
      static_cast<int>(c / cells[0] % cells[1]), static_cast<int>(c / (cells[0] * cells[1])) };
  };
  std::vector<std::array<double, 3>> bends(static_cast<std::size_t>(count) * fields);
  options.For(count, 32,
    [&](std::ptrdiff_t begin, std::ptrdiff_t end)
    {
      ChordBound bound;
      Eigen::MatrixXd points;
      for (std::ptrdiff_t c = begin; c < end; ++c)
      {
        std::array<double, 3>* bend = bends.data() + static_cast<std::size_t>(c) * fields;
        for (const Domain::Measured& field : domain.Fields)
        {
          const Spline& spline = domain.Splines[field.Index];
          domain.Extract(field, triple(c), points);
          const double scale = 1.0 / (8.0 * field.Tolerance);
          for (const ChordBound::Bound& b :
            bound(points, spline.Degrees(), spline.IsRational(), field.Norm, Halvings[2]))
          {
            *bend++ = { scale * b.Second[0], scale * b.Second[3], scale * b.Second[5] };
          }
        }
      }
    });
  // First what each direction needs by itself; then all layers of an element are refined together
  // by what it still lacks. Both steps take maxima, so that no order of elements matters.
  std::array<std::vector<double>, 3> needed;
  for (std::size_t d = 0; d < 3; ++d)
  {
    needed[d].assign(static_cast<std::size_t>(cells[d]), 1.0);
  }
  const auto forAll = [&](const auto& body)
  {
    for (std::ptrdiff_t c = 0; c < count; ++c)
    {
      const auto cell = triple(c);
      for (std::size_t k = 0; k < fields; ++k)
      {
        body(cell, bends[static_cast<std::size_t>(c) * fields + k]);
      }
    }
  };
  forAll(
    [&](const std::array<int, 3>& cell, const std::array<double, 3>& bend)
    {
      for (std::size_t d = 0; d < 3; ++d)
      {
        double& n = needed[d][static_cast<std::size_t>(cell[d])];
        n = std::max(n, std::sqrt(bend[d]));
      }
    });
  const auto alone = needed;
  forAll(
    [&](const std::array<int, 3>& cell, const std::array<double, 3>& bend)
    {
      double sum = 0.0;
      for (std::size_t d = 0; d < 3; ++d)
      {
        const double n = alone[d][static_cast<std::size_t>(cell[d])];
        sum += bend[d] / (n * n);
      }
      for (std::size_t d = 0; d < 3 && sum > 1.0; ++d)
      {
        const auto slab = static_cast<std::size_t>(cell[d]);
        if (bend[d] > 0.0)
        {
          needed[d][slab] = std::max(needed[d][slab], alone[d][slab] * std::sqrt(sum));
        }
      }
    });
  std::array<std::vector<int>, 3> segments;
  for (std::size_t d = 0; d < 3; ++d)
  {
    for (double n : needed[d])
    {
      segments[d].push_back(Count(n, options.MaximumSubdivision, limited));
    }
  }
  return segments;
}

std::vector<Spline> SplinesOf(const Aggregate& body)
{
  std::vector<Spline> splines{ body.Geometry() };
  for (const Attribute& attribute : body.Attributes())
  {
    splines.push_back(attribute.Field);
  }
  return splines;
}

/// The tensor grid that hexahedra are made of.
struct SolidGrid
{
  std::array<std::vector<double>, 3> Lines; ///< ascending parameters
  /// Per layer between lines: the non-empty knot span of the geometry, counted in this part.
  std::array<std::vector<int>, 3> Spans;
  bool LimitReached = false;
};

SolidGrid MakeGrid(const Domain& domain, const TessellationOptions& options)
{
  SolidGrid grid;
  const auto segments = SolidSegments(domain, options, grid.LimitReached);
  for (std::size_t d = 0; d < 3; ++d)
  {
    const ElementAxis& axis = domain.Axes[d];
    grid.Lines[d].push_back(axis.Breaks.front());
    for (int c = 0; c < axis.Cells(); ++c)
    {
      const int n = segments[d][static_cast<std::size_t>(c)];
      for (int k = 1; k <= n; ++k)
      {
        grid.Lines[d].push_back(axis.At(c, static_cast<double>(k) / n));
        grid.Spans[d].push_back(axis.Spans[0][static_cast<std::size_t>(c)]);
      }
    }
  }
  return grid;
}

}

SolidMesh TessellateSolid(const Patch& patch, int handedness, const TessellationOptions& options)
{
  Check(patch, handedness, options);
  const Aggregate& body = patch.Body;
  if (DirectionsWithDegree(body.Geometry()).size() != 3)
  {
    throw Error("hexahedra need a volume; this patch has " +
      std::to_string(body.Geometry().Dimension()) +
      " parametric dimensions: tessellate its surface instead");
  }
  const Domain domain(SplinesOf(body), options);
  SolidMesh mesh;
  const SolidGrid grid = MakeGrid(domain, options);
  mesh.LimitReached = grid.LimitReached;
  const auto& lines = grid.Lines;
  const auto nu = static_cast<Id>(lines[0].size());
  const auto nv = static_cast<Id>(lines[1].size());
  const auto nw = static_cast<Id>(lines[2].size());
  mesh.Parameters.resize(3, nu * nv * nw);
  mesh.Points.setZero(3, nu * nv * nw);
  for (std::size_t s = 1; s < domain.Splines.size(); ++s)
  {
    mesh.Attributes.emplace_back(domain.Splines[s].Components(), nu * nv * nw);
  }
  const Evaluator geometry(domain.Splines[0]);
  std::vector<Evaluator> attributes;
  for (std::size_t s = 1; s < domain.Splines.size(); ++s)
  {
    attributes.emplace_back(domain.Splines[s]);
  }
  options.For(nw, 1,
    [&](std::ptrdiff_t begin, std::ptrdiff_t end)
    {
      const Id first = begin * nu * nv;
      Id id = first;
      for (std::ptrdiff_t k = begin; k < end; ++k)
      {
        for (double v : lines[1])
        {
          for (double u : lines[0])
          {
            mesh.Parameters.col(id++) << u, v, lines[2][static_cast<std::size_t>(k)];
          }
        }
      }
      const std::array<std::vector<double>, 3> layers{ lines[0], lines[1],
        { lines[2].begin() + begin, lines[2].begin() + end } };
      Eigen::MatrixXd values(geometry.Components(), id - first);
      geometry.EvaluateGrid(layers, values.data());
      mesh.Points.block(0, first, values.rows(), values.cols()) = values;
      for (std::size_t a = 0; a < attributes.size(); ++a)
      {
        attributes[a].EvaluateGrid(layers, mesh.Attributes[a].col(first).data());
      }
    });

  const Id hexahedra = (nu - 1) * (nv - 1) * (nw - 1);
  mesh.Hexahedra.resize(8, hexahedra);
  mesh.Elements.resize(3, hexahedra);
  // A mirrored patch has its lower and upper quadrilaterals exchanged.
  const Id lower = handedness > 0 ? 0 : nu * nv;
  const Id upper = nu * nv - lower;
  options.For(nw - 1, 1,
    [&](std::ptrdiff_t begin, std::ptrdiff_t end)
    {
      Id id = begin * (nu - 1) * (nv - 1);
      for (Id k = begin; k < end; ++k)
      {
        for (Id j = 0; j + 1 < nv; ++j)
        {
          for (Id i = 0; i + 1 < nu; ++i, ++id)
          {
            const Id p = i + nu * (j + nv * k);
            mesh.Hexahedra.col(id) << p + lower, p + 1 + lower, p + 1 + nu + lower, p + nu + lower,
              p + upper, p + 1 + upper, p + 1 + nu + upper, p + nu + upper;
            mesh.Elements.col(id) << patch.FirstSpan[0] +
                grid.Spans[0][static_cast<std::size_t>(i)],
              patch.FirstSpan[1] + grid.Spans[1][static_cast<std::size_t>(j)],
              patch.FirstSpan[2] + grid.Spans[2][static_cast<std::size_t>(k)];
          }
        }
      }
    });
  return mesh;
}

}
