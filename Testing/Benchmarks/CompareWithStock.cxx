// SPDX-License-Identifier: BSD-3-Clause
// Zero sets beside what there is without them: a uniform grid of exact points, as coarse as the
// same measured error allows, through vtkContourFilter or vtkCutter.
//
//   VTK_SMP_MAX_THREADS=1 StockComparison [spans] [case ...]
//
// In the environment: ONLY_HERE leaves the stock filters out, VERBOSE shows all grids that are
// tried.
#include "Aggregate.h"
#include "Evaluator.h"
#include "Interpolation.h"
#include "NURBSConversion.h"
#include "Times.h"

#include "vtkCellArray.h"
#include "vtkContourFilter.h"
#include "vtkCutter.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkNURBSContour.h"
#include "vtkNURBSSlice.h"
#include "vtkNew.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkPlane.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkStaticCellLocator.h"
#include "vtkStructuredGrid.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <functional>
#include <malloc.h>
#include <string>
#include <vector>

using namespace hyperpatch;

namespace
{

/// Peak resident memory of the process in MiB since the last ResetPeak().
double Peak()
{
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
  {
    if (word == "VmHWM:")
    {
      double kilobytes = 0.0;
      status >> kilobytes;
      return kilobytes / 1024.0;
    }
  }
  return 0.0;
}

/// Returns what is resident now.
double ResetPeak()
{
  malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5";
  return Peak();
}

/// A sector of a ring about as wide as the unit cube, with a wavy third direction and weights.
Eigen::Vector3d Map(const Eigen::Vector3d& u)
{
  const double angle = 0.25 * M_PI * (u[0] - 0.5);
  const double radius = 1.0 + u[1];
  return { 0.5 + radius * std::sin(angle), radius * std::cos(angle) - 1.0,
    u[2] + 0.1 * std::sin(3.0 * u[0]) };
}

const Eigen::Vector3d Centre(0.5, 0.5, 0.5 + 0.1 * std::sin(1.5));

/// Knots whose spans are about ten times shorter around the middle.
KnotVector Graded(int spans)
{
  std::vector<double> knots(4, 0.0);
  for (int i = 1; i < spans; ++i)
  {
    const double t = 2.0 * i / spans - 1.0;
    knots.push_back(0.5 + 0.5 * (0.1 * t + 0.9 * t * t * t));
  }
  knots.insert(knots.end(), 4, 1.0);
  return { 3, knots };
}

struct Case
{
  const char* Name;
  std::function<double(const Eigen::Vector3d&)> F; ///< of the position; empty: an oblique slice
  double Tolerance;
  bool IsGraded = false;
  double Finer = 0.1; ///< the part of the tolerance of the surface that errors are measured from
};

const std::vector<Case>& Cases()
{
  const auto sphere = [](const Eigen::Vector3d& x)
  { return (x - Centre).squaredNorm() - 0.35 * 0.35; };
  const auto gyroid = [](const Eigen::Vector3d& x)
  {
    const Eigen::Vector3d q = 10.0 * M_PI * x;
    return std::sin(q[0]) * std::cos(q[1]) + std::sin(q[1]) * std::cos(q[2]) +
      std::sin(q[2]) * std::cos(q[0]);
  };
  // A gentle sheet with a bump on it.
  const auto bump = [](const Eigen::Vector3d& x)
  {
    const Eigen::Vector3d y = x - Centre;
    return y[2] + 0.02 * std::sin(3.0 * y[0]) - 0.02 * std::exp(-y.squaredNorm() / (0.01 * 0.01));
  };
  static const std::vector<Case> All{
    { "sphere-3", sphere, 1e-3 },
    { "sphere-5", sphere, 1e-5 },
    { "gyroid-3", gyroid, 1e-3 },
    { "gyroid-4", gyroid, 1e-4, false, 0.4 },
    { "bump-4", bump, 1e-4, true },
    { "slice-3", {}, 1e-3 },
  };
  return All;
}

Spline Interpolated(const KnotVector& knots, int components,
  const std::function<void(const Eigen::Vector3d&, double*)>& f)
{
  const std::vector<double> g = GrevilleAbscissae(knots);
  const auto n = static_cast<Eigen::Index>(g.size());
  Eigen::MatrixXd values(components, n * n * n);
  Eigen::Index at = 0;
  for (const double w : g)
  {
    for (const double v : g)
    {
      for (const double u : g)
      {
        f({ u, v, w }, values.col(at++).data());
      }
    }
  }
  return Interpolate({ knots, knots, knots }, { g, g, g }, std::move(values));
}

Aggregate Model(const Case& c, int spans)
{
  const KnotVector knots = KnotVector::Uniform(3, spans + 3);
  const Spline polynomial = Interpolated(knots, 3,
    [](const Eigen::Vector3d& u, double* x)
    {
      Eigen::Map<Eigen::Vector3d> to(x);
      to = Map(u);
    });
  Eigen::VectorXd weights(polynomial.Coefficients().cols());
  const Eigen::Index n = spans + 3;
  for (Eigen::Index i = 0; i < weights.size(); ++i)
  {
    weights[i] = 1.0 + 0.2 * static_cast<double>(i % n * (i / n % n)) / static_cast<double>(n * n);
  }
  Spline geometry({ knots, knots, knots }, polynomial.Coefficients(), weights);
  const Evaluator evaluator(geometry);
  const KnotVector own = c.IsGraded ? Graded(spans) : knots;
  const auto field = c.F ? c.F : [](const Eigen::Vector3d& x) { return std::sin(3.0 * x.sum()); };
  Spline attribute = Interpolated(own, 1,
    [&](const Eigen::Vector3d& u, double* f)
    {
      Eigen::Vector3d x;
      evaluator.Evaluate(1, u.data(), x.data());
      f[0] = field(x);
    });
  return Aggregate(std::move(geometry), { { "f", std::move(attribute) } });
}

/// The plane of the oblique slice.
const Eigen::Vector3d Normal = Eigen::Vector3d(1.0, 2.0, 3.0).normalized();

/// Distance of a point of the mesh, near parameters u, from the exact zero set: the point is
/// inverted, then one step of Newton's in physical space.
class Measure
{
public:
  Measure(const Aggregate& body, bool isSlice)
    : X(body.Geometry())
    , A(*body.FindAttribute("f"))
    , IsSlice(isSlice)
  {
  }

