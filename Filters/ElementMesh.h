// SPDX-License-Identifier: BSD-3-Clause
#ifndef ElementMesh_h
#define ElementMesh_h

#include "Aggregate.h"

#include <cstdint>
#include <vector>

class vtkUnstructuredGrid;

/// Hexahedra that are the elements (knot spans) of volumes, for data that belong to elements:
/// linear where the spline is trilinear, otherwise with 27 points that lie on the exact volume.
/// Points of neighbours in a patch are shared. The arrays ParametricCoordinates (points), PatchId
/// and ElementId (cells) are those of vtkNURBSMeshAlgorithm. Private to this module.
class ElementMesh
{
public:
  /// \param handedness -1 turns the cells, so that all have positive volume
  void Add(const hyperpatch::Patch& patch, int handedness);

  /// \param output an empty grid
  void Fill(vtkUnstructuredGrid* output) const;

private:
  std::vector<double> Points;
  std::vector<double> Parameters;
  std::vector<std::int64_t> Connectivity;
  /// VTK cell types.
  std::vector<int> Types;
  std::vector<std::int64_t> ElementIds;
  std::vector<int> PatchIds;
};

#endif
