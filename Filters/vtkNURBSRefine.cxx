// SPDX-License-Identifier: BSD-3-Clause
#include "vtkNURBSRefine.h"

#include "Error.h"
#include "NURBSConversion.h"
#include "Operators.h"
#include "Reparametrise.h"

#include "vtkObjectFactory.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <string>
#include <utility>

namespace
{

using hyperpatch::Aggregate;
using hyperpatch::Attribute;
using hyperpatch::Error;
using hyperpatch::KnotVector;
using hyperpatch::MultiPatch;
using hyperpatch::Patch;
using hyperpatch::Spline;

using Function = std::function<Spline(const Spline&)>;

/// Applies a function to the chosen bases.
Aggregate ApplyToBases(const Aggregate& body, int bases, const Function& function)
{
  std::vector<Attribute> attributes;
  for (const Attribute& attribute : body.Attributes())
  {
    const bool shares = hyperpatch::SharesBasis(body.Geometry(), attribute.Field);
    const bool chosen =
      bases == vtkNURBSRefine::ALL_BASES || shares == (bases == vtkNURBSRefine::GEOMETRY);
    attributes.push_back({ attribute.Name, chosen ? function(attribute.Field) : attribute.Field });
  }
  return Aggregate(
    bases == vtkNURBSRefine::ATTRIBUTES ? body.Geometry() : function(body.Geometry()),
    std::move(attributes));
}

bool IsThere(const Spline& spline, int direction)
{
  return spline.Knots(direction).Degree() > 0;
}

void CheckDirection(const MultiPatch& model, int direction)
{
  for (const Patch& patch : model.Patches)
  {
    if (!IsThere(patch.Body.Geometry(), direction))
    {
      throw Error("patch " + std::to_string(patch.Id) + " has no direction " + "uvw"[direction]);
    }
  }
}

/// The part on a box, and what of the topology it keeps.
MultiPatch Restrict(const MultiPatch& model, const double box[6])
{
  MultiPatch part = model;
  // Sides that stay: those that are at an end of the box which is an end of the domain.
  const auto keeps = [&](int id, int side)
  {
    const auto patch = std::find_if(
      model.Patches.begin(), model.Patches.end(), [id](const Patch& p) { return p.Id == id; });
    if (patch == model.Patches.end())
    {
      return false;
    }
    const KnotVector& knots = patch->Body.Geometry().Knots(side / 2);
    return box[side] == (side % 2 == 0 ? knots.First() : knots.Last());
  };
  for (Patch& patch : part.Patches)
  {
    const Spline& geometry = patch.Body.Geometry();
    patch.Body = hyperpatch::Apply(patch.Body,
      [&](const Spline& spline)
      {
        std::array<double, 3> low;
        std::array<double, 3> high;
        for (std::size_t d = 0; d < 3; ++d)
        {
          // Domains of attributes agree with that of the geometry to rounding.
          const KnotVector& g = geometry.Knots()[d];
          const KnotVector& own = spline.Knots()[d];
          const bool there = g.Degree() > 0;
          low[d] = there && box[2 * d] != g.First() ? box[2 * d] : own.First();
          high[d] = there && box[2 * d + 1] != g.Last() ? box[2 * d + 1] : own.Last();
        }
        return hyperpatch::RestrictToBox(spline, low, high);
      });
  }
  // Faces that were joined still are where both lose the same; they are found again.
  part.Interfaces.clear();
  for (hyperpatch::Boundary& boundary : part.Boundaries)
  {
    auto& sides = boundary.Sides;
    sides.erase(std::remove_if(sides.begin(), sides.end(),
                  [&keeps](const std::array<int, 2>& side) { return !keeps(side[0], side[1]); }),
      sides.end());
  }
  auto& boundaries = part.Boundaries;
  boundaries.erase(std::remove_if(boundaries.begin(), boundaries.end(),
                     [](const hyperpatch::Boundary& b) { return b.Sides.empty(); }),
    boundaries.end());
  return part;
}

}

