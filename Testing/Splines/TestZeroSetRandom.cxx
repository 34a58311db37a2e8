// SPDX-License-Identifier: BSD-3-Clause
#include "Evaluator.h"
#include "QuadricField.h"
#include "Splines/GridTopology.h"
#include "Splines/RandomZeroSets.h"
#include "ZeroSet.h"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

using namespace hyperpatch;
using models::RandomZeroSet;

namespace
{

constexpr double Epsilon = std::numeric_limits<double>::epsilon();

/// What is counted over many seeds.
struct Tally
{
  int Seeds = 0;
  int Empty = 0;
  int Undecided = 0;
  int Missed = 0;   ///< tolerance not reached
  int Compared = 0; ///< topology
  int Skipped = 0;  ///< the reference did not settle
  long Triangles = 0;
  long Slivers = 0; ///< thinner than the tolerance and turned over
};

/// A mesh whose points have been joined where they are in the same place, bit by bit.
struct Welded
{
  std::vector<std::size_t> PointOf; ///< per point of the mesh
  topology::Invariants Topology;
  std::vector<std::array<std::size_t, 2>> Open; ///< edges that one triangle has
  std::string Flaw;                             ///< what is no oriented surface
};

Welded Weld(const ZeroSetMesh& mesh)
{
  Welded result;
  std::map<std::array<double, 3>, std::size_t> first;
  for (Eigen::Index v = 0; v < mesh.Points.cols(); ++v)
  {
    const std::array<double, 3> at{ mesh.Points(0, v), mesh.Points(1, v), mesh.Points(2, v) };
    result.PointOf.push_back(first.try_emplace(at, static_cast<std::size_t>(v)).first->second);
  }
  std::map<std::array<std::size_t, 2>, std::array<int, 2>> uses; // there, and back
  topology::Sets parts(result.PointOf.size());
  for (Eigen::Index c = 0; c < mesh.Cells.cols(); ++c)
  {
    for (int k = 0; k < 3; ++k)
    {
      const std::size_t a = result.PointOf[static_cast<std::size_t>(mesh.Cells(k, c))];
      const std::size_t b = result.PointOf[static_cast<std::size_t>(mesh.Cells((k + 1) % 3, c))];
      if (a == b)
      {
        result.Flaw = "a triangle has a point twice";
      }
      ++uses[{ std::min(a, b), std::max(a, b) }][a < b ? 0 : 1];
      parts.Join(a, b);
    }
  }
  topology::Sets loops(result.PointOf.size());
  std::vector<char> isUsed(result.PointOf.size(), 0);
  std::vector<int> isOnLoop(result.PointOf.size(), 0);
  for (const auto& [edge, use] : uses)
  {
    for (const std::size_t v : edge)
    {
      isUsed[v] = 1;
    }
    if (use[0] > 1 || use[1] > 1)
    {
      result.Flaw = "an edge has more than two triangles, or two that turn against each other";
    }
    if (use[0] + use[1] == 1)
    {
      result.Open.push_back(edge);
      loops.Join(edge[0], edge[1]);
      ++isOnLoop[edge[0]];
      ++isOnLoop[edge[1]];
    }
  }
  result.Topology.Euler = static_cast<long>(mesh.Cells.cols()) - static_cast<long>(uses.size());
  for (std::size_t v = 0; v < isUsed.size(); ++v)
  {
    result.Topology.Euler += isUsed[v];
    result.Topology.Components += isUsed[v] != 0 && parts.Find(v) == v ? 1 : 0;
    result.Topology.BoundaryLoops += isOnLoop[v] != 0 && loops.Find(v) == v ? 1 : 0;
    if (isOnLoop[v] != 0 && isOnLoop[v] != 2)
    {
      result.Flaw = "the border crosses itself";
    }
  }
  return result;
}

/// f and the geometry with what a method of Newton's needs, by other means than the engine's field.
class Exact
{
public:
  explicit Exact(const RandomZeroSet& model)
    : Model(model)
    , Geometry(model.Body->Geometry())
    , Field(model.Function())
  {
    for (int d = 0; d < 3; ++d)
    {
      this->Low[d] = model.Body->Geometry().Knots(d).First();
      this->High[d] = model.Body->Geometry().Knots(d).Last();
    }
  }

  /// From first principles, one point at a time.
  [[nodiscard]] double Value(const Eigen::Vector3d& u) const
  {
    return this->Model.Q.Value(this->Model.Function().Evaluate(u[0], u[1], u[2]).data());
  }

