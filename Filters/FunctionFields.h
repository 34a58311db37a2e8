// SPDX-License-Identifier: BSD-3-Clause
#ifndef FunctionFields_h
#define FunctionFields_h

#include "Aggregate.h"
#include "Prepared.h"
#include "QuadricField.h"
#include "ScalarField.h"

#include "vtkSmartPointer.h"

#include <memory>
#include <optional>
#include <vector>

class vtkImplicitFunction;

/// The fields of an implicit function on a model. Private to this module.
class FunctionFields
{
public:
  /// \throws hyperpatch::Error if there is no function, or its parameters are not finite or a
  /// plane's normal is 0
  FunctionFields(vtkImplicitFunction* function, const hyperpatch::MultiPatch& model);

  /// The fields whose maximum is the function less a value: six for a box (at values that are not
  /// positive), where they are the distances from the planes of its sides; one otherwise.
  [[nodiscard]] std::vector<std::shared_ptr<const hyperpatch::ScalarField>> At(
    const hyperpatch::PreparedAggregate& body, double value) const;

private:
  vtkSmartPointer<vtkImplicitFunction> Function;
  /// Exact ones: the function itself, or the six sides of a box.
  std::vector<hyperpatch::Quadric> Quadrics;
  bool IsBox = false;
};

#endif
