// SPDX-License-Identifier: BSD-3-Clause
#include "ZeroSetWorker.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hyperpatch
{

namespace
{

/// Elements are searched in blocks of so many in each direction.
constexpr int BlockSize = 8;

/// What two parameters must differ by to be told apart after a sum or product.
double Resolution(double a, double b)
{
  return std::numeric_limits<double>::epsilon() * std::max(std::abs(a), std::abs(b));
}

}

ZeroSet::Worker::Cell ZeroSet::Worker::CornerOfKey(Index key) const
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

bool ZeroSet::Worker::IsDrawn(const CrossedCell& touched) const
{
  for (int c = 0; c < 1 << this->Axes.size(); ++c)
  {
    if ((touched.Zero >> c & 1u) == 0)
    {
      continue;
    }
    Cell corner = touched.At;
    for (std::size_t a = 0; a < this->Axes.size(); ++a)
    {
      corner[static_cast<std::size_t>(this->Axes[a])] += c >> a & 1;
    }
    const Index key = 4 * this->Corner(corner) + 3;
    const auto at = std::lower_bound(this->Vertices.begin(), this->Vertices.end(), key,
      [](const Crossing& crossing, Index k) { return crossing.Key < k; });
    if (at != this->Vertices.end() && at->Key == key)
    {
      return true;
    }
  }
  return false;
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
  // A surface through a corner, up to round-off, is drawn by the cells on its other side; but where
  // f is zero all over the cell nothing is.
  const bool everywhere = f.Min() >= -noise && f.Max() <= noise;
  const bool throughCorner =
    !everywhere && ((f.Min() >= -noise && low <= noise) || (f.Max() <= noise && high >= -noise));
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
      const bool plateau = f.Min() >= -f.RoundingBound() && f.Max() <= f.RoundingBound();
      if (!plateau && this->Width(low) > this->Options.FeatureSize)
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
        ++found.Sampled;
      }
      if (cell.Positive == 0 || cell.Positive == (1u << corners) - 1)
      {
        if (cell.Zero != 0 && certified)
        {
          found.Touched.push_back(cell);
        }
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

void ZeroSet::Worker::SearchElements(const Cell& low, const Cell& high, Found& found) const
{
  ParameterBox box{};
  std::size_t widest = 0;
  for (std::size_t d = 0; d < 3; ++d)
  {
    box.Low[d] = this->Grid.Breaks[d][static_cast<std::size_t>(low[d])];
    box.High[d] = this->Grid.Breaks[d][static_cast<std::size_t>(high[d])];
    widest = high[d] - low[d] > high[widest] - low[widest] ? d : widest;
  }
  if (this->Field.Excludes(box))
  {
    return;
  }
  if (high[widest] - low[widest] == 1)
  {
    this->SearchElement(low, box, found);
    return;
  }
  Cell middle = high;
  middle[widest] = (low[widest] + high[widest]) / 2;
  this->SearchElements(low, middle, found);
  Cell begin = low;
  begin[widest] = middle[widest];
  this->SearchElements(begin, high, found);
}

void ZeroSet::Worker::SearchElement(
  const Cell& element, const ParameterBox& box, Found& found) const
{
  Cell low{};
  Cell high{ 1, 1, 1 };
  for (int d : this->Axes)
  {
    const auto D = static_cast<std::size_t>(d);
    const auto& lines = this->IntervalOfLine[D];
    low[D] = static_cast<int>(
      std::lower_bound(lines.begin(), lines.end() - 1, element[D]) - lines.begin());
    high[D] = low[D] + this->Grid.Counts[D][static_cast<std::size_t>(element[D])];
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
    // Nothing is known between the corners: look as closely as features are to be seen.
    if (this->Width(low) > this->Options.FeatureSize)
    {
      found.Wide.push_back(low);
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
  // Blocks are many enough for any number of threads; their order makes the result one and the
  // same.
  Cell blocks{};
  for (std::size_t d = 0; d < 3; ++d)
  {
    blocks[d] = static_cast<int>((elements[d] + BlockSize - 1) / BlockSize);
  }
  std::vector<Found> found(static_cast<std::size_t>(blocks[0]) *
    static_cast<std::size_t>(blocks[1]) * static_cast<std::size_t>(blocks[2]));
  if (!this->Parallel(static_cast<Index>(found.size()), 1,
        [&](Index begin, Index end)
        {
          for (Index b = begin; b < end; ++b)
          {
            Cell low{ static_cast<int>(b % blocks[0]), static_cast<int>(b / blocks[0] % blocks[1]),
              static_cast<int>(b / blocks[0] / blocks[1]) };
            Cell high{};
            for (std::size_t d = 0; d < 3; ++d)
            {
              low[d] *= BlockSize;
              high[d] = std::min(low[d] + BlockSize, static_cast<int>(elements[d]));
            }
            this->SearchElements(low, high, found[static_cast<std::size_t>(b)]);
          }
        }))
  {
    return false;
  }
  this->Crossed.clear();
  this->Vertices.clear();
  this->LargestValue = 0.0;
  this->Sampled = 0;
  for (const Found& f : found)
  {
    this->Crossed.insert(this->Crossed.end(), f.Crossed.begin(), f.Crossed.end());
    this->Vertices.insert(this->Vertices.end(), f.Crossings.begin(), f.Crossings.end());
    this->Certificate.UndecidedCells += f.Undecided;
    this->Sampled += f.Sampled;
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
  // f is zero there and drawn by nobody: it touches zero, or a face lies in the zero set.
  for (const Found& f : found)
  {
    for (const CrossedCell& touched : f.Touched)
    {
      this->Certificate.UndecidedCells += this->IsDrawn(touched) ? 0 : 1;
    }
  }
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

}
