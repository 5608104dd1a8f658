#include "studies/flight_logs/log_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "engine/core/check.h"
#include "engine/core/message.h"
#include "engine/core/suggest.h"

namespace ed3r::flight_logs {

LogTable::LogTable(DecodedLog log) : log_(std::move(log)) {
  ED3R_CHECK(!log_.columns.empty(), log_.path + ": no columns");
  for (const DecodedColumn& column : log_.columns) {
    ED3R_CHECK(column.values.size() == log_.columns.front().values.size(), column.name);
    names_.push_back(column.name);
  }
  ED3R_CHECK(log_.on_ground.empty() || log_.on_ground.size() == rows(), log_.path + ": on_ground");
  ED3R_CHECK(log_.lines.empty() || log_.lines.size() == rows(), log_.path + ": lines");
}

int LogTable::Line(std::size_t row) const {
  if (csv_) return csv_->Line(row);
  return log_.lines.empty() ? 0 : log_.lines[row];
}

void LogTable::DecimalCommasToPoints(const std::vector<std::string>& columns) {
  if (!csv_) return;
  std::vector<std::size_t> indices;
  for (const std::string& name : columns)
    if (Has(name)) indices.push_back(csv_->Column(name, ""));
  std::sort(indices.begin(), indices.end());
  csv_->DecimalCommasToPoints(indices);
}

bool LogTable::Has(std::string_view name) const {
  return std::find(columns().begin(), columns().end(), name) != columns().end();
}

std::size_t LogTable::Column(std::string_view name, std::string_view what) const {
  if (csv_) return csv_->Column(name, what);
  const auto found = std::find(names_.begin(), names_.end(), name);
  if (found != names_.end()) return static_cast<std::size_t>(found - names_.begin());
  const std::string nearest = NearestWord(name, names_);
  throw UserError(OneLine(fmt::format(
      "{}: no column '{}' ({}); {}columns of this log: {}", path(), name, what,
      nearest.empty() ? "" : fmt::format("did you mean '{}'? ", nearest), fmt::join(names_, ", "))));
}

std::string LogTable::Cell(std::size_t row, std::size_t column) const {
  if (csv_) return std::string(csv_->Cell(row, column));
  return fmt::format("{:g}", log_.columns[column].values[row]);
}

double LogTable::Number(std::size_t row, std::size_t column, double min, double max) const {
  if (csv_) return csv_->Number(row, column, min, max);
  const double value = log_.columns[column].values[row];
  if (!std::isfinite(value)) throw UserError(fmt::format("{}there is no number", Where(row, column)));
  if (value < min || value > max)
    throw UserError(
        fmt::format("{}{:g} is out of range; allowed: {:g} .. {:g}", Where(row, column), value, min, max));
  return value;
}

std::string LogTable::Where(std::size_t row, std::size_t column) const {
  if (csv_) return csv_->Where(row, column);
  return fmt::format("{}{}: ", WhereRow(row), names_[column]);
}

std::string LogTable::WhereRow(std::size_t row) const {
  if (Line(row) > 0) return fmt::format("{}:{}:1: ", path(), Line(row));
  return fmt::format("{}: at {:.3f} s: ", path(), log_.columns.front().values[row]);
}

}  // namespace ed3r::flight_logs
