// Tables of other programs as engine/core/files/csv_table.h reads them.
#pragma once

#include <string>

namespace ed3r::world {

struct DelimitedText {
  std::string text;
  char delimiter = ',';
};

// Its delimiter is told by the first line that is no comment. CR line ends become LF. Bytes keep their places, so that
// complaints name the right line and column. Throws UserError, naming `path`, for UTF-16, for cells apart by spaces, and
// for a line that begins with # and has as many cells as the header: it may be a row.
DelimitedText ToDelimitedText(const std::string& path, std::string text);

}  // namespace ed3r::world
