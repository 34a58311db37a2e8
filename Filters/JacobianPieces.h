// SPDX-License-Identifier: BSD-3-Clause
#ifndef JacobianPieces_h
#define JacobianPieces_h

#include <functional>
#include <vector>

class vtkPolyData;

namespace hyperpatch
{
struct MultiPatch;
}

/// What vtkNURBSJacobianBoundary does with its finished mesh. Private to this module.
namespace JacobianPieces
{

/// Called often in long loops; may throw to end the work.
using Check = std::function<void()>;

/// Removes triangles of sheets that lie in a domain face: where det J is 0 all over a face, because
/// it is collapsed or the fold is just there, the sheet is the face once more.
void RemoveSheetsInFaces(
  const hyperpatch::MultiPatch& model, vtkPolyData* output, const Check& check);

/// Adds the point array `JacobianDeterminant`: det J with respect to the patch's own parameters. On
/// knot planes across which it jumps over 0 it is 0.
void AddDeterminant(const hyperpatch::MultiPatch& model, vtkPolyData* output, const Check& check);

/// Adds the cell array `PieceId`: cells of one patch and one `Piece` that are connected have the
/// same number. Pieces are numbered from 0 in the order of patch, `Piece`, and the least parameters
/// of their points, on one and on many ranks alike. All ranks must call it.
/// \param allGather the records of all ranks, in order
void AddIds(const hyperpatch::MultiPatch& model, vtkPolyData* output,
  const std::function<std::vector<double>(const std::vector<double>&)>& allGather,
  const Check& check);

}

#endif
