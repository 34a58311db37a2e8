// SPDX-License-Identifier: BSD-3-Clause
#include "vtkNURBSAddAttribute.h"

#include "AttributeSampler.h"
#include "Error.h"
#include "Evaluator.h"
#include "FitReport.h"
#include "GridFit.h"
#include "Interpolation.h"
#include "NURBSConversion.h"
#include "Operators.h"
#include "SampleGrid.h"
#include "WholeInput.h"

#include "vtkDataArray.h"
#include "vtkDataSet.h"
#include "vtkDataSetAttributes.h"
#include "vtkInformation.h"
#include "vtkObjectFactory.h"
#include "vtkTable.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace
{

using hyperpatch::Attribute;
using hyperpatch::Error;
using hyperpatch::KnotVector;
using hyperpatch::MultiPatch;
using hyperpatch::Patch;
using hyperpatch::Spline;

using Grid = std::array<std::vector<double>, 3>;

/// Parameters and positions of a grid of points.
struct GridPoints
{
  GridPoints(const Spline& geometry, const Grid& grid)
  {
    const auto count = static_cast<Eigen::Index>(grid[0].size() * grid[1].size() * grid[2].size());
    this->Parameters.resize(3, count);
    Eigen::Index i = 0;
    for (const double w : grid[2])
    {
      for (const double v : grid[1])
      {
        for (const double u : grid[0])
        {
          this->Parameters.col(i++) << u, v, w;
        }
      }
    }
    this->Positions.resize(3, count);
    hyperpatch::Evaluator(geometry).EvaluateGrid(grid, this->Positions.data());
  }
  Eigen::Matrix3Xd Parameters;
  Eigen::Matrix3Xd Positions;
};

std::string PointText(const Eigen::Vector3d& x)
{
  return "(" + std::to_string(x[0]) + ", " + std::to_string(x[1]) + ", " + std::to_string(x[2]) +
    ")";
}

}

/// Makes the attribute of one patch after the other.
class vtkNURBSAddAttribute::Maker
{
public:
  Maker(vtkNURBSAddAttribute* self, vtkDataObject* source, FitReport& report)
    : Self(self)
    , Source(source)
    , Report(&report)
  {
    if (self->AttributeFrom != EXPRESSION && !source)
    {
      throw Error("a second input is needed to take the attribute from");
    }
    if (self->AttributeFrom == EXPRESSION)
    {
      this->Sampler = AttributeSampler::FromExpression(self->Expression);
    }
    else if (self->AttributeFrom == DATA_SET)
    {
      if (hyperpatch::IsSplineData(source))
      {
        throw Error("the second input is a control lattice, whose points are not on the spline: "
                    "put NURBS Tessellate before it, or take the attribute from it as a Lattice");
      }
      this->Sampler = AttributeSampler::FromData(source, self->PointArray);
    }
    else if (hyperpatch::IsSplineData(source))
    {
      this->LatticeModel = hyperpatch::FromVTK(source);
    }
  }

  Spline Make(const Patch& patch)
  {
    return this->Sampler   ? this->Interpolate(patch)
      : this->LatticeModel ? this->FromModel(patch)
                           : this->FromLattice(patch);
  }

private:
  /// Knots of the new attribute; a direction that the geometry does not have stays so. Those of an
  /// unclamped geometry are clamped: then the Greville points are in the domain.
  [[nodiscard]] std::array<KnotVector, 3> MakeKnots(const Spline& geometry, const int* sizes) const
  {
    std::array<KnotVector, 3> knots = hyperpatch::Clamp(geometry).Knots();
    for (std::size_t d = 0; this->Self->Basis == UNIFORM && d < 3; ++d)
    {
      if (knots[d].Degree() > 0)
      {
        const int degree = this->Self->Degree[d];
        if (degree < 1 || sizes[d] < degree + 1)
        {
          throw Error(std::to_string(sizes[d]) + " control points along direction " +
            std::to_string(d) + " do not make a basis of degree " + std::to_string(degree) +
            ": take a degree of 1 or more, and at least one control point more");
        }
        knots[d] = KnotVector::Uniform(degree, sizes[d], knots[d].First(), knots[d].Last());
      }
    }
    return knots;
  }

