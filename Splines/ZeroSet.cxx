// SPDX-License-Identifier: BSD-3-Clause
#include "ZeroSet.h"

#include "MarchingCells.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <numeric>
#include <utility>

namespace hyperpatch
{

namespace
{

using Index = std::int64_t;
using Cell = std::array<int, 3>; ///< indices of its low corner among the grid lines

/// Points per call of a field or evaluator.
constexpr Index Batch = 512;

/// Breaks of several bases as one ascending list; those that differ by round-off count as one.
std::vector<double> MergeBreaks(std::vector<double> all)
{
  std::sort(all.begin(), all.end());
  const double same = 1e-12 * (all.back() - all.front());
  std::vector<double> merged{ all.front() };
  for (double b : all)
  {
    if (b - merged.back() > same)
    {
      merged.push_back(b);
    }
  }
  merged.back() = all.back();
  return merged;
}

/// A crossed edge of a cell, or the corner that stands for it where f is exactly zero there.
struct Crossing
{
  Index Key; ///< 4 * corner + axis; axis 3 for the corner itself
  double Low;
  double High; ///< f at both ends
};

/// A cell with pieces of the surface.
struct CrossedCell
{
  Cell At;
  unsigned Positive; ///< sign bits of its corners
  unsigned Zero;     ///< bits of corners where f is exactly zero
};

/// What a chunk of elements found.
struct Found
{
  std::vector<CrossedCell> Crossed;
  std::vector<Crossing> Crossings;
  Index Undecided = 0;
  double LargestValue = 0.0;
  std::vector<Cell> Wide; ///< undecided cells that are wider than the feature size
};

/// What two parameters must differ by to be told apart after a sum or product.
double Resolution(double a, double b)
{
  return std::numeric_limits<double>::epsilon() * std::max(std::abs(a), std::abs(b));
}

Eigen::Vector3d ClosestOnSegment(
  const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b, double& t)
{
  const Eigen::Vector3d ab = b - a;
  const double square = ab.squaredNorm();
  t = square > 0.0 ? std::clamp((p - a).dot(ab) / square, 0.0, 1.0) : 0.0;
  return a + t * ab;
}

}

void ZeroSetCertificate::Add(const ZeroSetCertificate& other)
{
  this->CrossedCells += other.CrossedCells;
  this->UndecidedCells += other.UndecidedCells;
  this->LargestResidual = std::max(this->LargestResidual, other.LargestResidual);
  this->LargestError = std::max(this->LargestError, other.LargestError);
  this->LargestAttributeError = std::max(this->LargestAttributeError, other.LargestAttributeError);
  this->ToleranceReached = this->ToleranceReached && other.ToleranceReached;
}

class ZeroSet::Worker
{
public:
  Worker(const Aggregate& body, const ScalarField& field, ZeroSetOptions options);

  bool Extract();

  CellGrid Grid;
  std::array<std::vector<int>, 3> Wanted;
  ZeroSetMesh Mesh;
  ZeroSetCertificate Certificate;

private:
  void MakeLines();
  /// Calls body(begin, end) in parallel and stops early when aborted.
  bool Parallel(Index count, Index grain, const std::function<void(Index, Index)>& body);

  // Steps of Extract(), in order.
  bool FindCrossings();
  void SearchElement(const Cell& element, Found& found) const;
  void SearchBox(
    Cell low, Cell high, const Bernstein& f, std::vector<Cell>& cells, Found& found) const;
  void SignCells(const std::vector<Cell>& cells, bool certified, Found& found) const;
  /// Whether a zero in a cell can neither be excluded nor shows as a sign change at corners.
  [[nodiscard]] bool IsUndecided(const Bernstein& f) const;
  [[nodiscard]] bool IsExcluded(const Bernstein& f, int depth) const;
  bool FindVertices();
  bool EvaluateVertices();
  void MakeCells();
  void Triangulate(const std::vector<Index>& ring, const std::vector<CellEdge>& edges,
    std::vector<std::array<Index, 3>>& triangles) const;
  /// Where the surface only touches a corner there is a vertex but no cell.
  void DropUnusedPoints();
  bool MeasureErrors();
  void MeasureCells(Index begin, Index end, ZeroSetCertificate& certificate,
    std::array<std::vector<int>, 3>& wanted) const;

  [[nodiscard]] Index Corner(const Cell& at) const
  {
    return at[0] + this->Counts[0] * (at[1] + this->Counts[1] * static_cast<Index>(at[2]));
  }
  [[nodiscard]] Cell CornerOfKey(Index key) const;
  [[nodiscard]] double Line(int direction, int i) const
  {
    return this->Lines[static_cast<std::size_t>(direction)][static_cast<std::size_t>(i)];
  }
  [[nodiscard]] double Width(const Cell& at) const;
  /// Intervals of the grid (between breaks) that hold a cell.
  [[nodiscard]] int Interval(int direction, int line) const
  {
    return this
      ->IntervalOfLine[static_cast<std::size_t>(direction)][static_cast<std::size_t>(line)];
  }
  void Want(
    const Cell& at, double factor, std::array<std::vector<int>, 3>& wanted, bool& reached) const;

  const Aggregate& Body;
  const ScalarField& Field;
  ZeroSetOptions Options;
  Evaluator Geometry;
  std::vector<Evaluator> Attributes;
  std::vector<int> Axes; ///< the directions that are there
  std::array<std::vector<double>, 3> Lines;
  std::array<std::vector<int>, 3> IntervalOfLine;
  std::array<std::vector<double>, 3> Creases; ///< parameters where mesh edges follow the geometry
  std::array<Index, 3> Counts{};              ///< of lines

