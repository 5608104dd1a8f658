#include "engine/mission/invariants.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <type_traits>
#include <utility>

#include "engine/robot/flight.h"

namespace ed3r::mission {
namespace {

constexpr double kLedgerTolerance = 1e-9;       // relative
constexpr double kProbabilityTolerance = 1e-9;  // of sums and means of values in [0, 1]
constexpr double kPositionToleranceM = 0.1;  // of Bullet's contacts; targets keep kBoxMarginM from the faces

bool AddsUp(double expected, double found) {
  return std::abs(expected - found) <= kLedgerTolerance * std::max(std::abs(expected), 1.0);
}

// Written so that NaN fails. The detail is put into words only where it does not hold: several times a timestep it does.
template <class... Values>
void Require(bool holds, Invariant invariant, fmt::format_string<const Values&...> detail,
             const Values&... values) {
  if (!holds) throw BrokenInvariant(invariant, fmt::format(detail, values...));
}

bool MayBeNaN(std::string_view name) {
  return name == "rc_predicted_reward" || name == "robot_predicted_reward";
}

template <class Record>
void CheckFiniteColumns(const Record& record, std::string_view where, std::int64_t k) {
  Record::Describe(record, [&](std::string_view name, const auto& field) {
    if constexpr (std::is_same_v<std::remove_cvref_t<decltype(field)>, double>)
      if (!std::isfinite(field) && !(std::isnan(field) && MayBeNaN(name)))
        throw BrokenInvariant(Invariant::kValuesFinite,
                              fmt::format("{} {}: {} is {}", where, k, name, field));
  });
}

std::array<std::pair<const char*, double>, 7> TimesOf(const TimestepRecord& step) {
  return {{{"horizontal_s", step.horizontal_s},
           {"ascent_s", step.ascent_s},
           {"descent_s", step.descent_s},
           {"turning_s", step.turning_s},
           {"sensing_s", step.sensing_s},
           {"computing_s", step.computing_s},
           {"transmitting_s", step.transmitting_s}}};
}

std::array<std::pair<const char*, double>, 11> EnergiesOf(const TimestepRecord& step) {
  return {{{"horizontal_j", step.horizontal_j},
           {"ascent_j", step.ascent_j},
           {"descent_j", step.descent_j},
           {"hover_turning_j", step.hover_turning_j},
           {"hover_sensing_j", step.hover_sensing_j},
           {"hover_computing_j", step.hover_computing_j},
           {"hover_transmitting_j", step.hover_transmitting_j},
           {"sensing_j", step.sensing_j},
           {"computation_j", step.computation_j},
           {"transmission_j", step.transmission_j},
           {"total_j", step.total_j}}};
}

}  // namespace

BrokenInvariant::BrokenInvariant(Invariant invariant, const std::string& detail)
    : InternalError(fmt::format("{}: {}", NameOf(invariant), detail)), invariant_(invariant) {}

void CheckInvariants(const MissionRecord& record, const MissionLimits& limits) {
  CheckFinite(record);
  CheckTime(record);
  CheckLedger(record, limits.power, limits.battery_j, limits.horizontal_w);
  CheckBattery(record);
  CheckPositions(record, limits.scene, limits.gust_mps);
  CheckProbabilities(record);
}

void CheckFinite(const MissionRecord& record) {
  CheckFiniteColumns(record, "mission", record.scenario);
  for (const TimestepRecord& step : record.steps) CheckFiniteColumns(step, "timestep", step.k);
}

void CheckTime(const MissionRecord& record) {
  std::int64_t k = 0;
  double duration_s = 0.0;
  for (const TimestepRecord& step : record.steps) {
    Require(step.k == ++k, Invariant::kTimeMonotone, "timestep {} stands in the place of timestep {}", step.k,
            k);
    for (const auto& [name, time_s] : TimesOf(step)) {
      Require(time_s >= 0.0, Invariant::kTimeMonotone, "timestep {}: {} is {}", step.k, name, time_s);
      duration_s += time_s;
    }
  }
  Require(record.timesteps == k, Invariant::kTimeMonotone, "{} timesteps are said, {} are there",
          record.timesteps, k);
  Require(AddsUp(duration_s, record.duration_s), Invariant::kTimeMonotone,
          "the timesteps take {} s, the mission {} s", duration_s, record.duration_s);
}

void CheckLedger(const MissionRecord& record, const robot::MovementPower& power, double battery_j,
                 std::span<const double> horizontal_w) {
  ED3R_CHECK(horizontal_w.empty() || horizontal_w.size() == record.steps.size(), "a power for each timestep");
  double left_j = battery_j;
  for (std::size_t i = 0; i < record.steps.size(); ++i) {
    const TimestepRecord& step = record.steps[i];
    const double across_w = horizontal_w.empty() ? power.horizontal_w : horizontal_w[i];
    for (const auto& [name, energy_j] : EnergiesOf(step))
      Require(energy_j >= 0.0, Invariant::kLedgerAddsUp, "timestep {}: {} is {}", step.k, name, energy_j);
    const double hovering_s = step.turning_s + step.sensing_s + step.computing_s + step.transmitting_s;
    const double expected_j = power.hover_w * hovering_s + across_w * step.horizontal_s +
                              power.ascent_w * step.ascent_s + power.descent_w * step.descent_s +
                              step.sensing_j + step.computation_j + step.transmission_j;
    Require(AddsUp(expected_j, step.total_j), Invariant::kLedgerAddsUp, "timestep {}: parts {} J, total {} J",
            step.k, expected_j, step.total_j);
    left_j -= step.total_j;
    Require(std::abs(left_j - step.battery_j) <= kLedgerTolerance * battery_j, Invariant::kLedgerAddsUp,
            "timestep {}: the battery holds {} J, the ledger leaves {} J", step.k, step.battery_j, left_j);
  }
  Require(std::abs(left_j - record.battery_left_j) <= kLedgerTolerance * battery_j, Invariant::kLedgerAddsUp,
          "mission: the battery holds {} J, the ledger leaves {} J", record.battery_left_j, left_j);
  const double parts_j = record.movement_j + record.sensing_j + record.computation_j + record.transmission_j;
  Require(AddsUp(parts_j, record.total_j), Invariant::kLedgerAddsUp, "mission: parts {} J, total {} J",
          parts_j, record.total_j);
  const double given_j = battery_j - record.battery_left_j;
  Require(AddsUp(given_j, record.total_j), Invariant::kLedgerAddsUp, "battery gave {} J, ledger says {} J",
          given_j, record.total_j);
}

void CheckBattery(const MissionRecord& record) {
  for (const TimestepRecord& step : record.steps)
    Require(step.battery_j >= 0.0, Invariant::kBatteryNotNegative, "timestep {}: {} J are left", step.k,
            step.battery_j);
  Require(record.battery_left_j >= 0.0, Invariant::kBatteryNotNegative, "mission: {} J are left",
          record.battery_left_j);
}

void CheckPositions(const MissionRecord& record, const world::Scene& scene, double gust_mps) {
  const double tolerance_m = kPositionToleranceM + robot::kSettleLimitS * gust_mps;
  const auto check = [&](std::int64_t k, double x_m, double y_m, double z_m) {
    const Eigen::Vector3d& size_m = scene.SizeM();
    const double ground_m = scene.Ground().HeightAt(x_m, y_m);
    for (const auto& [name, at, low, high] :
         {std::tuple{"x_m", x_m, 0.0, size_m.x()}, std::tuple{"y_m", y_m, 0.0, size_m.y()},
          std::tuple{"z_m", z_m, ground_m, size_m.z()}})
      Require(at >= low - tolerance_m && at <= high + tolerance_m, Invariant::kPositionInWorld,
              "timestep {}: {} is {}; the world holds {} .. {}", k, name, at, low, high);
  };
  check(0, record.start_x_m, record.start_y_m, record.start_z_m);
  for (const TimestepRecord& step : record.steps) check(step.k, step.x_m, step.y_m, step.z_m);
}

void CheckProbabilities(const MissionRecord& record) {
  for (const TimestepRecord& step : record.steps)
    for (const auto& [name, value] :
         {std::pair{"scs", step.scs}, std::pair{"fire_only_scs", step.fire_only_scs},
          std::pair{"confidence_mean", step.confidence_mean}, std::pair{"confidence_sd", step.confidence_sd},
          std::pair{"fire_share", step.fire_share}, std::pair{"smoke_share", step.smoke_share},
          std::pair{"epsilon", step.epsilon}})
      Require(value >= -kProbabilityTolerance && value <= 1.0 + kProbabilityTolerance,
              Invariant::kProbabilityInRange, "timestep {}: {} is {}", step.k, name, value);
}

}  // namespace ed3r::mission
