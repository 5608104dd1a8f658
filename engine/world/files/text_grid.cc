#include "engine/world/files/text_grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <optional>
#include <set>

#include "engine/core/parse_number.h"

namespace ed3r::world {
namespace {

std::optional<double> GridNumber(std::string_view text) {
  const std::string_view word = WithoutPlus(text);
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || std::isinf(value)) return std::nullopt;
  return value;
}

// In lower case, or "".
std::string HeaderName(std::string_view word) {
  constexpr std::array<std::string_view, 10> kNames = {"ncols",     "nrows",       "xllcorner", "yllcorner",
                                                       "xllcenter", "yllcenter",   "cellsize",  "dx",
                                                       "dy",        "nodata_value"};
  std::string lower(word);
  std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return std::tolower(c); });
  return std::find(kNames.begin(), kNames.end(), lower) != kNames.end() ? lower : "";
}

class TextGrid {
 public:
  TextGrid(int columns, int rows, const KeepHeight& keep)
      : columns_(static_cast<std::size_t>(columns)), rows_(static_cast<std::size_t>(rows)), keep_(keep) {}

  std::string Read(std::string_view text) {
    constexpr std::string_view kSpace = " \t\r\n";
    for (std::size_t begin = 0; begin < text.size();) {
      if (text[begin] == '\n') ++line_, EndLine();
      if (kSpace.find(text[begin]) != std::string_view::npos) {
        ++begin;
        continue;
      }
      const std::size_t end = std::min(text.find_first_of(kSpace, begin), text.size());
      if (const std::string problem = Hear(text.substr(begin, end - begin)); !problem.empty())
        return fmt::format("line {}: {}", line_, problem);
      begin = end;
    }
    EndLine();
    return WhyOtherHeights();
  }

 private:
  // GDAL, which reads the header, takes the first of two keys, and what is left of a count in 32 bits.
  std::string Hear(std::string_view word) {
    if (const std::string name = HeaderName(word); !name.empty()) {
      if (heights_ + in_line_ > 0) return fmt::format("'{}' stands below heights; put it above them", word);
      if (!names_.insert(name).second) return fmt::format("'{}' is there twice; leave one out", word);
      if (names_.contains("cellsize") && (names_.contains("dx") || names_.contains("dy")))
        return "'cellsize' beside 'dx' or 'dy'; leave one out";
      after_name_ = name;
      return "";
    }
    const std::optional<double> value = GridNumber(word);
    if (!value) return fmt::format("'{}' is no number", word);
    if (after_name_.empty()) {
      keep_(heights_ + in_line_++, *value);
      return "";
    }
    constexpr double kFarthest = 1e9;  // of any coordinate system's metres, feet or degrees
    if (after_name_.starts_with("xll") || after_name_.starts_with("yll"))
      if (!(std::abs(*value) <= kFarthest))
        return fmt::format("{} is '{}'; allowed: {} .. {}", after_name_, word, -kFarthest, kFarthest);
    const bool counts = (after_name_ == "ncols" && *value != static_cast<double>(columns_)) ||
                        (after_name_ == "nrows" && *value != static_cast<double>(rows_));
    if (counts) return fmt::format("{} is '{}'; allowed: a whole number of 32 bits", after_name_, word);
    after_name_.clear();
    return "";
  }

  void EndLine() {
    if (in_line_ != 0 && in_first_line_ == 0) in_first_line_ = in_line_;
    alike_ = alike_ && (in_line_ == 0 || in_line_ == in_first_line_);
    heights_ += in_line_;
    in_line_ = 0;
  }

  // Numbers are taken as they come: where there are more or fewer than the header says, rows are shifted. Lines need not be
  // rows, but a line for each column is a header whose two numbers are exchanged.
  std::string WhyOtherHeights() const {
    const std::size_t cells = columns_ * rows_;
    if (heights_ != cells)
      return fmt::format(
          "{} heights{}, but its header says ncols {} and nrows {}, which makes {}; correct the header, or "
          "bring the whole file",
          heights_, alike_ ? fmt::format(", {} a line", in_first_line_) : "", columns_, rows_, cells);
    if (!alike_ || in_first_line_ != rows_ || in_first_line_ == columns_) return "";
    return fmt::format(
        "{0} lines of {1} heights each, but its header says ncols {0} and nrows {1}; exchange the two, or "
        "bring the lines to {0} heights",
        columns_, rows_);
  }

  std::size_t columns_, rows_;
  const KeepHeight& keep_;
  std::set<std::string> names_;
  std::string after_name_;  // of the header: its value comes next
  std::size_t heights_ = 0, in_line_ = 0, in_first_line_ = 0, line_ = 1;
  bool alike_ = true;
};

}  // namespace

std::string ReadTextGrid(std::string_view text, int columns, int rows, const KeepHeight& keep) {
  return TextGrid(columns, rows, keep).Read(text);
}

}  // namespace ed3r::world
