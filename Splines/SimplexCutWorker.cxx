// SPDX-License-Identifier: BSD-3-Clause
#include "SimplexCutWorker.h"

#include "Error.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

namespace hyperpatch
{

namespace
{

constexpr std::ptrdiff_t Grain = 256;
/// Cells between two questions whether to abort.
constexpr std::size_t Step = 1 << 14;

bool IsBefore(const Eigen::Vector3d& a, const Eigen::Vector3d& b)
{
  return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

}

SimplexCut::SimplexCut(std::shared_ptr<const PreparedAggregate> body,
  std::vector<std::shared_ptr<const ScalarField>> fields, int dimension)
  : Body(std::move(body))
  , Fields(std::move(fields))
  , Dimension(dimension)
{
  if (this->Fields.size() > MaximumFields)
  {
    throw Error("simplices are cut by " + std::to_string(MaximumFields) + " fields at most");
  }
  const auto& knots = this->Body->Body().Geometry().Knots();
  for (std::size_t d = 0; d < 3; ++d)
  {
    this->Low[static_cast<Eigen::Index>(d)] = knots[d].First();
    this->High[static_cast<Eigen::Index>(d)] = knots[d].Last();
  }
}

SimplexCut::Index SimplexCut::AddPoint(
  const FreeParameters& parameter, const Eigen::Vector3d& point, unsigned on, unsigned fixed)
{
  const auto index = static_cast<Index>(this->U.size());
  this->U.push_back(parameter.Values);
  this->Weights.push_back(parameter.Weights);
  this->HasPoles = this->HasPoles || parameter.Weights.minCoeff() < 1.0;
  this->X.push_back(point);
  this->OnField.push_back(on);
  this->Fixed.push_back(fixed);
  this->Ends.push_back({ index, index });
  return index;
}

bool SimplexCut::Cut(
  int field, bool keepOutside, const ParallelFor& parallel, const std::function<bool()>& abort)
{
  return this->FindValues(field, parallel, abort) && this->FindPoints(parallel, abort) &&
    this->Split(keepOutside, abort);
}

bool SimplexCut::FindValues(
  int field, const ParallelFor& parallel, const std::function<bool()>& abort)
{
  this->Field = field;
  const unsigned bit = 1u << field;
  this->Values.resize(this->U.size());
  parallel(static_cast<std::ptrdiff_t>(this->U.size()), Grain,
    [&](std::ptrdiff_t begin, std::ptrdiff_t end)
    {
      const auto b = static_cast<std::size_t>(begin);
      const auto count = static_cast<std::size_t>(end - begin);
      this->Fields[static_cast<std::size_t>(field)]->Evaluate(
        count, this->U[b].data(), &this->Values[b]);
      for (std::size_t i = b; i < b + count; ++i)
      {
        this->Values[i] = this->OnField[i] & bit ? 0.0 : this->Values[i];
      }
    });
  return !abort();
}

bool SimplexCut::FindPoints(const ParallelFor& parallel, const std::function<bool()>& abort)
{
  const unsigned bit = 1u << this->Field;
  for (std::size_t i = 0; i < this->Values.size(); ++i)
  {
    this->OnField[i] |= this->Values[i] == 0.0 ? bit : 0;
  }
  this->FirstNew = static_cast<Index>(this->U.size());
  this->CutEdges.Clear();
  std::vector<std::array<Index, 2>> edges;
  for (std::size_t c = 0; c < this->C.size(); ++c)
  {
    if (c % Step == 0 && abort())
    {
      return false;
    }
    this->ForCutEdges(this->C[c],
      [&](Index a, Index b)
      {
        if (this->CutEdges.Number(KeyOf(a, b)).second)
        {
          // Both ends in an order of their own: neighbors find the same root.
          edges.push_back({ a, b });
          if (IsBefore(this->U[static_cast<std::size_t>(b)], this->U[static_cast<std::size_t>(a)]))
          {
            edges.back() = { b, a };
          }
        }
      });
  }
  this->FindRoots(edges, parallel);
  this->Values.resize(this->U.size(), 0.0);
  return !abort();
}

bool SimplexCut::Split(bool keepOutside, const std::function<bool()>& abort)
{
  const unsigned bit = 1u << this->Field;
  this->MovePoints();
  const auto n = static_cast<std::size_t>(this->Dimension) + 1;
  std::vector<Cell> kept;
  kept.reserve(this->C.size());
  std::vector<Index> order;
  std::vector<Cell> parts;
  for (std::size_t c = 0; c < this->C.size(); ++c)
  {
    if (c % Step == 0 && abort())
    {
      return false;
    }
    const Cell& cell = this->C[c];
    order.clear();
    this->ForCutEdges(cell, [&](Index a, Index b) { order.push_back(this->PointBetween(a, b)); });
    std::sort(order.begin(), order.end(),
      [this](Index a, Index b)
      {
        const Eigen::Vector3d& x = this->X[static_cast<std::size_t>(a)];
        const Eigen::Vector3d& y = this->X[static_cast<std::size_t>(b)];
        return IsBefore(x, y) || (!IsBefore(y, x) && a < b);
      });
    parts.clear();
    this->Bisect(cell, order, parts);
    for (Cell& part : parts)
    {
      const auto last = part.Corners.begin() + static_cast<std::ptrdiff_t>(n);
      const bool isOutside =
        std::any_of(part.Corners.begin(), last, [this](Index i) { return this->Sign(i) > 0; });
      const bool isFlat =
        std::all_of(part.Corners.begin(), last, [this](Index i) { return this->Sign(i) == 0; }) &&
        std::any_of(part.Corners.begin(), last,
          [this](Index i) { return this->WasMoved[static_cast<std::size_t>(i)] != 0; });
      if (!isFlat && (!isOutside || keepOutside))
      {
        part.Outside |= isOutside ? bit : 0;
        kept.push_back(part);
      }
    }
  }
  this->C.swap(kept);
  return true;
}

void SimplexCut::MovePoints()
{
  constexpr double Nearest = 0.25;
  this->WasMoved.resize(this->U.size(), 0);
  this->Fixed.resize(this->U.size(), Immovable);
  if (std::all_of(
        this->Fixed.begin(), this->Fixed.end(), [](unsigned fixed) { return fixed == Immovable; }))
  {
    return;
  }
  std::vector<double> shortest(this->U.size(), INFINITY);
  const auto n = static_cast<std::size_t>(this->Dimension) + 1;
  for (const Cell& cell : this->C)
  {
    for (std::size_t i = 0; i < n; ++i)
    {
      for (std::size_t j = i + 1; j < n; ++j)
      {
        const auto a = static_cast<std::size_t>(cell.Corners[i]);
        const auto b = static_cast<std::size_t>(cell.Corners[j]);
        const double length = (this->X[a] - this->X[b]).norm();
        shortest[a] = std::min(shortest[a], length);
        shortest[b] = std::min(shortest[b], length);
      }
    }
  }
  // The nearest of the new points on edges along which a point may move.
  std::vector<Index> target(static_cast<std::size_t>(this->FirstNew), -1);
  const auto distance = [this](std::size_t from, Index to)
  { return (this->X[static_cast<std::size_t>(to)] - this->X[from]).norm(); };
  for (Index to = this->FirstNew; to < static_cast<Index>(this->U.size()); ++to)
  {
    const auto& ends = this->Ends[static_cast<std::size_t>(to)];
    for (std::size_t e = 0; e < 2; ++e)
    {
      const auto a = static_cast<std::size_t>(ends[e]);
      bool mayMove = this->Fixed[a] != Immovable && this->OnField[a] == 0;
      const auto isAlong = this->DirectionsOf(ends);
      for (std::size_t d = 0; d < 3; ++d)
      {
        mayMove = mayMove && !(this->Fixed[a] & 1u << d && isAlong[d]);
      }
      const double length = distance(a, to);
      if (mayMove && length < Nearest * shortest[a] &&
        (target[a] < 0 || length < distance(a, target[a])))
      {
        target[a] = to;
      }
    }
  }
  for (std::size_t a = 0; a < target.size(); ++a)
  {
    if (target[a] >= 0)
    {
      const auto to = static_cast<std::size_t>(target[a]);
      this->U[a] = this->U[to];
      this->Weights[a] = this->Weights[to];
      this->X[a] = this->X[to];
      this->OnField[a] |= 1u << this->Field;
      this->WasMoved[a] = 1;
      this->Values[a] = 0.0;
    }
  }
}

std::array<bool, 3> SimplexCut::DirectionsOf(const std::array<Index, 2>& edge) const
{
  std::array<FreeParameters, 2> ends{ this->At(edge[0]), this->At(edge[1]) };
  FillFree(ends.data(), 2);
  const auto isAlong = [&ends](int d) { return ends[0].Values[d] != ends[1].Values[d]; };
  return { isAlong(0), isAlong(1), isAlong(2) };
}

void SimplexCut::Bisect(
  const Cell& cell, const std::vector<Index>& order, std::vector<Cell>& parts) const
{
  parts.push_back(cell);
  const auto n = static_cast<std::size_t>(this->Dimension) + 1;
  for (const Index point : order)
  {
    const auto& ends = this->Ends[static_cast<std::size_t>(point)];
    for (std::size_t p = 0, count = parts.size(); p < count; ++p)
    {
      const auto begin = parts[p].Corners.begin();
      const auto a = std::find(begin, begin + n, ends[0]) - begin;
      const auto b = std::find(begin, begin + n, ends[1]) - begin;
      if (a < static_cast<std::ptrdiff_t>(n) && b < static_cast<std::ptrdiff_t>(n))
      {
        Cell other = parts[p];
        parts[p].Corners[static_cast<std::size_t>(a)] = point;
        other.Corners[static_cast<std::size_t>(b)] = point;
        parts.push_back(other);
      }
    }
  }
}

void SimplexCut::FindRoots(
  const std::vector<std::array<Index, 2>>& edges, const ParallelFor& parallel)
{
  const std::size_t first = this->U.size();
  this->U.resize(first + edges.size());
  this->Weights.resize(first + edges.size());
  this->X.resize(first + edges.size(), Eigen::Vector3d::Zero());
  this->OnField.resize(first + edges.size());
  this->Ends.insert(this->Ends.end(), edges.begin(), edges.end());
  std::vector<double> residuals(edges.size());
  const ScalarField& f = *this->Fields[static_cast<std::size_t>(this->Field)];
  const auto& geometry = *this->Body->Geometry();
  const auto m = static_cast<std::size_t>(geometry.Spline().Components());

  parallel(static_cast<std::ptrdiff_t>(edges.size()), Grain,
    [&](std::ptrdiff_t begin, std::ptrdiff_t end)
    {
      // All edges of the chunk step by step, so that they are evaluated together.
      struct Bracket
      {
        double Low = 0.0, High = 1.0; ///< places on the edge
        double AtLow, AtHigh;         ///< values there
        double Scale;
        double Try = 0.0;
        int Side = 0;
        bool IsDone = false;
      };
      std::vector<Bracket> brackets;
      for (std::ptrdiff_t e = begin; e < end; ++e)
      {
        const auto& edge = edges[static_cast<std::size_t>(e)];
        const double a = this->Value(edge[0]);
        const double b = this->Value(edge[1]);
        brackets.push_back({ 0.0, 1.0, a, b, std::max(std::abs(a), std::abs(b)) });
      }
      const auto at = [&](std::size_t k, double t)
      {
        const auto& edge = edges[static_cast<std::size_t>(begin) + k];
        const std::array<FreeParameters, 2> ends{ this->At(edge[0]), this->At(edge[1]) };
        if (this->HasPoles)
        {
          const std::array<double, 2> shares{ 1.0 - t, t };
          return hyperpatch::Between(ends.data(), shares.data(), 2);
        }
        // Equal coordinates stay what they are: faces of the domain, knot planes.
        const Eigen::Vector3d& a = ends[0].Values;
        const Eigen::Vector3d& b = ends[1].Values;
        return FreeParameters{ (a.array() == b.array()).select(a, a + t * (b - a)) };
      };
      std::vector<std::size_t> open(brackets.size());
      std::iota(open.begin(), open.end(), 0);
      std::vector<Eigen::Vector3d> tried;
      std::vector<double> found;
      for (int step = 0; step < 100 && !open.empty(); ++step)
      {
        tried.clear();
        for (const std::size_t k : open)
        {
          Bracket& b = brackets[k];
          // False position with halved weights (the Illinois method); now and then the middle.
          b.Try = step % 4 == 3 ? 0.5 * (b.Low + b.High)
                                : b.Low + (b.High - b.Low) * (b.AtLow / (b.AtLow - b.AtHigh));
          b.Try = std::min(std::max(b.Try, b.Low), b.High);
          tried.push_back(at(k, b.Try).Values);
        }
        found.resize(tried.size());
        f.Evaluate(tried.size(), tried.front().data(), found.data());
        std::vector<std::size_t> next;
        for (std::size_t i = 0; i < open.size(); ++i)
        {
          Bracket& b = brackets[open[i]];
          const double value = found[i];
          residuals[static_cast<std::size_t>(begin) + open[i]] = std::abs(value) / b.Scale;
          const bool toLow = (value < 0.0) ==
            (this->Value(edges[static_cast<std::size_t>(begin) + open[i]][0]) < 0.0);
          if (value == 0.0 || b.High - b.Low <= 4.0 * std::numeric_limits<double>::epsilon())
          {
            continue;
          }
          if (toLow)
          {
            b.Low = b.Try;
            b.AtLow = value;
            b.AtHigh *= b.Side < 0 ? 0.5 : 1.0;
            b.Side = -1;
          }
          else
          {
            b.High = b.Try;
            b.AtHigh = value;
            b.AtLow *= b.Side > 0 ? 0.5 : 1.0;
            b.Side = 1;
          }
          next.push_back(open[i]);
        }
        open.swap(next);
      }
      std::vector<double> points(m * brackets.size());
      for (std::size_t k = 0; k < brackets.size(); ++k)
      {
        const std::size_t to = first + static_cast<std::size_t>(begin) + k;
        const auto& edge = edges[static_cast<std::size_t>(begin) + k];
        const FreeParameters u = at(k, brackets[k].Try);
        this->U[to] = u.Values;
        this->Weights[to] = u.Weights;
        const unsigned shared = this->OnField[static_cast<std::size_t>(edge[0])] &
          this->OnField[static_cast<std::size_t>(edge[1])];
        this->OnField[to] = shared | 1u << this->Field;
        if (shared != 0)
        {
          this->Correct(this->OnField[to], this->DirectionsOf(edge), this->U[to]);
        }
      }
      const std::size_t from = first + static_cast<std::size_t>(begin);
      geometry.Evaluator().Evaluate(brackets.size(), this->U[from].data(), points.data());
      for (std::size_t k = 0; k < brackets.size(); ++k)
      {
        std::copy_n(&points[m * k], m, this->X[from + k].data());
      }
      for (std::size_t k = 0; k < this->Fields.size() && m == 3; ++k)
      {
        for (std::size_t i = 0; i < brackets.size(); ++i)
        {
          if (this->OnField[from + i] & 1u << k)
          {
            this->Fields[k]->Snap(1, this->X[from + i].data());
          }
        }
      }
    });
  for (const double residual : residuals)
  {
    this->Residual = std::max(this->Residual, residual);
  }
}

void SimplexCut::Correct(unsigned on, const std::array<bool, 3>& isFree, Eigen::Vector3d& u) const
{
  // Newton's method for all fields at once, by steps as short as can be.
  std::vector<std::size_t> fields;
  for (std::size_t k = 0; k < this->Fields.size(); ++k)
  {
    if (on & 1u << k)
    {
      fields.push_back(k);
    }
  }
  const auto rows = static_cast<Eigen::Index>(fields.size());
  Eigen::VectorXd f(rows);
  Eigen::MatrixXd J(rows, 3);
  const Eigen::Vector3d width = this->High - this->Low;
  double last = INFINITY;
  Eigen::Vector3d at = u;
  for (int step = 0; step < 20; ++step)
  {
    for (Eigen::Index k = 0; k < rows; ++k)
    {
      Eigen::Vector3d gradient;
      this->Fields[fields[static_cast<std::size_t>(k)]]->EvaluateWithGradient(
        1, at.data(), &f[k], gradient.data());
      for (int d = 0; d < 3; ++d)
      {
        J(k, d) = isFree[static_cast<std::size_t>(d)] ? gradient[d] * width[d] : 0.0;
      }
      // Rows of length 1, so that no field counts more than another.
      const double length = J.row(k).norm();
      if (length > 0.0)
      {
        J.row(k) /= length;
        f[k] /= length;
      }
    }
    const double residual = f.norm();
    if (!(residual < last))
    {
      return;
    }
    u = at;
    last = residual;
    if (residual == 0.0)
    {
      return;
    }
    at -= width.cwiseProduct(J.completeOrthogonalDecomposition().solve(f));
    at = at.cwiseMax(this->Low).cwiseMin(this->High);
  }
}

}
