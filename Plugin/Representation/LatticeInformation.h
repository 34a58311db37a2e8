// SPDX-License-Identifier: BSD-3-Clause
#ifndef LatticeInformation_h
#define LatticeInformation_h

class vtkPVDataInformation;

/// The point array of weights in a control lattice, see NURBSConversion.h.
inline constexpr const char* WeightName = "Weight";

/// What hyperpatch::IsSplineData() asks of data, asked of its information: a client has no more.
/// Meshes of Bezier hexahedra are not told from other cells here. \param information or nullptr
[[nodiscard]] bool IsLattice(vtkPVDataInformation* information);

#endif
