// SPDX-License-Identifier: BSD-3-Clause
#ifndef ValidityReport_h
#define ValidityReport_h

#include "CondeTorres.h"
#include "GlobalInjectivity.h"
#include "Validity.h"

#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

class vtkFieldData;
class vtkTable;

/// What vtkNURBSValidity tells of patches and of the model, in words and numbers. Private to this
/// module.
class ValidityReport
{
public:
  /// Adds a patch, or a part of one.
  /// \param options with which it was tested
  /// \param passes how many elements pass the test of Conde & Torres, if it was made
  void Add(int patchId, const hyperpatch::PatchValidity& validity,
    const hyperpatch::ValidityOptions& options, std::optional<hyperpatch::CondeTorresForm> form,
    std::size_t passes);

  /// The rows as numbers; lists of several ranks, one after the other, make the report of all.
  [[nodiscard]] std::vector<double> Pack() const;
  [[nodiscard]] static ValidityReport Unpack(const std::vector<double>& numbers);

  /// The same of injectivity: the shares of several ranks make that of all.
  [[nodiscard]] static std::vector<double> Pack(const hyperpatch::Injectivity& injectivity);
  [[nodiscard]] static hyperpatch::Injectivity Joined(const std::vector<double>& numbers);

  void SetInjectivity(const hyperpatch::Injectivity& injectivity)
  {
    this->Injectivity = injectivity;
  }

  /// One row per patch, ascending, and one for all.
  void Fill(vtkTable* table) const;
  /// The numbers of the whole model, and all notes.
  void Fill(vtkFieldData* data) const;

private:
  struct Row
  {
    std::size_t Elements = 0;
    std::size_t Valid = 0;
    std::size_t Invalid = 0;
    std::size_t Undecided = 0;
    std::size_t Degenerate = 0;
    /// Whose bounds are further apart than the tolerance: of det J, and of the scaled Jacobian.
    std::size_t Wide = 0;
    std::size_t WideScaled = 0;
    std::size_t CondeTorres = 0;
    int Form = -1;
    bool HasRightHanded = false;
    bool HasLeftHanded = false;
    std::size_t Tested = 0;
    /// Enclosures of the least and greatest det J and of the least scaled Jacobian: low, high.
    std::array<double, 6> Bounds;

    Row();
    void Merge(const Row& other);
    /// 1 or -1, 0 if there are both.
    [[nodiscard]] int Handedness() const;
  };
  /// Numbers of a row, and of a share of injectivity.
  static constexpr std::size_t Size = 19;
  static constexpr std::size_t ShareSize = 18;

  [[nodiscard]] Row All() const;
  [[nodiscard]] static std::string NoteOf(const Row& row);
  [[nodiscard]] std::vector<std::string> NotesOfAll() const;

  std::map<int, Row> Rows;
  std::optional<hyperpatch::Injectivity> Injectivity;
};

#endif
