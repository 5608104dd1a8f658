// The remote controller: decision-making stage 1, the motion command of timestep k.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "engine/agents/context.h"
#include "engine/agents/early_completion.h"
#include "engine/agents/region_memory.h"
#include "engine/agents/views.h"

namespace ed3r {

struct MotionDecision {
  bool complete = false;  // the mission ends here; no command
  MotionCommand command;
  MotionRule rule = MotionRule::kRandom;
  ConfidenceBand band = ConfidenceBand::kNone;
  double epsilon = 1.0;
  double predicted_reward =
      std::numeric_limits<double>::quiet_NaN();  // of the command; NaN without a network
};

// The candidates of one greedy decision, for `ed3r explain`.
struct CandidateTrace {
  std::vector<MotionCommand> commands;
  std::vector<double> rewards;  // predicted
  std::vector<int> admitted;    // indices that region avoidance left; empty where it left all
  int chosen = -1;
};

class RemoteController {
 public:
  explicit RemoteController(const AgentContext& context);

  // To be called once per timestep, k = 1, 2, ... `trace`, where given, receives the candidates of a greedy decision.
  MotionDecision ChooseMotion(const RcView& view, std::uint32_t timestep, CandidateTrace* trace = nullptr);

 private:
  void ChooseGreedily(const RcView& view, const ActionRanges& ranges, std::uint32_t timestep,
                      MotionDecision& decision, CandidateTrace* trace);
  double Predict(const RcView& view, const MotionCommand& command);

  const AgentContext context_;
  EarlyCompletion completion_;
  RegionMemory regions_;
  Model::Workspace workspace_;
};

}  // namespace ed3r
