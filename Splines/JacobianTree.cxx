// SPDX-License-Identifier: BSD-3-Clause
#include "JacobianTree.h"

#include "Bernstein.h"
#include "Error.h"
#include "JacobianField.h"
#include "Operators.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <queue>
#include <utility>

namespace hyperpatch
{

namespace
{

constexpr double UnitRoundoff = std::numeric_limits<double>::epsilon() / 2;

/// A cell is not halved when it is narrower than this fraction of the domain.
constexpr double LeastEdge = 1e-12;

double Width(const Interval& interval)
{
  return interval.High - interval.Low;
}

Interval Intersection(const Interval& a, const Interval& b)
{
  return { std::max(a.Low, b.Low), std::min(a.High, b.High) };
}

Interval operator+(const Interval& a, const Interval& b)
{
  return { a.Low + b.Low, a.High + b.High };
}

/// \param factor of non-negative numbers
Interval Times(const Interval& factor, const Interval& a)
{
  return { std::min(factor.Low * a.Low, factor.High * a.Low),
    std::max(factor.Low * a.High, factor.High * a.High) };
}

/// Directions and lengths of a derivative on a cell.
struct Bounded
{
  Cone Directions;
  Interval Lengths{ 0.0, 0.0 };
};

Bounded Bound(const Eigen::Matrix3Xd& vectors)
{
  Bounded result;
  result.Directions = Cone::Around(vectors);
  if (vectors.cols() > 0)
  {
    result.Lengths.High = vectors.colwise().norm().maxCoeff();
  }
  // The least length of a combination is that along the axis of the cone.
  if (!result.Directions.IsEverything() && result.Directions.ZeroVectors() == 0)
  {
    result.Lengths.Low = std::max(0.0, (result.Directions.Axis().transpose() * vectors).minCoeff());
  }
  return result;
}

/// The paper's equation (1), with the length of every factor.
Interval Determinant(const Bounded& a, const Bounded& b, const Bounded& c)
{
  const Interval lengths{ a.Lengths.Low * b.Lengths.Low * c.Lengths.Low,
    a.Lengths.High * b.Lengths.High * c.Lengths.High };
  if (lengths.High == 0.0)
  {
    return { 0.0, 0.0 };
  }
  // Of unit vectors b and c the product is the shorter the nearer they are to parallel.
  const Interval cosine = Dot(a.Directions, Cross(b.Directions, c.Directions));
  const Interval shortened{ std::min(0.0, cosine.Low), std::max(0.0, cosine.High) };
  return Times(lengths, shortened);
}

/// The geometry on one cell.
class Net
{
public:
  /// \param roundings bounds the error of every homogeneous control point, in units of the unit
  /// roundoff times the largest one
  Net(Spline spline, double roundings)
    : S(std::move(spline))
    , Roundings(roundings)
  {
  }

  /// \param box half of this one, along a direction
  [[nodiscard]] Net Half(const ParameterBox& box, int direction) const
  {
    return Net(RestrictToBox(this->S, box.Low, box.High),
      this->Roundings + RoundingsOfHalving(this->S.Knots(direction).Degree()));
  }

  /// Knots are inserted by convex sums, with five roundings per degree in each weight.
  static double RoundingsOfHalving(int degree) { return 6.0 + 6.0 * degree; }

  /// The cone of the derivative in a direction.
  [[nodiscard]] Cone Directions(int direction) const
  {
    // As in JacobianSign.h: differences of homogeneous points about the centre, each right up to
    // the difference of the weights times the distance of the volume from the centre.
    const auto points = this->S.Coefficients();
    const Eigen::Vector3d centre =
      0.5 * points.rowwise().minCoeff() + 0.5 * points.rowwise().maxCoeff();
    const Eigen::Matrix3Xd about = points.colwise() - centre;
    const double radius = about.colwise().norm().maxCoeff();
    const auto weight = [this](Eigen::Index i)
    { return this->S.IsRational() ? this->S.Weights()[i] : 1.0; };
    const Eigen::Index size = this->S.Sizes()[Index(direction)];
    Eigen::Index step = 1;
    for (int d = 0; d < direction; ++d)
    {
      step *= this->S.Sizes()[Index(d)];
    }
    Eigen::Matrix3Xd vectors(3, points.cols());
    Eigen::Index count = 0;
    double difference = 0.0;
    for (Eigen::Index i = 0; i + step < points.cols(); ++i)
    {
      if (i / step % size + 1 < size)
      {
        vectors.col(count++) = weight(i + step) * about.col(i + step) - weight(i) * about.col(i);
        difference = std::max(difference, std::abs(weight(i + step) - weight(i)));
      }
    }
    // The roundings of the points so far and of the lines above, in points and in weights; dividing
    // by the weights brings their ratio along.
    const double greatest = this->S.IsRational() ? this->S.Weights().maxCoeff() : 1.0;
    const double least = this->S.IsRational() ? this->S.Weights().minCoeff() : 1.0;
    const double error = UnitRoundoff * (2.0 * this->Roundings + 8.0) *
      points.cwiseAbs().maxCoeff() * greatest * (this->S.IsRational() ? greatest / least : 1.0);
    return Cone::Around(vectors.leftCols(count),
      (1.0 + 8.0 * UnitRoundoff) *
        (radius * (difference + 2.0 * UnitRoundoff * (this->Roundings + 1.0) * greatest) +
          4.0 * error));
  }

