// SPDX-License-Identifier: BSD-3-Clause
#ifndef ModelExchange_h
#define ModelExchange_h

#include "Aggregate.h"
#include "Validity.h"

#include <vector>

/// Geometries and verdicts as lists of numbers, for reductions over ranks
/// (vtkNURBSAlgorithm::AllGather). Lists that are put one after the other unpack to all that they
/// hold. Private to this module.
namespace ModelExchange
{

/// The geometries of all patches, with what tells their place in the whole patch; no attributes.
std::vector<double> Pack(const hyperpatch::MultiPatch& model);
hyperpatch::MultiPatch UnpackModel(const std::vector<double>& numbers);

/// What TestInjectivity() asks of verdicts, in the knots of the patches.
std::vector<double> Pack(const std::vector<hyperpatch::PatchValidity>& validity);
std::vector<hyperpatch::PatchValidity> UnpackValidity(const std::vector<double>& numbers);

}

#endif
