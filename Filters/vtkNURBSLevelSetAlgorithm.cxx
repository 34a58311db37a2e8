// SPDX-License-Identifier: BSD-3-Clause
#include "vtkNURBSLevelSetAlgorithm.h"

#include "Error.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

VTK_ABI_NAMESPACE_BEGIN

vtkNURBSLevelSetAlgorithm::vtkNURBSLevelSetAlgorithm(std::vector<double> levels)
  : Levels(std::move(levels))
{
}

vtkNURBSLevelSetAlgorithm::~vtkNURBSLevelSetAlgorithm() = default;

void vtkNURBSLevelSetAlgorithm::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Levels:";
  for (const double value : this->Levels)
  {
    os << " " << value;
  }
  os << "\n";
}

void vtkNURBSLevelSetAlgorithm::SetNumberOfLevels(int number)
{
  const auto size = static_cast<std::size_t>(std::max(number, 0));
  if (this->Levels.size() != size)
  {
    this->Levels.resize(size, 0.0);
    this->Modified();
  }
}

void vtkNURBSLevelSetAlgorithm::SetLevel(int i, double value)
{
  if (i < 0)
  {
    vtkErrorMacro("there is no value " << i);
    return;
  }
  this->SetNumberOfLevels(std::max(i + 1, this->GetNumberOfLevels()));
  double& at = this->Levels[static_cast<std::size_t>(i)];
  if (at != value)
  {
    at = value;
    this->Modified();
  }
}

double vtkNURBSLevelSetAlgorithm::GetLevel(int i) const
{
  return i >= 0 && i < this->GetNumberOfLevels() ? this->Levels[static_cast<std::size_t>(i)] : 0.0;
}

const std::vector<double>& vtkNURBSLevelSetAlgorithm::CheckedLevels(const char* what) const
{
  for (const double value : this->Levels)
  {
    if (!std::isfinite(value))
    {
      throw hyperpatch::Error(std::string(what) + " is not a finite number");
    }
  }
  return this->Levels;
}

VTK_ABI_NAMESPACE_END
