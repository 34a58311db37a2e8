// SPDX-License-Identifier: BSD-3-Clause
#include "GridFit.h"

#include "Error.h"
#include "Evaluator.h"
#include "LineBlocksWorker.h"
#include "SparseRows.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

namespace hyperpatch
{

namespace
{

using Eigen::Index;

std::size_t Unsigned(Index i)
{
  return static_cast<std::size_t>(i);
}

/// The samples, seen as inner x size x outer along one direction.
struct Along
{
  Along(const std::array<std::vector<double>, 3>& sites, int direction, Index components)
    : Components(components)
    , Inner(components)
  {
    for (int d = 0; d < 3; ++d)
    {
      const auto size = static_cast<Index>(sites[Unsigned(d)].size());
      (d < direction ? this->Inner : this->Outer) *= d == direction ? 1 : size;
    }
  }
  Index Components;
  Index Inner;
  Index Outer = 1;
};

/// Places among the sites of one direction, for the error that fitting lines there leaves.
class PlaceSearch
{
public:
  PlaceSearch(int degree, const std::vector<double>& sites, ErrorMeasure measure)
    : Degree(degree)
    , Sites(&sites)
    , Measure(measure)
  {
    const auto last = static_cast<int>(sites.size()) - 1;
    if (last < degree)
    {
      // Says that the samples are too few.
      static_cast<void>(InterpolationKnots(degree, sites));
    }
    for (int i = 0; i <= degree; ++i)
    {
      this->Places.push_back(static_cast<int>(static_cast<long long>(i) * last / degree));
    }
  }

  [[nodiscard]] bool IsFull() const { return this->Places.size() == this->Sites->size(); }

  [[nodiscard]] DirectionFit Fit() const
  {
    std::vector<double> places;
    for (const int i : this->Places)
    {
      places.push_back((*this->Sites)[Unsigned(i)]);
    }
    const KnotVector knots = InterpolationKnots(this->Degree, places);
    return this->IsFull() ? DirectionFit::Interpolation(knots, *this->Sites)
                          : DirectionFit::LeastSquares(knots, *this->Sites);
  }

  /// Halves intervals until the error along this direction is within the tolerance.
  void Refine(const Along& along, const Eigen::MatrixXd& samples, double tolerance,
    const ParallelFor& parallelFor)
  {
    while (!this->IsFull())
    {
      const std::vector<double> errors = this->Errors(along, samples, tolerance, parallelFor);
      const double worst = *std::max_element(errors.begin(), errors.end());
      if (this->Total(errors) <= tolerance)
      {
        return;
      }
      // Not all at once: what is left beside the largest errors often goes with them.
      this->Halve(errors, std::max(tolerance, 0.25 * worst));
    }
  }

private:
  /// Of all lines, from that at each site.
  [[nodiscard]] double Total(const std::vector<double>& errors) const
  {
    if (this->Measure == ErrorMeasure::Maximum)
    {
      return *std::max_element(errors.begin(), errors.end());
    }
    const Eigen::Map<const Eigen::VectorXd> all(errors.data(), static_cast<Index>(errors.size()));
    return all.stableNorm() / std::sqrt(static_cast<double>(errors.size()));
  }

  /// The error of all lines at each site.
  /// \param unit for squares, which might overflow or vanish
  [[nodiscard]] std::vector<double> Errors(const Along& along, const Eigen::MatrixXd& samples,
    double unit, const ParallelFor& parallelFor) const
  {
    const DirectionFit fit = this->Fit();
    const auto count = static_cast<Index>(this->Sites->size());
    const bool isMaximum = this->Measure == ErrorMeasure::Maximum;
    const LineBlocks blocks(along.Inner, count, along.Outer);
    // Of every block by itself: sums must not depend on the order in which threads come.
    Eigen::ArrayXXd parts(count, blocks.Count());
    blocks.ForEach(parallelFor,
      [&]
      {
        const Index lines = blocks.MaximalLines();
        std::vector<double> rows(Unsigned(count * lines));
        std::vector<double> points(Unsigned(fit.NumberOfControlPoints() * lines));
        std::vector<double> values(rows.size());
        return [&, rows = std::move(rows), points = std::move(points), values = std::move(values)](
                 const LineBlocks::Block& block) mutable
        {
          const Index width = block.Lines();
          blocks.Read(block, samples.data(), rows.data());
          fit(width, rows.data(), points.data());
          fit.Evaluate(width, points.data(), values.data());
          for (Index i = 0; i < count; ++i)
          {
            const Eigen::Map<const Eigen::ArrayXd> row(rows.data() + i * width, width);
            const Eigen::Map<const Eigen::ArrayXd> value(values.data() + i * width, width);
            parts(i, block.Number) =
              isMaximum ? (value - row).abs().maxCoeff() : ((value - row) / unit).square().sum();
          }
        };
      });
    const double lines = static_cast<double>(along.Inner / along.Components * along.Outer);
    std::vector<double> errors(Unsigned(count));
    for (Index i = 0; i < count; ++i)
    {
      errors[Unsigned(i)] =
        isMaximum ? parts.row(i).maxCoeff() : unit * std::sqrt(parts.row(i).sum() / lines);
    }
    return errors;
  }

