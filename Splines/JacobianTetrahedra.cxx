// SPDX-License-Identifier: BSD-3-Clause
#include "JacobianTetrahedra.h"

#include "Evaluator.h"
#include "JacobianComplexWorker.h"
#include "JacobianField.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

namespace hyperpatch
{

namespace
{

using Index = JacobianComplex::Index;
using Triangle = std::array<Index, 3>;

/// The surface in a complex of tetrahedra.
class Marching
{
public:
  Marching(const Spline& geometry, JacobianComplex complex)
    : Geometry(geometry)
    , Complex(std::move(complex))
  {
  }

  JacobianTetrahedra Make(const ParameterBox& domain)
  {
    this->EvaluateVertices();
    this->March();
    this->CountOpenEdges(domain);
    this->Result.RepairedCells = this->Complex.RepairedCells;
    return std::move(this->Result);
  }

private:
  void EvaluateVertices()
  {
    const std::size_t count = this->Complex.Parameters.size();
    this->Positions.resize(3, static_cast<Index>(count));
    this->Values.resize(count);
    if (count == 0)
    {
      return;
    }
    const double* parameters = this->Complex.Parameters.front().data();
    Evaluator(this->Geometry).Evaluate(count, parameters, this->Positions.data());
    JacobianField(this->Geometry).Evaluate(count, parameters, this->Values.data());
    for (const JacobianComplex::Hanging& hanging : this->Complex.Interpolated)
    {
      Eigen::Vector3d position = Eigen::Vector3d::Zero();
      double value = 0.0;
      for (std::size_t i = 0; i < 3; ++i)
      {
        position += hanging.Weights[i] * this->Positions.col(hanging.From[i]);
        value += hanging.Weights[i] * this->Values[static_cast<std::size_t>(hanging.From[i])];
      }
      this->Positions.col(hanging.Vertex) = position;
      this->Values[static_cast<std::size_t>(hanging.Vertex)] = value;
    }
  }

  /// The surface vertex on an edge between corners of different sign.
  Index Cut(Index a, Index b)
  {
    const std::pair<Index, Index> edge = std::minmax(a, b);
    const auto [found, isNew] = this->Cuts.emplace(edge, static_cast<Index>(this->Cuts.size()));
    if (isNew)
    {
      const auto [i, j] = edge;
      const double from = this->Values[static_cast<std::size_t>(i)];
      const double to = this->Values[static_cast<std::size_t>(j)];
      const double t = from / (from - to);
      this->Points.emplace_back(
        this->Positions.col(i) + t * (this->Positions.col(j) - this->Positions.col(i)));
      const Eigen::Map<const Eigen::Vector3d> low(
        this->Complex.Parameters[static_cast<std::size_t>(i)].data());
      const Eigen::Map<const Eigen::Vector3d> high(
        this->Complex.Parameters[static_cast<std::size_t>(j)].data());
      // On a face of the domain it stays there.
      this->PointParameters.emplace_back(low + t * (high - low));
    }
    return found->second;
  }

  void March()
  {
    // Even permutations, by the corner or corners that are alone on their side.
    static constexpr int Alone[4][4] = { { 0, 1, 2, 3 }, { 1, 0, 3, 2 }, { 2, 3, 0, 1 },
      { 3, 2, 1, 0 } };
    std::vector<Triangle> triangles;
    for (const JacobianComplex::Tetrahedron& tetrahedron : this->Complex.Tetrahedra)
    {
      const std::array<Index, 4>& v = tetrahedron.Vertices;
      std::vector<int> positive;
      std::vector<int> negative;
      for (int i = 0; i < 4; ++i)
      {
        const double value = this->Values[static_cast<std::size_t>(v[static_cast<std::size_t>(i)])];
        (value >= 0.0 ? positive : negative).push_back(i);
      }
      const auto cut = [&](int i, int j)
      { return this->Cut(v[static_cast<std::size_t>(i)], v[static_cast<std::size_t>(j)]); };
      const std::size_t before = triangles.size();
      if (positive.size() == 1)
      {
        const int* p = Alone[positive[0]];
        triangles.push_back({ cut(p[0], p[1]), cut(p[0], p[3]), cut(p[0], p[2]) });
      }
      else if (negative.size() == 1)
      {
        const int* p = Alone[negative[0]];
        triangles.push_back({ cut(p[0], p[1]), cut(p[0], p[2]), cut(p[0], p[3]) });
      }
      else if (positive.size() == 2)
      {
        // Corners a, b positive and c, d negative in an even order.
        const int a = positive[0];
        const int b = positive[1];
        const bool isEven = (b - a) % 2 != 0;
        const int c = negative[isEven ? 0 : 1];
        const int d = negative[isEven ? 1 : 0];
        triangles.push_back({ cut(a, c), cut(b, c), cut(b, d) });
        triangles.push_back({ cut(a, c), cut(b, d), cut(a, d) });
      }
      this->Result.Cells.insert(
        this->Result.Cells.end(), triangles.size() - before, tetrahedron.Cell);
    }
    this->Result.Tetrahedra = static_cast<Index>(this->Complex.Tetrahedra.size());
    this->Result.Parameters.resize(3, static_cast<Index>(this->Points.size()));
    this->Result.Points.resize(3, static_cast<Index>(this->Points.size()));
    for (std::size_t i = 0; i < this->Points.size(); ++i)
    {
      this->Result.Parameters.col(static_cast<Index>(i)) = this->PointParameters[i];
      this->Result.Points.col(static_cast<Index>(i)) = this->Points[i];
    }
    this->Result.Triangles.resize(3, static_cast<Index>(triangles.size()));
    for (std::size_t t = 0; t < triangles.size(); ++t)
    {
      this->Result.Triangles.col(static_cast<Index>(t)) =
        Eigen::Map<const Eigen::Matrix<Index, 3, 1>>(triangles[t].data());
    }
  }

  void CountOpenEdges(const ParameterBox& domain)
  {
    std::map<std::pair<Index, Index>, int> uses;
    for (Index t = 0; t < this->Result.Triangles.cols(); ++t)
    {
      for (Index i = 0; i < 3; ++i)
      {
        ++uses[std::minmax(this->Result.Triangles(i, t), this->Result.Triangles((i + 1) % 3, t))];
      }
    }
    for (const auto& [edge, count] : uses)
    {
      bool isOnFace = false;
      for (std::size_t d = 0; d < 3; ++d)
      {
        const double a = this->PointParameters[static_cast<std::size_t>(edge.first)][Index(d)];
        const double b = this->PointParameters[static_cast<std::size_t>(edge.second)][Index(d)];
        isOnFace = isOnFace || (a == domain.Low[d] && b == domain.Low[d]) ||
          (a == domain.High[d] && b == domain.High[d]);
      }
      this->Result.OpenEdges += count == 1 && !isOnFace ? 1 : 0;
    }
  }

  const Spline& Geometry;
  JacobianComplex Complex;
  Eigen::Matrix3Xd Positions;
  std::vector<double> Values;
  std::map<std::pair<Index, Index>, Index> Cuts;
  std::vector<Eigen::Vector3d> Points;
  std::vector<Eigen::Vector3d> PointParameters;
  JacobianTetrahedra Result;
};

}

JacobianTetrahedra MarchTetrahedra(
  const Spline& geometry, const JacobianTree& tree, CrackRepair repair)
{
  return Marching(geometry, MakeComplex(tree, repair)).Make(tree.Cells().front().Box);
}

}