  Spline Interpolate(const Patch& patch)
  {
    const Spline& geometry = patch.Body.Geometry();
    const std::array<KnotVector, 3> knots = this->MakeKnots(geometry, this->Self->ControlPoints);
    Grid sites;
    Grid between;
    std::array<int, 3> sizes{};
    for (std::size_t d = 0; d < 3; ++d)
    {
      sites[d] = hyperpatch::GrevilleAbscissae(knots[d]);
      sizes[d] = static_cast<int>(sites[d].size());
      for (std::size_t i = 1; i < sites[d].size(); ++i)
      {
        between[d].push_back(0.5 * (sites[d][i - 1] + sites[d][i]));
      }
      if (between[d].empty())
      {
        between[d] = sites[d];
      }
    }
    const GridPoints points(geometry, sites);
    const auto check = [this] { this->Self->ReportProgress(0.0); };
    Eigen::MatrixXd samples = this->Sampler->Sample(points.Positions, points.Parameters, check);
    if (!samples.allFinite())
    {
      this->FillOrRefuse(sizes, points, samples);
    }
    const double range = SampleRange(samples);
    Spline field =
      hyperpatch::Interpolate(knots, sites, std::move(samples), this->Self->KernelParallelFor());

    const GridPoints middles(geometry, between);
    const Eigen::MatrixXd exact =
      this->Sampler->Sample(middles.Positions, middles.Parameters, check);
    const hyperpatch::FitError error = hyperpatch::MeasureError(
      field, between,
      [&exact](Eigen::Index first, Eigen::Index count, double* block)
      { std::copy_n(exact.data() + first * exact.rows(), count * exact.rows(), block); },
      this->Self->KernelParallelFor());
    this->Report->Add(patch.Id, this->Self->AttributeName, field, error, range);
    return field;
  }

  void FillOrRefuse(
    const std::array<int, 3>& sizes, const GridPoints& points, Eigen::MatrixXd& samples) const
  {
    if (this->Self->MissingSamples == LEAVE_OUT)
    {
      hyperpatch::FillMissing(sizes, samples);
      return;
    }
    Eigen::Index missing = 0;
    Eigen::Index first = -1;
    for (Eigen::Index i = 0; i < samples.cols(); ++i)
    {
      if (!samples.col(i).allFinite())
      {
        first = first < 0 ? i : first;
        ++missing;
      }
    }
    throw Error((this->Self->AttributeFrom == EXPRESSION
                    ? "the expression has no finite value"
                    : std::string("the second input has no (finite) value")) +
      " at " + std::to_string(missing) + " of " + std::to_string(samples.cols()) +
      " Greville points, the first is " + PointText(points.Positions.col(first)) +
      ": let Missing Samples leave them out");
  }

  [[nodiscard]] Spline FromModel(const Patch& patch) const
  {
    for (const Patch& other : this->LatticeModel->Patches)
    {
      const auto& attributes = other.Body.Attributes();
      const std::string& name = this->Self->PointArray;
      const Spline* field = name.empty() && attributes.size() == 1 ? &attributes[0].Field
                                                                   : other.Body.FindAttribute(name);
      if (other.Id == patch.Id && field)
      {
        return *field;
      }
    }
    throw Error("the second input has no attribute \"" + this->Self->PointArray + "\" of patch " +
      std::to_string(patch.Id) + " to take as a lattice");
  }

  [[nodiscard]] Spline FromLattice(const Patch& patch) const
  {
    const std::optional<SampleGrid> grid =
      SampleGrid::From(vtkDataSet::SafeDownCast(this->Source), false);
    if (!grid)
    {
      throw Error("a lattice must be an image, a rectilinear or structured grid, or a spline "
                  "model; the second input is a " +
        std::string(this->Source->GetClassName()));
    }
    vtkDataArray* array = FindPointArray(this->Source, this->Self->PointArray);
    Eigen::MatrixXd coefficients = ReadTuples(array);
    if (!coefficients.allFinite() && this->Self->MissingSamples == LEAVE_OUT)
    {
      hyperpatch::FillMissing(grid->Sizes, coefficients);
    }
    CheckSamples(array, coefficients, grid->Sizes);
    const std::array<KnotVector, 3> knots =
      this->MakeKnots(patch.Body.Geometry(), grid->Sizes.data());
    for (std::size_t d = 0; d < 3; ++d)
    {
      if (knots[d].Size() != grid->Sizes[d])
      {
        throw Error("the lattice has " + std::to_string(grid->Sizes[d]) +
          " points along direction " + std::to_string(d) + ", the basis of patch " +
          std::to_string(patch.Id) + " " + std::to_string(knots[d].Size()) +
          ": take a Uniform basis, or another lattice");
      }
    }
    return Spline(knots, std::move(coefficients));
  }

