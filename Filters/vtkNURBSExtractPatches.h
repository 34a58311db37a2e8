// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkNURBSExtractPatches
 * @brief Some patches of a model, chosen by id, by boundary or by a box.
 *
 * To look at, save or work on a part of a model of many patches. Nothing is approximated: the
 * patches that are chosen are passed on as they are.
 *
 * Input: see vtkNURBSAlgorithm. Output: vtkPartitionedDataSetCollection, the control lattice of the
 * chosen patches with all attributes, see NURBSConversion.h. Patches keep their ids. Of the
 * interfaces those between chosen patches stay, of the boundaries the sides of chosen patches; a
 * boundary that has no sides any more is dropped.
 *
 * An id or the name of a boundary that is not there is an error, which lists what there is. A box
 * that no patch meets gives empty output without a message.
 *
 * The choice is the same on any number of ranks. Cost: one copy of the model.
 *
 * @sa vtkNURBSTessellate
 */
#ifndef vtkNURBSExtractPatches_h
#define vtkNURBSExtractPatches_h

#include "vtkNURBSAlgorithm.h"
#include "vtkNURBSFiltersModule.h" // for the export macro
#include "vtkSmartPointer.h"       // for the box

#include <set>    // for ids of patches
#include <string> // for the name of the boundary
#include <vector> // for the ids

class vtkBox;
class vtkStringArray;

class VTKNURBSFILTERS_EXPORT vtkNURBSExtractPatches : public vtkNURBSAlgorithm
{
public:
  static vtkNURBSExtractPatches* New();
  vtkTypeMacro(vtkNURBSExtractPatches, vtkNURBSAlgorithm)
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /// Also that of the box.
  vtkMTimeType GetMTime() override;

  enum ExtractByTypes
  {
    PATCH_IDS = 0,
    BOUNDARY = 1,
    BOX = 2
  };

  ///@{
  /**
   * What patches are chosen by: PatchIds (the default), BoundaryName or Box.
   */
  vtkSetClampMacro(ExtractBy, int, PATCH_IDS, BOX);
  vtkGetMacro(ExtractBy, int);
  ///@}

  ///@{
  /**
   * The ids, in any order. Default: one, 0. Indices beyond the number of ids are ignored by
   * SetPatchId() and give -1 from GetPatchId().
   */
  void SetNumberOfPatchIds(int number);
  int GetNumberOfPatchIds();
  void SetPatchId(int index, int id);
  int GetPatchId(int index);
  ///@}

  ///@{
  /**
   * The name of a boundary of the model: patches that have a side in it are chosen. Default empty.
   */
  vtkSetStdStringFromCharMacro(BoundaryName);
  vtkGetCharFromStdStringMacro(BoundaryName);
  ///@}

  /**
   * The names of the boundaries of the input as it is now; to choose from.
   */
  vtkStringArray* GetBoundaryNames();

  ///@{
  /**
   * A box, which a linear transform may have turned: patches are chosen whose control points have
   * bounds, in the axes of the box, that meet it. The solid of a patch lies in these bounds. A box
   * may be flat. There is none at first, which is an error.
   */
  void SetBox(vtkBox* box);
  vtkBox* GetBox();
  ///@}

protected:
  vtkNURBSExtractPatches();
  ~vtkNURBSExtractPatches() override;

  int OutputType() const override;
  void Execute(const hyperpatch::MultiPatch& model, vtkDataObject* output) override;

private:
  vtkNURBSExtractPatches(const vtkNURBSExtractPatches&) = delete;
  void operator=(const vtkNURBSExtractPatches&) = delete;

  std::set<int> FindIds(const hyperpatch::MultiPatch& model) const;
  std::set<int> FindBoundary(const hyperpatch::MultiPatch& model) const;
  std::set<int> FindInBox(const hyperpatch::MultiPatch& model) const;
  std::vector<std::string> GatherNames(const std::vector<std::string>& names) const;

  int ExtractBy = PATCH_IDS;
  std::vector<int> PatchIds = { 0 };
  std::string BoundaryName;
  vtkSmartPointer<vtkStringArray> BoundaryNames;
  vtkSmartPointer<vtkBox> Box;
};

#endif
