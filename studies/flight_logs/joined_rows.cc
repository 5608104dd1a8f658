#include "studies/flight_logs/joined_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/core/check.h"

namespace ed3r::flight_logs {
namespace {

// Before the first message the state is the one that it ended: what becomes armed was not.
bool OnGround(const TimeSeries& armed, const TimeSeries& landed, double time_s) {
  if (!armed.empty() && armed.Last(time_s, 1.0 - armed.value(0)) < 0.5) return true;
  return !landed.empty() && landed.Last(time_s, 1.0 - landed.value(0)) >= 0.5;
}

// Messages may come out of order by a moment; a clock that starts again would put two flights into one, and a sample whose stamp is
// far ahead would be taken for one of then.
void CheckClock(const std::string& path, const std::string& source, const TimeSeries& clock) {
  if (clock.back_s() <= kMaxJoinS) return;
  throw UserError(
      fmt::format("{}: the clock of {} runs back from {:.3f} to {:.3f} s: a restart, or two logs in one "
                  "file; give each log as a "
                  "file of its own",
                  path, source, clock.back_from_s(), clock.back_from_s() - clock.back_s()));
}

constexpr double kMinFlightS = 5.0;  // less is a motor test or a bench

[[noreturn]] void FailOnGround(const std::string& path, const TimeSeries& armed, double air_s, double begin_s,
                               double end_s) {
  bool ever = armed.empty();
  for (std::size_t i = 0; i < armed.size(); ++i) ever = ever || armed.value(i) >= 0.5;
  throw UserError(fmt::format(
      "{}: no flight: {} from {:.1f} to {:.1f} s; a log of a flight is needed", path,
      ever ? fmt::format("armed and not landed for {:.1f} s only", air_s) : "never armed", begin_s, end_s));
}

}  // namespace

DecodedLog JoinRows(const std::string& path, LogKind kind, const ChosenBattery& battery,
                    const std::vector<NamedSeries>& series, const TimeSeries& armed,
                    const TimeSeries& landed) {
  DecodedLog log{.path = path, .kind = kind, .columns = {}, .on_ground = {}, .lines = {}, .notes = {}};
  for (const char* name : {"time_s", "battery_voltage_v", "battery_current_a"})
    log.columns.push_back({name, {}});
  for (const NamedSeries& source : series) {
    CheckClock(path, source.name, *source.series);
    log.columns.push_back({source.name, {}});
  }
  const bool states = !armed.empty() || !landed.empty();
  int apart = 0;
  for (std::size_t i = 0; i < battery.times_s.size(); ++i) {
    const double time_s = battery.times_s[i];
    std::vector<double> row = {time_s, battery.voltage_v[i], battery.current_a[i]};
    for (const NamedSeries& source : series) row.push_back(source.series->Nearest(time_s));
    const bool on_ground = states && OnGround(armed, landed, time_s);
    if (!std::all_of(row.begin(), row.end(), [](double value) { return std::isfinite(value); })) {
      apart += on_ground ? 0 : 1;
      continue;
    }
    for (std::size_t k = 0; k < row.size(); ++k) log.columns[k].values.push_back(row[k]);
    if (states) log.on_ground.push_back(on_ground);
  }
  log.notes.push_back(fmt::format(
      "one row per battery sample; every other value is the one nearest in time, at most {:g} s away",
      kMaxJoinS));
  if (!battery.note.empty()) log.notes.push_back(battery.note);
  if (apart > 0)
    log.notes.push_back(fmt::format("{} rows in which a value has no sample near were left out", apart));
  return log;
}

void CheckAnyFlight(const std::string& path, const TimeSeries& clock, const TimeSeries& armed,
                    const TimeSeries& landed) {
  if (armed.empty() && landed.empty()) return;
  double air_s = 0.0;
  for (std::size_t i = 1; i < clock.size(); ++i)
    if (!OnGround(armed, landed, clock.time_s(i - 1))) air_s += clock.time_s(i) - clock.time_s(i - 1);
  if (air_s < kMinFlightS) FailOnGround(path, armed, air_s, clock.time_s(0), clock.time_s(clock.size() - 1));
}

ChosenBattery BatteryInFlight(const std::string& path, const std::map<int, Battery>& batteries,
                              const TimeSeries& armed, const TimeSeries& landed, const LogReading& reading) {
  std::vector<Battery> all;
  for (const auto& [id, battery] : batteries) {
    CheckClock(path, battery.source, battery.voltage_v);
    all.push_back(battery);
  }
  CheckPowerMeasured(path, all);
  CheckAnyFlight(path, all.front().voltage_v, armed, landed);
  return ChooseBattery(path, all, reading);
}

void CheckFlown(const DecodedLog& log) {
  const bool flown = log.on_ground.empty() ? !log.columns.front().values.empty()
                                           : std::find(log.on_ground.begin(), log.on_ground.end(), false) !=
                                                 log.on_ground.end();
  if (!flown)
    throw UserError(fmt::format(
        "{}: no moment in flight at which battery, velocity and altitude are all known", log.path));
}

}  // namespace ed3r::flight_logs