  /// Of the image of a box, by its corners.
  [[nodiscard]] double Width(const ParameterBox& box) const
  {
    Eigen::Matrix<double, 3, 8> at;
    for (int c = 0; c < 8; ++c)
    {
      for (int d = 0; d < 3; ++d)
      {
        const auto D = static_cast<std::size_t>(d);
        at(d, c) = (c >> d & 1) != 0 ? box.High[D] : box.Low[D];
      }
    }
    Eigen::Matrix<double, 3, 8> x;
    this->Geometry.Evaluate(8, at.data(), x.data());
    return (x.rowwise().maxCoeff() - x.rowwise().minCoeff()).norm();
  }

  /// Whether f is 0 at 5 x 5 x 5 points of a box.
  [[nodiscard]] bool IsZero(const ParameterBox& box) const
  {
    for (int i = 0; i < 125; ++i)
    {
      const Eigen::Array3d t(i % 5 / 4.0, i / 5 % 5 / 4.0, i / 25 / 4.0);
      const Eigen::Array3d low(box.Low.data());
      const Eigen::Array3d u = low + t * (Eigen::Array3d(box.High.data()) - low);
      if (!(std::abs(this->Value(u.matrix())) <= 64 * Epsilon * this->Model.Scale))
      {
        return false;
      }
    }
    return true;
  }

  void At(const Eigen::Vector3d& u, double& f, Eigen::Vector3d& gradient, Eigen::Vector3d& x,
    Eigen::Matrix3d& J) const
  {
    this->Geometry.EvaluateWithDerivatives(1, u.data(), x.data(), J.data());
    const int m = this->Field.Components();
    Eigen::VectorXd s(m);
    Eigen::MatrixXd D(m, 3);
    this->Field.EvaluateWithDerivatives(1, u.data(), s.data(), D.data());
    Eigen::VectorXd slope(m);
    this->Model.Q.Gradient(s.data(), slope.data());
    f = this->Model.Q.Value(s.data());
    gradient = D.transpose() * slope;
  }

  /// An upper bound of the distance from a point in space to the zero set: what Newton's method
  /// finds from `start` or, where that does not do (f may have kinks), what is found in many
  /// directions.
  [[nodiscard]] double Distance(
    const Eigen::Vector3d& target, const Eigen::Vector3d& start, double enough) const
  {
    const double byNewton = this->FindByNewton(target, start).Distance;
    return byNewton <= enough ? byNewton
                              : std::min(byNewton, this->DistanceBySearch(target, start, enough));
  }

  [[nodiscard]] double DistanceBySearch(
    const Eigen::Vector3d& target, const Eigen::Vector3d& start, double radius) const
  {
    // From the point itself, and where `start` is on a crease from there and in its plane: a ridge
    // of f may come up to 0 in no other direction.
    Eigen::Vector3d u = start;
    double f = 0.0;
    Eigen::Vector3d g;
    Eigen::Vector3d x;
    Eigen::Matrix3d J;
    for (int step = 0; step < 8; ++step)
    {
      this->At(u, f, g, x, J);
      u = (u + J.inverse() * (target - x)).cwiseMax(this->Low).cwiseMin(this->High);
    }
    double least = this->DistanceFrom(u, Eigen::Vector3d::Ones(), target, radius);
    for (int d = 0; d < 3; ++d)
    {
      for (const double crease : this->Model.Function().Knots(d).Creases())
      {
        if (std::abs(start[d] - crease) <= 1e-12 * (this->High[d] - this->Low[d]))
        {
          u = start;
          u[d] = crease;
          Eigen::Vector3d inPlane = Eigen::Vector3d::Ones();
          inPlane[d] = 0.0;
          least = std::min(least, this->DistanceFrom(u, inPlane, target, radius));
        }
      }
    }
    return least;
  }

