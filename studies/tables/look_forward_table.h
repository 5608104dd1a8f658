// How far the RC network's predictions of a timestep's reward are off, and what the paper's look-forward accuracy may mean by
// it (R29): 1 - mean error of a mission / a largest error, which the paper does not define.
#pragma once

#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "studies/metrics/arm.h"

namespace ed3r::tables {

// The largest error may be the largest mean error of a mission, among the missions averaged over (the P85 group's own), the
// arm's or all arms'; or the largest error of one timestep, the arm's or all arms'. Always that of the network that flew:
// networks of one number come from one seed.
enum class WorstOf { kGroup, kArm, kAllArms, kArmTimestep, kAllTimesteps };
inline constexpr WorstOf kWorstOfs[] = {WorstOf::kGroup, WorstOf::kArm, WorstOf::kAllArms,
                                        WorstOf::kArmTimestep, WorstOf::kAllTimesteps};

struct LookForward {
  std::string arm;
  int missions = 0;              // with predictions
  double mean_error = 0.0;       // of a mission's mean error
  double largest_mission = 0.0;  // mean error
  double largest_timestep = 0.0;
  // Percent, by WorstOf: over all missions, and over the P85 group (NaN where it has no predictions).
  double accuracy[std::size(kWorstOfs)] = {}, p85_accuracy[std::size(kWorstOfs)] = {};
};

// Arms with predictions alone.
std::vector<LookForward> LookForwardOf(std::span<const metrics::ArmData> arms);

// What the paper prints: the P85 values of ED3R-75 and ECD2R above their means; every ablation above ED3R-75; ECD2R above
// ED3R-75. Each part is none where its arms are missing.
struct LookForwardPattern {
  std::optional<bool> p85_above_mean, ablations_above_ed3r, ecd2r_above_ed3r;
  bool Holds() const {
    return p85_above_mean == true && ablations_above_ed3r == true && ecd2r_above_ed3r == true;
  }
};
LookForwardPattern PatternOf(const std::vector<LookForward>& arms, WorstOf definition);

// Empty without predictions.
std::string LookForwardText(const std::vector<LookForward>& arms);
// Columns arm,missions,mean_error,largest_mission,largest_timestep, then accuracy_ and p85_accuracy_ of group, arm, all_arms,
// arm_timestep, all_timesteps; an empty cell is none.
std::string LookForwardCsv(const std::vector<LookForward>& arms);
// The same rows as objects, none as null, and "pattern" by definition.
nlohmann::ordered_json LookForwardJson(const std::vector<LookForward>& arms);

}  // namespace ed3r::tables
