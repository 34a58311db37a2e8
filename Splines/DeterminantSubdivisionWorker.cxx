// SPDX-License-Identifier: BSD-3-Clause
#include "DeterminantSubdivisionWorker.h"

#include "Bernstein.h"
#include "RoundingWorker.h"

#include <algorithm>
#include <cmath>

namespace hyperpatch
{

using rounding::Gamma;
using rounding::Outward;
using rounding::U;

namespace
{

/// Halves by de Casteljau; every step rounds once. `source` becomes the second half.
void Halve(const TensorGrid& grid, int direction, double* source, double* first)
{
  const std::size_t stride = grid.Stride(direction);
  const auto n = static_cast<std::size_t>(grid.Size[static_cast<std::size_t>(direction)]);
  const std::size_t slab = stride * n;
  for (const double* end = source + grid.Count(); source < end; source += slab, first += slab)
  {
    std::copy_n(source, stride, first);
    for (std::size_t r = 1; r < n; ++r)
    {
      for (std::size_t i = 0; i < stride * (n - r); ++i)
      {
        source[i] = 0.5 * (source[i] + source[i + stride]);
      }
      std::copy_n(source, stride, first + r * stride);
    }
  }
}

/// The bound of errors after halving: every intermediate number is a mean of the ones before, and
/// each step rounds once.
double Grown(double error, int steps, double magnitude)
{
  return (error + Gamma(steps) * (error + magnitude)) * Outward;
}

/// The greatest second difference: what the hull of the coefficients is too large by.
double Curvature(const TensorGrid& grid, int direction, const double* c)
{
  const std::size_t stride = grid.Stride(direction);
  const auto n = static_cast<std::size_t>(grid.Size[static_cast<std::size_t>(direction)]);
  double greatest = 0.0;
  for (const double* end = c + grid.Count(); n > 2 && c < end; c += stride * n)
  {
    for (std::size_t i = 0; i < stride * (n - 2); ++i)
    {
      greatest = std::max(greatest, std::abs(c[i] - 2.0 * c[i + stride] + c[i + 2 * stride]));
    }
  }
  // Of Bernstein coefficients of degree n - 1: the distance to the function grows with n.
  return greatest * static_cast<double>(n);
}

}

DeterminantSubdivision::DeterminantSubdivision(
  std::array<int, 3> degrees, bool rational, const ValidityOptions& options)
  : Rational(rational)
  , Options(options)
{
  for (std::size_t d = 0; d < 3; ++d)
  {
    this->Determinant.Size[d] = rational ? 4 * degrees[d] + 1 : 3 * degrees[d];
  }
  this->BlockSize = this->Determinant.Count() * (rational ? 2 : 1);
  this->Ratios.resize(rational ? this->Determinant.Count() : 0);
}

double* DeterminantSubdivision::Coefficients()
{
  this->Pool.resize(std::max(this->Pool.size(), this->BlockSize));
  return this->Pool.data();
}

std::size_t DeterminantSubdivision::NewBlock()
{
  if (!this->Free.empty())
  {
    const std::size_t block = this->Free.back();
    this->Free.pop_back();
    return block;
  }
  const std::size_t block = this->Blocks++;
  this->Pool.resize(std::max(this->Pool.size(), this->Blocks * this->BlockSize));
  return block;
}

Interval DeterminantSubdivision::Quotient(const Box& box, double value, double weight)
{
  if (!(weight > box.WeightError))
  {
    return { -INFINITY, INFINITY };
  }
  const double low = value - box.Error;
  const double high = value + box.Error;
  const double least = (weight - box.WeightError) * (1.0 - 2 * U);
  const double greatest = (weight + box.WeightError) * (1.0 + 2 * U);
  const double a = low / (low < 0.0 ? least : greatest);
  const double b = high / (high < 0.0 ? greatest : least);
  return { a - 4 * U * std::abs(a), b + 4 * U * std::abs(b) };
}

Interval DeterminantSubdivision::Contribution(const Box& box, std::size_t i)
{
  const double value = this->Values(box)[i];
  return this->Rational ? Quotient(box, value, this->Weights(box)[i])
                        : Interval{ value - box.Error, value + box.Error };
}

void DeterminantSubdivision::Examine(Box& box, ElementValidity& result)
{
  const double* c = this->Values(box);
  const std::size_t n = this->Determinant.Count();
  double least = c[0];
  double greatest = c[0];
  for (std::size_t i = 1; i < n; ++i)
  {
    least = std::min(least, c[i]);
    greatest = std::max(greatest, c[i]);
  }
  box.Magnitude = std::max(std::abs(least), std::abs(greatest));
  box.Range = { least - box.Error, greatest + box.Error };
  if (this->Rational)
  {
    const double* w = this->Weights(box);
    box.WeightMagnitude = *std::max_element(w, w + n);
    box.Range = { INFINITY, -INFINITY };
    for (std::size_t i = 0; i < n; ++i)
    {
      const Interval q = this->Contribution(box, i);
      box.Range = { std::min(box.Range.Low, q.Low), std::max(box.Range.High, q.High) };
    }
  }
  box.Sign = least > box.Error ? 1 : greatest < -box.Error ? -1 : 0;
  if (box.Sign == 0 && result.Degenerate != 0 && (least >= -box.Error || greatest <= box.Error) &&
    (greatest > box.Error || least < -box.Error))
  {
    // One sign, but for some that are 0 to rounding.
    box.Sign = greatest > box.Error ? 1 : -1;
    for (std::size_t i = 0; i < n && box.Sign != 0; ++i)
    {
      if (std::abs(c[i]) <= box.Error && !this->Degenerate.IsExcused(box.Sides, i))
      {
        box.Sign = 0;
      }
    }
  }
  const auto witness = [&result](int sign) -> std::optional<std::array<double, 3>>&
  { return sign > 0 ? result.Positive : result.Negative; };
  if (box.Sign != 0 && !witness(box.Sign))
  {
    witness(box.Sign) = std::array<double, 3>{ box.Low[0] + 0.5 * box.Size[0],
      box.Low[1] + 0.5 * box.Size[1], box.Low[2] + 0.5 * box.Size[2] };
  }
  for (int corner = 0; corner < 8; ++corner)
  {
    const double value = c[this->Determinant.Corner(corner)];
    const Interval j = this->Contribution(box, this->Determinant.Corner(corner));
    this->LeastSample = std::min(this->LeastSample, j.High);
    this->GreatestSample = std::max(this->GreatestSample, j.Low);
    const int sign = value > box.Error ? 1 : value < -box.Error ? -1 : 0;
    if (sign != 0 && !witness(sign))
    {
      witness(sign) = std::array<double, 3>{ box.Low[0] + (corner & 1) * box.Size[0],
        box.Low[1] + (corner >> 1 & 1) * box.Size[1], box.Low[2] + (corner >> 2) * box.Size[2] };
    }
  }
}

bool DeterminantSubdivision::IsOpen(const Box& box, const ElementValidity& result) const
{
  if (box.Sign == 0 && !(result.Positive && result.Negative))
  {
    return true;
  }
  if (this->Options.Tolerance == 0.0)
  {
    return false;
  }
  const double tolerance =
    this->Options.Tolerance * std::max(this->GreatestSample, -this->LeastSample);
  return !(box.Range.Low >= this->LeastSample - tolerance &&
    box.Range.High <= this->GreatestSample + tolerance);
}

std::array<DeterminantSubdivision::Box, 2> DeterminantSubdivision::HalvesOf(const Box& box)
{
  const double* values = this->Values(box);
  if (this->Rational)
  {
    std::transform(values, values + this->Ratios.size(), this->Weights(box), this->Ratios.begin(),
      [](double value, double weight) { return value / weight; });
    values = this->Ratios.data();
  }
  int direction = 0;
  double most = -1.0;
  for (int d = 0; d < 3; ++d)
  {
    double bend = Curvature(this->Determinant, d, values);
    // A linear function that changes its sign is cut as well.
    bend += 1e-3 * box.Size[static_cast<std::size_t>(d)] *
      std::max(std::abs(box.Range.Low), std::abs(box.Range.High));
    if (bend > most)
    {
      most = bend;
      direction = d;
    }
  }
  std::array<Box, 2> halves{ box, box };
  halves[0].Block = this->NewBlock();
  const auto d = static_cast<std::size_t>(direction);
  Halve(this->Determinant, direction, this->Values(box), this->Values(halves[0]));
  if (this->Rational)
  {
    Halve(this->Determinant, direction, this->Weights(box), this->Weights(halves[0]));
  }
  const double error = Grown(box.Error, this->Determinant.Size[d] - 1, box.Magnitude);
  const double weightError =
    Grown(box.WeightError, this->Determinant.Size[d] - 1, box.WeightMagnitude);
  for (int end = 0; end < 2; ++end)
  {
    Box& half = halves[static_cast<std::size_t>(end)];
    half.Size[d] *= 0.5;
    half.Low[d] += end * half.Size[d];
    half.Sides &= ~SideBit(direction, 1 - end);
    half.Error = error;
    half.WeightError = weightError;
    ++half.Depth;
  }
  return halves;
}

double DeterminantSubdivision::ValueAt(const std::array<double, 3>& point) const
{
  double basis[3][Bernstein::DegreeLimit + 1];
  for (std::size_t d = 0; d < 3; ++d)
  {
    double* b = basis[d];
    b[0] = 1.0;
    for (int r = 1; r < this->Determinant.Size[d]; ++r)
    {
      double saved = 0.0;
      for (int i = 0; i < r; ++i)
      {
        const double value = b[i];
        b[i] = saved + (1.0 - point[d]) * value;
        saved = point[d] * value;
      }
      b[r] = saved;
    }
  }
  const double* c = this->Root.data();
  double sum = 0.0;
  for (int k = 0; k < this->Determinant.Size[2]; ++k)
  {
    for (int j = 0; j < this->Determinant.Size[1]; ++j)
    {
      double row = 0.0;
      for (int i = 0; i < this->Determinant.Size[0]; ++i)
      {
        row += basis[0][i] * *c++;
      }
      sum += basis[2][k] * basis[1][j] * row;
    }
  }
  return sum;
}

std::array<double, 3> DeterminantSubdivision::Interior(
  const std::array<double, 3>& point, int sign, double error) const
{
  if (std::all_of(point.begin(), point.end(), [](double t) { return 0.0 < t && t < 1.0; }))
  {
    return point;
  }
  double magnitude = 0.0;
  for (const double c : this->Root)
  {
    magnitude = std::max(magnitude, std::abs(c));
  }
  // Three roundings per step of the recurrences, then products and sums.
  const std::array<int, 3>& n = this->Determinant.Size;
  const double bound =
    (error + Gamma(4 * (n[0] + n[1] + n[2]) + 4) * (magnitude + error)) * Outward;
  for (double part = 0.25; part > U; part *= 0.25)
  {
    std::array<double, 3> inside;
    for (std::size_t d = 0; d < 3; ++d)
    {
      inside[d] = point[d] + part * (0.5 - point[d]);
    }
    if (sign * this->ValueAt(inside) > bound)
    {
      return inside;
    }
  }
  return point;
}

void DeterminantSubdivision::operator()(double error, double weightError, ElementValidity& result)
{
  Box root{ 0, { 0, 0, 0 }, { 1, 1, 1 }, error, weightError, 0, 0, 0x3f, 0, { 0, 0 }, 0, 0 };
  this->Root.assign(this->Pool.begin(),
    this->Pool.begin() + static_cast<std::ptrdiff_t>(this->Determinant.Count()));
  this->Blocks = 1;
  this->Free.clear();
  this->Heap.clear();
  this->LeastSample = INFINITY;
  this->GreatestSample = -INFINITY;
  result.Degenerate = this->Degenerate.Find(this->Determinant, this->Values(root), error);
  this->Examine(root, result);

  Interval closed{ INFINITY, -INFINITY };
  int sign = 2; // of all closed boxes; 2: none yet
  const auto close = [&](const Box& box)
  {
    closed = { std::min(closed.Low, box.Range.Low), std::max(closed.High, box.Range.High) };
    sign = sign == 2 || sign == box.Sign ? box.Sign : 0;
    result.Depth = std::max(result.Depth, box.Depth);
    this->Free.push_back(box.Block);
  };
  const auto add = [&](Box& box)
  {
    box.Priority = box.Range.High - box.Range.Low;
    this->Heap.push_back(box);
    std::push_heap(this->Heap.begin(), this->Heap.end(), ComesLater);
  };
  // Zero all over to rounding: halving it tells nothing.
  if (this->Degenerate.IsAllOfIt())
  {
    close(root);
  }
  else
  {
    add(root);
  }
  while (!this->Heap.empty())
  {
    std::pop_heap(this->Heap.begin(), this->Heap.end(), ComesLater);
    const Box box = this->Heap.back();
    this->Heap.pop_back();
    if (!this->IsOpen(box, result) || box.Depth >= this->Options.MaxDepth ||
      result.Boxes + 2 > this->Options.MaxBoxes)
    {
      close(box);
      continue;
    }
    for (Box& half : this->HalvesOf(box))
    {
      ++result.Boxes;
      this->Examine(half, result);
      add(half);
    }
  }
  if (result.Positive && result.Negative)
  {
    result.Verdict = -1;
    result.By = Certificate::Bernstein;
    result.Positive = this->Interior(*result.Positive, 1, error);
    result.Negative = this->Interior(*result.Negative, -1, error);
  }
  else if (sign == 1 || sign == -1)
  {
    result.Certify(sign, Certificate::Bernstein);
  }
  if (this->Options.Tolerance > 0.0)
  {
    result.Minimum = Interval{ closed.Low, this->LeastSample };
    result.Maximum = Interval{ this->GreatestSample, closed.High };
  }
}

}
