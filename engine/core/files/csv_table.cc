#include "engine/core/files/csv_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>
#include <utility>

#include "engine/core/check.h"
#include "engine/core/files/file.h"
#include "engine/core/message.h"
#include "engine/core/parse_number.h"
#include "engine/core/suggest.h"

namespace ed3r {
namespace {

std::string_view Trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"') text = text.substr(1, text.size() - 2);
  return text;
}

// Calls action(begin, end) for each cell; delimiters between quotes belong to the cell. False: a quote is not closed.
template <class Action>
bool ForEachCell(std::string_view line, char delimiter, Action action) {
  std::size_t begin = 0;
  bool quoted = false;
  for (std::size_t i = 0; i <= line.size(); ++i) {
    if (i < line.size() && line[i] == '"') quoted = !quoted;
    if (i < line.size() && (quoted || line[i] != delimiter)) continue;
    action(begin, i);
    begin = i + 1;
  }
  return !quoted;
}

// What a cell that is no number may have been meant as, in brackets, or "".
std::string Hint(std::string_view cell) {
  constexpr std::string_view kDigits = "0123456789";
  const std::size_t comma = cell.find(',');
  if (comma != std::string_view::npos && cell.find_first_not_of("0123456789+-,") == std::string_view::npos)
    return " (decimal or thousands commas? a decimal point is wanted, or semicolons between the columns)";
  if (cell.find(':') != std::string_view::npos && cell.find_first_of(kDigits) == 0)
    return " (a date or a time of day? seconds are wanted)";
  return "";
}

}  // namespace

CsvTable CsvTable::Read(const std::string& path, CsvComments comments) {
  return Parse(path, ReadFile(path, kMaxTextBytes), comments);
}

CsvTable CsvTable::Parse(std::string path, std::string text, CsvComments comments, char delimiter) {
  CsvTable table;
  table.path_ = std::move(path);
  table.text_ = std::move(text);
  table.delimiter_ = delimiter;
  ED3R_CHECK(table.text_.size() <= kMaxTextBytes, table.path_);  // cells are found by 32 bits
  const std::string_view all = table.text_;
  int first_blank = 0;
  std::size_t next = all.starts_with("\xEF\xBB\xBF") ? 3 : 0;
  for (int number = 1; next < all.size(); ++number) {
    const std::size_t begin = next, newline = std::min(all.find('\n', begin), all.size());
    next = newline + 1;
    std::string_view line = all.substr(begin, newline - begin);
    if (line.ends_with('\r')) line.remove_suffix(1);
    const bool blank = Trimmed(line).empty();
    if (comments == CsvComments::kHash && (blank || line.starts_with('#'))) continue;
    if (blank) {
      if (first_blank == 0) first_blank = number;
    } else if (first_blank != 0) {
      throw UserError(fmt::format("{}:{}:1: blank line inside the table", table.path_, first_blank));
    } else if (table.columns_.empty()) {
      table.ReadHeader(line, number, comments);
    } else {
      table.ReadRow(begin, line, number);
    }
  }
  if (table.columns_.empty())
    throw UserError(fmt::format("{}:1:1: empty file; a header line was expected", table.path_));
  if (comments == CsvComments::kHash) table.DropBlankRowsAtEnd();
  return table;
}

void CsvTable::ReadHeader(std::string_view line, int number, CsvComments comments) {
  header_line_ = number;
  std::set<std::string, std::less<>> names;
  ForEachCell(line, delimiter_, [&](std::size_t begin, std::size_t end) {
    std::string name(Trimmed(line.substr(begin, end - begin)));
    const auto refuse = [&](const std::string& problem) {
      throw UserError(OneLine(fmt::format("{}:{}:{}: {}", path_, number, begin + 1, problem)));
    };
    if (columns_.size() == kMaxCsvColumns)
      refuse(fmt::format("more columns than are allowed ({})", kMaxCsvColumns));
    if (name.empty() && comments == CsvComments::kNone)
      refuse(fmt::format("column {} has no name", columns_.size() + 1));
    if (name.empty()) name = fmt::format("column {}", columns_.size() + 1);
    if (!names.insert(name).second) refuse(fmt::format("column '{}' is there twice", name));
    columns_.push_back(name);
  });
}

