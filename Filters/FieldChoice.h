// SPDX-License-Identifier: BSD-3-Clause
#ifndef FieldChoice_h
#define FieldChoice_h

#include "Aggregate.h"
#include "Prepared.h"
#include "ScalarField.h"

#include <map>
#include <memory>
#include <string>

/// What the user chose to contour or clip by. Private to this module.
struct FieldChoice
{
  /// The values of the enumeration property.
  enum Kinds
  {
    Attribute = 0,
    Coordinates = 1,
    ParametricCoordinates = 2,
    JacobianDeterminant = 3
  };

  int Kind = Attribute;
  std::string Name;  ///< of the attribute
  int Component = 0; ///< -1: the magnitude

  /// \param components of all attributes of the model
  /// \throws hyperpatch::Error that names what there is, if there is no such thing to choose
  void Check(const std::map<std::string, int>& components) const;

  /// The field that is 0 where what was chosen has the value; nullptr if the patch does not have
  /// it.
  [[nodiscard]] std::shared_ptr<const hyperpatch::ScalarField> At(
    const hyperpatch::PreparedAggregate& body, double value) const;

  /// The index of the attribute that is constant where the field is 0; -1: none is.
  [[nodiscard]] int ConstantAttribute(const hyperpatch::Aggregate& body) const;
};

#endif
