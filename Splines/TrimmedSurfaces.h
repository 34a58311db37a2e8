// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_TrimmedSurfaces_h
#define hyperpatch_TrimmedSurfaces_h

#include "Parallel.h"
#include "Prepared.h"
#include "ScalarField.h"
#include "ZeroSet.h"

#include <functional>
#include <memory>
#include <vector>

namespace hyperpatch
{

/// Trims the zero set of each field to where no other field is positive: what is left is the
/// boundary of the body in which no field is, such as the six sides of a box in a patch.
///
/// Along the lines in which two zero sets meet, both have the same points, with the same bits in
/// their coordinates and parameters; they lie on both zero sets to round-off. The lines are taken
/// for straight, as those of planes are.
///
/// \param surfaces the zero sets of the fields, in their order; trimmed in place
/// \returns false if aborted
[[nodiscard]] bool TrimToEachOther(const std::shared_ptr<const PreparedAggregate>& body,
  const std::vector<std::shared_ptr<const ScalarField>>& fields, std::vector<ZeroSetMesh>& surfaces,
  const ParallelFor& parallel, const std::function<bool()>& abort);

}

#endif
