// CsvTable::DecimalCommasToPoints.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <string_view>
#include <system_error>
#include <vector>

#include "engine/core/check.h"
#include "engine/core/files/csv_table.h"
#include "engine/core/message.h"
#include "engine/core/parse_number.h"

namespace ed3r {
namespace {

constexpr std::string_view kDigits = "0123456789";

bool IsNumber(std::string_view text) {
  text = WithoutPlus(text);
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

// The numbers of a table that have a comma, and what tells whether it is a decimal one.
class NumberCells {
 public:
  explicit NumberCells(const CsvTable& table) : table_(table) {}

  void Look(std::size_t row, std::size_t column) {
    const std::string_view text = table_.Cell(row, column);
    const std::size_t comma = text.find(',');
    if (comma == std::string_view::npos) {
      if (!point_ && text.find('.') != std::string_view::npos && IsNumber(text)) point_ = {row, column};
      return;
    }
    if (comma + 1 == text.size()) return;  // a number that is cut tells nothing of the others
    std::string with_point(text);
    with_point[comma] = '.';
    const bool thousands = MayBeThousands(text);
    if (!thousands && !IsNumber(with_point)) return;
    if (!comma_) comma_ = {row, column};
    commas_.push_back(text.substr(comma, 1));
    sure_ = sure_ || !thousands;
  }

  // Each within the table's text; the first of each number.
  const std::vector<std::string_view>& DecimalCommas() const {
    if (comma_ && point_)
      Fail(
          fmt::format("'{}' here and '{}' in line {}: a decimal comma and a decimal point, or thousands? "
                      "allowed: one decimal sign in the columns that are read, and none for thousands",
                      Text(*comma_), Text(*point_), table_.Line(point_->row)));
    if (comma_ && !sure_)
      Fail(fmt::format(
          "'{}': every number with a comma has three digits after it in the columns that are "
          "read: decimals or thousands? "
          "allowed: no sign for thousands (1234), and decimal points where all have three decimals",
          Text(*comma_)));
    return commas_;
  }

 private:
  struct Place {
    std::size_t row, column;
  };

  std::string_view Text(const Place& place) const { return table_.Cell(place.row, place.column); }

  [[noreturn]] void Fail(const std::string& what) const {
    throw UserError(OneLine(table_.Where(comma_->row, comma_->column) + what));
  }

  const CsvTable& table_;
  std::vector<std::string_view> commas_;
  std::optional<Place> comma_, point_;  // the first number with either
  bool sure_ = false;                   // that commas are decimal ones
};

}  // namespace

void CsvTable::DecimalCommasToPoints(const std::vector<std::size_t>& columns) {
  if (delimiter_ == ',') return;
  NumberCells cells(*this);
  for (std::size_t row = 0; row < rows(); ++row)
    for (const std::size_t column : columns) cells.Look(row, column);
  for (const std::string_view comma : cells.DecimalCommas())
    text_[static_cast<std::size_t>(comma.data() - text_.data())] = '.';
}

}  // namespace ed3r
