// Decimal commas of tables whose cells are apart by semicolons or tabs.
#pragma once

#include <cstddef>
#include <string>

namespace ed3r {

// In the cells from byte `begin` of `text` on that are numbers, in quotes or not, decimal commas become points; words keep
// theirs, and so do lines that begin with #. Bytes keep their places.
// Throws UserError with file:line:column where thousands may be meant: numbers with points beside numbers with commas, or
// three digits after every comma (0,125 and 1234,125 are no thousands).
void DecimalCommasToPoints(const std::string& path, std::string& text, std::size_t begin, char delimiter);

}  // namespace ed3r
