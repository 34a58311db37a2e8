// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_ElementPolynomials_h
#define hyperpatch_ElementPolynomials_h

#include "Spline.h"

#include <array>
#include <functional>
#include <memory>
#include <mutex>
#include <vector>

namespace hyperpatch
{

/// A polynomial on one element, with the bound of the error of its coefficients.
struct ElementPolynomial
{
  Spline Values; ///< one component, in Bezier form on the box of the element
  double Error;
};

/// Keeps polynomials that are dear to make for the elements that were asked for last: boxes are
/// visited element by element, and coefficients are halved instead of computed again. Any number of
/// threads may ask.
class ElementPolynomials
{
public:
  using Maker = std::function<ElementPolynomial()>;

  /// That of an element, given by its knot spans; made if it is not there.
  [[nodiscard]] std::shared_ptr<const ElementPolynomial> Find(
    const std::array<int, 3>& spans, const Maker& make) const;

private:
  /// An element has its place; another one with the same place pushes it out.
  struct Place
  {
    std::mutex Mutex;
    std::array<int, 3> Spans{};
    std::shared_ptr<const ElementPolynomial> Polynomial;
  };
  static constexpr std::size_t Count = 64;
  mutable std::array<Place, Count> Places;
};

}

#endif
