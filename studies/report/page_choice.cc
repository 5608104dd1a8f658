#include "studies/report/page_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <set>

#include "engine/sweep/arm_id.h"
#include "studies/report/page_data.h"

namespace ed3r::report {
namespace {

using Wanted = std::function<bool(const mission::MissionRecord&)>;

struct Choice {
  std::size_t arm = 0;
  std::size_t mission = 0;  // index
  std::string what;
};

Wanted Ended(mission::Outcome outcome) {
  return
      [outcome](const mission::MissionRecord& m) { return m.outcome == static_cast<std::int64_t>(outcome); };
}

// Indices of the missions wanted, by duration.
std::vector<std::size_t> ByDuration(const metrics::ArmData& arm, const Wanted& wanted) {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < arm.missions.size(); ++i)
    if (wanted(arm.missions[i])) found.push_back(i);
  std::stable_sort(found.begin(), found.end(), [&](std::size_t a, std::size_t b) {
    return arm.missions[a].duration_s < arm.missions[b].duration_s;
  });
  return found;
}

// Arms that are no warm-up, the one that the study is about first, then by the number of missions wanted.
std::vector<std::size_t> ArmsToSearch(const std::vector<metrics::ArmData>& arms,
                                      const std::set<std::string>& warmups, const Wanted& wanted) {
  const auto count = [&](std::size_t a) {
    return std::count_if(arms[a].missions.begin(), arms[a].missions.end(), wanted);
  };
  std::vector<std::size_t> order;
  for (std::size_t a = 0; a < arms.size(); ++a)
    if (!warmups.contains(arms[a].stage)) order.push_back(a);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    const bool first = arms[a].name == "ed3r-75", second = arms[b].name == "ed3r-75";
    return first != second ? first : count(a) > count(b);
  });
  return order;
}

std::vector<Choice> Choose(const std::vector<metrics::ArmData>& arms, const std::set<std::string>& warmups) {
  std::vector<Choice> choices;
  const Wanted success = Ended(mission::Outcome::kSuccess),
               any = [](const mission::MissionRecord&) { return true; };
  const std::vector<std::size_t> order = ArmsToSearch(arms, warmups, success);
  if (order.empty()) return choices;
  const std::size_t studied = order.front();
  const auto& missions = arms[studied].missions;
  if (const auto found = ByDuration(arms[studied], success); !found.empty()) {
    choices.push_back({studied, found[found.size() / 2], "a typical success"});
    choices.push_back({studied,
                       *std::min_element(found.begin(), found.end(),
                                         [&](std::size_t a, std::size_t b) {
                                           return missions[a].total_j < missions[b].total_j;
                                         }),
                       "the success for the least energy"});
  }
  if (const auto found = ByDuration(arms[studied], any); !found.empty())
    choices.push_back({studied, found.back(), "the longest"});
  for (const auto& [outcome, what] : {std::pair{mission::Outcome::kFalsePositive, "a typical false alarm"},
                                      std::pair{mission::Outcome::kBatteryDepleted, "an empty battery"}})
    for (const std::size_t a : ArmsToSearch(arms, warmups, Ended(outcome)))
      if (const auto found = ByDuration(arms[a], Ended(outcome)); !found.empty()) {
        choices.push_back({a, found[found.size() / 2], what});
        break;
      }
  return choices;
}

// Stages whose missions networks learnt from; none where nothing else was flown.
std::set<std::string> WarmupStages(std::span<const figures::ArmPlan> plans,
                                   const std::vector<metrics::ArmData>& arms) {
  std::set<std::string> stages;
  for (const figures::ArmPlan& plan : plans)
    if (plan.warmup) stages.insert(plan.stage);
  const bool others = std::any_of(arms.begin(), arms.end(), [&](const metrics::ArmData& arm) {
    return !stages.contains(arm.stage) && !arm.missions.empty();
  });
  return others ? stages : std::set<std::string>();
}

}  // namespace

std::vector<ChosenMission> ChooseMissions(const Report& report, const RunResults& results,
                                          std::span<const figures::ArmPlan> plans) {
  const PageMissions missions = PageMissionsOf(report, results);
  std::vector<ChosenMission> chosen;
  for (const Choice& choice : Choose(missions.arms, WarmupStages(plans, missions.arms))) {
    const metrics::ArmData& arm = missions.arms[choice.arm];
    chosen.push_back({fmt::format("{}/{}/{}", arm.stage, sweep::ArmId{arm.name, missions.variant}.Text(),
                                  missions.numbers[choice.arm][choice.mission]),
                      choice.what});
  }
  return chosen;
}

}  // namespace ed3r::report
