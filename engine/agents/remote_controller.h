// The remote controller: decision-making stage 1, the motion command of timestep k.
#pragma once

#include <cstdint>
#include <limits>

#include "engine/agents/early_completion.h"
#include "engine/agents/strategy.h"
#include "engine/agents/views.h"
#include "engine/config/config.h"

namespace ed3r {

struct MotionDecision {
  bool complete = false;  // the mission ends here; no command
  MotionCommand command;
  MotionRule rule = MotionRule::kRandom;
  ConfidenceBand band = ConfidenceBand::kNone;
  double epsilon = 1.0;
  double predicted_reward = std::numeric_limits<double>::quiet_NaN();  // where no network was asked
};

class RemoteController {
 public:
  RemoteController(const Config& config, const Strategy& strategy, std::uint64_t seed,
                   std::uint32_t scenario);

  MotionDecision ChooseMotion(const RcView& view, std::uint32_t timestep);

 private:
  const Config& config_;
  const Strategy& strategy_;
  std::uint64_t seed_;
  std::uint32_t scenario_;
  EarlyCompletion completion_;
};

}  // namespace ed3r
