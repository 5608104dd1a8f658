// Sweep files (YAML): strict parse and expansion into a SweepPlan.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/sweep/plan.h"

namespace ed3r {

struct SweepOverrides {
  std::vector<std::string> set;  // "key=value"
  std::optional<std::uint64_t> seed;
  std::optional<int> missions;  // per arm, in every flying stage
};

constexpr std::int64_t kMaxMissions = 10'000'000;  // a plan with more is refused
constexpr int kMaxArms = 10'000;

// Reads, checks and expands. Throws UserError with one line "file:line:column: ..." that names the key, the
// value, the allowed range and the nearest known key. Reads only; writes nothing.
SweepPlan LoadSweep(const std::string& file, const SweepOverrides& overrides = {});

}  // namespace ed3r
