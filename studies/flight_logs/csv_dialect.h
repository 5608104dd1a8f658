// CSV as people have it, to CSV as CsvTable reads it.
//
// Columns may be separated by semicolons or tabs, lines may end in CR, and lines that begin with #, % or // or that say sep=; are comments. Characters are replaced one for one, so that lines and columns
// in messages are those of the file.
#pragma once

#include <string>

namespace ed3r::flight_logs {

struct StandardCsv {
  std::string text;
  char delimiter = ',';
  int bad = 0;           // rows left out
  int comment_rows = 0;  // comments with as many cells as the header: they may be rows
};

// Throws UserError: no header line, columns that nothing separates, decimal commas between commas. With skip_bad, rows with another number of cells than the header become
// comments and are counted.
StandardCsv ToStandardCsv(const std::string& path, std::string text, bool skip_bad);

}  // namespace ed3r::flight_logs
