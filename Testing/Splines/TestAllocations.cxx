// SPDX-License-Identifier: BSD-3-Clause

// Counts the allocations of the whole test program.

#include "Evaluator.h"
#include "JacobianSign.h"
#include "Operators.h"
#include "Splines/Models.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

using namespace hyperpatch;

namespace
{
std::atomic<long> Allocations{ 0 };
}

[[gnu::noinline]] void* operator new(std::size_t size)
{
  ++Allocations;
  if (void* memory = std::malloc(size > 0 ? size : 1))
  {
    return memory;
  }
  throw std::bad_alloc();
}

[[gnu::noinline]] void operator delete(void* memory) noexcept
{
  std::free(memory);
}

[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept
{
  std::free(memory);
}

namespace
{

template <class Work>
long CountAllocations(const Work& work)
{
  const long before = Allocations;
  work();
  return Allocations - before;
}

struct Case
{
  int Degree;
  int Components;
};

class EvaluatorAllocations : public testing::TestWithParam<Case>
{
};

INSTANTIATE_TEST_SUITE_P(SmallAndLarge, EvaluatorAllocations,
  testing::Values(Case{ 3, 3 }, Case{ 9, 1 }, Case{ 5, 100 }),
  [](const testing::TestParamInfo<Case>& test)
  { return "Degree" + std::to_string(test.param.Degree); });

}

TEST_P(EvaluatorAllocations, AreNotPerPoint)
{
  std::mt19937 random(1);
  const auto [degree, m] = GetParam();
  const KnotVector knots = models::RandomKnots(random, degree, degree + 3, true);
  const Evaluator evaluator(models::RandomSpline(random, { knots, knots, knots }, m, true));
  const std::size_t largest = m > 10 ? 1000 : 100000;
  const std::vector<double> parameters(3 * largest, 0.4);
  const auto components = static_cast<std::size_t>(m);
  std::vector<double> values(components * largest);
  std::vector<double> first(3 * components * largest);
  std::vector<double> second(6 * components * largest);
  long counts[2];
  for (int i = 0; i < 2; ++i)
  {
    const std::size_t n = i == 0 ? 10 : largest;
    counts[i] = CountAllocations(
      [&]
      {
        evaluator.Evaluate(n, parameters.data(), values.data());
        evaluator.EvaluateWithDerivatives(n, parameters.data(), values.data(), first.data());
        evaluator.EvaluateWithSecondDerivatives(
          n, parameters.data(), values.data(), first.data(), second.data());
      });
  }
  EXPECT_EQ(counts[0], counts[1]);
  // A point of few components needs none at all.
  EXPECT_EQ(counts[0] == 0, m < 10);

  for (int i = 0; i < 2; ++i)
  {
    const std::size_t side = i == 0 ? 2 : 9;
    const std::array<std::vector<double>, 3> lists{ std::vector<double>(side, 0.3),
      std::vector<double>(side, 0.4), std::vector<double>(side, 0.5) };
    counts[i] = CountAllocations(
      [&]
      {
        evaluator.EvaluateGrid(lists, values.data());
        evaluator.EvaluateGrid(lists, values.data(), first.data());
      });
  }
  EXPECT_EQ(counts[0], counts[1]);
  EXPECT_LE(counts[0], 4);
}

TEST(JacobianSignAllocations, AreNone)
{
  const Spline tube = RefineUniformly(models::QuarterTube(), { 4, 4, 4 });
  for (const bool rational : { false, true })
  {
    const Spline s(
      tube.Knots(), tube.Coefficients(), rational ? tube.Weights() : Eigen::VectorXd());
    int sign = 0;
    EXPECT_EQ(CountAllocations([&] { sign = JacobianSign(s, { { 0, 0.5, 0 }, { 1, 1, 1 } }); }), 0);
    EXPECT_EQ(sign, 1);
  }
}
