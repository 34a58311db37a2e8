// SPDX-License-Identifier: BSD-3-Clause

// The calibration: a rational cubic volume of 20^3 control points, open uniform knots. Beside
// Evaluator, in the same run, a plain loop as The NURBS Book writes it, so that every figure is a
// ratio.

#include "Evaluator.h"

#include <benchmark/benchmark.h>

#include <algorithm>
#include <random>

using namespace hyperpatch;

namespace
{

constexpr int Size = 20;
constexpr std::size_t Points = 1000000;
constexpr std::size_t Side = 100;

const Spline& Volume()
{
  static const Spline volume = []
  {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> jitter(-0.2, 0.2);
    std::uniform_real_distribution<double> weight(0.5, 2.0);
    Eigen::MatrixXd points(3, Size * Size * Size);
    Eigen::VectorXd weights(points.cols());
    for (Eigen::Index i = 0; i < points.cols(); ++i)
    {
      points.col(i) << static_cast<double>(i % Size) + jitter(random),
        static_cast<double>(i / Size % Size) + jitter(random),
        static_cast<double>(i / (Size * Size)) + jitter(random);
      weights[i] = weight(random);
    }
    const KnotVector knots = KnotVector::Uniform(3, Size);
    return Spline({ knots, knots, knots }, points, weights);
  }();
  return volume;
}

const std::vector<double>& RandomParameters()
{
  static const std::vector<double> parameters = []
  {
    std::mt19937 random(2);
    std::uniform_real_distribution<double> parameter(0.0, 1.0);
    std::vector<double> numbers(3 * Points);
    std::generate(numbers.begin(), numbers.end(), [&] { return parameter(random); });
    return numbers;
  }();
  return parameters;
}

std::vector<double> GridParameters()
{
  std::vector<double> parameters(Side);
  for (std::size_t i = 0; i < Side; ++i)
  {
    parameters[i] = static_cast<double>(i) / (Side - 1);
  }
  return parameters;
}

// What a good engineer writes in an hour with the book open: fixed degree 3, homogeneous control
// points of four numbers.
class PlainLoop
{
public:
  explicit PlainLoop(const Spline& spline)
    : Knots(spline.Knots(0).Knots())
    , Points(static_cast<std::size_t>(4 * spline.NumberOfControlPoints()))
  {
    const Eigen::MatrixXd homogeneous = spline.Homogeneous();
    std::copy(homogeneous.data(), homogeneous.data() + homogeneous.size(), this->Points.begin());
  }

  // A2.1.
  int FindSpan(double u) const
  {
    if (u >= this->Knots[Size])
    {
      return Size - 1;
    }
    int low = 3;
    int high = Size;
    int middle = (low + high) / 2;
    while (u < this->Knots[static_cast<std::size_t>(middle)] ||
      u >= this->Knots[static_cast<std::size_t>(middle) + 1])
    {
      (u < this->Knots[static_cast<std::size_t>(middle)] ? high : low) = middle;
      middle = (low + high) / 2;
    }
    return middle;
  }

  // A2.2.
  void Basis(int span, double u, double* n) const
  {
    const double* knots = this->Knots.data() + span;
    double left[4];
    double right[4];
    n[0] = 1.0;
    for (int j = 1; j <= 3; ++j)
    {
      left[j] = u - knots[1 - j];
      right[j] = knots[j] - u;
      double saved = 0.0;
      for (int r = 0; r < j; ++r)
      {
        const double scaled = n[r] / (right[r + 1] + left[j - r]);
        n[r] = saved + right[r + 1] * scaled;
        saved = left[j - r] * scaled;
      }
      n[j] = saved;
    }
  }

  // A2.3 for the first derivative: the differences of the basis functions of degree 2.
  void BasisDerivatives(int span, double u, double* n, double* derivatives) const
  {
    const double* knots = this->Knots.data() + span;
    double left[4];
    double right[4];
    n[0] = 1.0;
    for (int j = 1; j <= 3; ++j)
    {
      left[j] = u - knots[1 - j];
      right[j] = knots[j] - u;
      double saved = 0.0;
      double before = 0.0;
      for (int r = 0; r < j; ++r)
      {
        const double scaled = n[r] / (right[r + 1] + left[j - r]);
        if (j == 3)
        {
          derivatives[r] = before - 3.0 * scaled;
          before = 3.0 * scaled;
        }
        n[r] = saved + right[r + 1] * scaled;
        saved = left[j - r] * scaled;
      }
      n[j] = saved;
      derivatives[3] = before;
    }
  }

