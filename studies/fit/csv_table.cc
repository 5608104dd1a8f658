#include "studies/fit/csv_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <sstream>
#include <utility>

#include "engine/core/check.h"
#include "engine/core/suggest.h"

namespace ed3r {
namespace {

std::string_view Trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  if (text.size() >= 2 && text.front() == '"' && text.back() == '"') text = text.substr(1, text.size() - 2);
  return text;
}

// Calls action(begin, end) for each comma-separated cell; commas between quotes belong to the cell.
template <class Action>
void ForEachCell(std::string_view line, Action action) {
  std::size_t begin = 0;
  bool quoted = false;
  for (std::size_t i = 0; i <= line.size(); ++i) {
    if (i < line.size() && line[i] == '"') quoted = !quoted;
    if (i < line.size() && (quoted || line[i] != ',')) continue;
    action(begin, i);
    begin = i + 1;
  }
}

}  // namespace

CsvTable CsvTable::Read(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw UserError(fmt::format("{}: cannot be read", path));
  std::ostringstream text;
  text << file.rdbuf();
  return Parse(path, std::move(text).str());
}

CsvTable CsvTable::Parse(std::string path, std::string text) {
  CsvTable table;
  table.path_ = std::move(path);
  table.text_ = std::move(text);
  const std::string_view all = table.text_;
  std::size_t begin = all.starts_with("\xEF\xBB\xBF") ? 3 : 0;
  int first_blank = 0;
  for (int number = 1; begin < all.size(); ++number) {
    const std::size_t newline = std::min(all.find('\n', begin), all.size());
    std::string_view line = all.substr(begin, newline - begin);
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (Trimmed(line).empty()) {
      if (first_blank == 0) first_blank = number;
    } else if (first_blank != 0) {
      throw UserError(fmt::format("{}:{}:1: blank line inside the table", table.path_, first_blank));
    } else if (table.columns_.empty()) {
      table.ReadHeader(line);
    } else {
      table.ReadRow(begin, line, number);
    }
    begin = newline + 1;
  }
  if (table.columns_.empty())
    throw UserError(fmt::format("{}:1:1: empty file; a header line was expected", table.path_));
  return table;
}

void CsvTable::ReadHeader(std::string_view line) {
  ForEachCell(line, [&](std::size_t begin, std::size_t end) {
    const std::string name(Trimmed(line.substr(begin, end - begin)));
    if (name.empty())
      throw UserError(fmt::format("{}:1:{}: column {} has no name", path_, begin + 1, columns_.size() + 1));
    if (std::find(columns_.begin(), columns_.end(), name) != columns_.end())
      throw UserError(fmt::format("{}:1:{}: column '{}' is there twice", path_, begin + 1, name));
    columns_.push_back(name);
  });
}

void CsvTable::ReadRow(std::size_t begin, std::string_view line, int number) {
  const std::size_t before = cells_.size();
  ForEachCell(line, [&](std::size_t from, std::size_t to) { cells_.push_back({begin + from, begin + to}); });
  const std::size_t found = cells_.size() - before;
  if (found != columns_.size())
    throw UserError(fmt::format("{}:{}:{}: {} cells, but the header names {} columns", path_, number,
                                line.size() + 1, found, columns_.size()));
  row_begin_.push_back(begin);
  row_line_.push_back(number);
}

std::size_t CsvTable::Column(std::string_view name, std::string_view what) const {
  const auto found = std::find(columns_.begin(), columns_.end(), name);
  if (found != columns_.end()) return static_cast<std::size_t>(found - columns_.begin());
  const std::string nearest = NearestWord(name, columns_);
  throw UserError(fmt::format("{}:1:1: no column '{}' ({}); {}columns: {}", path_, name, what,
                              nearest.empty() ? "" : fmt::format("did you mean '{}'? ", nearest),
                              fmt::join(columns_, ", ")));
}

std::string_view CsvTable::Cell(std::size_t row, std::size_t column) const {
  const Span& span = cells_[row * columns_.size() + column];
  return Trimmed(std::string_view(text_).substr(span.begin, span.end - span.begin));
}

double CsvTable::Number(std::size_t row, std::size_t column, double min, double max) const {
  const std::string_view cell = Cell(row, column);
  double value = 0.0;
  const char* end = cell.data() + cell.size();
  const char* begin = cell.data() + (cell.starts_with('+') ? 1 : 0);
  const auto [stop, error] = std::from_chars(begin, end, value);
  if (cell.empty() || error != std::errc() || stop != end || !std::isfinite(value))
    throw UserError(fmt::format("{}'{}' is not a number", Where(row, column), cell));
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

}  // namespace ed3r
