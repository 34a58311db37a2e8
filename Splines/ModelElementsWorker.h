// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_ModelElementsWorker_h
#define hyperpatch_ModelElementsWorker_h

#include "Aggregate.h"
#include "BezierPieceWorker.h"
#include "ContactWorker.h"
#include "Parallel.h"

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

namespace hyperpatch
{

/// Internal to the intersection tests: an element of a model in Bezier form. Rows of control points
/// that are one point up to the contact distance are made exactly that.
struct ModelElement
{
  /// Index of the patch in the model, and its Id.
  std::size_t Patch;
  int PatchId;
  /// Knot span of the whole patch.
  std::array<int, 3> Span;
  /// The box in the knots of the patch.
  std::array<double, 3> Low;
  std::array<double, 3> High;
  BezierPiece Piece;
  /// CollapsedEdges() of the element.
  unsigned Collapsed;

  [[nodiscard]] std::array<double, 3> ToPatch(const std::array<double, 3>& parameters) const;
  [[nodiscard]] std::array<double, 3> FromPatch(const std::array<double, 3>& parameters) const;
};

/// The elements of all patches, one patch after the other, u fastest.
/// \throws Error if a geometry is not a volume of three coordinates
[[nodiscard]] std::vector<ModelElement> MakeElements(
  const MultiPatch& model, double distance, const ParallelFor& parallelFor);

/// How many elements b lies after a in each direction, if both are of one patch. Parts of a patch
/// are told by the knots at which they meet, because cells of a mesh may have one Id as well.
[[nodiscard]] std::optional<std::array<int, 3>> LatticeOffset(
  const ModelElement& a, const ModelElement& b);

/// All contacts of two elements: that of neighbours in a patch, and those that control points tell.
[[nodiscard]] std::vector<Contact> ContactsOf(
  const ModelElement& a, const ModelElement& b, double distance);

}

#endif
