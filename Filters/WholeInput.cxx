// SPDX-License-Identifier: BSD-3-Clause
#include "WholeInput.h"

#include "Error.h"

#include "vtkCharArray.h"
#include "vtkCommunicator.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataSet.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"

#include <array>
#include <cstring>
#include <vector>

namespace
{

/// Number of points and bounds: what tells parts of a whole apart.
using Record = std::array<double, 7>;

Record Describe(vtkDataObject* input)
{
  Record record{};
  if (input)
  {
    record[0] = static_cast<double>(input->GetNumberOfElements(vtkDataObject::POINT));
  }
  if (record[0] > 0.0)
  {
    if (auto set = vtkDataSet::SafeDownCast(input))
    {
      set->GetBounds(record.data() + 1);
    }
    else if (auto composite = vtkCompositeDataSet::SafeDownCast(input))
    {
      composite->GetBounds(record.data() + 1);
    }
  }
  return record;
}

/// The input of process `source`, on all.
vtkSmartPointer<vtkDataObject> Broadcast(
  vtkDataObject* input, vtkMultiProcessController* controller, int source)
{
  vtkNew<vtkCharArray> bytes;
  const bool isSource = controller->GetLocalProcessId() == source;
  if (isSource)
  {
    vtkCommunicator::MarshalDataObject(input, bytes);
  }
  vtkIdType length = bytes->GetNumberOfValues();
  controller->Broadcast(&length, 1, source);
  bytes->SetNumberOfValues(length);
  controller->Broadcast(bytes->GetPointer(0), length, source);
  return isSource ? vtkSmartPointer<vtkDataObject>(input)
                  : vtkCommunicator::UnMarshalDataObject(bytes);
}

}

vtkSmartPointer<vtkDataObject> WholeInput(
  vtkDataObject* input, vtkMultiProcessController* controller)
{
  const int processes = controller ? controller->GetNumberOfProcesses() : 1;
  if (processes < 2)
  {
    return input;
  }
  const Record own = Describe(input);
  std::vector<Record> all(static_cast<std::size_t>(processes));
  controller->AllGather(own.data(), all[0].data(), static_cast<vtkIdType>(own.size()));
  int owners = 0;
  int owner = 0;
  bool same = true;
  for (int rank = 0; rank < processes; ++rank)
  {
    const Record& record = all[static_cast<std::size_t>(rank)];
    // Bits: coordinates that are no numbers are equal, too.
    same = same && std::memcmp(record.data(), all[0].data(), sizeof(Record)) == 0;
    if (record[0] > 0.0)
    {
      ++owners;
      owner = rank;
    }
  }
  if (same || owners == 0)
  {
    return input;
  }
  if (owners > 1)
  {
    throw hyperpatch::Error("the input is divided among the processes, and a fit needs all of it: "
                            "read it from one of VTK's own formats, or with one process");
  }
  return Broadcast(input, controller, owner);
}