  void Evaluate(const double* parameters, double* value) const
  {
    int span[3];
    double n[3][4];
    for (int d = 0; d < 3; ++d)
    {
      span[d] = this->FindSpan(parameters[d]);
      this->Basis(span[d], parameters[d], n[d]);
    }
    double sum[4] = {};
    for (int c = 0; c < 4; ++c)
    {
      double line[4] = {};
      for (int b = 0; b < 4; ++b)
      {
        double row[4] = {};
        const double* point = this->Row(span, b, c);
        for (int a = 0; a < 4; ++a)
        {
          for (int e = 0; e < 4; ++e)
          {
            row[e] += n[0][a] * point[4 * a + e];
          }
        }
        for (int e = 0; e < 4; ++e)
        {
          line[e] += n[1][b] * row[e];
        }
      }
      for (int e = 0; e < 4; ++e)
      {
        sum[e] += n[2][c] * line[e];
      }
    }
    for (int e = 0; e < 3; ++e)
    {
      value[e] = sum[e] / sum[3];
    }
  }

  void EvaluateWithDerivatives(const double* parameters, double* value, double* derivatives) const
  {
    int span[3];
    double n[3][4];
    double g[3][4];
    for (int d = 0; d < 3; ++d)
    {
      span[d] = this->FindSpan(parameters[d]);
      this->BasisDerivatives(span[d], parameters[d], n[d], g[d]);
    }
    double sum[4][4] = {};
    for (int c = 0; c < 4; ++c)
    {
      double line[3][4] = {};
      for (int b = 0; b < 4; ++b)
      {
        double row[2][4] = {};
        const double* point = this->Row(span, b, c);
        for (int a = 0; a < 4; ++a)
        {
          for (int e = 0; e < 4; ++e)
          {
            row[0][e] += n[0][a] * point[4 * a + e];
            row[1][e] += g[0][a] * point[4 * a + e];
          }
        }
        for (int e = 0; e < 4; ++e)
        {
          line[0][e] += n[1][b] * row[0][e];
          line[1][e] += n[1][b] * row[1][e];
          line[2][e] += g[1][b] * row[0][e];
        }
      }
      for (int e = 0; e < 4; ++e)
      {
        sum[0][e] += n[2][c] * line[0][e];
        sum[1][e] += n[2][c] * line[1][e];
        sum[2][e] += n[2][c] * line[2][e];
        sum[3][e] += g[2][c] * line[0][e];
      }
    }
    const double inverse = 1.0 / sum[0][3];
    for (int e = 0; e < 3; ++e)
    {
      value[e] = sum[0][e] * inverse;
      for (int d = 0; d < 3; ++d)
      {
        derivatives[3 * d + e] = (sum[d + 1][e] - value[e] * sum[d + 1][3]) * inverse;
      }
    }
  }

  // Contracts w for a plane, v for a line, u for the points.
  void Grid(const std::vector<double>& parameters, double* values) const
  {
    const std::size_t count = parameters.size();
    std::vector<int> span(count);
    std::vector<std::array<double, 4>> n(count);
    for (std::size_t i = 0; i < count; ++i)
    {
      span[i] = this->FindSpan(parameters[i]);
      this->Basis(span[i], parameters[i], n[i].data());
    }
    std::vector<double> plane(4 * Size * Size);
    std::vector<double> line(4 * Size);
    for (std::size_t k = 0; k < count; ++k)
    {
      const double* from = this->Points.data() + 4 * Size * Size * (span[k] - 3);
      for (std::size_t i = 0; i < plane.size(); ++i)
      {
        plane[i] = n[k][0] * from[i] + n[k][1] * from[i + 4 * Size * Size] +
          n[k][2] * from[i + 8 * Size * Size] + n[k][3] * from[i + 12 * Size * Size];
      }
      for (std::size_t j = 0; j < count; ++j)
      {
        const double* row = plane.data() + 4 * Size * (span[j] - 3);
        for (std::size_t i = 0; i < line.size(); ++i)
        {
          line[i] = n[j][0] * row[i] + n[j][1] * row[i + 4 * Size] + n[j][2] * row[i + 8 * Size] +
            n[j][3] * row[i + 12 * Size];
        }
        for (std::size_t i = 0; i < count; ++i)
        {
          const double* point = line.data() + 4 * (span[i] - 3);
          double sum[4];
          for (int e = 0; e < 4; ++e)
          {
            sum[e] = n[i][0] * point[e] + n[i][1] * point[4 + e] + n[i][2] * point[8 + e] +
              n[i][3] * point[12 + e];
          }
          const double inverse = 1.0 / sum[3];
          values[0] = sum[0] * inverse;
          values[1] = sum[1] * inverse;
          values[2] = sum[2] * inverse;
          values += 3;
        }
      }
    }
  }

private:
  const double* Row(const int* span, int b, int c) const
  {
    return this->Points.data() +
      4 * (span[0] - 3 + Size * (span[1] - 3 + b + Size * (span[2] - 3 + c)));
  }

  std::vector<double> Knots;
  std::vector<double> Points;
};

void SetRate(benchmark::State& state)
{
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(Points));
}

