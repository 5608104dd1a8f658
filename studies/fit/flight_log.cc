#include "studies/fit/flight_log.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <set>

#include "engine/core/check.h"
#include "engine/core/utf8.h"

namespace ed3r {
namespace {

constexpr double kDropOutShare = 0.25;
constexpr double kSpikeShare = 2.0;

struct Range {
  double min, max;
};

// Reads one meaning of the format from a table, with its unit factor; absent meanings read as a constant.
class Source {
 public:
  Source(const CsvTable& table, const LogFormat& format, const std::string& meaning, Range range,
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
  const CsvTable& table_;
  Range range_;
  double otherwise_;
  double factor_ = 1.0;
  std::size_t column_ = 0;
  bool there_ = false;
};

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
  TableReader(const CsvTable& table, const LogFormat& format)
      : table_(table),
        format_(format),
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
    for (const auto& [name, least] : format.in_flight)
      gates_.push_back({table.Column(name, "in_flight"), least});
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
      AddRow(row, flights.back());
    }
    return flights;
  }

 private:
  struct Gate {
    std::size_t column;
    double least;
  };

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
    flight.rows.push_back(values);
    flight.recorded_climb_mps.push_back(climb_.there() ? values.climb_mps
                                                       : std::numeric_limits<double>::quiet_NaN());
    flight.altitude_m.push_back(altitude_.there() ? altitude_(row)
                                                  : std::numeric_limits<double>::quiet_NaN());
    flight.in_flight.push_back(std::all_of(gates_.begin(), gates_.end(), [&](const Gate& gate) {
      return table_.Number(row, gate.column, -1e300, 1e300) >= gate.least;
    }));
  }

  const CsvTable& table_;
  const LogFormat& format_;
  Source time_, power_, voltage_, current_, airspeed_, climb_, altitude_, density_, payload_, mass_;
  std::vector<Gate> gates_;
  std::size_t flight_column_ = 0;
};

// Climb rate of each row: slope of the straight line through the altitudes within +-window.
void ClimbFromAltitude(double window_s, RawFlight& flight) {
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
  for (std::size_t i = 0; i < rows.size(); ++i) flight.rows[i].climb_mps = slope[i];
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

void CheckEnough(const std::vector<CsvTable>& tables, const FlightLog& log, LogUse use) {
  const CsvTable& last = tables.back();
  const int last_line = last.rows() == 0 ? 1 : last.Line(last.rows() - 1);
  const std::string where = fmt::format("{}:{}:1: ", last.path(), last_line);
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

FlightLog MakeFlightLog(const std::vector<CsvTable>& tables, const LogFormat& format, LogUse use) {
  ED3R_CHECK(!tables.empty(), "no tables");
  FlightLog log;
  log.format = format;
  double drift_m = 0.0;
  for (const CsvTable& table : tables) {
    log.files.push_back(table.path());
    for (RawFlight& raw : TableReader(table, format).Read()) {
      if (format.climb_from == ClimbFrom::kAltitude) ClimbFromAltitude(format.climb_window_s, raw);
      Flight flight{.id = raw.id, .rows = {}};
      for (std::size_t i = 0; i < raw.rows.size(); ++i) {
        if (raw.in_flight[i])
          flight.rows.push_back(raw.rows[i]);
        else
          ++log.rows_on_ground;
      }
      if (flight.rows.size() < kMinFlightRows) {
        ++log.short_flights;
        continue;
      }
      MarkOutliers(flight, log);
      for (const FlightRow& row : flight.rows) log.hover_rows += IsHover(row, format) ? 1 : 0;
      log.rows += static_cast<int>(flight.rows.size());
      drift_m += ClimbDriftM(raw);
      log.flights.push_back(std::move(flight));
    }
  }
  CheckEnough(tables, log, use);
  log.climb_drift_m = drift_m / static_cast<double>(log.flights.size());
  return log;
}

FlightLog ReadFlightLog(const std::vector<std::string>& paths, const LogFormat& format, LogUse use) {
  if (paths.empty()) throw UserError("ed3r fit: no log file given");
  std::vector<CsvTable> tables;
  for (const std::string& path : paths) tables.push_back(CsvTable::Read(path));
  return MakeFlightLog(tables, format, use);
}

}  // namespace ed3r
