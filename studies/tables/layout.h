// Text in columns, for a terminal. Widths count characters, not bytes (UTF-8; every character that the tables
// use is one cell wide).
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace ed3r::tables {

constexpr int kTerminalWidth = 120;

int DisplayWidth(std::string_view utf8);

enum class Align { kLeft, kRight, kCentre };

// `text` padded with spaces to `width`; longer text is left as it is.
std::string Pad(std::string_view text, int width, Align align);

// A left-aligned column in which texts do not run into the next one: as wide as the longest and two spaces, at least `least`, at
// most kWidestColumn; a text that is longer pushes its own line aside.
class TextColumn {
 public:
  static constexpr int kWidestColumn = 60;
  TextColumn(std::span<const std::string> texts, int least);
  std::string operator()(std::string_view text) const;

 private:
  int width_;
};

// `count` times the character "─".
std::string Rule(int count);

// Lines of at most `width` characters, broken at spaces; the first starts with `first`, the others with as
// many spaces. A single longer word is not broken. Ends with a line end.
std::string Wrap(std::string_view text, std::string_view first, int width);

// `text` without the spaces at the ends of its lines.
std::string TrimLineEnds(std::string_view text);

// "12.34" at the given number of decimals, fewer where the number would take more than five characters
// ("139.9"); "–" for NaN.
std::string FormatValue(double value, int decimals);

}  // namespace ed3r::tables
