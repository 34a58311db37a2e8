// SPDX-License-Identifier: BSD-3-Clause
#include "vtkNURBSMeshAlgorithm.h"

#include "Aggregate.h"
#include "ArrayNames.h"
#include "Error.h"
#include "Evaluator.h"
#include "Prepared.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

VTK_ABI_NAMESPACE_BEGIN

namespace
{

/// Least and largest value over a grid of samples: all knots, and some between them where spans are
/// few.
std::array<double, 2> SampledRange(
  const hyperpatch::Spline& field, const hyperpatch::Evaluator& evaluator)
{
  constexpr std::size_t LayerValues = 1 << 15;
  std::size_t spans = 1;
  for (const hyperpatch::KnotVector& knots : field.Knots())
  {
    spans *= knots.Spans().size();
  }
  std::array<std::vector<double>, 3> samples;
  for (std::size_t d = 0; d < 3; ++d)
  {
    const hyperpatch::KnotVector& knots = field.Knots()[d];
    const std::vector<double> breaks = knots.Breaks();
    const int perSpan = std::min(knots.Degree() + 1, spans <= 10000 ? hyperpatch::MaxDegree : 1);
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
  }
  // Layer after layer: all values at once may be more than the spline itself.
  const std::size_t layer =
    samples[0].size() * samples[1].size() * static_cast<std::size_t>(field.Components());
  const std::size_t layers = std::max<std::size_t>(1, LayerValues / layer);
  std::vector<double> values(layer * std::min(layers, samples[2].size()));
  std::array<double, 2> range{ INFINITY, -INFINITY };
  for (std::size_t k = 0; k < samples[2].size(); k += layers)
  {
    const std::size_t count = std::min(layers, samples[2].size() - k);
    const auto first = samples[2].begin() + static_cast<std::ptrdiff_t>(k);
    evaluator.EvaluateGrid(
      { samples[0], samples[1], { first, first + static_cast<std::ptrdiff_t>(count) } },
      values.data());
    for (std::size_t i = 0; i < count * layer; ++i)
    {
      range[0] = std::min(range[0], values[i]);
      range[1] = std::max(range[1], values[i]);
    }
  }
  return range;
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

  std::map<std::string, int> components; // of the patches here
  for (const hyperpatch::Patch& patch : model.Patches)
  {
    for (const hyperpatch::Attribute& attribute : patch.Body.Attributes())
    {
      components.emplace(attribute.Name, attribute.Field.Components());
    }
  }

  // All ranks agree on the attributes first: names as records of character codes, with components.
  std::vector<double> records;
  for (const auto& [name, count] : components)
  {
    records.push_back(count);
    records.push_back(static_cast<double>(name.size()));
    for (const char c : name)
    {
      records.push_back(static_cast<unsigned char>(c));
    }
  }
  records = this->AllGather(records);
  for (std::size_t i = 0; i < records.size();)
  {
    const int count = static_cast<int>(records[i]);
    const auto length = static_cast<std::size_t>(records[i + 1]);
    std::string name;
    for (std::size_t c = 0; c < length; ++c)
    {
      name += static_cast<char>(static_cast<unsigned char>(records[i + 2 + c]));
    }
    result.Components.emplace(name, count);
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
  for (const char* ours : { hyperpatch::names::Normals, hyperpatch::names::ParametricCoordinates })
  {
    if (result.Components.erase(ours) > 0)
    {
      vtkWarningMacro("the attribute \""
        << ours << "\" is left out: an array of the output has that name. Rename it");
    }
  }

  if (this->AttributeTolerance <= 0.0)
  {
    return result;
  }
  if (this->LocalRanges.empty())
  {
    this->FindRanges(model);
  }
  std::vector<double> low;
  std::vector<double> high;
  for (const auto& entry : result.Components)
  {
    const auto found = this->LocalRanges.find(entry.first);
    const bool isHere = found != this->LocalRanges.end();
    low.push_back(isHere ? found->second[0] : INFINITY);
    high.push_back(isHere ? found->second[1] : -INFINITY);
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

void vtkNURBSMeshAlgorithm::FindRanges(const hyperpatch::MultiPatch& model)
{
  for (std::size_t p = 0; p < model.Patches.size(); ++p)
  {
    const std::vector<hyperpatch::Attribute>& attributes = model.Patches[p].Body.Attributes();
    const hyperpatch::PreparedAggregate* prepared = this->PreparedBody(model, p);
    for (std::size_t a = 0; a < attributes.size(); ++a)
    {
      const hyperpatch::Spline& field = attributes[a].Field;
      const auto range = prepared ? SampledRange(field, prepared->Attributes()[a]->Evaluator())
                                  : SampledRange(field, hyperpatch::Evaluator(field));
      const auto [at, isNew] = this->LocalRanges.try_emplace(attributes[a].Name, range);
      at->second[0] = std::min(at->second[0], range[0]);
      at->second[1] = std::max(at->second[1], range[1]);
    }
  }
}

const hyperpatch::PreparedAggregate* vtkNURBSMeshAlgorithm::PreparedBody(
  const hyperpatch::MultiPatch& /*model*/, std::size_t /*patch*/)
{
  return nullptr;
}

VTK_ABI_NAMESPACE_END
