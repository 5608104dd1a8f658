#include "studies/report/departures.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <span>

#include "engine/config/parameters.h"
#include "engine/config/perception.h"
#include "engine/store/reader.h"
#include "engine/sweep/arm_id.h"
#include "engine/sweep/plan_text.h"
#include "studies/paper/arms.h"
#include "studies/paper/world.h"

namespace ed3r::report {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kWorldKey = "mission.world";
constexpr std::string_view kMissionsOf = "missions of ";
constexpr std::size_t kMostTold = 3;  // values, arms or variants

// One arm as the plan has it, and the paper's arm that it stands for.
struct FlownArm {
  std::string name;  // without its variant
  const std::map<std::string, std::string>* settings;
  const paper::PaperArm* paper;  // null: an arm of somebody's own
  bool warmup;
};

std::string Setting(const std::map<std::string, std::string>& settings, const std::string& key) {
  const auto found = settings.find(key);
  return found == settings.end() ? "" : found->second;
}

std::set<std::string> WarmupStages(const sweep::WrittenPlan& plan) {
  std::set<std::string> stages;
  for (const sweep::WrittenPlan::Stage& stage : plan.stages)
    if (stage.kind == sweep::StageKind::kTrain) stages.insert(stage.after.begin(), stage.after.end());
  return stages;
}

FlownArm FlownArmOf(const sweep::WrittenPlan::Arm& arm, bool learned_from) {
  FlownArm flown{sweep::ArmId::Of(arm.name).name, &arm.settings, nullptr, learned_from};
  flown.paper = paper::FindPaperArm(flown.name);
  // Networks learn from whatever flies a warm-up's strategy, by any name.
  if (flown.paper == nullptr && learned_from)
    flown.paper = paper::FindPaperWarmup(Setting(arm.settings, "mission.strategy"));
  if (flown.paper != nullptr) flown.warmup = flown.paper->warmup;
  return flown;
}

// What the paper's arm has; nullopt where an arm of somebody's own may have what it likes.
std::optional<std::string> PaperText(const ParameterInfo& parameter, const FlownArm& arm) {
  const std::string& key = parameter.key;
  if (key == "mission.sites" || key == "mission.base_stations")
    return arm.warmup ? std::string(NameOf(SiteSet::kKnown)) : parameter.default_value;
  if (key != "mission.strategy" && key != "agents.eta_min") return parameter.default_value;
  if (arm.paper == nullptr) return std::nullopt;
  return key == "mission.strategy" ? std::string(arm.paper->strategy) : fmt::format("{}", arm.paper->eta_min);
}

enum class Bearing { kResults, kEffort, kNone };

Bearing BearingOf(const std::string& key, const FlownArm& arm) {
  // The warm-up's scenarios are set apart from the online ones somewhere, it does not matter where.
  if (key == "mission.first_scenario") return arm.warmup ? Bearing::kNone : Bearing::kEffort;
  if (key == "mission.physics_hz") return Bearing::kNone;  // the paper has no step of the physics
  // What renders frames and looks at them decides nothing where none are.
  if ((key.starts_with("perception.render.") || key.starts_with("perception.detector.")) &&
      Setting(*arm.settings, "perception.tier") != NameOf(PerceptionTier::kPixels))
    return Bearing::kNone;
  if (!key.starts_with("training.")) return Bearing::kResults;
  return arm.paper != nullptr && arm.paper->learns ? Bearing::kEffort : Bearing::kNone;
}

// Collects one list, key by key.
class Collector {
 public:
  void Meet(const std::string& arm) { AddOnce(arm, met_); }

  void Add(const std::string& value, const std::string& paper, const std::string& arm) {
    departure_.paper = paper;
    AddOnce(value, departure_.values);
    AddOnce(arm, departure_.arms);
  }

  void EndKey(const std::string& key, std::vector<Departure>& list) {
    departure_.key = key;
    if (departure_.arms.size() == met_.size()) departure_.arms.clear();
    if (!departure_.values.empty()) list.push_back(std::move(departure_));
    departure_ = {};
    met_.clear();
  }

 private:
  static void AddOnce(const std::string& text, std::vector<std::string>& list) {
    if (std::find(list.begin(), list.end(), text) == list.end()) list.push_back(text);
  }

