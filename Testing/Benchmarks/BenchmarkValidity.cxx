// SPDX-License-Identifier: BSD-3-Clause

// Certification of random cubic cells, how many cells cones and Bernstein coefficients visit until
// the boundary det J = 0 is cut out at a fixed depth, and global injectivity.

#include "Bernstein.h"
#include "CondeTorres.h"
#include "Cone.h"
#include "GlobalInjectivity.h"
#include "Validity.h"

#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

namespace
{

using namespace hyperpatch;

/// Bezier control points on a lattice of spacing 1, each coordinate moved by up to `noise`.
std::vector<double> RandomCells(std::size_t count, double noise)
{
  std::mt19937 random(1);
  std::uniform_real_distribution<double> move(-noise, noise);
  std::vector<double> points;
  points.reserve(192 * count);
  for (std::size_t cell = 0; cell < count; ++cell)
  {
    for (int i = 0; i < 64; ++i)
    {
      points.push_back(i % 4 + move(random));
      points.push_back(i / 4 % 4 + move(random));
      points.push_back(i / 16 + move(random));
    }
  }
  return points;
}

/// Noise in percent of the lattice spacing, tolerance of the bounds in percent.
void RandomTricubicCells(benchmark::State& state)
{
  constexpr std::size_t Count = 4096;
  const std::vector<double> points = RandomCells(Count, 0.01 * static_cast<double>(state.range(0)));
  ValidityOptions options;
  options.Tolerance = 0.01 * static_cast<double>(state.range(1));
  ValidityTest test({ 3, 3, 3 }, false, options);
  std::vector<ElementValidity> results(Count);
  for (auto _ : state)
  {
    test(Count, points.data(), nullptr, results.data());
    benchmark::ClobberMemory();
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(Count));
  double cones = 0;
  double valid = 0;
  double invalid = 0;
  double boxes = 0;
  for (const ElementValidity& result : results)
  {
    cones += result.By == Certificate::Cones;
    valid += result.Verdict == 1;
    invalid += result.Verdict == -1;
    boxes += result.Boxes;
  }
  state.counters["cones%"] = 100 * cones / Count;
  state.counters["valid%"] = 100 * valid / Count;
  state.counters["invalid%"] = 100 * invalid / Count;
  state.counters["boxes"] = boxes / Count;
}

//------------------------------------------------------------------------------------------------
// Visited cells.

/// The points of a cubic curve from (1, 0) over (0, 1) to (-1, 0): a half circle to 2 percent.
Eigen::Matrix3Xd CubicArc()
{
  Eigen::Matrix3Xd points(3, 4);
  points << 1, 1, -1, -1, 0, 4.0 / 3, 4.0 / 3, 0, 0, 0, 0, 0;
  return points;
}

/// Tricubic volumes: u and v a section, w the sweep.
Eigen::MatrixXd HalfCylinderSwept()
{
  const Eigen::Matrix3Xd arc = CubicArc();
  Eigen::MatrixXd points(3, 64);
  for (int i = 0; i < 64; ++i)
  {
    points.col(i) = arc.col(i % 4) + Eigen::Vector3d(i / 16, 0, (i / 4 % 4) / 3.0);
  }
  return points;
}

/// Four sections, a wavy sheet, rotated by up to `degrees` in total about the axis z of the sweep
/// or about x, lofted.
Eigen::MatrixXd RotatedSweep(double degrees, bool aboutSweep)
{
  Eigen::MatrixXd points(3, 64);
  for (int i = 0; i < 64; ++i)
  {
    const double angle = degrees * 3.14159265358979 / 180.0 * (i / 16) / 3.0;
    const double x = (i % 4) / 3.0;
    const double y = (i / 4 % 4) / 3.0;
    const double z = 0.5 * std::sin(2.5 * x) * std::cos(2.0 * y);
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    points.col(i) = aboutSweep ? Eigen::Vector3d(c * x - s * z, y, s * x + c * z)
                               : Eigen::Vector3d(x, c * y - s * z, s * y + c * z);
    points.col(i) += i / 16 / 3.0 * Eigen::Vector3d(aboutSweep ? 0.3 : 0.6, 0.4, 0.5);
  }
  return points;
}

enum Method
{
  OneOrder,
  BestOfThree,
  BernsteinCoefficients
};

struct Cell
{
  std::array<Bernstein, 3> X;
  Bernstein J;
};

bool IsExcluded(const Cell& cell, Method method)
{
  if (method == BernsteinCoefficients)
  {
    return cell.J.Min() > cell.J.RoundingBound() || cell.J.Max() < -cell.J.RoundingBound();
  }
  Eigen::MatrixXd points(3, cell.X[0].Coefficients().size());
  for (int r = 0; r < 3; ++r)
  {
    points.row(r) = cell.X[static_cast<std::size_t>(r)].Coefficients().transpose();
  }
  std::array<Cone, 3> cones;
  for (int d = 0; d < 3; ++d)
  {
    cones[static_cast<std::size_t>(d)] = DerivativeCone(points, cell.X[0].Degrees(), d);
  }
  if (method == BestOfThree)
  {
    return TripleProductSign(cones[0], cones[1], cones[2]) != 0;
  }
  const Interval dot = Dot(cones[0], Cross(cones[1], cones[2]));
  return dot.Low > 0.0 || dot.High < 0.0;
}

void Visit(const Cell& cell, Method method, int depth, std::int64_t& visited, std::int64_t& leaves)
{
  ++visited;
  if (IsExcluded(cell, method))
  {
    return;
  }
  if (depth == 0)
  {
    ++leaves;
    return;
  }
  std::array<Cell, 2> halves;
  if (method == BernsteinCoefficients)
  {
    const auto parts = cell.J.Split(depth % 3);
    halves[0].J = parts[0];
    halves[1].J = parts[1];
  }
  else
  {
    for (std::size_t r = 0; r < 3; ++r)
    {
      const auto parts = cell.X[r].Split(depth % 3);
      halves[0].X[r] = parts[0];
      halves[1].X[r] = parts[1];
    }
  }
  Visit(halves[0], method, depth - 1, visited, leaves);
  Visit(halves[1], method, depth - 1, visited, leaves);
}

void VisitedCells(benchmark::State& state)
{
  const auto model = state.range(0);
  const Eigen::MatrixXd points = model == 0 ? HalfCylinderSwept() : RotatedSweep(35, model == 2);
  const auto method = static_cast<Method>(state.range(1));
  const int depth = model == 0 ? 15 : 18;
  Cell root;
  for (int r = 0; r < 3; ++r)
  {
    root.X[static_cast<std::size_t>(r)] = Bernstein({ 3, 3, 3 }, points.row(r).transpose());
  }
  root.J = JacobianDeterminant(points, { 3, 3, 3 }, false);
  std::int64_t visited = 0;
  std::int64_t leaves = 0;
  for (auto _ : state)
  {
    visited = 0;
    leaves = 0;
    Visit(root, method, depth, visited, leaves);
  }
  state.counters["visited"] = static_cast<double>(visited);
  state.counters["leaves"] = static_cast<double>(leaves);
}

//------------------------------------------------------------------------------------------------
// Whole models.

/// A tricubic volume of n^3 elements in one patch, control points moved by a fifth of the noise
/// that turns cells over.
MultiPatch RandomVolume(int n)
{
  const KnotVector knots = KnotVector::Uniform(3, n + 3, 0.0, n);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> move(-0.06, 0.06);
  Eigen::Matrix3Xd points(3, (n + 3) * (n + 3) * (n + 3));
  for (int i = 0; i < points.cols(); ++i)
  {
    const Eigen::Vector3d at(knots.Greville(i % (n + 3)), knots.Greville(i / (n + 3) % (n + 3)),
      knots.Greville(i / (n + 3) / (n + 3)));
    points.col(i) = at + Eigen::Vector3d(move(random), move(random), move(random));
  }
  MultiPatch model;
  model.Patches.push_back({ 0, Aggregate(Spline({ knots, knots, knots }, points)) });
  return model;
}

void GlobalInjectivity(benchmark::State& state)
{
  const MultiPatch model = RandomVolume(static_cast<int>(state.range(0)));
  ValidityOptions options;
  options.Tolerance = 0.0;
  const std::vector<PatchValidity> validity{ TestValidity(
    model.Patches[0].Body.Geometry(), options) };
  Injectivity result;
  for (auto _ : state)
  {
    result = TestInjectivity(model, validity);
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(result.Elements));
  state.counters["verdict"] = result.Verdict;
  state.counters["pairs"] = static_cast<double>(result.Pairs);
  state.counters["boxes"] = static_cast<double>(result.Boxes);
}

void CondeTorresTest(benchmark::State& state)
{
  const MultiPatch model = RandomVolume(static_cast<int>(state.range(0)));
  for (auto _ : state)
  {
    benchmark::DoNotOptimize(TestCondeTorres(model));
  }
  state.SetItemsProcessed(state.iterations() * state.range(0) * state.range(0) * state.range(0));
}

/// One tricubic element with noise in percent of the lattice spacing, by itself.
void InjectivityOfRandomCells(benchmark::State& state)
{
  constexpr std::size_t Count = 256;
  const std::vector<double> points = RandomCells(Count, 0.01 * static_cast<double>(state.range(0)));
  const KnotVector knots = KnotVector::Uniform(3, 4);
  std::vector<MultiPatch> models;
  std::vector<std::vector<PatchValidity>> validity;
  ValidityOptions options;
  options.Tolerance = 0.0;
  for (std::size_t cell = 0; cell < Count; ++cell)
  {
    const Eigen::Map<const Eigen::Matrix3Xd> p(points.data() + 192 * cell, 3, 64);
    MultiPatch model;
    model.Patches.push_back({ 0, Aggregate(Spline({ knots, knots, knots }, p)) });
    const PatchValidity patch = TestValidity(model.Patches[0].Body.Geometry(), options);
    if (patch.Elements[0].Verdict == 1)
    {
      models.push_back(std::move(model));
      validity.push_back({ patch });
    }
  }
  double certified = 0;
  double boxes = 0;
  for (auto _ : state)
  {
    certified = 0;
    boxes = 0;
    for (std::size_t cell = 0; cell < models.size(); ++cell)
    {
      const Injectivity result = TestInjectivity(models[cell], validity[cell]);
      certified += result.Verdict == 1;
      boxes += static_cast<double>(result.Boxes);
    }
  }
  const auto n = static_cast<double>(models.size());
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(models.size()));
  state.counters["certified%"] = 100 * certified / n;
  state.counters["boxes"] = boxes / n;
}

BENCHMARK(RandomTricubicCells)
  ->ArgNames({ "noise%", "tolerance%" })
  ->ArgsProduct({ { 15, 30, 40 }, { 0, 1 } })
  ->Unit(benchmark::kMillisecond)
  ->MinTime(0.3);
BENCHMARK(VisitedCells)
  ->ArgNames({ "model", "method" })
  ->ArgsProduct({ { 0, 1, 2 }, { OneOrder, BestOfThree, BernsteinCoefficients } })
  ->Unit(benchmark::kMillisecond)
  ->MinTime(0.1);
BENCHMARK(InjectivityOfRandomCells)
  ->ArgName("noise%")
  ->Arg(15)
  ->Arg(30)
  ->Arg(40)
  ->Unit(benchmark::kMillisecond);
BENCHMARK(GlobalInjectivity)->ArgName("n")->Arg(10)->Arg(20)->Unit(benchmark::kMillisecond);
BENCHMARK(CondeTorresTest)->ArgName("n")->Arg(10)->Unit(benchmark::kMillisecond);

}
