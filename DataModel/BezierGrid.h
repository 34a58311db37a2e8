// SPDX-License-Identifier: BSD-3-Clause
#ifndef BezierGrid_h
#define BezierGrid_h

#include "Aggregate.h"

#include <vector>

class vtkDataObject;
class vtkUnstructuredGrid;

/// Bezier hexahedra as patches, see FromVTK(). Private to this module.
namespace hyperpatch
{

[[nodiscard]] bool IsBezierGrid(vtkDataObject* data);

/// Appends a patch for each cell. \throws Error if a cell has not the points of its degrees
void ReadBezierGrid(vtkUnstructuredGrid* grid, std::vector<Patch>& patches);

}

#endif
