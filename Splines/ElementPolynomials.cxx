// SPDX-License-Identifier: BSD-3-Clause
#include "ElementPolynomials.h"

namespace hyperpatch
{

std::shared_ptr<const ElementPolynomial> ElementPolynomials::Find(
  const std::array<int, 3>& spans, const Maker& make) const
{
  const auto number = [&spans](std::size_t d) { return static_cast<std::size_t>(spans[d]); };
  Place& place = this->Places[(number(0) + 7 * number(1) + 31 * number(2)) % Count];
  {
    const std::lock_guard<std::mutex> lock(place.Mutex);
    if (place.Polynomial && place.Spans == spans)
    {
      return place.Polynomial;
    }
  }
  auto made = std::make_shared<const ElementPolynomial>(make());
  const std::lock_guard<std::mutex> lock(place.Mutex);
  place.Spans = spans;
  place.Polynomial = made;
  return made;
}

}
