// SPDX-License-Identifier: BSD-3-Clause
#include "vtkNURBSGeometryFilter.h"

#include "NURBSConversion.h"
#include "vtkNURBSTessellate.h"

#include "vtkCommand.h"
#include "vtkCommunicator.h"
#include "vtkDataObject.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMultiProcessController.h"
#include "vtkObjectFactory.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkSmartPointer.h"

#include <algorithm>

vtkStandardNewMacro(vtkNURBSGeometryFilter);

vtkNURBSGeometryFilter::vtkNURBSGeometryFilter()
{
  this->Tessellation->AddObserver(
    vtkCommand::ProgressEvent, this, &vtkNURBSGeometryFilter::HandleGeometryFilterProgress);
}

vtkNURBSGeometryFilter::~vtkNURBSGeometryFilter() = default;

void vtkNURBSGeometryFilter::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Tessellation:\n";
  this->Tessellation->PrintSelf(os, indent.GetNextIndent());
}

vtkMTimeType vtkNURBSGeometryFilter::GetMTime()
{
  return std::max(this->Superclass::GetMTime(), this->Tessellation->GetMTime());
}

bool vtkNURBSGeometryFilter::AnyRankHasSplines(vtkDataObject* input)
{
  const int here = hyperpatch::IsSplineData(input) ? 1 : 0;
  int anywhere = here;
  if (this->Controller && this->Controller->GetNumberOfProcesses() > 1)
  {
    this->Controller->AllReduce(&here, &anywhere, 1, vtkCommunicator::MAX_OP);
  }
  return anywhere != 0;
}

int vtkNURBSGeometryFilter::RequestData(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkDataObject* input = vtkDataObject::GetData(inputVector[0]);
  if (!this->AnyRankHasSplines(input))
  {
    return this->Superclass::RequestData(request, inputVector, outputVector);
  }

  this->Tessellation->SetController(this->Controller);
  this->Tessellation->SetInputDataObject(input);
  this->Tessellation->Update();

  vtkSmartPointer<vtkDataObject> surface = this->Tessellation->GetOutputDataObject(0);
  if (auto collection = vtkPartitionedDataSetCollection::SafeDownCast(input))
  {
    vtkNew<vtkPartitionedDataSetCollection> surfaces;
    surfaces->CopyStructure(collection);
    surfaces->SetPartition(0, 0, surface);
    surface = surfaces;
  }

  vtkNew<vtkInformation> info;
  info->Copy(inputVector[0]->GetInformationObject(0));
  info->Set(vtkDataObject::DATA_OBJECT(), surface);
  vtkNew<vtkInformationVector> tessellated;
  tessellated->Append(info);
  vtkInformationVector* tessellatedVector[] = { tessellated };
  return this->Superclass::RequestData(request, tessellatedVector, outputVector);
}
