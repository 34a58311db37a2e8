// SPDX-License-Identifier: BSD-3-Clause
#include "FunctionFields.h"

#include "Error.h"
#include "Measures.h"
#include "SampledField.h"

#include "vtkAbstractTransform.h"
#include "vtkBox.h"
#include "vtkCylinder.h"
#include "vtkImplicitFunction.h"
#include "vtkLinearTransform.h"
#include "vtkPlane.h"
#include "vtkQuadric.h"
#include "vtkSphere.h"

#include <algorithm>
#include <array>
#include <functional>
#include <utility>

namespace
{

/// The functions that a function is the maximum of, where they are polynomials of degree two at
/// most; empty where it can only be sampled.
struct Polynomials
{
  std::vector<std::function<double(const Eigen::Vector3d&)>> Values;
  bool AreLinear = false;
};

Polynomials PolynomialsOf(vtkImplicitFunction* function)
{
  vtkAbstractTransform* transform = function->GetTransform();
  if (transform && !vtkLinearTransform::SafeDownCast(transform))
  {
    return {};
  }
  Polynomials result;
  if (auto* box = vtkBox::SafeDownCast(function))
  {
    std::array<double, 6> bounds{};
    box->GetBounds(bounds.data());
    for (int side = 0; side < 6; ++side)
    {
      const double bound = bounds[static_cast<std::size_t>(side)];
      result.Values.emplace_back(
        [transform, side, bound](const Eigen::Vector3d& x)
        {
          Eigen::Vector3d local = x;
          if (transform)
          {
            transform->TransformPoint(x.data(), local.data());
          }
          return side % 2 == 0 ? bound - local[side / 2] : local[side / 2] - bound;
        });
    }
    result.AreLinear = true;
  }
  else if (vtkPlane::SafeDownCast(function) || vtkSphere::SafeDownCast(function) ||
    vtkCylinder::SafeDownCast(function) || vtkQuadric::SafeDownCast(function))
  {
    result.Values.emplace_back(
      [function](Eigen::Vector3d x) { return function->FunctionValue(x.data()); });
    result.AreLinear = vtkPlane::SafeDownCast(function) != nullptr;
  }
  return result;
}

}

FunctionFields::FunctionFields(vtkImplicitFunction* function, const hyperpatch::MultiPatch& model)
  : Function(function)
{
  if (!function)
  {
    throw hyperpatch::Error("there is no function to slice with: set SliceFunction");
  }
  this->IsBox = vtkBox::SafeDownCast(function) != nullptr;
  // Without a patch the function is looked at all the same: all ranks find the same faults.
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double size = 1.0;
  if (!model.Patches.empty())
  {
    const hyperpatch::Bounds bounds = hyperpatch::ControlPointBounds(model);
    const Eigen::Vector3d low(bounds.Low.data());
    const Eigen::Vector3d high(bounds.High.data());
    centre = 0.5 * (low + high);
    size = high != low ? (high - low).norm() : 1.0;
  }
  const Polynomials polynomials = PolynomialsOf(function);
  for (const auto& value : polynomials.Values)
  {
    auto quadric = hyperpatch::QuadricFromValues(value, polynomials.AreLinear, centre, size);
    if (!quadric)
    {
      throw hyperpatch::Error(
        "the function to cut with has parameters that are not finite numbers");
    }
    if (quadric->IsLinear() && quadric->b.isZero(0.0))
    {
      throw hyperpatch::Error(this->IsBox ? "the box to cut with has no extent in a direction"
                                          : "the normal of the plane is zero");
    }
    this->Quadrics.push_back(std::move(*quadric));
  }
}

std::vector<std::shared_ptr<const hyperpatch::ScalarField>> FunctionFields::At(
  const hyperpatch::PreparedAggregate& body, double value) const
{
  std::vector<std::shared_ptr<const hyperpatch::ScalarField>> fields;
  // Outside, a box measures the distance from itself, which is round at its edges.
  if (!this->Quadrics.empty() && !(this->IsBox && value > 0.0))
  {
    for (hyperpatch::Quadric quadric : this->Quadrics)
    {
      quadric.c -= value;
      fields.push_back(
        std::make_shared<hyperpatch::QuadricField>(body.Geometry(), std::move(quadric), true));
    }
    return fields;
  }
  fields.push_back(std::make_shared<hyperpatch::SampledField>(body.Geometry(),
    [function = this->Function, value](
      std::size_t count, const double* points, double* values, double* gradients)
    {
      for (std::size_t p = 0; p < count; ++p)
      {
        double x[3] = { points[3 * p], points[3 * p + 1], points[3 * p + 2] };
        values[p] = function->FunctionValue(x) - value;
        if (gradients)
        {
          function->FunctionGradient(x, gradients + 3 * p);
        }
      }
    }));
  return fields;
}
