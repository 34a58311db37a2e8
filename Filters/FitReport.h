// SPDX-License-Identifier: BSD-3-Clause
#ifndef FitReport_h
#define FitReport_h

#include "Cone.h"
#include "GridFit.h"
#include "Spline.h"

#include <cmath>
#include <string>
#include <vector>

class vtkFieldData;

/// What is known of fits, one row for each; the columns are those of the class comment of
/// vtkNURBSFit. Private to this module.
class FitReport
{
public:
  /// \param range that relative errors refer to
  void Add(int patchId, const std::string& name, const hyperpatch::Spline& spline,
    const hyperpatch::FitError& error, double range);

  /// Completes the last row by bounds of the least Jacobian determinant, times the handedness.
  void CertifyJacobian(
    const hyperpatch::Spline& geometry, const hyperpatch::ParallelFor& parallelFor);

  /// Adds the columns as arrays.
  void Fill(vtkFieldData* columns) const;

private:
  struct Row
  {
    int PatchId;
    std::string Attribute;
    Eigen::Index Components, ControlPoints;
    hyperpatch::FitError Error;
    double Range;
    hyperpatch::Interval Jacobian{ NAN, NAN };
    int Invalid = -1;
    int Undecided = -1;
  };
  template <typename Array, typename Value>
  void AddColumn(vtkFieldData* columns, const char* name, Value&& value) const;

  std::vector<Row> Rows;
};

#endif
