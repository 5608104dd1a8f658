// What holds in every mission, whatever flew it. Checked in every build at the end of each mission, at a cost that does
// not show beside flying it. A mission that breaks one is a failed mission of that class, never a result.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <string_view>

#include "engine/config/field.h"
#include "engine/core/check.h"
#include "engine/mission/record.h"
#include "engine/robot/energy.h"
#include "engine/world/scene.h"

namespace ed3r::mission {

enum class Invariant {
  kMissionEnds,   // within mission.max_timesteps
  kValuesFinite,  // every stored number, predictions without a network apart
  kTimeMonotone,  // timesteps are numbered 1, 2, ..., no part of one is negative, and their sum is the duration
  kLedgerAddsUp,  // energies are powers times times, parts are totals, and the battery gave what was used
  kBatteryNotNegative,  // after every timestep
  kPositionInWorld,     // inside the box and not in the ground
  kProbabilityInRange   // scores, shares of the image and exploration rates are in [0, 1]
};

}  // namespace ed3r::mission

namespace ed3r {

template <>
struct EnumNames<mission::Invariant> {
  static constexpr EnumName<mission::Invariant> kNames[] = {
      {mission::Invariant::kMissionEnds, "mission-ends"},
      {mission::Invariant::kValuesFinite, "values-finite"},
      {mission::Invariant::kTimeMonotone, "time-monotone"},
      {mission::Invariant::kLedgerAddsUp, "ledger-adds-up"},
      {mission::Invariant::kBatteryNotNegative, "battery-not-negative"},
      {mission::Invariant::kPositionInWorld, "position-in-world"},
      {mission::Invariant::kProbabilityInRange, "probability-in-range"}};
};

}  // namespace ed3r

namespace ed3r::mission {

// what() is one line that begins with the invariant's name.
class BrokenInvariant : public InternalError {
 public:
  BrokenInvariant(Invariant invariant, const std::string& detail);
  Invariant Which() const { return invariant_; }

 private:
  Invariant invariant_;
};

// What a record is held against.
struct MissionLimits {
  const robot::MovementPower& power;
  double battery_j;  // at the start
  const world::Scene& scene;
  double gust_mps = 0.0;  // the robot may be carried out of the box by what it cannot hold
  std::span<const double> horizontal_w = {};  // of each timestep's leg, where they differ
};

// Throws BrokenInvariant, the first in the order of the enumeration above.
void CheckInvariants(const MissionRecord& record, const MissionLimits& limits);

// The parts of it.
void CheckFinite(const MissionRecord& record);
void CheckTime(const MissionRecord& record);
void CheckLedger(const MissionRecord& record, const robot::MovementPower& power, double battery_j,
                 std::span<const double> horizontal_w = {});
void CheckBattery(const MissionRecord& record);
void CheckPositions(const MissionRecord& record, const world::Scene& scene, double gust_mps);
void CheckProbabilities(const MissionRecord& record);

}  // namespace ed3r::mission
