// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkNURBSLevelSetAlgorithm
 * @brief Base class of slice and contour: level sets of a function at a list of values.
 *
 * Keeps the values. Output: see vtkNURBSZeroSetAlgorithm.
 */
#ifndef vtkNURBSLevelSetAlgorithm_h
#define vtkNURBSLevelSetAlgorithm_h

#include "vtkNURBSFiltersModule.h" // for the export macro
#include "vtkNURBSZeroSetAlgorithm.h"

class VTKNURBSFILTERS_EXPORT vtkNURBSLevelSetAlgorithm : public vtkNURBSZeroSetAlgorithm
{
public:
  vtkAbstractTypeMacro(vtkNURBSLevelSetAlgorithm, vtkNURBSZeroSetAlgorithm)
  void PrintSelf(ostream& os, vtkIndent indent) override;

protected:
  explicit vtkNURBSLevelSetAlgorithm(std::vector<double> levels);
  ~vtkNURBSLevelSetAlgorithm() override;

  ///@{
  /**
   * The values, under the names that subclasses give them. A value set beyond the end makes the
   * list longer, with 0 between; there is none of a negative index, which is an error.
   */
  void SetNumberOfLevels(int number);
  int GetNumberOfLevels() const { return static_cast<int>(this->Levels.size()); }
  void SetLevel(int i, double value);
  double GetLevel(int i) const;
  ///@}

  /**
   * All values; throws an error that says what it is if one is not finite.
   */
  const std::vector<double>& CheckedLevels(const char* what) const;

private:
  vtkNURBSLevelSetAlgorithm(const vtkNURBSLevelSetAlgorithm&) = delete;
  void operator=(const vtkNURBSLevelSetAlgorithm&) = delete;

  std::vector<double> Levels;
};

#endif
