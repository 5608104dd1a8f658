#include "engine/sweep/arm_name.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <initializer_list>

#include "engine/sweep/arm_id.h"

namespace ed3r::sweep {
namespace {

constexpr std::string_view kStrategyKey = "mission.strategy";
constexpr std::string_view kThresholdKey = "agents.eta_min";

std::string Leaf(const std::string& key) { return key.substr(key.rfind('.') + 1); }

// The key's last part, or the whole key where another axis has a key that ends alike.
std::string ShortKey(const std::string& key, const std::set<std::string>& axis_keys) {
  const auto alike = std::count_if(axis_keys.begin(), axis_keys.end(),
                                   [&](const std::string& other) { return Leaf(other) == Leaf(key); });
  return alike > 1 ? key : Leaf(key);
}

std::string StrategyName(const Config& config) {
  if (config.mission.strategy == "random") return "warmup";
  if (config.mission.strategy != "ed3r") return config.mission.strategy;
  return fmt::format("ed3r-{:.10g}", 100.0 * config.agents.eta_min);
}

// A value as it stands in a name, which has no mark of a variant.
std::string ValueInName(const Setting& setting) {
  if (!NamesAFile(setting.key)) return setting.canonical;
  std::string stem = std::filesystem::path(setting.canonical).stem().string();
  std::replace(stem.begin(), stem.end(), ArmId::kMark, '_');
  return stem;
}

// What the points set, but for the keys in `told`: "heavy", "cell_m=2".
void AppendPoints(const std::vector<const AxisPoint*>& points, const std::set<std::string>& axis_keys,
                  std::initializer_list<std::string_view> told, std::vector<std::string>& parts) {
  for (const AxisPoint* point : points) {
    if (!point->name.empty()) {
      parts.push_back(point->name);
      continue;
    }
    for (const Setting& setting : point->settings) {
      if (std::find(told.begin(), told.end(), setting.key) != told.end()) continue;
      parts.push_back(fmt::format("{}={}", ShortKey(setting.key, axis_keys), ValueInName(setting)));
    }
  }
}

}  // namespace

std::string ArmName(const Stage& stage, const Config& config, const std::vector<const AxisPoint*>& points,
                    const std::set<std::string>& axis_keys) {
  bool any_named = false;
  bool strategy_varies = false;
  for (const AxisPoint* point : points) {
    any_named |= !point->name.empty();
    for (const Setting& setting : point->settings)
      strategy_varies |= point->name.empty() && setting.key == kStrategyKey;
  }
  std::vector<std::string> parts;
  bool threshold_is_told = false;
  if (strategy_varies || (!any_named && stage.kind == StageKind::kFly)) {
    parts.push_back(StrategyName(config));
    threshold_is_told = config.mission.strategy == "ed3r";
  } else if (!any_named) {
    parts.push_back(stage.name);
  }
  AppendPoints(points, axis_keys, {kStrategyKey, threshold_is_told ? kThresholdKey : kStrategyKey}, parts);
  return fmt::format("{}", fmt::join(parts, ","));
}

std::string VariantName(const std::vector<const AxisPoint*>& points, const std::set<std::string>& axis_keys) {
  std::vector<std::string> parts;
  AppendPoints(points, axis_keys, {}, parts);
  return fmt::format("{}", fmt::join(parts, ","));
}

}  // namespace ed3r::sweep
