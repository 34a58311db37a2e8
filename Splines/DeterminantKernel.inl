// SPDX-License-Identifier: BSD-3-Clause

// The determinant kernel, included once per instruction set with HYPERPATCH_LANES (doubles per
// register) and HYPERPATCH_KERNELS (the name of the table to define). Internal linkage only, and
// no header that has anything else: see DeterminantKernel.h.
//
// Two steps: the nine 2x2 minors of P_v x P_w, then their product with P_u. The sums of a row of
// coefficients stay in registers while all pairs of rows that reach it are added.

#include "DeterminantKernel.h"

namespace hyperpatch
{
namespace
{

typedef double Register __attribute__((vector_size(8 * HYPERPATCH_LANES)));
constexpr std::size_t Lanes = HYPERPATCH_LANES;

[[gnu::always_inline]] inline Register Load(const double* from)
{
  Register v;
  __builtin_memcpy(&v, from, sizeof(Register));
  return v;
}

[[gnu::always_inline]] inline void Store(double* to, const Register& v)
{
  __builtin_memcpy(to, &v, sizeof(Register));
}

[[gnu::always_inline]] inline Register Less(const Register& a, const Register& b)
{
  return a < b ? a : b;
}

/// Calls body(Number<0>()), ... body(Number<Count - 1>()): a loop that is gone before arrays are
/// assigned to registers, as unrolled loops are not.
template <int Value>
struct Number
{
  static constexpr int value = Value;
};

template <int Count, class Body>
[[gnu::always_inline]] inline void Repeat(const Body& body)
{
  if constexpr (Count > 0)
  {
    Repeat<Count - 1>(body);
    body(Number<Count - 1>());
  }
}

/// sums += a * b or -= a * b for rows of scaled coefficients.
template <bool Negative, int CountA, int CountB>
[[gnu::always_inline]] inline void Convolve(const double* a, const double* b, Register* sums)
{
  Register x[CountA];
  Repeat<CountA>([&](auto i) [[gnu::always_inline]] { x[i.value] = Load(a + Lanes * i.value); });
  Repeat<CountB>(
    [&](auto j) [[gnu::always_inline]]
    {
      const Register y = Load(b + Lanes * j.value);
      Repeat<CountA>(
        [&](auto i) [[gnu::always_inline]]
        {
          Register& sum = sums[i.value + j.value];
          sum = Negative ? sum - x[i.value] * y : sum + x[i.value] * y;
        });
    });
}

/// The same for rows whose lengths, at least 1, are known at run time only.
template <bool Negative>
void Convolve(const double* a, int countA, const double* b, int countB, Register* sums)
{
  for (int j = 0; j < countB; ++j)
  {
    const Register y = Load(b + HYPERPATCH_LANES * j);
    for (int i = 0; i < countA; ++i)
    {
      const Register x = Load(a + HYPERPATCH_LANES * i);
      sums[i + j] = Negative ? sums[i + j] - x * y : sums[i + j] + x * y;
    }
  }
}

/// One of the two above; P: the degree in u, 0 where it is known at run time only.
template <bool Negative, int P, int CountA, int CountB>
[[gnu::always_inline]] inline void Add(
  const double* a, int countA, const double* b, int countB, Register* sums)
{
  if constexpr (P > 0)
  {
    Convolve<Negative, CountA, CountB>(a, b, sums);
  }
  else
  {
    Convolve<Negative>(a, countA, b, countB, sums);
  }
}

/// Coefficients of a vector field: three components of n[0] x n[1] x n[2], u fastest.
struct Field
{
  double* Values;
  int n[3];

