// SPDX-License-Identifier: BSD-3-Clause
#ifndef hyperpatch_Append_h
#define hyperpatch_Append_h

#include "Aggregate.h"

#include <vector>

namespace hyperpatch
{

/// Several models as one. Patches keep their order and are numbered from 0; parts of a patch keep
/// one number. Interfaces and boundaries come along; boundaries of one name become one.
/// \throws Error if an attribute has other numbers of components in other patches: attributes are
/// matched by name
[[nodiscard]] MultiPatch Append(const std::vector<MultiPatch>& models);

/// The model with the interfaces that FindInterfaces() finds between sides that have none.
/// \throws Error as FindInterfaces
[[nodiscard]] MultiPatch WithFoundInterfaces(MultiPatch model, double relativeTolerance);

/// The model with its parts of patches as patches of their own, numbered anew, for operators that
/// are about whole patches. Interfaces and boundaries, which name whole patches, are dropped then;
/// a model without parts stays as it is.
[[nodiscard]] MultiPatch PartsAsPatches(MultiPatch model);

}

#endif
