// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_Cone_h
#define hyperpatch_Cone_h

#include <Eigen/Core>

#include <array>

namespace hyperpatch
{

/// A closed interval of numbers.
struct Interval
{
  double Low;
  double High;
};

/// A circular cone with its apex at the origin and a half angle of less than 90 degrees, or all of
/// space. It bounds the directions of a set of vectors, and so of all their non-negative
/// combinations (Sederberg & Meyers, Loop detection in surface patch intersections, CAGD 5, 1988;
/// Joy & Duchaineau 1999, section 5).
///
/// Cosine and sine of the half angle are kept, both rounded towards the wider cone: the operations
/// below are backward stable with errors of a few units in the last place of numbers of magnitude
/// 1, and each widens its result by a small multiple of that, given where it is done. What a cone
/// excludes is therefore excluded in exact arithmetic. At an angle near 0 this costs 1e-7 radians.
class Cone
{
public:
  /// All of space: nothing is known.
  Cone() = default;

  /// \param axis of any length but 0
  /// \param angle half angle in radians; from pi / 2 on the cone is all of space
  /// \throws Error if the axis is 0 or not finite, or the angle is negative or NaN
  Cone(const Eigen::Vector3d& axis, double angle);

  /// Around the mean of the vectors. Zero vectors have no direction and are left out.
  /// \param vectors 3 x n
  /// \param error bound of the distance (Euclidean) of every vector from the true one
  [[nodiscard]] static Cone Around(
    const Eigen::Ref<const Eigen::Matrix3Xd>& vectors, double error = 0.0);

  /// The least cone that holds this one and one more vector (Sederberg & Meyers, with the term
  /// cos(alpha) that Martin & Cohen 2001 lost: the border opposite to v points to
  /// (cot(theta) sin(alpha) + cos(alpha)) axis - v).
  [[nodiscard]] Cone Grown(const Eigen::Vector3d& vector) const;

  [[nodiscard]] bool IsEverything() const { return this->C <= 0.0; }
  /// Unit vector; 0 where the cone is everything.
  [[nodiscard]] const Eigen::Vector3d& Axis() const { return this->A; }
  [[nodiscard]] double Cosine() const { return this->C; }
  [[nodiscard]] double Sine() const { return this->S; }
  /// Half angle in radians, pi where the cone is everything.
  [[nodiscard]] double Angle() const;
  /// How many of the vectors that it was made around were zero to their error.
  [[nodiscard]] int ZeroVectors() const { return this->Zeros; }

  [[nodiscard]] bool Contains(const Eigen::Vector3d& vector) const;

  /// Bounds of a . b for unit vectors of two cones, exact to round-off.
  friend Interval Dot(const Cone& a, const Cone& b);

  /// The cone of all a x b: half angle t with sin(t) = sqrt(sin^2 t1 + 2 sin t1 sin t2 cos(beta) +
  /// sin^2 t2) / sin(beta), beta the acute angle of the axes. Everything unless t1 + t2 < beta.
  friend Cone Cross(const Cone& a, const Cone& b);

  /// Bounds of a . (b x c) for unit vectors of three cones: the best of the three orders.
  friend Interval TripleProduct(const Cone& a, const Cone& b, const Cone& c);

  /// The sign that a . (b x c) has for all vectors of three cones, by any of the three orders; 0 if
  /// none of them decides. Much faster than TripleProduct().
  friend int TripleProductSign(const Cone& a, const Cone& b, const Cone& c);

  friend Cone DerivativeCone(const Eigen::MatrixXd& homogeneousBezierPoints,
    std::array<int, 3> degrees, int direction, double pointError);

private:
  template <class ForEach>
  static Cone AroundEach(const ForEach& forEach, double error);
  static Cone Acute(const Eigen::Vector3d& unitAxis, double cosine);

  Eigen::Vector3d A = Eigen::Vector3d::Zero();
  double C = -1.0;
  double S = 0.0;
  int Zeros = 0;
};

[[nodiscard]] Interval Dot(const Cone& a, const Cone& b);
[[nodiscard]] Cone Cross(const Cone& a, const Cone& b);
[[nodiscard]] Interval TripleProduct(const Cone& a, const Cone& b, const Cone& c);
[[nodiscard]] int TripleProductSign(const Cone& a, const Cone& b, const Cone& c);

/// The directions of the derivative of a Bezier volume in one direction over the unit cube.
///
/// Polynomial: the cone of the differences of control points. Rational: that of the Bernstein
/// coefficients of the numerator N = X_u W - X W_u = W^2 P_u, of degree 2p - 2 in u and doubled
/// degrees otherwise; the projected control points of (X_u, W_u) do not bound the derivative.
/// Weights must be positive.
///
/// \param homogeneousBezierPoints 3 or 4 x product of (degrees + 1), as BezierExtractor gives them
/// \param pointError bound of the error that each number of the points already has
/// \throws Error if the number of rows or columns does not fit, the direction is not 0..2 or its
/// degree is 0
[[nodiscard]] Cone DerivativeCone(const Eigen::MatrixXd& homogeneousBezierPoints,
  std::array<int, 3> degrees, int direction, double pointError = 0.0);

}

#endif
