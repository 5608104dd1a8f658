#include "engine/app/idle_settings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <set>
#include <string_view>

#include "engine/config/parameters.h"
#include "engine/schedule/training_stage.h"

namespace ed3r::app {
namespace {

struct Rule {
  std::vector<std::string_view> begins;  // of keys; a whole key is the beginning of itself
  std::function<bool(const Config&)> acts;
  const char* why;
  bool in_each_arm = false;  // said of the arms that do not heed it, though others do
};

bool BillsAirspeeds(const Config& config) { return config.energy.model == PowerModel::kMomentum; }

const std::vector<Rule>& Rules() {
  static const std::vector<Rule> rules = {
      {{"environment.wind_"},
       BillsAirspeeds,
       "wind is flown in and not billed: the paper's powers are those of still air (energy.model momentum "
       "bills "
       "airspeeds)",
       true},
      {{"energy.momentum_efficiency", "energy.induced_factor", "energy.profile_share", "energy.interference",
        "energy.drag_area_m2"},
       BillsAirspeeds,
       "only energy.model momentum heeds this"},
      {{"mission.start_yaw_deg"},
       [](const Config& config) { return config.mission.start_yaw == StartYaw::kFixed; },
       "only mission.start_yaw fixed heeds this"},
      {{"perception.render.", "perception.detector."},
       [](const Config& config) { return config.perception.tier == PerceptionTier::kPixels; },
       "only perception.tier pixels heeds this"},
      {{"perception.full.", "perception.quantized."},
       [](const Config& config) { return config.perception.tier == PerceptionTier::kProfile; },
       "only perception.tier profile heeds this"},
      {{"training."}, schedule::NeedsTraining, "no arm asks a network that is trained"},
  };
  return rules;
}

bool Begins(const Rule& rule, std::string_view key) {
  return std::any_of(rule.begins.begin(), rule.begins.end(),
                     [&](std::string_view begin) { return key.starts_with(begin); });
}

}  // namespace

std::vector<std::string> IdleSettings(const sweep::SweepPlan& plan) {
  std::vector<const sweep::Arm*> all;
  for (const sweep::Stage& stage : plan.stages)
    for (const sweep::Arm& arm : stage.arms) all.push_back(&arm);
  std::vector<std::string> sentences;
  for (const Rule& rule : Rules()) {
    std::vector<const Config*> arms;  // that do not heed it
    std::set<std::string> names;
    for (const sweep::Arm* arm : all)
      if (!rule.acts(arm->config)) arms.push_back(&arm->config), names.insert(arm->name);
    const bool some = arms.size() < all.size();
    if (some && !rule.in_each_arm) continue;
    std::vector<std::string> keys;
    for (const ParameterInfo& parameter : Parameters())
      if (Begins(rule, parameter.key) && std::any_of(arms.begin(), arms.end(), [&](const Config* config) {
            return GetParameter(*config, parameter.key) != parameter.default_value;
          }))
        keys.push_back(parameter.key);
    if (!keys.empty())
      sentences.push_back(fmt::format("{}{}: {}", fmt::join(keys, ", "),
                                      some ? fmt::format(", in {}", fmt::join(names, ", ")) : "", rule.why));
  }
  return sentences;
}

}  // namespace ed3r::app
