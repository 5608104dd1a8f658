// ED3R's motion: the candidate with the largest reward that the RC's network predicts, exploring with epsilon, and the
// Region Avoidance Mechanism, which leaves fewer candidates where the robot is stuck (R19, R20, R23).
#pragma once

#include <vector>

#include "engine/agents/context.h"
#include "engine/agents/motion_policy.h"
#include "engine/agents/region_memory.h"

namespace ed3r::agents {

class GreedyMotion : public MotionPolicy {
 public:
  // InternalError without a network of the RC.
  explicit GreedyMotion(const AgentContext& context);

  void Observe(const RcView& view) override { regions_.Visit(view.pose.position_m, view.previous_scs); }
  MotionChoice Choose(const MotionQuestion& question) override;
  double Predict(const RcView& view, const robot::MotionCommand& command) override;

 private:
  MotionChoice Explore(const MotionQuestion& question);
  MotionChoice TakeBest(const MotionQuestion& question);

  const AgentContext context_;
  RegionMemory regions_;
  rfnn::Model::Workspace workspace_;
  // Of one decision; kept so that the next needs no memory of its own.
  std::vector<robot::MotionCommand> commands_;
  std::vector<float> rows_;
  std::vector<double> rewards_;
};

}  // namespace ed3r::agents
