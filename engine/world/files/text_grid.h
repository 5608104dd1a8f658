// The heights of a text grid (ESRI ASCII), whose header GDAL reads. GDAL's own heights are not taken: it begins them at the
// first line without a letter, and so behind a row that begins with nan, and makes 0 of what it does not understand.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>

namespace ed3r::world {

// A height, NaN where the text has nan, and which one it is, counted along rows from the top.
using KeepHeight = std::function<void(std::size_t cell, double height)>;

// Calls `keep` for each height. What is wrong with the text, "" for nothing: words that are no numbers, a key of the header
// that is there twice or stands below heights, more or fewer heights than `columns` x `rows`, `columns` lines of `rows` heights.
std::string ReadTextGrid(std::string_view text, int columns, int rows, const KeepHeight& keep);

}  // namespace ed3r::world
