// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_ValidityTest_h
#define hyperpatch_ValidityTest_h

#include "Cone.h"
#include "ScaledJacobian.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

namespace hyperpatch
{

struct ValidityOptions
{
  /// How far apart the bounds of the least (and of the greatest) det J of an element may be, as a
  /// fraction of the greatest |det J| found there. 0: signs only, which is much faster.
  double Tolerance = 0.01;
  /// How far apart the bounds of the least scaled Jacobian, with the sign of the patch, may be. 0:
  /// not wanted. Costs more than all the rest.
  double ScaledTolerance = 0.0;
  /// An element is halved at most so often in a row, and into so many boxes.
  int MaxDepth = 40;
  int MaxBoxes = 4000;
  /// The same for its scaled Jacobian, where a box costs more.
  int MaxScaledBoxes = 1000;
};

/// What proved the sign of an element.
enum class Certificate
{
  None,
  Cones,    ///< the cones of the three derivatives
  Bernstein ///< the Bernstein coefficients of det J
};

/// What is known about det J on one element. Everything is certain, rounding included.
struct ElementValidity
{
  /// 1: det J has one strict sign in the open element, that of the patch; -1: it has not, and there
  /// is a witness; 0: undecided.
  int Verdict = 0;
  /// The sign of det J where it is one: 1 right-handed, -1 left-handed; 0 otherwise.
  int Sign = 0;
  Certificate By = Certificate::None;
  /// The most halvings in a row, and the number of boxes, that it took.
  int Depth = 0;
  int Boxes = 0;
  /// Where det J is 0 to rounding all over: bits 0..5 faces u0 u1 v0 v1 w0 w1; 6 + 4 d + a + 2 b
  /// edges along direction d at end a of the next and b of the last of the other directions, in
  /// the order u, v, w; 18 + i + 2 j + 4 k corners. Only what is not part of a reported face or
  /// edge. The verdict is about the element without these.
  std::uint32_t Degenerate = 0;
  /// Enclosures of the least and the greatest det J on the closed element; only if asked for.
  std::optional<Interval> Minimum;
  std::optional<Interval> Maximum;
  /// Of det J over the lengths of the three derivatives; only if asked of TestValidity().
  std::optional<ScaledJacobian> Scaled;
  /// Points of the open element where det J is certainly positive, or negative: the witnesses of
  /// verdict -1 (one of them if the element has one sign, against the patch).
  std::optional<std::array<double, 3>> Positive;
  std::optional<std::array<double, 3>> Negative;

  /// det J has this strict sign in the open element.
  void Certify(int sign, Certificate by);
};

/// Bounds of the Jacobian determinant of Bezier volumes of one shape.
///
/// Signs: cones first (3 of 3 orders), where they fail the Bernstein coefficients of det J, where
/// they fail their subdivision. Bounds: Bernstein coefficients, subdivided until both enclosures
/// are narrow enough (Johnen, Remacle & Geuzaine, JCP 233, 2013, with products and a priori
/// rounding bounds in the place of sampling). Polynomial elements go several at a time through
/// DeterminantKernel; rational ones have the sign of the homogeneous 4x4 determinant W^4 J.
///
/// Owns its scratch: one object per thread. After the first calls nothing is allocated for
/// polynomial elements.
class ValidityTest
{
public:
  /// \throws Error if a degree is 0 or too large, or an option is out of range
  ValidityTest(std::array<int, 3> degrees, bool rational, const ValidityOptions& options = {});
  ~ValidityTest();
  ValidityTest(ValidityTest&&) noexcept;
  ValidityTest& operator=(ValidityTest&&) noexcept;

  /// Tests elements given by homogeneous Bezier control points; det J is taken with respect to the
  /// unit cube, and the parameters of witnesses lie in it. An element is held against its own sign.
  /// \param points count x product of (degrees + 1) x (3 or 4) numbers, (w x, w y, w z, w)
  /// \param pointErrors count bounds of the error that each number already has, or nullptr
  /// \throws Error if a weight is not positive
  void operator()(
    std::size_t count, const double* points, const double* pointErrors, ElementValidity* results);

private:
  struct Implementation;
  std::unique_ptr<Implementation> I;
};

}

#endif
