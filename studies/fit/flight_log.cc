#include "studies/fit/flight_log.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <limits>
#include <set>

#include "engine/core/check.h"
#include "engine/core/files/utf8.h"
#include "studies/fit/ground_check.h"
#include "studies/fit/unit_check.h"

namespace ed3r::fit {
namespace {

constexpr double kDropOutShare = 0.25;
constexpr double kSpikeShare = 2.0;
constexpr double kMostRows = 0.9;

struct Range {
  double min, max;
};

// Reads one meaning of the format from a table, with its unit factor; absent meanings read as a constant.
class Source {
 public:
  Source(const flight_logs::LogTable& table, const LogFormat& format, const std::string& meaning, Range range,
         double otherwise = 0.0)
      : table_(table), range_(range), otherwise_(otherwise) {
    if (!format.Has(meaning)) return;
    column_ = table.Column(format.columns.at(meaning), meaning);
    there_ = true;
    if (const auto unit = format.units.find(meaning); unit != format.units.end()) factor_ = unit->second;
  }

  bool there() const { return there_; }
  std::size_t column() const { return column_; }

  double operator()(std::size_t row) const {
    if (!there_) return otherwise_;
    // The range is in our unit; the message shows it in the log's.
    const double a = range_.min / factor_, b = range_.max / factor_;
    return factor_ * table_.Number(row, column_, std::min(a, b), std::max(a, b));
  }

 private:
  const flight_logs::LogTable& table_;
  Range range_;
  double otherwise_;
  double factor_ = 1.0;
  std::size_t column_ = 0;
  bool there_ = false;
};

std::string Lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

struct RawFlight {
  std::string id;
  std::vector<FlightRow> rows;
  std::vector<double> altitude_m;
  std::vector<double> recorded_climb_mps;
  std::vector<bool> in_flight;
};

// All flights of one table, rows on the ground included.
class TableReader {
 public:
  TableReader(const flight_logs::LogTable& table, const LogFormat& format,
              const flight_logs::LogReading& reading)
      : table_(table),
        format_(format),
        reading_(reading),
        time_(table, format, "time_s", {-1e12, 1e12}),
        power_(table, format, "power_w", {-1e5, 1e5}),
        voltage_(table, format, "voltage_v", {0, 1e3}),
        current_(table, format, "current_a", {-1e3, 1e3}),
        airspeed_(table, format, format.Has("airspeed_mps") ? "airspeed_mps" : "ground_speed_mps", {0, 60}),
        climb_(table, format, "climb_mps", {-40, 40}),
        altitude_(table, format, "altitude_m", {-1000, 20000}),
        density_(table, format, "air_density_kgm3", {0.3, 2}, format.air_density_kgm3),
        payload_(table, format, "payload_kg", {0, 500}),
        mass_(table, format, "mass_kg", {0.05, 500}) {
    for (const auto& [name, condition] : format.in_flight)
      gates_.push_back({table.Column(name, "in_flight"), condition});
    if (format.Has("flight")) flight_column_ = table.Column(format.columns.at("flight"), "flight");
  }

  std::vector<RawFlight> Read() {
    const std::string file = std::filesystem::path(table_.path()).filename().string();
    std::vector<RawFlight> flights;
    std::set<std::string> seen;
    for (std::size_t row = 0; row < table_.rows(); ++row) {
      const std::string id =
          format_.Has("flight") ? fmt::format("{}#{}", file, table_.Cell(row, flight_column_)) : file;
      if (!IsUtf8(id)) throw UserError(fmt::format("{}not UTF-8 text", table_.Where(row, flight_column_)));
      if (flights.empty() || flights.back().id != id) {
        if (!seen.insert(id).second)
          throw UserError(
              fmt::format("{}flight '{}' goes on after another flight; rows of a flight must be together",
                          table_.Where(row, flight_column_), table_.Cell(row, flight_column_)));
        flights.push_back(
            {.id = id, .rows = {}, .altitude_m = {}, .recorded_climb_mps = {}, .in_flight = {}});
      }
      try {
        AddRow(row, flights.back());
      } catch (const UserError& error) {
        if (!reading_.skip_bad)
          throw UserError(std::string(error.what()) + "; --skip-bad leaves such rows out");
        if (bad_++ == 0) first_bad_ = error.what();
      }
    }
    if (bad_ + table_.bad() > flight_logs::kMaxBadShare *
                                  static_cast<double>(table_.rows() + static_cast<std::size_t>(table_.bad())))
      throw UserError(fmt::format(
          "{}: --skip-bad would leave out {} of {} rows, at most {:g} % are allowed{}", table_.path(),
          bad_ + table_.bad(), table_.rows() + static_cast<std::size_t>(table_.bad()),
          100.0 * flight_logs::kMaxBadShare, first_bad_.empty() ? "" : "; the first: " + first_bad_));
    return flights;
  }