  /// Of what is found of the zero set in many directions from u.
  [[nodiscard]] double DistanceFrom(const Eigen::Vector3d& u, const Eigen::Vector3d& isFree,
    const Eigen::Vector3d& target, double radius) const
  {
    double f = 0.0;
    Eigen::Vector3d g;
    Eigen::Vector3d x;
    Eigen::Matrix3d J;
    this->At(u, f, g, x, J);
    double least = INFINITY;
    constexpr int Directions = 400;
    constexpr int Steps = 12;
    for (int i = 0; i < Directions; ++i)
    {
      // Evenly over the sphere, along a spiral.
      const double z = 1.0 - (2.0 * i + 1.0) / Directions;
      const double angle = 2.399963229728653 * i;
      const double r = std::sqrt(1.0 - z * z);
      const Eigen::Vector3d along =
        J.inverse() * Eigen::Vector3d(r * std::cos(angle), r * std::sin(angle), z) * radius;
      double before = f;
      Eigen::Vector3d low = u;
      // In growing steps: two sheets may be near to each other where the first one is near to u.
      for (int step = 1; step <= Steps; ++step)
      {
        Eigen::Vector3d high = (u + along.cwiseProduct(isFree) * std::pow(3.0, step - Steps))
                                 .cwiseMax(this->Low)
                                 .cwiseMin(this->High);
        const double after = this->Value(high);
        if ((before < 0.0) != (after < 0.0))
        {
          for (int halving = 0; halving < 40; ++halving)
          {
            const Eigen::Vector3d middle = 0.5 * (low + high);
            ((this->Value(middle) < 0.0) == (before < 0.0) ? low : high) = middle;
          }
          this->Geometry.Evaluate(1, low.data(), x.data());
          least = std::min(least, (target - x).norm());
          break;
        }
        before = after;
        low = high;
      }
    }
    return least;
  }

  struct Found
  {
    double Distance;
    Eigen::Vector3d At; ///< parameters
  };
  [[nodiscard]] Found FindByNewton(
    const Eigen::Vector3d& target, const Eigen::Vector3d& start) const
  {
    Found least{ INFINITY, start };
    for (const bool nearest : { true, false })
    {
      Eigen::Vector3d u = start;
      for (int step = 0; step < 12; ++step)
      {
        double f = 0.0;
        Eigen::Vector3d g;
        Eigen::Vector3d x;
        Eigen::Matrix3d J;
        this->At(u, f, g, x, J);
        const Eigen::Vector3d r = nearest ? Eigen::Vector3d(target - x) : Eigen::Vector3d::Zero();
        // The least |J du - r| with g du = -f, of the directions that lead to somewhere.
        Eigen::Vector3d du = Eigen::Vector3d::Zero();
        std::array<bool, 3> isFree{ true, true, true };
        for (int tried = 0; tried < 3; ++tried)
        {
          Eigen::Matrix4d A = Eigen::Matrix4d::Identity();
          Eigen::Vector4d b = Eigen::Vector4d::Zero();
          const Eigen::Matrix3d G = J.transpose() * J;
          const Eigen::Vector3d h = J.transpose() * r;
          for (int i = 0; i < 3; ++i)
          {
            for (int j = 0; j < 3; ++j)
            {
              const bool both =
                isFree[static_cast<std::size_t>(i)] && isFree[static_cast<std::size_t>(j)];
              A(i, j) = both ? G(i, j) : i == j ? 1.0 : 0.0;
            }
            const bool free = isFree[static_cast<std::size_t>(i)];
            A(i, 3) = A(3, i) = free ? g[i] : 0.0;
            b[i] = free ? h[i] : 0.0;
          }
          A(3, 3) = 0.0;
          b[3] = -f;
          du = Eigen::Vector4d(A.fullPivLu().solve(b)).head<3>();
          bool again = false;
          for (int i = 0; i < 3; ++i)
          {
            const bool leaves =
              (u[i] <= this->Low[i] && du[i] < 0.0) || (u[i] >= this->High[i] && du[i] > 0.0);
            again = again || (leaves && isFree[static_cast<std::size_t>(i)]);
            isFree[static_cast<std::size_t>(i)] = isFree[static_cast<std::size_t>(i)] && !leaves;
          }
          if (!again)
          {
            break;
          }
        }
        const double length = (du.array() / (this->High - this->Low).array()).abs().maxCoeff();
        const Eigen::Vector3d next = (u + du * std::min(1.0, 0.2 / std::max(length, 1e-300)))
                                       .cwiseMax(this->Low)
                                       .cwiseMin(this->High);
        if (std::abs(f) <= 1e-9 * this->Model.Scale && (target - x).norm() < least.Distance)
        {
          least = { (target - x).norm(), u };
        }
        u = next.allFinite() ? next : u;
        if (std::abs(f) <= 1e-9 * this->Model.Scale)
        {
          if (!nearest || length < 1e-6)
          {
            break;
          }
        }
      }
    }
    return least;
  }

