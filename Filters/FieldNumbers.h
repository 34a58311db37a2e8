// SPDX-License-Identifier: BSD-3-Clause
#ifndef FieldNumbers_h
#define FieldNumbers_h

#include <cstdint>

class vtkDataArray;
class vtkFieldData;

/// Arrays of one number, for what filters tell in field data. Private to this module.
namespace FieldNumbers
{

void AddCount(vtkFieldData* fieldData, const char* name, std::int64_t value);

void AddNumber(vtkFieldData* fieldData, const char* name, double value);

/// The array of that name, made with the value if it is not there.
vtkDataArray* Named(vtkFieldData* fieldData, const char* name, double value);

}

#endif
