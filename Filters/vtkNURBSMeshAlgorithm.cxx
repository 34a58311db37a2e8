// SPDX-License-Identifier: BSD-3-Clause
#include "vtkNURBSMeshAlgorithm.h"

#include "Aggregate.h"
#include "Error.h"
#include "Evaluator.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

VTK_ABI_NAMESPACE_BEGIN

namespace
{

/// Least and largest value over a grid of samples, knots included; a few per span where spans are
/// few.
std::array<double, 2> SampledRange(const hyperpatch::Spline& field)
{
  std::size_t spans = 1;
  for (const hyperpatch::KnotVector& knots : field.Knots())
  {
    spans *= knots.Spans().size();
  }
  std::array<std::vector<double>, 3> samples;
  std::size_t count = 1;
  for (std::size_t d = 0; d < 3; ++d)
  {
    const hyperpatch::KnotVector& knots = field.Knots()[d];
    const std::vector<double> breaks = knots.Breaks();
    const int perSpan = std::min(knots.Degree() + 1, spans <= 10000 ? hyperpatch::MaxDegree : 2);
    for (std::size_t b = 0; b + 1 < breaks.size(); ++b)
    {
      for (int i = 0; i < perSpan; ++i)
      {
        samples[d].push_back(breaks[b] + (breaks[b + 1] - breaks[b]) * i / perSpan);
      }
    }
    if (knots.Degree() > 0)
    {
      samples[d].push_back(breaks.back());
    }
    count *= samples[d].size();
  }
  std::vector<double> values(count * static_cast<std::size_t>(field.Components()));
  hyperpatch::Evaluator(field).EvaluateGrid(samples, values.data());
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return { *low, *high };
}

}

void vtkNURBSMeshAlgorithm::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Tolerance: " << this->Tolerance << "\n";
  os << indent << "AttributeTolerance: " << this->AttributeTolerance << "\n";
}

std::vector<double> vtkNURBSMeshAlgorithm::AbsoluteTolerances::Of(
  const hyperpatch::Patch& patch) const
{
  std::vector<double> tolerances;
  for (const hyperpatch::Attribute& attribute : patch.Body.Attributes())
  {
    // An attribute that jumps at knots is right on one side of them, however fine the mesh is.
    const auto& knots = attribute.Field.Knots();
    const bool jumps = std::any_of(knots.begin(), knots.end(),
      [](const hyperpatch::KnotVector& k) { return k.Degree() == 0 && k.Spans().size() > 1; });
    const auto found = this->Attributes.find(attribute.Name);
    tolerances.push_back(jumps || found == this->Attributes.end() ? 0.0 : found->second);
  }
  return tolerances;
}

void vtkNURBSMeshAlgorithm::ModelChanged()
{
  this->Superclass::ModelChanged();
  this->LocalRanges.clear();
  this->RangesKnown = false;
}

vtkNURBSMeshAlgorithm::AbsoluteTolerances vtkNURBSMeshAlgorithm::FindTolerances(
  const hyperpatch::MultiPatch& model)
{
  if (!std::isfinite(this->Tolerance) || !std::isfinite(this->AttributeTolerance))
  {
    throw hyperpatch::Error("Tolerance and Attribute Tolerance must be finite numbers");
  }
  AbsoluteTolerances result;
  const double diagonal = this->Diagonal(model);
  // A model without extent has no error either.
  result.Position = this->Tolerance * (diagonal > 0.0 ? diagonal : 1.0);

  if (!this->RangesKnown)
  {
    for (const hyperpatch::Patch& patch : model.Patches)
    {
      for (const hyperpatch::Attribute& attribute : patch.Body.Attributes())
      {
        const auto range = SampledRange(attribute.Field);
        const auto [at, isNew] = this->LocalRanges.insert(
          { attribute.Name, { attribute.Field.Components(), range[0], range[1] } });
        at->second.Low = std::min(at->second.Low, range[0]);
        at->second.High = std::max(at->second.High, range[1]);
      }
    }
    this->RangesKnown = true;
  }

  // All ranks agree on the attributes first: names as records of character codes, with components.
  std::vector<double> records;
  for (const auto& [name, range] : this->LocalRanges)
  {
    records.push_back(range.Components);
    records.push_back(static_cast<double>(name.size()));
    for (const char c : name)
    {
      records.push_back(static_cast<unsigned char>(c));
    }
  }
  records = this->AllGather(records);
  for (std::size_t i = 0; i < records.size();)
  {
    const int components = static_cast<int>(records[i]);
    const auto length = static_cast<std::size_t>(records[i + 1]);
    std::string name;
    for (std::size_t c = 0; c < length; ++c)
    {
      name += static_cast<char>(static_cast<unsigned char>(records[i + 2 + c]));
    }
    result.Components.emplace(name, components);
    i += 2 + length;
  }

  int misfits = 0;
  for (const hyperpatch::Patch& patch : model.Patches)
  {
    for (const hyperpatch::Attribute& attribute : patch.Body.Attributes())
    {
      misfits += attribute.Field.Components() != result.Components.at(attribute.Name) ? 1 : 0;
    }
  }
  if (misfits > 0)
  {
    vtkWarningMacro(
      << misfits
      << " attributes have another number of components than their namesakes in other "
         "patches: they are NaN in the output");
  }
  for (const char* ours : { "Normals", "ParametricCoordinates" })
  {
    if (result.Components.erase(ours) > 0)
    {
      vtkWarningMacro("the attribute \""
        << ours << "\" is left out: an array of the output has that name. Rename it");
    }
  }

  std::vector<double> low(result.Components.size(), INFINITY);
  std::vector<double> high(result.Components.size(), -INFINITY);
  for (const auto& [name, range] : this->LocalRanges)
  {
    const auto found = result.Components.find(name);
    if (found == result.Components.end())
    {
      continue;
    }
    const auto i = static_cast<std::size_t>(std::distance(result.Components.begin(), found));
    low[i] = range.Low;
    high[i] = range.High;
  }
  low = this->GlobalMinimum(low);
  high = this->GlobalMaximum(high);
  std::size_t i = 0;
  for (const auto& entry : result.Components)
  {
    const double range = high[i] - low[i];
    // A constant, up to round-off, asks for nothing.
    const double noise = 1e-12 * std::max(std::abs(low[i]), std::abs(high[i]));
    result.Attributes[entry.first] = range > noise ? this->AttributeTolerance * range : 0.0;
    ++i;
  }
  return result;
}

VTK_ABI_NAMESPACE_END
