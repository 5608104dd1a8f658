#include "engine/agents/strategy.h"

#include <fmt/format.h>

#include <vector>

#include "engine/agents/context.h"
#include "engine/agents/strategies/direct.h"
#include "engine/agents/strategies/drawn_execution.h"
#include "engine/agents/strategies/greedy_execution.h"
#include "engine/agents/strategies/greedy_motion.h"
#include "engine/agents/strategies/look_level.h"
#include "engine/agents/strategies/outside.h"
#include "engine/agents/strategies/random_walk.h"
#include "engine/agents/strategies/rbs_execution.h"
#include "engine/core/check.h"
#include "engine/core/suggest.h"

namespace ed3r::agents {
namespace {

template <class Policy>
std::unique_ptr<MotionPolicy> MakeMotion(const AgentContext& context) {
  return std::make_unique<Policy>(context);
}

template <class Policy>
std::unique_ptr<ExecutionPolicy> MakeExecution(const AgentContext& context) {
  return std::make_unique<Policy>(context);
}

// A network that decides by itself takes the place of one that scores actions.
std::unique_ptr<MotionPolicy> MakeBestMotion(const AgentContext& context) {
  if (context.networks.direct_rc != nullptr) return std::make_unique<DirectMotion>(context);
  return std::make_unique<GreedyMotion>(context);
}
std::unique_ptr<ExecutionPolicy> MakeBestExecution(const AgentContext& context) {
  if (context.networks.direct_robot != nullptr) return std::make_unique<DirectExecution>(context);
  return std::make_unique<GreedyExecution>(context);
}

constexpr AllowedExecutions kAll{};
constexpr AllowedExecutions kLocal{.offload = false, .full = true, .quantized = true};
constexpr AllowedExecutions kOffloadOnly{.offload = true, .full = false, .quantized = false};
constexpr AllowedExecutions kFullOnly{.offload = false, .full = true, .quantized = false};
constexpr AllowedExecutions kQuantizedOnly{.offload = false, .full = false, .quantized = true};

template <class Policy>
constexpr MotionPart kMotion{MakeMotion<Policy>};
template <class Policy>
constexpr ExecutionPart kExecution{MakeExecution<Policy>, kAll};

constexpr MotionPart kWalk = kMotion<RandomWalk>;
constexpr MotionPart kGreedy{MakeBestMotion, true};
constexpr ExecutionPart kBest{MakeBestExecution, kAll, true};
constexpr ExecutionPart kBestLocal{MakeBestExecution, kLocal, true};
constexpr ExecutionPart kOffload{MakeExecution<OnlyExecution<Execution::kOffload>>, kOffloadOnly};
constexpr ExecutionPart kFull{MakeExecution<OnlyExecution<Execution::kFull>>, kFullOnly};
constexpr ExecutionPart kQuantized{MakeExecution<OnlyExecution<Execution::kQuantized>>, kQuantizedOnly};

// clang-format off
constexpr Strategy kStrategies[] = {
    // name            the RC moves it by   the robot detects by           completion  networks from
    {"random",         kWalk,               kExecution<DrawnExecution>,    false,      ""},
    {"random-offload", kWalk,               kOffload,                      false,      ""},
    {"rbs",            kWalk,               kExecution<RbsExecution>,      true,       ""},
    {"ed3r",           kGreedy,             kBest,                         true,       "random"},
    {"ablation-1",     kGreedy,             kFull,                         true,       "random"},
    {"ablation-2",     kGreedy,             kQuantized,                    true,       "random"},
    {"ablation-3",     kGreedy,             kBestLocal,                    true,       "random"},
    {"ablation-4",     kGreedy,             kOffload,                      true,       "random"},
    {"ecd2r",          kGreedy,             kOffload,                      true,       "random-offload"},
    {"look-level",     kMotion<LookLevel>,  kQuantized,                    true,       ""},
    {kOutsideStrategy, kMotion<OutsideMotion>, kExecution<OutsideExecution>, true,     "", true},
};
// clang-format on

}  // namespace

std::span<const Strategy> Strategies() { return kStrategies; }

std::string CheckStrategyName(std::string_view name) {
  std::vector<std::string> names;
  std::string list;
  for (const Strategy& strategy : kStrategies) {
    if (strategy.name == name) return "";
    names.emplace_back(strategy.name);
    list += (list.empty() ? "" : " | ") + names.back();
  }
  const std::string nearest = NearestWord(name, names);
  return fmt::format("mission.strategy: '{}' is not allowed; allowed: {}{}", name, list,
                     nearest.empty() ? "" : fmt::format("; did you mean {}?", nearest));
}

const Strategy& FindStrategy(std::string_view name) {
  for (const Strategy& strategy : kStrategies)
    if (strategy.name == name) return strategy;
  throw UserError(CheckStrategyName(name));
}

}  // namespace ed3r::agents
