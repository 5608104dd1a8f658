// Adaptive Early Mission Completion at the RC (the paper's Algorithm; R21, R22).
#pragma once

#include <optional>

#include "engine/agents/action_ranges.h"
#include "engine/agents/decisions.h"

namespace ed3r::agents {

// What the Algorithm orders for timestep k.
struct CompletionOrder {
  bool complete = false;  // line 5
  bool hover = false;     // line 4
  ConfidenceBand band = ConfidenceBand::kNone;
  ActionRanges ranges;
  std::optional<double> epsilon;  // forced value; none where normal operation decides (R20)
};

class EarlyCompletion {
 public:
  explicit EarlyCompletion(const AgentsConfig& agents);

  // To be called once per timestep with eta_{k-1} (0 before the first detection).
  CompletionOrder Next(double previous_scs);

 private:
  AgentsConfig agents_;
  ActionRanges ranges_;
  int stop_count_ = 0;  // c_stop
  int low_count_ = 0;   // c_low
};

}  // namespace ed3r::agents