  int bad() const { return bad_; }
  const std::string& first_bad() const { return first_bad_; }

 private:
  struct Gate {
    std::size_t column;
    FlightCondition condition;
  };

  bool Passes(std::size_t row, const Gate& gate) const {
    const std::vector<std::string>& words = gate.condition.words;
    if (words.empty()) return table_.Number(row, gate.column, -1e300, 1e300) >= gate.condition.least;
    const std::string cell = Lower(table_.Cell(row, gate.column));
    return std::any_of(words.begin(), words.end(),
                       [&](const std::string& word) { return Lower(word) == cell; });
  }

  void AddRow(std::size_t row, RawFlight& flight) {
    FlightRow values;
    values.time_s = time_(row);
    if (!flight.rows.empty() && values.time_s <= flight.rows.back().time_s)
      throw UserError(fmt::format("{}{} does not come after {:g}; time must increase within a flight",
                                  table_.Where(row, time_.column()), table_.Cell(row, time_.column()),
                                  flight.rows.back().time_s));
    values.power_w = power_.there() ? power_(row) : voltage_(row) * current_(row);
    values.airspeed_mps = airspeed_(row);
    values.climb_mps = climb_(row);
    values.density_kgm3 = density_(row);
    values.mass_kg = mass_.there() ? mass_(row) : format_.robot.mass_kg + payload_(row);
    values.source_row = row;
    const double recorded_altitude =
        altitude_.there() ? altitude_(row) : std::numeric_limits<double>::quiet_NaN();
    const bool in_flight =
        !table_.OnGround(row) &&
        std::all_of(gates_.begin(), gates_.end(), [&](const Gate& gate) { return Passes(row, gate); });
    flight.rows.push_back(values);
    flight.recorded_climb_mps.push_back(climb_.there() ? values.climb_mps
                                                       : std::numeric_limits<double>::quiet_NaN());
    flight.altitude_m.push_back(recorded_altitude);
    flight.in_flight.push_back(in_flight);
  }

