// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkNURBSSolidRepresentation
 * @brief The representation "NURBS Solid": a control lattice is shown as the solid it stands for.
 *
 * The surface representation with another geometry filter; see vtkNURBSGeometryFilter. The edges of
 * "Surface With Edges" are the knot lines, in the edge colour and line width. Data that is no
 * control lattice is shown as "Surface" and "Surface With Edges" show it.
 *
 * Selections do not see the solid: what they find are cells of the input, and no cell of the
 * lattice is what the user points at. (The output of vtkNURBSTessellate can be selected.)
 */
#ifndef vtkNURBSSolidRepresentation_h
#define vtkNURBSSolidRepresentation_h

#include "vtkGeometryRepresentationWithFaces.h"
#include "vtkNURBSRepresentationModule.h" // for the export macro
#include "vtkNew.h"                       // for the knot lines

class vtkActor;
class vtkNURBSGeometryFilter;
class vtkPolyDataMapper;

class VTKNURBSREPRESENTATION_EXPORT vtkNURBSSolidRepresentation
  : public vtkGeometryRepresentationWithFaces
{
public:
  static vtkNURBSSolidRepresentation* New();
  vtkTypeMacro(vtkNURBSSolidRepresentation, vtkGeometryRepresentationWithFaces)
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * Those of vtkNURBSMeshAlgorithm, with its defaults.
   */
  void SetTolerance(double tolerance);
  double GetTolerance();
  void SetAttributeTolerance(double tolerance);
  double GetAttributeTolerance();
  ///@}

  /**
   * The array for smooth shading. None stands for the exact normals of the solid, which a property
   * that looks at the input cannot offer; for flat shading there is Interpolation.
   */
  void SetNormalArray(const char* name) override;

  ///@{
  /**
   * Overridden for the knot lines.
   */
  using Superclass::SetRepresentation;
  void SetRepresentation(const char* type) override;
  void SetVisibility(bool visible) override;
  int ProcessViewRequest(
    vtkInformationRequestKey* request, vtkInformation* inInfo, vtkInformation* outInfo) override;
  ///@}

  /**
   * Whether selections see data that is no control lattice.
   */
  void SetPickable(int pickable) override;

protected:
  vtkNURBSSolidRepresentation();
  ~vtkNURBSSolidRepresentation() override;

  bool AddToView(vtkView* view) override;
  bool RemoveFromView(vtkView* view) override;
  void UpdateColoringParameters() override;

private:
  vtkNURBSSolidRepresentation(const vtkNURBSSolidRepresentation&) = delete;
  void operator=(const vtkNURBSSolidRepresentation&) = delete;

  vtkNURBSGeometryFilter* GetFilter();
  void UpdateKnotLines();

  vtkNew<vtkActor> KnotLines;
  vtkNew<vtkPolyDataMapper> KnotLineMapper;
  bool Pickable = true;
};

#endif
