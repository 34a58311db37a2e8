// SPDX-License-Identifier: BSD-3-Clause
// What is left of a curved rational tricubic volume by NURBS Clip: time, the longest wait for
// Cancel, and the error of the volume where it is known.
//
//   VTK_SMP_MAX_THREADS=1 ClipBenchmark [spans] [case ...]
#include "Aggregate.h"
#include "Evaluator.h"
#include "Interpolation.h"
#include "NURBSConversion.h"
#include "Operators.h"
#include "Times.h"

#include "vtkCallbackCommand.h"
#include "vtkCellArray.h"
#include "vtkCommand.h"
#include "vtkDataObject.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkIdList.h"
#include "vtkNURBSClip.h"
#include "vtkNew.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkPlane.h"
#include "vtkPoints.h"
#include "vtkSphere.h"
#include "vtkTetra.h"
#include "vtkUnstructuredGrid.h"

#include <Eigen/Core>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <vector>

using namespace hyperpatch;

namespace
{

using Clock = std::chrono::steady_clock;

double Seconds(Clock::duration time)
{
  return std::chrono::duration<double>(time).count();
}

/// A quarter of a tube of radii 1 and 2 and height 1, exact, refined to so many spans in each
/// direction, with a gyroid of three periods as an attribute.
MultiPatch Model(int spans)
{
  Eigen::MatrixXd points(3, 12);
  Eigen::VectorXd weights(12);
  const double arc[3][3] = { { 1, 0, 1 }, { 1, 1, std::sqrt(0.5) }, { 0, 1, 1 } };
  for (int n = 0; n < 12; ++n)
  {
    const double* a = arc[n / 2 % 3];
    points.col(n) << (1 + n % 2) * a[0], (1 + n % 2) * a[1], n / 6;
    weights[n] = a[2];
  }
  const KnotVector line = KnotVector::Uniform(1, 2);
  Spline tube({ line, KnotVector::Uniform(2, 3), line }, points, weights);
  for (int d = 0; d < 3; ++d)
  {
    tube = ElevateDegree(tube, d, 3 - tube.Degrees()[static_cast<std::size_t>(d)]);
  }
  tube = RefineUniformly(tube, { spans, spans, spans });
  const Evaluator evaluator(tube);
  std::vector<double> g = GrevilleAbscissae(tube.Knots(0));
  const auto n = static_cast<Eigen::Index>(g.size());
  Eigen::MatrixXd values(1, n * n * n);
  for (Eigen::Index i = 0; i < values.cols(); ++i)
  {
    const auto at = [&g](Eigen::Index k) { return g[static_cast<std::size_t>(k)]; };
    const Eigen::Vector3d u(at(i % n), at(i / n % n), at(i / n / n));
    Eigen::Vector3d x;
    evaluator.Evaluate(1, u.data(), x.data());
    x *= 3.0 * M_PI;
    values(0, i) = std::sin(x[0]) * std::cos(x[1]) + std::sin(x[1]) * std::cos(x[2]) +
      std::sin(x[2]) * std::cos(x[0]);
  }
  Spline gyroid = Interpolate(tube.Knots(), { g, g, g }, std::move(values));
  MultiPatch model;
  model.Patches.push_back({ 0, Aggregate(std::move(tube), { { "gyroid", std::move(gyroid) } }) });
  return model;
}

double Volume(vtkUnstructuredGrid* grid)
{
  double sum = 0.0;
  vtkNew<vtkIdList> ids;
  for (vtkIdType c = 0; c < grid->GetNumberOfCells(); ++c)
  {
    double x[4][3];
    grid->GetCells()->GetCellAtId(c, ids);
    for (int i = 0; i < 4; ++i)
    {
      grid->GetPoint(ids->GetId(i), x[i]);
    }
    sum += vtkTetra::ComputeVolume(x[0], x[1], x[2], x[3]);
  }
  return sum;
}

struct Case
{
  const char* Name;
  double Tolerance;          ///< relative to the diagonal
  double AttributeTolerance; ///< 0: off
  double Radius;             ///< of a sphere; 0: a plane; negative: the gyroid
  double Offset;             ///< of the plane along (1, 1, 0), or the isovalue
  double Exact;              ///< volume, 0 if it is not known
};

}

