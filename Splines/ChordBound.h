// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_ChordBound_h
#define hyperpatch_ChordBound_h

#include <Eigen/Core>

#include <array>
#include <vector>

namespace hyperpatch
{

/// Upper bounds of the second derivatives of a Bezier piece on its unit box: what linear
/// interpolation of it can be wrong by. With legs h_u, h_v of a parameter triangle the error is at
/// most (h_u^2 M_uu + 2 h_u h_v M_uv + h_v^2 M_vv) / 8 (Filip, Magedson & Markot, Surface
/// algorithms using bounds on derivatives, 1986); of d-linear interpolation on a box it is at most
/// the sum of h_d^2 M_dd / 8.
///
/// The bounds hold because Bernstein coefficients bound the polynomial. From a rational piece X / W
/// an affine map of the parameters is taken away, which has no second derivatives: X~ = X - (c +
/// g . xi) W, r = max |X~| / W; then |P_d| <= (|X~_d| + |W_d| r) / W_min and |P_de| <= (|X~_de| +
/// |W_d| |P_e| + |W_e| |P_d| + |W_de| r) / W_min, where P is X~ / W. Where coefficients alone are a
/// loose bound (rational, high degree) the piece is halved a few times; parts never lose certainty.
///
/// Holds scratch: one object per thread.
class ChordBound
{
public:
  /// What is measured as one vector.
  enum class Norm
  {
    Vector,    ///< all components together, Euclidean
    Components ///< each component by itself
  };

  struct Bound
  {
    /// Bounds of |P_uu|, |P_uv|, |P_uw|, |P_vv|, |P_vw|, |P_ww|, parameters from 0 to 1.
    std::array<double, 6> Second{};
    /// Bound of the distance of the piece from a constant; 0 means that it is one.
    double Radius = 0.0;
  };

  /// \param points (m or m + 1) x prod(degrees + 1) homogeneous Bezier points, u fastest; last row
  /// the weight if rational
  /// \param halvings how often each direction that needs it is halved
  /// \returns one bound, or m of them (Norm::Components); valid until the next call
  const std::vector<Bound>& operator()(const Eigen::MatrixXd& points, std::array<int, 3> degrees,
    bool rational, Norm norm, int halvings);

private:
  void Recurse(std::size_t level);
  /// \tparam Rows of the points, where the compiler should know it, or 0
  template <int Rows>
  void Accumulate(const Eigen::MatrixXd& points);

  std::array<int, 3> Degrees{};
  bool Rational = false;
  Norm Measure = Norm::Vector;
  std::vector<int> Splits;             // direction of the halving at each level
  std::vector<Eigen::MatrixXd> Levels; // the part at each level
  Eigen::MatrixXd Centred;
  Eigen::MatrixXd Scratch;
  Eigen::VectorXd Difference;
  std::vector<double> First;  // per group: r and bounds of the first derivatives
  std::vector<double> Second; // per group
  std::vector<Bound> Result;
};

}

#endif
