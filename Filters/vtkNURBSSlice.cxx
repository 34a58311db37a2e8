// SPDX-License-Identifier: BSD-3-Clause
#include "vtkNURBSSlice.h"

#include "Aggregate.h"
#include "Error.h"
#include "Measures.h"
#include "NURBSMeshOutput.h"
#include "ScalarField.h"

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
  hyperpatch::Quadric q;
  const Eigen::Matrix3d unit = Eigen::Matrix3d::Identity();
  const double c = value(Eigen::Vector3d::Zero());
  Eigen::Vector3d b;
  for (int i = 0; i < 3; ++i)
  {
    const double plus = value(unit.col(i));
    const double minus = value(-unit.col(i));
    b[i] = 0.5 * (plus - minus);
    q.A(i, i) = plane ? 0.0 : 0.5 * (plus + minus) - c;
  }
  for (int i = 0; i < 3 && quadric; ++i)
  {
    for (int j = 0; j < i; ++j)
    {
      const double both = value(unit.col(i) + unit.col(j));
      q.A(i, j) = q.A(j, i) = 0.5 * (both - c - b[i] - b[j] - q.A(i, i) - q.A(j, j));
    }
  }
  q.A /= size * size;
  b /= size;
  q.b = b - (q.A + q.A.transpose()) * centre;
  q.c = c - b.dot(centre) + centre.dot(q.A * centre);
  return q;
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
  std::vector<Task> tasks;
  std::optional<hyperpatch::Quadric> quadric;
  if (!model.Patches.empty())
  {
    const double size = (high - low).norm();
    quadric = AsQuadric(this->SliceFunction, 0.5 * (low + high), size > 0.0 ? size : 1.0);
  }
  for (const hyperpatch::Patch& patch : model.Patches)
  {
    const hyperpatch::Spline& geometry = patch.Body.Geometry();
    const int handedness = hyperpatch::Handedness(patch);
    for (std::size_t i = 0; i < this->OffsetValues.size(); ++i)
    {
      const double offset = this->OffsetValues[i];
      std::shared_ptr<const hyperpatch::ScalarField> field;
      if (quadric)
      {
        hyperpatch::Quadric q = *quadric;
        q.c -= offset;
        if (q.IsPlane())
        {
          field = std::make_shared<hyperpatch::PlaneField>(geometry, q);
        }
        else
        {
          field = std::make_shared<hyperpatch::QuadricField>(geometry, q, true);
        }
      }
      else
      {
        field = std::make_shared<hyperpatch::SampledField>(geometry,
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
      tasks.push_back(
        { std::shared_ptr<const hyperpatch::Patch>(&patch, [](const hyperpatch::Patch*) {}),
          std::move(field), handedness, static_cast<int>(i) });
    }
  }
  NURBSMeshOutput mesh(tolerances.Components, { "SliceIndex" });
  this->Draw(tasks, tolerances, mesh, output->GetFieldData());
  mesh.Fill(vtkPolyData::SafeDownCast(output));
}

VTK_ABI_NAMESPACE_END
