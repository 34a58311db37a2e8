// SPDX-License-Identifier: BSD-3-Clause

// The evaluation kernel, included once per instruction set with HYPERPATCH_LANES (doubles per
// register) and HYPERPATCH_KERNELS (the name of the table to define). Internal linkage only, and
// no header that has anything else: see EvaluatorKernel.h.
//
// A tensor-product sum over (p+1)^3 control points is contracted in w, then in v, then in u. The
// first two act alike on all numbers of a u-row of control points, which lie side by side, so the
// registers are full for any degree and number of components. Batches and grids contract in the
// same order with the same operations: they agree bitwise, and so do all positions in a batch.

#include "EvaluatorKernel.h"

namespace hyperpatch
{
namespace
{

typedef double Pair __attribute__((vector_size(16)));
typedef double Quad __attribute__((vector_size(32)));
typedef double Register __attribute__((vector_size(8 * HYPERPATCH_LANES)));
constexpr int Lanes = HYPERPATCH_LANES;
// What a control point of 4, 8, ... doubles and a row of table basis functions are cut into.
#if HYPERPATCH_LANES == 2
typedef Pair Piece;
#else
typedef Quad Piece;
#endif

// Registers of a u-row that are contracted together, by order: as many as there are registers for
// their sums.
constexpr int Together[3] = { 4, 2, Lanes == 8 ? 2 : 1 };

template <int Width>
struct PieceFor
{
  typedef Piece Type;
};
template <>
struct PieceFor<1>
{
  typedef double Type;
};
template <>
struct PieceFor<2>
{
  typedef Pair Type;
};
template <int Width>
using PieceOf = typename PieceFor<Width>::Type;

template <class V>
[[gnu::always_inline]] inline V Load(const double* from)
{
  V v;
  __builtin_memcpy(&v, from, sizeof(V));
  return v;
}

template <class V>
[[gnu::always_inline]] inline void Store(double* to, const V& v)
{
  __builtin_memcpy(to, &v, sizeof(V));
}

[[gnu::always_inline]] inline void StoreSome(double* to, double v, int)
{
  *to = v;
}

[[gnu::always_inline]] inline void StoreSome(double* to, const Pair& v, int count)
{
  if (count > 1)
  {
    Store(to, v);
  }
  else if (count == 1)
  {
    to[0] = v[0];
  }
}

[[gnu::always_inline]] inline void StoreSome(double* to, const Quad& v, int count)
{
  if (count == 3)
  {
    Store(to, Pair{ v[0], v[1] });
    to[2] = v[2];
  }
  else if (count >= 4)
  {
    Store(to, v);
  }
  else
  {
    for (int i = 0; i < count; ++i)
    {
      to[i] = v[i];
    }
  }
}

[[gnu::always_inline]] inline double LastOf(double v)
{
  return v;
}

template <class V>
[[gnu::always_inline]] inline double LastOf(const V& v)
{
  return v[sizeof(V) / sizeof(double) - 1];
}

// sum += a * x, fused where the instruction set can.
template <class V>
[[gnu::always_inline]] inline void Add(V& sum, double a, const V& x)
{
  sum += a * x;
}

// The compiler may spread a scalar sum over a register and then not fuse it, here but not there.
[[gnu::always_inline]] inline void Add(double& sum, double a, double x)
{
#ifdef __FMA__
  sum = __builtin_fma(a, x, sum);
#else
  sum += a * x;
#endif
}

// Moves t into the domain and finds its span; NaN stays NaN, in span 0.
[[gnu::always_inline]] inline int Locate(const EvaluatorDirection& d, double& t)
{
  t = t < d.First ? d.First : t;
  t = t > d.Last ? d.Last : t;
  int span = d.Bucket[EvaluatorBucket(d, t)];
  const int last = d.Spans - 1;
  span += static_cast<int>(span < last) & static_cast<int>(t >= d.Breaks[span + 1]);
  if (__builtin_expect(span < last && t >= d.Breaks[span + 1], 0))
  {
    int high = d.Spans;
    while (high - span > 1)
    {
      const int middle = span + (high - span) / 2;
      (t >= d.Breaks[middle] ? span : high) = middle;
    }
  }
  return span;
}

template <int Degree, int Order>
[[gnu::always_inline]] inline void TableBasis(
  const EvaluatorDirection& d, int span, double t, double* basis)
{
  constexpr int pitch = Degree < 4 ? 4 : 8;
  const double below = t - d.Breaks[span];
  const double above = t - d.Breaks[span + 1];
  const int half = below + above > 0.0;
  const double inverse = d.InverseLengths[span];
  const double x = (half ? above : below) * inverse;
  const double* table = d.Table + static_cast<std::size_t>(2 * span + half) * (Degree + 1) * pitch;
  for (int i = 0; i < pitch; i += static_cast<int>(sizeof(Piece) / sizeof(double)))
  {
    Piece value = Load<Piece>(table + Degree * pitch + i);
    Piece first{};
    Piece second{};
    for (int power = Degree - 1; power >= 0; --power)
    {
      if constexpr (Order > 1)
      {
        second = second * x + first;
      }
      if constexpr (Order > 0)
      {
        first = first * x + value;
      }
      value = value * x + Load<Piece>(table + power * pitch + i);
    }
    Store(basis + i, value);
    if constexpr (Order > 0)
    {
      Store(basis + pitch + i, first * inverse);
    }
    if constexpr (Order > 1)
    {
      Store(basis + 2 * pitch + i, second * (2.0 * inverse * inverse));
    }
  }
}

// One step of differentiation: `lower` has degree values of degree - 1 (or derivatives of them).
inline void Differentiate(int degree, const double* inverse, const double* lower, double* to)
{
  double before = 0.0;
  for (int j = 0; j < degree; ++j)
  {
    const double scaled = degree * lower[j] * inverse[j];
    to[j] = before - scaled;
    before = scaled;
  }
  to[degree] = before;
}

// Never inlined: its products could be fused with its sums in more than one way, and batches and
// grids must get the same.
[[gnu::noinline]] void RecurrenceBasis(
  const EvaluatorDirection& d, int span, double t, int order, double* basis)
{
  constexpr int most = 32;
  const int p = d.Degree;
  const double* knots = d.Table + static_cast<std::size_t>(span) * d.TableSize + p - 1;
  const double* inverse = knots + p + 1;
  // Shares are measured from the nearer knot: they are exact zeros there, and the rest exactly one.
  const bool upper = t - knots[0] > knots[1] - t;
  double values[most] = { 1.0 };
  double lower[2][most];
  for (int r = 1; r <= p; ++r)
  {
    if (p - r < order)
    {
      for (int j = 0; j < r; ++j)
      {
        lower[p - r][j] = values[j];
      }
    }
    double saved = 0.0;
    for (int j = 0; j < r; ++j)
    {
      const double share = (upper ? knots[j + 1] - t : t - knots[j + 1 - r]) * inverse[j];
      const double near = share * values[j];
      const double rest = values[j] - near;
      values[j] = saved + (upper ? near : rest);
      saved = upper ? rest : near;
    }
    values[r] = saved;
    inverse += r;
  }
  for (int j = 0; j <= p; ++j)
  {
    basis[j] = values[j];
  }
  if (order > 0)
  {
    Differentiate(p, inverse - p, lower[0], basis + d.Pitch);
  }
  if (order > 1)
  {
    double middle[most];
    Differentiate(p - 1, inverse - p - (p - 1), lower[1], middle);
    Differentiate(p, inverse - p, middle, basis + 2 * d.Pitch);
  }
}

// Basis functions and derivatives at t.
// \return the index of the first control point that matters
template <int Order>
[[gnu::always_inline]] inline std::size_t Basis(
  const EvaluatorDirection& d, double t, double* basis)
{
  const int span = Locate(d, t);
  switch (d.Degree)
  {
    case 0:
    case 1:
      TableBasis<1, Order>(d, span, t, basis);
      break;
    case 2:
      TableBasis<2, Order>(d, span, t, basis);
      break;
    case 3:
      TableBasis<3, Order>(d, span, t, basis);
      break;
    case 4:
      TableBasis<4, Order>(d, span, t, basis);
      break;
    default:
      RecurrenceBasis(d, span, t, Order, basis);
  }
  return d.Offsets[span];
}

// Number of rows after the contraction in w and v: 1; v, w; vv, vw, ww.
template <int Order>
constexpr int Rows = Order == 0 ? 1
  : Order == 1                  ? 3
                                : 6;

// Contracts Count registers of a u-row in w and v. DegreeW < 0: any.
template <int Order, int DegreeW, int Count>
[[gnu::always_inline]] inline void Contract(const EvaluatorData& data, const double* points,
  const double* v, const double* w, double* rows, std::size_t pitch)
{
  const EvaluatorDirection& dv = data.Directions[1];
  const EvaluatorDirection& dw = data.Directions[2];
  const int degreeW = DegreeW < 0 ? dw.Degree : DegreeW;
  const double* v1 = v + dv.Pitch;
  const double* v2 = v1 + dv.Pitch;
  const double* w1 = w + dw.Pitch;
  const double* w2 = w1 + dw.Pitch;
  Register sum[Rows<Order>][Count] = {};
  for (int b = 0; b <= dv.Degree; ++b, points += dv.Stride)
  {
    Register line[Order + 1][Count] = {};
    const double* at = points;
#pragma GCC unroll 5
    for (int c = 0; c <= degreeW; ++c, at += dw.Stride)
    {
#pragma GCC unroll 4
      for (int k = 0; k < Count; ++k)
      {
        const Register x = Load<Register>(at + k * Lanes);
        line[0][k] += w[c] * x;
        if constexpr (Order > 0)
        {
          line[1][k] += w1[c] * x;
        }
        if constexpr (Order > 1)
        {
          line[2][k] += w2[c] * x;
        }
      }
    }
#pragma GCC unroll 4
    for (int k = 0; k < Count; ++k)
    {
      sum[0][k] += v[b] * line[0][k];
      if constexpr (Order > 0)
      {
        sum[1][k] += v1[b] * line[0][k];
        sum[2][k] += v[b] * line[1][k];
      }
      if constexpr (Order > 1)
      {
        sum[3][k] += v2[b] * line[0][k];
        sum[4][k] += v1[b] * line[1][k];
        sum[5][k] += v[b] * line[2][k];
      }
    }
  }
  for (int r = 0; r < Rows<Order>; ++r)
  {
    for (int k = 0; k < Count; ++k)
    {
      Store(rows + static_cast<std::size_t>(r) * pitch + k * Lanes, sum[r][k]);
    }
  }
}

// Contracts the rows in u, divides by the weight (quotient rule, The NURBS Book A4.4) and writes
// one point. Width: of a control point, 0 for any multiple of 4; DegreeU < 0: any.
template <int Order, int DegreeU, int Width>
[[gnu::always_inline]] inline void Finish(const EvaluatorData& data, const double* rows,
  std::size_t pitch, const double* u, double* values, double* first, double* second)
{
  using V = PieceOf<Width>;
  constexpr int lanes = sizeof(V) / sizeof(double);
  constexpr int sums = Order == 0 ? 1 : Order == 1 ? 4 : 10;
  const EvaluatorDirection& du = data.Directions[0];
  const int degreeU = DegreeU < 0 ? du.Degree : DegreeU;
  const double* u1 = u + du.Pitch;
  const double* u2 = u1 + du.Pitch;
  const int width = Width > 0 ? Width : data.Width;
  const int m = data.Components;
  double weights[sums] = { 1.0 };
  double inverse = 1.0;
  // From the last piece to the first, because the last one has the weight.
  for (int e = width - lanes; e >= 0; e -= lanes)
  {
    V h[sums] = {};
    const double* x = rows + e;
#pragma GCC unroll 5
    for (int a = 0; a <= degreeU; ++a, x += width)
    {
      const V x0 = Load<V>(x);
      Add(h[0], u[a], x0);
      if constexpr (Order > 0)
      {
        const V xv = Load<V>(x + pitch);
        const V xw = Load<V>(x + 2 * pitch);
        Add(h[1], u1[a], x0);
        Add(h[2], u[a], xv);
        Add(h[3], u[a], xw);
        if constexpr (Order > 1)
        {
          Add(h[4], u2[a], x0);
          Add(h[5], u1[a], xv);
          Add(h[6], u1[a], xw);
          Add(h[7], u[a], Load<V>(x + 3 * pitch));
          Add(h[8], u[a], Load<V>(x + 4 * pitch));
          Add(h[9], u[a], Load<V>(x + 5 * pitch));
        }
      }
    }
    if (data.Rational)
    {
      if (e == width - lanes)
      {
        for (int r = 0; r < sums; ++r)
        {
          weights[r] = LastOf(h[r]);
        }
        inverse = 1.0 / weights[0];
      }
      h[0] = h[0] / weights[0];
      if constexpr (Order > 0)
      {
        for (int r = 1; r < 4; ++r)
        {
          h[r] = (h[r] - weights[r] * h[0]) * inverse;
        }
      }
      if constexpr (Order > 1)
      {
        for (int r = 4, i = 1; i < 4; ++i)
        {
          for (int j = i; j < 4; ++j, ++r)
          {
            V numerator = h[r] - weights[r] * h[0];
            numerator -= weights[j] * h[i];
            numerator -= weights[i] * h[j];
            h[r] = numerator * inverse;
          }
        }
      }
    }
    const int count = m - e;
    StoreSome(values + e, h[0], count);
    if constexpr (Order > 0)
    {
      for (int r = 1; r < 4; ++r)
      {
        StoreSome(first + (r - 1) * m + e, h[r], count);
      }
    }
    if constexpr (Order > 1)
    {
      for (int r = 4; r < 10; ++r)
      {
        StoreSome(second + (r - 4) * m + e, h[r], count);
      }
    }
  }
}

template <int Order, int Degree, int Width>
void Batch(const EvaluatorData& data, std::size_t count, const double* parameters, double* values,
  double* first, double* second, double* scratch)
{
  const EvaluatorDirection& du = data.Directions[0];
  const auto length = static_cast<std::size_t>((du.Degree + 1) * data.Width);
  const std::size_t pitch = EvaluatorPadded(length);
  const auto registers = static_cast<int>((length + Lanes - 1) / Lanes);
  const auto m = static_cast<std::size_t>(data.Components);
  constexpr int together = Together[Order];
  double basis[3][3 * 32];
  for (std::size_t q = 0; q < count; ++q)
  {
    const double* points = data.Points;
    for (int d = 0; d < 3; ++d)
    {
      points += Basis<Order>(data.Directions[d], parameters[3 * q + d], basis[d]);
    }
    int k = 0;
    for (; k + together <= registers; k += together)
    {
      Contract<Order, Degree, together>(
        data, points + k * Lanes, basis[1], basis[2], scratch + k * Lanes, pitch);
    }
    for (; k < registers; ++k)
    {
      Contract<Order, Degree, 1>(
        data, points + k * Lanes, basis[1], basis[2], scratch + k * Lanes, pitch);
    }
    Finish<Order, Degree, Width>(data, scratch, pitch, basis[0], values, first, second);
    values += m;
    if constexpr (Order > 0)
    {
      first += 3 * m;
    }
    if constexpr (Order > 1)
    {
      second += 6 * m;
    }
  }
}

// to[j] = sum over i of basis[i] from[i * stride + j]; writes whole registers.
inline void Combine(double* to, std::size_t length, int degree, const double* basis,
  const double* from, std::size_t stride)
{
  for (std::size_t j = 0; j < length; j += Lanes)
  {
    Register sum{};
    const double* at = from + j;
    for (int i = 0; i <= degree; ++i, at += stride)
    {
      sum += basis[i] * Load<Register>(at);
    }
    Store(to + j, sum);
  }
}

template <int Order, int Degree, int Width>
void Grid(const EvaluatorData& data, const std::size_t* counts, const double* const* parameters,
  double* values, double* first, double* const* bases, std::size_t* const* offsets, double* planes,
  double* rows)
{
  const EvaluatorDirection& du = data.Directions[0];
  const EvaluatorDirection& dv = data.Directions[1];
  const EvaluatorDirection& dw = data.Directions[2];
  std::size_t low[3];
  std::size_t high[3];
  for (int d = 0; d < 3; ++d)
  {
    const EvaluatorDirection& direction = data.Directions[d];
    const auto size = static_cast<std::size_t>((Order + 1) * direction.Pitch);
    low[d] = direction.Offsets[direction.Spans - 1];
    high[d] = 0;
    for (std::size_t i = 0; i < counts[d]; ++i)
    {
      const std::size_t at = Basis<Order>(direction, parameters[d][i], bases[d] + i * size);
      offsets[d][i] = at;
      low[d] = at < low[d] ? at : low[d];
      high[d] = at > high[d] ? at : high[d];
    }
    high[d] += static_cast<std::size_t>(direction.Degree + 1) * direction.Stride;
  }
  const std::size_t length = high[0] - low[0];
  const std::size_t pitch = EvaluatorPadded(length);
  const std::size_t lines = (high[1] - low[1]) / dv.Stride;
  double* planeW = planes + lines * pitch;
  const auto m = static_cast<std::size_t>(data.Components);
  for (std::size_t k = 0; k < counts[2]; ++k)
  {
    const double* w = bases[2] + k * static_cast<std::size_t>((Order + 1) * dw.Pitch);
    const double* points = data.Points + low[0] + low[1] + offsets[2][k];
    for (std::size_t l = 0; l < lines; ++l, points += dv.Stride)
    {
      Combine(planes + l * pitch, length, dw.Degree, w, points, dw.Stride);
      if constexpr (Order > 0)
      {
        Combine(planeW + l * pitch, length, dw.Degree, w + dw.Pitch, points, dw.Stride);
      }
    }
    for (std::size_t j = 0; j < counts[1]; ++j)
    {
      const double* v = bases[1] + j * static_cast<std::size_t>((Order + 1) * dv.Pitch);
      const std::size_t at = (offsets[1][j] - low[1]) / dv.Stride * pitch;
      Combine(rows, length, dv.Degree, v, planes + at, pitch);
      if constexpr (Order > 0)
      {
        Combine(rows + pitch, length, dv.Degree, v + dv.Pitch, planes + at, pitch);
        Combine(rows + 2 * pitch, length, dv.Degree, v, planeW + at, pitch);
      }
      const double* u = bases[0];
      for (std::size_t i = 0; i < counts[0]; ++i)
      {
        Finish<Order, Degree, Width>(
          data, rows + (offsets[0][i] - low[0]), pitch, u, values, first, nullptr);
        u += (Order + 1) * du.Pitch;
        values += m;
        if constexpr (Order > 0)
        {
          first += 3 * m;
        }
      }
    }
  }
}

template <int Order, int Width>
void BatchOfDegree(const EvaluatorData& data, std::size_t count, const double* parameters,
  double* values, double* first, double* second, double* scratch)
{
  const int degree = data.Directions[2].Degree;
  const bool same = data.Directions[0].Degree == degree;
  const auto batch = !same || degree == 0 ? Batch<Order, -1, Width>
    : degree == 1                         ? Batch<Order, 1, Width>
    : degree == 2                         ? Batch<Order, 2, Width>
    : degree == 3                         ? Batch<Order, 3, Width>
    : degree == 4                         ? Batch<Order, 4, Width>
                                          : Batch<Order, -1, Width>;
  batch(data, count, parameters, values, first, second, scratch);
}

template <int Width>
void BatchOfOrder(const EvaluatorData& data, std::size_t count, const double* parameters, int order,
  double* values, double* first, double* second, double* scratch)
{
  const auto batch = order == 0 ? BatchOfDegree<0, Width>
    : order == 1                ? BatchOfDegree<1, Width>
                                : BatchOfDegree<2, Width>;
  batch(data, count, parameters, values, first, second, scratch);
}

void Evaluate(const EvaluatorData& data, std::size_t count, const double* parameters, int order,
  double* values, double* first, double* second, double* scratch)
{
  const auto batch = data.Width == 1 ? BatchOfOrder<1>
    : data.Width == 2                ? BatchOfOrder<2>
    : data.Width == 4                ? BatchOfOrder<4>
                                     : BatchOfOrder<0>;
  batch(data, count, parameters, order, values, first, second, scratch);
}

template <int Order, int Width>
void GridOfDegree(const EvaluatorData& data, const std::size_t* counts,
  const double* const* parameters, double* values, double* first, double* const* bases,
  std::size_t* const* offsets, double* planes, double* rows)
{
  const int degree = data.Directions[0].Degree;
  const auto grid = degree == 1 ? Grid<Order, 1, Width>
    : degree == 2               ? Grid<Order, 2, Width>
    : degree == 3               ? Grid<Order, 3, Width>
    : degree == 4               ? Grid<Order, 4, Width>
                                : Grid<Order, -1, Width>;
  grid(data, counts, parameters, values, first, bases, offsets, planes, rows);
}

void EvaluateGrid(const EvaluatorData& data, const std::size_t* counts,
  const double* const* parameters, double* values, double* first, double* const* bases,
  std::size_t* const* offsets, double* planes, double* rows)
{
  const auto grid = data.Width == 1 ? (first ? GridOfDegree<1, 1> : GridOfDegree<0, 1>)
    : data.Width == 2               ? (first ? GridOfDegree<1, 2> : GridOfDegree<0, 2>)
    : data.Width == 4               ? (first ? GridOfDegree<1, 4> : GridOfDegree<0, 4>)
                                    : (first ? GridOfDegree<1, 0> : GridOfDegree<0, 0>);
  grid(data, counts, parameters, values, first, bases, offsets, planes, rows);
}

}

const EvaluatorKernels HYPERPATCH_KERNELS = { HYPERPATCH_KERNELS_NAME, Evaluate, EvaluateGrid };

}
