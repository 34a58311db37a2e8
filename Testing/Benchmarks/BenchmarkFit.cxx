// SPDX-License-Identifier: BSD-3-Clause
// What fitting costs, beside vtkImageBSplineCoefficients on the same data in the same run.
#include "Evaluator.h"
#include "Interpolation.h"

#include "vtkDoubleArray.h"
#include "vtkFloatArray.h"
#include "vtkImageBSplineCoefficients.h"
#include "vtkImageData.h"
#include "vtkNURBSFit.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkTable.h"
#include "vtkVariant.h"

#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <numeric>
#include <string>

using namespace hyperpatch;

namespace
{

/// Peak resident memory of the process in bytes since the last ResetPeak(); 0 where the system does
/// not tell.
double Peak()
{
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
  {
    if (word == "VmHWM:")
    {
      double kilobytes = 0.0;
      status >> kilobytes;
      return 1024.0 * kilobytes;
    }
  }
  return 0.0;
}

/// Returns what is resident now.
double ResetPeak()
{
  std::ofstream("/proc/self/clear_refs") << "5";
  return Peak();
}

double Sample(int i, int n)
{
  const double x = static_cast<double>(i % n) / n;
  const double y = static_cast<double>(i / n % n) / n;
  const double z = static_cast<double>(i / n / n) / n;
  return 100.0 * std::sin(20.0 * x + 7.0 * y) * std::cos(15.0 * z - 3.0 * x) + 13.0 * y;
}

template <typename Array>
vtkNew<vtkImageData> MakeImage(int n)
{
  vtkNew<Array> values;
  values->SetName("Value");
  values->SetNumberOfTuples(static_cast<vtkIdType>(n) * n * n);
  for (int i = 0; i < n * n * n; ++i)
  {
    values->SetValue(i, static_cast<typename Array::ValueType>(Sample(i, n)));
  }
  vtkNew<vtkImageData> image;
  image->SetDimensions(n, n, n);
  image->GetPointData()->SetScalars(values);
  return image;
}

/// In units of the image in doubles: what was resident at most, beyond what was before.
void Report(benchmark::State& state, int n, double peak, double before)
{
  const double samples = static_cast<double>(n) * n * n;
  state.counters["samples/s"] = benchmark::Counter(
    samples * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
  state.counters["memory/image"] = (peak - before) / (8.0 * samples);
}

template <typename Array>
void VTKCoefficients(benchmark::State& state)
{
  const auto n = static_cast<int>(state.range(0));
  const vtkNew<vtkImageData> image = MakeImage<Array>(n);
  double before = 0.0;
  double peak = 0.0;
  for (auto _ : state)
  {
    state.PauseTiming();
    before = ResetPeak();
    state.ResumeTiming();
    vtkNew<vtkImageBSplineCoefficients> filter;
    filter->SetInputData(image);
    filter->SetSplineDegree(3);
    filter->SetOutputScalarTypeToDouble();
    filter->SetNumberOfThreads(1);
    filter->SetEnableSMP(false);
    filter->Update();
    benchmark::DoNotOptimize(filter->GetOutput());
    state.PauseTiming();
    peak = Peak();
    state.ResumeTiming();
  }
  Report(state, n, peak, before);
}

template <typename Array>
void Interpolation(benchmark::State& state)
{
  const auto n = static_cast<int>(state.range(0));
  const vtkNew<vtkImageData> image = MakeImage<Array>(n);
  const auto* values = Array::SafeDownCast(image->GetPointData()->GetScalars())->GetPointer(0);
  std::vector<double> sites(static_cast<std::size_t>(n));
  std::iota(sites.begin(), sites.end(), 0.0);
  double before = 0.0;
  double peak = 0.0;
  for (auto _ : state)
  {
    state.PauseTiming();
    before = ResetPeak();
    state.ResumeTiming();
    const KnotVector knots = InterpolationKnots(static_cast<int>(state.range(1)), sites);
    const DirectionFit fit = DirectionFit::Interpolation(knots, sites);
    Eigen::MatrixXd samples(1, image->GetNumberOfPoints());
    std::copy_n(values, samples.size(), samples.data());
    const Spline spline = FitGrid({ fit, fit, fit }, std::move(samples));
    benchmark::DoNotOptimize(spline.Coefficients().data());
    state.PauseTiming();
    peak = Peak();
    state.ResumeTiming();
  }
  Report(state, n, peak, before);
}

/// The filter: reading, interpolation, the errors at all samples, and the output with its lattice.
template <typename Array>
void Filter(benchmark::State& state)
{
  const auto n = static_cast<int>(state.range(0));
  const vtkNew<vtkImageData> image = MakeImage<Array>(n);
  double before = 0.0;
  double peak = 0.0;
  double error = 0.0;
  for (auto _ : state)
  {
    state.PauseTiming();
    before = ResetPeak();
    state.ResumeTiming();
    vtkNew<vtkNURBSFit> filter;
    filter->SetInputData(image);
    filter->Update();
    state.PauseTiming();
    peak = Peak();
    auto report = vtkTable::SafeDownCast(filter->GetOutputDataObject(1));
    error = report->GetValueByName(0, "RelativeError").ToDouble();
    state.ResumeTiming();
  }
  Report(state, n, peak, before);
  state.counters["error/range"] = error;
}

}

BENCHMARK(VTKCoefficients<vtkDoubleArray>)->Arg(256)->Unit(benchmark::kMillisecond);
BENCHMARK(Interpolation<vtkDoubleArray>)->Args({ 256, 3 })->Unit(benchmark::kMillisecond);
BENCHMARK(VTKCoefficients<vtkFloatArray>)->Arg(256)->Unit(benchmark::kMillisecond);
BENCHMARK(Filter<vtkDoubleArray>)->Arg(256)->Unit(benchmark::kMillisecond);
BENCHMARK(Interpolation<vtkFloatArray>)
  ->ArgsProduct({ { 256 }, { 1, 2, 3, 4, 5 } })
  ->Unit(benchmark::kMillisecond);

int main(int argc, char** argv)
{
  // One thread for all.
  setenv("VTK_SMP_BACKEND_IN_USE", "Sequential", 1);
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
