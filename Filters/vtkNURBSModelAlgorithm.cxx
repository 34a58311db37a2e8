// SPDX-License-Identifier: BSD-3-Clause
#include "vtkNURBSModelAlgorithm.h"

#include "Append.h"
#include "NURBSConversion.h"

#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkType.h"

#include <algorithm>
#include <string>
#include <utility>

VTK_ABI_NAMESPACE_BEGIN

vtkNURBSModelAlgorithm::vtkNURBSModelAlgorithm() = default;

vtkNURBSModelAlgorithm::~vtkNURBSModelAlgorithm() = default;

void vtkNURBSModelAlgorithm::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
}

hyperpatch::MultiPatch vtkNURBSModelAlgorithm::ConvertInput(int, vtkDataObject* input)
{
  return hyperpatch::FromVTK(input);
}

double vtkNURBSModelAlgorithm::FoundInterfaceTolerance() const
{
  return 1e-9;
}

int vtkNURBSModelAlgorithm::OutputType() const
{
  return VTK_PARTITIONED_DATA_SET_COLLECTION;
}

int vtkNURBSModelAlgorithm::RequestInformation(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector)
{
  for (int port = 0; port < this->GetNumberOfOutputPorts(); ++port)
  {
    outputVector->GetInformationObject(port)->Set(vtkAlgorithm::CAN_HANDLE_PIECE_REQUEST(), 1);
  }
  return 1;
}

int vtkNURBSModelAlgorithm::RequestUpdateExtent(
  vtkInformation*, vtkInformationVector** inputVector, vtkInformationVector*)
{
  using Pipeline = vtkStreamingDemandDrivenPipeline;
  for (int port = 0; port < this->GetNumberOfInputPorts(); ++port)
  {
    for (int i = 0; i < inputVector[port]->GetNumberOfInformationObjects(); ++i)
    {
      vtkInformation* info = inputVector[port]->GetInformationObject(i);
      info->Set(Pipeline::UPDATE_PIECE_NUMBER(), 0);
      info->Set(Pipeline::UPDATE_NUMBER_OF_PIECES(), 1);
      info->Set(Pipeline::UPDATE_NUMBER_OF_GHOST_LEVELS(), 0);
      if (info->Has(Pipeline::WHOLE_EXTENT()))
      {
        info->Set(Pipeline::UPDATE_EXTENT(), info->Get(Pipeline::WHOLE_EXTENT()), 6);
      }
    }
  }
  return 1;
}

bool vtkNURBSModelAlgorithm::HasWork(vtkDataObject*)
{
  this->Models.assign(static_cast<std::size_t>(this->GetNumberOfInputPorts()), {});
  for (int port = 0; port < this->GetNumberOfInputPorts(); ++port)
  {
    for (int i = 0; i < this->GetNumberOfInputConnections(port); ++i)
    {
      this->Models[static_cast<std::size_t>(port)].push_back(
        hyperpatch::PartsAsPatches(this->ConvertInput(port, this->GetInputDataObject(port, i))));
    }
  }
  return this->Models.empty() ||
    std::any_of(this->Models[0].begin(), this->Models[0].end(),
      [](const hyperpatch::MultiPatch& model) { return !model.Patches.empty(); });
}

void vtkNURBSModelAlgorithm::ExecuteInput(vtkDataObject*, vtkDataObject* output)
{
  using Pipeline = vtkStreamingDemandDrivenPipeline;
  const Inputs models = std::exchange(this->Models, {});
  hyperpatch::MultiPatch model =
    hyperpatch::WithFoundInterfaces(this->MakeModel(models), this->FoundInterfaceTolerance());
  this->ReportProgress(0.0);
  const std::vector<std::string> attributes = hyperpatch::OwnBasisAttributes(model);
  vtkInformation* info = this->GetOutputInformation(0);
  const int pieces = info->Get(Pipeline::UPDATE_NUMBER_OF_PIECES());
  if (pieces > 1)
  {
    model = hyperpatch::ExtractPiece(model, info->Get(Pipeline::UPDATE_PIECE_NUMBER()), pieces);
  }
  hyperpatch::ToVTK(
    std::move(model), vtkPartitionedDataSetCollection::SafeDownCast(output), attributes);
}

bool vtkNURBSModelAlgorithm::IsFirstPiece()
{
  return this->GetOutputInformation(0)->Get(
           vtkStreamingDemandDrivenPipeline::UPDATE_PIECE_NUMBER()) == 0;
}

VTK_ABI_NAMESPACE_END
