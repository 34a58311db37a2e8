// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkNURBSPrimitive
 * @brief Boxes, cylinders, tubes, cones, spheres, tori, wedges and helices as spline volumes.
 *
 * All shapes are exact (rational where they are round) but the helix, which is not rational and is
 * made to a tolerance. They are right-handed (det J > 0), centred at Center with their axis along
 * z, and have the interfaces of their patches.
 *
 * A solid that has no regular map from one cube comes in two parametrisations: as one patch with a
 * pole (an axis, a centre or an edge where its map degenerates), or as several regular patches
 * around a central one. A tube and a box need no choice. A cone with an apex has poles only.
 *
 * | shape | patches | degrees | lengths |
 * | --- | --- | --- | --- |
 * | box | 1 | 1, 1, 1 | Lengths |
 * | cylinder | 5 or 1 | 1, 2, 1 (central: 2, 2, 1) | Radius, Height |
 * | tube | 1 | 1, 2, 1 | InnerRadius, Radius, Height |
 * | cone | 5 or 1 | as cylinder | Radius, TopRadius, Height |
 * | sphere | 7 or 1 | 4, 4, 1 (central: 4, 4, 4) or 1, 2, 2 | Radius |
 * | spherical shell | 6 or 1 | 4, 4, 1 or 1, 2, 2 | InnerRadius, Radius |
 * | torus | 5 or 1 | as cylinder, 2 in w | MajorRadius, Radius |
 * | wedge, half a box | 3 or 1 | 1, 1, 1 | Lengths |
 * | helix, a bent wire | 5 or 1 | as cylinder, 3 in w | MajorRadius, Radius, Pitch, Turns |
 *
 * Output: vtkPartitionedDataSetCollection, the control lattice, see NURBSConversion.h.
 *
 * @code
 * vtkNew<vtkNURBSPrimitive> sphere;
 * sphere->SetShape(vtkNURBSPrimitive::SPHERE);
 * slice->SetInputConnection(sphere->GetOutputPort());
 * @endcode
 *
 * References: Cobb, Tiling the sphere with rational Bezier patches, 1988.
 *
 * @sa vtkNURBSCurve, vtkNURBSExtrude, vtkNURBSRevolve
 */
#ifndef vtkNURBSPrimitive_h
#define vtkNURBSPrimitive_h

#include "vtkNURBSFiltersModule.h" // for the export macro
#include "vtkNURBSModelAlgorithm.h"

class VTKNURBSFILTERS_EXPORT vtkNURBSPrimitive : public vtkNURBSModelAlgorithm
{
public:
  static vtkNURBSPrimitive* New();
  vtkTypeMacro(vtkNURBSPrimitive, vtkNURBSModelAlgorithm)
  void PrintSelf(ostream& os, vtkIndent indent) override;

  enum Shapes
  {
    BOX = 0,
    CYLINDER = 1,
    TUBE = 2,
    CONE = 3,
    SPHERE = 4,
    SPHERICAL_SHELL = 5,
    TORUS = 6,
    WEDGE = 7,
    HELIX = 8
  };

  ///@{
  /**
   * The shape. Default BOX.
   */
  vtkSetClampMacro(Shape, int, BOX, HELIX);
  vtkGetMacro(Shape, int);
  ///@}

  enum Parametrisations
  {
    PATCHES = 0,
    POLES = 1
  };

  ///@{
  /**
   * Several regular patches (the default), or one with a pole.
   */
  vtkSetClampMacro(Parametrisation, int, PATCHES, POLES);
  vtkGetMacro(Parametrisation, int);
  ///@}

  ///@{
  /**
   * Lengths of a box or wedge along x, y and z. Default 1, 1, 1.
   */
  vtkSetVector3Macro(Lengths, double);
  vtkGetVector3Macro(Lengths, double);
  ///@}

  ///@{
  /**
   * Radius of a cylinder or sphere, outer radius of a tube or shell, bottom radius of a cone,
   * radius of the disk that a torus or helix is swept with. Default 0.5.
   */
  vtkSetMacro(Radius, double);
  vtkGetMacro(Radius, double);
  ///@}

  ///@{
  /**
   * Inner radius of a tube or shell. Default 0.25.
   */
  vtkSetMacro(InnerRadius, double);
  vtkGetMacro(InnerRadius, double);
  ///@}

  ///@{
  /**
   * Top radius of a cone; 0 for an apex, which POLES can have alone. Default 0.25.
   */
  vtkSetMacro(TopRadius, double);
  vtkGetMacro(TopRadius, double);
  ///@}

  ///@{
  /**
   * Height of a cylinder, tube or cone. Default 1.
   */
  vtkSetMacro(Height, double);
  vtkGetMacro(Height, double);
  ///@}

  ///@{
  /**
   * Distance of the centre of a torus' or helix' disk from the axis. Default 1.5.
   */
  vtkSetMacro(MajorRadius, double);
  vtkGetMacro(MajorRadius, double);
  ///@}

  ///@{
  /**
   * Rise of a helix per turn; negative: left-handed. Default 1.5.
   */
  vtkSetMacro(Pitch, double);
  vtkGetMacro(Pitch, double);
  ///@}

  ///@{
  /**
   * Number of turns of a helix, not necessarily whole. Default 3.
   */
  vtkSetMacro(Turns, double);
  vtkGetMacro(Turns, double);
  ///@}

  ///@{
  /**
   * Largest distance of a point of a helix from where it should be, as a fraction of its outer
   * radius. Default 1e-4.
   */
  vtkSetMacro(Tolerance, double);
  vtkGetMacro(Tolerance, double);
  ///@}

  ///@{
  /**
   * The centre. Default 0, 0, 0.
   */
  vtkSetVector3Macro(Center, double);
  vtkGetVector3Macro(Center, double);
  ///@}

protected:
  vtkNURBSPrimitive();
  ~vtkNURBSPrimitive() override = default;

  hyperpatch::MultiPatch MakeModel(const Inputs& inputs) override;

private:
  vtkNURBSPrimitive(const vtkNURBSPrimitive&) = delete;
  void operator=(const vtkNURBSPrimitive&) = delete;

  int Shape = BOX;
  int Parametrisation = PATCHES;
  double Lengths[3] = { 1.0, 1.0, 1.0 };
  double Radius = 0.5;
  double InnerRadius = 0.25;
  double TopRadius = 0.25;
  double Height = 1.0;
  double MajorRadius = 1.5;
  double Pitch = 1.5;
  double Turns = 3.0;
  double Tolerance = 1e-4;
  double Center[3] = { 0.0, 0.0, 0.0 };
};

#endif
