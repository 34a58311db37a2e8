// SPDX-License-Identifier: BSD-3-Clause
#include "DirectionFit.h"

#include "Error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace hyperpatch
{

namespace
{

std::size_t Index(std::ptrdiff_t i)
{
  return static_cast<std::size_t>(i);
}

void CheckSites(const KnotVector& knots, const std::vector<double>& sites)
{
  for (std::size_t i = 0; i < sites.size(); ++i)
  {
    const std::string name = "site " + std::to_string(i) + " (" + std::to_string(sites[i]) + ")";
    if (!std::isfinite(sites[i]))
    {
      throw Error(name + " is not a finite number");
    }
    if (sites[i] < knots.First() || sites[i] > knots.Last())
    {
      throw Error(name + " is outside the domain [" + std::to_string(knots.First()) + ", " +
        std::to_string(knots.Last()) + "] of the knots");
    }
    if (i > 0 && sites[i] == sites[i - 1])
    {
      throw Error(name + " coincides with the one before it: remove one of the two");
    }
    if (i > 0 && sites[i] < sites[i - 1])
    {
      throw Error(name + " is less than the one before it: sort the sites");
    }
  }
}

/// The basis functions that are not zero at a site.
struct BasisRow
{
  BasisRow(const KnotVector& knots, double site)
  {
    const int span = knots.FindSpan(site);
    this->First = span - knots.Degree();
    knots.BasisFunctions(span, site, this->Values);
  }
  int First;
  double Values[MaxDegree + 1];
};

/// Whether some of the sites satisfy the conditions of Schoenberg & Whitney: the k-th of them in
/// the support of basis function k. Taking the first that fits is best possible as both ascend.
/// Returns the first basis function without a site, or the number of basis functions.
int FirstWithoutSite(const KnotVector& knots, const std::vector<double>& sites)
{
  int next = 0;
  for (const double site : sites)
  {
    if (next == knots.Size())
    {
      break;
    }
    const BasisRow row(knots, site);
    const int i = next - row.First;
    if (i >= 0 && i <= knots.Degree() && row.Values[i] > 0.0)
    {
      ++next;
    }
  }
  return next;
}

}

DirectionFit::DirectionFit()
  : DirectionFit(KnotVector(), { 0.5 })
{
  std::vector<double> band{ 1.0 };
  this->Factorise(band, 0, 0);
}

DirectionFit::DirectionFit(const KnotVector& knots, const std::vector<double>& sites)
  : K(knots)
  , X(sites)
{
  CheckSites(knots, sites);
  this->Basis = SparseRows::Collocation(knots, sites);
}

DirectionFit DirectionFit::Interpolation(const KnotVector& knots, const std::vector<double>& sites)
{
  const int n = knots.Size();
  const int p = knots.Degree();
  if (sites.size() != Index(n))
  {
    throw Error(std::to_string(sites.size()) + " sites cannot be interpolated by " +
      std::to_string(n) + " control points: the numbers must be equal");
  }
  DirectionFit fit(knots, sites);
  std::vector<double> band(Index(n) * Index(2 * p + 1), 0.0);
  for (int i = 0; i < n; ++i)
  {
    const BasisRow row(knots, sites[Index(i)]);
    const int diagonal = i - row.First;
    if (diagonal < 0 || diagonal > p || !(row.Values[diagonal] > 0.0))
    {
      throw Error("site " + std::to_string(i) + " (" + std::to_string(sites[Index(i)]) +
        ") is not inside the support (" + std::to_string(knots[i]) + ", " +
        std::to_string(knots[i + p + 1]) + ") of basis function " + std::to_string(i) +
        " (Schoenberg-Whitney condition): take knots that follow the sites");
    }
    std::copy_n(row.Values, p + 1, band.begin() + i * (2 * p + 1) + p - diagonal);
  }
  fit.Factorise(band, p, p);
  return fit;
}

DirectionFit DirectionFit::LeastSquares(
  const KnotVector& knots, const std::vector<double>& sites, double smoothing)
{
  const int n = knots.Size();
  const int p = knots.Degree();
  if (!(smoothing >= 0.0) || !std::isfinite(smoothing))
  {
    throw Error("the smoothing must be a finite number, 0 or more");
  }
  DirectionFit fit(knots, sites);
  const int lonely = smoothing > 0.0 ? n : FirstWithoutSite(knots, sites);
  if (lonely < n || sites.size() < 2)
  {
    throw Error(std::to_string(sites.size()) + " sites do not determine " + std::to_string(n) +
      " control points" +
      (lonely < n ? " (none is left for basis function " + std::to_string(lonely) + ")" : "") +
      ": take fewer control points, or some smoothing");
  }

  const int width = std::max(p, smoothing > 0.0 ? 2 : 0);
  std::vector<double> band(Index(n) * Index(2 * width + 1), 0.0);
  const auto at = [&band, width](int i, int j) -> double&
  { return band[Index(i) * Index(2 * width + 1) + Index(j - i + width)]; };

  std::vector<std::vector<double>> columns(Index(n));
  std::vector<int> first(Index(n), 0);
  for (std::size_t s = 0; s < sites.size(); ++s)
  {
    const BasisRow row(knots, sites[s]);
    for (int a = 0; a <= p; ++a)
    {
      for (int b = 0; b <= p; ++b)
      {
        at(row.First + a, row.First + b) += row.Values[a] * row.Values[b];
      }
      std::vector<double>& column = columns[Index(row.First + a)];
      if (column.empty())
      {
        first[Index(row.First + a)] = static_cast<int>(s);
      }
      column.push_back(row.Values[a]);
    }
  }
  for (int j = 0; j < n; ++j)
  {
    const std::vector<double>& column = columns[Index(j)];
    fit.Sums.Append(column.data(), column.data() + column.size(), first[Index(j)]);
  }

  const double mean = (knots.Greville(n - 1) - knots.Greville(0)) / std::max(n - 1, 1);
  for (int j = 1; smoothing > 0.0 && j + 1 < n; ++j)
  {
    const double before = knots.Greville(j) - knots.Greville(j - 1);
    const double after = knots.Greville(j + 1) - knots.Greville(j);
    if (!(before > 0.0) || !(after > 0.0))
    {
      // A crease: what is on one side says nothing of the other.
      continue;
    }
    const double scale = 2.0 * mean * mean / (before + after);
    const double difference[3] = { scale / before, -scale / before - scale / after, scale / after };
    for (int a = 0; a < 3; ++a)
    {
      for (int b = 0; b < 3; ++b)
      {
        at(j - 1 + a, j - 1 + b) += smoothing * difference[a] * difference[b];
      }
    }
  }
  fit.Factorise(band, width, width);
  return fit;
}

/// LU without pivoting of a band matrix: row i has the columns i - lower .. i + upper.
void DirectionFit::Factorise(std::vector<double>& band, int lower, int upper)
{
  const int n = this->K.Size();
  const int width = lower + upper + 1;
  const auto row = [&band, width, lower](int i) { return band.data() + i * width + lower - i; };
  double largest = 0.0;
  for (int i = 0; i < n; ++i)
  {
    largest = std::max(largest, row(i)[i]);
  }
  for (int i = 0; i < n; ++i)
  {
    double* const target = row(i);
    for (int k = std::max(0, i - lower); k < i; ++k)
    {
      if (target[k] == 0.0)
      {
        continue;
      }
      const double* const source = row(k);
      target[k] *= this->InverseDiagonal[Index(k)];
      for (int j = k + 1; j <= std::min(n - 1, k + upper); ++j)
      {
        target[j] -= target[k] * source[j];
      }
    }
    // Normal equations square the condition: what is left below this are rounding errors.
    if (!(target[i] > n * std::numeric_limits<double>::epsilon() * largest) &&
      !(this->IsInterpolation() && target[i] > 0.0))
    {
      throw Error("the samples do not determine control point " + std::to_string(i) +
        " to working precision: take fewer control points, more or less smoothing, or knots that "
        "follow the sites");
    }
    this->InverseDiagonal.push_back(1.0 / target[i]);
    const int first = std::max(0, i - lower);
    this->Lower.Append(target + first, target + i, first);
    this->Upper.Append(target + i + 1, target + std::min(n, i + upper + 1), i + 1);
  }
}

void DirectionFit::operator()(
  std::ptrdiff_t lines, const double* samples, double* coefficients) const
{
  const int n = this->NumberOfControlPoints();
  const auto subtract = [lines, coefficients](
                          const SparseRows::Row& row, double* __restrict target, double factor)
  {
    const double* values = row.Values;
    const double* source = coefficients + row.First * lines;
    // The usual case, one or two terms and the diagonal, in one sweep over the lines.
    if (row.Count == 1)
    {
      const double a = values[0];
      for (std::ptrdiff_t l = 0; l < lines; ++l)
      {
        target[l] = (target[l] - a * source[l]) * factor;
      }
      return;
    }
    for (int i = 0; i < row.Count; ++i, source += lines)
    {
      const double a = values[i];
      for (std::ptrdiff_t l = 0; l < lines; ++l)
      {
        target[l] -= a * source[l];
      }
    }
    if (factor != 1.0)
    {
      for (std::ptrdiff_t l = 0; l < lines; ++l)
      {
        target[l] *= factor;
      }
    }
  };

  if (this->IsInterpolation())
  {
    if (samples != coefficients)
    {
      std::copy_n(samples, n * lines, coefficients);
    }
  }
  else
  {
    for (int j = 0; j < n; ++j)
    {
      this->Sums.Multiply(j, lines, samples, coefficients + j * lines);
    }
  }
  for (int i = 0; i < n; ++i)
  {
    subtract(this->Lower[i], coefficients + i * lines, 1.0);
  }
  for (int i = n - 1; i >= 0; --i)
  {
    subtract(this->Upper[i], coefficients + i * lines, this->InverseDiagonal[Index(i)]);
  }
}

void DirectionFit::Evaluate(std::ptrdiff_t lines, const double* coefficients, double* values) const
{
  for (int i = 0; i < this->NumberOfSamples(); ++i)
  {
    this->Basis.Multiply(i, lines, coefficients, values + i * lines);
  }
}

}