  /// Halves the intervals that hold an error beyond the threshold; one at least.
  void Halve(const std::vector<double>& errors, double threshold)
  {
    std::vector<int> added;
    int nearest = -1;
    double least = std::numeric_limits<double>::infinity();
    const auto worst = std::max_element(errors.begin(), errors.end()) - errors.begin();
    for (std::size_t k = 1; k < this->Places.size(); ++k)
    {
      const int begin = this->Places[k - 1];
      const int end = this->Places[k];
      if (end - begin < 2)
      {
        continue;
      }
      const int middle = begin + (end - begin) / 2;
      if (*std::max_element(errors.begin() + begin, errors.begin() + end + 1) > threshold)
      {
        added.push_back(middle);
      }
      const double distance = std::abs(static_cast<double>(middle - worst));
      if (distance < least)
      {
        least = distance;
        nearest = middle;
      }
    }
    if (added.empty())
    {
      added.push_back(nearest);
    }
    this->Places.insert(this->Places.end(), added.begin(), added.end());
    std::sort(this->Places.begin(), this->Places.end());
  }

  int Degree;
  const std::vector<double>* Sites;
  ErrorMeasure Measure;
  std::vector<int> Places; ///< ascending indices of sites, both ends among them
};

/// The Euclidean norm, also where squares overflow or vanish.
double Length(const Eigen::VectorXd& vector)
{
  const double squares = vector.squaredNorm();
  return squares > 1e-280 && squares < 1e280 ? std::sqrt(squares) : vector.stableNorm();
}

/// Calls function(neighbour) for the neighbours of a sample in the grid.
template <typename Function>
void ForNeighbours(const std::array<int, 3>& sizes, Index sample, Function&& function)
{
  Index stride = 1;
  Index rest = sample;
  for (const int size : sizes)
  {
    const Index i = rest % size;
    rest /= size;
    if (i > 0)
    {
      function(sample - stride);
    }
    if (i + 1 < size)
    {
      function(sample + stride);
    }
    stride *= size;
  }
}

}

FitError FitError::Of(const Eigen::VectorXd& distances, Index first)
{
  FitError error;
  error.Where = first;
  double squares = 0.0;
  for (Index i = 0; i < distances.size(); ++i)
  {
    const double distance = distances[i];
    if (std::isfinite(distance))
    {
      squares += distance * distance;
      ++error.Count;
      if (distance > error.Maximum)
      {
        error.Maximum = distance;
        error.Where = first + i;
      }
    }
  }
  if (error.Maximum == 0.0)
  {
    return error;
  }
  double unit = 1.0;
  if (!(squares > 1e-280 && squares < 1e280))
  {
    // Some have overflowed, or vanished.
    unit = error.Maximum;
    squares = 0.0;
    for (const double distance : distances)
    {
      const double part = distance / unit;
      squares += std::isfinite(part) ? part * part : 0.0;
    }
  }
  error.RootMeanSquare = unit * std::sqrt(squares / static_cast<double>(error.Count));
  return error;
}

FitError MeasureError(const Spline& spline, const std::array<std::vector<double>, 3>& sites,
  const SampleReader& read, const ParallelFor& parallelFor)
{
  const Eigen::MatrixXd homogeneous =
    spline.IsRational() ? spline.Homogeneous() : Eigen::MatrixXd();
  const Eigen::Map<const Eigen::MatrixXd> points(
    spline.IsRational() ? homogeneous.data() : spline.Coefficients().data(),
    spline.Components() + (spline.IsRational() ? 1 : 0), spline.NumberOfControlPoints());
  const Index m = points.rows();
  const Index components = spline.Components();
  std::array<SparseRows, 3> bases;
  for (std::size_t d = 0; d < 3; ++d)
  {
    bases[d] = SparseRows::Collocation(spline.Knots()[d], sites[d]);
  }
  const Index row = m * spline.Sizes()[0];
  const Index plane = row * spline.Sizes()[1];
  const auto layer = static_cast<Index>(sites[0].size() * sites[1].size());
  std::vector<FitError> layers(sites[2].size());
  parallelFor(static_cast<std::ptrdiff_t>(layers.size()), 1 + bases[2].Size() / 64,
    [&](std::ptrdiff_t begin, std::ptrdiff_t end)
    {
      Eigen::VectorXd inPlane(plane);
      Eigen::VectorXd inRow(row);
      Eigen::VectorXd difference(components);
      Eigen::MatrixXd samples(components, layer);
      Eigen::VectorXd distances(layer);
      for (auto k = static_cast<int>(begin); k < end; ++k)
      {
        read(k * layer, layer, samples.data());
        bases[2].Multiply(k, plane, points.data(), inPlane.data());
        Index at = 0;
        for (int j = 0; j < bases[1].Size(); ++j)
        {
          bases[1].Multiply(j, row, inPlane.data(), inRow.data());
          for (int i = 0; i < bases[0].Size(); ++i, ++at)
          {
            const SparseRows::Row basis = bases[0][i];
            const auto value = [&basis, &inRow, m](Index component)
            {
              double sum = 0.0;
              for (int a = 0; a < basis.Count; ++a)
              {
                sum += basis.Values[a] * inRow[(basis.First + a) * m + component];
              }
              return sum;
            };
            if (m == 1)
            {
              distances[at] = std::abs(value(0) - samples(0, at));
              continue;
            }
            const double weight = spline.IsRational() ? value(components) : 1.0;
            for (Index c = 0; c < components; ++c)
            {
              difference[c] = value(c) / weight - samples(c, at);
            }
            distances[at] = Length(difference);
          }
        }
        layers[Unsigned(k)] = FitError::Of(distances, k * layer);
      }
    });
  FitError total;
  for (const FitError& error : layers)
  {
    if (error.Maximum > total.Maximum)
    {
      total.Maximum = error.Maximum;
      total.Where = error.Where;
    }
    total.Count += error.Count;
  }
  double squares = 0.0;
  for (const FitError& error : layers)
  {
    const double part = total.Maximum > 0.0 ? error.RootMeanSquare / total.Maximum : 0.0;
    squares += static_cast<double>(error.Count) * part * part;
  }
  total.RootMeanSquare =
    total.Maximum * std::sqrt(squares / static_cast<double>(std::max<Index>(total.Count, 1)));
  return total;
}

Spline FitToTolerance(std::array<int, 3> degrees, const std::array<std::vector<double>, 3>& sites,
  const Eigen::MatrixXd& samples, double tolerance, ErrorMeasure measure,
  const ParallelFor& parallelFor)
{
  if (!(tolerance > 0.0) || !std::isfinite(tolerance))
  {
    throw Error("the target error must be a finite number greater than 0");
  }
  std::vector<std::pair<std::size_t, PlaceSearch>> searches;
  for (std::size_t d = 0; d < 3; ++d)
  {
    if (sites[d].size() > 1)
    {
      searches.emplace_back(d, PlaceSearch(degrees[d], sites[d], measure));
    }
  }
  const SampleReader read = [&samples](Index first, Index count, double* block)
  { std::copy_n(samples.data() + first * samples.rows(), count * samples.rows(), block); };
  for (double share = tolerance;; share *= 0.7)
  {
    std::array<DirectionFit, 3> fits;
    bool full = true;
    for (auto& [d, search] : searches)
    {
      search.Refine(Along(sites, static_cast<int>(d), samples.rows()), samples, share, parallelFor);
      fits[d] = search.Fit();
      full = full && search.IsFull();
    }
    Spline spline = FitGrid(fits, samples, parallelFor);
    std::array<std::vector<double>, 3> used;
    for (std::size_t d = 0; d < 3; ++d)
    {
      used[d] = fits[d].Sites();
    }
    if (full || MeasureError(spline, used, read, parallelFor).Of(measure) <= tolerance)
    {
      return spline;
    }
  }
}

std::vector<Index> FillMissing(std::array<int, 3> sizes, Eigen::MatrixXd& samples)
{
  const Index count = samples.cols();
  std::vector<Index> missing;
  for (Index i = 0; i < count; ++i)
  {
    if (!samples.col(i).allFinite())
    {
      missing.push_back(i);
    }
  }
  if (static_cast<Index>(missing.size()) == count)
  {
    throw Error("no sample is a finite number");
  }
  // From the rim of the gaps inwards, then relaxation from that start.
  std::vector<bool> known(Unsigned(count), true);
  for (const Index i : missing)
  {
    known[Unsigned(i)] = false;
  }
  std::vector<Index> rest = missing;
  int rounds = 0;
  while (!rest.empty())
  {
    std::vector<Index> reached;
    std::vector<Index> later;
    for (const Index i : rest)
    {
      Eigen::VectorXd sum = Eigen::VectorXd::Zero(samples.rows());
      int neighbours = 0;
      ForNeighbours(sizes, i,
        [&](Index neighbour)
        {
          if (known[Unsigned(neighbour)])
          {
            sum += samples.col(neighbour);
            ++neighbours;
          }
        });
      if (neighbours > 0)
      {
        samples.col(i) = sum / neighbours;
        reached.push_back(i);
      }
      else
      {
        later.push_back(i);
      }
    }
    for (const Index i : reached)
    {
      known[Unsigned(i)] = true;
    }
    rest.swap(later);
    ++rounds;
  }
  // The slowest mode of a gap of that depth decays by exp(-(pi / (2 rounds))^2 / 2) per sweep.
  const int sweeps = std::min(4 * rounds * rounds + 4, 200);
  for (int sweep = 0; sweep < sweeps; ++sweep)
  {
    for (const Index i : missing)
    {
      Eigen::VectorXd sum = Eigen::VectorXd::Zero(samples.rows());
      int neighbours = 0;
      ForNeighbours(sizes, i,
        [&](Index neighbour)
        {
          sum += samples.col(neighbour);
          ++neighbours;
        });
      samples.col(i) = sum / neighbours;
    }
  }
  return missing;
}

Spline FitAroundMissing(const std::array<DirectionFit, 3>& fits, const std::vector<Index>& missing,
  Eigen::MatrixXd samples, const ParallelFor& parallelFor)
{
  const bool keeps = std::all_of(
    fits.begin(), fits.end(), [](const DirectionFit& fit) { return fit.IsInterpolation(); });
  if (missing.empty() || keeps)
  {
    return FitGrid(fits, std::move(samples), parallelFor);
  }
  const Index nu = fits[0].NumberOfSamples();
  const Index nv = fits[1].NumberOfSamples();
  std::vector<double> parameters;
  for (const Index i : missing)
  {
    parameters.push_back(fits[0].Sites()[Unsigned(i % nu)]);
    parameters.push_back(fits[1].Sites()[Unsigned(i / nu % nv)]);
    parameters.push_back(fits[2].Sites()[Unsigned(i / nu / nv)]);
  }
  const double range = (samples.rowwise().maxCoeff() - samples.rowwise().minCoeff()).maxCoeff();
  Eigen::MatrixXd values(samples.rows(), static_cast<Index>(missing.size()));
  for (int round = 0;; ++round)
  {
    Spline spline = FitGrid(fits, samples, parallelFor);
    Evaluator(spline).Evaluate(missing.size(), parameters.data(), values.data());
    double change = 0.0;
    for (std::size_t i = 0; i < missing.size(); ++i)
    {
      auto sample = samples.col(missing[i]);
      change =
        std::max(change, (sample - values.col(static_cast<Index>(i))).lpNorm<Eigen::Infinity>());
      sample = values.col(static_cast<Index>(i));
    }
    if (change <= 1e-6 * range || round == 100)
    {
      return spline;
    }
  }
}

}
