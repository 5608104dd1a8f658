// The robot agent: decision-making stage 2, where and how detection is executed in timestep k.
#pragma once

#include <cstdint>
#include <limits>

#include "engine/agents/strategy.h"
#include "engine/agents/views.h"
#include "engine/config/config.h"
#include "engine/core/random.h"

namespace ed3r {

struct ExecutionDecision {
  Execution execution = Execution::kFull;
  bool random = false;  // drawn, not deduced
  double predicted_reward = std::numeric_limits<double>::quiet_NaN();
};

class RobotAgent {
 public:
  RobotAgent(const Config& config, const Strategy& strategy, std::uint64_t seed, std::uint32_t scenario);

  ExecutionDecision ChooseExecution(const RobotView& view, std::uint32_t timestep) const;

 private:
  const Config& config_;
  const Strategy& strategy_;
  std::uint64_t seed_;
  std::uint32_t scenario_;
};

// The distributed rule-based heuristic (Appendix, Baselines; R25). Takes exactly two draws.
ExecutionDecision DecideByRules(const RbsConfig& rbs, const RobotView& view, Stream& stream);

}  // namespace ed3r
