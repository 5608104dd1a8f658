// Flight telemetry, read and checked: what the estimation sees.
#pragma once

#include <string>
#include <vector>

#include "studies/fit/log_format.h"
#include "studies/flight_logs/log_table.h"

namespace ed3r::fit {

// Why a row does not count for energies: single samples that no multirotor in flight can draw.
enum class RowQuality : unsigned char { kGood, kDropOut, kSpike };

struct FlightRow {
  double time_s = 0.0;
  double power_w = 0.0;
  double airspeed_mps = 0.0;  // horizontal
  double climb_mps = 0.0;     // up positive
  double density_kgm3 = 0.0;
  double mass_kg = 0.0;
  RowQuality quality = RowQuality::kGood;
  std::size_t source_row = 0;  // of Flight::table
};

// Rows in strictly increasing time.
struct Flight {
  std::string id;  // "file" or "file#flight"
  std::vector<FlightRow> rows;
  std::size_t table = 0;  // index of the log that it came from

  double MassKg() const { return rows.front().mass_kg; }
};

struct FlightLog {
  std::vector<std::string> files;
  LogFormat format;
  std::vector<Flight> flights;
  int rows = 0;
  int rows_on_ground = 0;  // not in flight (LogFormat::in_flight)
  int drop_outs = 0;       // power below 1/4 of the flight's median
  int spikes = 0;          // power above twice the flight's median
  int short_flights = 0;   // flights of fewer than kMinFlightRows rows, left out
  int hover_rows = 0;
  int bad_rows = 0;                // left out because they could not be read (LogReading::skip_bad)
  std::string first_bad;           // the message of the first of them
  std::vector<std::string> notes;  // of the readers of raw logs
  // Mean over flights of |climb integrated from the recorded climb rate - climb by altitude|, where a log has
  // both: metres that the recorded climb rate drifts in a flight. NaN where it has not.
  double climb_drift_m = 0.0;
};

inline constexpr int kMinFlightRows = 20;
inline constexpr int kMinLogRows = 200;
inline constexpr double kMinLogS = 30.0;
inline constexpr int kMinHoverRows = 20;
inline constexpr double kMaxNoPowerShare = 0.05;  // of the rows in flight whose power is 0 or below

// Logs to fit must be long enough and hover; logs to evaluate need one flight.
enum class LogUse { kFit, kEvaluate };

// Logs as one. Throws UserError naming file, line and column: a column that is missing, text in a number, values out of
// range, time that does not increase (with skip_bad such rows are left out and counted), units that cannot be
// (unit_check.h), flights that are not contiguous, rows on the ground that the format does not leave out (ground_check.h), power that was not measured, too few rows, no hovering.
FlightLog MakeFlightLog(const std::vector<flight_logs::LogTable>& tables, const LogFormat& format,
                        LogUse use = LogUse::kFit, const flight_logs::LogReading& reading = {});

bool IsHover(const FlightRow& row, const LogFormat& format);

// Seconds between neighbouring rows above which nothing is integrated.
inline constexpr double kMaxGapS = 2.0;

}  // namespace ed3r::fit
