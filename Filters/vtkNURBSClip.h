// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkNURBSClip
 * @brief The part of exact spline volumes on one side of a plane, sphere, box or isovalue.
 *
 * What vtkTableBasedClipDataSet does with cells, done with the splines themselves: a conforming
 * mesh of one side of a function or of an isovalue, to the tolerances. Points of the cut lie on the
 * plane (to 1e-12 of the model's size), sphere or isosurface, and all points lie on the spline and
 * carry the exact values of all attributes there.
 *
 * Input: see vtkNURBSAlgorithm. Output: vtkUnstructuredGrid of tetrahedra of positive volume
 * (volumes), triangles (surfaces) or lines (curves) with the arrays of vtkNURBSMeshAlgorithm but
 * Normals. Field data, one number each:
 * - `CertifiedCells`: cells at the cut, before they are cut, in which it is proven to be one sheet
 * - `UndecidedCells`: those in which a zero can neither be excluded nor be proven to be a simple
 *   sheet; no wider than the tolerance unless the limit of refinement came first
 * - `LargestResidual`: of |f| at points of the cut, relative to |f| at the ends of the edges there
 * - `LargestError`: distance from the exact geometry, bounded or measured, and measured distance
 *   from the exact cut
 * - `OpenFacesOnInterfaces`: faces of one tetrahedron only, on interfaces between patches
 * - `ToleranceReached`: 0 where the limit of refinement came first (a warning says so too)
 * In a parallel run all processes have the numbers of the whole.
 *
 * With a function (ClipFunction): planes, spheres, cylinders, quadrics and boxes (also transformed
 * by an affine transform) are exact polynomials; any other function is sampled in every cell at the
 * cut, and these count as undecided. Without one, by an attribute, a coordinate, a parametric
 * coordinate or det J (ClipBy), at Value; the attribute is chosen with SetInputArrayToProcess(0, 0,
 * 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, name), and patches without it are left out.
 *
 * The mesh is conforming in a patch, and where patches of a process meet at an interface on which
 * geometry and field agree to 1e-6 of the extent of the model and of the range of the field: both
 * sides have the same faces there, with the same bits in the coordinates of their points, which
 * occur once per side. Elsewhere (interfaces that do not agree, cuts between processes, patches of
 * different processes) meshes may differ by Tolerance, and their faces are counted in
 * OpenFacesOnInterfaces.
 *
 * Where a side of a patch is collapsed to an axis or a pole, it is one line or point of the mesh.
 * An attribute that is not one value there (an angle on the axis) has one of its values; tetrahedra
 * around it are then refined to the width of Tolerance and count as undecided.
 *
 * Cost: proportional to the elements kept and to the output; elements on the other side cost only
 * their exclusion, which a tree finds. What is known of elements is kept while the input does not
 * change. Not more than about 5 million cells of a patch are refined further: then a warning says
 * that a tolerance was not reached.
 *
 * References: Labelle & Shewchuk, Isosurface stuffing, SIGGRAPH 2007, for points near the cut; De
 * Loera, Rambau & Santos, Triangulations, 2010, section 4.3.2, for the division of elements.
 *
 * @code{.cpp}
 * vtkNew<vtkSphere> sphere;
 * vtkNew<vtkNURBSClip> clip;
 * clip->SetInputConnection(reader->GetOutputPort());
 * clip->SetClipFunction(sphere);
 * clip->Update();
 * @endcode
 *
 * @sa vtkNURBSSlice, vtkNURBSContour, vtkNURBSTessellate
 */
#ifndef vtkNURBSClip_h
#define vtkNURBSClip_h

#include "vtkNURBSFiltersModule.h" // for the export macro
#include "vtkNURBSMeshAlgorithm.h"
#include "vtkSmartPointer.h" // for the function

#include <memory> // for what is kept

class vtkImplicitFunction;

class VTKNURBSFILTERS_EXPORT vtkNURBSClip : public vtkNURBSMeshAlgorithm
{
public:
  static vtkNURBSClip* New();
  vtkTypeMacro(vtkNURBSClip, vtkNURBSMeshAlgorithm)
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /// Also that of the function.
  vtkMTimeType GetMTime() override;

  ///@{
  /**
   * The function that clips. Default: none, then ClipBy says what does.
   */
  void SetClipFunction(vtkImplicitFunction* function);
  vtkImplicitFunction* GetClipFunction();
  ///@}

  enum ClipByTypes
  {
    ATTRIBUTE = 0,
    COORDINATES = 1,
    PARAMETRIC_COORDINATES = 2,
    JACOBIAN_DETERMINANT = 3
  };

  ///@{
  /**
   * What clips where there is no function: an attribute (the default), a coordinate, a parametric
   * coordinate (in the patch's own knots), or the determinant of the derivatives of the coordinates
   * by the parameters.
   */
  vtkSetClampMacro(ClipBy, int, ATTRIBUTE, JACOBIAN_DETERMINANT);
  vtkGetMacro(ClipBy, int);
  ///@}

  ///@{
  /**
   * The component of the attribute or coordinates, from 0; -1 is the magnitude, which parametric
   * coordinates do not have. Default 0.
   */
  vtkSetMacro(Component, int);
  vtkGetMacro(Component, int);
  ///@}

  ///@{
  /**
   * The value at which to clip where there is no function. Default 0.
   */
  vtkSetMacro(Value, double);
  vtkGetMacro(Value, double);
  ///@}

  ///@{
  /**
   * Whether the side of smaller values is kept (on, the default: behind a plane, inside a sphere or
   * box) or that of larger ones.
   */
  vtkSetMacro(Invert, bool);
  vtkGetMacro(Invert, bool);
  vtkBooleanMacro(Invert, bool);
  ///@}

protected:
  vtkNURBSClip();
  ~vtkNURBSClip() override;

  int OutputType() const override;
  void Execute(const hyperpatch::MultiPatch& model, vtkDataObject* output) override;
  void ModelChanged() override;

private:
  vtkNURBSClip(const vtkNURBSClip&) = delete;
  void operator=(const vtkNURBSClip&) = delete;

  /// How much elements bend; kept until the model changes.
  struct KeptBends;
  std::unique_ptr<KeptBends> Bends;

  vtkSmartPointer<vtkImplicitFunction> ClipFunction;
  int ClipBy = ATTRIBUTE;
  int Component = 0;
  double Value = 0.0;
  bool Invert = true;
};

#endif
