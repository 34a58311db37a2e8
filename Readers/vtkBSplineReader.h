// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class vtkBSplineReader
 * @brief Reads spline volumes, surfaces and curves with their fields.
 *
 * The format is recognised by the content of the file: G+Smo XML, MFEM NURBS mesh, GoTools g2, IRIT
 * itd, GeoPDEs text, and the .vtpc files that vtkXMLPartitionedDataSetCollectionWriter makes of
 * this reader's output (data mode Binary or Ascii).
 *
 * Output: a vtkPartitionedDataSetCollection, the control lattice described in NURBSConversion.h:
 * dataset `Geometry` with one vtkStructuredGrid per patch (points are control points; point data
 * `Weight` where rational and the attributes in the geometry's basis), and one dataset per
 * attribute with a basis of its own. Field data of the collection: interfaces and named boundaries.
 * Where the file says nothing of interfaces they are found by coincident faces.
 *
 * Pieces: patches are dealt out to the ranks, and cut at knot spans where there are more ranks than
 * patches. Every rank reads the whole file.
 *
 * What the file has and the reader does not take is told in one warning each. A file that cannot be
 * read gives one error message and empty output.
 *
 * The model is kept until the file or its name changes.
 *
 * @sa vtkNURBSAlgorithm
 */
#ifndef vtkBSplineReader_h
#define vtkBSplineReader_h

#include "vtkNURBSReadersModule.h" // for the export macro
#include "vtkPartitionedDataSetCollectionAlgorithm.h"

#include <memory> // for the parsed model
#include <string> // for the file name

class VTKNURBSREADERS_EXPORT vtkBSplineReader : public vtkPartitionedDataSetCollectionAlgorithm
{
public:
  static vtkBSplineReader* New();
  vtkTypeMacro(vtkBSplineReader, vtkPartitionedDataSetCollectionAlgorithm)
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * The file to read.
   */
  vtkSetStdStringFromCharMacro(FileName);
  vtkGetCharFromStdStringMacro(FileName);
  ///@}

  /**
   * 1 if the file's beginning (for .vtpc: its first grid) says that it is ours, 0 otherwise. Reads
   * a few kB.
   */
  static int CanReadFile(const char* fileName);

protected:
  vtkBSplineReader();
  ~vtkBSplineReader() override;

  int RequestInformation(vtkInformation* request, vtkInformationVector** inputVector,
    vtkInformationVector* outputVector) override;
  int RequestData(vtkInformation* request, vtkInformationVector** inputVector,
    vtkInformationVector* outputVector) override;

private:
  vtkBSplineReader(const vtkBSplineReader&) = delete;
  void operator=(const vtkBSplineReader&) = delete;

  struct Contents;
  void Read();

  std::string FileName;
  std::unique_ptr<Contents> Cached;
};

#endif
