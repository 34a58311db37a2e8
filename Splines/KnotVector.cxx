// SPDX-License-Identifier: BSD-3-Clause
#include "KnotVector.h"

#include "Error.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace hyperpatch
{

KnotVector::KnotVector()
  : K{ 0.0, 1.0 }
  , S{ 0 }
{
}

KnotVector::KnotVector(int degree, std::vector<double> knots, Smoothness smoothness)
  : P(degree)
  , K(std::move(knots))
{
  if (degree < 0 || degree > MaxDegree)
  {
    throw Error("degree " + std::to_string(degree) + " is not in 0.." + std::to_string(MaxDegree));
  }
  const auto count = static_cast<long long>(this->K.size());
  if (count < 2 * (degree + 1))
  {
    throw Error(std::to_string(count) + " knots are too few for degree " + std::to_string(degree) +
      ": at least " + std::to_string(2 * (degree + 1)) + " are needed");
  }
  for (std::size_t i = 0; i < this->K.size(); ++i)
  {
    if (!std::isfinite(this->K[i]))
    {
      throw Error("knot " + std::to_string(i) + " is not a finite number");
    }
    if (i > 0 && this->K[i] < this->K[i - 1])
    {
      throw Error("knots decrease at index " + std::to_string(i) + " (" +
        std::to_string(this->K[i - 1]) + " to " + std::to_string(this->K[i]) + ")");
    }
  }
  const double first = this->First();
  const double last = this->Last();
  if (!(first < last))
  {
    throw Error("the knot vector has an empty domain: knots " + std::to_string(degree) + " and " +
      std::to_string(this->Size()) + " are both " + std::to_string(first));
  }
  const int allowed = degree + (smoothness == Smoothness::Discontinuous || degree == 0 ? 1 : 0);
  for (std::size_t i = 0; i < this->K.size();)
  {
    const auto next = std::upper_bound(this->K.begin() + i, this->K.end(), this->K[i]);
    const auto multiplicity = static_cast<int>(next - this->K.begin() - i);
    const bool interior = first < this->K[i] && this->K[i] < last;
    if (multiplicity > (interior ? allowed : degree + 1))
    {
      throw Error("knot " + std::to_string(this->K[i]) + " has multiplicity " +
        std::to_string(multiplicity) + " at degree " + std::to_string(degree) +
        (interior ? "; an interior knot may repeat at most degree times: split the patch there"
                  : "; an end knot may repeat at most degree + 1 times: remove the rest"));
    }
    i += static_cast<std::size_t>(multiplicity);
  }
  for (int s = degree; s < this->Size(); ++s)
  {
    if ((*this)[s] < (*this)[s + 1])
    {
      this->S.push_back(s);
    }
  }
}

KnotVector KnotVector::Uniform(int degree, int size, double first, double last)
{
  std::vector<double> knots(static_cast<std::size_t>(std::max(0, size + degree + 1)));
  const int spans = size - degree;
  for (int i = 0; i < static_cast<int>(knots.size()); ++i)
  {
    const int s = std::clamp(i - degree, 0, std::max(spans, 0));
    knots[static_cast<std::size_t>(i)] =
      s == spans ? last : first + (last - first) * s / std::max(spans, 1);
  }
  return KnotVector(degree, std::move(knots));
}

std::vector<double> KnotVector::Breaks() const
{
  std::vector<double> breaks;
  breaks.reserve(this->S.size() + 1);
  for (int s : this->S)
  {
    breaks.push_back((*this)[s]);
  }
  breaks.push_back(this->Last());
  return breaks;
}

int KnotVector::Multiplicity(double knot) const
{
  const auto [begin, end] = std::equal_range(this->K.begin(), this->K.end(), knot);
  return static_cast<int>(end - begin);
}

std::vector<double> KnotVector::Creases() const
{
  std::vector<double> creases;
  for (std::size_t i = 1; i < this->S.size(); ++i)
  {
    const double knot = (*this)[this->S[i]];
    if (this->Multiplicity(knot) >= this->P)
    {
      creases.push_back(knot);
    }
  }
  return creases;
}

double KnotVector::Greville(int i) const
{
  if (this->P == 0)
  {
    return 0.5 * ((*this)[i] + (*this)[i + 1]);
  }
  // Relative to the middle knot, so that equal knots give that knot and not its rounded mean.
  const double centre = (*this)[i + (this->P + 1) / 2];
  double sum = 0.0;
  for (int j = 1; j <= this->P; ++j)
  {
    sum += (*this)[i + j] - centre;
  }
  return std::clamp(centre + sum / this->P, this->First(), this->Last());
}

int KnotVector::FindSpan(double u) const
{
  if (!(u > this->First()))
  {
    return this->S.front();
  }
  if (u >= this->Last())
  {
    return this->S.back();
  }
  const auto begin = this->K.begin() + this->P;
  const auto end = this->K.begin() + this->Size();
  return static_cast<int>(std::upper_bound(begin, end, u) - this->K.begin()) - 1;
}

void KnotVector::BasisFunctions(int span, double u, double* values) const
{
  double arguments[MaxDegree + 1];
  std::fill(arguments, arguments + this->P, u);
  this->BlossomWeights(span, arguments, values);
}

void KnotVector::BlossomWeights(int span, const double* arguments, double* weights) const
{
  const double* k = this->K.data() + span;
  weights[0] = 1.0;
  for (int r = 1; r <= this->P; ++r)
  {
    const double u = arguments[r - 1];
    double saved = 0.0;
    for (int j = 0; j < r; ++j)
    {
      const double left = k[j + 1 - r];
      const double right = k[j + 1];
      // Quotients first: they are exactly 0 and 1 at the knots, so that clamped ends are control
      // points and inserting a knot that is there copies, to the last bit.
      const double weight = weights[j];
      weights[j] = saved + (right - u) / (right - left) * weight;
      saved = (u - left) / (right - left) * weight;
    }
    weights[r] = saved;
  }
}

void KnotVector::BasisDerivatives(int span, double u, int order, double* values) const
{
  const int p = this->P;
  const double* k = this->K.data() + span;
  // ndu: upper triangle the basis functions of each degree, lower triangle knot differences.
  double ndu[MaxDegree + 1][MaxDegree + 1];
  ndu[0][0] = 1.0;
  for (int j = 1; j <= p; ++j)
  {
    double saved = 0.0;
    for (int r = 0; r < j; ++r)
    {
      const double right = k[r + 1] - u;
      const double left = u - k[r + 1 - j];
      ndu[j][r] = k[r + 1] - k[r + 1 - j];
      ndu[r][j] = saved + right / ndu[j][r] * ndu[r][j - 1];
      saved = left / ndu[j][r] * ndu[r][j - 1];
    }
    ndu[j][j] = saved;
  }
  for (int j = 0; j <= p; ++j)
  {
    values[j] = ndu[j][p];
  }
  double a[2][MaxDegree + 1];
  for (int r = 0; r <= p; ++r)
  {
    int current = 0;
    a[0][0] = 1.0;
    double factor = p;
    for (int d = 1; d <= order; ++d)
    {
      double* row = values + d * (p + 1);
      if (d > p)
      {
        row[r] = 0.0;
        continue;
      }
      const int next = 1 - current;
      const int low = r - d;
      const int high = p - d;
      double sum = 0.0;
      if (low >= 0)
      {
        a[next][0] = a[current][0] / ndu[high + 1][low];
        sum = a[next][0] * ndu[low][high];
      }
      const int j1 = low >= -1 ? 1 : -low;
      const int j2 = r - 1 <= high ? d - 1 : p - r;
      for (int j = j1; j <= j2; ++j)
      {
        a[next][j] = (a[current][j] - a[current][j - 1]) / ndu[high + 1][low + j];
        sum += a[next][j] * ndu[low + j][high];
      }
      if (r <= high)
      {
        a[next][d] = -a[current][d - 1] / ndu[high + 1][r];
        sum += a[next][d] * ndu[r][high];
      }
      row[r] = sum * factor;
      factor *= high;
      current = next;
    }
  }
}

}
