// SPDX-License-Identifier: BSD-3-Clause
#include "vtkNURBSSlice.h"

#include "Aggregate.h"
#include "Error.h"
#include "Measures.h"
#include "NURBSMeshOutput.h"
#include "QuadricField.h"
#include "SampledField.h"

#include "vtkAbstractTransform.h"
#include "vtkCylinder.h"
#include "vtkImplicitFunction.h"
#include "vtkLinearTransform.h"
#include "vtkObjectFactory.h"
#include "vtkPlane.h"
#include "vtkPolyData.h"
#include "vtkQuadric.h"
#include "vtkSphere.h"

#include <algorithm>
#include <cmath>
#include <optional>

VTK_ABI_NAMESPACE_BEGIN
vtkStandardNewMacro(vtkNURBSSlice);

namespace
{

/// The function as a polynomial of degree two, where it is one: read off its values around a point,
/// which also covers transforms and offsets of subclasses.
std::optional<hyperpatch::Quadric> AsQuadric(
  vtkImplicitFunction* function, const Eigen::Vector3d& centre, double size)
{
  const bool plane = vtkPlane::SafeDownCast(function) != nullptr;
  const bool quadric = vtkSphere::SafeDownCast(function) || vtkCylinder::SafeDownCast(function) ||
    vtkQuadric::SafeDownCast(function);
  vtkAbstractTransform* transform = function->GetTransform();
  if ((!plane && !quadric) || (transform && !vtkLinearTransform::SafeDownCast(transform)))
  {
    return std::nullopt;
  }
  const auto value = [&](const Eigen::Vector3d& offset)
  {
    Eigen::Vector3d x = centre + size * offset;
    return function->FunctionValue(x.data());
  };
  // q(centre + size y) = y' A y + b . y + c
  const Eigen::Matrix3d unit = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b;
  const double c = value(Eigen::Vector3d::Zero());
  for (int i = 0; i < 3; ++i)
  {
    const double plus = value(unit.col(i));
    const double minus = value(-unit.col(i));
    b[i] = 0.5 * (plus - minus);
    A(i, i) = 0.5 * (plus + minus) - c;
  }
  for (int i = 0; i < 3; ++i)
  {
    for (int j = 0; j < i; ++j)
    {
      const double both = value(unit.col(i) + unit.col(j));
      A(i, j) = A(j, i) = 0.5 * (both - c - b[i] - b[j] - A(i, i) - A(j, j));
    }
  }
  b /= size;
  if (plane)
  {
    return hyperpatch::Quadric{ Eigen::MatrixXd(), b, c, centre };
  }
  A /= size * size;
  return hyperpatch::Quadric{ A, b, c, centre };
}

}

vtkNURBSSlice::vtkNURBSSlice() = default;
vtkNURBSSlice::~vtkNURBSSlice() = default;

void vtkNURBSSlice::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "SliceFunction: " << this->SliceFunction.Get() << "\n";
  os << indent << "OffsetValues:";
  for (const double value : this->OffsetValues)
  {
    os << " " << value;
  }
  os << "\n";
}

vtkMTimeType vtkNURBSSlice::GetMTime()
{
  const vtkMTimeType own = this->Superclass::GetMTime();
  return this->SliceFunction ? std::max(own, this->SliceFunction->GetMTime()) : own;
}

void vtkNURBSSlice::SetSliceFunction(vtkImplicitFunction* function)
{
  if (this->SliceFunction != function)
  {
    this->SliceFunction = function;
    this->Modified();
  }
}

vtkImplicitFunction* vtkNURBSSlice::GetSliceFunction()
{
  return this->SliceFunction;
}

void vtkNURBSSlice::SetNumberOfOffsetValues(int number)
{
  const auto size = static_cast<std::size_t>(std::max(number, 0));
  if (this->OffsetValues.size() != size)
  {
    this->OffsetValues.resize(size, 0.0);
    this->Modified();
  }
}

void vtkNURBSSlice::SetOffsetValue(int i, double value)
{
  if (i < 0)
  {
    vtkErrorMacro("there is no offset value " << i);
    return;
  }
  if (i >= this->GetNumberOfOffsetValues())
  {
    this->SetNumberOfOffsetValues(i + 1);
  }
  double& at = this->OffsetValues[static_cast<std::size_t>(i)];
  if (at != value)
  {
    at = value;
    this->Modified();
  }
}

double vtkNURBSSlice::GetOffsetValue(int i)
{
  return i >= 0 && i < this->GetNumberOfOffsetValues()
    ? this->OffsetValues[static_cast<std::size_t>(i)]
    : 0.0;
}

void vtkNURBSSlice::Execute(const hyperpatch::MultiPatch& model, vtkDataObject* output)
{
  if (!this->SliceFunction)
  {
    throw hyperpatch::Error("there is no function to slice with: set SliceFunction");
  }
  const AbsoluteTolerances tolerances = this->FindTolerances(model);
  const hyperpatch::Bounds bounds = hyperpatch::ControlPointBounds(model);
  const Eigen::Vector3d low(bounds.Low.data());
  const Eigen::Vector3d high(bounds.High.data());
  for (const double offset : this->OffsetValues)
  {
    if (!std::isfinite(offset))
    {
      throw hyperpatch::Error("an offset value is not a finite number");
    }
  }
  std::vector<Task> tasks;
  std::optional<hyperpatch::Quadric> quadric;
  if (!model.Patches.empty())
  {
    const double size = (high - low).norm();
    quadric = AsQuadric(this->SliceFunction, 0.5 * (low + high), size > 0.0 ? size : 1.0);
  }
  if (quadric && !(quadric->b.allFinite() && quadric->A.allFinite() && std::isfinite(quadric->c)))
  {
    throw hyperpatch::Error(
      "the function to slice with has parameters that are not finite numbers");
  }
  if (quadric && quadric->IsLinear() && quadric->b.isZero(0.0))
  {
    throw hyperpatch::Error("the normal of the plane is zero");
  }
  for (const PreparedPatch& patch : this->Prepare(model))
  {
    for (std::size_t i = 0; i < this->OffsetValues.size(); ++i)
    {
      const double offset = this->OffsetValues[i];
      std::shared_ptr<const hyperpatch::ScalarField> field;
      if (quadric)
      {
        hyperpatch::Quadric q = *quadric;
        q.c -= offset;
        field =
          std::make_shared<hyperpatch::QuadricField>(patch.Body->Geometry(), std::move(q), true);
      }
      else
      {
        field = std::make_shared<hyperpatch::SampledField>(patch.Body->Geometry(),
          [function = this->SliceFunction, offset](
            std::size_t count, const double* points, double* values, double* gradients)
          {
            for (std::size_t p = 0; p < count; ++p)
            {
              double x[3] = { points[3 * p], points[3 * p + 1], points[3 * p + 2] };
              values[p] = function->FunctionValue(x) - offset;
              if (gradients)
              {
                function->FunctionGradient(x, gradients + 3 * p);
              }
            }
          });
      }
      tasks.push_back({ patch, std::move(field), static_cast<int>(i) });
    }
  }
  NURBSMeshOutput mesh(tolerances.Components, { "SliceIndex" });
  this->Draw(tasks, tolerances, mesh, output->GetFieldData());
  mesh.Fill(vtkPolyData::SafeDownCast(output));
}

VTK_ABI_NAMESPACE_END
