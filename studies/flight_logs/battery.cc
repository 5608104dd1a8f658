#include "studies/flight_logs/battery.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "engine/core/check.h"

namespace ed3r::flight_logs {
namespace {

double MaxOf(const TimeSeries& series) {
  double max = -INFINITY;
  for (std::size_t i = 0; i < series.size(); ++i) max = std::max(max, series.value(i));
  return max;
}

double MeanOf(const TimeSeries& series) {
  double sum = 0.0;
  for (std::size_t i = 0; i < series.size(); ++i) sum += series.value(i);
  return sum / static_cast<double>(series.size());
}

bool Measured(const Battery& battery) {
  return MaxOf(battery.current_a) > 0.0 && MaxOf(battery.voltage_v) > 0.0;
}

std::string Described(const std::vector<const Battery*>& batteries) {
  std::vector<std::string> texts;
  for (const Battery* battery : batteries)
    texts.push_back(fmt::format("{} ({}: {:.1f} V, {:.1f} A on average)", battery->id, battery->source,
                                MeanOf(battery->voltage_v), MeanOf(battery->current_a)));
  return fmt::format("{}", fmt::join(texts, ", "));
}

ChosenBattery Taken(const Battery& battery, const std::string& note) {
  ChosenBattery chosen;
  chosen.note = note;
  for (std::size_t i = 0; i < battery.voltage_v.size(); ++i) {
    chosen.times_s.push_back(battery.voltage_v.time_s(i));
    chosen.voltage_v.push_back(battery.voltage_v.value(i));
    chosen.current_a.push_back(battery.current_a.value(i));
  }
  return chosen;
}

ChosenBattery Summed(const std::vector<const Battery*>& batteries) {
  ChosenBattery chosen = Taken(*batteries.front(), "power is the sum of batteries " + Described(batteries));
  for (std::size_t i = 0; i < chosen.times_s.size(); ++i) {
    double power_w = 0.0;
    for (const Battery* battery : batteries)
      power_w +=
          battery->voltage_v.Nearest(chosen.times_s[i]) * battery->current_a.Nearest(chosen.times_s[i]);
    chosen.current_a[i] = power_w / chosen.voltage_v[i];
  }
  return chosen;
}

}  // namespace

void CheckPowerMeasured(const std::string& path, const std::vector<Battery>& batteries) {
  if (batteries.empty() || batteries.front().current_a.empty())
    throw UserError(path + ": power was not measured: the log has no battery voltage and current");
  for (const Battery& battery : batteries)
    if (Measured(battery)) return;
  const TimeSeries &current = batteries.front().current_a, &voltage = batteries.front().voltage_v;
  const bool no_current = MaxOf(current) <= 0.0;
  const TimeSeries& dead = no_current ? current : voltage;
  throw UserError(fmt::format(
      "{}: power was not measured: {}: the {} is {:g} {} at {:.3f} s and never above 0 in {} values; "
      "a log with a current sensor is needed",
      path, batteries.front().source, no_current ? "current" : "voltage", dead.value(0),
      no_current ? "A" : "V", dead.time_s(0), dead.size()));
}

ChosenBattery ChooseBattery(const std::string& path, const std::vector<Battery>& batteries,
                            const LogReading& reading) {
  CheckPowerMeasured(path, batteries);
  std::vector<const Battery*> all, measured;
  for (const Battery& battery : batteries) {
    all.push_back(&battery);
    if (Measured(battery)) measured.push_back(&battery);
  }
  if (!reading.battery) {
    if (measured.size() > 1)
      throw UserError(fmt::format(
          "{}: {} batteries: {}; say which powers the drone: --battery NUMBER, or --battery all for "
          "the sum of their powers",
          path, measured.size(), Described(measured)));
    return Taken(*measured.front(),
                 all.size() == 1 ? "" : "the only battery with a current: " + Described(measured));
  }
  if (*reading.battery == kAllBatteries) return Summed(measured);
  for (const Battery* battery : all)
    if (battery->id == *reading.battery) return Taken(*battery, "battery " + Described({battery}));
  throw UserError(
      fmt::format("{}: --battery {}: there is none; batteries: {}", path, *reading.battery, Described(all)));
}

}  // namespace ed3r::flight_logs
