// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_KnotVector_h
#define hyperpatch_KnotVector_h

#include <vector>

namespace hyperpatch
{

/// The largest polynomial degree in one direction; scratch on the stack is sized by it.
inline constexpr int MaxDegree = 31;

/// The least smoothness that a knot vector promises.
enum class Smoothness
{
  C0,           ///< interior multiplicity at most the degree
  Discontinuous ///< interior multiplicity at most degree + 1 (derivatives of C0 splines, Bezier
                ///< form)
};

/// A knot vector with its degree: the one-dimensional B-spline basis (The NURBS Book, chapter 2).
///
/// n control points of degree p have n + p + 1 non-decreasing knots k_0 .. k_{n+p}; the domain is
/// the closed interval [k_p, k_n]. Clamped and unclamped vectors are both fine. A direction that a
/// curve or surface does not have is the default: degree 0, one control point, domain [0, 1].
class KnotVector
{
public:
  /// The direction that is not there: degree 0, knots 0 and 1.
  KnotVector();

  /// \throws Error if the degree is not in 0..MaxDegree, a knot is not finite or decreases, there
  /// are fewer than degree + 1 control points, the domain is empty or an interior knot repeats more
  /// often than `smoothness` allows.
  KnotVector(int degree, std::vector<double> knots, Smoothness smoothness = Smoothness::C0);

  /// Clamped, equally spaced knots for `size` control points on [first, last].
  [[nodiscard]] static KnotVector Uniform(
    int degree, int size, double first = 0.0, double last = 1.0);

  [[nodiscard]] int Degree() const { return this->P; }
  /// Number of control points.
  [[nodiscard]] int Size() const { return static_cast<int>(this->K.size()) - this->P - 1; }
  [[nodiscard]] const std::vector<double>& Knots() const { return this->K; }
  [[nodiscard]] double operator[](int i) const { return this->K[static_cast<std::size_t>(i)]; }
  [[nodiscard]] double First() const { return this->K[static_cast<std::size_t>(this->P)]; }
  [[nodiscard]] double Last() const { return this->K[this->K.size() - 1 - this->P]; }

  /// Indices s of the non-empty spans [k_s, k_{s+1}) of the domain, ascending.
  [[nodiscard]] const std::vector<int>& Spans() const { return this->S; }
  /// The distinct knots of the domain, ends included: one more than there are spans.
  [[nodiscard]] std::vector<double> Breaks() const;
  /// How often `knot` occurs (bitwise equality).
  [[nodiscard]] int Multiplicity(double knot) const;
  /// Interior breaks where the basis is only C0 or less.
  [[nodiscard]] std::vector<double> Creases() const;
  /// Greville abscissa of control point i: the mean of knots i+1 .. i+p, or the end of the domain
  /// where that lies beyond it (of vectors that are not clamped), to be a site of interpolation.
  [[nodiscard]] double Greville(int i) const;

  /// Index s with k_s <= u < k_{s+1}; the last non-empty span at and beyond the end of the domain,
  /// the first one before its begin (A2.1, closed domain).
  [[nodiscard]] int FindSpan(double u) const;

  /// The degree + 1 basis functions that are not zero on span s, at u (A2.2).
  void BasisFunctions(int span, double u, double* values) const;

  /// Basis functions and derivatives up to `order`: (order + 1) rows of degree + 1 values (A2.3).
  void BasisDerivatives(int span, double u, int order, double* values) const;

  /// Weights of control points s-p .. s in the blossom (polar form) of the polynomial piece on span
  /// s at p arguments. Equal arguments give the basis functions, consecutive knots of a refined
  /// vector give the row of knot insertion (Oslo algorithm), end points of an interval give the
  /// Bezier points of that interval (Ramshaw, Blossoming, 1987).
  void BlossomWeights(int span, const double* arguments, double* weights) const;

  friend bool operator==(const KnotVector& a, const KnotVector& b)
  {
    return a.P == b.P && a.K == b.K;
  }
  friend bool operator!=(const KnotVector& a, const KnotVector& b) { return !(a == b); }

private:
  int P = 0;
  std::vector<double> K;
  std::vector<int> S;
};

}

#endif