  Eigen::Vector3d Low, High;
  const RandomZeroSet& Model;
  const Evaluator Geometry;
  const Evaluator Field;
};

/// Ericson 2005, Real-Time Collision Detection, section 5.1.5.
double DistanceToTriangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
  const Eigen::Vector3d& b, const Eigen::Vector3d& c)
{
  const Eigen::Vector3d ab = b - a;
  const Eigen::Vector3d ac = c - a;
  const double d1 = ab.dot(p - a);
  const double d2 = ac.dot(p - a);
  const double d3 = ab.dot(p - b);
  const double d4 = ac.dot(p - b);
  const double d5 = ab.dot(p - c);
  const double d6 = ac.dot(p - c);
  const double va = d3 * d6 - d5 * d4;
  const double vb = d5 * d2 - d1 * d6;
  const double vc = d1 * d4 - d3 * d2;
  if (va > 0.0 && vb > 0.0 && vc > 0.0)
  {
    return (a + (vb * ab + vc * ac) / (va + vb + vc) - p).norm();
  }
  const auto toSegment = [&p](const Eigen::Vector3d& s, const Eigen::Vector3d& e)
  {
    const double square = (e - s).squaredNorm();
    const double t = square > 0.0 ? std::clamp((p - s).dot(e - s) / square, 0.0, 1.0) : 0.0;
    return (s + t * (e - s) - p).norm();
  };
  return std::min({ toSegment(a, b), toSegment(b, c), toSegment(c, a) });
}

/// The values of f on a grid of n nodes per direction. Some lie on the knots, where f may have
/// kinks; the others not quite regularly, so that none lies in the middle of a span by habit.
std::vector<double> Sample(
  const Exact& exact, std::size_t n, std::array<std::vector<double>, 3>& at)
{
  for (std::size_t d = 0; d < 3; ++d)
  {
    const auto D = static_cast<Eigen::Index>(d);
    at[d].resize(n);
    for (std::size_t i = 0; i < n; ++i)
    {
      const double t = static_cast<double>(i) / static_cast<double>(n - 1);
      at[d][i] = i + 1 == n
        ? exact.High[D]
        : exact.Low[D] + (t + 0.03 * t * (1.0 - t)) * (exact.High[D] - exact.Low[D]);
    }
    for (const double knot : exact.Model.Function().Knots(static_cast<int>(d)).Breaks())
    {
      const auto above = std::lower_bound(at[d].begin(), at[d].end(), knot);
      const auto nearest =
        above == at[d].begin() || *above - knot < knot - *(above - 1) ? above : above - 1;
      if (nearest != at[d].begin() && nearest + 1 != at[d].end())
      {
        *nearest = knot;
      }
    }
  }
  const auto m = static_cast<std::size_t>(exact.Field.Components());
  std::vector<double> s(m * n * n * n);
  exact.Field.EvaluateGrid(at, s.data());
  std::vector<double> values(n * n * n);
  for (std::size_t i = 0; i < values.size(); ++i)
  {
    values[i] = exact.Model.Q.Value(s.data() + m * i);
  }
  return values;
}

/// What a brute-force reference finds.
enum class Reference
{
  Agrees,
  Differs,
  Unsettled
};

Reference Compare(
  const Exact& exact, const topology::Invariants& mesh, std::vector<topology::Invariants>& seen)
{
  // Finer until two that follow each other agree, with each other and with the mesh. If they agree
  // with each other only, there may be something that both are too coarse for.
  static constexpr std::array<std::size_t, 6> Nodes{ 12, 19, 29, 44, 67, 101 };
  std::array<std::vector<double>, 3> at;
  bool isSettled = false;
  for (const std::size_t n : Nodes)
  {
    const std::vector<double> values = Sample(exact, n, at);
    std::vector<char> isPositive(values.size());
    std::array<topology::Invariants, 2> both;
    for (const bool zeroIsPositive : { true, false })
    {
      // A zero is either; what depends on which is no topology.
      const double noise = 1e-13 * exact.Model.Scale;
      bool hasZero = false;
      for (std::size_t i = 0; i < values.size(); ++i)
      {
        const bool isZero = std::abs(values[i]) <= noise;
        hasZero = hasZero || isZero;
        isPositive[i] = (isZero ? zeroIsPositive : values[i] > 0.0) ? 1 : 0;
      }
      both[zeroIsPositive ? 1 : 0] = topology::OfGrid(isPositive, n);
      if (!hasZero)
      {
        both[0] = both[1];
        break;
      }
    }
    const bool isSure = both[0] == both[1];
    isSettled = isSure && !seen.empty() && seen.back() == both[1];
    seen.push_back(both[1]);
    if (!isSure)
    {
      return Reference::Unsettled;
    }
    if (isSettled && both[1] == mesh)
    {
      return Reference::Agrees;
    }
  }
  return isSettled ? Reference::Differs : Reference::Unsettled;
}

