// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_FacetTriangulation_h
#define hyperpatch_FacetTriangulation_h

#include <Eigen/Core>

#include <array>
#include <vector>

namespace hyperpatch
{

/// The constrained Delaunay triangulation of a simple polygon and of points inside it, built point
/// by point (Lawson's flips). Reuse one object: no memory is taken once it has its size.
class FacetTriangulation
{
public:
  using Triangle = std::array<int, 3>;

  /// Triangulates a polygon.
  /// \param polygon its corners, counter-clockwise; they become points 0, 1, ...
  /// \returns false if it is not simple; then there is no triangulation
  bool Start(const std::vector<Eigen::Vector2d>& polygon);

  /// Adds a point to the triangulation. One outside the polygon, or on top of another, is left out.
  /// \returns its number, or -1 where it was left out
  int Insert(const Eigen::Vector2d& point);

  /// Counter-clockwise.
  [[nodiscard]] const std::vector<Triangle>& Triangles() const { return this->T; }
  [[nodiscard]] const std::vector<Eigen::Vector2d>& Points() const { return this->X; }

  /// Whether the edge opposite to a corner of a triangle is an edge of the polygon.
  [[nodiscard]] bool IsBoundary(int triangle, int corner) const
  {
    return this->N[static_cast<std::size_t>(triangle)][static_cast<std::size_t>(corner)] < 0;
  }

private:
  [[nodiscard]] double Area(int a, int b, int c) const;
  void Link(int triangle, int corner, int neighbor, int old);
  void Flip(int triangle, int corner);
  void Legalise();

  std::vector<Eigen::Vector2d> X;
  std::vector<Triangle> T;
  std::vector<std::array<int, 3>> N;     ///< neighbor opposite to each corner, -1 at the polygon
  std::vector<std::array<int, 2>> Stack; ///< (triangle, corner) of edges to be tested
  std::vector<int> Ring;                 ///< what is left of the polygon while ears are cut off
  std::vector<int> Behind; ///< 3 triangle + corner behind the edge that begins there, or -1
  int Last = 0;            ///< where the search for a point begins
};

}

#endif
