#include "studies/flight_logs/read_log.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "engine/core/check.h"
#include "engine/core/files/file.h"
#include "engine/core/message.h"
#include "studies/flight_logs/airdata_log.h"
#include "studies/flight_logs/ardupilot_log.h"
#include "studies/flight_logs/csv_dialect.h"
#include "studies/flight_logs/dataflash.h"
#include "studies/flight_logs/px4_log.h"
#include "studies/flight_logs/ulog.h"

namespace ed3r::flight_logs {

namespace {

bool IsNoText(char c) {
  return static_cast<unsigned char>(c) < ' ' && c != '\t' && c != '\n' && c != '\r' && c != '\f';
}

}  // namespace

LogTable ReadLog(const std::string& path, const LogReading& reading) {
  return ParseLog(path, ReadFile(path, kMaxTextBytes), reading);
}

LogTable ParseLog(const std::string& path, std::string bytes, const LogReading& reading) {
  if (ULog::Is(bytes)) return LogTable(ReadPx4Log(path, bytes, reading));
  if (DataFlashLog::Is(bytes)) return LogTable(ReadArduPilotLog(path, bytes, reading));
  constexpr std::size_t kLook = 4096;
  if (bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF"))
    throw UserError(path + ": UTF-16 text; save it as UTF-8");
  const std::string_view begin = std::string_view(bytes).substr(0, kLook);
  if (std::any_of(begin.begin(), begin.end(), IsNoText))
    throw UserError(path +
                    ": neither PX4 ULog, ArduPilot DataFlash (.bin) nor CSV; known logs: those three, and "
                    "AirData exports");
  if (bytes.starts_with("FMT, 128"))
    throw UserError(path + ": ArduPilot's log as text; give the .bin file that it was made from");
  StandardCsv csv = ToStandardCsv(path, std::move(bytes), reading.skip_bad);
  CsvTable table = CsvTable::Parse(path, std::move(csv.text), CsvComments::kHash, csv.delimiter);
  std::vector<std::string> notes;
  if (csv.comment_rows > 0)
    notes.push_back(OneLine(fmt::format(
        "{}: {} line{} left out as comment{}, though with as many cells as the header: "
        "lines that begin with #, % or //",
        path, csv.comment_rows, csv.comment_rows == 1 ? "" : "s", csv.comment_rows == 1 ? "" : "s")));
  if (!IsAirDataLog(table)) return LogTable(std::move(table), csv.bad, std::move(notes));
  DecodedLog log = ReadAirDataLog(table, reading, csv.bad);
  log.notes.insert(log.notes.end(), notes.begin(), notes.end());
  return LogTable(std::move(log));
}

}  // namespace ed3r::flight_logs
