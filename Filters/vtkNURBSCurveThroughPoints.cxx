// SPDX-License-Identifier: BSD-3-Clause
#include "vtkNURBSCurveThroughPoints.h"

#include "Aggregate.h"
#include "Error.h"
#include "Interpolation.h"

#include "vtkCellArray.h"
#include "vtkCellArrayIterator.h"
#include "vtkDataArray.h"
#include "vtkInformation.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace
{

/// Tuples of an array at some points, as columns. All are finite.
Eigen::MatrixXd Columns(
  vtkDataArray* array, const std::string& what, vtkIdType count, const vtkIdType* points)
{
  Eigen::MatrixXd columns(array->GetNumberOfComponents(), count);
  for (vtkIdType i = 0; i < count; ++i)
  {
    array->GetTuple(points[i], columns.col(i).data());
    if (!columns.col(i).allFinite())
    {
      throw hyperpatch::Error(what + " has a number at point " + std::to_string(points[i]) +
        " that is not finite: take the point away");
    }
  }
  return columns;
}

}

VTK_ABI_NAMESPACE_BEGIN
vtkStandardNewMacro(vtkNURBSCurveThroughPoints);

void vtkNURBSCurveThroughPoints::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  const char* spacings[] = { "Chord Length", "Centripetal", "Uniform" };
  os << indent << "Degree: " << this->Degree << "\n";
  os << indent << "Spacing: " << spacings[this->Spacing] << "\n";
}

int vtkNURBSCurveThroughPoints::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkPolyData");
  return 1;
}

hyperpatch::MultiPatch vtkNURBSCurveThroughPoints::ConvertInput(int, vtkDataObject* input)
{
  hyperpatch::MultiPatch model;
  auto data = vtkPolyData::SafeDownCast(input);
  if (!data || data->GetNumberOfPoints() == 0)
  {
    return model;
  }
  if (data->GetNumberOfLines() == 0)
  {
    throw hyperpatch::Error("the input has no lines to interpolate");
  }
  if (this->Degree < 1)
  {
    throw hyperpatch::Error("a curve has degree 1 at least, not " + std::to_string(this->Degree));
  }
  const double exponents[] = { 1.0, 0.5, 0.0 };
  const auto lines = vtk::TakeSmartPointer(data->GetLines()->NewIterator());
  for (lines->GoToFirstCell(); !lines->IsDoneWithTraversal(); lines->GoToNextCell())
  {
    vtkIdType count = 0;
    const vtkIdType* points = nullptr;
    lines->GetCurrentCell(count, points);
    const auto id = static_cast<int>(model.Patches.size());
    const std::string line = "line " + std::to_string(id);
    try
    {
      const Eigen::MatrixXd sites =
        Columns(data->GetPoints()->GetData(), "the line", count, points);
      const std::vector<double> parameters =
        hyperpatch::ChordParameters(sites, exponents[this->Spacing]);
      const int degree = std::min(this->Degree, static_cast<int>(count) - 1);
      std::vector<hyperpatch::Attribute> attributes;
      for (int a = 0; a < data->GetPointData()->GetNumberOfArrays(); ++a)
      {
        vtkDataArray* array = data->GetPointData()->GetArray(a);
        const std::string name = array && array->GetName() ? array->GetName() : "";
        if (!name.empty() && name.compare(0, 3, "vtk") != 0)
        {
          attributes.push_back({ name,
            hyperpatch::InterpolateCurve(
              degree, parameters, Columns(array, "array \"" + name + "\"", count, points)) });
        }
      }
      model.Patches.push_back({ id,
        hyperpatch::Aggregate(
          hyperpatch::InterpolateCurve(degree, parameters, sites), std::move(attributes)) });
    }
    catch (const hyperpatch::Error& error)
    {
      throw hyperpatch::Error(line + ": " + error.what());
    }
  }
  return model;
}

hyperpatch::MultiPatch vtkNURBSCurveThroughPoints::MakeModel(const Inputs& inputs)
{
  return inputs[0][0];
}

VTK_ABI_NAMESPACE_END
