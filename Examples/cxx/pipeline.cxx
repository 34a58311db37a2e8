// SPDX-License-Identifier: BSD-3-Clause
// Opens a spline file; slices it, draws two isosurfaces of Temperature and its boundary; writes the
// surfaces (.vtp) and a picture of them in the colours of Temperature into a folder.
//
// usage: pipeline Data/heated_pipe_bend.vtpc FOLDER

#include "vtkBSplineReader.h"
#include "vtkNURBSContour.h"
#include "vtkNURBSJacobianBoundary.h"
#include "vtkNURBSSlice.h"

#include "vtkActor.h"
#include "vtkCamera.h"
#include "vtkColorTransferFunction.h"
#include "vtkDataArray.h"
#include "vtkNew.h"
#include "vtkPNGWriter.h"
#include "vtkPlane.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkPolyDataMapper.h"
#include "vtkProperty.h"
#include "vtkRenderWindow.h"
#include "vtkRenderer.h"
#include "vtkWindowToImageFilter.h"
#include "vtkXMLPolyDataWriter.h"

#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <string>

int main(int argc, char* argv[])
{
  if (argc != 3)
  {
    std::cerr << "usage: " << argv[0] << " FILE FOLDER\n";
    return EXIT_FAILURE;
  }
  const std::string folder = argv[2];
  std::filesystem::create_directories(folder);

  vtkNew<vtkBSplineReader> reader;
  reader->SetFileName(argv[1]);

  vtkNew<vtkPlane> plane;
  plane->SetOrigin(1.5, 1.5, 0.0);
  plane->SetNormal(0.0, 1.0, 0.0);
  vtkNew<vtkNURBSSlice> slice;
  slice->SetInputConnection(reader->GetOutputPort());
  slice->SetSliceFunction(plane);

  vtkNew<vtkNURBSContour> contour;
  contour->SetInputConnection(reader->GetOutputPort());
  contour->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "Temperature");
  contour->SetNumberOfContours(2);
  contour->SetValue(0, 100.0);
  contour->SetValue(1, 180.0);

  vtkNew<vtkNURBSJacobianBoundary> boundary;
  boundary->SetInputConnection(reader->GetOutputPort());

  vtkNew<vtkRenderer> renderer;
  renderer->SetBackground(1.0, 1.0, 1.0);
  double range[2];
  boundary->Update();
  vtkPolyData::SafeDownCast(boundary->GetOutputDataObject(0))
    ->GetPointData()
    ->GetArray("Temperature")
    ->GetRange(range);
  vtkNew<vtkColorTransferFunction> colors;
  colors->SetColorSpaceToDiverging();
  colors->AddRGBPoint(range[0], 0.23, 0.30, 0.75);
  colors->AddRGBPoint(range[1], 0.71, 0.02, 0.15);
  const auto writeAndShow = [&](vtkAlgorithm* filter, const std::string& name, double opacity)
  {
    vtkNew<vtkXMLPolyDataWriter> writer;
    writer->SetInputConnection(filter->GetOutputPort());
    writer->SetFileName((folder + "/" + name + ".vtp").c_str());
    writer->SetDataModeToBinary(); // readers on some systems stumble over raw appended data
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputConnection(filter->GetOutputPort());
    mapper->SetScalarModeToUsePointFieldData();
    mapper->SelectColorArray("Temperature");
    mapper->SetLookupTable(colors);
    vtkNew<vtkActor> actor;
    actor->SetMapper(mapper);
    actor->GetProperty()->SetOpacity(opacity);
    renderer->AddActor(actor);
    return writer->Write() != 0;
  };
  const bool written = writeAndShow(slice, "slice", 1.0) && writeAndShow(contour, "contour", 1.0) &&
    writeAndShow(boundary, "boundary", 0.2);

  vtkNew<vtkRenderWindow> window;
  window->OffScreenRenderingOn();
  window->SetSize(800, 600);
  window->AddRenderer(renderer);
  renderer->GetActiveCamera()->SetPosition(-2.0, -1.2, 1.6);
  renderer->GetActiveCamera()->SetViewUp(0.0, 0.0, 1.0);
  renderer->ResetCamera();
  window->Render();
  vtkNew<vtkWindowToImageFilter> image;
  image->SetInput(window);
  vtkNew<vtkPNGWriter> picture;
  picture->SetInputConnection(image->GetOutputPort());
  picture->SetFileName((folder + "/picture.png").c_str());
  picture->Write();
  return written && picture->GetErrorCode() == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
