// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkNURBSSolidRepresentation
 * @brief The representation "NURBS Solid": a control lattice is shown as the solid it stands for.
 *
 * The surface representation with another geometry filter; see vtkNURBSGeometryFilter. Data that is
 * no control lattice is shown as "Surface" shows it.
 */
#ifndef vtkNURBSSolidRepresentation_h
#define vtkNURBSSolidRepresentation_h

#include "vtkGeometryRepresentationWithFaces.h"
#include "vtkNURBSRepresentationModule.h" // for the export macro

class vtkNURBSTessellate;

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

protected:
  vtkNURBSSolidRepresentation();
  ~vtkNURBSSolidRepresentation() override = default;

private:
  vtkNURBSSolidRepresentation(const vtkNURBSSolidRepresentation&) = delete;
  void operator=(const vtkNURBSSolidRepresentation&) = delete;

  vtkNURBSTessellate* GetTessellation();
};

#endif