/// What does not hold for one seed; empty texts where all is well.
struct Flaws
{
  std::string Surface;   ///< of what the mesh is, and of where its vertices are
  std::string Topology;  ///< differs from that of the reference
  std::string Triangles; ///< too far from the zero set, or turned over
};

/// \param triangles whether to look at what is between vertices, which takes longest
/// \param nodes per direction of the grid between whose nodes zeros are looked for
Flaws Check(const RandomZeroSet& model, bool triangles, Tally& tally, std::size_t nodes = 15)
{
  Flaws result;
  std::ostringstream flaws;
  const auto start = std::chrono::steady_clock::now();
  ZeroSetOptions options = model.Options;
  // Nothing here takes more than a fraction of that; it is there to end what would not.
  options.Abort = [start]
  { return std::chrono::steady_clock::now() - start > std::chrono::seconds(60); };
  const QuadricField field(model.Function(), model.Q, !model.OfAttribute);
  ZeroSet zeroSet(*model.Body, field, options);
  if (!zeroSet.Extract())
  {
    result.Surface = "takes more than a minute";
    return result;
  }
  const ZeroSetMesh& mesh = zeroSet.Mesh();
  const ZeroSetCertificate& certificate = zeroSet.Certificate();
  const Exact exact(model);
  const double tolerance = options.Tolerance;
  const bool isDecided = certificate.UndecidedCells == 0;
  ++tally.Seeds;
  tally.Empty += mesh.Cells.cols() == 0 ? 1 : 0;
  tally.Undecided += isDecided ? 0 : 1;
  tally.Missed += certificate.ToleranceReached ? 0 : 1;
  tally.Triangles += static_cast<long>(mesh.Cells.cols());

  // Watertight and oriented; open on faces of the domain only.
  const Welded welded = Weld(mesh);
  if (isDecided && !welded.Flaw.empty())
  {
    flaws << welded.Flaw << "; ";
  }
  std::int64_t onBoundary = 0;
  for (const auto& [a, b] : welded.Open)
  {
    bool isOnFace = false;
    for (int d = 0; d < 3; ++d)
    {
      const double x = mesh.Parameters(d, static_cast<Eigen::Index>(a));
      isOnFace = isOnFace ||
        (x == mesh.Parameters(d, static_cast<Eigen::Index>(b)) &&
          (x == exact.Low[d] || x == exact.High[d]));
    }
    onBoundary += isOnFace ? 1 : 0;
  }
  const auto inside = static_cast<std::int64_t>(welded.Open.size()) - onBoundary;
  if (isDecided && inside != 0)
  {
    flaws << inside << " open edges inside; ";
  }
  if (welded.Flaw.empty() &&
    (certificate.OpenEdgesInside != inside || certificate.OpenEdgesOnBoundary != onBoundary ||
      certificate.OpenEdgesOnInterfaces != 0))
  {
    flaws << "open edges " << onBoundary << " + " << inside << ", certificate "
          << certificate.OpenEdgesOnBoundary << " + " << certificate.OpenEdgesInside << "; ";
  }

  // Vertices: on f = 0, where their parameters say, with the normal of growing f.
  double residual = 0.0;
  double misplaced = 0.0;
  double turned = 1.0;
  for (Eigen::Index v = 0; v < mesh.Points.cols(); ++v)
  {
    const Eigen::Vector3d u = mesh.Parameters.col(v);
    double f = 0.0;
    Eigen::Vector3d g;
    Eigen::Vector3d x;
    Eigen::Matrix3d J;
    exact.At(u, f, g, x, J);
    // A parameter can be no better than its last bit.
    const double reachable =
      Epsilon * g.cwiseAbs().dot(u.cwiseAbs().cwiseMax(exact.High - exact.Low));
    residual = std::max(residual, std::abs(exact.Value(u)) / (model.Scale + reachable / Epsilon));
    misplaced = std::max(misplaced, (x - mesh.Points.col(v)).norm() / model.Reach);
    // cof(J) grad f with one sign per patch; where det J has the other one, f falls along it.
    const double sign = J.determinant() * options.Handedness < 0.0 ? -1.0 : 1.0;
    const Eigen::Vector3d up = sign * J.transpose().inverse() * g;
    // On a crease it has one per side; u is on the upper side of it.
    if (welded.PointOf[static_cast<std::size_t>(v)] == static_cast<std::size_t>(v) &&
      !model.IsOnCrease(u) && up.norm() * model.Diagonal > 1e-6 * model.Scale)
    {
      turned = std::min(turned, up.normalized().dot(mesh.Normals.col(v)));
    }
  }
  if (residual > 256 * Epsilon && isDecided)
  {
    flaws << "residual " << residual / Epsilon << " eps; ";
  }
  if (misplaced > 64 * Epsilon)
  {
    flaws << "points off their parameters by " << misplaced << "; ";
  }
  if (turned < 1.0 - 1e-6)
  {
    flaws << "normal's cosine " << turned << "; ";
  }

  // Triangles: they turn with the normals and lie within the tolerance.
  double worst = 0.0;
  long slivers = 0;
  const Eigen::Index stride = 1 + mesh.Cells.cols() / 400;
  // A limitation: of what lies beside the end of the surface, the nearest point of it is found to
  // first order only, which one model of 300 shows.
  constexpr double MostOfAttribute = 1.1;
  const double attributeTolerance = options.AttributeTolerances[0];
  double worstAttribute = 0.0;
  std::ostringstream between;
  for (Eigen::Index c = 0; c < mesh.Cells.cols() && triangles; ++c)
  {
    Eigen::Matrix3d X;
    Eigen::Matrix3d U;
    Eigen::MatrixXd A(mesh.Attributes[0].rows(), 3);
    Eigen::Vector3d up = Eigen::Vector3d::Zero();
    for (int k = 0; k < 3; ++k)
    {
      A.col(k) = mesh.Attributes[0].col(mesh.Cells(k, c));
      X.col(k) = mesh.Points.col(mesh.Cells(k, c));
      U.col(k) = mesh.Parameters.col(mesh.Cells(k, c));
      up += mesh.Normals.col(mesh.Cells(k, c));
    }
    const Eigen::Vector3d n = (X.col(1) - X.col(0)).cross(X.col(2) - X.col(0));
    const double longest = std::max(
      { (X.col(1) - X.col(0)).norm(), (X.col(2) - X.col(0)).norm(), (X.col(2) - X.col(1)).norm() });
    if (n.dot(up) <= 0.0)
    {
      ++slivers;
      if (n.norm() > 2.0 * tolerance * longest && isDecided && certificate.ToleranceReached)
      {
        between << "triangle " << c << " turned over, height " << n.norm() / longest / tolerance
                << " tolerances; ";
      }
    }
    if (c % stride != 0)
    {
      continue;
    }
    static constexpr int Parts = 4;
    for (int i = 0; i <= Parts; ++i)
    {
      for (int j = 0; i + j <= Parts; ++j)
      {
        const Eigen::Vector3d weights =
          Eigen::Vector3d(i, j, Parts - i - j) / static_cast<double>(Parts);
        if (weights.maxCoeff() == 1.0)
        {
          continue;
        }
        worst = std::max(worst, exact.Distance(X * weights, U * weights, tolerance));
        if (attributeTolerance > 0.0)
        {
          const Exact::Found found = exact.FindByNewton(X * weights, U * weights);
          const Eigen::VectorXd there =
            model.Body->Attributes()[0].Field.Evaluate(found.At[0], found.At[1], found.At[2]);
          const double off = (A * weights - there).cwiseAbs().maxCoeff() / attributeTolerance;
          worstAttribute = std::max(worstAttribute, found.Distance <= tolerance ? off : 0.0);
        }
      }
    }
  }
  tally.Slivers += slivers;
  if (certificate.ToleranceReached && isDecided && worst > tolerance)
  {
    between << "triangles off by " << worst / tolerance << " tolerances; ";
  }
  if (certificate.ToleranceReached && certificate.LargestAttributeError > 1.0)
  {
    flaws << "certified attribute error " << certificate.LargestAttributeError << "; ";
  }
  if (certificate.ToleranceReached && isDecided && worstAttribute > MostOfAttribute)
  {
    between << "attribute off by " << worstAttribute << " tolerances; ";
  }

  // Zeros between the nodes of a grid: the mesh is near, or a narrow undecided cell around them.
  EXPECT_EQ(static_cast<std::int64_t>(zeroSet.UndecidedBoxes().size()), certificate.UndecidedCells);
  // A box that is 0 all over may be wide: no smaller one in it would say more, and nothing in it is
  // a surface. All of its corners, faces and inside count, so that no sheet hides beside a plateau.
  std::vector<ParameterBox> narrow;
  std::copy_if(zeroSet.UndecidedBoxes().begin(), zeroSet.UndecidedBoxes().end(),
    std::back_inserter(narrow),
    [&](const ParameterBox& box)
    { return exact.Width(box) <= (1.0 + 1e-9) * tolerance || exact.IsZero(box); });
  if (certificate.ToleranceReached)
  {
    std::array<std::vector<double>, 3> at;
    const std::size_t N = nodes;
    const std::vector<double> values = Sample(exact, N, at);
    std::vector<std::array<std::size_t, 2>> crossings; // node and direction
    const std::array<std::size_t, 3> step{ 1, N, N * N };
    for (std::size_t node = 0; node < values.size(); ++node)
    {
      const std::array<std::size_t, 3> ijk{ node % N, node / N % N, node / (N * N) };
      for (std::size_t d = 0; d < 3; ++d)
      {
        // A value that is 0 but for the rounding of its own evaluation has no sign that anybody
        // could know; this is a few hundred eps, which a sum of up to 1000 terms of both signs
        // needs.
        if (ijk[d] + 1 < N && values[node] * values[node + step[d]] < 0.0 &&
          std::min(std::abs(values[node]), std::abs(values[node + step[d]])) > 1e-13 * model.Scale)
        {
          crossings.push_back({ node, d });
        }
      }
    }
    const std::size_t most = N * N / 4;
    double farthest = 0.0;
    // What bisection leaves open, and rounding.
    const Eigen::Array3d slack =
      1e-12 * (exact.High - exact.Low).cwiseMax(exact.High.cwiseAbs()).array();
    for (std::size_t i = 0; i < crossings.size(); i += 1 + crossings.size() / most)
    {
      const auto [node, d] = crossings[i];
      Eigen::Vector3d u(at[0][node % N], at[1][node / N % N], at[2][node / (N * N)]);
      double low = u[static_cast<Eigen::Index>(d)];
      double high = at[d][(d == 0 ? node % N : d == 1 ? node / N % N : node / (N * N)) + 1];
      for (int halving = 0; halving < 40; ++halving)
      {
        double& x = u[static_cast<Eigen::Index>(d)];
        x = 0.5 * (low + high);
        ((exact.Value(u) < 0.0) == (values[node] < 0.0) ? low : high) = x;
      }
      const bool isListed = std::any_of(narrow.begin(), narrow.end(),
        [&u, &slack](const ParameterBox& box)
        {
          return (u.array() >= Eigen::Array3d(box.Low.data()) - slack).all() &&
            (u.array() <= Eigen::Array3d(box.High.data()) + slack).all();
        });
      if (isListed)
      {
        continue;
      }
      Eigen::Vector3d x;
      exact.Geometry.Evaluate(1, u.data(), x.data());
      double nearest = INFINITY;
      for (Eigen::Index c = 0; c < mesh.Cells.cols(); ++c)
      {
        const Eigen::Vector3d a = mesh.Points.col(mesh.Cells(0, c));
        const Eigen::Vector3d b = mesh.Points.col(mesh.Cells(1, c));
        const Eigen::Vector3d e = mesh.Points.col(mesh.Cells(2, c));
        const bool mayBeNear = ((a.cwiseMin(b).cwiseMin(e) - x).array() < nearest).all() &&
          ((x - a.cwiseMax(b).cwiseMax(e)).array() < nearest).all();
        nearest = mayBeNear ? std::min(nearest, DistanceToTriangle(x, a, b, e)) : nearest;
      }
      farthest = std::max(farthest, nearest);
    }
    if (farthest > tolerance)
    {
      flaws << "a zero is " << farthest / tolerance << " tolerances from the mesh; ";
    }
  }

  result.Surface = flaws.str();
  result.Triangles = between.str();
  if (isDecided && result.Surface.empty())
  {
    std::vector<topology::Invariants> seen;
    const Reference reference = Compare(exact, welded.Topology, seen);
    ++(reference == Reference::Unsettled ? tally.Skipped : tally.Compared);
    if (reference == Reference::Differs)
    {
      flaws << "(" << welded.Topology.Euler << ", " << welded.Topology.Components << ", "
            << welded.Topology.BoundaryLoops << ") but on grids";
      for (const auto& t : seen)
      {
        flaws << " (" << t.Euler << ", " << t.Components << ", " << t.BoundaryLoops << ")";
      }
      result.Topology = flaws.str();
    }
  }
  return result;
}

