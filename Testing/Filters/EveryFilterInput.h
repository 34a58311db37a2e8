// SPDX-License-Identifier: BSD-3-Clause
#ifndef EveryFilterInput_h
#define EveryFilterInput_h

#include "EveryFilter.h"
#include "Models.h"
#include "NURBSConversion.h"

#include "vtkAlgorithm.h"
#include "vtkCellArray.h"
#include "vtkDataArray.h"
#include "vtkDataObject.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkNew.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkPlane.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"

#include <cmath>
#include <random>

/// What a filter needs to give something: input that fits it, and properties beyond its defaults.
class EveryFilterInput
{
public:
  struct Sizes
  {
    int Spans;   ///< of volumes, in each direction
    int Section; ///< control points of sections: along a curve, or in each direction of a surface
    int Samples; ///< of images, in each direction
  };

  explicit EveryFilterInput(Sizes sizes)
    : Size(sizes)
  {
    ToVTK(DentedCube(sizes.Spans), this->Volume);
    ToVTK(Section(sizes.Section, 0.0), this->Sections[0]);
    ToVTK(Section(sizes.Section, 1.0), this->Sections[1]);
    ToVTK(Section(3, 0.0), this->Path);
  }

  void Prepare(vtkAlgorithm* filter) const
  {
    for (int port = 0; port < filter->GetNumberOfInputPorts(); ++port)
    {
      if (!filter->GetInputPortInformation(port)->Get(vtkAlgorithm::INPUT_IS_OPTIONAL()))
      {
        filter->SetInputDataObject(port, this->Volume);
      }
    }
    filter->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "Temperature");
    vtkNew<vtkPlane> plane;
    plane->SetOrigin(0.5, 0.5, 0.5);
    plane->SetNormal(1.0, 2.0, 3.0);
    if (auto slice = vtkNURBSSlice::SafeDownCast(filter))
    {
      slice->SetSliceFunction(plane);
    }
    else if (auto clip = vtkNURBSClip::SafeDownCast(filter))
    {
      clip->SetClipFunction(plane);
    }
    else if (auto contour = vtkNURBSContour::SafeDownCast(filter))
    {
      contour->SetNumberOfContours(1);
      contour->SetValue(0, 0.0);
    }
    else if (vtkNURBSFit::SafeDownCast(filter))
    {
      vtkNew<vtkImageData> image;
      image->SetDimensions(this->Size.Samples, this->Size.Samples, this->Size.Samples);
      image->AllocateScalars(VTK_FLOAT, 3);
      image->GetPointData()->GetScalars()->Fill(1.0);
      filter->SetInputDataObject(image);
    }
    else if (filter->IsA("vtkNURBSExtrude") || filter->IsA("vtkNURBSRevolve") ||
      filter->IsA("vtkNURBSSweep"))
    {
      filter->SetInputDataObject(this->Sections[0]);
      if (filter->GetNumberOfInputPorts() > 1)
      {
        filter->SetInputDataObject(1, this->Path);
      }
    }
    else if (filter->IsA("vtkNURBSLoft") || filter->IsA("vtkNURBSRule"))
    {
      filter->SetInputDataObject(this->Sections[0]);
      filter->AddInputDataObject(this->Sections[1]);
    }
    else if (filter->IsA("vtkNURBSCurveThroughPoints"))
    {
      filter->SetInputDataObject(Line(this->Size.Section * this->Size.Section));
    }
  }

private:
  /// With a temperature in a basis of its own. It does not fold.
  static hyperpatch::MultiPatch DentedCube(int spans)
  {
    constexpr int degree = 3;
    const auto knots = hyperpatch::KnotVector::Uniform(degree, spans + degree);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> dent(-0.1 / spans, 0.1 / spans);
    const Eigen::Index n = knots.Size();
    Eigen::MatrixXd points(3, n * n * n);
    for (Eigen::Index c = 0; c < points.cols(); ++c)
    {
      const auto place = [&](Eigen::Index i)
      { return knots.Greville(static_cast<int>(i % n)) + dent(random); };
      points.col(c) << place(c), place(c / n), place(c / n / n);
    }
    const auto coarse = hyperpatch::KnotVector::Uniform(2, 5);
    const hyperpatch::Spline temperature =
      models::RandomSpline(random, { coarse, coarse, coarse }, 1, false);
    return Alone(hyperpatch::Aggregate(
      hyperpatch::Spline({ knots, knots, knots }, points), { { "Temperature", temperature } }));
  }

  /// Beside the y axis: of three points a parabola, of more a wavy surface.
  static hyperpatch::MultiPatch Section(int n, double y)
  {
    const int rows = n > 3 ? n : 1;
    Eigen::MatrixXd points(3, n * rows);
    for (int c = 0; c < n * rows; ++c)
    {
      const double u = (c % n) / (n - 1.0);
      points.col(c) << 1.0 + 2.0 * u, y + 0.1 * (c / n) / n,
        rows > 1 ? 0.1 * std::sin(40.0 * u) : 4.0 * u * (1.0 - u);
    }
    return Alone(hyperpatch::Aggregate(hyperpatch::Spline(
      { hyperpatch::KnotVector::Uniform(2, n),
        rows > 1 ? hyperpatch::KnotVector::Uniform(2, rows) : hyperpatch::KnotVector(), {} },
      points)));
  }

  static hyperpatch::MultiPatch Alone(hyperpatch::Aggregate body)
  {
    hyperpatch::MultiPatch model;
    model.Patches.push_back({ 0, std::move(body) });
    return model;
  }

  static vtkSmartPointer<vtkPolyData> Line(int n)
  {
    vtkNew<vtkPoints> points;
    vtkNew<vtkCellArray> lines;
    lines->InsertNextCell(n);
    for (int i = 0; i < n; ++i)
    {
      lines->InsertCellPoint(points->InsertNextPoint(i, std::sin(i), 0.0));
    }
    auto line = vtkSmartPointer<vtkPolyData>::New();
    line->SetPoints(points);
    line->SetLines(lines);
    return line;
  }

  Sizes Size;
  vtkNew<vtkPartitionedDataSetCollection> Volume;
  vtkNew<vtkPartitionedDataSetCollection> Sections[2];
  vtkNew<vtkPartitionedDataSetCollection> Path;
};

#endif
