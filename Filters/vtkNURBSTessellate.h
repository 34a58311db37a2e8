// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkNURBSTessellate
 * @brief A mesh of spline volumes, surfaces and curves, to stated tolerances.
 *
 * Makes an ordinary mesh of the boundary or of the whole solid, as fine as the tolerances ask and
 * no finer, for everything that works on meshes. The bounds on second derivatives that decide the
 * fineness come from the Bezier control points of each element, so the tolerances are guaranteed,
 * not sampled.
 *
 * Input: see vtkNURBSAlgorithm. Output: vtkPolyData with the triangles of the domain faces (of the
 * surface itself where the input is a surface; line segments where it is a curve), or
 * vtkUnstructuredGrid with hexahedra; arrays of vtkNURBSMeshAlgorithm, and in the surface mesh
 * `Side` (cell data; 0..5 for u = first, u = last, v = first, ... w = last; -1 elsewhere). With
 * KnotLines the element edges are added as line segments.
 *
 * The boundary is closed where faces of a patch, conforming patches and pieces of a split patch
 * meet: the points on an edge depend on that edge alone. Normals are outward.
 *
 * Cost: of the boundary proportional to the elements on it plus the output; of the solid
 * proportional to the output.
 *
 * References: Filip, Magedson, Markot, Surface algorithms using bounds on derivatives, CAGD 3
 * (1986).
 *
 * @sa vtkNURBSSlice, vtkNURBSContour
 */
#ifndef vtkNURBSTessellate_h
#define vtkNURBSTessellate_h

#include "vtkNURBSFiltersModule.h" // for the export macro
#include "vtkNURBSMeshAlgorithm.h"

class VTKNURBSFILTERS_EXPORT vtkNURBSTessellate : public vtkNURBSMeshAlgorithm
{
public:
  static vtkNURBSTessellate* New();
  vtkTypeMacro(vtkNURBSTessellate, vtkNURBSMeshAlgorithm)
  void PrintSelf(ostream& os, vtkIndent indent) override;

  enum MeshTypes
  {
    SURFACE = 0,
    SOLID = 1
  };

  ///@{
  /**
   * Whether to mesh the boundary (SURFACE, the default) or the inside (SOLID).
   */
  vtkSetClampMacro(MeshType, int, SURFACE, SOLID);
  vtkGetMacro(MeshType, int);
  void SetMeshTypeToSurface() { this->SetMeshType(SURFACE); }
  void SetMeshTypeToSolid() { this->SetMeshType(SOLID); }
  ///@}

  ///@{
  /**
   * Whether to add the edges of the elements as lines. Default off.
   */
  vtkSetMacro(KnotLines, bool);
  vtkGetMacro(KnotLines, bool);
  vtkBooleanMacro(KnotLines, bool);
  ///@}

protected:
  vtkNURBSTessellate() = default;
  ~vtkNURBSTessellate() override = default;

  int OutputType() const override;
  void Execute(const hyperpatch::MultiPatch& model, vtkDataObject* output) override;

private:
  vtkNURBSTessellate(const vtkNURBSTessellate&) = delete;
  void operator=(const vtkNURBSTessellate&) = delete;

  int MeshType = SURFACE;
  bool KnotLines = false;
};

#endif