void CsvTable::ReadRow(std::size_t begin, std::string_view line, int number) {
  const std::size_t before = cells_.size();
  const bool closed = ForEachCell(line, delimiter_, [&](std::size_t from, std::size_t to) {
    cells_.push_back({static_cast<std::uint32_t>(begin + from), static_cast<std::uint32_t>(begin + to)});
  });
  if (!closed)
    throw UserError(fmt::format(
        "{}:{}:1: a quotation mark is not closed; cells over several lines are not read", path_, number));
  const std::size_t found = cells_.size() - before;
  if (found != columns_.size())
    throw UserError(fmt::format("{}:{}:{}: {} cells, but the header names {} columns", path_, number,
                                line.size() + 1, found, columns_.size()));
  row_begin_.push_back(begin);
  row_line_.push_back(number);
}

// Spreadsheets save rows whose cells were once filled.
void CsvTable::DropBlankRowsAtEnd() {
  const auto blank = [&](std::size_t row) {
    for (std::size_t column = 0; column < columns_.size(); ++column)
      if (!Cell(row, column).empty()) return false;
    return true;
  };
  while (rows() > 0 && blank(rows() - 1)) {
    cells_.resize(cells_.size() - columns_.size());
    row_begin_.pop_back();
    row_line_.pop_back();
  }
}

std::size_t CsvTable::Column(std::string_view name, std::string_view what) const {
  const auto found = std::find(columns_.begin(), columns_.end(), name);
  if (found != columns_.end()) return static_cast<std::size_t>(found - columns_.begin());
  const std::string nearest = NearestWord(name, columns_);
  throw UserError(OneLine(fmt::format(
      "{}:{}:1: no column '{}' ({}); {}columns: {}", path_, header_line_, name, what,
      nearest.empty() ? "" : fmt::format("did you mean '{}'? ", nearest), fmt::join(columns_, ", "))));
}

std::string_view CsvTable::Cell(std::size_t row, std::size_t column) const {
  const Span& span = cells_[row * columns_.size() + column];
  return Trimmed(std::string_view(text_).substr(span.begin, span.end - span.begin));
}

std::string CsvTable::Text(std::size_t row, std::size_t column) const {
  const std::string_view cell = Cell(row, column);
  std::string text;
  for (std::size_t i = 0; i < cell.size(); ++i) {
    text += cell[i];
    if (cell.substr(i, 2) == "\"\"") ++i;
  }
  return text;
}

double CsvTable::Number(std::size_t row, std::size_t column, double min, double max) const {
  const std::string_view cell = Cell(row, column), number = WithoutPlus(cell);
  double value = 0.0;
  const char* end = number.data() + number.size();
  const auto [stop, error] = std::from_chars(number.data(), end, value);
  if (cell.empty() || error != std::errc() || stop != end || !std::isfinite(value))
    throw UserError(fmt::format("{}'{}' is not a number{}", Where(row, column), cell, Hint(cell)));
  if (value < min || value > max)
    throw UserError(
        fmt::format("{}{} is out of range; allowed: {:g} .. {:g}", Where(row, column), cell, min, max));
  return value;
}

std::string CsvTable::Where(std::size_t row, std::size_t column) const {
  const Span& span = cells_[row * columns_.size() + column];
  return fmt::format("{}:{}:{}: {}: ", path_, row_line_[row], span.begin - row_begin_[row] + 1,
                     columns_[column]);
}

std::string CsvField(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) quoted.append(c == '"' ? 2 : 1, c);
  return quoted + '"';
}

}  // namespace ed3r
