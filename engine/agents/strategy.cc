#include "engine/agents/strategy.h"

#include <fmt/format.h>

#include "engine/core/check.h"
#include "engine/core/suggest.h"

namespace ed3r {
namespace {

constexpr AllowedExecutions kAll{};
constexpr AllowedExecutions kFullOnly{.offload = false, .full = true, .quantized = false};
constexpr AllowedExecutions kQuantizedOnly{.offload = false, .full = false, .quantized = true};
constexpr AllowedExecutions kLocal{.offload = false, .full = true, .quantized = true};
constexpr AllowedExecutions kOffloadOnly{.offload = true, .full = false, .quantized = false};

constexpr auto kNet = MotionPolicy::kNetwork;
constexpr auto kWalk = MotionPolicy::kRandom;

// clang-format off
constexpr Strategy kStrategies[] = {
    // name             motion  robot's choice             among           completion  regions  networks from
    {"random",          kWalk,  ExecutionPolicy::kRandom,  kAll,           false,      false,   ""},
    {"random-offload",  kWalk,  ExecutionPolicy::kRandom,  kOffloadOnly,   false,      false,   ""},
    {"rbs",             kWalk,  ExecutionPolicy::kRules,   kAll,           true,       false,   ""},
    {"ed3r",            kNet,   ExecutionPolicy::kNetwork, kAll,           true,       true,    "random"},
    {"ablation-1",      kNet,   ExecutionPolicy::kNetwork, kFullOnly,      true,       true,    "random"},
    {"ablation-2",      kNet,   ExecutionPolicy::kNetwork, kQuantizedOnly, true,       true,    "random"},
    {"ablation-3",      kNet,   ExecutionPolicy::kNetwork, kLocal,         true,       true,    "random"},
    {"ablation-4",      kNet,   ExecutionPolicy::kNetwork, kOffloadOnly,   true,       true,    "random"},
    {"ecd2r",           kNet,   ExecutionPolicy::kNetwork, kOffloadOnly,   true,       true,    "random-offload"},
};
// clang-format on

}  // namespace

bool AllowedExecutions::Allows(Execution execution) const {
  switch (execution) {
    case Execution::kOffload:
      return offload;
    case Execution::kFull:
      return full;
    case Execution::kQuantized:
      return quantized;
  }
  return false;
}

std::span<const Strategy> Strategies() { return kStrategies; }

const Strategy& FindStrategy(std::string_view name) {
  std::vector<std::string> names;
  for (const Strategy& strategy : kStrategies) {
    if (strategy.name == name) return strategy;
    names.emplace_back(strategy.name);
  }
  std::string list;
  for (const std::string& known : names) list += (list.empty() ? "" : " | ") + known;
  const std::string nearest = NearestWord(name, names);
  throw UserError(fmt::format("mission.strategy: '{}' is not allowed; allowed: {}{}", name, list,
                              nearest.empty() ? "" : fmt::format("; did you mean {}?", nearest)));
}

}  // namespace ed3r
