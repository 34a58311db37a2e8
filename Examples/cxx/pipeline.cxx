// SPDX-License-Identifier: BSD-3-Clause
// Opens a spline file, slices it in the middle and writes the slice as a .vtp file.
//
// usage: pipeline FILE SLICE.vtp

#include "vtkBSplineReader.h"
#include "vtkNURBSSlice.h"
#include "vtkNURBSTessellate.h"

#include "vtkNew.h"
#include "vtkPlane.h"
#include "vtkPolyData.h"
#include "vtkXMLPolyDataWriter.h"

#include <cstdlib>
#include <iostream>

int main(int argc, char* argv[])
{
  if (argc != 3)
  {
    std::cerr << "usage: " << argv[0] << " FILE SLICE.vtp\n";
    return EXIT_FAILURE;
  }
  vtkNew<vtkBSplineReader> reader;
  reader->SetFileName(argv[1]);

  vtkNew<vtkNURBSTessellate> boundary;
  boundary->SetInputConnection(reader->GetOutputPort());
  boundary->Update();
  double centre[3];
  vtkPolyData::SafeDownCast(boundary->GetOutputDataObject(0))->GetCenter(centre);

  vtkNew<vtkPlane> plane;
  plane->SetOrigin(centre);
  plane->SetNormal(0.0, 0.0, 1.0);
  vtkNew<vtkNURBSSlice> slice;
  slice->SetInputConnection(reader->GetOutputPort());
  slice->SetSliceFunction(plane);
  slice->SetTolerance(1e-4); // of the model's diagonal

  vtkNew<vtkXMLPolyDataWriter> writer;
  writer->SetInputConnection(slice->GetOutputPort());
  writer->SetFileName(argv[2]);
  const bool written = writer->Write() != 0;
  const vtkIdType triangles =
    vtkPolyData::SafeDownCast(slice->GetOutputDataObject(0))->GetNumberOfCells();
  std::cout << triangles << " triangles\n";
  return written && triangles > 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
