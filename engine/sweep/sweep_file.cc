#include "engine/sweep/sweep_file.h"

#include <fmt/format.h>

#include <map>

#include "engine/sweep/expand.h"
#include "engine/sweep/sweep_source.h"

namespace ed3r::sweep {
namespace {

std::vector<Setting> ReadOverrides(const std::vector<std::string>& written, const std::string& file,
                                   const ValueCheck& check) {
  const SettingReader reader("", FolderOf(file), false, check);
  std::vector<Setting> settings;
  std::map<std::string, std::string> places;
  for (const std::string& text : written) {
    const std::string at = "--set " + text;
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos) FailAt(at, "is not allowed; allowed: KEY=VALUE");
    if (text.substr(0, equals) == kAirframeKey) {
      // An airframe file; a later or earlier --set of one of its keys is a duplicate like any other.
      const auto [first, is_new] = places.emplace(kAirframeKey, at);
      if (!is_new) FailAt(at, fmt::format("robot: is set twice, first by {}", first->second));
      for (Setting& setting : ReadAirframeFile(text.substr(equals + 1), at)) {
        if (!places.emplace(setting.key, at).second) FailAt(at, fmt::format("{}: is set twice", setting.key));
        settings.push_back(std::move(setting));
      }
      continue;
    }
    settings.push_back(reader.Read(text.substr(0, equals), at, text.substr(equals + 1), at));
    const auto [first, is_new] = places.emplace(settings.back().key, at);
    if (!is_new) FailAt(at, fmt::format("{}: is set twice, first by {}", settings.back().key, first->second));
  }
  return settings;
}

MissionCounts CheckedMissions(const std::vector<MissionsOverride>& overrides) {
  MissionCounts counts;
  for (const auto& [stage, value] : overrides) {
    const std::string at = fmt::format("--missions {}{}{}", stage, stage.empty() ? "" : "=", value);
    if (value < 1 || value > kMaxMissions)
      FailAt(at, fmt::format("missions: '{}' is not allowed; allowed: 1 .. {}", value, kMaxMissions));
    const auto [first, is_new] = counts.emplace(stage, WrittenCount{value, at});
    if (!is_new) FailAt(at, fmt::format("missions: is said twice, first by {}", first->second.at));
  }
  return counts;
}

}  // namespace

SweepPlan LoadSweep(const std::string& file, const SweepOverrides& overrides, const ValueCheck& check) {
  const SweepSource source = ReadSweepSource(file, check);
  if (!source.name) FailAt(source.at, "name: is missing; a sweep's name is that of its results");
  SweepPlan plan;
  plan.name = *source.name;
  plan.question = source.question;
  plan.file = file;
  plan.seed = overrides.seed.value_or(source.seed.value_or(0));
  plan.stages =
      ExpandStages(source, ReadOverrides(overrides.set, file, check), CheckedMissions(overrides.missions));
  return plan;
}

}  // namespace ed3r::sweep
