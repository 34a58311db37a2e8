// SPDX-License-Identifier: BSD-3-Clause
// Models a lens whose index of refraction varies with the radius (Martin and Cohen, 2001, Figure
// 1): a line with an attribute curve is revolved to a disk, and the disk extruded to a volume.
// Writes the disk, the volume and two isosurfaces of the index (.vtp), and a picture of them, into
// a folder.
//
// usage: lens FOLDER

#include "vtkNURBSContour.h"
#include "vtkNURBSCurve.h"
#include "vtkNURBSExtrude.h"
#include "vtkNURBSRevolve.h"
#include "vtkNURBSTessellate.h"

#include "vtkActor.h"
#include "vtkCamera.h"
#include "vtkColorTransferFunction.h"
#include "vtkDataArray.h"
#include "vtkNew.h"
#include "vtkPNGWriter.h"
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
  if (argc != 2)
  {
    std::cerr << "usage: " << argv[0] << " FOLDER\n";
    return EXIT_FAILURE;
  }
  const std::string folder = argv[1];
  std::filesystem::create_directories(folder);

  vtkNew<vtkNURBSCurve> line;
  line->SetNumberOfPoints(2);
  line->SetPoint(0, 0.0, 0.0, 0.0);
  line->SetPoint(1, 1.0, 0.0, 0.0);
  line->SetAttributeName("Index");
  const double values[] = { 1.62, 1.62, 1.4, 1.58, 1.46 };
  line->SetNumberOfAttributeValues(5);
  for (int i = 0; i < 5; ++i)
  {
    line->SetAttributeValue(i, values[i]);
  }
  line->SetAttributeDegree(3);

  vtkNew<vtkNURBSRevolve> disk;
  disk->SetInputConnection(line->GetOutputPort());
  disk->SetAxisDirection(0.0, 0.0, 1.0);
  vtkNew<vtkNURBSExtrude> lens;
  lens->SetInputConnection(disk->GetOutputPort());
  lens->SetVector(0.0, 0.0, 0.5);

  vtkNew<vtkNURBSTessellate> lineMesh;
  lineMesh->SetInputConnection(line->GetOutputPort());
  vtkNew<vtkNURBSTessellate> diskMesh;
  diskMesh->SetInputConnection(disk->GetOutputPort());
  vtkNew<vtkNURBSTessellate> lensMesh;
  lensMesh->SetInputConnection(lens->GetOutputPort());
  vtkNew<vtkNURBSContour> contour;
  contour->SetInputConnection(lens->GetOutputPort());
  contour->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "Index");
  contour->SetNumberOfContours(2);
  contour->SetValue(0, 1.5);
  contour->SetValue(1, 1.56);

  double range[2];
  diskMesh->Update();
  vtkPolyData::SafeDownCast(diskMesh->GetOutputDataObject(0))
    ->GetPointData()
    ->GetArray("Index")
    ->GetRange(range);
  vtkNew<vtkColorTransferFunction> colors;
  colors->SetColorSpaceToDiverging();
  colors->AddRGBPoint(range[0], 0.23, 0.30, 0.75);
  colors->AddRGBPoint(range[1], 0.71, 0.02, 0.15);
  vtkNew<vtkRenderer> renderer;
  renderer->SetBackground(1.0, 1.0, 1.0);
  const auto show = [&](vtkAlgorithm* mesh, double x)
  {
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputConnection(mesh->GetOutputPort());
    mapper->SetScalarModeToUsePointFieldData();
    mapper->SelectColorArray("Index");
    mapper->SetLookupTable(colors);
    vtkNew<vtkActor> actor;
    actor->SetMapper(mapper);
    actor->SetPosition(x, 0.0, 0.0);
    actor->GetProperty()->SetLineWidth(6.0f);
    renderer->AddActor(actor);
  };
  const auto write = [&folder](vtkAlgorithm* mesh, const std::string& name)
  {
    vtkNew<vtkXMLPolyDataWriter> writer;
    writer->SetInputConnection(mesh->GetOutputPort());
    writer->SetFileName((folder + "/" + name + ".vtp").c_str());
    writer->SetDataModeToBinary(); // readers on some systems stumble over raw appended data
    return writer->Write() != 0;
  };
  show(lineMesh, -4.4);
  show(diskMesh, -2.2);
  show(lensMesh, 0.4);
  show(contour, 2.6);
  const bool written =
    write(diskMesh, "disk_surface") && write(lensMesh, "lens_surface") && write(contour, "contour");

  vtkNew<vtkRenderWindow> window;
  window->OffScreenRenderingOn();
  window->SetSize(1200, 400);
  window->AddRenderer(renderer);
  renderer->GetActiveCamera()->SetPosition(0.0, -2.0, 1.2);
  renderer->GetActiveCamera()->SetViewUp(0.0, 0.0, 1.0);
  renderer->ResetCameraScreenSpace();
  window->Render();
  vtkNew<vtkWindowToImageFilter> image;
  image->SetInput(window);
  vtkNew<vtkPNGWriter> picture;
  picture->SetInputConnection(image->GetOutputPort());
  picture->SetFileName((folder + "/picture.png").c_str());
  picture->Write();
  return written && picture->GetErrorCode() == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
