// SPDX-License-Identifier: BSD-3-Clause
#include "vtkNURBSFit.h"

#include "Error.h"
#include "FitReport.h"
#include "GridFit.h"
#include "NURBSConversion.h"
#include "SampleGrid.h"
#include "ScatteredFit.h"
#include "WholeInput.h"

#include "vtkCellData.h"
#include "vtkCompositeDataIterator.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataArray.h"
#include "vtkDataSet.h"
#include "vtkFieldData.h"
#include "vtkInformation.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkSmartPointer.h"
#include "vtkTable.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace
{

using hyperpatch::Attribute;
using hyperpatch::DirectionFit;
using hyperpatch::Error;
using hyperpatch::FitError;
using hyperpatch::MultiPatch;
using hyperpatch::Patch;
using hyperpatch::Spline;

/// The data sets of the input that have points; an index is the id of a patch.
std::vector<std::pair<int, vtkDataSet*>> DataSets(vtkDataObject* input)
{
  std::vector<std::pair<int, vtkDataSet*>> sets;
  const auto add = [&sets](vtkDataObject* leaf, int id)
  {
    auto set = vtkDataSet::SafeDownCast(leaf);
    if (set && set->GetNumberOfPoints() > 0)
    {
      sets.emplace_back(id, set);
    }
  };
  if (auto composite = vtkCompositeDataSet::SafeDownCast(input))
  {
    vtkSmartPointer<vtkCompositeDataIterator> it;
    it.TakeReference(composite->NewIterator());
    // Null leaves are counted, so that ids do not depend on them.
    it->SkipEmptyNodesOff();
    int id = 0;
    for (it->InitTraversal(); !it->IsDoneWithTraversal(); it->GoToNextItem(), ++id)
    {
      add(it->GetCurrentDataObject(), id);
    }
  }
  else if (input)
  {
    add(input, 0);
  }
  return sets;
}

}

/// Fits one data set after the other.
class vtkNURBSFit::Fitter
{
public:
  Fitter(vtkNURBSFit* self, FitReport& report)
    : Self(self)
    , Report(&report)
  {
  }

  /// \param begin, end the part of the progress that this data set is
  Patch Fit(int id, vtkDataSet* data, double begin, double end)
  {
    this->PatchId = id;
    const bool chords = this->Self->SampleParameters == CHORD_LENGTH;
    std::optional<SampleGrid> grid;
    if (this->Self->Method != SCATTERED_DATA)
    {
      grid = SampleGrid::From(data, chords);
    }
    const std::vector<vtkDataArray*> arrays = this->Arrays(data);
    if (arrays.empty() && !(grid && grid->Points))
    {
      throw Error("there is no numeric point array to fit" +
        std::string(data->GetCellData()->GetNumberOfArrays() > 0
            ? ": Cell Data To Point Data makes some of the cell arrays"
            : ""));
    }
    int done = 0;
    const auto next = [&]
    {
      const double step = (end - begin) / static_cast<double>(arrays.size() + 1);
      this->Self->SetProgressRange(begin + done * step, begin + (done + 1) * step);
      ++done;
    };
    next();
    return grid ? this->FitGrid(*grid, arrays, next) : this->FitPoints(data, arrays, next);
  }

private:
  [[nodiscard]] std::vector<vtkDataArray*> Arrays(vtkDataSet* data) const
  {
    std::vector<vtkDataArray*> arrays;
    for (int a = 0; a < data->GetPointData()->GetNumberOfArrays(); ++a)
    {
      vtkDataArray* array = data->GetPointData()->GetArray(a);
      const std::string name = array && array->GetName() ? array->GetName() : "";
      const std::set<std::string>& chosen = this->Self->PointArrays;
      if (!name.empty() && name.compare(0, 3, "vtk") != 0 &&
        (chosen.empty() || chosen.count(name) > 0))
      {
        arrays.push_back(array);
      }
    }
    return arrays;
  }

  [[nodiscard]] bool ToTarget() const { return this->Self->FitTo == TARGET_ERROR; }

  [[nodiscard]] hyperpatch::ErrorMeasure Measure() const
  {
    return this->Self->ErrorMeasure == MAXIMUM ? hyperpatch::ErrorMeasure::Maximum
                                               : hyperpatch::ErrorMeasure::RootMeanSquare;
  }

