#include "studies/tables/look_forward_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "studies/metrics/metrics.h"
#include "studies/tables/layout.h"
#include "studies/tables/names.h"

namespace ed3r::tables {
namespace {

using Json = nlohmann::ordered_json;

struct Words {
  const char *key, *text;
};
constexpr Words kWords[] = {{"group", "the group's worst mission"},
                            {"arm", "the arm's worst mission"},
                            {"all_arms", "the worst mission of all arms"},
                            {"arm_timestep", "the arm's worst timestep"},
                            {"all_timesteps", "the worst timestep of all arms"}};
static_assert(std::size(kWords) == std::size(kWorstOfs));

constexpr const char* kAblations[] = {"ablation-1", "ablation-2", "ablation-3", "ablation-4"};

double MeanPercent(const std::vector<double>& accuracies) {
  double sum = 0.0;
  int count = 0;
  for (const double accuracy : accuracies)
    if (!std::isnan(accuracy)) sum += accuracy, ++count;
  return count > 0 ? 100.0 * sum / count : std::numeric_limits<double>::quiet_NaN();
}

LookForward ErrorsOf(const metrics::ArmData& arm) {
  LookForward result{.arm = arm.name};
  for (const mission::MissionRecord& mission : arm.missions) {
    if (mission.predicted_timesteps == 0) continue;
    const double error = mission.absolute_reward_error_sum / static_cast<double>(mission.predicted_timesteps);
    ++result.missions;
    result.mean_error += error;
    result.largest_mission = std::max(result.largest_mission, error);
    result.largest_timestep = std::max(result.largest_timestep, mission.largest_reward_error);
  }
  if (result.missions > 0) result.mean_error /= result.missions;
  return result;
}

// By network.
metrics::WorstErrors WorstTimestepsOf(std::span<const mission::MissionRecord> missions) {
  metrics::WorstErrors worst;
  for (const mission::MissionRecord& m : missions)
    if (m.predicted_timesteps > 0) worst[m.network] = std::max(worst[m.network], m.largest_reward_error);
  return worst;
}

void Widen(const metrics::WorstErrors& errors, metrics::WorstErrors& worst) {
  for (const auto& [network, error] : errors) worst[network] = std::max(worst[network], error);
}

const LookForward* Find(const std::vector<LookForward>& arms, std::string_view name) {
  const auto found = std::find_if(arms.begin(), arms.end(), [&](const auto& arm) { return arm.arm == name; });
  return found == arms.end() ? nullptr : &*found;
}

std::string Cell(double value, const char* format) {
  return Pad(std::isnan(value) ? "–" : fmt::format(fmt::runtime(format), value), 9, Align::kRight);
}

std::string CsvCell(double value) { return std::isnan(value) ? "" : fmt::format("{}", value); }

std::string Answer(const std::optional<bool>& answer) { return !answer ? "–" : *answer ? "yes" : "no"; }

std::string PatternText(const std::vector<LookForward>& arms) {
  std::string text = Pad("LF divided by", 33, Align::kLeft);
  for (const char* heading : {"P85 > mean", "ablations > ED³R", "ECD²R > ED³R"})
    text += Pad(heading, 19, Align::kRight);
  text += "\n";
  for (const WorstOf definition : kWorstOfs) {
    const LookForwardPattern pattern = PatternOf(arms, definition);
    text += Pad(kWords[static_cast<std::size_t>(definition)].text, 33, Align::kLeft);
    for (const auto& part : {pattern.p85_above_mean, pattern.ablations_above_ed3r, pattern.ecd2r_above_ed3r})
      text += Pad(Answer(part), 19, Align::kRight);
    text += "\n";
  }
  return text;
}

}  // namespace

std::vector<LookForward> LookForwardOf(std::span<const metrics::ArmData> arms) {
  metrics::WorstErrors of_all, of_all_timesteps;
  for (const metrics::ArmData& arm : arms) {
    Widen(metrics::WorstErrorsOf(arm.missions), of_all);
    Widen(WorstTimestepsOf(arm.missions), of_all_timesteps);
  }
  std::vector<LookForward> result;
  for (const metrics::ArmData& arm : arms) {
    LookForward row = ErrorsOf(arm);
    if (row.missions == 0) continue;
    const metrics::ArmData group = metrics::P85Group(arm);
    const metrics::WorstErrors of_arm = metrics::WorstErrorsOf(arm.missions),
                               of_group = metrics::WorstErrorsOf(group.missions);
    const metrics::WorstErrors of_arm_timesteps = WorstTimestepsOf(arm.missions);
    const metrics::WorstErrors* worst[] = {&of_arm, &of_arm, &of_all, &of_arm_timesteps, &of_all_timesteps};
    for (std::size_t i = 0; i < std::size(kWorstOfs); ++i) {
      row.accuracy[i] = MeanPercent(metrics::LookForwardAccuracies(arm.missions, *worst[i]));
      const bool own = kWorstOfs[i] == WorstOf::kGroup;
      row.p85_accuracy[i] =
          MeanPercent(metrics::LookForwardAccuracies(group.missions, own ? of_group : *worst[i]));
    }
    result.push_back(std::move(row));
  }
  return result;
}

LookForwardPattern PatternOf(const std::vector<LookForward>& arms, WorstOf definition) {
  const auto i = static_cast<std::size_t>(definition);
  const LookForward *ed3r = Find(arms, "ed3r-75"), *ecd2r = Find(arms, "ecd2r");
  LookForwardPattern pattern;
  if (ed3r == nullptr) return pattern;
  const auto rises = [i](const LookForward& arm) { return arm.p85_accuracy[i] > arm.accuracy[i]; };
  if (ecd2r != nullptr) {
    pattern.p85_above_mean = rises(*ed3r) && rises(*ecd2r);
    pattern.ecd2r_above_ed3r = ecd2r->accuracy[i] > ed3r->accuracy[i];
  }
  bool above = true;
  for (const char* name : kAblations) {
    const LookForward* ablation = Find(arms, name);
    if (ablation == nullptr) return pattern;
    above = above && ablation->accuracy[i] > ed3r->accuracy[i];
  }
  pattern.ablations_above_ed3r = above;
  return pattern;
}

std::string LookForwardText(const std::vector<LookForward>& arms) {
  if (arms.empty()) return "";
  double largest = 0.0;
  std::string text = Pad("look-forward errors", 21, Align::kLeft);
  for (const char* heading : {"mean", "mission", "timestep", "LF, arm", "P85", "LF, all", "P85"})
    text += Pad(heading, 9, Align::kRight);
  text += fmt::format("\n{}\n", Rule(DisplayWidth(text)));
  for (const LookForward& row : arms) {
    largest = std::max(largest, row.largest_mission);
    text += Pad(ArmLabel(row.arm), 21, Align::kLeft) + Cell(row.mean_error, "{:.3f}") +
            Cell(row.largest_mission, "{:.3f}") + Cell(row.largest_timestep, "{:.3f}") +
            Cell(row.accuracy[1], "{:.1f}") + Cell(row.p85_accuracy[1], "{:.1f}") +
            Cell(row.accuracy[2], "{:.1f}") + Cell(row.p85_accuracy[2], "{:.1f}") + "\n";
  }
  text += Wrap(
      fmt::format("Absolute errors of the predicted reward: a mission's mean, the largest such mean, "
                  "the largest of one timestep; the largest mean of all arms is {:.3f}. LF accuracy in % "
                  "(R29) by the worst mission of the arm, and of all arms, of the network that flew.",
                  largest),
      "", kTerminalWidth);
  const bool asked = PatternOf(arms, WorstOf::kArm).p85_above_mean.has_value();
  return asked ? text + "\nWhich definition of LF accuracy gives what the paper prints?\n" + PatternText(arms)
               : text;
}

std::string LookForwardCsv(const std::vector<LookForward>& arms) {
  std::string csv = "arm,missions,mean_error,largest_mission,largest_timestep";
  for (const char* of : {"accuracy_", "p85_accuracy_"})
    for (const Words& words : kWords) csv += fmt::format(",{}{}", of, words.key);
  csv += '\n';
  for (const LookForward& row : arms) {
    csv += fmt::format("{},{},{},{},{}", row.arm, row.missions, row.mean_error, row.largest_mission,
                       row.largest_timestep);
    for (const auto& accuracies : {row.accuracy, row.p85_accuracy})
      for (std::size_t i = 0; i < std::size(kWorstOfs); ++i) csv += ',' + CsvCell(accuracies[i]);
    csv += '\n';
  }
  return csv;
}

Json LookForwardJson(const std::vector<LookForward>& arms) {
  Json json = {{"arms", Json::object()}, {"pattern", Json::object()}};
  for (const LookForward& row : arms) {
    Json accuracy = Json::object(), p85_accuracy = Json::object();
    for (std::size_t i = 0; i < std::size(kWorstOfs); ++i) {
      accuracy[kWords[i].key] = row.accuracy[i];
      p85_accuracy[kWords[i].key] = row.p85_accuracy[i];
    }
    json["arms"][row.arm] = {{"missions", row.missions},
                             {"mean_error", row.mean_error},
                             {"largest_mission", row.largest_mission},
                             {"largest_timestep", row.largest_timestep},
                             {"accuracy_pct", accuracy},
                             {"p85_accuracy_pct", p85_accuracy}};
  }
  const auto part = [](const std::optional<bool>& answer) { return answer ? Json(*answer) : Json(nullptr); };
  for (const WorstOf definition : kWorstOfs) {
    const LookForwardPattern pattern = PatternOf(arms, definition);
    json["pattern"][kWords[static_cast<std::size_t>(definition)].key] = {
        {"p85_above_mean", part(pattern.p85_above_mean)},
        {"ablations_above_ed3r", part(pattern.ablations_above_ed3r)},
        {"ecd2r_above_ed3r", part(pattern.ecd2r_above_ed3r)}};
  }
  return json;
}

}  // namespace ed3r::tables