  [[gnu::always_inline]] double* Row(int component, int j, int k) const
  {
    return this->Values +
      Lanes * static_cast<std::size_t>(n[0] * (j + n[1] * (k + n[2] * component)));
  }
};

/// Calls body(rows j and k of the first factor, of the second one) for all that add up to (j, k).
template <class Body>
[[gnu::always_inline]] inline void ForPairs(
  const Field& a, const Field& b, int j, int k, const Body& body)
{
  const int lastK = k < a.n[2] - 1 ? k : a.n[2] - 1;
  const int lastJ = j < a.n[1] - 1 ? j : a.n[1] - 1;
  for (int l = k < b.n[2] ? 0 : k - b.n[2] + 1; l <= lastK; ++l)
  {
    for (int i = j < b.n[1] ? 0 : j - b.n[1] + 1; i <= lastJ; ++i)
    {
      body(i, l, j - i, k - l);
    }
  }
}

template <int P, int Count, class Body>
[[gnu::always_inline]] inline void ForRow(int count, const Body& body)
{
  if constexpr (P > 0)
  {
    Repeat<Count>([&](auto i) [[gnu::always_inline]] { body(i.value); });
  }
  else
  {
    for (int i = 0; i < count; ++i)
    {
      body(i);
    }
  }
}

/// \tparam MaxSums at least 3 times the degree in u
template <int P, int MaxSums>
void Products(const DeterminantShape& shape, const Field& u, const Field& v, const Field& w,
  const Field& cross, double* coefficients, double* least, double* greatest)
{
  const int p = P > 0 ? P : shape.Degrees[0];
  const int count = 2 * p + 1;
  for (int c = 0; c < 3; ++c)
  {
    const int c1 = (c + 1) % 3;
    const int c2 = (c + 2) % 3;
    for (int k = 0; k < cross.n[2]; ++k)
    {
      for (int j = 0; j < cross.n[1]; ++j)
      {
        Register sums[MaxSums] = {};
        ForPairs(v, w, j, k,
          [&](int jv, int kv, int jw, int kw) [[gnu::always_inline]]
          {
            Add<false, P, P + 1, P + 1>(v.Row(c1, jv, kv), p + 1, w.Row(c2, jw, kw), p + 1, sums);
            Add<true, P, P + 1, P + 1>(v.Row(c2, jv, kv), p + 1, w.Row(c1, jw, kw), p + 1, sums);
          });
        double* target = cross.Row(c, j, k);
        const auto store = [&](int i) [[gnu::always_inline]]
        { Store(target + HYPERPATCH_LANES * i, sums[i]); };
        ForRow<P, 2 * P + 1>(count, store);
      }
    }
  }
  const double* unscale = shape.Unscale;
  Register low = Register{} + __builtin_inf();
  Register high = -low;
  for (int k = 0; k < 3 * shape.Degrees[2]; ++k)
  {
    for (int j = 0; j < 3 * shape.Degrees[1]; ++j)
    {
      Register sums[MaxSums] = {};
      for (int c = 0; c < 3; ++c)
      {
        ForPairs(u, cross, j, k,
          [&](int ju, int ku, int jc, int kc) [[gnu::always_inline]]
          { Add<false, P, P, 2 * P + 1>(u.Row(c, ju, ku), p, cross.Row(c, jc, kc), count, sums); });
      }
      const auto store = [&](int i) [[gnu::always_inline]]
      {
        const Register value = sums[i] * unscale[i];
        Store(coefficients + HYPERPATCH_LANES * i, value);
        low = Less(value, low);
        high = -Less(-value, -high);
      };
      ForRow<P, 3 * P>(3 * p, store);
      unscale += 3 * p;
      coefficients += HYPERPATCH_LANES * 3 * p;
    }
  }
  Store(least, low);
  Store(greatest, high);
}

void Determinant(const DeterminantShape& shape, const double* points, double* scratch,
  double* coefficients, double* least, double* greatest, double* magnitudes)
{
  const int* p = shape.Degrees;
  Field derivatives[3];
  const int size[3] = { p[0] + 1, p[1] + 1, p[2] + 1 };
  const std::size_t all = static_cast<std::size_t>(size[0] * size[1] * size[2]);
  std::size_t stride = Lanes;
  for (int d = 0; d < 3; ++d)
  {
    Field& f = derivatives[d];
    f = { scratch, { size[0] - (d == 0), size[1] - (d == 1), size[2] - (d == 2) } };
    for (int c = 0; c < 3; ++c)
    {
      const double* scale = shape.Scales[d];
      Register magnitude{};
      for (int k = 0; k < f.n[2]; ++k)
      {
        for (int j = 0; j < f.n[1]; ++j)
        {
          const double* from = points +
            Lanes *
              (all * static_cast<std::size_t>(c) +
                static_cast<std::size_t>(size[0] * (j + size[1] * k)));
          for (int i = 0; i < f.n[0]; ++i, from += Lanes, scratch += Lanes)
          {
            const Register difference = Load(from + stride) - Load(from);
            Store(scratch, difference * *scale++);
            magnitude = -Less(-magnitude, Less(difference, -difference));
          }
        }
      }
      Store(magnitudes, magnitude * static_cast<double>(p[d]));
      magnitudes += Lanes;
    }
    stride *= static_cast<std::size_t>(size[d]);
  }
  const Field cross{ scratch, { 2 * p[0] + 1, 2 * p[1], 2 * p[2] } };
  const Field& u = derivatives[0];
  const Field& v = derivatives[1];
  const Field& w = derivatives[2];
  switch (p[0])
  {
    case 1:
      return Products<1, 3>(shape, u, v, w, cross, coefficients, least, greatest);
    case 2:
      return Products<2, 6>(shape, u, v, w, cross, coefficients, least, greatest);
    case 3:
      return Products<3, 9>(shape, u, v, w, cross, coefficients, least, greatest);
    case 4:
      return Products<4, 12>(shape, u, v, w, cross, coefficients, least, greatest);
    default:
      return Products<0, 96>(shape, u, v, w, cross, coefficients, least, greatest);
  }
}

}

const DeterminantKernels HYPERPATCH_KERNELS = { HYPERPATCH_KERNELS_NAME, HYPERPATCH_LANES,
  Determinant };

}
