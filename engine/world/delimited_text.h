// Tables of other programs as the CSV that engine/core/csv_table.h reads.
#pragma once

#include <string>

namespace ed3r::world {

struct CommaSeparated {
  std::string text;
  bool decimal_commas = false;  // quoted numbers may have them; those without quotes were changed
};

// Told by the first line that is no comment: cells apart by semicolons or tabs become apart by commas, their decimal
// commas points, CR line ends become LF, a first column without a name (row numbers of R and pandas) gets one. Bytes
// keep their places, so that complaints name the right line and column. Throws UserError, naming `path`, for UTF-16 and
// for cells apart by spaces.
CommaSeparated ToCommaSeparated(const std::string& path, std::string text);

}  // namespace ed3r::world
