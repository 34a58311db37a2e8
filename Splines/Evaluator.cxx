// SPDX-License-Identifier: BSD-3-Clause
#include "Evaluator.h"

#include "Error.h"
#include "EvaluatorKernel.h"
#include "NumberBlock.h"

#include <algorithm>
#include <cstdlib>
#include <string>

namespace hyperpatch
{

namespace
{

// The arrays behind one EvaluatorDirection.
struct DirectionTables
{
  std::vector<int> Bucket;
  std::vector<double> Breaks;
  std::vector<double> InverseLengths;
  std::vector<std::size_t> Offsets;
  std::vector<double> Table;
};

// Power coefficients of the basis functions on a span about a knot at its end.
void AppendPowers(const KnotVector& knots, int span, double knot, int pitch, DirectionTables& to)
{
  const int p = knots.Degree();
  const double length = knots[span + 1] - knots[span];
  double derivatives[(MaxTableDegree + 1) * (MaxTableDegree + 1)];
  knots.BasisDerivatives(span, knot, p, derivatives);
  double scale = 1.0;
  // Degree 0 has a zero slope, so that a NaN parameter gives NaN there too.
  for (int power = 0; power <= std::max(p, 1); ++power)
  {
    for (int i = 0; i < pitch; ++i)
    {
      to.Table.push_back(i <= p && power <= p ? derivatives[power * (p + 1) + i] * scale : 0.0);
    }
    scale *= length / (power + 1);
  }
}

// Knots and reciprocals for the recurrence; see EvaluatorDirection::Table.
void AppendReciprocals(const KnotVector& knots, int span, DirectionTables& to)
{
  const int p = knots.Degree();
  for (int i = span - p + 1; i <= span + p; ++i)
  {
    to.Table.push_back(knots[i]);
  }
  for (int r = 1; r <= p; ++r)
  {
    for (int j = 0; j < r; ++j)
    {
      to.Table.push_back(1.0 / (knots[span + j + 1] - knots[span + j + 1 - r]));
    }
  }
}

EvaluatorDirection MakeDirection(
  const KnotVector& knots, std::size_t stride, DirectionTables& tables)
{
  const int p = knots.Degree();
  EvaluatorDirection d{};
  d.Degree = p;
  d.Spans = static_cast<int>(knots.Spans().size());
  d.Pitch = p < 4 ? 4 : p == 4 ? 8 : p + 1;
  d.First = knots.First();
  d.Last = knots.Last();
  d.Stride = stride;
  tables.Breaks = knots.Breaks();
  const auto spans = static_cast<std::size_t>(d.Spans);
  tables.InverseLengths.reserve(spans);
  tables.Offsets.reserve(spans);
  tables.Table.reserve(spans *
    static_cast<std::size_t>(
      p <= MaxTableDegree ? 2 * (std::max(p, 1) + 1) * d.Pitch : 2 * p + p * (p + 1) / 2));
  for (int span : knots.Spans())
  {
    tables.InverseLengths.push_back(1.0 / (knots[span + 1] - knots[span]));
    tables.Offsets.push_back(static_cast<std::size_t>(span - p) * stride);
    if (p <= MaxTableDegree)
    {
      AppendPowers(knots, span, knots[span], d.Pitch, tables);
      AppendPowers(knots, span, knots[span + 1], d.Pitch, tables);
    }
    else
    {
      AppendReciprocals(knots, span, tables);
    }
  }
  d.TableSize = tables.Table.size() / static_cast<std::size_t>(d.Spans);

  // Several buckets per span: mostly the bucket alone decides.
  d.Buckets = 4 * d.Spans;
  d.BucketsPerUnit = d.Buckets / (d.Last - d.First);
  tables.Bucket.reserve(static_cast<std::size_t>(d.Buckets));
  for (int bucket = 0, span = 0; bucket < d.Buckets; ++bucket)
  {
    while (span + 1 < d.Spans &&
      EvaluatorBucket(d, tables.Breaks[static_cast<std::size_t>(span) + 1]) < bucket)
    {
      ++span;
    }
    tables.Bucket.push_back(span);
  }
  d.Bucket = tables.Bucket.data();
  d.Breaks = tables.Breaks.data();
  d.InverseLengths = tables.InverseLengths.data();
  d.Offsets = tables.Offsets.data();
  d.Table = tables.Table.data();
  return d;
}

// The fastest kernels, or those that the environment names.
const EvaluatorKernels* ChooseKernels()
{
  const EvaluatorKernels* available[3];
  const int count = AvailableEvaluatorKernels(available);
  const char* wanted = std::getenv("HYPERPATCH_INSTRUCTION_SET");
  if (!wanted || !*wanted)
  {
    return available[0];
  }
  std::string names;
  for (int i = 0; i < count; ++i)
  {
    if (std::string(wanted) == available[i]->Name)
    {
      return available[i];
    }
    names += std::string(i > 0 ? ", " : "") + available[i]->Name;
  }
  throw Error("HYPERPATCH_INSTRUCTION_SET is \"" + std::string(wanted) +
    "\"; this processor and build have: " + names);
}

}

int AvailableEvaluatorKernels(const EvaluatorKernels* kernels[3])
{
  int count = 0;
#ifdef HYPERPATCH_X86
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
    __builtin_cpu_supports("avx512vl"))
  {
    kernels[count++] = &EvaluatorAVX512;
  }
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
  {
    kernels[count++] = &EvaluatorAVX2;
  }
#endif
  kernels[count++] = &EvaluatorBaseline;
  return count;
}

