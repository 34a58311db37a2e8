// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkNURBSGeometryFilter
 * @brief What NURBS Solid draws: the exact boundary of a control lattice, anything else as it is.
 *
 * A control lattice (see hyperpatch::IsSplineData()) is replaced by its boundary as
 * vtkNURBSTessellate draws it; then, and for all other data, vtkPVGeometryFilter does its work.
 *
 * Of a collection all patches become one vtkPolyData in its first partitioned dataset, since a view
 * pays for every block; the other datasets stay, empty, so that block selectors keep their meaning
 * and all ranks have the same list. Input that vtkNURBSTessellate refuses gives its error message
 * and nothing to draw.
 *
 * The lines that the tessellation makes with KnotLines are kept apart, see GetKnotLines(). The
 * surface has no vtkOriginalCellIds: its triangles come from no cell of the lattice.
 *
 * Whether there are splines is asked of all ranks: one that has no patch takes part all the same.
 *
 * @sa vtkNURBSTessellate, vtkNURBSSolidRepresentation
 */
#ifndef vtkNURBSGeometryFilter_h
#define vtkNURBSGeometryFilter_h

#include "vtkNURBSRepresentationModule.h" // for the export macro
#include "vtkNew.h"                       // for the tessellation and its lines
#include "vtkPVGeometryFilter.h"
#include "vtkPolyData.h" // for the lines

class vtkNURBSTessellate;

class VTKNURBSREPRESENTATION_EXPORT vtkNURBSGeometryFilter : public vtkPVGeometryFilter
{
public:
  static vtkNURBSGeometryFilter* New();
  vtkTypeMacro(vtkNURBSGeometryFilter, vtkPVGeometryFilter)
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /// Holds the tolerances, and whether there are knot lines.
  vtkNURBSTessellate* GetTessellation() { return this->Tessellation; }

  /// The knot lines of the last output, without arrays; no cells if none were asked for or the
  /// input was no lattice.
  vtkPolyData* GetKnotLines() { return this->KnotLines; }

  /// Also that of the tessellation.
  vtkMTimeType GetMTime() override;

protected:
  vtkNURBSGeometryFilter();
  ~vtkNURBSGeometryFilter() override;

  int RequestData(vtkInformation* request, vtkInformationVector** inputVector,
    vtkInformationVector* outputVector) override;

private:
  vtkNURBSGeometryFilter(const vtkNURBSGeometryFilter&) = delete;
  void operator=(const vtkNURBSGeometryFilter&) = delete;

  bool AnyRankHasSplines(vtkDataObject* input);

  vtkNew<vtkNURBSTessellate> Tessellation;
  vtkNew<vtkPolyData> KnotLines;
};

#endif