  std::vector<CrossedCell> Crossed;
  std::vector<Crossing> Vertices; ///< unique, sorted by key
  std::vector<Cell> CellOfPiece;  ///< per mesh cell
  double LargestValue = 0.0;
};

ZeroSet::Worker::Worker(const Aggregate& body, const ScalarField& field, ZeroSetOptions options)
  : Body(body)
  , Field(field)
  , Options(std::move(options))
  , Geometry(body.Geometry())
{
  std::array<std::vector<double>, 3> breaks = field.Breaks();
  const auto add = [&breaks](const Spline& spline)
  {
    for (std::size_t d = 0; d < 3; ++d)
    {
      const std::vector<double> more = spline.Knots()[d].Breaks();
      breaks[d].insert(breaks[d].end(), more.begin(), more.end());
    }
  };
  add(body.Geometry());
  for (const Attribute& attribute : body.Attributes())
  {
    this->Attributes.emplace_back(attribute.Field);
    add(attribute.Field);
  }
  for (int d = 0; d < 3; ++d)
  {
    const auto D = static_cast<std::size_t>(d);
    const KnotVector& knots = body.Geometry().Knots(d);
    this->Grid.Breaks[D] = MergeBreaks(breaks[D]);
    if (knots.Degree() > 0)
    {
      this->Axes.push_back(d);
      this->Grid.Counts[D].assign(this->Grid.Breaks[D].size() - 1, 1);
      this->Creases[D] = knots.Creases();
      this->Creases[D].push_back(knots.First());
      this->Creases[D].push_back(knots.Last());
    }
  }
  this->Options.AttributeTolerances.resize(body.Attributes().size(), 0.0);
  if (this->Options.FeatureSize <= 0.0)
  {
    this->Options.FeatureSize = 16.0 * this->Options.Tolerance;
  }
  this->Wanted = this->Grid.Counts;
}

bool ZeroSet::Worker::Parallel(
  Index count, Index grain, const std::function<void(Index, Index)>& body)
{
  // Chunks begin at multiples of the grain whatever the threads do: some results go by chunk.
  this->Options.For(static_cast<std::ptrdiff_t>((count + grain - 1) / grain), 1,
    [this, &body, count, grain](std::ptrdiff_t begin, std::ptrdiff_t end)
    {
      for (Index c = begin; c < end && !this->Options.Abort(); ++c)
      {
        body(c * grain, std::min(count, (c + 1) * grain));
      }
    });
  return !this->Options.Abort();
}

void ZeroSet::Worker::MakeLines()
{
  for (std::size_t d = 0; d < 3; ++d)
  {
    this->Lines[d].clear();
    this->IntervalOfLine[d].clear();
    const std::vector<double>& breaks = this->Grid.Breaks[d];
    const std::vector<int>& counts = this->Grid.Counts[d];
    for (std::size_t b = 0; b < counts.size(); ++b)
    {
      for (int i = 0; i < counts[b]; ++i)
      {
        const double t = static_cast<double>(i) / counts[b];
        this->Lines[d].push_back(i == 0 ? breaks[b] : breaks[b] + t * (breaks[b + 1] - breaks[b]));
        this->IntervalOfLine[d].push_back(static_cast<int>(b));
      }
    }
    this->Lines[d].push_back(counts.empty() ? breaks.front() : breaks.back());
    this->IntervalOfLine[d].push_back(std::max(0, static_cast<int>(counts.size()) - 1));
    this->Counts[d] = static_cast<Index>(this->Lines[d].size());
  }
}

Cell ZeroSet::Worker::CornerOfKey(Index key) const
{
  const Index corner = key / 4;
  return { static_cast<int>(corner % this->Counts[0]),
    static_cast<int>(corner / this->Counts[0] % this->Counts[1]),
    static_cast<int>(corner / (this->Counts[0] * this->Counts[1])) };
}

double ZeroSet::Worker::Width(const Cell& at) const
{
  Eigen::AlignedBox3d box;
  for (int c = 0; c < 1 << this->Axes.size(); ++c)
  {
    Eigen::Vector3d parameter;
    for (int d = 0; d < 3; ++d)
    {
      parameter[d] = this->Line(d, at[static_cast<std::size_t>(d)]);
    }
    for (std::size_t a = 0; a < this->Axes.size(); ++a)
    {
      if (c >> a & 1)
      {
        const int d = this->Axes[a];
        parameter[d] = this->Line(d, at[static_cast<std::size_t>(d)] + 1);
      }
    }
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    this->Geometry.Evaluate(1, parameter.data(), point.data());
    box.extend(point);
  }
  return box.diagonal().norm();
}

bool ZeroSet::Worker::IsUndecided(const Bernstein& f) const
{
  double low = INFINITY;
  double high = -INFINITY;
  const auto n = f.Degrees();
  const Index nu = n[0] + 1;
  const Index nv = n[1] + 1;
  for (int c = 0; c < 8; ++c)
  {
    const Index i = (c & 1) * n[0] + nu * ((c >> 1 & 1) * n[1] + nv * ((c >> 2) * n[2]));
    low = std::min(low, f.Coefficients()[i]);
    high = std::max(high, f.Coefficients()[i]);
  }
  const double noise = f.RoundingBound();
  // A surface through a corner, up to round-off, is drawn by the cells on its other side.
  const bool throughCorner =
    (f.Min() >= -noise && low <= noise) || (f.Max() <= noise && high >= -noise);
  const bool signChange = low < 0.0 && high >= 0.0;
  return !throughCorner && !signChange &&
    !this->IsExcluded(f, 2 * static_cast<int>(this->Axes.size()));
}

bool ZeroSet::Worker::IsExcluded(const Bernstein& f, int depth) const
{
  if (f.Min() > f.RoundingBound() || f.Max() < -f.RoundingBound())
  {
    return true;
  }
  if (depth == 0)
  {
    return false;
  }
  const int direction = this->Axes[static_cast<std::size_t>(depth) % this->Axes.size()];
  const auto [low, high] = f.Split(direction, 0.5);
  return this->IsExcluded(low, depth - 1) && this->IsExcluded(high, depth - 1);
}

void ZeroSet::Worker::SearchBox(
  Cell low, Cell high, const Bernstein& f, std::vector<Cell>& cells, Found& found) const
{
  if (f.Min() > f.RoundingBound() || f.Max() < -f.RoundingBound())
  {
    return;
  }
  int widest = this->Axes.front();
  for (int d : this->Axes)
  {
    const auto D = static_cast<std::size_t>(d);
    const auto W = static_cast<std::size_t>(widest);
    widest = high[D] - low[D] > high[W] - low[W] ? d : widest;
  }
  const auto W = static_cast<std::size_t>(widest);
  if (high[W] - low[W] == 1)
  {
    if (this->IsUndecided(f))
    {
      ++found.Undecided;
      if (this->Width(low) > this->Options.FeatureSize)
      {
        found.Wide.push_back(low);
      }
    }
    cells.push_back(low);
    return;
  }
  const int middle = (low[W] + high[W]) / 2;
  const double begin = this->Line(widest, low[W]);
  const double t = (this->Line(widest, middle) - begin) / (this->Line(widest, high[W]) - begin);
  const auto [first, second] = f.Split(widest, t);
  Cell cut = high;
  cut[W] = middle;
  this->SearchBox(low, cut, first, cells, found);
  cut = low;
  cut[W] = middle;
  this->SearchBox(cut, high, second, cells, found);
}

void ZeroSet::Worker::SignCells(const std::vector<Cell>& cells, bool certified, Found& found) const
{
  const int axes = static_cast<int>(this->Axes.size());
  const int corners = 1 << axes;
  std::vector<double> parameters;
  std::vector<double> values;
  const Index step = Batch / corners;
  for (Index first = 0; first < static_cast<Index>(cells.size()); first += step)
  {
    const Index last = std::min<Index>(first + step, static_cast<Index>(cells.size()));
    parameters.clear();
    for (Index i = first; i < last; ++i)
    {
      const Cell& at = cells[static_cast<std::size_t>(i)];
      for (int c = 0; c < corners; ++c)
      {
        Cell corner = at;
        for (int a = 0; a < axes; ++a)
        {
          corner[static_cast<std::size_t>(this->Axes[static_cast<std::size_t>(a)])] += c >> a & 1;
        }
        for (int d = 0; d < 3; ++d)
        {
          parameters.push_back(this->Line(d, corner[static_cast<std::size_t>(d)]));
        }
      }
    }
    values.resize(parameters.size() / 3);
    this->Field.Evaluate(values.size(), parameters.data(), values.data());
    for (Index i = first; i < last; ++i)
    {
      const Cell& at = cells[static_cast<std::size_t>(i)];
      const double* f = values.data() + (i - first) * corners;
      CrossedCell cell{ at, 0, 0 };
      for (int c = 0; c < corners; ++c)
      {
        cell.Positive |= f[c] >= 0.0 ? 1u << c : 0u;
        cell.Zero |= f[c] == 0.0 ? 1u << c : 0u;
        found.LargestValue = std::max(found.LargestValue, std::abs(f[c]));
      }
      if (!certified)
      {
        ++found.Undecided;
      }
      if (cell.Positive == 0 || cell.Positive == (1u << corners) - 1)
      {
        continue;
      }
      found.Crossed.push_back(cell);
      for (int a = 0; a < axes; ++a)
      {
        for (int c = 0; c < corners; ++c)
        {
          const int other = c | 1 << a;
          if (other == c || ((cell.Positive >> c ^ cell.Positive >> other) & 1) == 0)
          {
            continue;
          }
          // Only a positive end can be zero; then the vertex is that corner.
          const bool atCorner = f[c] == 0.0 || f[other] == 0.0;
          const int at0 = atCorner && f[other] == 0.0 ? other : c;
          Cell corner = at;
          for (int b = 0; b < axes; ++b)
          {
            corner[static_cast<std::size_t>(this->Axes[static_cast<std::size_t>(b)])] +=
              at0 >> b & 1;
          }
          const int axis = atCorner ? 3 : this->Axes[static_cast<std::size_t>(a)];
          found.Crossings.push_back({ 4 * this->Corner(corner) + axis, f[c], f[other] });
        }
      }
    }
  }
}

void ZeroSet::Worker::SearchElement(const Cell& element, Found& found) const
{
  ParameterBox box{};
  Cell low{};
  Cell high{};
  for (std::size_t d = 0; d < 3; ++d)
  {
    const std::vector<double>& breaks = this->Grid.Breaks[d];
    const auto e = static_cast<std::size_t>(element[d]);
    box.Low[d] = breaks[e];
    box.High[d] = breaks[e + 1];
    if (!this->Grid.Counts[d].empty())
    {
      const auto& lines = this->IntervalOfLine[d];
      low[d] = static_cast<int>(
        std::lower_bound(lines.begin(), lines.end() - 1, element[d]) - lines.begin());
      high[d] = low[d] + this->Grid.Counts[d][e];
    }
    else
    {
      high[d] = 1;
    }
  }
  if (this->Field.Excludes(box))
  {
    return;
  }
  std::vector<Cell> cells;
  const auto f = this->Field.OnBox(box);
  if (f)
  {
    this->SearchBox(low, high, *f, cells, found);
  }
  else
  {
    for (int k = low[2]; k < high[2]; ++k)
    {
      for (int j = low[1]; j < high[1]; ++j)
      {
        for (int i = low[0]; i < high[0]; ++i)
        {
          cells.push_back({ i, j, k });
        }
      }
    }
  }
  this->SignCells(cells, f.has_value(), found);
}

bool ZeroSet::Worker::FindCrossings()
{
  std::array<Index, 3> elements{};
  for (std::size_t d = 0; d < 3; ++d)
  {
    elements[d] = std::max<Index>(1, static_cast<Index>(this->Grid.Counts[d].size()));
  }
  const Index count = elements[0] * elements[1] * elements[2];
  // Chunks are many enough for any number of threads; their order makes the result one and the
  // same.
  const Index chunk = std::clamp<Index>(count / 256, 1, 4096);
  std::vector<Found> found(static_cast<std::size_t>((count + chunk - 1) / chunk));
  if (!this->Parallel(static_cast<Index>(found.size()), 1,
        [&](Index begin, Index end)
        {
          for (Index c = begin; c < end; ++c)
          {
            for (Index e = c * chunk; e < std::min(count, (c + 1) * chunk); ++e)
            {
              this->SearchElement({ static_cast<int>(e % elements[0]),
                                    static_cast<int>(e / elements[0] % elements[1]),
                                    static_cast<int>(e / (elements[0] * elements[1])) },
                found[static_cast<std::size_t>(c)]);
            }
          }
        }))
  {
    return false;
  }
  this->Crossed.clear();
  this->Vertices.clear();
  this->LargestValue = 0.0;
  for (const Found& f : found)
  {
    this->Crossed.insert(this->Crossed.end(), f.Crossed.begin(), f.Crossed.end());
    this->Vertices.insert(this->Vertices.end(), f.Crossings.begin(), f.Crossings.end());
    this->Certificate.UndecidedCells += f.Undecided;
    this->LargestValue = std::max(this->LargestValue, f.LargestValue);
    for (const Cell& wide : f.Wide)
    {
      this->Want(wide, 2.0, this->Wanted, this->Certificate.ToleranceReached);
    }
  }
  this->Certificate.CrossedCells = static_cast<Index>(this->Crossed.size());
  const auto byKey = [](const Crossing& a, const Crossing& b) { return a.Key < b.Key; };
  std::sort(this->Vertices.begin(), this->Vertices.end(), byKey);
  const auto last = std::unique(this->Vertices.begin(), this->Vertices.end(),
    [](const Crossing& a, const Crossing& b) { return a.Key == b.Key; });
  this->Vertices.erase(last, this->Vertices.end());
  return true;
}

bool ZeroSet::Worker::FindVertices()
{
  const auto count = static_cast<Index>(this->Vertices.size());
  this->Mesh.Parameters.resize(3, count);
  std::vector<double> residuals(static_cast<std::size_t>((count + Batch - 1) / Batch), 0.0);
  const bool finished = this->Parallel(count, Batch,
    [&](Index begin, Index end)
    {
      // Bracketed roots along edges, all of a batch in step: false position with Illinois' halved
      // weights, and a bisection wherever it does not halve the bracket in three steps.
      struct Bracket
      {
        Index Vertex;
        int Axis;
        double Low, High, FLow, FHigh;
        double WeightLow, WeightHigh; ///< Illinois: of an end that stays
        double Width;
        int Side, Steps;
      };
      constexpr int Most = 4 * 64; // steps, should every bracket have to be bisected
      std::vector<Bracket> open;
      std::vector<double> parameters;
      std::vector<double> values;
      double& residual = residuals[static_cast<std::size_t>(begin / Batch)];
      for (Index v = begin; v < end; ++v)
      {
        const Crossing& crossing = this->Vertices[static_cast<std::size_t>(v)];
        const Cell corner = this->CornerOfKey(crossing.Key);
        const int axis = static_cast<int>(crossing.Key % 4);
        for (int d = 0; d < 3; ++d)
        {
          this->Mesh.Parameters(d, v) = this->Line(d, corner[static_cast<std::size_t>(d)]);
        }
        if (axis < 3)
        {
          const int i = corner[static_cast<std::size_t>(axis)];
          const double low = this->Line(axis, i);
          const double high = this->Line(axis, i + 1);
          open.push_back(
            { v, axis, low, high, crossing.Low, crossing.High, 1.0, 1.0, high - low, 0, 0 });
        }
      }
      for (int iteration = 0; !open.empty(); ++iteration)
      {
        parameters.resize(3 * open.size());
        values.resize(open.size());
        for (std::size_t b = 0; b < open.size(); ++b)
        {
          Bracket& o = open[b];
          const double low = o.WeightLow * o.FLow;
          const double high = o.WeightHigh * o.FHigh;
          double t = o.Low - low * (o.High - o.Low) / (high - low);
          if (o.Steps == 3)
          {
            o.Steps = 0;
            if (o.High - o.Low > 0.5 * o.Width)
            {
              t = 0.5 * (o.Low + o.High);
              o.WeightLow = o.WeightHigh = 1.0;
              o.Side = 0;
            }
            o.Width = o.High - o.Low;
          }
          ++o.Steps;
          // Never closer to an end than it matters: so a root beside an end closes the bracket.
          const double step = std::min(Resolution(o.Low, o.High), 0.5 * (o.High - o.Low));
          t = t > o.Low + step ? t : o.Low + step;
          t = t < o.High - step ? t : o.High - step;
          for (int d = 0; d < 3; ++d)
          {
            parameters[3 * b + static_cast<std::size_t>(d)] = this->Mesh.Parameters(d, o.Vertex);
          }
          parameters[3 * b + static_cast<std::size_t>(o.Axis)] = t;
        }
        this->Field.Evaluate(open.size(), parameters.data(), values.data());
        std::size_t kept = 0;
        for (std::size_t b = 0; b < open.size(); ++b)
        {
          Bracket o = open[b];
          const double t = parameters[3 * b + static_cast<std::size_t>(o.Axis)];
          const double f = values[b];
          if ((f >= 0.0) == (o.FHigh >= 0.0))
          {
            o.High = t;
            o.FHigh = f;
            o.WeightHigh = 1.0;
            o.WeightLow *= o.Side == 1 ? 0.5 : 1.0;
            o.Side = 1;
          }
          else
          {
            o.Low = t;
            o.FLow = f;
            o.WeightLow = 1.0;
            o.WeightHigh *= o.Side == -1 ? 0.5 : 1.0;
            o.Side = -1;
          }
          if (f == 0.0 || o.High - o.Low <= 2.0 * Resolution(o.Low, o.High) || iteration == Most ||
            !std::isfinite(f))
          {
            const bool low = std::abs(o.FLow) < std::abs(o.FHigh);
            this->Mesh.Parameters(o.Axis, o.Vertex) = low ? o.Low : o.High;
            residual = std::max(residual, std::abs(low ? o.FLow : o.FHigh));
          }
          else
          {
            open[kept++] = o;
          }
        }
        open.resize(kept);
      }
    });
  const double largest =
    residuals.empty() ? 0.0 : *std::max_element(residuals.begin(), residuals.end());
  this->Certificate.LargestResidual = this->LargestValue > 0.0 ? largest / this->LargestValue : 0.0;
  return finished;
}

bool ZeroSet::Worker::EvaluateVertices()
{
  const Index count = this->Mesh.Parameters.cols();
  const int m = this->Geometry.Components();
  this->Mesh.Points.setZero(3, count);
  this->Mesh.Normals.setZero(3, count);
  this->Mesh.Attributes.resize(this->Attributes.size());
  for (std::size_t a = 0; a < this->Attributes.size(); ++a)
  {
    this->Mesh.Attributes[a].resize(this->Attributes[a].Components(), count);
  }
  return this->Parallel(count, Batch,
    [&](Index begin, Index end)
    {
      const auto n = static_cast<std::size_t>(end - begin);
      const double* parameters = this->Mesh.Parameters.col(begin).data();
      Eigen::MatrixXd points(m, end - begin);
      Eigen::MatrixXd derivatives(3 * m, end - begin);
      std::vector<double> values(n);
      Eigen::Matrix3Xd gradients(3, end - begin);
      this->Geometry.EvaluateWithDerivatives(n, parameters, points.data(), derivatives.data());
      this->Mesh.Points.block(0, begin, m, end - begin) = points;
      this->Field.EvaluateWithGradient(n, parameters, values.data(), gradients.data());
      this->Field.Snap(n, this->Mesh.Points.col(begin).data());
      for (std::size_t a = 0; a < this->Attributes.size(); ++a)
      {
        this->Attributes[a].Evaluate(n, parameters, this->Mesh.Attributes[a].col(begin).data());
      }
      for (Index i = 0; i < end - begin; ++i)
      {
        Eigen::Matrix3d J = Eigen::Matrix3d::Zero();
        for (int d = 0; d < 3; ++d)
        {
          J.col(d).head(m) = derivatives.block(d * m, i, m, 1);
        }
        // cof(J) grad f: the physical gradient times det J, so it does not flip across folds.
        Eigen::Vector3d normal = Eigen::Vector3d::Zero();
        if (this->Axes.size() == 3)
        {
          const Eigen::Vector3d g = gradients.col(i);
          normal = this->Options.Handedness *
            (g[0] * J.col(1).cross(J.col(2)) + g[1] * J.col(2).cross(J.col(0)) +
              g[2] * J.col(0).cross(J.col(1)));
        }
        else if (this->Axes.size() == 2)
        {
          normal = J.col(this->Axes[0]).cross(J.col(this->Axes[1]));
        }
        const double norm = normal.norm();
        this->Mesh.Normals.col(begin + i) = norm > 0.0 ? Eigen::Vector3d(normal / norm) : normal;
      }
    });
}

void ZeroSet::Worker::Triangulate(const std::vector<Index>& ring,
  const std::vector<CellEdge>& edges, std::vector<std::array<Index, 3>>& triangles) const
{
  // The triangulation with the least sum of squared diagonals: flat, well shaped, the same on any
  // thread. A diagonal inside a face of the cell is forbidden where there is another way: the
  // neighbour might draw it too. Klincsek's dynamic program; polygons are short.
  constexpr std::size_t Most = 16;
  const std::size_t n = ring.size();
  std::array<std::array<double, Most>, Most> cost{};
  std::array<std::array<std::size_t, Most>, Most> apex{};
  const auto weight = [&](std::size_t i, std::size_t j)
  {
    if (j - i == 1 || j - i == n - 1)
    {
      return 0.0;
    }
    bool inFace = false;
    for (int a = 0; a < 3; ++a)
    {
      inFace = inFace ||
        (a != edges[i].Axis && a != edges[j].Axis &&
          ((edges[i].Corner ^ edges[j].Corner) >> a & 1) == 0);
    }
    const double square =
      (this->Mesh.Points.col(ring[i]) - this->Mesh.Points.col(ring[j])).squaredNorm();
    return inFace ? 1e100 : square;
  };
  for (std::size_t length = 2; length < n; ++length)
  {
    for (std::size_t i = 0; i + length < n; ++i)
    {
      const std::size_t j = i + length;
      cost[i][j] = INFINITY;
      for (std::size_t k = i + 1; k < j; ++k)
      {
        const double sum = cost[i][k] + cost[k][j] + weight(i, k) + weight(k, j);
        if (sum < cost[i][j])
        {
          cost[i][j] = sum;
          apex[i][j] = k;
        }
      }
    }
  }
  triangles.clear();
  const std::function<void(std::size_t, std::size_t)> cut = [&](std::size_t i, std::size_t j)
  {
    if (j - i < 2)
    {
      return;
    }
    const std::size_t k = apex[i][j];
    if (ring[i] != ring[k] && ring[k] != ring[j] && ring[j] != ring[i])
    {
      triangles.push_back({ ring[i], ring[k], ring[j] });
    }
    cut(i, k);
    cut(k, j);
  };
  cut(0, n - 1);
}

void ZeroSet::Worker::MakeCells()
{
  const int axes = static_cast<int>(this->Axes.size());
  std::vector<Index> indices;
  this->CellOfPiece.clear();
  std::vector<Index> ring;
  std::vector<CellEdge> edges;
  std::vector<std::array<Index, 3>> triangles;
  const auto vertexOf = [&](const CrossedCell& cell, const CellEdge& edge)
  {
    const int other = edge.Corner | 1 << edge.Axis;
    const bool low = cell.Zero >> edge.Corner & 1u;
    const bool high = cell.Zero >> other & 1u;
    const int from = high ? other : edge.Corner;
    Cell corner = cell.At;
    for (int b = 0; b < axes; ++b)
    {
      corner[static_cast<std::size_t>(this->Axes[static_cast<std::size_t>(b)])] += from >> b & 1;
    }
    const int axis = low || high ? 3 : this->Axes[static_cast<std::size_t>(edge.Axis)];
    const Index key = 4 * this->Corner(corner) + axis;
    return static_cast<Index>(std::lower_bound(this->Vertices.begin(), this->Vertices.end(), key,
                                [](const Crossing& c, Index k) { return c.Key < k; }) -
      this->Vertices.begin());
  };
  const auto add = [&](const Cell& at, std::initializer_list<Index> cell)
  {
    indices.insert(indices.end(), cell);
    this->CellOfPiece.push_back(at);
  };
  const auto point = [this](Index v) { return this->Mesh.Points.col(v); };
  for (const CrossedCell& cell : this->Crossed)
  {
    for (const std::vector<CellEdge>& piece : PiecesOfCell(axes, cell.Positive))
    {
      ring.clear();
      edges.clear();
      for (const CellEdge& edge : piece)
      {
        const Index v = vertexOf(cell, edge);
        if (ring.empty() || ring.back() != v)
        {
          ring.push_back(v);
          edges.push_back(edge);
        }
      }
      while (ring.size() > 1 && ring.front() == ring.back())
      {
        ring.pop_back();
        edges.pop_back();
      }
      if (axes == 1)
      {
        add(cell.At, { ring[0] });
      }
      else if (axes == 2 && ring.size() == 2)
      {
        add(cell.At, { ring[0], ring[1] });
      }
      else if (axes == 3 && ring.size() >= 3)
      {
        this->Triangulate(ring, edges, triangles);
        for (const auto& [a, b, c] : triangles)
        {
          if (this->Options.Handedness > 0)
          {
            add(cell.At, { a, b, c });
          }
          else
          {
            add(cell.At, { a, c, b });
          }
        }
      }
    }
  }
  const auto count = static_cast<Index>(this->CellOfPiece.size());
  this->Mesh.Cells = Eigen::Map<const Eigen::Matrix<Index, Eigen::Dynamic, Eigen::Dynamic>>(
    indices.data(), axes, count);
  this->Mesh.Elements.resize(3, count);
  for (int d = 0; d < 3; ++d)
  {
    const std::vector<double> breaks = this->Body.Geometry().Knots(d).Breaks();
    for (Index c = 0; c < count; ++c)
    {
      const int i = this->CellOfPiece[static_cast<std::size_t>(c)][static_cast<std::size_t>(d)];
      const double low = this->Line(d, i);
      const double high =
        i + 1 < this->Counts[static_cast<std::size_t>(d)] ? this->Line(d, i + 1) : low;
      const auto span = std::upper_bound(breaks.begin() + 1, breaks.end() - 1, 0.5 * (low + high)) -
        breaks.begin() - 1;
      this->Mesh.Elements(d, c) = static_cast<int>(span);
    }
  }
  // Where the Jacobian has no rank at a pole there is no normal; take that of the triangles around.
  if (axes == 3)
  {
    std::vector<std::pair<Index, Index>> lost;
    for (Index c = 0; c < count; ++c)
    {
      for (int k = 0; k < 3; ++k)
      {
        if (this->Mesh.Normals.col(this->Mesh.Cells(k, c)).isZero(0.0))
        {
          lost.emplace_back(this->Mesh.Cells(k, c), c);
        }
      }
    }
    std::vector<std::pair<Index, Eigen::Vector3d>> sums;
    std::sort(lost.begin(), lost.end());
    for (const auto& [v, c] : lost)
    {
      const Eigen::Vector3d a = point(this->Mesh.Cells(0, c));
      const Eigen::Vector3d n =
        (point(this->Mesh.Cells(1, c)) - a).cross(point(this->Mesh.Cells(2, c)) - a);
      if (sums.empty() || sums.back().first != v)
      {
        sums.emplace_back(v, Eigen::Vector3d::Zero());
      }
      sums.back().second += n;
    }
    for (const auto& [v, n] : sums)
    {
      this->Mesh.Normals.col(v) = n.norm() > 0.0 ? Eigen::Vector3d(n.normalized()) : n;
    }
  }
}

void ZeroSet::Worker::Want(
  const Cell& at, double factor, std::array<std::vector<int>, 3>& wanted, bool& reached) const
{
  // Divide where the cell is long: its extent in physical space, along each direction.
  std::array<double, 3> extent{};
  double longest = 0.0;
  Eigen::Vector3d low;
  Eigen::Vector3d high;
  for (int d = 0; d < 3; ++d)
  {
    const auto D = static_cast<std::size_t>(d);
    low[d] = this->Line(d, at[D]);
    high[d] = at[D] + 1 < this->Counts[D] ? this->Line(d, at[D] + 1) : low[d];
  }
  const Eigen::Vector3d middle = 0.5 * (low + high);
  for (int d : this->Axes)
  {
    Eigen::Matrix3d ends;
    ends.col(0) = ends.col(1) = ends.col(2) = middle;
    ends(d, 0) = low[d];
    ends(d, 2) = high[d];
    const int m = this->Geometry.Components();
    Eigen::MatrixXd points(m, 3);
    this->Geometry.Evaluate(3, ends.data(), points.data());
    const double length =
      (points.col(1) - points.col(0)).norm() + (points.col(2) - points.col(1)).norm();
    extent[static_cast<std::size_t>(d)] = length;
    longest = std::max(longest, length);
  }
  for (int d : this->Axes)
  {
    const auto D = static_cast<std::size_t>(d);
    if (extent[D] < 0.4 * longest)
    {
      continue;
    }
    const auto b = static_cast<std::size_t>(this->Interval(d, at[D]));
    const int now = this->Grid.Counts[D][b];
    const int then = std::min(this->Options.MaximumSubdivision,
      std::max(now + 1, static_cast<int>(std::ceil(now * std::min(factor, 4.0)))));
    reached = reached && then > now;
    wanted[D][b] = std::max(wanted[D][b], then);
  }
}

void ZeroSet::Worker::MeasureCells(Index begin, Index end, ZeroSetCertificate& certificate,
  std::array<std::vector<int>, 3>& wanted) const
{
  const int axes = static_cast<int>(this->Axes.size());
  const int m = this->Geometry.Components();
  // Samples per cell: midpoints of its edges and, for a triangle, its centre.
  const int samples = axes == 3 ? 4 : 1;
  const Index count = (end - begin) * samples;
  Eigen::Matrix3Xd at(3, count);
  Eigen::Matrix3Xd step(3, count); ///< squared cell size where the sample may move, 0 where not
  std::vector<char> onCrease(static_cast<std::size_t>(count), 0);
  for (Index c = begin; c < end; ++c)
  {
    const Cell& cell = this->CellOfPiece[static_cast<std::size_t>(c)];
    for (int s = 0; s < samples; ++s)
    {
      const Index q = (c - begin) * samples + s;
      const Eigen::Vector3d a = this->Mesh.Parameters.col(this->Mesh.Cells(s % axes, c));
      const Eigen::Vector3d b = this->Mesh.Parameters.col(this->Mesh.Cells((s + 1) % axes, c));
      const bool centre = s == 3;
      at.col(q) = centre
        ? Eigen::Vector3d(
            (a + b + Eigen::Vector3d(this->Mesh.Parameters.col(this->Mesh.Cells(2, c)))) / 3.0)
        : Eigen::Vector3d(0.5 * (a + b));
      for (int d = 0; d < 3; ++d)
      {
        const auto D = static_cast<std::size_t>(d);
        const bool there = !this->Grid.Counts[D].empty();
        const double low = this->Line(d, cell[D]);
        const double high = there ? this->Line(d, cell[D] + 1) : low;
        const double h = high - low;
        // An edge in a plane of the grid belongs to the cells on both sides: stay in the plane.
        const bool locked = !centre && a[d] == b[d] && (a[d] == low || a[d] == high);
        step(d, q) = locked ? 0.0 : h * h;
        const auto& creases = this->Creases[D];
        if (there && locked && std::find(creases.begin(), creases.end(), a[d]) != creases.end())
        {
          onCrease[static_cast<std::size_t>(q)] = 1;
        }
      }
    }
  }
  std::vector<double> values(static_cast<std::size_t>(count));
  Eigen::Matrix3Xd gradients(3, count);
  for (int iteration = 0; iteration < 2; ++iteration)
  {
    this->Field.EvaluateWithGradient(
      static_cast<std::size_t>(count), at.data(), values.data(), gradients.data());
    for (Index q = 0; q < count; ++q)
    {
      const Eigen::Vector3d direction = step.col(q).cwiseProduct(gradients.col(q));
      const double slope = direction.dot(gradients.col(q));
      Eigen::Vector3d move = Eigen::Vector3d::Zero();
      if (slope > 0.0)
      {
        move = -values[static_cast<std::size_t>(q)] / slope * direction;
        // Further than the cell is wide is no step of Newton's but noise at a singular point.
        if ((move.array().square() > step.col(q).array()).any())
        {
          move.setZero();
        }
      }
      at.col(q) += move;
      for (int d : this->Axes)
      {
        const KnotVector& knots = this->Body.Geometry().Knots(d);
        at(d, q) = std::clamp(at(d, q), knots.First(), knots.Last());
      }
    }
  }
  Eigen::MatrixXd exact(m, count);
  this->Geometry.Evaluate(static_cast<std::size_t>(count), at.data(), exact.data());
  std::vector<Eigen::MatrixXd> attributes(this->Attributes.size());
  for (std::size_t a = 0; a < attributes.size(); ++a)
  {
    if (this->Options.AttributeTolerances[a] > 0.0)
    {
      attributes[a].resize(this->Attributes[a].Components(), count);
      this->Attributes[a].Evaluate(
        static_cast<std::size_t>(count), at.data(), attributes[a].data());
    }
  }
  for (Index c = begin; c < end; ++c)
  {
    double worst = 0.0; // of errors over tolerances
    for (int s = 0; s < samples; ++s)
    {
      const Index q = (c - begin) * samples + s;
      Eigen::Vector3d p = Eigen::Vector3d::Zero();
      p.head(m) = exact.col(q);
      const auto corner = [&](int k)
      { return Eigen::Vector3d(this->Mesh.Points.col(this->Mesh.Cells(k % axes, c))); };
      // Nearest point of the edge that the sample belongs to; of any edge in a sliver, whose plane
      // says nothing; of the triangle's plane otherwise, unless the mesh ends or bends at the edge.
      Eigen::Vector3d weights = Eigen::Vector3d::Zero();
      double error = INFINITY;
      const auto tryEdge = [&](int k)
      {
        double t = 0.0;
        const double distance = (p - ClosestOnSegment(p, corner(k), corner(k + 1), t)).norm();
        if (distance < error)
        {
          error = distance;
          weights.setZero();
          weights[k % axes] += 1.0 - t;
          weights[(k + 1) % axes] += t;
        }
      };
      const bool atCrease = onCrease[static_cast<std::size_t>(q)] != 0;
      if (axes == 2 || atCrease)
      {
        tryEdge(s);
      }
      else
      {
        const Eigen::Vector3d e1 = corner(1) - corner(0);
        const Eigen::Vector3d e2 = corner(2) - corner(0);
        const Eigen::Vector3d normal = e1.cross(e2);
        const double square = normal.squaredNorm();
        const double longest =
          std::max({ e1.squaredNorm(), e2.squaredNorm(), (e2 - e1).squaredNorm() });
        if (square > 1e-12 * longest * longest)
        {
          const Eigen::Vector3d r = p - corner(0);
          error = std::abs(r.dot(normal)) / std::sqrt(square);
          weights[1] = r.cross(e2).dot(normal) / square;
          weights[2] = e1.cross(r).dot(normal) / square;
          weights[0] = 1.0 - weights[1] - weights[2];
        }
        else
        {
          tryEdge(0);
          tryEdge(1);
          tryEdge(2);
        }
      }
      certificate.LargestError = std::max(certificate.LargestError, error);
      worst = std::max(worst, error / this->Options.Tolerance);
      for (std::size_t a = 0; a < attributes.size(); ++a)
      {
        const double tolerance = this->Options.AttributeTolerances[a];
        if (!(tolerance > 0.0))
        {
          continue;
        }
        Eigen::VectorXd difference = attributes[a].col(q);
        for (int k = 0; k < axes; ++k)
        {
          difference -= weights[k] * this->Mesh.Attributes[a].col(this->Mesh.Cells(k, c));
        }
        const double ratio = difference.cwiseAbs().maxCoeff() / tolerance;
        certificate.LargestAttributeError = std::max(certificate.LargestAttributeError, ratio);
        worst = std::max(worst, ratio);
      }
    }
    if (worst > 1.0)
    {
      // Errors fall with the square of the cell size.
      this->Want(this->CellOfPiece[static_cast<std::size_t>(c)], 1.05 * std::sqrt(worst), wanted,
        certificate.ToleranceReached);
    }
  }
}

void ZeroSet::Worker::DropUnusedPoints()
{
  std::vector<Index> place(static_cast<std::size_t>(this->Mesh.Points.cols()), -1);
  for (Index i = 0; i < this->Mesh.Cells.size(); ++i)
  {
    place[static_cast<std::size_t>(this->Mesh.Cells.data()[i])] = 0;
  }
  Index count = 0;
  for (std::size_t v = 0; v < place.size(); ++v)
  {
    if (place[v] < 0)
    {
      continue;
    }
    const auto from = static_cast<Index>(v);
    this->Mesh.Parameters.col(count) = this->Mesh.Parameters.col(from);
    this->Mesh.Points.col(count) = this->Mesh.Points.col(from);
    this->Mesh.Normals.col(count) = this->Mesh.Normals.col(from);
    for (Eigen::MatrixXd& values : this->Mesh.Attributes)
    {
      values.col(count) = values.col(from);
    }
    place[v] = count++;
  }
  this->Mesh.Parameters.conservativeResize(3, count);
  this->Mesh.Points.conservativeResize(3, count);
  this->Mesh.Normals.conservativeResize(3, count);
  for (Eigen::MatrixXd& values : this->Mesh.Attributes)
  {
    values.conservativeResize(values.rows(), count);
  }
  for (Index i = 0; i < this->Mesh.Cells.size(); ++i)
  {
    Index& v = this->Mesh.Cells.data()[i];
    v = place[static_cast<std::size_t>(v)];
  }
}

bool ZeroSet::Worker::MeasureErrors()
{
  if (this->Axes.size() < 2)
  {
    return true;
  }
  std::mutex mutex;
  return this->Parallel(static_cast<Index>(this->CellOfPiece.size()), Batch / 4,
    [&](Index begin, Index end)
    {
      ZeroSetCertificate certificate;
      std::array<std::vector<int>, 3> wanted = this->Grid.Counts;
      this->MeasureCells(begin, end, certificate, wanted);
      // Only maxima are merged, so the order of the chunks does not matter.
      const std::lock_guard<std::mutex> lock(mutex);
      this->Certificate.Add(certificate);
      for (std::size_t d = 0; d < 3; ++d)
      {
        for (std::size_t b = 0; b < wanted[d].size(); ++b)
        {
          this->Wanted[d][b] = std::max(this->Wanted[d][b], wanted[d][b]);
        }
      }
    });
}

bool ZeroSet::Worker::Extract()
{
  this->Certificate = ZeroSetCertificate();
  this->Wanted = this->Grid.Counts;
  this->MakeLines();
  if (!this->FindCrossings() || !this->FindVertices() || !this->EvaluateVertices())
  {
    return false;
  }
  this->MakeCells();
  this->DropUnusedPoints();
  if (!this->MeasureErrors())
  {
    return false;
  }
  // Where the surface is not smooth no refinement helps: stop before memory does.
  double growth = 1.0;
  for (int d : this->Axes)
  {
    const auto D = static_cast<std::size_t>(d);
    const auto sum = [](const std::vector<int>& counts)
    { return std::accumulate(counts.begin(), counts.end(), 0.0); };
    growth *= sum(this->Wanted[D]) / sum(this->Grid.Counts[D]);
  }
  const double surface = std::pow(growth, 1.0 - 1.0 / static_cast<double>(this->Axes.size()));
  if (static_cast<double>(this->Crossed.size()) * surface > this->Options.MaximumCells &&
    this->Wanted != this->Grid.Counts)
  {
    this->Wanted = this->Grid.Counts;
    this->Certificate.ToleranceReached = false;
  }
  return true;
}

//------------------------------------------------------------------------------------------------
ZeroSet::ZeroSet(const Aggregate& body, const ScalarField& field, ZeroSetOptions options)
  : W(std::make_unique<Worker>(body, field, std::move(options)))
{
}

ZeroSet::~ZeroSet() = default;

const CellGrid& ZeroSet::Grid() const
{
  return this->W->Grid;
}

std::array<std::vector<int>, 3>& ZeroSet::Wanted()
{
  return this->W->Wanted;
}

bool ZeroSet::Refine()
{
  const bool changed = this->W->Grid.Counts != this->W->Wanted;
  this->W->Grid.Counts = this->W->Wanted;
  return changed;
}

bool ZeroSet::Extract()
{
  return this->W->Extract();
}

const ZeroSetMesh& ZeroSet::Mesh() const
{
  return this->W->Mesh;
}

const ZeroSetCertificate& ZeroSet::Certificate() const
{
  return this->W->Certificate;
}

}