namespace
{

/// Numbers per homogeneous control point, padded.
std::size_t PointWidth(const Spline& spline)
{
  const int numbers = spline.Components() + (spline.IsRational() ? 1 : 0);
  return static_cast<std::size_t>(numbers < 3 ? numbers : (numbers + 3) / 4 * 4);
}

/// Homogeneous control points; the weight is the last of `width` numbers. \tparam M the number of
/// components where the compiler should know it, or 0
template <int M>
void CopyPointsOf(const Spline& spline, int width, double* to)
{
  const int m = M > 0 ? M : spline.Components();
  const double* point = spline.Coefficients().data();
  const double* weight = spline.IsRational() ? spline.Weights().data() : nullptr;
  const Eigen::Index count = spline.NumberOfControlPoints();
  for (Eigen::Index i = 0; i < count; ++i, point += m, to += width)
  {
    const double w = weight ? weight[i] : 1.0;
    for (int e = 0; e < m; ++e)
    {
      to[e] = w * point[e];
    }
    for (int e = m; e < width; ++e)
    {
      to[e] = 0.0;
    }
    if (weight)
    {
      to[width - 1] = w;
    }
  }
}

void CopyPoints(const Spline& spline, int width, double* to)
{
  if (!spline.IsRational() && width == spline.Components())
  {
    std::copy_n(spline.Coefficients().data(), spline.Coefficients().size(), to);
  }
  else if (spline.Components() == 3)
  {
    CopyPointsOf<3>(spline, width, to);
  }
  else
  {
    CopyPointsOf<0>(spline, width, to);
  }
}

}

struct Evaluator::Layout
{
  explicit Layout(const Spline& spline);
  Layout(const Layout&) = delete;
  Layout& operator=(const Layout&) = delete;

  void Evaluate(std::size_t count, const double* parameters, int order, double* values,
    double* first, double* second) const;

  std::array<DirectionTables, 3> Tables;
  NumberBlock Points;
  EvaluatorData Data{};
  const EvaluatorKernels* Kernels;
};

