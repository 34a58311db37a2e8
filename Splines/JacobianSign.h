// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_JacobianSign_h
#define hyperpatch_JacobianSign_h

#include "ControlBounds.h"
#include "Spline.h"

namespace hyperpatch
{

/// The sign that det J certainly keeps on a parameter box of any size, knots inside included; 0 if
/// that is not known. A bound, rounding included, and never a guess.
///
/// The derivatives are non-negative combinations of control vectors, which the control window of
/// the box gives without knot insertion or products. They are seen in the frame of their mean
/// directions, where control vector i of direction d has a positive part b_d along axis d and parts
/// |b_k| <= m_kd b_d along the others. Such ratios pass on to all combinations, so J is, up to
/// positive factors of its columns, I + E with |E| <= m, and det J > 0 in that frame if
/// - all |b_k| + |b_l| < b_d: J is strictly diagonally dominant by columns; or
/// - the spectral radius of the 3 x 3 matrix m is below 1: J is an H-matrix (Horn & Johnson, Topics
///   in Matrix Analysis, 2.5).
/// Three cones about orthogonal axes pass the test of Joy & Duchaineau 1999, section 5, up to the
/// half angle atan(1 / sqrt 2); the pyramids of the first criterion circumscribe these cones. Skew
/// frames lose nothing here, and no root is taken.
///
/// Rational: W P_u = X_u - (P - c) W_u with P - c in the box of the control points around their
/// centre c, W_u a combination of differences of weights: control vectors with a margin that is of
/// second order in the size of the box.
///
/// Where the geometry is degenerate (control vectors of length 0) or torn the answer is 0. A box
/// inside a span is taken as the whole span. Const, reentrant, no allocation; the cost is about 8
/// ns per control vector of the window (12 ns if rational), far less where the first ones fail.
///
/// \param geometry a volume with three coordinates; 0 is the answer for anything else
[[nodiscard]] int JacobianSign(const Spline& geometry, const ParameterBox& box);

}

#endif