  vtkNURBSAddAttribute* Self;
  vtkDataObject* Source;
  FitReport* Report;
  std::unique_ptr<AttributeSampler> Sampler;
  std::optional<MultiPatch> LatticeModel;
};

VTK_ABI_NAMESPACE_BEGIN
vtkStandardNewMacro(vtkNURBSAddAttribute);

vtkNURBSAddAttribute::vtkNURBSAddAttribute()
{
  this->SetNumberOfInputPorts(2);
  this->SetNumberOfOutputPorts(2);
}

vtkNURBSAddAttribute::~vtkNURBSAddAttribute() = default;

void vtkNURBSAddAttribute::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  const char* sources[] = { "Expression", "Data Set", "Lattice" };
  os << indent << "AttributeName: " << this->AttributeName << "\n";
  os << indent << "AttributeFrom: " << sources[this->AttributeFrom] << "\n";
  os << indent << "Expression: " << this->Expression << "\n";
  os << indent << "PointArray: " << this->PointArray << "\n";
  os << indent << "Basis: " << (this->Basis == GEOMETRY ? "Geometry" : "Uniform") << "\n";
  os << indent << "Degree: " << this->Degree[0] << " " << this->Degree[1] << " " << this->Degree[2]
     << "\n";
  os << indent << "ControlPoints: " << this->ControlPoints[0] << " " << this->ControlPoints[1]
     << " " << this->ControlPoints[2] << "\n";
  os << indent << "MissingSamples: " << (this->MissingSamples == REFUSE ? "Refuse" : "Leave Out")
     << "\n";
}

int vtkNURBSAddAttribute::FillInputPortInformation(int port, vtkInformation* info)
{
  if (port == 0)
  {
    return this->Superclass::FillInputPortInformation(port, info);
  }
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkDataSet");
  info->Append(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkCompositeDataSet");
  info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
  return 1;
}

MultiPatch vtkNURBSAddAttribute::ConvertInput(int port, vtkDataObject* input)
{
  if (port == 0)
  {
    this->Source = nullptr;
    return this->Superclass::ConvertInput(port, input);
  }
  this->Source = WholeInput(input, this->GetController());
  return {};
}

MultiPatch vtkNURBSAddAttribute::MakeModel(const Inputs& inputs)
{
  FitReport report;
  const vtkSmartPointer<vtkDataObject> source = std::exchange(this->Source, nullptr);
  Maker maker(this, source, report);
  MultiPatch model = inputs[0][0];
  const double step = 1.0 / static_cast<double>(model.Patches.size());
  for (std::size_t i = 0; i < model.Patches.size(); ++i)
  {
    this->SetProgressRange(step * static_cast<double>(i), step * static_cast<double>(i + 1));
    this->ReportProgress(0.0);
    Patch& patch = model.Patches[i];
    std::vector<Attribute> attributes = patch.Body.Attributes();
    attributes.erase(std::remove_if(attributes.begin(), attributes.end(),
                       [this](const Attribute& a) { return a.Name == this->AttributeName; }),
      attributes.end());
    attributes.push_back({ this->AttributeName, maker.Make(patch) });
    patch.Body = hyperpatch::Aggregate(patch.Body.Geometry(), std::move(attributes));
  }
  if (this->IsFirstPiece())
  {
    report.Fill(vtkTable::SafeDownCast(this->GetOutputDataObject(1))->GetRowData());
  }
  return model;
}

VTK_ABI_NAMESPACE_END
