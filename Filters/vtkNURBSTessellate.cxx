// SPDX-License-Identifier: BSD-3-Clause
#include "vtkNURBSTessellate.h"

#include "Aggregate.h"
#include "ArrayNames.h"
#include "Measures.h"
#include "NURBSMeshOutput.h"
#include "Tessellation.h"

#include "vtkObjectFactory.h"
#include "vtkPointSet.h"
#include "vtkType.h"

#include <algorithm>
#include <utility>

VTK_ABI_NAMESPACE_BEGIN
vtkStandardNewMacro(vtkNURBSTessellate);

void vtkNURBSTessellate::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "MeshType: " << (this->MeshType == SURFACE ? "Surface" : "Solid") << "\n";
  os << indent << "KnotLines: " << (this->KnotLines ? "on" : "off") << "\n";
}

int vtkNURBSTessellate::OutputType() const
{
  return this->MeshType == SURFACE ? VTK_POLY_DATA : VTK_UNSTRUCTURED_GRID;
}

void vtkNURBSTessellate::Execute(const hyperpatch::MultiPatch& model, vtkDataObject* output)
{
  const AbsoluteTolerances tolerances = this->FindTolerances(model);
  const bool solid = this->MeshType == SOLID;
  const std::size_t count = model.Patches.size();
  std::vector<hyperpatch::SurfaceMesh> surfaces(count);
  std::vector<hyperpatch::SolidMesh> solids(count);
  const auto tessellate = [&](std::size_t i, hyperpatch::ParallelFor loop)
  {
    const hyperpatch::Patch& patch = model.Patches[i];
    hyperpatch::TessellationOptions options;
    options.Tolerance = tolerances.Position;
    options.AttributeTolerances = tolerances.Of(patch);
    options.KnotLines = this->KnotLines;
    options.For = std::move(loop);
    const int handedness = hyperpatch::Handedness(patch) < 0 ? -1 : 1;
    if (solid && patch.Body.Geometry().Dimension() == 3)
    {
      solids[i] = hyperpatch::TessellateSolid(patch, handedness, options);
    }
    if (!solid || this->KnotLines || patch.Body.Geometry().Dimension() < 3)
    {
      surfaces[i] = hyperpatch::TessellateBoundary(patch, handedness, options);
    }
  };
  // Few patches: the loops inside use the threads. Many: they are dealt out whole.
  if (count < 8)
  {
    for (std::size_t i = 0; i < count; ++i)
    {
      this->SetProgressRange(static_cast<double>(i) / count, static_cast<double>(i + 1) / count);
      tessellate(i, this->KernelParallelFor());
    }
  }
  else
  {
    this->ParallelFor(static_cast<vtkIdType>(count), 1,
      [&tessellate](vtkIdType begin, vtkIdType end)
      {
        for (vtkIdType i = begin; i < end; ++i)
        {
          tessellate(static_cast<std::size_t>(i), hyperpatch::SerialFor);
        }
      });
  }

  // Curves alone have no normals: zeros would draw them black.
  const bool normals = this->AnyRank(std::any_of(model.Patches.begin(), model.Patches.end(),
    [](const hyperpatch::Patch& patch) { return patch.Body.Geometry().Dimension() > 1; }));
  NURBSMeshOutput mesh(tolerances.Components, { hyperpatch::names::Side });
  bool limited = false;
  for (std::size_t i = 0; i < count; ++i)
  {
    const hyperpatch::Patch& patch = model.Patches[i];
    const bool volume = patch.Body.Geometry().Dimension() == 3;
    hyperpatch::SolidMesh s = std::move(solids[i]);
    hyperpatch::SurfaceMesh b = std::move(surfaces[i]);
    limited = limited || s.LimitReached || b.LimitReached;
    this->ReportProgress(0.0);
    if (solid && volume)
    {
      mesh.AddPoints(
        patch, std::move(s.Parameters), std::move(s.Points), {}, std::move(s.Attributes));
      mesh.AddCells(patch, std::move(s.Hexahedra), std::move(s.Elements), { { -1 } });
    }
    if (!normals)
    {
      b.Normals.resize(3, 0);
    }
    mesh.AddPoints(patch, std::move(b.Parameters), std::move(b.Points), std::move(b.Normals),
      std::move(b.Attributes));
    const std::vector<int> noSide{ -1 };
    mesh.AddCells(patch, std::move(b.Lines), std::move(b.LineElements),
      { volume ? std::move(b.LineSides) : noSide });
    if (!solid || !volume)
    {
      mesh.AddCells(patch, std::move(b.Triangles), std::move(b.TriangleElements),
        { volume ? std::move(b.TriangleSides) : noSide });
    }
  }
  if (limited)
  {
    vtkWarningMacro(
      "the limit of subdivision was reached before the tolerance: the mesh is coarser "
      "than Tolerance and Attribute Tolerance ask for");
  }
  mesh.Fill(vtkPointSet::SafeDownCast(output), this->KernelParallelFor());
}

VTK_ABI_NAMESPACE_END