  Departure departure_;
  std::vector<std::string> met_;  // arms that could have it
};

void CompareParameter(const ParameterInfo& parameter, const std::vector<FlownArm>& arms,
                      const std::set<std::string>& paper_worlds, Departures& found) {
  Collector results, aside, effort;
  for (const FlownArm& arm : arms) {
    const auto setting = arm.settings->find(parameter.key);
    if (setting == arm.settings->end()) continue;  // of a version without this parameter
    const std::optional<std::string> paper = PaperText(parameter, arm);
    const Bearing bearing = BearingOf(parameter.key, arm);
    if (!paper || bearing == Bearing::kNone) continue;
    Collector& list = bearing == Bearing::kEffort ? effort : arm.paper == nullptr ? aside : results;
    list.Meet(arm.name);
    if (parameter.key == kWorldKey) {
      if (paper_worlds.contains(setting->second)) continue;
      const bool called_alike = setting->second == *paper;
      list.Add(setting->second + (called_alike ? " of other content" : ""), *paper, arm.name);
    } else if (setting->second != *paper) {
      list.Add(setting->second, *paper, arm.name);
    }
  }
  results.EndKey(parameter.key, found.results);
  aside.EndKey(parameter.key, found.aside);
  effort.EndKey(parameter.key, found.effort);
}

void CompareMissions(const sweep::WrittenPlan::Stage& stage, const std::vector<FlownArm>& arms,
                     Departures& found) {
  const auto named = std::find_if(arms.begin(), arms.end(), [](const FlownArm& arm) { return arm.paper; });
  if (named == arms.end() || stage.precision) return;  // with a precision it flies what that takes
  const int paper = named->paper->warmup ? paper::kPaperWarmupMissions : paper::kPaperOnlineMissions;
  if (stage.missions != paper)
    found.effort.push_back(
        {std::string(kMissionsOf) + stage.name, {std::to_string(stage.missions)}, std::to_string(paper), {}});
}

std::string YesOrNo(const std::string& value) {
  return value == "true" ? "yes" : value == "false" ? "no" : value;
}

std::string Listed(const std::vector<std::string>& all) {
  const std::size_t told = std::min(all.size(), kMostTold);
  std::string text = fmt::format("{}", fmt::join(all.begin(), all.begin() + static_cast<int>(told), ", "));
  if (all.size() > told) text += fmt::format(" and {} more", all.size() - told);
  return text;
}

// What a study often departs in; other parameters go by their key.
constexpr std::pair<std::string_view, std::string_view> kSpokenKeys[] = {
    {"training.learning_rate", "learning rate"},
    {"training.epochs", "training epochs"},
    {"training.seeds", "trained networks of each kind"},
    {"training.own_warmups", "a warm-up of its own for each network"},
};

// "10200 missions of warmup", "learning rate 5e-05", "robot.mass_kg 2.4".
std::string Spoken(const Departure& d) {
  const std::string values = YesOrNo(Listed(d.values));
  if (d.key.starts_with(kMissionsOf)) return values + ' ' + d.key;
  for (const auto& [key, words] : kSpokenKeys)
    if (d.key == key) return fmt::format("{} {}", words, values);
  return d.key + ' ' + values;
}

Json ListJson(const std::vector<Departure>& departures) {
  Json list = Json::array();
  for (const Departure& d : departures)
    list.push_back({{"parameter", d.key}, {"values", d.values}, {"paper", d.paper}, {"arms", d.arms}});
  return list;
}

// Worlds of the run, as its plan calls them, whose files are those of the paper's.
std::set<std::string> PaperWorlds(const store::Recipe& recipe, const std::vector<store::InputFile>& files) {
  const auto is_there = [&](const std::filesystem::path& name, std::string_view sha256) {
    return std::any_of(files.begin(), files.end(), [&](const store::InputFile& file) {
      return file.name == name.lexically_normal().string() && file.sha256 == sha256;
    });
  };
  std::set<std::string> worlds;
  for (const auto& [called, file] : recipe.places) {
    const std::filesystem::path folder = std::filesystem::path(file).parent_path();
    const std::span<const paper::PaperWorldFile> parts = paper::PaperWorldFiles();
    // What a world file names is beside it; its own name does not matter.
    const bool same = is_there(file, parts.front().sha256) &&
                      std::all_of(parts.begin() + 1, parts.end(), [&](const paper::PaperWorldFile& part) {
                        return is_there(folder / part.name, part.sha256);
                      });
    if (same) worlds.insert(called);
  }
  return worlds;
}

}  // namespace

