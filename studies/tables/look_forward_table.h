// How far the RC network's predictions of a timestep's reward are off, and what the paper's look-forward accuracy may mean by
// it (R29): 1 - mean error of a mission / a largest mean error, which the paper does not define.
#pragma once

#include <limits>
#include <span>
#include <string>
#include <vector>

#include "studies/metrics/arm.h"

namespace ed3r {

// The largest mean error of a mission may be that of the missions averaged over, of the arm, or of all arms.
enum class WorstOf { kGroup, kArm, kAllArms };
inline constexpr WorstOf kWorstOfs[] = {WorstOf::kGroup, WorstOf::kArm, WorstOf::kAllArms};

struct LookForward {
  std::string arm;
  int missions = 0;              // with predictions
  double mean_error = 0.0;       // of a mission's mean error
  double largest_mission = 0.0;  // mean error
  double largest_timestep = 0.0;
  // Percent, by WorstOf: over all missions, and over the P85 group (NaN where it has none). Worst missions are those of the
  // network that flew.
  double accuracy[3] = {}, p85_accuracy[3] = {};
};

// Arms with predictions alone.
std::vector<LookForward> LookForwardOf(std::span<const ArmData> arms);

// Whether a definition gives what the paper prints: the P85 value of ED3R-75 above its mean, that of every ablation above it.
// False where arms are missing.
bool GivesThePapersPattern(const std::vector<LookForward>& arms, WorstOf definition);

// Empty without predictions.
std::string LookForwardText(const std::vector<LookForward>& arms);
// Columns arm,missions,mean_error,largest_mission,largest_timestep, then accuracy_ and p85_accuracy_ of group, arm, all_arms.
std::string LookForwardCsv(const std::vector<LookForward>& arms);

}  // namespace ed3r
