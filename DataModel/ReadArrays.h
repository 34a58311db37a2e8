// SPDX-License-Identifier: BSD-3-Clause
#ifndef ReadArrays_h
#define ReadArrays_h

#include "Spline.h"

#include <array>
#include <string>
#include <vector>

class vtkDataArray;
class vtkDataSet;

/// Arrays of data sets as numbers of splines. Private to this module.
namespace hyperpatch
{

/// The numbers of an array where they are; of other types than double, a copy.
[[nodiscard]] SharedColumns ReadColumns(vtkDataArray* array);

/// The point arrays that are fields of the user's.
[[nodiscard]] std::vector<vtkDataArray*> AttributeArrays(vtkDataSet* grid);

/// For messages.
[[nodiscard]] std::string DimensionsText(const std::array<int, 3>& n);

}

#endif
