// SPDX-License-Identifier: BSD-3-Clause
#include "BendBounds.h"

#include "BezierExtractor.h"
#include "ChordBound.h"

#include <algorithm>
#include <utility>

namespace hyperpatch
{

BendBounds::BendBounds(const Aggregate& body, std::vector<bool> isMeasured,
  const std::array<std::vector<double>, 3>& more)
  : Body(&body)
  , IsMeasured(std::move(isMeasured))
{
  std::vector<const Spline*> splines{ &body.Geometry() };
  for (std::size_t a = 0; a < body.Attributes().size(); ++a)
  {
    const Spline& field = body.Attributes()[a].Field;
    splines.push_back(&field);
    this->Count += this->IsMeasured[a] ? static_cast<std::size_t>(field.Components()) : 0;
  }
  std::size_t elements = 1;
  for (std::size_t d = 0; d < 3; ++d)
  {
    this->A[d] = MakeElementAxis(splines, static_cast<int>(d), more[d]);
    elements *= static_cast<std::size_t>(this->A[d].Cells());
  }
  this->Slots.assign(elements, -1);
}

void BendBounds::Find(const std::vector<int>& elements, const std::vector<double>& tolerances,
  const ParallelFor& parallel)
{
  for (const int element : elements)
  {
    std::int32_t& slot = this->Slots[static_cast<std::size_t>(element)];
    if (slot < 0)
    {
      slot = static_cast<std::int32_t>(this->IsTight.size());
      this->IsTight.push_back(-1);
    }
  }
  this->Bends.resize(this->Count * this->IsTight.size());
  const std::array<int, 3> cells{ this->A[0].Cells(), this->A[1].Cells(), this->A[2].Cells() };

  parallel(static_cast<std::ptrdiff_t>(elements.size()), 32,
    [&](std::ptrdiff_t begin, std::ptrdiff_t end)
    {
      ChordBound bound;
      Eigen::MatrixXd points;
      for (std::ptrdiff_t i = begin; i < end; ++i)
      {
        const int element = elements[static_cast<std::size_t>(i)];
        const auto slot = static_cast<std::size_t>(this->Slots[static_cast<std::size_t>(element)]);
        Bend* const bends = &this->Bends[this->Count * slot];
        const std::array<int, 3> cell{ element % cells[0], element / cells[0] % cells[1],
          element / (cells[0] * cells[1]) };
        std::array<double, 3> low{};
        std::array<double, 3> high{};
        for (std::size_t d = 0; d < 3; ++d)
        {
          low[d] = this->A[d].Breaks[static_cast<std::size_t>(cell[d])];
          high[d] = this->A[d].Breaks[static_cast<std::size_t>(cell[d]) + 1];
        }
        const auto find = [&](int halvings)
        {
          Bend* bend = bends;
          for (std::size_t s = 0; s <= this->IsMeasured.size(); ++s)
          {
            if (s > 0 && !this->IsMeasured[s - 1])
            {
              continue;
            }
            const Spline& spline =
              s == 0 ? this->Body->Geometry() : this->Body->Attributes()[s - 1].Field;
            std::array<int, 3> spans{};
            for (std::size_t d = 0; d < 3; ++d)
            {
              spans[d] = this->A[d].Spans[s][static_cast<std::size_t>(cell[d])];
            }
            BezierExtractor(spline).Extract(spans, low, high, points);
            for (const ChordBound::Bound& b : bound(points, spline.Degrees(), spline.IsRational(),
                   s == 0 ? ChordBound::Norm::Vector : ChordBound::Norm::Components, halvings))
            {
              *bend++ = b.Second;
            }
          }
        };
        if (this->IsTight[slot] < 0)
        {
          find(0);
          this->IsTight[slot] = 0;
        }
        for (std::size_t k = 0; k < this->Count && this->IsTight[slot] == 0; ++k)
        {
          if (LinearError(bends[k], { 1.0, 1.0, 1.0 }) > tolerances[k])
          {
            find(1);
            this->IsTight[slot] = 1;
          }
        }
      }
    });
}

}
