// SPDX-License-Identifier: BSD-3-Clause
#include "vtkNURBSGeometryFilter.h"

#include "NURBSConversion.h"
#include "vtkNURBSTessellate.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkCommand.h"
#include "vtkCommunicator.h"
#include "vtkCompositeDataIterator.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataObject.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMultiProcessController.h"
#include "vtkObjectFactory.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"

#include <algorithm>

namespace
{

/// Moves the lines of a mesh of lines and triangles into a mesh of their own.
vtkSmartPointer<vtkPolyData> SplitLines(vtkPolyData* mesh, vtkPolyData* lines)
{
  if (mesh->GetNumberOfPolys() == 0)
  {
    return mesh; // a curve is all lines
  }
  lines->SetPoints(mesh->GetPoints());
  lines->SetLines(mesh->GetLines());
  auto surface = vtkSmartPointer<vtkPolyData>::New();
  surface->SetPoints(mesh->GetPoints());
  surface->SetPolys(mesh->GetPolys());
  surface->GetPointData()->ShallowCopy(mesh->GetPointData());
  const vtkIdType first = mesh->GetNumberOfLines();
  const vtkIdType count = mesh->GetNumberOfPolys();
  vtkCellData* cells = surface->GetCellData();
  cells->CopyAllocate(mesh->GetCellData(), count);
  cells->SetNumberOfTuples(count);
  cells->CopyData(mesh->GetCellData(), 0, count, first); // lines come first
  return surface;
}

/// Takes away the ids by which a selection finds cells and points of the input: here they would be
/// the numbers of triangles, which the lattice does not know.
void RemoveOriginalIds(vtkDataObject* output)
{
  const auto remove = [](vtkDataObject* block)
  {
    if (auto data = vtkDataSet::SafeDownCast(block))
    {
      data->GetCellData()->RemoveArray("vtkOriginalCellIds");
      data->GetPointData()->RemoveArray("vtkOriginalPointIds");
    }
  };
  remove(output);
  if (auto composite = vtkCompositeDataSet::SafeDownCast(output))
  {
    vtkSmartPointer<vtkCompositeDataIterator> it;
    it.TakeReference(composite->NewIterator());
    for (it->InitTraversal(); !it->IsDoneWithTraversal(); it->GoToNextItem())
    {
      remove(it->GetCurrentDataObject());
    }
  }
}

}

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
  this->KnotLines->Initialize();
  vtkDataObject* input = vtkDataObject::GetData(inputVector[0]);
  if (!this->AnyRankHasSplines(input))
  {
    return this->Superclass::RequestData(request, inputVector, outputVector);
  }

  this->Tessellation->SetController(this->Controller);
  this->Tessellation->SetInputDataObject(input);
  this->Tessellation->Update();

  vtkSmartPointer<vtkDataObject> surface = SplitLines(
    vtkPolyData::SafeDownCast(this->Tessellation->GetOutputDataObject(0)), this->KnotLines);
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
  const int good = this->Superclass::RequestData(request, tessellatedVector, outputVector);
  RemoveOriginalIds(vtkDataObject::GetData(outputVector));
  return good;
}
