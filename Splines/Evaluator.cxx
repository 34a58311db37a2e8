// SPDX-License-Identifier: BSD-3-Clause
#include "Evaluator.h"

#include <algorithm>
#include <utility>

namespace hyperpatch
{

struct Evaluator::Layout
{
  std::array<KnotVector, 3> Knots;
  std::array<int, 3> Sizes;
  Eigen::MatrixXd Homogeneous;
  int Components;
  bool Rational;
};

namespace
{
// Quotient rule for a rational value with derivatives, from homogeneous sums; rows of `h` are
// value, u, v, w, uu, uv, uw, vv, vw, ww, each of m + 1 numbers.
constexpr int SecondOf[6][2] = { { 1, 1 }, { 1, 2 }, { 1, 3 }, { 2, 2 }, { 2, 3 }, { 3, 3 } };
}

Evaluator::Evaluator(const Spline& spline)
  : L(std::make_unique<const Layout>(Layout{ spline.Knots(), spline.Sizes(), spline.Homogeneous(),
      spline.Components(), spline.IsRational() }))
{
}

Evaluator::~Evaluator() = default;
Evaluator::Evaluator(Evaluator&&) noexcept = default;
Evaluator& Evaluator::operator=(Evaluator&&) noexcept = default;

int Evaluator::Components() const
{
  return this->L->Components;
}

void Evaluator::Evaluate(std::size_t count, const double* parameters, double* values) const
{
  this->EvaluateWithSecondDerivatives(count, parameters, values, nullptr, nullptr);
}

void Evaluator::EvaluateWithDerivatives(
  std::size_t count, const double* parameters, double* values, double* derivatives) const
{
  this->EvaluateWithSecondDerivatives(count, parameters, values, derivatives, nullptr);
}

void Evaluator::EvaluateWithSecondDerivatives(std::size_t count, const double* parameters,
  double* values, double* derivatives, double* second) const
{
  const Layout& l = *this->L;
  const int order = second ? 2 : derivatives ? 1 : 0;
  const int rows = order == 2 ? 10 : order == 1 ? 4 : 1;
  const int m = l.Components;
  const auto n = static_cast<int>(l.Homogeneous.rows());
  static constexpr int Orders[10][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 },
    { 2, 0, 0 }, { 1, 1, 0 }, { 1, 0, 1 }, { 0, 2, 0 }, { 0, 1, 1 }, { 0, 0, 2 } };
  std::vector<double> sums(static_cast<std::size_t>(rows * n));
  double basis[3][3 * (MaxDegree + 1)];
  for (std::size_t q = 0; q < count; ++q)
  {
    int first[3];
    int p[3];
    for (int d = 0; d < 3; ++d)
    {
      const KnotVector& k = l.Knots[static_cast<std::size_t>(d)];
      const double t =
        std::clamp(parameters[3 * q + static_cast<std::size_t>(d)], k.First(), k.Last());
      const int span = k.FindSpan(t);
      p[d] = k.Degree();
      first[d] = span - p[d];
      k.BasisDerivatives(span, t, order, basis[d]);
    }
    std::fill(sums.begin(), sums.end(), 0.0);
    for (int c = 0; c <= p[2]; ++c)
    {
      for (int b = 0; b <= p[1]; ++b)
      {
        for (int a = 0; a <= p[0]; ++a)
        {
          const double* point = l.Homogeneous.data() +
            n *
              (first[0] + a +
                static_cast<Eigen::Index>(l.Sizes[0]) *
                  (first[1] + b + static_cast<Eigen::Index>(l.Sizes[1]) * (first[2] + c)));
          for (int r = 0; r < rows; ++r)
          {
            const double weight = basis[0][Orders[r][0] * (p[0] + 1) + a] *
              basis[1][Orders[r][1] * (p[1] + 1) + b] * basis[2][Orders[r][2] * (p[2] + 1) + c];
            for (int e = 0; e < n; ++e)
            {
              sums[static_cast<std::size_t>(r * n + e)] += weight * point[e];
            }
          }
        }
      }
    }
    const double* h = sums.data();
    const auto M = static_cast<std::size_t>(m);
    for (int e = 0; e < m; ++e)
    {
      const auto E = static_cast<std::size_t>(e);
      const double inverse = l.Rational ? 1.0 / h[m] : 1.0;
      const double value = h[e] * inverse;
      values[q * M + E] = value;
      double first1[4] = { value, 0, 0, 0 };
      for (int r = 1; r < 4 && order > 0; ++r)
      {
        const double dw = l.Rational ? h[r * n + m] : 0.0;
        first1[r] = (h[r * n + e] - value * dw) * inverse;
        derivatives[q * 3 * M + static_cast<std::size_t>(r - 1) * M + E] = first1[r];
      }
      for (int r = 4; r < rows; ++r)
      {
        const int i = SecondOf[r - 4][0];
        const int j = SecondOf[r - 4][1];
        double numerator = h[r * n + e];
        if (l.Rational)
        {
          numerator -= value * h[r * n + m] + first1[i] * h[j * n + m] + first1[j] * h[i * n + m];
        }
        second[q * 6 * M + static_cast<std::size_t>(r - 4) * M + E] = numerator * inverse;
      }
    }
  }
}

void Evaluator::EvaluateGrid(
  const std::array<std::vector<double>, 3>& parameters, double* values, double* derivatives) const
{
  const auto m = static_cast<std::size_t>(this->L->Components);
  std::size_t q = 0;
  for (double w : parameters[2])
  {
    for (double v : parameters[1])
    {
      for (double u : parameters[0])
      {
        const double point[3] = { u, v, w };
        this->EvaluateWithSecondDerivatives(
          1, point, values + q * m, derivatives ? derivatives + q * 3 * m : nullptr, nullptr);
        ++q;
      }
    }
  }
}

}
