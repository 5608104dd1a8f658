#include "studies/figures/run_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <set>
#include <sstream>

#include "engine/core/check.h"

namespace ed3r {
namespace {

std::vector<std::string> SplitList(const std::string& text) {
  std::vector<std::string> parts;
  std::istringstream list(text);
  for (std::string part; std::getline(list, part, ',');) parts.push_back(part);
  return parts;
}

// Lower is tried first.
int Rank(const ArmPlan& plan) { return plan.warmup ? 2 : plan.name == "ed3r-75" ? 0 : 1; }

// The mission of the median duration among those that ended so; equally long ones in mission order.
std::optional<RunId> MedianMission(ResultReader& reader, int stage, int arm, Outcome outcome) {
  std::vector<std::pair<double, int>> ended_so;
  reader.ForEachMission(stage, arm, Steps::kSkip, [&](const StoredMission& mission) {
    if (mission.record.outcome == static_cast<std::int64_t>(outcome))
      ended_so.emplace_back(mission.record.duration_s, mission.id.mission);
  });
  if (ended_so.empty()) return std::nullopt;
  std::sort(ended_so.begin(), ended_so.end());
  return RunId{stage, arm, ended_so[(ended_so.size() - 1) / 2].second};
}

// Indices of the flying arms of the layout, those that are tried first in front.
struct Candidate {
  int stage, arm;
  const ArmPlan* plan;
};

std::vector<Candidate> Candidates(const RunLayout& layout, std::span<const ArmPlan> plans) {
  std::vector<Candidate> candidates;
  for (int s = 0; s < static_cast<int>(layout.stages.size()); ++s)
    for (int a = 0; a < static_cast<int>(layout.stages[s].arms.size()); ++a)
      for (const ArmPlan& plan : plans)
        if (layout.stages[s].missions > 0 && plan.stage == layout.stages[s].name &&
            plan.name == layout.stages[s].arms[a].name)
          candidates.push_back({s, a, &plan});
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return Rank(*a.plan) < Rank(*b.plan); });
  return candidates;
}

}  // namespace

std::string ArmPlan::Setting(const std::string& key) const {
  const auto found = settings.find(key);
  return found == settings.end() ? "" : found->second;
}

std::vector<ArmPlan> ReadArmPlans(std::string_view plan_text) {
  std::vector<ArmPlan> plans;
  std::set<std::string> warmups;
  std::string stage, kind;
  std::optional<Precision> precision;
  std::istringstream lines{std::string(plan_text)};
  for (std::string line; std::getline(lines, line);) {
    const auto equals = line.find('=');
    if (equals == std::string::npos) continue;
    const std::string key = line.substr(0, equals), value = line.substr(equals + 1);
    if (key == "stage") {
      stage = value;
      precision.reset();
    } else if (key == "precision") {
      std::istringstream words(value);
      words >> precision.emplace().metric >> precision->half_width >> precision->every;
    } else if (key == "kind") {
      kind = value;
    } else if (key == "after") {
      if (kind == "train")
        for (const std::string& name : SplitList(value)) warmups.insert(name);
    } else if (key == "arm") {
      plans.push_back({.stage = stage, .name = value, .settings = {}, .precision = precision});
    } else if (key.find('.') != std::string::npos && !plans.empty()) {
      plans.back().settings[key] = value;
    }
  }
  for (ArmPlan& plan : plans) plan.warmup = warmups.contains(plan.stage);
  return plans;
}

std::vector<ShownMission> PickMissions(ResultReader& reader, std::span<const ArmPlan> plans) {
  std::vector<ShownMission> shown;
  std::optional<std::string> world;
  for (const Outcome outcome : {Outcome::kSuccess, Outcome::kFalsePositive, Outcome::kBatteryDepleted})
    for (const Candidate& candidate : Candidates(reader.Layout(), plans)) {
      if (world && candidate.plan->Setting("mission.world") != *world) continue;
      const auto id = MedianMission(reader, candidate.stage, candidate.arm, outcome);
      if (!id) continue;
      shown.push_back(
          {candidate.plan->stage, candidate.plan->name, id->mission, reader.LoadMission(*id).record});
      world = candidate.plan->Setting("mission.world");
      break;
    }
  return shown;
}

FoundScene FindScene(ResultReader& reader, const std::string& world) {
  const std::vector<Session> sessions = reader.Sessions();
  if (sessions.empty() || !sessions.back().notes.contains("sweep file"))
    return {nullptr, "no session tells where the sweep file lay"};
  const auto& worlds = reader.StoredRecipe().inputs;
  const auto flown = worlds.find(world);
  if (flown == worlds.end()) return {nullptr, fmt::format("the recipe does not know the world '{}'", world)};
  const std::filesystem::path file =
      std::filesystem::path(sessions.back().notes.at("sweep file")).parent_path() / world;
  try {
    std::shared_ptr<const Scene> scene = Scene::Load(file.lexically_normal().string());
    if (scene->Fingerprint() != flown->second)
      return {nullptr, fmt::format("{} has changed since it was flown in", file.lexically_normal().string())};
    return {scene, ""};
  } catch (const UserError& error) {
    return {nullptr, error.what()};
  }
}

}  // namespace ed3r