void CheckSeeds(RandomZeroSet::Kind kind, unsigned count, bool triangles, Tally& tally)
{
  for (unsigned seed = 0; seed < count; ++seed)
  {
    const RandomZeroSet model(kind, seed);
    const Flaws flaws = Check(model, triangles, tally);
    EXPECT_EQ(flaws.Surface, "") << "seed " << seed << ": " << model.Description;
    EXPECT_EQ(flaws.Triangles, "") << "seed " << seed << ": " << model.Description;
    EXPECT_EQ(flaws.Topology, "") << "seed " << seed << ": " << model.Description;
  }
}

}

TEST(ZeroSetRandom, ContinuousCoefficientsGiveSurfacesLikeTheirReference)
{
  Tally tally;
  CheckSeeds(RandomZeroSet::Kind::Generic, 700, false, tally);
  EXPECT_LE(tally.Missed, tally.Seeds / 20);
  EXPECT_LE(tally.Skipped, tally.Compared / 20);
  // Half of the tolerances are coarser than the features of the fields.
  EXPECT_LE(tally.Undecided, tally.Seeds / 2);
}

TEST(ZeroSetRandom, WhatIsUndecidedIsDecidedWithSmallerTolerances)
{
  int undecided = 0;
  int decided = 0;
  for (unsigned seed = 0; seed < 60; ++seed)
  {
    const RandomZeroSet model(RandomZeroSet::Kind::Generic, seed);
    const QuadricField field(model.Function(), model.Q, !model.OfAttribute);
    for (const double tolerance : { 3e-2, 3e-3 })
    {
      ZeroSetOptions options;
      options.Tolerance = tolerance * model.Diagonal;
      options.Handedness = model.Options.Handedness;
      ZeroSet zeroSet(*model.Body, field, options);
      ASSERT_TRUE(zeroSet.Extract());
      const bool isDecided = zeroSet.Certificate().UndecidedCells == 0;
      undecided += !isDecided && tolerance == 3e-2 ? 1 : 0;
      decided += isDecided && tolerance == 3e-3 ? 1 : 0;
    }
  }
  EXPECT_GE(undecided, 6);
  EXPECT_GE(decided, 54);
}

