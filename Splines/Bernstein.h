// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_Bernstein_h
#define hyperpatch_Bernstein_h

#include <Eigen/Core>

#include <array>

namespace hyperpatch
{

/// A scalar polynomial on the unit cube in tensor-product Bernstein form (Farouki & Rajan 1988).
///
/// Its values lie between its least and its greatest coefficient; together with RoundingBound()
/// that decides signs with certainty:
///
///     f.Min() > f.RoundingBound()    f is positive on the closed unit cube
///     f.Max() < -f.RoundingBound()   f is negative there
///
/// Every operation returns coefficients and a bound of how far they are from those of exact
/// arithmetic. The bounds are a priori and conservative: a coefficient of an operation on s
/// summands is a combination of input coefficients with weights that sum to 1, so that its error is
/// at most gamma_s = s u / (1 - s u) times the greatest magnitudes (Higham 2002, section 3.1), plus
/// what the operands bring along. They hold unless a number underflows or overflows.
class Bernstein
{
public:
  /// The largest degree in one direction: that of the Jacobian determinants of MaxDegree fits.
  static constexpr int DegreeLimit = 127;

  /// The constant 0.
  Bernstein();

  /// \param degrees per direction, 0..DegreeLimit
  /// \param coefficients product of (degrees + 1) numbers, u fastest
  /// \param roundingBound bound of the error that each coefficient already has
  /// \throws Error if a degree is out of range or the number of coefficients does not fit
  Bernstein(std::array<int, 3> degrees, Eigen::VectorXd coefficients, double roundingBound = 0.0);

  [[nodiscard]] const std::array<int, 3>& Degrees() const { return this->D; }
  [[nodiscard]] const Eigen::VectorXd& Coefficients() const { return this->C; }
  /// Bound of the distance of every coefficient from that of exact arithmetic.
  [[nodiscard]] double RoundingBound() const { return this->E; }

  /// Least and greatest coefficient: bounds of the values on the unit cube (convex hull property),
  /// attained if it is at a corner.
  [[nodiscard]] double Min() const { return this->C.minCoeff(); }
  [[nodiscard]] double Max() const { return this->C.maxCoeff(); }

  /// The value at a point of the unit cube.
  [[nodiscard]] double operator()(double u, double v = 0.0, double w = 0.0) const;

  /// The derivative in one direction, of one degree less there. At degree 0 it is 0.
  [[nodiscard]] Bernstein Derivative(int direction) const;

  /// The same polynomial with degree `to` in one direction.
  /// \throws Error if `to` is less than the degree or more than DegreeLimit
  [[nodiscard]] Bernstein Elevate(int direction, int to) const;

  /// The parts on [0, t] and [t, 1] of one direction, each on its own unit cube (de Casteljau).
  /// \throws Error if t is not in [0, 1]
  [[nodiscard]] std::array<Bernstein, 2> Split(int direction, double t = 0.5) const;

  /// Sums of different degrees are elevated to the greater one of each direction.
  [[nodiscard]] friend Bernstein operator+(const Bernstein& a, const Bernstein& b)
  {
    return Sum(a, b, 1.0);
  }
  [[nodiscard]] friend Bernstein operator-(const Bernstein& a, const Bernstein& b)
  {
    return Sum(a, b, -1.0);
  }
  friend Bernstein operator*(double factor, const Bernstein& a);
  /// The product, of the sum of the degrees: a convolution of binomially scaled coefficients.
  /// \throws Error if a degree would exceed DegreeLimit
  friend Bernstein operator*(const Bernstein& a, const Bernstein& b);

private:
  static Bernstein Sum(const Bernstein& a, const Bernstein& b, double sign);

  std::array<int, 3> D;
  Eigen::VectorXd C;
  double E = 0.0;
};

/// The Jacobian determinant of one Bezier volume with respect to the unit cube; on a knot span
/// divide by the product of the span's lengths.
///
/// Polynomial: J = det(P_u, P_v, P_w), degrees 3p - 1. Rational: W^4 J, which has the sign of J, as
/// the determinant of homogeneous columns det[X_u X_v X_w X], degrees 4p - 2.
///
/// \param homogeneousBezierPoints 3 x product of (degrees + 1) if polynomial, 4 x if rational:
/// columns (w x, w y, w z, w), u fastest, as BezierExtractor gives them
/// \param pointError bound of the error that each number of the points already has
/// \throws Error if the number of rows or columns does not fit or a degree is 0
[[nodiscard]] Bernstein JacobianDeterminant(const Eigen::MatrixXd& homogeneousBezierPoints,
  std::array<int, 3> degrees, bool rational, double pointError = 0.0);

}

#endif
