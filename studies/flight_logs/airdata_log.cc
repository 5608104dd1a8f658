#include "studies/flight_logs/airdata_log.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>

#include "engine/core/check.h"
#include "studies/flight_logs/battery.h"

namespace ed3r::flight_logs {
namespace {

constexpr double kGroundHeightM = 0.5;

std::string Lower(std::string_view text) {
  std::string lower(text);
  std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return std::tolower(c); });
  return lower;
}

const std::map<std::string, double>& Units() {
  static const std::map<std::string, double> units = {
      {"millisecond", 1e-3}, {"feet", 0.3048}, {"meters", 1.0},     {"metres", 1.0},     {"m", 1.0},
      {"ft", 0.3048},        {"ft/s", 0.3048}, {"fps", 0.3048},     {"knots", 0.514444}, {"kn", 0.514444},
      {"mph", 0.44704},      {"m/s", 1.0},     {"km/h", 1.0 / 3.6}, {"kph", 1.0 / 3.6},  {"v", 1.0},
      {"volts", 1.0},        {"a", 1.0},       {"amps", 1.0}};
  return units;
}

std::string UnitNames() {
  std::string names;
  for (const auto& [unit, factor] : Units()) names += (names.empty() ? "" : " | ") + unit;
  return names;
}

// A column "name(unit)" with the factor to SI units.
class UnitColumn {
 public:
  UnitColumn(const CsvTable& table, const std::string& name, double sign = 1.0) : table_(table) {
    for (std::size_t i = 0; i < table.columns().size(); ++i) {
      const std::string title = Lower(table.columns()[i]);
      if (!title.starts_with(Lower(name) + "(") || !title.ends_with(')')) continue;
      const std::string unit = title.substr(name.size() + 1, title.size() - name.size() - 2);
      const auto factor = Units().find(unit);
      if (factor == Units().end())
        throw UserError(fmt::format("{}:1:1: column '{}': the unit '{}' is not known; allowed: {}",
                                    table.path(), table.columns()[i], unit, UnitNames()));
      index_ = i;
      factor_ = sign * factor->second;
      return;
    }
    throw UserError(fmt::format("{}:1:1: an AirData export without a column '{}(...)'", table.path(), name));
  }

  double operator()(std::size_t row) const { return factor_ * table_.Number(row, index_, -1e12, 1e12); }
  std::size_t index() const { return index_; }

 private:
  const CsvTable& table_;
  std::size_t index_ = 0;
  double factor_ = 1.0;
};

class AirDataReader {
 public:
  AirDataReader(CsvTable& table, const LogReading& reading, int bad)
      : table_(table), reading_(reading), columns_{UnitColumn(table, "time"),
                                                   UnitColumn(table, "voltage"),
                                                   UnitColumn(table, "current"),
                                                   UnitColumn(table, "speed"),
                                                   UnitColumn(table, "zSpeed", -1.0),
                                                   UnitColumn(table, "height_above_takeoff")} {
    std::vector<std::size_t> read;
    for (const UnitColumn& column : columns_) read.push_back(column.index());
    table.DecimalCommasToPoints(read);
    log_ = {.path = table.path(),
            .kind = LogKind::kAirData,
            .columns = {},
            .on_ground = {},
            .ground_by_height = true,
            .lines = {},
            .notes = {},
            .bad = bad};
    for (const char* name :
         {"time_s", "battery_voltage_v", "battery_current_a", "ground_speed_mps", "climb_mps", "altitude_m"})
      log_.columns.push_back({name, {}});
    const auto state = std::find(table.columns().begin(), table.columns().end(), "flycState");
    if (state != table.columns().end()) state_ = static_cast<std::size_t>(state - table.columns().begin());
  }

  DecodedLog Read() {
    for (std::size_t row = 0; row < table_.rows(); ++row) {
      try {
        AddRow(row);
      } catch (const UserError& error) {
        if (!reading_.skip_bad)
          throw UserError(std::string(error.what()) + "; --skip-bad leaves such rows out");
        ++log_.bad;
      }
    }
    CheckPowerMeasured(log_.path, {battery_});
    if (std::find(log_.on_ground.begin(), log_.on_ground.end(), false) == log_.on_ground.end())
      throw UserError(
          fmt::format("{}: no flight: motors starting or less than {:g} m above take-off in all {} rows",
                      log_.path, kGroundHeightM, table_.rows()));
    log_.notes.push_back("AirData export: climb is -zSpeed, ground speed stands in for airspeed");
    return std::move(log_);
  }

 private:
  void AddRow(std::size_t row) {
    std::vector<double> values;
    for (const UnitColumn& column : columns_) values.push_back(column(row));
    std::vector<double>& times_s = log_.columns.front().values;
    if (!times_s.empty() && values[0] <= times_s.back())
      throw UserError(fmt::format("{}{} does not come after the row before; time must increase",
                                  table_.Where(row, columns_[0].index()),
                                  table_.Cell(row, columns_[0].index())));
    for (std::size_t k = 0; k < values.size(); ++k) log_.columns[k].values.push_back(values[k]);
    const std::string state = state_ ? Lower(table_.Cell(row, *state_)) : "";
    const bool motors = state.find("motor") != std::string::npos || state.find("engine") != std::string::npos;
    if (motors) log_.ground_by_height = false;
    log_.on_ground.push_back(motors || std::abs(values[5]) < kGroundHeightM);
    log_.lines.push_back(table_.Line(row));
    battery_.voltage_v.Add(values[0], values[1]);
    battery_.current_a.Add(values[0], values[2]);
  }

  const CsvTable& table_;
  const LogReading& reading_;
  std::vector<UnitColumn> columns_;
  std::optional<std::size_t> state_;
  Battery battery_{.id = 0, .source = "voltage(v) and current(A)", .voltage_v = {}, .current_a = {}};
  DecodedLog log_;
};

}  // namespace

bool IsAirDataLog(const CsvTable& table) {
  return std::any_of(table.columns().begin(), table.columns().end(),
                     [](const std::string& name) { return Lower(name) == "time(millisecond)"; });
}

DecodedLog ReadAirDataLog(CsvTable& table, const LogReading& reading, int bad) {
  return AirDataReader(table, reading, bad).Read();
}

}  // namespace ed3r::flight_logs