  const flight_logs::LogTable& table_;
  const LogFormat& format_;
  const flight_logs::LogReading& reading_;
  Source time_, power_, voltage_, current_, airspeed_, climb_, altitude_, density_, payload_, mass_;
  std::vector<Gate> gates_;
  std::size_t flight_column_ = 0;
  int bad_ = 0;
  std::string first_bad_;
};

// Climb rate of each row: slope of the straight line through the altitudes within +-window.
std::vector<double> AltitudeSlope(double window_s, const RawFlight& flight) {
  const std::vector<FlightRow>& rows = flight.rows;
  std::vector<double> slope(rows.size(), 0.0);
  std::size_t begin = 0, end = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    while (rows[begin].time_s < rows[i].time_s - window_s) ++begin;
    while (end < rows.size() && rows[end].time_s <= rows[i].time_s + window_s) ++end;
    double time_sum = 0.0, altitude_sum = 0.0;
    for (std::size_t k = begin; k < end; ++k) {
      time_sum += rows[k].time_s - rows[i].time_s;
      altitude_sum += flight.altitude_m[k];
    }
    const double count = static_cast<double>(end - begin);
    double covariance = 0.0, variance = 0.0;
    for (std::size_t k = begin; k < end; ++k) {
      const double dt = rows[k].time_s - rows[i].time_s - time_sum / count;
      covariance += dt * (flight.altitude_m[k] - altitude_sum / count);
      variance += dt * dt;
    }
    slope[i] = variance > 0.0 ? covariance / variance : 0.0;
  }
  return slope;
}

// Refuses a recorded climb rate that has not the sign or the size of what the altitude does.
void CheckClimb(const RawFlight& flight, const flight_logs::LogTable& table, const LogFormat& format) {
  const std::vector<double> slopes = AltitudeSlope(format.climb_window_s, flight);
  std::vector<double> recorded_mps, slope_mps;
  for (std::size_t i = 0; i < slopes.size(); ++i) {
    if (!flight.in_flight[i] || std::isnan(flight.recorded_climb_mps[i]) || std::isnan(slopes[i])) continue;
    recorded_mps.push_back(flight.recorded_climb_mps[i]);
    slope_mps.push_back(slopes[i]);
  }
  if (recorded_mps.empty()) return;
  CheckClimbAgainstAltitude(table.WhereRow(flight.rows.front().source_row), format, recorded_mps, slope_mps);
}

// |integral of the recorded climb rate - change of altitude| over the rows in flight.
double ClimbDriftM(const RawFlight& flight) {
  double drift = 0.0;
  for (std::size_t i = 1; i < flight.rows.size(); ++i) {
    const double dt = flight.rows[i].time_s - flight.rows[i - 1].time_s;
    if (dt > kMaxGapS || !flight.in_flight[i] || !flight.in_flight[i - 1]) continue;
    drift += 0.5 * dt * (flight.recorded_climb_mps[i] + flight.recorded_climb_mps[i - 1]) -
             (flight.altitude_m[i] - flight.altitude_m[i - 1]);
  }
  return std::abs(drift);
}

void MarkOutliers(Flight& flight, FlightLog& log) {
  std::vector<double> powers;
  for (const FlightRow& row : flight.rows) powers.push_back(row.power_w);
  std::nth_element(powers.begin(), powers.begin() + static_cast<std::ptrdiff_t>(powers.size() / 2),
                   powers.end());
  const double median_w = powers[powers.size() / 2];
  for (FlightRow& row : flight.rows) {
    if (row.power_w < kDropOutShare * median_w) {
      row.quality = RowQuality::kDropOut;
      ++log.drop_outs;
    } else if (row.power_w > kSpikeShare * median_w) {
      row.quality = RowQuality::kSpike;
      ++log.spikes;
    }
  }
}

double DurationS(const FlightLog& log) {
  double duration_s = 0.0;
  for (const Flight& flight : log.flights)
    duration_s += flight.rows.back().time_s - flight.rows.front().time_s;
  return duration_s;
}

// Puts a flight's rows in the air into the log; returns how far its recorded climb rate drifts from its altitude.
double AddFlight(const flight_logs::LogTable& source, std::size_t table, RawFlight& raw, FlightLog& log) {
  if (log.format.climb_from == ClimbFrom::kAltitude) {
    const std::vector<double> slopes = AltitudeSlope(log.format.climb_window_s, raw);
    for (std::size_t i = 0; i < slopes.size(); ++i) raw.rows[i].climb_mps = slopes[i];
  } else if (log.format.Has("altitude_m")) {
    CheckClimb(raw, source, log.format);
  }
  Flight flight{.id = raw.id, .rows = {}, .table = table};
  for (std::size_t i = 0; i < raw.rows.size(); ++i) {
    if (raw.in_flight[i])
      flight.rows.push_back(raw.rows[i]);
    else
      ++log.rows_on_ground;
  }
  if (flight.rows.size() < kMinFlightRows) {
    ++log.short_flights;
    return 0.0;
  }
  MarkOutliers(flight, log);
  for (const FlightRow& row : flight.rows) log.hover_rows += IsHover(row, log.format) ? 1 : 0;
  log.rows += static_cast<int>(flight.rows.size());
  log.flights.push_back(std::move(flight));
  return ClimbDriftM(raw);
}

// Refuses logs in which more than kMaxNoPowerShare of the rows in flight draw no power: there it was not measured.
void CheckPowerInFlight(const std::vector<flight_logs::LogTable>& tables, const FlightLog& log) {
  int without = 0;
  const FlightRow* first = nullptr;
  std::size_t table = 0;
  for (const Flight& flight : log.flights)
    for (const FlightRow& row : flight.rows) {
      if (row.power_w > 0.0) continue;
      if (without++ == 0) first = &row, table = flight.table;
    }
  if (without <= kMaxNoPowerShare * log.rows) return;
  const bool power = log.format.Has("power_w");
  const std::string meaning = power ? "power_w" : "current_a";
  const std::size_t column = tables[table].Column(log.format.columns.at(meaning), meaning);
  int negative = 0;
  double low_w = 0.0, high_w = -std::numeric_limits<double>::infinity();
  for (const Flight& flight : log.flights)
    for (const FlightRow& row : flight.rows) {
      negative += row.power_w < 0.0;
      low_w = std::min(low_w, row.power_w);
      high_w = std::max(high_w, row.power_w);
    }
  constexpr double kSpread = 0.05;  // less is a mark for "unknown"
  if (negative > kMostRows * log.rows && high_w - low_w > kSpread * std::abs(low_w))
    throw UserError(
        fmt::format("{}{} is negative in {} of {} rows in flight: it looks like one that counts what the "
                    "battery gives as negative: "
                    "put 'units: {{{}: {:g}}}' into the format file",
                    tables[table].Where(first->source_row, column), meaning, negative, log.rows, meaning,
                    log.format.units.contains(meaning) ? -log.format.units.at(meaning) : -1.0));
  throw UserError(fmt::format("{}power was not measured in {} of {} rows in flight: the first is {}{}",
                              tables[table].Where(first->source_row, column), without, log.rows,
                              tables[table].Cell(first->source_row, column),
                              power ? " W" : fmt::format(" A at {:.3g} W", first->power_w)));
}

// A misspelt word puts its rows on the ground; a word of another log's states does nothing.
void NoteUnseenWords(const std::vector<flight_logs::LogTable>& tables, FlightLog& log) {
  for (const auto& [name, condition] : log.format.in_flight) {
    if (condition.words.empty()) continue;
    std::set<std::string> seen;
    for (const flight_logs::LogTable& table : tables)
      for (std::size_t row = 0, column = table.Column(name, "in_flight"); row < table.rows(); ++row)
        if (const std::string cell = table.Cell(row, column); IsUtf8(cell)) seen.insert(Lower(cell));
    constexpr std::size_t kMostShown = 10;
    std::vector<std::string> shown(seen.begin(), seen.end());
    const bool more = shown.size() > kMostShown;
    if (more) shown.resize(kMostShown);
    for (const std::string& word : condition.words)
      if (!seen.contains(Lower(word)))
        log.notes.push_back(fmt::format("in_flight: no row has '{}' in '{}'; there are: {}{}", word, name,
                                        fmt::join(shown, ", "), more ? ", ..." : ""));
  }
}

// No row in the air: says what in_flight asks for and what the first row has instead.
[[noreturn]] void FailOnGround(const flight_logs::LogTable& table, const FlightLog& log) {
  std::string conditions;
  for (const auto& [name, condition] : log.format.in_flight)
    conditions +=
        fmt::format("{}'{}' {}, and row 1 has '{}'", conditions.empty() ? "" : "; ", name,
                    condition.words.empty() ? fmt::format("at least {:g}", condition.least)
                                            : fmt::format("one of: {}", fmt::join(condition.words, ", ")),
                    table.Cell(0, table.Column(name, "in_flight")));
  throw UserError(fmt::format(
      "{}no flight: {} rows are on the ground by the format's in_flight ({}), fewer than {} are not",
      table.WhereRow(0), log.rows_on_ground, conditions, kMinFlightRows));
}

// A speed that never changes by a millimetre per second was hardly measured; it may be a hover in a hall, so it is said.
void NoteDeadSpeed(FlightLog& log) {
  const double first_mps = log.flights.front().rows.front().airspeed_mps;
  for (const Flight& flight : log.flights)
    for (const FlightRow& row : flight.rows)
      if (std::abs(row.airspeed_mps - first_mps) > 1e-3) return;
  log.notes.push_back(
      fmt::format("the speed is {:g} m/s in all {} rows in flight: was it measured?", first_mps, log.rows));
}

void CheckEnough(const std::vector<flight_logs::LogTable>& tables, const FlightLog& log, LogUse use) {
  const flight_logs::LogTable& last = tables.back();
  const std::string where = last.rows() == 0 ? last.path() + ":1:1: " : last.WhereRow(last.rows() - 1);
  if (log.flights.empty() && log.rows_on_ground > 0 && !log.format.in_flight.empty()) FailOnGround(last, log);
  if (log.flights.empty())
    throw UserError(fmt::format("{}too few rows: no flight of at least {} rows", where, kMinFlightRows));
  if (use == LogUse::kEvaluate) return;
  if (log.rows < kMinLogRows)
    throw UserError(
        fmt::format("{}too few rows: {} in flight, at least {} are needed", where, log.rows, kMinLogRows));
  if (DurationS(log) < kMinLogS)
    throw UserError(fmt::format("{}too short: {:.1f} s of flight, at least {:g} s are needed", where,
                                DurationS(log), kMinLogS));
  if (log.hover_rows >= kMinHoverRows) return;
  const LogFormat& format = log.format;
  const std::string speed =
      format.columns.at(format.Has("airspeed_mps") ? "airspeed_mps" : "ground_speed_mps");
  const std::string climb =
      format.columns.at(format.climb_from == ClimbFrom::kAltitude ? "altitude_m" : "climb_mps");
  throw UserError(fmt::format(
      "{}no hovering phase: {} rows have '{}' up to {:g} m/s and a climb rate ('{}') within {:g} m/s; "
      "at least {} are needed (format: hover)",
      where, log.hover_rows, speed, format.hover_max_speed_mps, climb, format.hover_max_climb_mps,
      kMinHoverRows));
}

}  // namespace