  /// The target as a distance; of constant data, rounding.
  [[nodiscard]] double Tolerance(const Eigen::MatrixXd& samples, double range) const
  {
    const double size = samples.size() > 0 ? samples.cwiseAbs().maxCoeff() : 0.0;
    return std::max(
      { this->Self->TargetError * range, 1e-12 * size, std::numeric_limits<double>::min() });
  }

  template <typename Next>
  Patch FitGrid(const SampleGrid& grid, const std::vector<vtkDataArray*>& arrays, Next&& next)
  {
    const std::array<DirectionFit, 3> fits = this->MakeFits(grid);
    const Spline geometry =
      grid.Points ? this->FitArray(grid, fits, grid.Points, "Points") : *grid.Geometry;
    if (grid.Points && geometry.Dimension() == 3)
    {
      this->Report->CertifyJacobian(geometry, this->Self->KernelParallelFor());
    }
    std::vector<Attribute> attributes;
    for (vtkDataArray* array : arrays)
    {
      next();
      attributes.push_back(
        { array->GetName(), this->FitArray(grid, fits, array, array->GetName()) });
    }
    return { this->PatchId, hyperpatch::Aggregate(geometry, std::move(attributes)) };
  }

  /// What all arrays of a grid have in common; nothing where each has its own knots.
  [[nodiscard]] std::array<DirectionFit, 3> MakeFits(const SampleGrid& grid) const
  {
    std::array<DirectionFit, 3> fits;
    for (std::size_t d = 0; d < 3; ++d)
    {
      const std::vector<double>& sites = grid.Sites[d];
      if (sites.size() < 2)
      {
        continue;
      }
      const int degree = this->Self->Degree[d];
      try
      {
        if (this->Self->Method != LEAST_SQUARES || this->ToTarget())
        {
          fits[d] =
            DirectionFit::Interpolation(hyperpatch::InterpolationKnots(degree, sites), sites);
          continue;
        }
        const int size = std::min(this->Self->ControlPoints[d], grid.Sizes[d]);
        const hyperpatch::KnotVector knots = hyperpatch::LeastSquaresKnots(degree, size, sites);
        fits[d] = size == grid.Sizes[d] && this->Self->Smoothing == 0.0
          ? DirectionFit::Interpolation(knots, sites)
          : DirectionFit::LeastSquares(knots, sites, this->Self->Smoothing);
      }
      catch (const Error& error)
      {
        throw Error("along direction " + std::to_string(d) + " of the grid: " + error.what());
      }
    }
    return fits;
  }

  Spline FitArray(const SampleGrid& grid, const std::array<DirectionFit, 3>& fits,
    vtkDataArray* array, const std::string& name)
  {
    const hyperpatch::ParallelFor parallelFor = this->Self->KernelParallelFor();
    Eigen::MatrixXd samples = ReadTuples(array);
    this->Self->ReportProgress(0.05);
    const double range = SampleRange(samples);
    std::vector<Eigen::Index> missing;
    if (this->Self->MissingSamples == LEAVE_OUT && !samples.allFinite())
    {
      try
      {
        missing = hyperpatch::FillMissing(grid.Sizes, samples);
      }
      catch (const Error& error)
      {
        throw Error("the array " + name + ": " + error.what());
      }
    }
    CheckSamples(array, samples, grid.Sizes);
    this->Self->ReportProgress(0.1);
    const auto make = [&]
    {
      if (this->Self->Method == DATA_AS_CONTROL_POINTS)
      {
        return Spline({ fits[0].Knots(), fits[1].Knots(), fits[2].Knots() }, std::move(samples));
      }
      if (this->Self->Method == LEAST_SQUARES && this->ToTarget())
      {
        const double tolerance = this->Tolerance(samples, range);
        return hyperpatch::FitToTolerance(
          { this->Self->Degree[0], this->Self->Degree[1], this->Self->Degree[2] }, grid.Sites,
          samples, tolerance, this->Measure(), parallelFor);
      }
      return hyperpatch::FitAroundMissing(fits, missing, std::move(samples), parallelFor);
    };
    Spline spline = make();
    const FitError error =
      hyperpatch::MeasureError(spline, grid.Sites, MakeReader(array), parallelFor);
    if (this->Self->Method == INTERPOLATE && error.Maximum > 1e-9 * range)
    {
      this->WarnOfRounding(array, name, error.Maximum, range);
    }
    this->Report->Add(this->PatchId, name, spline, error, range);
    this->Self->ReportProgress(1.0);
    return spline;
  }

