// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_GlobalInjectivity_h
#define hyperpatch_GlobalInjectivity_h

#include "Aggregate.h"
#include "Parallel.h"
#include "Validity.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace hyperpatch
{

struct InjectivityOptions
{
  /// How many boxes and pairs of boxes may be looked at for one element or pair of elements.
  int MaxTests = 20000;
  /// Control points this close are one and the same, as a fraction of the diagonal of all control
  /// points: how interfaces, closed patches and collapsed sides are found. Patches that overlap by
  /// less are not taken to overlap.
  double ContactTolerance = 1e-6;
  /// The part of the work that is done here, when several processes share it.
  std::size_t Share = 0;
  std::size_t Shares = 1;
};

/// Two different points of a model with the same image.
struct DoublePoint
{
  /// Patch::Id of both.
  std::array<int, 2> Patches;
  /// In the knots of these patches.
  std::array<std::array<double, 3>, 2> Parameters;
  std::array<double, 3> Image;
};

/// What was found about an element (A equal to B) or a pair of elements.
struct InjectivityItem
{
  int A;
  int B;
  /// 1: certified; -1: a double point was found; 0: undecided.
  int Verdict;
};

struct Injectivity
{
  /// 1: certified, rounding included: no two points have the same image, but for those that have
  /// the same control points (interfaces, seams of closed patches, collapsed sides), and left out
  /// what lies within 1 / 1024 of an element of a face, edge or corner where det J is 0. -1: not
  /// injective, because det J has both signs in a patch, or there is a double point. 0: undecided.
  int Verdict = 1;
  /// Certain as well. Absent only where det J has both signs and Newton's iteration found no pair.
  std::optional<DoublePoint> Witness;
  std::size_t Elements = 0;
  /// Pairs of elements whose bounds overlap.
  std::size_t Pairs = 0;
  std::size_t UndecidedElements = 0;
  std::size_t UndecidedPairs = 0;
  /// Elements with a collapsed edge or face; what coincides there was left out.
  std::size_t CollapsedElements = 0;
  /// Elements and pairs of this share that were tested, not known before, and the boxes it took.
  std::size_t Tested = 0;
  std::int64_t Boxes = 0;
  /// Of this share, ascending: elements are numbered through all patches.
  std::vector<InjectivityItem> Items;
};

/// What TestInjectivity() has told of a model before its control points were edited.
struct KnownInjectivity
{
  const Injectivity* Result;
  /// Elements (numbered through all patches) that are not what they were then.
  std::vector<bool> Changed;
};

/// Tests whether the map from the patches of a model to space is one to one: every element by
/// itself, every pair of elements whose bounds overlap, by the tests of IntersectionTest, on the
/// cores that parallelFor gives.
///
/// Memory: the Bezier points of all elements. Cost: a few microseconds for an element that is not
/// strongly bent and each of its 26 neighbours; at worst MaxTests boxes per element and pair.
///
/// \param model whole patches, or all their parts
/// \param validity of each patch of the model, obtained from TestValidity()
/// \throws Error if a geometry is not a volume of three coordinates, the numbers of elements do not
/// fit, or an option is out of range
[[nodiscard]] Injectivity TestInjectivity(const MultiPatch& model,
  const std::vector<PatchValidity>& validity, const InjectivityOptions& options = {},
  const ParallelFor& parallelFor = SerialFor, const KnownInjectivity* known = nullptr);

}

#endif
