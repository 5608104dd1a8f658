// The strategies as data: who decides what (paper: Result 2, Table of ablations; Appendix, Baselines; R25,
// R26).
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/agents/decisions.h"

namespace ed3r {

enum class MotionPolicy { kRandom, kNetwork };
enum class ExecutionPolicy { kRandom, kRules, kNetwork };

// Set of Execution values that a robot may choose from.
struct AllowedExecutions {
  bool offload = true;
  bool full = true;
  bool quantized = true;

  bool Allows(Execution execution) const;
  int Count() const { return int{offload} + int{full} + int{quantized}; }
};

struct Strategy {
  std::string_view name;
  MotionPolicy motion;        // how the RC chooses motion
  ExecutionPolicy execution;  // how the robot chooses among `allowed`; a single one is fixed
  AllowedExecutions allowed;
  bool early_completion;
  bool region_avoidance;
  std::string_view networks;  // warm-up whose networks it uses: a strategy name, "" for none
};

std::span<const Strategy> Strategies();

// Throws UserError that lists the names for an unknown one.
const Strategy& FindStrategy(std::string_view name);

}  // namespace ed3r