  /// The paper's I_u, I_v, I_w: bounds of the gradient of det J, in every component the sum of
  /// three determinants.
  [[nodiscard]] std::array<Interval, 3> Gradient() const
  {
    const Spline plain(this->S.Knots(), this->S.Coefficients());
    std::array<Bounded, 3> first;
    std::array<std::array<Bounded, 3>, 3> second;
    for (int a = 0; a < 3; ++a)
    {
      const Spline derivative = Derivative(plain, a);
      first[Index(a)] = Bound(derivative.Coefficients());
      for (int b = a; b < 3; ++b)
      {
        second[Index(a)][Index(b)] = Bound(Derivative(derivative, b).Coefficients());
        second[Index(b)][Index(a)] = second[Index(a)][Index(b)];
      }
    }
    std::array<Interval, 3> gradient{};
    for (std::size_t d = 0; d < 3; ++d)
    {
      gradient[d] = Determinant(second[0][d], first[1], first[2]) +
        Determinant(first[0], second[1][d], first[2]) +
        Determinant(first[0], first[1], second[2][d]);
    }
    return gradient;
  }

private:
  static std::size_t Index(int i) { return static_cast<std::size_t>(i); }

  Spline S;
  double Roundings;
};

/// Bounds of det J and its gradient on boxes.
class Bounds
{
public:
  Bounds(const Spline& geometry, JacobianBound method)
    : Field(geometry)
    , Method(method)
    , Breaks(Field.Breaks())
  {
  }

  /// Bounds of det J; the flag says that it certainly does not vanish.
  [[nodiscard]] std::pair<Interval, bool> Find(const Net& net, const ParameterBox& box)
  {
    if (this->Method == JacobianBound::Bernstein)
    {
      Interval all{ INFINITY, -INFINITY };
      bool positive = true;
      bool negative = true;
      this->ForElements(box,
        [&](const ParameterBox& /*part*/, const Bernstein& f, double volume)
        {
          all = { std::min(all.Low, f.Min() / volume), std::max(all.High, f.Max() / volume) };
          positive = positive && f.Min() > f.RoundingBound();
          negative = negative && f.Max() < -f.RoundingBound();
        });
      if (this->Scale == 0.0)
      {
        this->Scale = std::max({ -all.Low, all.High, 1e-300 });
      }
      return { { all.Low / this->Scale, all.High / this->Scale }, positive || negative };
    }
    const Cone u = net.Directions(0);
    const Cone v = net.Directions(1);
    const Cone w = net.Directions(2);
    // Zero vectors have no direction: where only they have weight det J vanishes.
    const bool isDegenerate = u.ZeroVectors() + v.ZeroVectors() + w.ZeroVectors() > 0;
    const Interval bound =
      this->Method == JacobianBound::Cones ? Dot(u, Cross(v, w)) : TripleProduct(u, v, w);
    return { bound, !isDegenerate && (bound.Low > 0.0 || bound.High < 0.0) };
  }

  /// How much the gradient of det J varies, per direction.
  [[nodiscard]] std::array<double, 3> GradientWidths(const Net& net, const ParameterBox& box) const
  {
    if (this->Method != JacobianBound::Bernstein)
    {
      const auto gradient = net.Gradient();
      return { Width(gradient[0]), Width(gradient[1]), Width(gradient[2]) };
    }
    std::array<Interval, 3> all{};
    all.fill({ INFINITY, -INFINITY });
    this->ForElements(box,
      [&all](const ParameterBox& part, const Bernstein& f, double volume)
      {
        for (std::size_t d = 0; d < 3; ++d)
        {
          const double scale = 1.0 / (volume * (part.High[d] - part.Low[d]));
          const Bernstein g = f.Derivative(static_cast<int>(d));
          all[d] = { std::min(all[d].Low, scale * g.Min()),
            std::max(all[d].High, scale * g.Max()) };
        }
      });
    return { Width(all[0]), Width(all[1]), Width(all[2]) };
  }

private:
  /// Calls body(part, det J with respect to the unit cube of the part, volume of the part) for the
  /// parts of the box between knots.
  template <class Body>
  void ForElements(const ParameterBox& box, const Body& body) const
  {
    std::array<std::vector<double>, 3> cuts;
    for (std::size_t d = 0; d < 3; ++d)
    {
      cuts[d].push_back(box.Low[d]);
      std::copy_if(this->Breaks[d].begin(), this->Breaks[d].end(), std::back_inserter(cuts[d]),
        [&](double b) { return box.Low[d] < b && b < box.High[d]; });
      cuts[d].push_back(box.High[d]);
    }
    for (std::size_t k = 0; k + 1 < cuts[2].size(); ++k)
    {
      for (std::size_t j = 0; j + 1 < cuts[1].size(); ++j)
      {
        for (std::size_t i = 0; i + 1 < cuts[0].size(); ++i)
        {
          const ParameterBox part{ { cuts[0][i], cuts[1][j], cuts[2][k] },
            { cuts[0][i + 1], cuts[1][j + 1], cuts[2][k + 1] } };
          const double volume = (part.High[0] - part.Low[0]) * (part.High[1] - part.Low[1]) *
            (part.High[2] - part.Low[2]);
          body(part, *this->Field.OnBox(part), volume);
        }
      }
    }
  }