  struct Result
  {
    double Distance, Attribute;
  };

  /// \param value what the mesh says of the attribute
  [[nodiscard]] Result operator()(const Eigen::Vector3d& x, Eigen::Vector3d u, double value) const
  {
    Eigen::Vector3d at;
    Eigen::Matrix3d J;
    Eigen::Vector3d miss = Eigen::Vector3d::Zero();
    for (int i = 0; i < 8; ++i)
    {
      this->X.EvaluateWithDerivatives(1, u.data(), at.data(), J.data());
      miss = x - at;
      const Eigen::Vector3d step = J.inverse() * miss;
      u = (u + step).cwiseMax(0.0).cwiseMin(1.0);
      if (step.norm() < 1e-13)
      {
        break;
      }
    }
    double f = 0.0;
    Eigen::Vector3d g;
    this->A.EvaluateWithDerivatives(1, u.data(), &f, g.data());
    if (this->IsSlice)
    {
      // On the plane as it is; off the solid is what counts.
      return { miss.norm(), std::abs(value - f) };
    }
    const double slope = (J.transpose().inverse() * g).norm();
    return { std::max(std::abs(f) / slope, miss.norm()), 0.0 };
  }

private:
  Evaluator X, A;
  bool IsSlice;
};

struct MeshError
{
  double Distance = 0.0, Attribute = 0.0;
};

/// Largest, over a grid of points in each triangle, and over the points of a finer mesh.
MeshError ErrorOf(vtkPolyData* mesh, const char* parameters, const Measure& measure)
{
  MeshError error;
  vtkDataArray* u = mesh->GetPointData()->GetArray(parameters);
  vtkDataArray* f = mesh->GetPointData()->GetArray("f");
  constexpr int Parts = 4;
  vtkIdType size = 0;
  const vtkIdType* corners = nullptr;
  // Not all of millions.
  const vtkIdType stride = std::max<vtkIdType>(1, mesh->GetNumberOfPolys() / 100000);
  for (vtkIdType cell = 0; cell < mesh->GetNumberOfPolys(); cell += stride)
  {
    mesh->GetPolys()->GetCellAtId(cell, size, corners);
    for (vtkIdType fan = 2; fan < size; ++fan)
    {
      Eigen::Matrix3d X;
      Eigen::Matrix3d U;
      Eigen::Vector3d F;
      for (int k = 0; k < 3; ++k)
      {
        const vtkIdType point = corners[k == 0 ? 0 : fan - 2 + k];
        mesh->GetPoint(point, X.col(k).data());
        u->GetTuple(point, U.col(k).data());
        F[k] = f ? f->GetComponent(point, 0) : 0.0;
      }
      for (int i = 0; i <= Parts; ++i)
      {
        for (int j = 0; i + j <= Parts; ++j)
        {
          const Eigen::Vector3d b =
            Eigen::Vector3d(i, j, Parts - i - j) / static_cast<double>(Parts);
          const auto found = measure(X * b, U * b, F.dot(b));
          error.Distance = std::max(error.Distance, found.Distance);
          error.Attribute = std::max(error.Attribute, found.Attribute);
        }
      }
    }
  }
  return error;
}

/// How far the points of a fine mesh are from another.
double Missed(vtkPolyData* fine, vtkPolyData* mesh)
{
  vtkNew<vtkStaticCellLocator> locator;
  locator->SetDataSet(mesh);
  locator->BuildLocator();
  double worst = 0.0;
  const vtkIdType stride = std::max<vtkIdType>(1, fine->GetNumberOfPoints() / 200000);
  for (vtkIdType i = 0; i < fine->GetNumberOfPoints(); i += stride)
  {
    double x[3];
    double closest[3];
    vtkIdType cell = 0;
    int sub = 0;
    double square = 0.0;
    fine->GetPoint(i, x);
    locator->FindClosestPoint(x, closest, cell, sub, square);
    worst = std::max(worst, square);
  }
  return std::sqrt(worst);
}

struct Run
{
  double Seconds = 0.0;
  double Memory = 0.0; ///< MiB beyond what was there
  vtkNew<vtkPolyData> Mesh;
};

template <typename Body>
void Time(Run& run, Body&& body)
{
  const double before = ResetPeak();
  const double start = CPUTime();
  body();
  run.Seconds = CPUTime() - start;
  run.Memory = Peak() - before;
}

/// The uniform grid of n^3 points and its contour or cut.
void Stock(vtkDataObject* input, bool isSlice, int n, bool withParameters, Run& run)
{
  Time(run,
    [&]
    {
      const MultiPatch model = FromVTK(input);
      const Aggregate& body = model.Patches[0].Body;
      const Evaluator X(body.Geometry());
      const Evaluator A(*body.FindAttribute("f"));
      std::vector<double> sites(static_cast<std::size_t>(n));
      for (int i = 0; i < n; ++i)
      {
        sites[static_cast<std::size_t>(i)] = i / (n - 1.0);
      }
      const vtkIdType count = static_cast<vtkIdType>(n) * n * n;
      vtkNew<vtkDoubleArray> points;
      points->SetNumberOfComponents(3);
      points->SetNumberOfTuples(count);
      X.EvaluateGrid({ sites, sites, sites }, points->GetPointer(0));
      vtkNew<vtkDoubleArray> f;
      f->SetName("f");
      f->SetNumberOfTuples(count);
      A.EvaluateGrid({ sites, sites, sites }, f->GetPointer(0));
      vtkNew<vtkStructuredGrid> grid;
      grid->SetDimensions(n, n, n);
      vtkNew<vtkPoints> p;
      p->SetData(points);
      grid->SetPoints(p);
      grid->GetPointData()->SetScalars(f);
      if (withParameters)
      {
        vtkNew<vtkDoubleArray> u;
        u->SetName("u");
        u->SetNumberOfComponents(3);
        u->SetNumberOfTuples(count);
        for (vtkIdType i = 0; i < count; ++i)
        {
          u->SetTuple3(i, sites[static_cast<std::size_t>(i % n)],
            sites[static_cast<std::size_t>(i / n % n)], sites[static_cast<std::size_t>(i / n / n)]);
        }
        grid->GetPointData()->AddArray(u);
      }
      if (isSlice)
      {
        vtkNew<vtkPlane> plane;
        plane->SetOrigin(Centre.data());
        plane->SetNormal(Normal.data());
        vtkNew<vtkCutter> cutter;
        cutter->SetInputData(grid);
        cutter->SetCutFunction(plane);
        cutter->Update();
        run.Mesh->ShallowCopy(cutter->GetOutput());
      }
      else
      {
        vtkNew<vtkContourFilter> contour;
        contour->SetInputData(grid);
        contour->SetValue(0, 0.0);
        contour->ComputeNormalsOn();
        contour->Update();
        run.Mesh->ShallowCopy(contour->GetOutput());
      }
    });
}

/// A filter with its input, so that values can be changed.
class Ours
{
public:
  Ours(const Aggregate& body, bool isSlice, double tolerance)
    : IsSlice(isSlice)
  {
    MultiPatch model;
    model.Patches.push_back({ 0, body });
    ToVTK(model, this->Input);
    const double diagonal = this->Diagonal(body);
    vtkNURBSZeroSetAlgorithm* filter = this->Contour;
    if (isSlice)
    {
      this->Plane->SetOrigin(Centre.data());
      this->Plane->SetNormal(Normal.data());
      this->Slice->SetSliceFunction(this->Plane);
      filter = this->Slice;
    }
    else
    {
      this->Contour->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "f");
      this->Contour->SetValue(0, 0.0);
      this->Contour->SetAttributeTolerance(0.0);
    }
    filter->SetInputDataObject(this->Input);
    filter->SetTolerance(tolerance / diagonal);
    this->Filter = filter;
  }