void PositionPlainLoop(benchmark::State& state)
{
  const PlainLoop loop(Volume());
  const double* parameters = RandomParameters().data();
  std::vector<double> values(3 * Points);
  for (auto _ : state)
  {
    for (std::size_t q = 0; q < Points; ++q)
    {
      loop.Evaluate(parameters + 3 * q, values.data() + 3 * q);
    }
    benchmark::ClobberMemory();
  }
  SetRate(state);
}

void Position(benchmark::State& state)
{
  const Evaluator evaluator(Volume());
  const double* parameters = RandomParameters().data();
  std::vector<double> values(3 * Points);
  for (auto _ : state)
  {
    evaluator.Evaluate(Points, parameters, values.data());
    benchmark::ClobberMemory();
  }
  SetRate(state);
}

// In calls of a few points, as Newton iterations make them.
void PositionOneByOne(benchmark::State& state)
{
  const Evaluator evaluator(Volume());
  const double* parameters = RandomParameters().data();
  std::vector<double> values(3 * Points);
  for (auto _ : state)
  {
    for (std::size_t q = 0; q < Points; ++q)
    {
      evaluator.Evaluate(1, parameters + 3 * q, values.data() + 3 * q);
    }
    benchmark::ClobberMemory();
  }
  SetRate(state);
}

void PositionAndJacobianPlainLoop(benchmark::State& state)
{
  const PlainLoop loop(Volume());
  const double* parameters = RandomParameters().data();
  std::vector<double> values(3 * Points);
  std::vector<double> derivatives(9 * Points);
  for (auto _ : state)
  {
    for (std::size_t q = 0; q < Points; ++q)
    {
      loop.EvaluateWithDerivatives(
        parameters + 3 * q, values.data() + 3 * q, derivatives.data() + 9 * q);
    }
    benchmark::ClobberMemory();
  }
  SetRate(state);
}

void PositionAndJacobian(benchmark::State& state)
{
  const Evaluator evaluator(Volume());
  const double* parameters = RandomParameters().data();
  std::vector<double> values(3 * Points);
  std::vector<double> derivatives(9 * Points);
  for (auto _ : state)
  {
    evaluator.EvaluateWithDerivatives(Points, parameters, values.data(), derivatives.data());
    benchmark::ClobberMemory();
  }
  SetRate(state);
}

void SecondDerivatives(benchmark::State& state)
{
  const Evaluator evaluator(Volume());
  const double* parameters = RandomParameters().data();
  std::vector<double> values(3 * Points);
  std::vector<double> derivatives(9 * Points);
  std::vector<double> second(18 * Points);
  for (auto _ : state)
  {
    evaluator.EvaluateWithSecondDerivatives(
      Points, parameters, values.data(), derivatives.data(), second.data());
    benchmark::ClobberMemory();
  }
  SetRate(state);
}

void GridPlainLoop(benchmark::State& state)
{
  const PlainLoop loop(Volume());
  const std::vector<double> parameters = GridParameters();
  std::vector<double> values(3 * Points);
  for (auto _ : state)
  {
    loop.Grid(parameters, values.data());
    benchmark::ClobberMemory();
  }
  SetRate(state);
}

void Grid(benchmark::State& state)
{
  const Evaluator evaluator(Volume());
  const std::array<std::vector<double>, 3> parameters{ GridParameters(), GridParameters(),
    GridParameters() };
  std::vector<double> values(3 * Points);
  for (auto _ : state)
  {
    evaluator.EvaluateGrid(parameters, values.data());
    benchmark::ClobberMemory();
  }
  SetRate(state);
}

void GridWithDerivatives(benchmark::State& state)
{
  const Evaluator evaluator(Volume());
  const std::array<std::vector<double>, 3> parameters{ GridParameters(), GridParameters(),
    GridParameters() };
  std::vector<double> values(3 * Points);
  std::vector<double> derivatives(9 * Points);
  for (auto _ : state)
  {
    evaluator.EvaluateGrid(parameters, values.data(), derivatives.data());
    benchmark::ClobberMemory();
  }
  SetRate(state);
}

BENCHMARK(PositionPlainLoop)->Unit(benchmark::kMillisecond)->MinTime(0.3);
BENCHMARK(Position)->Unit(benchmark::kMillisecond)->MinTime(0.3);
BENCHMARK(PositionOneByOne)->Unit(benchmark::kMillisecond)->MinTime(0.3);
BENCHMARK(PositionAndJacobianPlainLoop)->Unit(benchmark::kMillisecond)->MinTime(0.3);
BENCHMARK(PositionAndJacobian)->Unit(benchmark::kMillisecond)->MinTime(0.3);
BENCHMARK(SecondDerivatives)->Unit(benchmark::kMillisecond)->MinTime(0.3);
BENCHMARK(GridPlainLoop)->Unit(benchmark::kMillisecond)->MinTime(0.3);
BENCHMARK(Grid)->Unit(benchmark::kMillisecond)->MinTime(0.3);
BENCHMARK(GridWithDerivatives)->Unit(benchmark::kMillisecond)->MinTime(0.3);

}
