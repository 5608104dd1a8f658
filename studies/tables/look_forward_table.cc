#include "studies/tables/look_forward_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "studies/metrics/metrics.h"
#include "studies/tables/layout.h"
#include "studies/tables/names.h"

namespace ed3r {
namespace {

constexpr const char* kWords[] = {"the group's worst mission", "the arm's worst mission",
                                  "the worst mission of all arms"};

double MeanPercent(const std::vector<double>& accuracies) {
  double sum = 0.0;
  int count = 0;
  for (const double accuracy : accuracies)
    if (!std::isnan(accuracy)) sum += accuracy, ++count;
  return count > 0 ? 100.0 * sum / count : std::numeric_limits<double>::quiet_NaN();
}

LookForward ErrorsOf(const ArmData& arm) {
  LookForward result{.arm = arm.name};
  for (const MissionRecord& mission : arm.missions) {
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

const LookForward* Find(const std::vector<LookForward>& arms, std::string_view name) {
  const auto found = std::find_if(arms.begin(), arms.end(), [&](const auto& arm) { return arm.arm == name; });
  return found == arms.end() ? nullptr : &*found;
}

std::string Cell(double value, const char* format) {
  return Pad(std::isnan(value) ? "–" : fmt::format(fmt::runtime(format), value), 11, Align::kRight);
}

}  // namespace

std::vector<LookForward> LookForwardOf(std::span<const ArmData> arms) {
  WorstErrors of_all;
  for (const ArmData& arm : arms)
    for (const auto& [network, error] : WorstErrorsOf(arm.missions))
      of_all[network] = std::max(of_all[network], error);
  std::vector<LookForward> result;
  for (const ArmData& arm : arms) {
    LookForward row = ErrorsOf(arm);
    if (row.missions == 0) continue;
    const ArmData group = P85Group(arm);
    const WorstErrors of_arm = WorstErrorsOf(arm.missions), of_group = WorstErrorsOf(group.missions);
    const WorstErrors* worst[] = {&of_arm, &of_arm, &of_all};
    const WorstErrors* p85_worst[] = {&of_group, &of_arm, &of_all};
    for (std::size_t i = 0; i < std::size(kWorstOfs); ++i) {
      row.accuracy[i] = MeanPercent(LookForwardAccuracies(arm.missions, *worst[i]));
      row.p85_accuracy[i] = MeanPercent(LookForwardAccuracies(group.missions, *p85_worst[i]));
    }
    result.push_back(std::move(row));
  }
  return result;
}

bool GivesThePapersPattern(const std::vector<LookForward>& arms, WorstOf definition) {
  const auto i = static_cast<std::size_t>(definition);
  const LookForward* ed3r = Find(arms, "ed3r-75");
  if (ed3r == nullptr || !(ed3r->p85_accuracy[i] > ed3r->accuracy[i])) return false;
  for (const char* name : {"ablation-1", "ablation-2", "ablation-3", "ablation-4"}) {
    const LookForward* ablation = Find(arms, name);
    if (ablation == nullptr || !(ablation->accuracy[i] > ed3r->accuracy[i])) return false;
  }
  return true;
}

std::string LookForwardText(const std::vector<LookForward>& arms) {
  if (arms.empty()) return "";
  double largest = 0.0;
  std::string text = Pad("look-forward errors", 21, Align::kLeft);
  for (const char* heading : {"mean", "mission", "timestep", "LF, arm", "P85", "LF, all", "P85"})
    text += Pad(heading, 11, Align::kRight);
  text += "\n" + Rule(DisplayWidth(text)) + "\n";
  for (const LookForward& row : arms) {
    largest = std::max(largest, row.largest_mission);
    text += Pad(ArmLabel(row.arm), 21, Align::kLeft) + Cell(row.mean_error, "{:.3f}") +
            Cell(row.largest_mission, "{:.3f}") + Cell(row.largest_timestep, "{:.3f}") +
            Cell(row.accuracy[1], "{:.1f}") + Cell(row.p85_accuracy[1], "{:.1f}") +
            Cell(row.accuracy[2], "{:.1f}") + Cell(row.p85_accuracy[2], "{:.1f}") + "\n";
  }
  std::string pattern;
  for (const WorstOf definition : kWorstOfs)
    if (GivesThePapersPattern(arms, definition))
      pattern += (pattern.empty() ? "" : "; ") + std::string(kWords[static_cast<std::size_t>(definition)]);
  return text + Wrap(fmt::format("Absolute errors of the predicted reward: a mission's mean, the largest "
                                 "such mean, the largest of one "
                                 "timestep; the largest mean of all arms is {:.3f}. LF accuracy in % (R29) "
                                 "by the worst mission of the "
                                 "arm, and of all arms. The paper's pattern, P85 above the mean and the "
                                 "ablations above ED³R, comes "
                                 "out with {}.",
                                 largest, pattern.empty() ? "none of the definitions" : pattern),
                     "", kTerminalWidth);
}

std::string LookForwardCsv(const std::vector<LookForward>& arms) {
  std::string csv =
      "arm,missions,mean_error,largest_mission,largest_timestep,accuracy_group,accuracy_arm,accuracy_all_"
      "arms,"
      "p85_accuracy_group,p85_accuracy_arm,p85_accuracy_all_arms\n";
  for (const LookForward& row : arms)
    csv += fmt::format("{},{},{},{},{},{},{},{},{},{},{}\n", row.arm, row.missions, row.mean_error,
                       row.largest_mission, row.largest_timestep, row.accuracy[0], row.accuracy[1],
                       row.accuracy[2], row.p85_accuracy[0], row.p85_accuracy[1], row.p85_accuracy[2]);
  return csv;
}

}  // namespace ed3r
