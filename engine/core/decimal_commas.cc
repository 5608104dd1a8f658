#include "engine/core/decimal_commas.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <string_view>
#include <system_error>
#include <vector>

#include "engine/core/check.h"
#include "engine/core/message.h"

namespace ed3r {
namespace {

constexpr std::string_view kDigits = "0123456789";

bool IsNumber(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0.0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && stop == text.data() + text.size();
}

// 1,234 and -12,345,678, but not 0,125 nor 1234,125.
bool MayBeThousands(std::string_view number) {
  if (number.starts_with('-') || number.starts_with('+')) number.remove_prefix(1);
  const std::size_t first = std::min(number.find(','), number.size());
  if (first == 0 || first > 3 || number.front() == '0' || first == number.size()) return false;
  for (std::size_t comma = first; comma < number.size(); comma += 4)
    if (number[comma] != ',' || comma + 4 > number.size() ||
        number.substr(comma + 1, 3).find_first_not_of(kDigits) != std::string_view::npos)
      return false;
  return true;
}

class NumberCells {
 public:
  NumberCells(const std::string& path, std::string& text, char delimiter)
      : path_(path), text_(text), delimiter_(delimiter) {}

  void Run(std::size_t begin) {
    while (begin < text_.size()) {
      const std::size_t end = std::min(text_.find('\n', begin), text_.size());
      if (text_[begin] != '#') ReadLine(begin, end);
      begin = end + 1;
    }
    if (commas_.empty()) return;
    if (point_.size != 0)
      Fail(
          fmt::format("'{}' here and '{}' in line {}: a decimal comma and a decimal point, or thousands? "
                      "allowed: one decimal sign in the whole table, and none for thousands",
                      Number(comma_), Number(point_), LineOf(point_.begin)));
    if (!sure_)
      Fail(fmt::format(
          "'{}': every number with a comma has three digits after it: decimals or thousands? "
          "allowed: no sign for thousands (1234), and decimal points where all have three decimals",
          Number(comma_)));
    for (const std::size_t comma : commas_) text_[comma] = '.';
  }

 private:
  struct Cell {
    std::size_t begin = 0, size = 0;
  };

  void ReadLine(std::size_t begin, std::size_t end) {
    bool quoted = false;
    for (std::size_t i = begin; i <= end; ++i) {
      if (i < end && text_[i] == '"') quoted = !quoted;
      if (i < end && (quoted || text_[i] != delimiter_)) continue;
      ReadCell(begin, i);
      begin = i + 1;
    }
  }

  void ReadCell(std::size_t begin, std::size_t end) {
    constexpr std::string_view kAround = " \t\r\"";
    while (begin < end && kAround.find(text_[begin]) != std::string_view::npos) ++begin;
    while (begin < end && kAround.find(text_[end - 1]) != std::string_view::npos) --end;
    const Cell cell{begin, end - begin};
    const std::string_view text = Number(cell);
    const std::size_t comma = text.find(',');
    if (comma == std::string_view::npos) {
      if (point_.size == 0 && text.find('.') != std::string_view::npos && IsNumber(text)) point_ = cell;
      return;
    }
    std::string with_point(text);
    with_point[comma] = '.';
    const bool thousands = MayBeThousands(text);
    if (!thousands && !IsNumber(with_point)) return;
    if (commas_.empty()) comma_ = cell;
    commas_.push_back(begin + comma);
    sure_ = sure_ || !thousands;
  }

  std::string_view Number(const Cell& cell) const {
    return std::string_view(text_).substr(cell.begin, cell.size);
  }

  std::ptrdiff_t LineOf(std::size_t place) const {
    return 1 + std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(place), '\n');
  }

  [[noreturn]] void Fail(const std::string& what) const {
    const std::size_t line = comma_.begin == 0 ? 0 : text_.rfind('\n', comma_.begin - 1) + 1;
    throw UserError(
        OneLine(fmt::format("{}:{}:{}: {}", path_, LineOf(comma_.begin), comma_.begin - line + 1, what)));
  }

  const std::string& path_;
  std::string& text_;
  char delimiter_;
  std::vector<std::size_t> commas_;  // of numbers, the first of each
  Cell comma_, point_;               // the first number with either
  bool sure_ = false;                // that commas are decimal ones
};

}  // namespace

void DecimalCommasToPoints(const std::string& path, std::string& text, std::size_t begin, char delimiter) {
  NumberCells(path, text, delimiter).Run(begin);
}

}  // namespace ed3r
