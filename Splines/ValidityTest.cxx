// SPDX-License-Identifier: BSD-3-Clause
#include "ValidityTest.h"

#include "Bernstein.h"
#include "DeterminantBatchWorker.h"
#include "DeterminantSubdivisionWorker.h"
#include "Error.h"
#include "EvaluatorKernel.h"
#include "KnotVector.h"

#include <algorithm>
#include <string>

namespace hyperpatch
{

void ElementValidity::Certify(int sign, Certificate by)
{
  this->Verdict = 1;
  this->Sign = sign;
  this->By = by;
  (sign > 0 ? this->Positive : this->Negative) = { 0.5, 0.5, 0.5 };
}

struct ValidityTest::Implementation
{
  Implementation(std::array<int, 3> degrees, bool rational, const ValidityOptions& options)
    : Degrees(degrees)
    , Rational(rational)
    , Options(options)
    , NumberOfPoints(static_cast<std::size_t>(degrees[0] + 1) *
        static_cast<std::size_t>(degrees[1] + 1) * static_cast<std::size_t>(degrees[2] + 1))
    , Subdivision(degrees, rational, options)
    , Batch(rational ? nullptr : std::make_unique<DeterminantBatch>(degrees))
  {
  }

  /// The sign by cones alone. Vectors that are zero to rounding leave it to the coefficients, which
  /// tell where the element is degenerate.
  int SignByCones(const Eigen::MatrixXd& points, double pointError) const
  {
    Cone cones[3];
    for (int d = 0; d < 3; ++d)
    {
      cones[d] = DerivativeCone(points, this->Degrees, d, pointError);
      if (cones[d].IsEverything() || cones[d].ZeroVectors() > 0)
      {
        return 0;
      }
    }
    return TripleProductSign(cones[0], cones[1], cones[2]);
  }

  void Polynomial(
    std::size_t count, const double* points, const double* pointErrors, ElementValidity* results)
  {
    DeterminantBatch& batch = *this->Batch;
    const std::size_t lanes = batch.Lanes();
    const std::size_t n = this->NumberOfPoints;
    std::array<const double*, MaxLanes> waiting{};
    std::array<std::size_t, MaxLanes> number{};
    std::size_t filled = 0;
    for (std::size_t e = 0; e < count; ++e)
    {
      results[e] = ElementValidity();
      const double error = pointErrors ? pointErrors[e] : 0.0;
      int sign = 0;
      if (this->Options.Tolerance == 0.0)
      {
        this->Element =
          Eigen::Map<const Eigen::MatrixXd>(points + 3 * n * e, 3, static_cast<Eigen::Index>(n));
        sign = this->SignByCones(this->Element, error);
      }
      if (sign != 0)
      {
        results[e].Certify(sign, Certificate::Cones);
      }
      else
      {
        waiting[filled] = points + 3 * n * e;
        number[filled++] = e;
      }
      if (filled == lanes || (e + 1 == count && filled > 0))
      {
        batch(filled, waiting.data());
        for (std::size_t lane = 0; lane < filled; ++lane)
        {
          const std::size_t i = number[lane];
          const double bound = batch.Error(lane, pointErrors ? pointErrors[i] : 0.0);
          const double least = batch.Least(lane);
          const double greatest = batch.Greatest(lane);
          results[i].Boxes = 1;
          if (this->Options.Tolerance == 0.0 && (least > bound || greatest < -bound))
          {
            results[i].Certify(least > 0.0 ? 1 : -1, Certificate::Bernstein);
            continue;
          }
          batch.Copy(lane, this->Subdivision.Coefficients());
          this->Subdivision(bound, 0.0, results[i]);
        }
        filled = 0;
      }
    }
  }

  void RationalElement(const double* points, double pointError, ElementValidity& result)
  {
    result = ElementValidity();
    const auto n = static_cast<Eigen::Index>(this->NumberOfPoints);
    this->Element = Eigen::Map<const Eigen::MatrixXd>(points, 4, n);
    if (!(this->Element.row(3).minCoeff() > pointError))
    {
      throw Error("the sign of det J needs positive weights; the least is " +
        std::to_string(this->Element.row(3).minCoeff()));
    }
    if (this->Options.Tolerance == 0.0)
    {
      if (const int sign = this->SignByCones(this->Element, pointError))
      {
        result.Certify(sign, Certificate::Cones);
        return;
      }
    }
    const Bernstein w(this->Degrees, this->Element.row(3).transpose(), pointError);
    const Bernstein w2 = w * w;
    const Bernstein w4 = w2 * w2;
    Bernstein j = JacobianDeterminant(this->Element, this->Degrees, true, pointError);
    for (int d = 0; d < 3; ++d)
    {
      j = j.Elevate(d, 4 * this->Degrees[static_cast<std::size_t>(d)]);
    }
    std::copy(w4.Coefficients().begin(), w4.Coefficients().end(),
      std::copy(
        j.Coefficients().begin(), j.Coefficients().end(), this->Subdivision.Coefficients()));
    result.Boxes = 1;
    this->Subdivision(j.RoundingBound(), w4.RoundingBound(), result);
  }

  std::array<int, 3> Degrees;
  bool Rational;
  ValidityOptions Options;
  std::size_t NumberOfPoints;
  Eigen::MatrixXd Element;
  DeterminantSubdivision Subdivision;
  std::unique_ptr<DeterminantBatch> Batch;
};

ValidityTest::ValidityTest(
  std::array<int, 3> degrees, bool rational, const ValidityOptions& options)
{
  for (int p : degrees)
  {
    if (p < 1 || p > MaxDegree)
    {
      throw Error("det J needs degrees from 1 to " + std::to_string(MaxDegree) + ", not " +
        std::to_string(p));
    }
  }
  if (!(options.Tolerance >= 0.0 && options.Tolerance <= 1.0))
  {
    throw Error("the tolerance of validity bounds is a fraction from 0 to 1, not " +
      std::to_string(options.Tolerance));
  }
  if (!(options.ScaledTolerance >= 0.0))
  {
    throw Error("the tolerance of the scaled Jacobian is not negative, and 0 to leave it out");
  }
  if (options.MaxDepth < 0 || options.MaxBoxes < 1 || options.MaxScaledBoxes < 1)
  {
    throw Error("a validity test needs a depth of at least 0 and at least 1 box");
  }
  this->I = std::make_unique<Implementation>(degrees, rational, options);
}

ValidityTest::~ValidityTest() = default;
ValidityTest::ValidityTest(ValidityTest&&) noexcept = default;
ValidityTest& ValidityTest::operator=(ValidityTest&&) noexcept = default;

void ValidityTest::operator()(
  std::size_t count, const double* points, const double* pointErrors, ElementValidity* results)
{
  if (!this->I->Rational)
  {
    this->I->Polynomial(count, points, pointErrors, results);
    return;
  }
  for (std::size_t e = 0; e < count; ++e)
  {
    this->I->RationalElement(
      points + 4 * this->I->NumberOfPoints * e, pointErrors ? pointErrors[e] : 0.0, results[e]);
  }
}

}
