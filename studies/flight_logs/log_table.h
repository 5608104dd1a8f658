// A flight log as a table of one clock: what the fit reads, whatever file it came from.
//
// Either a CSV file as it is, or columns that a reader decoded (px4_log.h, ardupilot_log.h, airdata_log.h): SI units,
// climb upwards positive.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/files/csv_table.h"

namespace ed3r::flight_logs {

enum class LogKind { kCsv, kPx4, kArduPilot, kAirData };

// How a user wants logs to be read.
struct LogReading {
  // Leaves out rows that cannot be read, and counts them, in place of refusing the file.
  bool skip_bad = false;
  // Of raw logs with several batteries: the one that counts, or kAllBatteries: the sum of their powers.
  std::optional<int> battery = {};
};
inline constexpr int kAllBatteries = -1;
inline constexpr double kMaxBadShare =
    0.1;  // of the rows of a table, or a raw log's bytes, that skip_bad may leave out

struct DecodedColumn {
  std::string name;
  std::vector<double> values;  // all columns of a log have one length
};

struct DecodedLog {
  std::string path;
  LogKind kind = LogKind::kCsv;
  std::vector<DecodedColumn> columns;  // the first is time_s, increasing
  std::vector<bool> on_ground;         // per row; empty where the log does not tell
  bool ground_by_height = false;   // on_ground is a guess by the height alone, no state of the autopilot's
  std::vector<int> lines;          // per row, where the file has lines
  std::vector<std::string> notes;  // for the report: clock, sources, what was left out
  int bad = 0;                     // rows or messages left out as unreadable (LogReading::skip_bad)
};

// Once made, and its decimal commas read, nothing changes it; share it between threads freely.
class LogTable {
 public:
  LogTable(CsvTable table)
      : csv_(std::move(table)) {}  // NOLINT(google-explicit-constructor): a CSV file is a log
  // bad: rows that were left out before the table was made.
  LogTable(CsvTable table, int bad, std::vector<std::string> notes) : csv_(std::move(table)), bad_(bad) {
    log_.notes = std::move(notes);
  }
  explicit LogTable(DecodedLog log);

  LogKind kind() const { return csv_ ? LogKind::kCsv : log_.kind; }
  const std::string& path() const { return csv_ ? csv_->path() : log_.path; }
  std::size_t rows() const { return csv_ ? csv_->rows() : log_.columns.front().values.size(); }
  const std::vector<std::string>& columns() const { return csv_ ? csv_->columns() : names_; }
  const std::vector<std::string>& notes() const { return log_.notes; }
  int bad() const { return csv_ ? bad_ : log_.bad; }
  // Whether the autopilot said which rows are on the ground.
  bool TellsGround() const { return !log_.on_ground.empty() && !log_.ground_by_height; }
  bool OnGround(std::size_t row) const { return !log_.on_ground.empty() && log_.on_ground[row]; }
  int Line(std::size_t row) const;  // 0 where the file has no lines

  // Of a CSV file: CsvTable::DecimalCommasToPoints for those of these columns that are there.
  void DecimalCommasToPoints(const std::vector<std::string>& columns);

  bool Has(std::string_view name) const;
  // As in CsvTable; a decoded value that is not there is no number.
  std::size_t Column(std::string_view name, std::string_view what) const;
  std::string Cell(std::size_t row, std::size_t column) const;
  double Number(std::size_t row, std::size_t column, double min, double max) const;

  // "path:line:character: column: " or "path: at 12.3 s: column: "
  std::string Where(std::size_t row, std::size_t column) const;
  // "path:line:1: " or "path: at 12.3 s: "
  std::string WhereRow(std::size_t row) const;

 private:
  std::optional<CsvTable> csv_;
  int bad_ = 0;
  DecodedLog log_;
  std::vector<std::string> names_;
};

}  // namespace ed3r::flight_logs