int main(int argc, char** argv)
{
  const int spans = argc > 1 ? std::atoi(argv[1]) : 40;
  const double ball = 4.0 / 3.0 * M_PI;
  const std::vector<Case> cases{
    { "half", 1e-3, 0.0, 0.0, 0.0, 0.375 * M_PI },
    { "half-colours", 1e-3, 1e-2, 0.0, 0.0, 0.375 * M_PI },
    { "corner", 1e-3, 1e-2, 0.0, -1.3, 0.0 },
    { "ball", 1e-3, 0.0, 0.35, 0.0, ball * std::pow(0.35, 3) },
    { "ball-colours", 1e-3, 1e-2, 0.35, 0.0, ball * std::pow(0.35, 3) },
    { "ball-fine", 1e-4, 0.0, 0.35, 0.0, ball * std::pow(0.35, 3) },
    { "gyroid", 1e-3, 0.0, -1.0, 0.0, 0.0 },
    { "missed", 1e-3, 1e-2, -1.0, -1e3, 0.0 },
  };
  vtkNew<vtkPartitionedDataSetCollection> lattice;
  ToVTK(Model(spans), lattice);
  std::printf("%-14s %9s %9s %9s %9s %9s %10s %9s\n", "case", "CPU s", "wall s", "again s",
    "pause ms", "cells", "undecided", "error");
  for (const Case& c : cases)
  {
    if (argc > 2 &&
      std::find_if(argv + 2, argv + argc,
        [&c](const char* name) { return std::string(name) == c.Name; }) == argv + argc)
    {
      continue;
    }
    vtkNew<vtkNURBSClip> clip;
    clip->SetInputDataObject(lattice);
    clip->SetTolerance(c.Tolerance);
    clip->SetAttributeTolerance(c.AttributeTolerance);
    vtkNew<vtkPlane> plane;
    plane->SetNormal(-1.0, 1.0, 0.0);
    vtkNew<vtkSphere> sphere;
    sphere->SetCenter(1.5 * std::sqrt(0.5), 1.5 * std::sqrt(0.5), 0.5);
    sphere->SetRadius(c.Radius);
    clip->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "gyroid");
    clip->SetValue(c.Offset);
    if (c.Radius >= 0.0)
    {
      plane->SetOrigin(-c.Offset, 0.0, 0.0);
      clip->SetClipFunction(
        c.Radius > 0.0 ? static_cast<vtkImplicitFunction*>(sphere) : plane.Get());
    }
    struct Silence
    {
      Clock::time_point Last = Clock::now();
      Clock::duration Longest{};
      void Note()
      {
        const Clock::time_point now = Clock::now();
        this->Longest = std::max(this->Longest, now - this->Last);
        this->Last = now;
      }
    } silence;
    vtkNew<vtkCallbackCommand> progress;
    progress->SetClientData(&silence);
    progress->SetCallback(
      [](vtkObject*, unsigned long, void* self, void*) { static_cast<Silence*>(self)->Note(); });
    clip->AddObserver(vtkCommand::ProgressEvent, progress);
    const double cpu = CPUTime();
    const Clock::time_point begin = Clock::now();
    silence.Last = begin;
    clip->Update();
    silence.Note();
    const double first = CPUTime() - cpu;
    const double wall = Seconds(Clock::now() - begin);
    vtkUnstructuredGrid* out = vtkUnstructuredGrid::SafeDownCast(clip->GetOutputDataObject(0));
    const double error = c.Exact > 0.0 ? std::abs(Volume(out) / c.Exact - 1.0) : NAN;
    const vtkIdType cells = out->GetNumberOfCells();
    const double undecided = out->GetFieldData()->GetArray("UndecidedCells")->GetComponent(0, 0);
    // The plane or value is dragged.
    plane->Push(1e-3);
    sphere->SetRadius(1.001 * c.Radius);
    clip->SetValue(c.Offset + 1e-3);
    const double before = CPUTime();
    clip->Update();
    std::printf("%-14s %9.2f %9.2f %9.2f %9.0f %9lld %10.0f %9.1e\n", c.Name, first, wall,
      CPUTime() - before, 1e3 * Seconds(silence.Longest), static_cast<long long>(cells), undecided,
      error);
    std::fflush(stdout);
  }
  return 0;
}
