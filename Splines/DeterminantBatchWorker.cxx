// SPDX-License-Identifier: BSD-3-Clause
#include "DeterminantBatchWorker.h"

#include "RoundingWorker.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>

namespace hyperpatch
{

using rounding::Outward;

namespace
{

std::size_t Product(const std::array<int, 3>& n)
{
  return static_cast<std::size_t>(n[0]) * static_cast<std::size_t>(n[1]) *
    static_cast<std::size_t>(n[2]);
}

std::array<int, 3> Plus(std::array<int, 3> n, int more)
{
  return { n[0] + more, n[1] + more, n[2] + more };
}

double Binomial(int n, int k)
{
  double b = 1.0;
  for (int i = 1; i <= k; ++i)
  {
    // Exact as long as the result is: the product is divisible by i.
    b = b * (n - k + i) / i;
  }
  return b;
}

/// The kernel for this processor; HYPERPATCH_INSTRUCTION_SET=baseline in the environment is
/// honoured as Evaluator does.
const DeterminantKernels* ChooseKernels()
{
#ifdef HYPERPATCH_X86
  const char* wanted = std::getenv("HYPERPATCH_INSTRUCTION_SET");
  const bool baseline = wanted && std::strcmp(wanted, DeterminantBaseline.Name) == 0;
  if (!baseline && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
  {
    return &DeterminantAVX2;
  }
#endif
  return &DeterminantBaseline;
}

/// A table of the values of products of binomials, one per index of a tensor product of degrees q.
template <class Function>
std::vector<double> Table(const std::array<int, 3>& q, const Function& value)
{
  std::vector<double> table;
  for (int k = 0; k <= q[2]; ++k)
  {
    for (int j = 0; j <= q[1]; ++j)
    {
      for (int i = 0; i <= q[0]; ++i)
      {
        table.push_back(value(Binomial(q[0], i) * Binomial(q[1], j) * Binomial(q[2], k)));
      }
    }
  }
  return table;
}
}

DeterminantBatch::DeterminantBatch(std::array<int, 3> degrees)
  : Degrees(degrees)
  , Kernels(ChooseKernels())
  , N(static_cast<std::size_t>(this->Kernels->Lanes))
{
  this->MakeTables();
  const std::array<int, 3>& p = degrees;
  this->Packed.resize(3 * Product(Plus(p, 1)) * this->N);
  std::size_t scratch = Product({ 2 * p[0] + 1, 2 * p[1], 2 * p[2] });
  for (std::size_t d = 0; d < 3; ++d)
  {
    std::array<int, 3> size = Plus(p, 1);
    --size[d];
    scratch += Product(size);
  }
  this->Scratch.resize(3 * scratch * this->N);
  this->Coefficients.resize(Product({ 3 * p[0], 3 * p[1], 3 * p[2] }) * this->N);
  this->Summary.resize(11 * this->N);
}

void DeterminantBatch::MakeTables()
{
  const std::array<int, 3>& p = this->Degrees;
  for (std::size_t d = 0; d < 3; ++d)
  {
    this->Shape.Degrees[d] = p[d];
    std::array<int, 3> q = p;
    --q[d];
    this->Scales[d] = Table(q, [&](double binomials) { return p[d] * binomials; });
    this->Shape.Scales[d] = this->Scales[d].data();
  }
  this->Unscale = Table(
    { 3 * p[0] - 1, 3 * p[1] - 1, 3 * p[2] - 1 }, [](double binomials) { return 1.0 / binomials; });
  this->Shape.Unscale = this->Unscale.data();
  // Binomials are exact up to row 50, above that they round twice per factor. A table entry is a
  // product of three of them and a degree. Each of three factors: difference, scaling, table.
  // Sums: at most all pairs, twice for a minor, thrice for the determinant. Then unscaling.
  const int row = 3 * *std::max_element(p.begin(), p.end()) - 1;
  const double table = 3 + (row > 50 ? 3 * 2 * row : 0);
  const double minor = 2.0 * static_cast<double>(Product({ p[0] + 1, p[1], p[2] })) + 1;
  const double sum = 3.0 * static_cast<double>(Product({ p[0], p[1] + 1, p[2] + 1 })) + 1;
  this->Gamma = rounding::Gamma(3 * (2 + table) + minor + sum + 2 + table);
}

void DeterminantBatch::operator()(std::size_t count, const double* const* points)
{
  const std::size_t n = Product(Plus(this->Degrees, 1));
  for (std::size_t lane = 0; lane < this->N; ++lane)
  {
    // Lanes that are left over repeat the first element.
    const double* from = points[lane < count ? lane : 0];
    for (std::size_t i = 0; i < n; ++i)
    {
      for (std::size_t c = 0; c < 3; ++c)
      {
        this->Packed[(c * n + i) * this->N + lane] = from[3 * i + c];
      }
    }
  }
  double* summary = this->Summary.data();
  this->Kernels->Determinant(this->Shape, this->Packed.data(), this->Scratch.data(),
    this->Coefficients.data(), summary, summary + this->N, summary + 2 * this->N);
}

void DeterminantBatch::Copy(std::size_t lane, double* coefficients) const
{
  const std::size_t n = this->Coefficients.size() / this->N;
  for (std::size_t i = 0; i < n; ++i)
  {
    coefficients[i] = this->Coefficients[i * this->N + lane];
  }
}

double DeterminantBatch::Error(std::size_t lane, double pointError) const
{
  // Coefficients are means of determinants of derivative coefficients with weights that sum to 1,
  // so that the permanent of the greatest magnitudes bounds them and their terms.
  double m[3][3];
  double e[3];
  for (std::size_t d = 0; d < 3; ++d)
  {
    e[d] = 2.0 * this->Degrees[d] * pointError;
    for (std::size_t c = 0; c < 3; ++c)
    {
      m[d][c] = this->Summary[(2 + 3 * d + c) * this->N + lane] * Outward + e[d];
    }
  }
  const auto permanent = [&m](std::size_t a, std::size_t b, const double* x)
  {
    return x[0] * (m[a][1] * m[b][2] + m[a][2] * m[b][1]) +
      x[1] * (m[a][2] * m[b][0] + m[a][0] * m[b][2]) +
      x[2] * (m[a][0] * m[b][1] + m[a][1] * m[b][0]);
  };
  double error = this->Gamma * permanent(1, 2, m[0]);
  for (std::size_t d = 0; pointError > 0.0 && d < 3; ++d)
  {
    const double moved[3] = { e[d], e[d], e[d] };
    error += permanent((d + 1) % 3, (d + 2) % 3, moved);
  }
  return error * Outward;
}
}
