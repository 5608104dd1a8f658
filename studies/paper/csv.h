// Comma-separated text (RFC 4180): fields with commas, quotes or line ends stand in double quotes, a quote in
// them is doubled.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace ed3r {

using CsvRow = std::vector<std::string>;

// Rows of `text`; lines end with LF or CRLF, the last one with or without. Throws UserError
// "name:line: ..." for a quote that is not closed or followed by text, and for a row whose number of fields
// differs from the first row's.
std::vector<CsvRow> ParseCsv(std::string_view text, std::string_view name);

// One field, quoted where it must be.
std::string CsvField(std::string_view text);

}  // namespace ed3r