  /// Samples that are large beside their range have rounding errors of that size themselves.
  void WarnOfRounding(
    vtkDataArray* array, const std::string& name, double error, double range) const
  {
    double ends[2];
    array->GetFiniteRange(ends, -1);
    if (error > 1e-12 * std::max(std::abs(ends[0]), std::abs(ends[1])))
    {
      vtkWarningWithObjectMacro(this->Self,
        "the interpolant of " << name << " misses samples by " << error / range
                              << " of their range, by rounding: its control points are far away. "
                                 "Take a lower degree, or samples that are more evenly spaced");
    }
  }

  template <typename Next>
  Patch FitPoints(vtkDataSet* data, const std::vector<vtkDataArray*>& arrays, Next&& next)
  {
    Eigen::Matrix3Xd points(3, data->GetNumberOfPoints());
    for (Eigen::Index i = 0; i < points.cols(); ++i)
    {
      data->GetPoint(i, points.col(i).data());
      if (!points.col(i).allFinite())
      {
        throw Error("point " + std::to_string(i) + " has a coordinate that is not finite");
      }
    }
    const Eigen::Vector3d low = points.rowwise().minCoeff();
    const Eigen::Vector3d high = points.rowwise().maxCoeff();
    if (low == high)
    {
      throw Error("all points coincide: there is nothing to fit a spline over");
    }
    std::vector<Attribute> attributes;
    for (vtkDataArray* array : arrays)
    {
      next();
      attributes.push_back({ array->GetName(), this->FitScattered(points, low, high, array) });
    }
    return { this->PatchId, hyperpatch::Aggregate(IdentityBox(low, high), std::move(attributes)) };
  }

  Spline FitScattered(const Eigen::Matrix3Xd& points, const Eigen::Vector3d& low,
    const Eigen::Vector3d& high, vtkDataArray* array)
  {
    const hyperpatch::ParallelFor parallelFor = this->Self->KernelParallelFor();
    Eigen::MatrixXd values = ReadTuples(array);
    std::vector<Eigen::Index> kept;
    for (Eigen::Index i = 0; i < values.cols(); ++i)
    {
      if (values.col(i).allFinite())
      {
        kept.push_back(i);
      }
    }
    Eigen::Matrix3Xd sites = points;
    if (static_cast<Eigen::Index>(kept.size()) < values.cols())
    {
      if (this->Self->MissingSamples == REFUSE)
      {
        CheckSamples(array, values);
      }
      if (kept.empty())
      {
        throw Error(
          "the array " + std::string(array->GetName()) + ": no sample is a finite number");
      }
      for (std::size_t i = 0; i < kept.size(); ++i)
      {
        values.col(static_cast<Eigen::Index>(i)) = values.col(kept[i]);
        sites.col(static_cast<Eigen::Index>(i)) = points.col(kept[i]);
      }
      values.conservativeResize(Eigen::NoChange, static_cast<Eigen::Index>(kept.size()));
      sites.conservativeResize(Eigen::NoChange, static_cast<Eigen::Index>(kept.size()));
    }
    const double range = SampleRange(values);
    hyperpatch::ScatteredFitOptions options;
    std::copy_n(this->Self->Degree, 3, options.Degrees.begin());
    std::copy_n(this->Self->ControlPoints, 3, options.ControlPoints.begin());
    options.Tolerance = this->ToTarget() ? this->Tolerance(values, range) : 0.0;
    options.Measure = this->Measure();
    Spline spline = hyperpatch::FitScattered(sites, values, { low[0], low[1], low[2] },
      { high[0], high[1], high[2] }, options, parallelFor);
    FitError error = hyperpatch::MeasureError(spline, sites, values, parallelFor);
    error.Where = kept[static_cast<std::size_t>(error.Where)];
    const double reached = error.Of(options.Measure);
    if (this->ToTarget() && reached > options.Tolerance)
    {
      vtkWarningWithObjectMacro(this->Self,
        "the fit of " << array->GetName() << " ended at a relative error of " << reached / range
                      << " with " << spline.NumberOfControlPoints() << " control points for "
                      << values.cols()
                      << " points: the data contradict each other, or vary between neighbours");
    }
    this->Report->Add(this->PatchId, array->GetName(), spline, error, range);
    return spline;
  }

  vtkNURBSFit* Self;
  FitReport* Report;
  int PatchId = 0;
};

VTK_ABI_NAMESPACE_BEGIN
vtkStandardNewMacro(vtkNURBSFit);

