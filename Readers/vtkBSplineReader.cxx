// SPDX-License-Identifier: BSD-3-Clause
#include "vtkBSplineReader.h"

#include "Error.h"
#include "Formats.h"
#include "Interfaces.h"
#include "NURBSConversion.h"

#include "vtkCallbackCommand.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkXMLPartitionedDataSetCollectionReader.h"

#include <vtksys/SystemTools.hxx>

#include <fstream>
#include <new>
#include <string_view>
#include <utility>
#include <vector>

namespace
{

constexpr std::size_t SniffLength = 4096;
/// Control points of two faces that are one, as a fraction of the model's diagonal.
constexpr double InterfaceTolerance = 1e-9;

std::string Begin(const std::string& fileName, std::size_t length)
{
  std::ifstream file(fileName, std::ios::binary);
  std::string text(length, '\0');
  file.read(text.data(), static_cast<std::streamsize>(length));
  text.resize(static_cast<std::size_t>(file.gcount()));
  return text;
}

bool Contains(std::string_view text, std::string_view part)
{
  return text.find(part) != std::string_view::npos;
}

bool IsCollectionFile(std::string_view begin)
{
  return Contains(begin, "<VTKFile") && Contains(begin, "\"vtkPartitionedDataSetCollection\"");
}

/// True if the first grid that a .vtpc file refers to is a control lattice.
bool IsCollectionOfLattices(const std::string& fileName, std::string_view begin)
{
  constexpr std::string_view attribute = "file=\"";
  const std::size_t at = begin.find(attribute);
  if (!IsCollectionFile(begin) || at == std::string_view::npos)
  {
    return false;
  }
  const std::size_t name = at + attribute.size();
  const std::string grid(begin.substr(name, begin.find('"', name) - name));
  const std::string text =
    Begin(vtksys::SystemTools::CollapseFullPath(grid,
            vtksys::SystemTools::GetFilenamePath(vtksys::SystemTools::CollapseFullPath(fileName))),
      SniffLength);
  return Contains(text, "type=\"StructuredGrid\"") && Contains(text, "Name=\"SplineLayout\"");
}

/// Keeps the first error of a VTK reader instead of printing it.
void KeepFirst(vtkObject*, unsigned long, void* clientData, void* callData)
{
  auto& first = *static_cast<std::string*>(clientData);
  if (first.empty())
  {
    first = static_cast<const char*>(callData);
    first.erase(first.find_last_not_of(" \n") + 1);
  }
}

hyperpatch::FileContents ReadCollectionFile(const std::string& fileName)
{
  std::string failure;
  vtkNew<vtkCallbackCommand> observer;
  observer->SetCallback(KeepFirst);
  observer->SetClientData(&failure);
  vtkNew<vtkXMLPartitionedDataSetCollectionReader> reader;
  reader->AddObserver(vtkCommand::ErrorEvent, observer);
  reader->SetReaderErrorObserver(observer);
  reader->SetParserErrorObserver(observer);
  reader->SetFileName(fileName.c_str());
  reader->Update();
  if (!failure.empty())
  {
    throw hyperpatch::Error(fileName + ": " + failure);
  }
  return { hyperpatch::FromVTK(reader->GetOutput()), {} };
}

}

struct vtkBSplineReader::Contents
{
  std::string FileName;
  long int Time = 0;
  unsigned long Length = 0;
  hyperpatch::MultiPatch Model;
  std::vector<std::string> OwnBasisAttributes;
};

vtkStandardNewMacro(vtkBSplineReader);

vtkBSplineReader::vtkBSplineReader()
{
  this->SetNumberOfInputPorts(0);
}

vtkBSplineReader::~vtkBSplineReader() = default;

void vtkBSplineReader::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "FileName: " << this->FileName << "\n";
  os << indent << "Cached: " << (this->Cached ? this->Cached->FileName : "(none)") << "\n";
}

int vtkBSplineReader::CanReadFile(const char* fileName)
{
  if (!fileName || !vtksys::SystemTools::FileExists(fileName, true))
  {
    return 0;
  }
  const std::string begin = Begin(fileName, SniffLength);
  return hyperpatch::SniffFormat(begin) != hyperpatch::Format::Unknown ||
      IsCollectionOfLattices(fileName, begin)
    ? 1
    : 0;
}

int vtkBSplineReader::RequestInformation(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector)
{
  outputVector->GetInformationObject(0)->Set(vtkAlgorithm::CAN_HANDLE_PIECE_REQUEST(), 1);
  return 1;
}

void vtkBSplineReader::Read()
{
  if (this->FileName.empty())
  {
    throw hyperpatch::Error("no file name");
  }
  if (!vtksys::SystemTools::FileExists(this->FileName, true))
  {
    throw hyperpatch::Error(this->FileName + ": there is no such file");
  }
  const long int time = vtksys::SystemTools::ModifiedTime(this->FileName);
  const unsigned long length = vtksys::SystemTools::FileLength(this->FileName);
  if (this->Cached && this->Cached->FileName == this->FileName && this->Cached->Time == time &&
    this->Cached->Length == length)
  {
    return;
  }
  this->Cached.reset();
  hyperpatch::FileContents file = IsCollectionFile(Begin(this->FileName, SniffLength))
    ? ReadCollectionFile(this->FileName)
    : hyperpatch::ReadSplineFile(this->FileName);
  for (const std::string& warning : file.Warnings)
  {
    vtkWarningMacro(<< this->FileName << ": " << warning);
  }
  if (file.Model.Interfaces.empty())
  {
    file.Model.Interfaces = hyperpatch::FindInterfaces(file.Model, InterfaceTolerance);
  }
  std::vector<std::string> own = hyperpatch::OwnBasisAttributes(file.Model);
  this->Cached = std::make_unique<Contents>(
    Contents{ this->FileName, time, length, std::move(file.Model), std::move(own) });
}

int vtkBSplineReader::RequestData(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputVector)
{
  vtkInformation* info = outputVector->GetInformationObject(0);
  const int piece = info->Get(vtkStreamingDemandDrivenPipeline::UPDATE_PIECE_NUMBER());
  const int pieces = info->Get(vtkStreamingDemandDrivenPipeline::UPDATE_NUMBER_OF_PIECES());
  auto output = vtkPartitionedDataSetCollection::GetData(outputVector);
  std::string message;
  try
  {
    this->Read();
    const hyperpatch::MultiPatch& model = this->Cached->Model;
    hyperpatch::ToVTK(pieces > 1 ? hyperpatch::ExtractPiece(model, piece, pieces) : model, output,
      this->Cached->OwnBasisAttributes);
    return 1;
  }
  catch (const hyperpatch::Error& error)
  {
    message = error.what();
  }
  catch (const std::bad_alloc&)
  {
    message = this->FileName + ": out of memory";
  }
  vtkErrorMacro(<< message);
  output->Initialize();
  return 0;
}