bool IsHover(const FlightRow& row, const LogFormat& format) {
  return row.quality == RowQuality::kGood && row.airspeed_mps <= format.hover_max_speed_mps &&
         std::abs(row.climb_mps) <= format.hover_max_climb_mps;
}

FlightLog MakeFlightLog(const std::vector<flight_logs::LogTable>& tables, const LogFormat& format, LogUse use,
                        const flight_logs::LogReading& reading) {
  ED3R_CHECK(!tables.empty(), "no tables");
  FlightLog log;
  log.format = format;
  double drift_m = 0.0;
  for (std::size_t t = 0; t < tables.size(); ++t) {
    CheckUnits(tables[t], format);
    log.files.push_back(tables[t].path());
    TableReader reader(tables[t], format, reading);
    for (RawFlight& raw : reader.Read()) drift_m += AddFlight(tables[t], t, raw, log);
    log.bad_rows += reader.bad() + tables[t].bad();
    if (log.first_bad.empty()) log.first_bad = reader.first_bad();
    for (const std::string& note : tables[t].notes())
      if (std::find(log.notes.begin(), log.notes.end(), note) == log.notes.end()) log.notes.push_back(note);
  }
  CheckGround(tables, log);
  CheckPowerInFlight(tables, log);
  CheckEnough(tables, log, use);
  NoteDeadSpeed(log);
  NoteUnseenWords(tables, log);
  log.climb_drift_m = drift_m / static_cast<double>(log.flights.size());
  return log;
}

}  // namespace ed3r::fit
