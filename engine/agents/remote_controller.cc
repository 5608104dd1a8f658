#include "engine/agents/remote_controller.h"

#include "engine/agents/features.h"
#include "engine/core/check.h"
#include "engine/core/random.h"

namespace ed3r {
namespace {

// Candidate actions as rows for the network, and where each would end.
std::vector<float> Rows(const std::vector<MotionCommand>& commands, const std::vector<int>& indices) {
  std::vector<float> rows;
  rows.reserve(indices.size() * std::tuple_size_v<RcAction>);
  for (const int index : indices) {
    const RcAction action = ActionOf(commands[static_cast<std::size_t>(index)]);
    rows.insert(rows.end(), action.begin(), action.end());
  }
  return rows;
}

std::vector<Eigen::Vector3d> Ends(const RcView& view, const std::vector<MotionCommand>& commands,
                                  const Eigen::Vector3d& size_m) {
  std::vector<Eigen::Vector3d> ends_m;
  ends_m.reserve(commands.size());
  for (const MotionCommand& command : commands)
    ends_m.push_back(
        (view.pose.position_m + command.displacement_m).cwiseMax(Eigen::Vector3d::Zero()).cwiseMin(size_m));
  return ends_m;
}

}  // namespace

RemoteController::RemoteController(const AgentContext& context)
    : context_(context), completion_(context.config.agents), regions_(context.config.agents, context.size_m) {
  ED3R_CHECK(context.strategy.motion != MotionPolicy::kNetwork || context.networks.rc != nullptr,
             "the strategy asks the RC's network, and there is none");
}

MotionDecision RemoteController::ChooseMotion(const RcView& view, std::uint32_t timestep,
                                              CandidateTrace* trace) {
  const AgentsConfig& agents = context_.config.agents;
  MotionDecision decision;
  decision.epsilon = context_.epsilon;
  ActionRanges ranges = ActionRanges::Full(agents);
  if (timestep > 1) regions_.Visit(view.pose.position_m, view.previous_scs);
  if (context_.strategy.early_completion && agents.early_completion) {
    const CompletionOrder order = completion_.Next(view.previous_scs);
    decision.band = order.band;
    decision.complete = order.complete;
    decision.epsilon = order.epsilon.value_or(context_.epsilon);
    ranges = order.ranges;
    if (order.hover) {
      decision.rule = MotionRule::kHover;
      decision.command = {.tilt_rad = view.pose.tilt_rad, .hover = true};
      decision.predicted_reward = Predict(view, decision.command);
      return decision;
    }
  }
  const bool explores =
      Stream(context_.seed, context_.scenario, Purpose::kExploration, timestep).Uniform() < decision.epsilon;
  if (context_.strategy.motion == MotionPolicy::kNetwork && !explores) {
    ChooseGreedily(view, ranges, timestep, decision, trace);
    return decision;
  }
  if (context_.strategy.motion == MotionPolicy::kRandom) decision.epsilon = 1.0;
  Stream stream(context_.seed, context_.scenario, Purpose::kMotion, timestep);
  decision.command = DrawCommand(ranges, agents, view.pose.tilt_rad, stream);
  decision.predicted_reward = Predict(view, decision.command);
  return decision;
}

void RemoteController::ChooseGreedily(const RcView& view, const ActionRanges& ranges, std::uint32_t timestep,
                                      MotionDecision& decision, CandidateTrace* trace) {
  const AgentsConfig& agents = context_.config.agents;
  Stream stream(context_.seed, context_.scenario, Purpose::kCandidates, timestep);
  std::vector<MotionCommand> commands(static_cast<std::size_t>(agents.candidates));
  for (MotionCommand& command : commands) command = DrawCommand(ranges, agents, view.pose.tilt_rad, stream);

  RegionMemory::Selection selection;
  if (context_.strategy.region_avoidance && agents.region_avoidance && regions_.Stuck(view.pose.position_m))
    selection = regions_.Select(Ends(view, commands, context_.size_m));
  std::vector<int> indices = selection.candidates;
  if (indices.empty())
    for (int i = 0; i < agents.candidates; ++i) indices.push_back(i);

  std::vector<double> rewards(indices.size());
  const BestAction best =
      context_.networks.rc->Best(StateOf(view), Rows(commands, indices), rewards, workspace_);
  const int chosen = indices[static_cast<std::size_t>(best.index)];
  decision.command = commands[static_cast<std::size_t>(chosen)];
  decision.rule = selection.rule;
  decision.predicted_reward = best.reward;
  if (trace != nullptr)
    *trace = {std::move(commands), std::move(rewards), std::move(selection.candidates), chosen};
}

double RemoteController::Predict(const RcView& view, const MotionCommand& command) {
  if (context_.networks.rc == nullptr) return std::numeric_limits<double>::quiet_NaN();
  return context_.networks.rc->Predict(StateOf(view), ActionOf(command), workspace_);
}

}  // namespace ed3r
