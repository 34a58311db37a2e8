// SPDX-License-Identifier: BSD-3-Clause
#include "Error.h"
#include "Splines/Models.h"

#include <gtest/gtest.h>

#include <algorithm>

using namespace hyperpatch;

TEST(KnotVector, PartitionOfUnityAndClosedDomain)
{
  std::mt19937 random(1);
  for (int degree = 1; degree <= 15; ++degree)
  {
    for (bool clamped : { true, false })
    {
      const KnotVector knots = models::RandomKnots(random, degree, degree + 6, clamped);
      for (int i = 0; i <= 50; ++i)
      {
        // Not an ulp beyond the end, where basis functions are negative.
        const double u =
          std::min(knots.Last(), knots.First() + (knots.Last() - knots.First()) * i / 50);
        double values[2 * (MaxDegree + 1)];
        knots.BasisDerivatives(knots.FindSpan(u), u, 1, values);
        double sum = 0.0;
        double derivative = 0.0;
        for (int j = 0; j <= degree; ++j)
        {
          EXPECT_GE(values[j], -1e-15);
          sum += values[j];
          derivative += values[degree + 1 + j];
        }
        EXPECT_NEAR(sum, 1.0, 1e-14);
        EXPECT_NEAR(derivative, 0.0, 1e-11);
      }
    }
  }
}

TEST(KnotVector, RefusesWhatIsNotOne)
{
  EXPECT_THROW(KnotVector(2, { 0, 0, 0, 1, 0.5, 1 }), Error);
  EXPECT_THROW(KnotVector(2, { 0, 0, 0, 1, 1 }), Error);
  EXPECT_THROW(KnotVector(1, { 0, 0, 0.5, 0.5, 1, 1 }), Error);
  EXPECT_THROW(KnotVector(1, { 0, 0, 0, 0 }), Error);
  EXPECT_THROW(KnotVector(1, { 0, 0, NAN, 1 }), Error);
  EXPECT_NO_THROW(KnotVector(2, { 0, 0, 0, 0.5, 0.5, 1, 1, 1 }));
}