vtkNURBSFit::vtkNURBSFit()
{
  this->SetNumberOfOutputPorts(2);
}

vtkNURBSFit::~vtkNURBSFit() = default;

void vtkNURBSFit::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  const char* methods[] = { "Interpolate", "Least Squares", "Data As Control Points",
    "Scattered Data" };
  os << indent << "Method: " << methods[this->Method] << "\n";
  os << indent << "PointArrays:";
  for (const std::string& name : this->PointArrays)
  {
    os << " " << name;
  }
  os << "\n";
  os << indent << "Degree: " << this->Degree[0] << " " << this->Degree[1] << " " << this->Degree[2]
     << "\n";
  os << indent << "FitTo: " << (this->FitTo == TARGET_ERROR ? "Target Error" : "Control Points")
     << "\n";
  os << indent << "ControlPoints: " << this->ControlPoints[0] << " " << this->ControlPoints[1]
     << " " << this->ControlPoints[2] << "\n";
  os << indent << "TargetError: " << this->TargetError << "\n";
  os << indent
     << "ErrorMeasure: " << (this->ErrorMeasure == MAXIMUM ? "Maximum" : "Root Mean Square")
     << "\n";
  os << indent << "Smoothing: " << this->Smoothing << "\n";
  os << indent
     << "SampleParameters: " << (this->SampleParameters == UNIFORM ? "Uniform" : "Chord Length")
     << "\n";
  os << indent << "MissingSamples: " << (this->MissingSamples == REFUSE ? "Refuse" : "Leave Out")
     << "\n";
}

void vtkNURBSFit::AddPointArray(const char* name)
{
  if (name && this->PointArrays.insert(name).second)
  {
    this->Modified();
  }
}

void vtkNURBSFit::ClearPointArrays()
{
  if (!this->PointArrays.empty())
  {
    this->PointArrays.clear();
    this->Modified();
  }
}

int vtkNURBSFit::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkDataSet");
  info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkCompositeDataSet");
  return 1;
}

bool vtkNURBSFit::HasWork(vtkDataObject* input)
{
  this->Whole = WholeInput(input, this->GetController());
  if (hyperpatch::IsSplineData(this->Whole))
  {
    throw Error("the input is a spline model already; NURBS Fit takes sampled data, such as NURBS "
                "Tessellate gives");
  }
  const auto sets = DataSets(this->Whole);
  for (const std::string& name : this->PointArrays)
  {
    const auto has = [&name](const std::pair<int, vtkDataSet*>& set)
    { return set.second->GetPointData()->GetArray(name.c_str()) != nullptr; };
    if (!sets.empty() && std::none_of(sets.begin(), sets.end(), has))
    {
      throw Error("there is no numeric point array \"" + name + "\" to fit");
    }
  }
  for (const int degree : this->Degree)
  {
    if (degree < 1 || degree > hyperpatch::MaxDegree)
    {
      throw Error("degree " + std::to_string(degree) + " is not in 1.." +
        std::to_string(hyperpatch::MaxDegree));
    }
  }
  if (!(this->TargetError > 0.0) || !std::isfinite(this->TargetError))
  {
    throw Error("Target Error must be a finite number greater than 0");
  }
  return !sets.empty();
}

MultiPatch vtkNURBSFit::MakeModel(const Inputs&)
{
  const vtkSmartPointer<vtkDataObject> whole = std::exchange(this->Whole, nullptr);
  const auto sets = DataSets(whole);
  MultiPatch model;
  Fitter fitter(this, *this->Report);
  for (std::size_t i = 0; i < sets.size(); ++i)
  {
    // Writing the output is the rest.
    const double step = 0.9 / static_cast<double>(sets.size());
    const auto [id, set] = sets[i];
    const double begin = step * static_cast<double>(i);
    model.Patches.push_back(fitter.Fit(id, set, begin, begin + step));
  }
  this->SetProgressRange(0.9, 1.0);
  return model;
}

void vtkNURBSFit::ExecuteInput(vtkDataObject* input, vtkDataObject* output)
{
  this->Report = std::make_unique<FitReport>();
  this->Superclass::ExecuteInput(input, output);
  this->Report->Fill(output->GetFieldData());
  if (this->IsFirstPiece())
  {
    this->Report->Fill(vtkTable::SafeDownCast(this->GetOutputDataObject(1))->GetRowData());
  }
  this->ReportProgress(1.0);
}

VTK_ABI_NAMESPACE_END
