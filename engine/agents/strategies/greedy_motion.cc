#include "engine/agents/strategies/greedy_motion.h"

#include <numeric>

#include "engine/agents/features.h"
#include "engine/core/check.h"
#include "engine/core/random.h"

namespace ed3r::agents {
namespace {

// Candidate actions as rows for the network.
void FillRows(const std::vector<robot::MotionCommand>& commands, const std::vector<int>& indices,
              std::vector<float>& rows) {
  rows.clear();
  for (const int index : indices) {
    const RcAction action = ActionOf(commands[static_cast<std::size_t>(index)]);
    rows.insert(rows.end(), action.begin(), action.end());
  }
}

// Where each candidate would end.
std::vector<Eigen::Vector3d> Ends(const RcView& view, const std::vector<robot::MotionCommand>& commands,
                                  const Eigen::Vector3d& size_m) {
  std::vector<Eigen::Vector3d> ends_m;
  ends_m.reserve(commands.size());
  for (const robot::MotionCommand& command : commands)
    ends_m.push_back(
        (view.pose.position_m + command.displacement_m).cwiseMax(Eigen::Vector3d::Zero()).cwiseMin(size_m));
  return ends_m;
}

}  // namespace

GreedyMotion::GreedyMotion(const AgentContext& context)
    : context_(context), regions_(context.config.agents, context.size_m) {
  ED3R_CHECK(context.networks.rc != nullptr, "the strategy asks the RC's network, and there is none");
}

MotionChoice GreedyMotion::Choose(const MotionQuestion& question) {
  const bool explores =
      Stream(context_.seed, context_.scenario, Purpose::kExploration, question.timestep).Uniform() <
      question.epsilon;
  return explores ? Explore(question) : TakeBest(question);
}

MotionChoice GreedyMotion::Explore(const MotionQuestion& question) {
  Stream stream(context_.seed, context_.scenario, Purpose::kMotion, question.timestep);
  MotionChoice choice;
  choice.epsilon = question.epsilon;
  choice.command = DrawCommand(question.ranges, context_.config.agents, question.view.pose.tilt_rad, stream);
  choice.predicted_reward = Predict(question.view, choice.command);
  return choice;
}

MotionChoice GreedyMotion::TakeBest(const MotionQuestion& question) {
  const AgentsConfig& agents = context_.config.agents;
  const RcView& view = question.view;
  Stream stream(context_.seed, context_.scenario, Purpose::kCandidates, question.timestep);
  commands_.resize(static_cast<std::size_t>(agents.candidates));
  for (robot::MotionCommand& command : commands_)
    command = DrawCommand(question.ranges, agents, view.pose.tilt_rad, stream);

  RegionMemory::Selection selection;
  if (agents.region_avoidance && regions_.Stuck(view.pose.position_m))
    selection = regions_.Select(Ends(view, commands_, context_.size_m));
  std::vector<int> indices = selection.candidates;
  if (indices.empty()) {
    indices.resize(commands_.size());
    std::iota(indices.begin(), indices.end(), 0);
  }

  FillRows(commands_, indices, rows_);
  rewards_.resize(indices.size());
  const rfnn::BestAction best = context_.networks.rc->Best(StateOf(view), rows_, rewards_, workspace_);
  const int chosen = indices[static_cast<std::size_t>(best.index)];
  if (question.trace != nullptr)
    *question.trace = {commands_, rewards_, std::move(selection.candidates), chosen};
  return {.command = commands_[static_cast<std::size_t>(chosen)],
          .rule = selection.rule,
          .epsilon = question.epsilon,
          .predicted_reward = best.reward};
}

double GreedyMotion::Predict(const RcView& view, const robot::MotionCommand& command) {
  return context_.networks.rc->Predict(StateOf(view), ActionOf(command), workspace_);
}

}  // namespace ed3r::agents
