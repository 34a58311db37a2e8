// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_BezierPieceWorker_h
#define hyperpatch_BezierPieceWorker_h

#include <Eigen/Core>

#include <array>

namespace hyperpatch
{

/// Internal to the intersection tests: a Bezier volume that is a part of an element (a box of its
/// unit cube), or a face, edge or corner of one, where some directions have degree 0 and size 0.
class BezierPiece
{
public:
  BezierPiece() = default;

  /// A whole element. Constant weights are divided out.
  /// \param points 3 or 4 x product of (degrees + 1), homogeneous, u fastest
  /// \param error bound of the error of each number
  BezierPiece(std::array<int, 3> degrees, Eigen::MatrixXd points, double error);

  [[nodiscard]] const std::array<int, 3>& Degrees() const { return this->P; }
  [[nodiscard]] int Degree(int direction) const
  {
    return this->P[static_cast<std::size_t>(direction)];
  }
  [[nodiscard]] bool IsRational() const { return this->H.rows() == 4; }
  /// Homogeneous, and the bound of their error.
  [[nodiscard]] const Eigen::MatrixXd& Points() const { return this->H; }
  [[nodiscard]] double Error() const { return this->E; }
  /// The control points in space, whose hull contains the piece, and the bound of their error.
  [[nodiscard]] const Eigen::Matrix3Xd& Projected() const { return this->X; }
  [[nodiscard]] double ProjectedError() const { return this->XE; }

  /// The box in the unit cube of the element.
  [[nodiscard]] double Low(int direction) const
  {
    return this->L[static_cast<std::size_t>(direction)];
  }
  [[nodiscard]] double Size(int direction) const
  {
    return this->S[static_cast<std::size_t>(direction)];
  }
  [[nodiscard]] double High(int direction) const
  {
    return this->Low(direction) + this->Size(direction);
  }
  [[nodiscard]] std::array<double, 3> Centre() const;

  /// Bounds in space, errors included.
  [[nodiscard]] const Eigen::Vector3d& BoxLow() const { return this->Bottom; }
  [[nodiscard]] const Eigen::Vector3d& BoxHigh() const { return this->Top; }

  /// Distance in memory between neighbours in a direction.
  [[nodiscard]] Eigen::Index Stride(int direction) const;
  /// Index of the control point at a corner; bits 0..2 choose the ends.
  [[nodiscard]] Eigen::Index Corner(int corner) const;

  [[nodiscard]] std::array<BezierPiece, 2> Halves(int direction) const;
  /// The part at one end of a direction, which so gets degree 0.
  [[nodiscard]] BezierPiece AtEnd(int direction, int end) const;

  /// The greatest length, over its rows, of the control polygons in a direction.
  [[nodiscard]] double Length(int direction) const;
  /// How much the derivatives in all directions vary along this one, relative to their size.
  [[nodiscard]] double Bend(int direction) const;

private:
  void Project();

  std::array<int, 3> P{ 0, 0, 0 };
  Eigen::MatrixXd H;
  double E = 0.0;
  Eigen::Matrix3Xd X;
  double XE = 0.0;
  std::array<double, 3> L{ 0, 0, 0 };
  std::array<double, 3> S{ 0, 0, 0 };
  Eigen::Vector3d Bottom = Eigen::Vector3d::Zero();
  Eigen::Vector3d Top = Eigen::Vector3d::Zero();
};

/// Whether the bounds of two pieces are disjoint.
[[nodiscard]] bool BoxesAreDisjoint(const BezierPiece& a, const BezierPiece& b);

/// Whether a plane strictly separates the hulls: seven directions (the middles, and the normals of
/// the mean parallelepipeds of both).
[[nodiscard]] bool AreSeparated(const BezierPiece& a, const BezierPiece& b);

/// The same by as many steps towards the closest points of the hulls (Gilbert 1966); with many, it
/// finds any plane that is not very tight.
[[nodiscard]] bool HullsAreDisjoint(const BezierPiece& a, const BezierPiece& b, int steps = 200);

}

#endif
