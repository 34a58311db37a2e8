// SPDX-License-Identifier: BSD-3-Clause
#include "vtkNURBSJacobianBoundary.h"

#include "Measures.h"
#include "NURBSMeshOutput.h"
#include "Operators.h"
#include "ScalarField.h"
#include "Tessellation.h"

#include "vtkObjectFactory.h"
#include "vtkPolyData.h"

#include <algorithm>
#include <array>

VTK_ABI_NAMESPACE_BEGIN
vtkStandardNewMacro(vtkNURBSJacobianBoundary);

namespace
{

/// Begins of the blocks of knot spans between which the basis is only C0, and the end.
std::vector<int> SmoothBlocks(const hyperpatch::KnotVector& knots)
{
  const std::vector<double> breaks = knots.Breaks();
  std::vector<int> begins{ 0 };
  for (const double crease : knots.Creases())
  {
    begins.push_back(
      static_cast<int>(std::lower_bound(breaks.begin(), breaks.end(), crease) - breaks.begin()));
  }
  begins.push_back(static_cast<int>(breaks.size()) - 1);
  return begins;
}

}

void vtkNURBSJacobianBoundary::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Faces: " << (this->Faces ? "on" : "off") << "\n";
  os << indent << "Sheet: " << (this->Sheet ? "on" : "off") << "\n";
}

void vtkNURBSJacobianBoundary::Execute(const hyperpatch::MultiPatch& model, vtkDataObject* output)
{
  const AbsoluteTolerances tolerances = this->FindTolerances(model);
  NURBSMeshOutput mesh(tolerances.Components, { "Piece" });
  std::vector<Task> tasks;
  int leftOut = 0;
  for (const PreparedPatch& prepared : this->Prepare(model))
  {
    const hyperpatch::Patch& patch = *prepared.Patch;
    const hyperpatch::Spline& geometry = patch.Body.Geometry();
    if (geometry.Dimension() < 3)
    {
      ++leftOut;
      continue;
    }
    if (this->Faces)
    {
      hyperpatch::TessellationOptions options;
      options.Tolerance = tolerances.Position;
      options.AttributeTolerances = tolerances.Of(patch);
      options.For = this->KernelParallelFor();
      const hyperpatch::SurfaceMesh faces =
        hyperpatch::TessellateBoundary(patch, prepared.Handedness, options);
      mesh.AddPoints(patch, faces.Parameters, faces.Points, faces.Normals, faces.Attributes);
      mesh.AddCells(patch, faces.Triangles, faces.TriangleElements, { faces.TriangleSides });
    }
    if (!this->Sheet)
    {
      continue;
    }
    std::array<std::vector<int>, 3> blocks;
    for (std::size_t d = 0; d < 3; ++d)
    {
      blocks[d] = SmoothBlocks(geometry.Knots()[d]);
    }
    // Parts of the patch have its handedness; told once, it is not computed for each of them.
    hyperpatch::Patch known = patch;
    known.WholeHandedness = prepared.Handedness;
    const bool whole = blocks[0].size() + blocks[1].size() + blocks[2].size() == 6;
    for (std::size_t k = 0; k + 1 < blocks[2].size(); ++k)
    {
      for (std::size_t j = 0; j + 1 < blocks[1].size(); ++j)
      {
        for (std::size_t i = 0; i + 1 < blocks[0].size(); ++i)
        {
          PreparedPatch part = prepared;
          if (!whole)
          {
            part.Patch = std::make_shared<const hyperpatch::Patch>(
              hyperpatch::RestrictPatch(known, { blocks[0][i], blocks[1][j], blocks[2][k] },
                { blocks[0][i + 1], blocks[1][j + 1], blocks[2][k + 1] }));
            part.Body = std::make_shared<const hyperpatch::PreparedAggregate>(part.Patch->Body);
          }
          auto field = std::make_shared<hyperpatch::JacobianField>(part.Body->Geometry());
          tasks.push_back({ std::move(part), std::move(field), SHEET });
        }
      }
    }
  }
  if (leftOut > 0)
  {
    vtkWarningMacro(<< leftOut << " patches are curves or surfaces and have no Jacobian boundary");
  }
  this->Draw(tasks, tolerances, mesh, output->GetFieldData());
  mesh.Fill(vtkPolyData::SafeDownCast(output));
}

VTK_ABI_NAMESPACE_END
