// SPDX-License-Identifier: BSD-3-Clause

// The Jacobian boundary: exclusion of large volumes, the subdivision of Joy & Duchaineau, and the
// sheet of a real file.

#include "Formats.h"
#include "JacobianField.h"
#include "JacobianSign.h"
#include "JacobianTetrahedra.h"
#include "JacobianTree.h"
#include "ZeroSet.h"

#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

namespace
{

using namespace hyperpatch;

enum Shape
{
  Bent,         ///< most of a tube, 5 radians
  RationalBent, ///< with weights from 0.7 to 1.3
  FoldedWaves   ///< folds all over
};

/// A cubic volume of 75^3 control points, 373,248 spans.
Spline LargeVolume(Shape shape)
{
  constexpr int N = 75;
  Eigen::MatrixXd points(3, N * N * N);
  Eigen::VectorXd weights(shape == RationalBent ? N * N * N : 0);
  for (int i = 0; i < N * N * N; ++i)
  {
    const double u = (i % N) / (N - 1.0);
    const double v = (i / N % N) / (N - 1.0);
    const double w = (i / N / N) / (N - 1.0);
    if (shape == FoldedWaves)
    {
      points.col(i) << u + 0.35 * std::sin(3 * v) * std::sin(6 * w), v + 0.3 * std::sin(7 * u) * w,
        w + 0.3 * std::sin(9 * u + v) * v;
    }
    else
    {
      points.col(i) << (1 + u) * std::cos(5 * v), (1 + u) * std::sin(5 * v),
        2 * w + 0.1 * std::sin(6 * u);
    }
    if (shape == RationalBent)
    {
      weights[i] = 1.0 + 0.3 * std::sin(5 * u) * std::sin(4 * v);
    }
  }
  const KnotVector k = KnotVector::Uniform(3, N);
  return Spline({ k, k, k }, points, weights);
}

struct Visits
{
  std::int64_t Boxes = 0;
  std::int64_t Open = 0; ///< single spans that are not excluded
};

void Exclude(const Spline& s, const std::array<std::vector<double>, 3>& breaks,
  const std::array<int, 3>& begin, const std::array<int, 3>& end, Visits& visits)
{
  ParameterBox box{};
  std::size_t widest = 0;
  for (std::size_t d = 0; d < 3; ++d)
  {
    box.Low[d] = breaks[d][static_cast<std::size_t>(begin[d])];
    box.High[d] = breaks[d][static_cast<std::size_t>(end[d])];
    widest = end[d] - begin[d] > end[widest] - begin[widest] ? d : widest;
  }
  ++visits.Boxes;
  if (JacobianSign(s, box) != 0)
  {
    return;
  }
  if (end[widest] - begin[widest] == 1)
  {
    ++visits.Open;
    return;
  }
  std::array<int, 3> middle = end;
  middle[widest] = (begin[widest] + end[widest]) / 2;
  Exclude(s, breaks, begin, middle, visits);
  std::array<int, 3> second = begin;
  second[widest] = middle[widest];
  Exclude(s, breaks, second, end, visits);
}

/// By bisection from the whole volume down to single spans.
void Exclusion(benchmark::State& state)
{
  const Spline s = LargeVolume(static_cast<Shape>(state.range(0)));
  std::array<std::vector<double>, 3> breaks;
  std::array<int, 3> end{};
  for (std::size_t d = 0; d < 3; ++d)
  {
    breaks[d] = s.Knots()[d].Breaks();
    end[d] = static_cast<int>(breaks[d].size()) - 1;
  }
  Visits visits;
  for (auto _ : state)
  {
    visits = Visits();
    Exclude(s, breaks, { 0, 0, 0 }, end, visits);
  }
  state.counters["boxes"] = static_cast<double>(visits.Boxes);
  state.counters["open"] = static_cast<double>(visits.Open);
}

/// A wavy sheet, four control nets turned by 35 degrees in all.
Spline TurnedSweep()
{
  Eigen::MatrixXd points(3, 64);
  for (int i = 0; i < 64; ++i)
  {
    const double angle = 35.0 * 3.14159265358979 / 180.0 * (i / 16) / 3.0;
    const double x = (i % 4) / 3.0;
    const double y = (i / 4 % 4) / 3.0;
    const double z = 0.5 * std::sin(2.5 * x) * std::cos(2.0 * y);
    points.col(i) << x + 0.6 * (i / 16) / 3.0,
      std::cos(angle) * y - std::sin(angle) * z + 0.4 * (i / 16) / 3.0,
      std::sin(angle) * y + std::cos(angle) * z + 0.5 * (i / 16) / 3.0;
  }
  const KnotVector k = KnotVector::Uniform(3, 4);
  return Spline({ k, k, k }, points);
}

/// 900 cells and their triangles, as for FIGURE 11 of the paper.
void JoyDuchaineau(benchmark::State& state)
{
  const Spline s = TurnedSweep();
  JacobianTreeOptions options;
  options.Bound = static_cast<JacobianBound>(state.range(0));
  options.MinimumWidth = 0.0;
  JacobianTetrahedra mesh;
  double width = 0.0;
  for (auto _ : state)
  {
    const JacobianTree tree(s, options);
    mesh = MarchTetrahedra(s, tree);
    width = tree.Steps().back().Width / tree.Steps().front().Width;
  }
  state.counters["triangles"] = static_cast<double>(mesh.Triangles.cols());
  state.counters["width"] = width;
}

/// tensorBSpline.xml of G+Smo in the folder HYPERPATCH_SHARED_DATA/gismo; the tolerance is in units
/// of 1e-5 of the diagonal.
void SheetOfRealFile(benchmark::State& state)
{
  const char* folder = std::getenv("HYPERPATCH_SHARED_DATA");
  if (!folder)
  {
    state.SkipWithError("HYPERPATCH_SHARED_DATA is not set");
    return;
  }
  const FileContents file = ReadSplineFile(std::string(folder) + "/gismo/tensorBSpline.xml");
  const Aggregate& body = file.Model.Patches.front().Body;
  const auto points = body.Geometry().Coefficients();
  ZeroSetOptions options;
  options.Tolerance = 1e-5 * static_cast<double>(state.range(0)) *
    (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
  const JacobianField field(body.Geometry());
  std::int64_t triangles = 0;
  ZeroSetCertificate certificate;
  for (auto _ : state)
  {
    ZeroSet sheet(body, field, options);
    sheet.Extract();
    triangles = sheet.Mesh().Cells.cols();
    certificate = sheet.Certificate();
  }
  state.counters["triangles"] = static_cast<double>(triangles);
  state.counters["error"] = certificate.LargestError / options.Tolerance;
  state.counters["residual"] = certificate.LargestResidual;
}

BENCHMARK(Exclusion)
  ->ArgName("shape")
  ->Arg(Bent)
  ->Arg(RationalBent)
  ->Arg(FoldedWaves)
  ->Unit(benchmark::kMillisecond);
BENCHMARK(JoyDuchaineau)->ArgName("bound")->DenseRange(0, 2)->Unit(benchmark::kMillisecond);
BENCHMARK(SheetOfRealFile)
  ->ArgName("tolerance")
  ->Arg(100)
  ->Arg(30)
  ->Arg(10)
  ->Arg(5)
  ->Unit(benchmark::kMillisecond);

}