  void Move(double by)
  {
    if (this->IsSlice)
    {
      const Eigen::Vector3d origin = Centre + by * Normal;
      this->Plane->SetOrigin(origin.data());
    }
    else
    {
      this->Contour->SetValue(0, by);
    }
  }

  void Update(Run& run)
  {
    Time(run, [this] { this->Filter->Update(); });
    run.Mesh->ShallowCopy(this->Filter->GetOutputDataObject(0));
  }

  vtkDataObject* GetInput() { return this->Input; }

  double Wall()
  {
    const double start = WallTime();
    this->Filter->Update();
    return WallTime() - start;
  }

private:
  static double Diagonal(const Aggregate& body)
  {
    const auto& x = body.Geometry().Coefficients();
    return (x.rowwise().maxCoeff() - x.rowwise().minCoeff()).norm();
  }

  bool IsSlice;
  vtkNew<vtkPartitionedDataSetCollection> Input;
  vtkNew<vtkNURBSContour> Contour;
  vtkNew<vtkNURBSSlice> Slice;
  vtkNew<vtkPlane> Plane;
  vtkNURBSZeroSetAlgorithm* Filter = nullptr;
};

double Number(vtkPolyData* mesh, const char* name)
{
  vtkDataArray* array = mesh->GetFieldData()->GetArray(name);
  return array ? array->GetComponent(0, 0) : NAN;
}

