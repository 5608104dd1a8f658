#include "studies/fit/power_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/core/check.h"
#include "engine/robot/power/power_models.h"

namespace ed3r::fit {
namespace {

double MedianOf(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Nine rows in ten alike to a thousandth is no measurement: a flying multirotor's power moves by percents.
void CheckVaries(const std::vector<flight_logs::LogTable>& tables, const FlightLog& log) {
  constexpr double kLeastSpread = 1e-3, kShare = 0.9;
  std::vector<double> powers;
  for (const Flight& flight : log.flights)
    for (const FlightRow& row : flight.rows) powers.push_back(row.power_w);
  const double median_w = MedianOf(powers);
  const auto alike = std::count_if(powers.begin(), powers.end(), [&](double power_w) {
    return std::abs(power_w - median_w) <= kLeastSpread * median_w;
  });
  if (static_cast<double>(alike) <= kShare * static_cast<double>(powers.size())) return;
  const Flight& first = log.flights.front();
  throw UserError(fmt::format(
      "{}power was not measured: it is {:g} W in {} of {} rows in flight, and a flying multirotor's "
      "power varies",
      tables[first.table].WhereRow(first.rows.front().source_row), median_w, alike, powers.size()));
}

struct Guess {
  const char *meaning, *unit;
  double factor;
};

}  // namespace

void CheckMeasuredPower(const std::vector<flight_logs::LogTable>& tables, const FlightLog& log,
                        double gravity_mps2) {
  CheckVaries(tables, log);
  const double area_m2 = robot::MakeRotorcraft(log.format.robot).DiscAreaM2();
  std::vector<double> ratios, powers;
  double mass_kg = 0.0;
  for (const Flight& flight : log.flights)
    for (const FlightRow& row : flight.rows) {
      if (!IsHover(row, log.format)) continue;
      const double weight_n = row.mass_kg * gravity_mps2;
      ratios.push_back(row.power_w / (weight_n * std::sqrt(weight_n / (2.0 * row.density_kgm3 * area_m2))));
      powers.push_back(row.power_w);
      mass_kg = row.mass_kg;
    }
  if (ratios.empty()) return;
  const double ratio = MedianOf(ratios), power_w = MedianOf(powers);
  if (ratio >= 1.0 && ratio <= kMaxIdealRatio) return;
  std::string mend = "check robot.mass_kg, robot.propellers, robot.propeller_radius_m and the log's units";
  const bool power = log.format.Has("power_w");
  for (const Guess& guess : power ? std::vector<Guess>{{"power_w", "kW", 1e3}, {"power_w", "mW", 1e-3}}
                                  : std::vector<Guess>{{"current_a", "mA", 1e-3},
                                                       {"current_a", "hundredths of an ampere", 0.01},
                                                       {"voltage_v", "mV", 1e-3}}) {
    constexpr double kPlausibleRatio = 8.0;
    if (ratio * guess.factor < 1.0 || ratio * guess.factor > kPlausibleRatio) continue;
    const double before = log.format.units.contains(guess.meaning) ? log.format.units.at(guess.meaning) : 1.0;
    mend = fmt::format("it looks like {}: put 'units: {{{}: {:g}}}' into the format file", guess.unit,
                       guess.meaning, before * guess.factor);
    break;
  }
  throw UserError(fmt::format(
      "{}: the median hover power is {:.4g} W, {} the ideal induced power of this airframe ({:.4g} W for "
      "{:.3g} kg on {} propellers "
      "of radius {:g} m); {}",
      log.files.front(), power_w, ratio < 1.0 ? "below" : fmt::format("{:.3g} times", ratio), power_w / ratio,
      mass_kg, log.format.robot.propellers, log.format.robot.propeller_radius_m, mend));
}

}  // namespace ed3r::fit
