// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_testing_TurnedPatches_h
#define hyperpatch_testing_TurnedPatches_h

#include "Aggregate.h"
#include "Interfaces.h"
#include "Operators.h"
#include "Splines/Models.h"

#include <algorithm>
#include <array>
#include <random>
#include <vector>

/// Volumes of several patches that meet in every relative orientation.
namespace models
{

/// Another parametrisation of the same volume: direction d of the result is direction from[d] of
/// the spline, run backwards where flipped[d].
struct Turn
{
  std::array<int, 3> From{ 0, 1, 2 };
  std::array<bool, 3> Flipped{};

  static Turn Number(int n)
  {
    Turn turn;
    for (int i = 0; i < n % 6; ++i)
    {
      std::next_permutation(turn.From.begin(), turn.From.end());
    }
    for (std::size_t d = 0; d < 3; ++d)
    {
      turn.Flipped[d] = (n / 6 >> d & 1) != 0;
    }
    return turn;
  }
  [[nodiscard]] int Sign() const
  {
    const int inversions = (From[0] > From[1]) + (From[0] > From[2]) + (From[1] > From[2]);
    return (inversions + Flipped[0] + Flipped[1] + Flipped[2]) % 2 == 0 ? 1 : -1;
  }
};

inline Spline Turned(const Spline& spline, const Turn& turn)
{
  std::array<KnotVector, 3> knots;
  std::array<int, 3> sizes{};
  for (std::size_t d = 0; d < 3; ++d)
  {
    const KnotVector& old = spline.Knots(turn.From[d]);
    std::vector<double> k = old.Knots();
    if (turn.Flipped[d])
    {
      for (double& x : k)
      {
        x = old.First() + old.Last() - x;
      }
      std::reverse(k.begin(), k.end());
    }
    knots[d] = KnotVector(old.Degree(), k);
    sizes[d] = old.Size();
  }
  const auto n = spline.Sizes();
  Eigen::MatrixXd points(spline.Components(), spline.NumberOfControlPoints());
  Eigen::VectorXd weights(spline.IsRational() ? points.cols() : 0);
  for (Eigen::Index i = 0; i < points.cols(); ++i)
  {
    const std::array<Eigen::Index, 3> at{ i % sizes[0], i / sizes[0] % sizes[1],
      i / (sizes[0] * sizes[1]) };
    std::array<Eigen::Index, 3> old{};
    for (std::size_t d = 0; d < 3; ++d)
    {
      old[static_cast<std::size_t>(turn.From[d])] = turn.Flipped[d] ? sizes[d] - 1 - at[d] : at[d];
    }
    const Eigen::Index from = old[0] + n[0] * (old[1] + n[1] * old[2]);
    points.col(i) = spline.Coefficients().col(from);
    if (spline.IsRational())
    {
      weights[i] = spline.Weights()[from];
    }
  }
  return Spline(knots, points, weights);
}

/// A curved rational volume about the unit cube, with an attribute of another basis.
inline Aggregate Curved(int seed)
{
  std::mt19937 random(static_cast<unsigned>(seed));
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const KnotVector k(2, { 0, 0, 0, 0.3, 0.8, 1, 1, 1 });
  Eigen::MatrixXd points(3, 125);
  Eigen::VectorXd weights(125);
  for (int i = 0; i < 125; ++i)
  {
    points.col(i) << k.Greville(i % 5), k.Greville(i / 5 % 5), k.Greville(i / 25);
    points.col(i) += 0.04 * Eigen::Vector3d(unit(random), unit(random), unit(random));
    weights[i] = 1.0 + 0.2 * unit(random);
  }
  const KnotVector a = KnotVector::Uniform(3, 6);
  return Aggregate(Spline({ k, k, k }, points, weights),
    { { "A", models::RandomSpline(random, { a, a, a }, 1, true) } });
}

/// The parts of a volume between cuts in the middle of directions, each in a turned
/// parametrisation, with their interfaces.
inline MultiPatch Split(
  const Aggregate& whole, std::array<int, 3> pieces, const std::vector<Turn>& turns)
{
  MultiPatch model;
  for (int i = 0; i < pieces[0] * pieces[1] * pieces[2]; ++i)
  {
    const std::array<int, 3> at{ i % pieces[0], i / pieces[0] % pieces[1],
      i / (pieces[0] * pieces[1]) };
    std::array<double, 3> low{};
    std::array<double, 3> high{};
    for (std::size_t d = 0; d < 3; ++d)
    {
      low[d] = static_cast<double>(at[d]) / pieces[d];
      high[d] = static_cast<double>(at[d] + 1) / pieces[d];
    }
    const Turn& turn = turns[static_cast<std::size_t>(i)];
    std::vector<Attribute> attributes;
    for (const Attribute& attribute : whole.Attributes())
    {
      attributes.push_back(
        { attribute.Name, Turned(RestrictToBox(attribute.Field, low, high), turn) });
    }
    model.Patches.push_back(
      { i, Aggregate(Turned(RestrictToBox(whole.Geometry(), low, high), turn), attributes) });
    model.Patches.back().WholeHandedness = turn.Sign();
  }
  model.Interfaces = FindInterfaces(model, 1e-9);
  return model;
}

}

#endif
