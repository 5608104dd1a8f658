// A written table back as rows of text, its header first.
#pragma once

#include <string>
#include <vector>

#include "engine/core/files/csv_table.h"

namespace ed3r {

using CsvRow = std::vector<std::string>;

inline std::vector<CsvRow> CsvRows(const std::string& text) {
  const CsvTable table = CsvTable::Parse("table.csv", text);
  std::vector<CsvRow> rows = {table.columns()};
  for (std::size_t r = 0; r < table.rows(); ++r) {
    CsvRow& row = rows.emplace_back();
    for (std::size_t c = 0; c < table.columns().size(); ++c) row.push_back(table.Text(r, c));
  }
  return rows;
}

}  // namespace ed3r
