// SPDX-License-Identifier: BSD-3-Clause
#include "ReadArrays.h"

#include "ArrayNames.h"

#include "vtkDataArray.h"
#include "vtkDataSet.h"
#include "vtkDoubleArray.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"

#include <memory>
#include <utility>

namespace hyperpatch
{

SharedColumns ReadColumns(vtkDataArray* array)
{
  vtkSmartPointer<vtkDoubleArray> doubles = vtkDoubleArray::SafeDownCast(array);
  if (!doubles)
  {
    doubles = vtkSmartPointer<vtkDoubleArray>::New();
    doubles->DeepCopy(array);
  }
  const double* data = doubles->GetPointer(0);
  const auto owner = std::make_shared<const vtkSmartPointer<vtkDoubleArray>>(std::move(doubles));
  return { { owner, data }, array->GetNumberOfComponents(), array->GetNumberOfTuples() };
}

std::vector<vtkDataArray*> AttributeArrays(vtkDataSet* grid)
{
  std::vector<vtkDataArray*> arrays;
  for (int a = 0; a < grid->GetPointData()->GetNumberOfArrays(); ++a)
  {
    vtkDataArray* array = grid->GetPointData()->GetArray(a);
    const char* name = array ? array->GetName() : nullptr;
    if (name && names::IsAttribute(name))
    {
      arrays.push_back(array);
    }
  }
  return arrays;
}

std::string DimensionsText(const std::array<int, 3>& n)
{
  return std::to_string(n[0]) + " x " + std::to_string(n[1]) + " x " + std::to_string(n[2]);
}

}
