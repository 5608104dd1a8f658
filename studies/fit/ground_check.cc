#include "studies/fit/ground_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>

#include "engine/core/check.h"

namespace ed3r::fit {
namespace {

struct Place {
  std::size_t table, row;
};

struct Ground {
  double least_w = 0.0;  // what a row in flight takes at least
  std::size_t low_rows = 0;
  std::vector<Place> places;
};

double UpperQuartileW(const FlightLog& log) {
  std::vector<double> powers;
  for (const Flight& flight : log.flights)
    for (const FlightRow& row : flight.rows) powers.push_back(row.power_w);
  if (powers.empty()) return 0.0;
  const auto at = powers.begin() + static_cast<std::ptrdiff_t>(powers.size() * 3 / 4);
  std::nth_element(powers.begin(), at, powers.end());
  return *at;
}

void AddRuns(const Flight& flight, const LogFormat& format, Ground& ground) {
  const auto rests = [&](const FlightRow& row) {
    return row.power_w < ground.least_w && row.airspeed_mps <= format.hover_max_speed_mps &&
           std::abs(row.climb_mps) <= format.hover_max_climb_mps;
  };
  const std::vector<FlightRow>& rows = flight.rows;
  for (std::size_t begin = 0; begin < rows.size();) {
    std::size_t end = begin;
    while (end < rows.size() && rests(rows[end]) &&
           (end == begin || rows[end].time_s - rows[end - 1].time_s <= kMaxGapS))
      ++end;
    if (end > begin && rows[end - 1].time_s - rows[begin].time_s >= kGroundS)
      for (std::size_t i = begin; i < end; ++i) ground.places.push_back({flight.table, rows[i].source_row});
    begin = std::max(end, begin + 1);
  }
}

std::string YamlKey(const std::string& name) {
  const bool plain =
      std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; });
  return plain ? name : '"' + name + '"';
}

// The condition on the altitude that leaves these rows out and keeps most others; "" where there is none.
std::string AltitudeCondition(const std::vector<flight_logs::LogTable>& tables, const FlightLog& log,
                              const std::vector<Place>& places) {
  if (!log.format.Has("altitude_m")) return "";
  const std::string& name = log.format.columns.at("altitude_m");
  const auto unit = log.format.units.find("altitude_m");
  const double metre = unit == log.format.units.end() ? 1.0 : 1.0 / unit->second;
  if (metre <= 0.0) return "";  // "at least" would keep the ground
  const auto altitude = [&](std::size_t table, std::size_t row) {
    constexpr double kAny = std::numeric_limits<double>::max();
    return tables[table].Number(row, tables[table].Column(name, "altitude_m"), -kAny, kAny);
  };
  double highest = -std::numeric_limits<double>::infinity();
  for (const Place& place : places) highest = std::max(highest, altitude(place.table, place.row));
  const double least = std::ceil(highest + metre);
  std::size_t above = 0;
  for (const Flight& flight : log.flights)
    above += static_cast<std::size_t>(
        std::count_if(flight.rows.begin(), flight.rows.end(),
                      [&](const FlightRow& row) { return altitude(flight.table, row.source_row) >= least; }));
  if (2 * above < static_cast<std::size_t>(log.rows) - places.size()) return "";
  return fmt::format("{}: {:.0f}", YamlKey(name), least);
}

}  // namespace

void CheckGround(const std::vector<flight_logs::LogTable>& tables, const FlightLog& log) {
  if (!log.format.in_flight.empty() ||
      std::all_of(tables.begin(), tables.end(), [](const auto& table) { return table.TellsGround(); }))
    return;
  Ground ground{.least_w = kGroundShare * UpperQuartileW(log), .low_rows = 0, .places = {}};
  for (const Flight& flight : log.flights) {
    ground.low_rows += static_cast<std::size_t>(
        std::count_if(flight.rows.begin(), flight.rows.end(),
                      [&](const FlightRow& row) { return row.power_w < ground.least_w; }));
    AddRuns(flight, log.format, ground);
  }
  const auto rows = static_cast<double>(ground.places.size());
  if (ground.places.empty() || rows < kLeastGroundPart * log.rows ||
      2.0 * rows < static_cast<double>(ground.low_rows))
    return;
  const std::string condition = AltitudeCondition(tables, log, ground.places);
  const Place& first = ground.places.front();
  throw UserError(fmt::format(
      "{}{} of {} rows look like the ground: they rest for {:g} s and more on less than {:.3g} W, a quarter "
      "of what this log takes in flight; say which rows are in flight: put {} into the format file "
      "(sweeps/OWN_DATA.md, \"A drone's log\")",
      tables[first.table].WhereRow(first.row), ground.places.size(), log.rows, kGroundS, ground.least_w,
      condition.empty()
          ? "'in_flight: {COLUMN: [WORD]}' or 'in_flight: {COLUMN: LEAST}', of a column that tells it,"
          : fmt::format("'in_flight: {{{}}}', or the words of a state,", condition)));
}

}  // namespace ed3r::fit
