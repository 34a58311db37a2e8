// SPDX-License-Identifier: BSD-3-Clause
#include "FieldNumbers.h"

#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkIdTypeArray.h"
#include "vtkNew.h"

void FieldNumbers::AddCount(vtkFieldData* fieldData, const char* name, std::int64_t value)
{
  vtkNew<vtkIdTypeArray> array;
  array->SetName(name);
  array->InsertNextValue(static_cast<vtkIdType>(value));
  fieldData->AddArray(array);
}

void FieldNumbers::AddNumber(vtkFieldData* fieldData, const char* name, double value)
{
  vtkNew<vtkDoubleArray> array;
  array->SetName(name);
  array->InsertNextValue(value);
  fieldData->AddArray(array);
}

vtkDataArray* FieldNumbers::Named(vtkFieldData* fieldData, const char* name, double value)
{
  if (!fieldData->GetArray(name))
  {
    AddNumber(fieldData, name, value);
  }
  return fieldData->GetArray(name);
}