VTK_ABI_NAMESPACE_BEGIN
vtkStandardNewMacro(vtkNURBSRefine);

void vtkNURBSRefine::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  const char* operations[] = { "Refine Uniformly", "Insert Knots", "Elevate Degrees",
    "Split To Bezier", "Restrict To Box", "Reverse Direction", "Swap Directions",
    "Normalise Domains" };
  const char* bases[] = { "All", "Geometry", "Attributes" };
  os << indent << "Operation: " << operations[this->Operation] << "\n";
  os << indent << "Bases: " << bases[this->Bases] << "\n";
  os << indent << "Pieces: " << this->Pieces[0] << " " << this->Pieces[1] << " " << this->Pieces[2]
     << "\n";
  os << indent << "Knots:";
  for (const double knot : this->Knots)
  {
    os << " " << knot;
  }
  os << "\n"
     << indent << "Elevations: " << this->Elevations[0] << " " << this->Elevations[1] << " "
     << this->Elevations[2] << "\n";
  os << indent << "ParameterBox:";
  for (const double end : this->ParameterBox)
  {
    os << " " << end;
  }
  os << "\n"
     << indent << "Direction: "
     << "uvw"[this->Direction] << "\n";
  os << indent << "OtherDirection: "
     << "uvw"[this->OtherDirection] << "\n";
}

void vtkNURBSRefine::SetNumberOfKnots(int number)
{
  if (number >= 0 && number != this->GetNumberOfKnots())
  {
    this->Knots.resize(static_cast<std::size_t>(number));
    this->Modified();
  }
}

void vtkNURBSRefine::SetKnot(int index, double knot)
{
  if (index >= 0 && index < this->GetNumberOfKnots() &&
    this->Knots[static_cast<std::size_t>(index)] != knot)
  {
    this->Knots[static_cast<std::size_t>(index)] = knot;
    this->Modified();
  }
}

MultiPatch vtkNURBSRefine::ConvertInput(int, vtkDataObject* input)
{
  return hyperpatch::FromVTK(input,
    this->Operation == NORMALISE_DOMAINS ? hyperpatch::Domains::Normalised
                                         : hyperpatch::Domains::Kept);
}

MultiPatch vtkNURBSRefine::MakeModel(const Inputs& inputs)
{
  MultiPatch model = inputs[0][0];
  const int direction = this->Direction;
  Function function;
  switch (this->Operation)
  {
    case INSERT_KNOTS:
    {
      CheckDirection(model, direction);
      std::vector<double> knots = this->Knots;
      std::sort(knots.begin(), knots.end());
      function = [knots, direction](const Spline& spline) {
        return IsThere(spline, direction) ? hyperpatch::InsertKnots(spline, direction, knots)
                                          : spline;
      };
      break;
    }
    case ELEVATE_DEGREES:
      function = [this](const Spline& spline)
      {
        Spline elevated = spline;
        for (int d = 0; d < 3; ++d)
        {
          elevated = IsThere(spline, d)
            ? hyperpatch::ElevateDegree(elevated, d, this->Elevations[d])
            : elevated;
        }
        return elevated;
      };
      break;
    case SPLIT_TO_BEZIER:
      function = hyperpatch::ToBezier;
      break;
    case RESTRICT_TO_BOX:
      return Restrict(model, this->ParameterBox);
    case REVERSE_DIRECTION:
      CheckDirection(model, direction);
      return hyperpatch::ReverseDirection(std::move(model), direction);
    case SWAP_DIRECTIONS:
      return hyperpatch::SwapDirections(std::move(model), direction, this->OtherDirection);
    case NORMALISE_DOMAINS:
      return model;
    default:
      function = [this](const Spline& spline)
      {
        return hyperpatch::RefineUniformly(
          spline, { this->Pieces[0], this->Pieces[1], this->Pieces[2] });
      };
  }
  for (Patch& patch : model.Patches)
  {
    patch.Body = ApplyToBases(patch.Body, this->Bases, function);
  }
  return model;
}

VTK_ABI_NAMESPACE_END