TEST(ZeroSetRandom, ZerosOnNodesAndKnotPlanesGiveSurfaces)
{
  Tally tally;
  CheckSeeds(RandomZeroSet::Kind::Integers, 200, false, tally);
}

TEST(ZeroSetRandom, PlateausEndInSurfaces)
{
  Tally tally;
  CheckSeeds(RandomZeroSet::Kind::Plateaus, 150, false, tally);
}

// Each of these has had a zero far from the surface and in no narrow box: a thin piece along an
// edge of the domain joined into nothing; a sheet of which signs at the corners of boxes show
// nothing, which enters certified boxes from undecided ones or along a face of the domain; a
// triangle whose normals tell too little of its error (2399: of which the reference saw no
// surface).
TEST(ZeroSetRandom, EveryZeroIsNearTheSurfaceOrInANarrowBox)
{
  using Kind = RandomZeroSet::Kind;
  const std::vector<std::pair<Kind, std::vector<unsigned>>> seeds{
    { Kind::Generic, { 216, 1425, 2399, 2873, 3933 } },
    { Kind::Integers,
      { 119, 537, 548, 678, 1325, 1351, 1373, 2177, 2342, 2816, 3213, 3359, 3478, 3563, 3624, 3890,
        3934 } },
    { Kind::Plateaus, { 266, 417, 515, 660, 1093, 1322, 1405, 1813, 3987 } }
  };
  Tally tally;
  for (const auto& [kind, some] : seeds)
  {
    for (const unsigned seed : some)
    {
      const RandomZeroSet model(kind, seed);
      constexpr std::size_t Nodes = 31;
      const Flaws flaws = Check(model, kind == Kind::Generic, tally, Nodes);
      EXPECT_EQ(flaws.Surface + flaws.Triangles, "")
        << "seed " << seed << ": " << model.Description;
    }
  }
}

// The geometry of these folds over at an edge of the domain.
TEST(ZeroSetRandom, NormalsKeepTheirSideThroughFolds)
{
  Tally tally;
  for (const unsigned seed : { 1090u, 1686u })
  {
    const RandomZeroSet model(RandomZeroSet::Kind::Plateaus, seed);
    EXPECT_EQ(Check(model, false, tally).Surface, "") << "seed " << seed;
  }
}

TEST(ZeroSetRandom, NoTriangleLeavesTheToleranceOrTurnsOver)
{
  Tally tally;
  CheckSeeds(RandomZeroSet::Kind::Generic, 300, true, tally);
}
