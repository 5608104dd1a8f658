// Tables of other programs as engine/core/csv_table.h reads them.
#pragma once

#include <string>

namespace ed3r::world {

struct DelimitedText {
  std::string text;
  char delimiter = ',';
};

// Its delimiter is told by the first line that is no comment. CR line ends become LF, a first column without a name
// (row numbers of R and pandas) gets one. Bytes keep their places, so that complaints name the right line and column.
// Throws UserError, naming `path`, for UTF-16 and for cells apart by spaces.
DelimitedText ToDelimitedText(const std::string& path, std::string text);

}  // namespace ed3r::world
