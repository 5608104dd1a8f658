// How a strategy's remote controller chooses a motion command (decision-making stage 1). What every strategy shares, the
// Algorithm's hovering and ranges, is the remote controller's own (remote_controller.h).
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "engine/agents/action_ranges.h"
#include "engine/agents/decisions.h"
#include "engine/agents/views.h"
#include "engine/robot/motion.h"

namespace ed3r::agents {

// The candidates of one greedy decision, for `ed3r explain`.
struct CandidateTrace {
  std::vector<robot::MotionCommand> commands;
  std::vector<double> rewards;  // predicted
  std::vector<int> admitted;    // indices that region avoidance left; empty where it left all
  int chosen = -1;
};

struct MotionQuestion {
  const RcView& view;
  const ActionRanges& ranges;  // A_RC,k: a command lies inside them
  double epsilon = 1.0;        // share of random actions that is asked for (R20)
  std::uint32_t timestep = 1;
  CandidateTrace* trace = nullptr;  // receives the candidates where there are any
};

struct MotionChoice {
  robot::MotionCommand command;
  MotionRule rule = MotionRule::kRandom;
  double epsilon = 1.0;  // in force: the question's where the policy explores by it
  double predicted_reward =
      std::numeric_limits<double>::quiet_NaN();  // of the command; NaN without a network
};

// One mission, one thread. Draws come from streams keyed by (seed, scenario, purpose, timestep) alone.
class MotionPolicy {
 public:
  virtual ~MotionPolicy() = default;

  // What the RC sees in each timestep from the second on, before anything is decided, hovering timesteps included.
  virtual void Observe(const RcView& view) { static_cast<void>(view); }

  virtual MotionChoice Choose(const MotionQuestion& question) = 0;

  // The reward that it expects of a command that was not its own choice; NaN where it expects none.
  virtual double Predict(const RcView& view, const robot::MotionCommand& command) {
    static_cast<void>(view), static_cast<void>(command);
    return std::numeric_limits<double>::quiet_NaN();
  }
};

}  // namespace ed3r::agents