  JacobianField Field;
  JacobianBound Method;
  std::array<std::vector<double>, 3> Breaks;
  double Scale = 0.0;
};

}

JacobianTree::JacobianTree(const Spline& geometry, const JacobianTreeOptions& options)
{
  if (!(options.MinimumWidth >= 0.0))
  {
    throw Error("the minimal width of intervals of det J is from 0 on, not " +
      std::to_string(options.MinimumWidth));
  }
  Bounds bounds(geometry, options.Bound);
  Cell root{};
  std::array<double, 3> least{};
  for (std::size_t d = 0; d < 3; ++d)
  {
    root.Box.Low[d] = geometry.Knots()[d].First();
    root.Box.High[d] = geometry.Knots()[d].Last();
    least[d] = LeastEdge * (root.Box.High[d] - root.Box.Low[d]);
  }

  // Wide intervals first, older cells first among equal ones. Nets are those of the cells in it.
  std::priority_queue<std::pair<double, int>> queue;
  std::map<int, Net> nets;
  const auto add = [&](Cell cell, Net net)
  {
    const auto [bound, excluded] = bounds.Find(net, cell.Box);
    cell.Bound = cell.Parent < 0
      ? bound
      : Intersection(bound, this->C[static_cast<std::size_t>(cell.Parent)].Bound);
    cell.Discarded = excluded;
    const int index = static_cast<int>(this->C.size());
    this->C.push_back(cell);
    if (!excluded)
    {
      queue.emplace(Width(cell.Bound), -index);
      nets.emplace(index, std::move(net));
    }
    return index;
  };
  double roundings = 0.0;
  for (const int degree : geometry.Degrees())
  {
    roundings += Net::RoundingsOfHalving(degree);
  }
  Net whole(RestrictToBox(geometry, root.Box.Low, root.Box.High), roundings);
  add(root, std::move(whole));

  while (!queue.empty())
  {
    const auto [width, negative] = queue.top();
    const std::size_t cells = queue.size() + this->Q.size();
    this->S.push_back({ width, cells });
    if (width < options.MinimumWidth || cells >= options.MaximumCells || options.Abort(cells))
    {
      break;
    }
    queue.pop();
    const int index = -negative;
    const Net net = std::move(nets.extract(index).mapped());
    const ParameterBox box = this->C[static_cast<std::size_t>(index)].Box;
    const std::array<double, 3> gradient = bounds.GradientWidths(net, box);
    // Where the gradient is constant the cell is cut across its longest edge.
    int axis = -1;
    std::array<double, 2> most{ -1.0, 0.0 };
    for (std::size_t d = 0; d < 3; ++d)
    {
      const double edge = box.High[d] - box.Low[d];
      const std::array<double, 2> variation{ gradient[d] * edge, edge / least[d] };
      if (edge > least[d] && variation > most)
      {
        most = variation;
        axis = static_cast<int>(d);
      }
    }
    if (axis < 0)
    {
      this->Q.push_back(index);
      continue;
    }
    this->C[static_cast<std::size_t>(index)].Axis = axis;
    for (std::size_t side = 0; side < 2; ++side)
    {
      Cell child{};
      child.Parent = index;
      child.Box = box;
      const auto A = static_cast<std::size_t>(axis);
      (side == 0 ? child.Box.High : child.Box.Low)[A] = 0.5 * (box.Low[A] + box.High[A]);
      const int at = add(child, net.Half(child.Box, axis));
      this->C[static_cast<std::size_t>(index)].Children[side] = at;
    }
  }
  if (queue.empty())
  {
    this->S.push_back({ 0.0, this->Q.size() });
  }
  for (const auto& entry : nets)
  {
    this->Q.push_back(entry.first);
  }
  std::sort(this->Q.begin(), this->Q.end());
}

}
