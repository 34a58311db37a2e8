// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_Prepared_h
#define hyperpatch_Prepared_h

#include "Aggregate.h"
#include "ControlBounds.h"
#include "Evaluator.h"

#include <memory>
#include <mutex>
#include <optional>
#include <vector>

namespace hyperpatch
{

/// A spline with what repeated work on it wants, each made when it is first asked for. Any number
/// of threads may ask.
class PreparedSpline
{
public:
  /// Keeps a reference to the spline, which must outlive it.
  explicit PreparedSpline(const hyperpatch::Spline& spline)
    : S(&spline)
  {
  }

  [[nodiscard]] const hyperpatch::Spline& Spline() const { return *this->S; }
  [[nodiscard]] const hyperpatch::Evaluator& Evaluator() const
  {
    std::call_once(this->EvaluatorOnce, [this] { this->E.emplace(*this->S); });
    return *this->E;
  }
  [[nodiscard]] const ControlBounds& Bounds() const
  {
    std::call_once(this->BoundsOnce, [this] { this->B.emplace(*this->S); });
    return *this->B;
  }

private:
  const hyperpatch::Spline* S;
  mutable std::once_flag EvaluatorOnce, BoundsOnce;
  mutable std::optional<hyperpatch::Evaluator> E;
  mutable std::optional<ControlBounds> B;
};

/// An aggregate whose geometry and attributes are prepared, to be kept between zero sets of it.
class PreparedAggregate
{
public:
  /// Keeps a reference to the aggregate, which must outlive it.
  explicit PreparedAggregate(const Aggregate& body)
    : A(&body)
    , G(std::make_shared<const PreparedSpline>(body.Geometry()))
  {
    for (const Attribute& attribute : body.Attributes())
    {
      this->F.push_back(std::make_shared<const PreparedSpline>(attribute.Field));
    }
  }

  [[nodiscard]] const Aggregate& Body() const { return *this->A; }
  [[nodiscard]] const std::shared_ptr<const PreparedSpline>& Geometry() const { return this->G; }
  /// In the order of the aggregate.
  [[nodiscard]] const std::vector<std::shared_ptr<const PreparedSpline>>& Attributes() const
  {
    return this->F;
  }

private:
  const Aggregate* A;
  std::shared_ptr<const PreparedSpline> G;
  std::vector<std::shared_ptr<const PreparedSpline>> F;
};

}

#endif