Evaluator::Layout::Layout(const Spline& spline)
  : Points(PointWidth(spline) * static_cast<std::size_t>(spline.NumberOfControlPoints()) + MaxLanes)
  , Kernels(ChooseKernels())
{
  this->Data.Components = spline.Components();
  this->Data.Rational = spline.IsRational();
  this->Data.Width = static_cast<int>(PointWidth(spline));
  const auto width = static_cast<std::size_t>(this->Data.Width);
  std::size_t stride = width;
  for (std::size_t d = 0; d < 3; ++d)
  {
    const KnotVector& knots = spline.Knots()[d];
    this->Data.Directions[d] = MakeDirection(knots, stride, this->Tables[d]);
    stride *= static_cast<std::size_t>(knots.Size());
  }
  CopyPoints(spline, this->Data.Width, this->Points.Data());
  std::fill_n(this->Points.Data() + stride, MaxLanes, 0.0);
  this->Data.Points = this->Points.Data();
}

void Evaluator::Layout::Evaluate(std::size_t count, const double* parameters, int order,
  double* values, double* first, double* second) const
{
  constexpr std::size_t onStack = 1024;
  const auto row =
    static_cast<std::size_t>((this->Data.Directions[0].Degree + 1) * this->Data.Width);
  const std::size_t size = (order == 0 ? 1 : order == 1 ? 3 : 6) * EvaluatorPadded(row);
  double small[onStack];
  std::vector<double> large(size > onStack ? size : 0);
  this->Kernels->Evaluate(this->Data, count, parameters, order, values, first, second,
    large.empty() ? small : large.data());
}

Evaluator::Evaluator(const Spline& spline)
  : L(std::make_unique<const Layout>(spline))
{
}

Evaluator::~Evaluator() = default;
Evaluator::Evaluator(Evaluator&&) noexcept = default;
Evaluator& Evaluator::operator=(Evaluator&&) noexcept = default;

int Evaluator::Components() const
{
  return this->L->Data.Components;
}

void Evaluator::Evaluate(std::size_t count, const double* parameters, double* values) const
{
  this->L->Evaluate(count, parameters, 0, values, nullptr, nullptr);
}

void Evaluator::EvaluateWithDerivatives(
  std::size_t count, const double* parameters, double* values, double* derivatives) const
{
  this->L->Evaluate(count, parameters, 1, values, derivatives, nullptr);
}

void Evaluator::EvaluateWithSecondDerivatives(std::size_t count, const double* parameters,
  double* values, double* derivatives, double* second) const
{
  this->L->Evaluate(count, parameters, 2, values, derivatives, second);
}

void Evaluator::EvaluateGrid(
  const std::array<std::vector<double>, 3>& parameters, double* values, double* derivatives) const
{
  const EvaluatorData& data = this->L->Data;
  const std::size_t orders = derivatives ? 2 : 1;
  const std::size_t rows = derivatives ? 3 : 1;
  std::size_t counts[3];
  const double* lists[3];
  std::size_t sizes[3];
  for (std::size_t d = 0; d < 3; ++d)
  {
    counts[d] = parameters[d].size();
    lists[d] = parameters[d].data();
    sizes[d] = counts[d] * orders * static_cast<std::size_t>(data.Directions[d].Pitch);
  }
  if (counts[0] * counts[1] * counts[2] == 0)
  {
    return;
  }
  // Control points in a u-row, and u-rows in a plane of the lattice.
  const std::size_t row = EvaluatorPadded(data.Directions[1].Stride);
  const std::size_t lines = data.Directions[2].Stride / data.Directions[1].Stride;
  std::vector<double> scratch(sizes[0] + sizes[1] + sizes[2] + orders * lines * row + rows * row);
  std::vector<std::size_t> indices(counts[0] + counts[1] + counts[2]);
  double* const bases[3] = { scratch.data(), scratch.data() + sizes[0],
    scratch.data() + sizes[0] + sizes[1] };
  std::size_t* const offsets[3] = { indices.data(), indices.data() + counts[0],
    indices.data() + counts[0] + counts[1] };
  double* planes = bases[2] + sizes[2];
  this->L->Kernels->EvaluateGrid(data, counts, lists, values, derivatives, bases, offsets, planes,
    planes + orders * lines * row);
}

}