/// Short runs are timed some times more, each from the beginning: the least counts.
template <typename Again>
void Repeat(Run& run, Again&& again)
{
  for (int i = 0; i < 4 && run.Seconds < 0.1; ++i)
  {
    Run next;
    again(next);
    run.Seconds = std::min(run.Seconds, next.Seconds);
  }
}

void Compare(const Case& c, int spans)
{
  const Aggregate body = Model(c, spans);
  const bool isSlice = !c.F;
  const Measure measure(body, isSlice);
  Ours ours(body, isSlice, c.Tolerance);
  Run first;
  ours.Update(first);
  Repeat(first, [&](Run& run) { Ours(body, isSlice, c.Tolerance).Update(run); });
  const MeshError error = ErrorOf(first.Mesh, "ParametricCoordinates", measure);
  Run fine;
  Ours(body, isSlice, c.Finer * c.Tolerance).Update(fine);
  const double missed = Missed(fine.Mesh, first.Mesh);
  const double allowed = std::max(error.Distance, missed);
  std::printf("%-9s spans %3d  here:  %8.1f ms %9lld triangles %7.1f MiB  error %.2e missed %.2e "
              "attribute %.2e  certified %g undecided %g\n",
    c.Name, spans, 1e3 * first.Seconds, static_cast<long long>(first.Mesh->GetNumberOfPolys()),
    first.Memory, error.Distance, missed, error.Attribute, Number(first.Mesh, "CertifiedCells"),
    Number(first.Mesh, "UndecidedCells"));

  // Moved a little.
  double moved = 0.0;
  double wall = INFINITY;
  for (int i = 1; i <= 5; ++i)
  {
    Run again;
    ours.Move(1e-3 * i);
    ours.Update(again);
    moved += 0.2 * again.Seconds;
    ours.Move(-1e-3 * i);
    wall = std::min(wall, ours.Wall());
  }
  std::printf(
    "          moved: %.1f ms of CPU time; wall time at best %.1f ms\n", 1e3 * moved, 1e3 * wall);
  if (std::getenv("ONLY_HERE"))
  {
    return;
  }

  // What a grid's error is of the allowed one.
  const auto share = [&](int n)
  {
    Run run;
    Stock(ours.GetInput(), isSlice, n, true, run);
    const MeshError e = ErrorOf(run.Mesh, "u", measure);
    const double worst = std::max(e.Distance, Missed(fine.Mesh, run.Mesh));
    if (std::getenv("VERBOSE"))
    {
      std::printf("          n %d: %.2e, attribute %.2e\n", n, worst, e.Attribute);
    }
    return std::max(
      worst / allowed, isSlice ? e.Attribute / std::max(error.Attribute, 1e-12) : 0.0);
  };
  // A grid that is as good. Errors fall with the square, but leap from grid to grid, as corners
  // happen to lie: what some grids say together counts.
  const int most = 520;
  std::vector<double> squares;
  const auto grid = [&squares]
  {
    std::nth_element(
      squares.begin(), squares.begin() + static_cast<int>(squares.size() / 2), squares.end());
    return static_cast<int>(std::sqrt(squares[squares.size() / 2]) + 0.5);
  };
  int high = 24;
  for (int tries = 0; tries < 4; ++tries)
  {
    squares = { share(high) * high * high };
    const int next = std::min(std::min(most, 3 * high), std::max(8, grid()));
    const bool isNear = std::abs(next - high) < high / 3;
    high = next;
    if (isNear)
    {
      break;
    }
  }
  for (const double part : { 0.7, 0.8, 0.9, 1.0, 1.1 })
  {
    const int n = std::min(most, static_cast<int>(part * high));
    squares.push_back(share(n) * n * n);
  }
  high = std::min(most, grid());
  Run run;
  Stock(ours.GetInput(), isSlice, high, false, run);
  Repeat(run, [&](Run& again) { Stock(ours.GetInput(), isSlice, high, false, again); });
  std::printf("          stock: %8.1f ms %9lld triangles %7.1f MiB  grid %d^3%s"
              "  time %.2f, triangles %.2f, memory %.2f times\n",
    1e3 * run.Seconds, static_cast<long long>(run.Mesh->GetNumberOfPolys()), run.Memory, high,
    high == most ? ", still too coarse" : "", run.Seconds / first.Seconds,
    static_cast<double>(run.Mesh->GetNumberOfPolys()) /
      static_cast<double>(first.Mesh->GetNumberOfPolys()),
    run.Memory / first.Memory);
}

}

int main(int argc, char** argv)
{
  const int spans = argc > 1 ? std::atoi(argv[1]) : 40;
  for (const Case& c : Cases())
  {
    bool wanted = argc < 3;
    for (int i = 2; i < argc; ++i)
    {
      wanted = wanted || c.Name == std::string(argv[i]);
    }
    if (wanted)
    {
      Compare(c, spans);
    }
  }
  return 0;
}
