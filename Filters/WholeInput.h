// SPDX-License-Identifier: BSD-3-Clause
#ifndef WholeInput_h
#define WholeInput_h

#include "vtkSmartPointer.h"

class vtkDataObject;
class vtkMultiProcessController;

/// The input of a filter that needs all of it on every process: what the process has, if its source
/// gives the whole to all; that of the only process that has anything, if it reads on one. All
/// processes must call it. Private to this module.
/// \throws hyperpatch::Error, on all processes, if the input is divided among them
[[nodiscard]] vtkSmartPointer<vtkDataObject> WholeInput(
  vtkDataObject* input, vtkMultiProcessController* controller);

#endif
