// The table of a stem map: which column holds what, in which unit, and its cells in metres (stem_map.h says what is read).
// Errors: UserError. Threads: immutable once read.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "engine/core/files/csv_table.h"
#include "engine/world/files/delimited_text.h"
#include "engine/world/files/stem_map_spec.h"

namespace ed3r::world {

enum StemQuantity { kX, kY, kDiameter, kHeight, kCrownDepth, kCrownRadius, kStemQuantities };

struct StemColumn {
  std::string_view name;
  StemQuantity quantity;
  double per_m;  // of the column's numbers
  std::string_view unit;
  bool base = false;  // the crown's base, not its depth
};

class StemTable {
 public:
  // `spec` must outlive it. Refuses a column that is missing and may not be estimated.
  explicit StemTable(const StemMapSpec& spec);

  std::size_t Rows() const { return table_.rows(); }
  int Line(std::size_t row) const { return table_.Line(row); }

  // Of a column that is there: its name in the file, its unit.
  const std::string& Header(StemQuantity quantity) const { return table_.columns()[where_[quantity].index]; }
  std::string_view Unit(StemQuantity quantity) const { return where_[quantity].column->unit; }

  // In m; none where it is missing and is to be estimated.
  std::optional<double> Number(std::size_t row, StemQuantity quantity) const;
  std::optional<double> CrownDepth(std::size_t row,
                                   double height_m) const;  // no deeper than the tree is high

  std::optional<double> CrownRadius(std::size_t row,
                                    double height_m) const;  // no wider than that, shrubs apart

  // Names the columns that are degrees, and the command that makes metres of them.
  [[noreturn]] void FailDegrees(const std::string& longitude, const std::string& latitude) const;

 private:
  struct Where {
    const StemColumn* column = nullptr;  // none: there is no such column
    std::size_t index = 0;
  };

  StemTable(const StemMapSpec& spec, DelimitedText file);
  void FindMapped(const std::string& name, const std::string& header);
  void CheckUnit(const StemColumn& column, const std::string& header) const;
  void FindByName(const StemColumn& column);
  void CheckAbsence(StemQuantity quantity) const;
  void CheckOneMeaning() const;
  bool HasNegativePlaces(StemQuantity quantity) const;
  std::string HeaderAmong(std::string_view words) const;
  double FirstNumber(const std::string& header) const;
  std::optional<double> Number(std::size_t row, StemQuantity quantity, double max_m) const;

  const StemMapSpec& spec_;
  CsvTable table_;
  std::array<Where, kStemQuantities> where_{};
  std::array<bool, 2> negative_places_{};  // of kX and kY, marks apart
};

}  // namespace ed3r::world
