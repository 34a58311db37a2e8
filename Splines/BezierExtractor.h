// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_BezierExtractor_h
#define hyperpatch_BezierExtractor_h

#include "Spline.h"

#include <array>

namespace hyperpatch
{

/// Extraction of Bezier control points, element by element, without refining the whole spline
/// (Borden et al. 2011, here by blossoms: Bezier point j on [a, b] is the polar form of the piece
/// at p - j times a and j times b).
///
/// Const and reentrant; nothing is allocated once `points` has its size.
class BezierExtractor
{
public:
  /// Keeps a reference to the spline, which must outlive it.
  explicit BezierExtractor(const Spline& spline)
    : S(&spline)
  {
  }

  /// Homogeneous Bezier control points of the spline on a parameter box that lies inside one
  /// element.
  /// \param spans indices into Knots(d).Spans()
  /// \param low, high the box; outside the element this extrapolates the element's polynomial
  /// \param points (m or m + 1) x prod(degrees + 1), u fastest; resized if needed
  /// \throws Error if a span does not exist
  void Extract(std::array<int, 3> spans, std::array<double, 3> low, std::array<double, 3> high,
    Eigen::MatrixXd& points) const;

  /// The whole element.
  void Extract(std::array<int, 3> spans, Eigen::MatrixXd& points) const;

  /// Bound of the rounding error of every number that Extract() gives, on the element or a box in
  /// it. Weights of blossoms inside a span are sums of positive terms of degree factors, five
  /// roundings each, that sum to 1 (Higham 2002, section 3.1).
  /// \throws Error if a span does not exist
  [[nodiscard]] double ErrorBound(std::array<int, 3> spans) const;

private:
  const Spline* S;
};

}

#endif
