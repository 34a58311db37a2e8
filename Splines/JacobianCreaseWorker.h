// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_JacobianCreaseWorker_h
#define hyperpatch_JacobianCreaseWorker_h

#include "Bernstein.h"
#include "Evaluator.h"
#include "JacobianCrease.h"
#include "JacobianField.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <tuple>
#include <utility>
#include <vector>

namespace hyperpatch
{

/// Internal to ExtractJacobianCrease(): searches the elements of a knot plane and cuts their cells
/// (JacobianCrease.cxx), then makes the mesh and measures it (JacobianCreaseMesh.cxx).
class JacobianCreaseExtraction
{
public:
  JacobianCreaseExtraction(
    const Spline& below, const Spline& above, int direction, int subdivision, double featureSize)
    : Below(below)
    , Above(above)
    , D(static_cast<std::size_t>(direction))
    , B((D + 1) % 3)
    , C((D + 2) % 3)
    , N(subdivision)
    , FeatureSize(featureSize)
    , Sides{ JacobianField(below), JacobianField(above) }
    , Geometry(below)
  {
  }

  JacobianCrease Make();

private:
  using Index = std::int64_t;
  using Parameter = std::array<double, 3>;
  using Triangle = std::array<Index, 3>;
  /// det J on both sides of the plane.
  using Pair = std::array<double, 2>;

  struct Vertex
  {
    Parameter At;
    Pair Values;
    std::array<bool, 2> IsRoot; ///< of the determinant below, above
  };

  /// A rectangle of grid cells of an element, low corner and size in cells, a power of two.
  struct Block
  {
    int B, C, Size;
  };

  [[nodiscard]] double Line(int axis, std::size_t element, int line) const;

  /// Goes down to single elements where control windows leave the signs open.
  void AddElements(const std::array<std::size_t, 2>& begin, const std::array<std::size_t, 2>& end);

  /// Goes down to single cells where the bounds leave a sign open.
  void Search(const Block& block, const std::array<Bernstein, 2>& f);

  Index AddVertex(const Parameter& at, std::array<bool, 2> isRoot);

  [[nodiscard]] double Value(std::size_t side, const Parameter& at) const;

  void AddCell(int b, int c, bool isDecided);

  [[nodiscard]] bool ChangesSign(const std::array<Index, 4>& corners, std::size_t side) const;

  [[nodiscard]] Eigen::Vector3d Position(Index vertex) const;

  /// The part of a polygon where a determinant has a sign (Sutherland & Hodgman 1974).
  std::vector<Index> Clip(const std::vector<Index>& polygon, std::size_t side, bool positive);

  /// The zero of a determinant on an edge, the same from whichever cell.
  Index Root(Index a, Index b, std::size_t side);

  void Fill();

  static Eigen::Index Column(std::size_t d) { return static_cast<Eigen::Index>(d); }

  /// The exact point that the middle of an edge stands for: where both ends are zeros of a
  /// determinant that is the zero beside it.
  [[nodiscard]] Eigen::Vector3d Exact(Index a, Index b) const;

  void Measure();

  const Spline& Below;
  const Spline& Above;
  std::size_t D, B, C; ///< the direction across, and those along the plane
  int N;
  double FeatureSize;
  std::array<JacobianField, 2> Sides;
  Evaluator Geometry;
  std::array<std::vector<double>, 2> Breaks;
  std::array<std::size_t, 2> Element{};
  std::map<Parameter, Index> VertexAt;
  std::map<std::tuple<Index, Index, std::size_t>, Index> RootOn;
  std::vector<Vertex> V;
  /// Triangles where det J is positive below the plane, and above it.
  std::array<std::vector<std::pair<Triangle, std::array<std::size_t, 2>>>, 2> Pieces;
  std::vector<Index> Source; ///< per point of the result: the vertex
  JacobianCrease Result;
};

}

#endif
