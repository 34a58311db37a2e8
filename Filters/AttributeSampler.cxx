// SPDX-License-Identifier: BSD-3-Clause
#include "AttributeSampler.h"

#include "Error.h"
#include "SampleGrid.h"

#include "vtkCallbackCommand.h"
#include "vtkCommand.h"
#include "vtkCompositeDataIterator.h"
#include "vtkCompositeDataProbeFilter.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataArray.h"
#include "vtkDataSet.h"
#include "vtkExprTkFunctionParser.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

namespace
{

using hyperpatch::Error;

class ExpressionSampler : public AttributeSampler
{
public:
  explicit ExpressionSampler(const std::string& expression)
  {
    // The parser reports errors as events of its own; here they become one message.
    vtkNew<vtkCallbackCommand> errors;
    errors->SetClientData(&this->Message);
    errors->SetCallback(
      [](vtkObject*, unsigned long, void* message, void* text)
      {
        auto* all = static_cast<std::string*>(message);
        if (all->empty())
        {
          *all = static_cast<const char*>(text);
        }
      });
    this->Parser->AddObserver(vtkCommand::ErrorEvent, errors);
    // Poles are a matter of the point, not of the expression.
    this->Parser->SetReplaceInvalidValues(1);
    this->Parser->SetReplacementValue(std::nan(""));
    this->SetVariables(Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero());
    this->Parser->SetFunction(expression.c_str());
    this->IsVector = this->Parser->IsVectorResult() != 0;
    if (!this->IsVector && !this->Parser->IsScalarResult())
    {
      // "ERROR: In file, line n\nclass (address): text"
      const std::size_t colon = this->Message.find("): ");
      std::string text =
        colon == std::string::npos ? this->Message : this->Message.substr(colon + 3);
      text.erase(text.find_last_not_of(" \n") + 1);
      throw Error("the expression \"" + expression + "\" does not parse" +
        (text.empty() ? "" : " (" + text + ")") +
        ": variables are x, y, z, the vector coords, and u, v, w");
    }
  }

  Eigen::MatrixXd Sample(const Eigen::Matrix3Xd& positions, const Eigen::Matrix3Xd& parameters,
    const std::function<void()>& check) override
  {
    constexpr Eigen::Index Step = 1 << 12;
    Eigen::MatrixXd values(this->IsVector ? 3 : 1, positions.cols());
    for (Eigen::Index i = 0; i < values.cols(); ++i)
    {
      if (i % Step == 0)
      {
        check();
      }
      this->SetVariables(positions.col(i), parameters.col(i));
      if (this->IsVector)
      {
        this->Parser->GetVectorResult(values.col(i).data());
      }
      else
      {
        values(0, i) = this->Parser->GetScalarResult();
      }
    }
    return values;
  }

private:
  void SetVariables(const Eigen::Vector3d& position, const Eigen::Vector3d& parameter)
  {
    const char* coordinates[] = { "x", "y", "z" };
    const char* parameters[] = { "u", "v", "w" };
    for (int d = 0; d < 3; ++d)
    {
      this->Parser->SetScalarVariableValue(coordinates[d], position[d]);
      this->Parser->SetScalarVariableValue(parameters[d], parameter[d]);
    }
    this->Parser->SetVectorVariableValue("coords", position[0], position[1], position[2]);
  }

  vtkNew<vtkExprTkFunctionParser> Parser;
  std::string Message;
  bool IsVector = false;
};

class ProbeSampler : public AttributeSampler
{
public:
  ProbeSampler(vtkDataObject* data, const std::string& array)
  {
    vtkDataArray* found = FindPointArray(data, array);
    this->Name = found->GetName();
    this->Components = found->GetNumberOfComponents();
    this->Probe->SetSourceData(data);
    // Other arrays, and blocks without this one, are no concern.
    this->Probe->SetPassPartialArrays(true);
  }

  Eigen::MatrixXd Sample(const Eigen::Matrix3Xd& positions, const Eigen::Matrix3Xd&,
    const std::function<void()>& check) override
  {
    check();
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    points->SetNumberOfPoints(positions.cols());
    for (Eigen::Index i = 0; i < positions.cols(); ++i)
    {
      points->SetPoint(i, positions.col(i).data());
    }
    vtkNew<vtkPolyData> cloud;
    cloud->SetPoints(points);
    this->Probe->SetInputData(cloud);
    this->Probe->Update();
    vtkPointData* data = this->Probe->GetOutput()->GetPointData();
    vtkDataArray* array = data->GetArray(this->Name.c_str());
    vtkDataArray* mask = data->GetArray(this->Probe->GetValidPointMaskArrayName());
    Eigen::MatrixXd values =
      Eigen::MatrixXd::Constant(this->Components, positions.cols(), std::nan(""));
    if (array && mask)
    {
      const Eigen::MatrixXd probed = ReadTuples(array);
      for (Eigen::Index i = 0; i < values.cols(); ++i)
      {
        if (mask->GetComponent(i, 0) != 0.0)
        {
          values.col(i) = probed.col(i);
        }
      }
    }
    return values;
  }

private:
  vtkNew<vtkCompositeDataProbeFilter> Probe;
  std::string Name;
  int Components = 1;
};

std::vector<vtkDataSet*> DataSets(vtkDataObject* data)
{
  std::vector<vtkDataSet*> sets;
  if (auto composite = vtkCompositeDataSet::SafeDownCast(data))
  {
    vtkSmartPointer<vtkCompositeDataIterator> it;
    it.TakeReference(composite->NewIterator());
    for (it->InitTraversal(); !it->IsDoneWithTraversal(); it->GoToNextItem())
    {
      sets.push_back(vtkDataSet::SafeDownCast(it->GetCurrentDataObject()));
    }
  }
  else
  {
    sets.push_back(vtkDataSet::SafeDownCast(data));
  }
  sets.erase(std::remove(sets.begin(), sets.end(), nullptr), sets.end());
  return sets;
}

}

std::unique_ptr<AttributeSampler> AttributeSampler::FromExpression(const std::string& expression)
{
  return std::make_unique<ExpressionSampler>(expression);
}

std::unique_ptr<AttributeSampler> AttributeSampler::FromData(
  vtkDataObject* data, const std::string& array)
{
  return std::make_unique<ProbeSampler>(data, array);
}

vtkDataArray* FindPointArray(vtkDataObject* data, const std::string& name)
{
  std::map<std::string, vtkDataArray*> arrays;
  for (vtkDataSet* set : DataSets(data))
  {
    for (int a = 0; a < set->GetPointData()->GetNumberOfArrays(); ++a)
    {
      vtkDataArray* array = set->GetPointData()->GetArray(a);
      if (array && array->GetName() && std::string(array->GetName()).compare(0, 3, "vtk") != 0)
      {
        arrays.emplace(array->GetName(), array);
      }
    }
  }
  if (name.empty() && arrays.size() == 1)
  {
    return arrays.begin()->second;
  }
  const auto found = arrays.find(name);
  if (found != arrays.end())
  {
    return found->second;
  }
  std::string known;
  for (const auto& entry : arrays)
  {
    known += (known.empty() ? "; there are " : ", ") + entry.first;
  }
  throw Error((name.empty() ? std::string("choose a point array of the second input")
                            : "the second input has no numeric point array \"" + name + "\"") +
    (known.empty() ? "; there is none" : known));
}