Departures DeparturesOf(std::string_view plan_text, const std::string& variant,
                        const std::set<std::string>& paper_worlds) {
  const sweep::WrittenPlan plan = sweep::ReadPlanText(plan_text);
  const std::set<std::string> warmups = WarmupStages(plan);
  std::vector<FlownArm> all;
  Departures found;
  for (const sweep::WrittenPlan::Stage& stage : plan.stages) {
    if (stage.kind != sweep::StageKind::kFly) continue;
    std::vector<FlownArm> arms;
    for (const sweep::WrittenPlan::Arm& arm : stage.arms)
      if (sweep::ArmId::Of(arm.name).variant == variant)
        arms.push_back(FlownArmOf(arm, warmups.contains(stage.name)));
    CompareMissions(stage, arms, found);
    all.insert(all.end(), arms.begin(), arms.end());
  }
  for (const ParameterInfo& parameter : Parameters())
    if (parameter.scope == Scope::kMission) CompareParameter(parameter, all, paper_worlds, found);
  return found;
}

RunDepartures ReadDepartures(store::ResultReader& reader) {
  const std::set<std::string> worlds = PaperWorlds(reader.StoredRecipe(), reader.Files());
  std::set<std::string> variants;
  for (const store::RunLayout::Stage& stage : reader.Layout().stages)
    for (const store::RunLayout::Arm& arm : stage.arms)
      if (stage.missions > 0) variants.insert(sweep::ArmId::Of(arm.name).variant);
  RunDepartures departures;
  for (const std::string& variant : variants)
    departures[variant] = DeparturesOf(reader.StoredRecipe().plan_text, variant, worlds);
  return departures;
}

std::string DepartureText(const std::vector<Departure>& departures) {
  std::string text;
  for (const Departure& d : departures) {
    text += fmt::format("{}{} (paper {})", text.empty() ? "" : "; ", Spoken(d), YesOrNo(d.paper));
    if (!d.arms.empty()) text += " in " + Listed(d.arms);
  }
  return text;
}

std::vector<std::string> DepartureSentences(const RunDepartures& departures, const std::string& variant,
                                            Judging judging) {
  const auto told = departures.find(variant);
  if (told == departures.end()) return {};
  const bool asked = judging == Judging::kEverything;
  std::vector<std::string> sentences;
  if (!told->second.PaperFlown())
    sentences.push_back(fmt::format(
        "Not as in the paper: {}. {}", DepartureText(told->second.results),
        asked ? "Its claims are judged all the same (--claims)."
              : "So its claims are not judged; 'ed3r report DIR --claims' judges them all the same."));
  if (!told->second.aside.empty())
    sentences.push_back(fmt::format("Not as in the paper, in arms that no claim speaks of: {}.",
                                    DepartureText(told->second.aside)));
  if (!told->second.effort.empty())
    sentences.push_back(
        fmt::format("Unlike the paper, in numbers alone: {}.", DepartureText(told->second.effort)));
  std::vector<std::string> others;
  for (const auto& [name, of_variant] : departures)
    if (!of_variant.PaperFlown()) others.push_back(name);
  if (others.size() > (told->second.PaperFlown() ? 0U : 1U))
    sentences.push_back(
        fmt::format("{} of {} variants are not as in the paper ({}); {}", others.size(), departures.size(),
                    Listed(others),
                    asked ? "the claims are judged in them all the same (--claims)."
                          : "which claims they change is left out; 'ed3r report DIR --claims' tells it."));
  return sentences;
}

Json DeparturesJson(const Departures& departures, Judging judging) {
  return {{"paper_flown", departures.PaperFlown()},
          {"claims_judged", departures.PaperFlown() || judging == Judging::kEverything},
          {"results", ListJson(departures.results)},
          {"aside", ListJson(departures.aside)},
          {"effort", ListJson(departures.effort)}};
}

}  // namespace ed3r::report
