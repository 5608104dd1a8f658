// What GDAL does not check in a text grid (ESRI ASCII).
#pragma once

#include <string>
#include <string_view>

namespace ed3r::world {

// What is wrong with its text, "" for nothing: words and numbers that GDAL would take for others, a key of the header that
// is there twice, more or fewer heights than `columns` x `rows`, `columns` lines of `rows` heights. `whole_numbers`: GDAL reads it
// into 32 bits.
std::string WhyTextGridIsWrong(std::string_view text, int columns, int rows, bool whole_numbers);

}  // namespace ed3r::world
