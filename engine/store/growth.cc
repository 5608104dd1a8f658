#include "engine/store/growth.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "engine/core/check.h"
#include "engine/store/schema.h"
#include "engine/sweep/arm_id.h"
#include "engine/sweep/plan_text.h"

namespace ed3r::store {
namespace {

using PlanStage = sweep::WrittenPlan::Stage;
using PlanArm = sweep::WrittenPlan::Arm;

// Tables with a column `run`.
constexpr const char* kTablesByRun[] = {"missions", "timesteps", "failures", "timings", "flown_networks"};

const PlanArm* FindArm(const PlanStage& stage, const std::string& name) {
  const auto found = std::find_if(stage.arms.begin(), stage.arms.end(),
                                  [&](const PlanArm& arm) { return arm.name == name; });
  return found == stage.arms.end() ? nullptr : &*found;
}

std::string SettingDifference(const PlanArm& there, const PlanArm& here) {
  for (const auto& [key, value] : there.settings) {
    const auto other = here.settings.find(key);
    if (other == here.settings.end())
      return fmt::format("arm {}: {} is {} there and unknown here", there.name, key, value);
    if (other->second != value)
      return fmt::format("arm {}: {} is {} there and {} here", there.name, key, value, other->second);
  }
  for (const auto& [key, value] : here.settings)
    if (!there.settings.contains(key))
      return fmt::format("arm {}: {} is unknown there and {} here", there.name, key, value);
  return "";
}

bool SamePrecision(const std::optional<sweep::Precision>& a, const std::optional<sweep::Precision>& b) {
  if (!a || !b) return a.has_value() == b.has_value();
  return a->metric == b->metric && a->half_width == b->half_width && a->every == b->every;
}

std::string StageDifference(const PlanStage& there, const PlanStage& here) {
  if (there.name != here.name) return fmt::format("stage {} there is stage {} here", there.name, here.name);
  if (there.kind != here.kind || there.after != here.after)
    return fmt::format("stage {} builds on other stages there than here", there.name);
  if (!SamePrecision(there.precision, here.precision))
    return fmt::format("stage {} has another precision there than here", there.name);
  if (there.timesteps != here.timesteps)
    return fmt::format("stage {} stores timesteps of {} missions there and of {} here", there.name,
                       NameOf(there.timesteps), NameOf(here.timesteps));
  if (here.missions < there.missions)
    return fmt::format("stage {} has {} missions per arm there and {} here, and none is taken out",
                       there.name, there.missions, here.missions);
  for (const PlanArm& arm : there.arms) {
    const PlanArm* const other = FindArm(here, arm.name);
    if (other == nullptr) return fmt::format("stage {}: arm {} is there, but not here", there.name, arm.name);
    if (std::string difference = SettingDifference(arm, *other); !difference.empty()) return difference;
  }
  return "";
}

// Stages that a stage builds on, directly or not. A stage stands behind those.
std::set<std::string> Foundations(const sweep::WrittenPlan& plan, const PlanStage& stage) {
  std::set<std::string> found(stage.after.begin(), stage.after.end());
  for (auto it = plan.stages.rbegin(); it != plan.stages.rend(); ++it)
    if (found.contains(it->name)) found.insert(it->after.begin(), it->after.end());
  return found;
}

// Whether networks of `learner` may learn from missions of `stage`.
bool LearnsFrom(const sweep::WrittenPlan& plan, const PlanStage& learner, const PlanStage& stage) {
  const std::set<std::string> foundations = Foundations(plan, learner);
  return stage.kind == sweep::StageKind::kFly && foundations.contains(stage.name) &&
         std::any_of(plan.stages.begin(), plan.stages.end(), [&](const PlanStage& training) {
           return training.kind == sweep::StageKind::kTrain && foundations.contains(training.name) &&
                  Foundations(plan, training).contains(stage.name);
         });
}

// Networks learn from the first arm that flies their strategy in their variant: "STAGE/ARM" by strategy and variant.
std::map<std::pair<std::string, std::string>, std::string> Teachers(const sweep::WrittenPlan& plan,
                                                                    const PlanStage& learner) {
  std::map<std::pair<std::string, std::string>, std::string> teachers;
  for (const PlanStage& stage : plan.stages) {
    if (!LearnsFrom(plan, learner, stage)) continue;
    for (const PlanArm& arm : stage.arms) {
      const auto strategy = arm.settings.find("mission.strategy");
      if (strategy != arm.settings.end())
        teachers.try_emplace({strategy->second, sweep::ArmId::Of(arm.name).variant},
                             stage.name + '/' + arm.name);
    }
  }
  return teachers;
}

// What would have the networks of `learner` learn from other missions. The stages are known to be the same.
std::string LessonDifference(const sweep::WrittenPlan& there, const sweep::WrittenPlan& here,
                             std::size_t learner) {
  const PlanStage& stage = there.stages[learner];
  for (std::size_t s = 0; s < learner; ++s) {
    const PlanStage &was = there.stages[s], &is = here.stages[s];
    if (was.missions != is.missions && LearnsFrom(there, stage, was))
      return fmt::format(
          "stage {} has {} missions per arm there and {} here, and the networks of stage {} have learned "
          "from them",
          was.name, was.missions, is.missions, stage.name);
  }
  const auto now = Teachers(here, here.stages[learner]);
  for (const auto& [what, teacher] : Teachers(there, stage))
    if (const std::string& other = now.at(what); other != teacher)
      return fmt::format("the networks of stage {} have learned from {} there and would from {} here",
                         stage.name, teacher, other);
  return "";
}

std::string PlanDifference(const sweep::WrittenPlan& there, const sweep::WrittenPlan& here,
                           const std::set<std::string>& learned) {
  if (there.name != here.name)
    return fmt::format("the sweep is called {} there and {} here", there.name, here.name);
  if (there.seed != here.seed) return fmt::format("the seed is {} there and {} here", there.seed, here.seed);
  if (there.stages.size() != here.stages.size())
    return fmt::format("there are {} stages there and {} here", there.stages.size(), here.stages.size());
  for (std::size_t s = 0; s < there.stages.size(); ++s)
    if (std::string difference = StageDifference(there.stages[s], here.stages[s]); !difference.empty())
      return difference;
  for (std::size_t s = 0; s < there.stages.size(); ++s)
    if (learned.contains(there.stages[s].name))
      if (std::string difference = LessonDifference(there, here, s); !difference.empty()) return difference;
  return "";
}

std::string Added(const sweep::WrittenPlan& there, const sweep::WrittenPlan& here) {
  constexpr std::size_t kMostTold = 3;
  std::vector<std::string> parts;
  for (std::size_t s = 0; s < there.stages.size(); ++s) {
    const PlanStage &was = there.stages[s], &is = here.stages[s];
    if (is.missions != was.missions)
      parts.push_back(
          fmt::format("stage {}: {} missions per arm for {}", is.name, is.missions, was.missions));
    std::vector<std::string> arms;
    for (const PlanArm& arm : is.arms)
      if (FindArm(was, arm.name) == nullptr) arms.push_back(arm.name);
    if (arms.empty()) continue;
    const std::size_t more = arms.size() - std::min(arms.size(), kMostTold);
    arms.resize(arms.size() - more);
    parts.push_back(fmt::format("stage {}: arms added: {}{}", is.name, fmt::join(arms, ", "),
                                more > 0 ? fmt::format(" and {} more", more) : ""));
  }
  return parts.empty() ? "its arms in another order" : fmt::format("{}", fmt::join(parts, "; "));
}

// Numbers of the file's runs in the grown layout, by their numbers there.
std::vector<std::int64_t> NewNumbers(const RunLayout& there, const RunLayout& here) {
  std::vector<std::int64_t> numbers;
  int stage = 0;
  for (const std::vector<int>& arms : ArmsAfterGrowth(there, here)) {
    for (const int arm : arms) numbers.push_back(here.RunIndex(stage, arm));
    ++stage;
  }
  return numbers;
}

// By way of numbers that no run has, so that no two meet.
void Renumber(Connection& database, const char* table, const std::vector<std::int64_t>& numbers) {
  Statement away(database, fmt::format("UPDATE {} SET run = ? WHERE run = ?", table));
  for (std::size_t run = 0; run < numbers.size(); ++run)
    if (numbers[run] != static_cast<std::int64_t>(run))
      away.Run(-1 - numbers[run], static_cast<std::int64_t>(run));
  database.Execute(fmt::format("UPDATE {} SET run = -1 - run WHERE run < 0", table));
}

}  // namespace

Growth GrowthOf(const Recipe& there, const Recipe& here, const std::set<std::string>& learned) {
  const sweep::WrittenPlan was = sweep::ReadPlanText(there.plan_text),
                           is = sweep::ReadPlanText(here.plan_text);
  if (was.stages.empty() || is.stages.empty()) return {Difference(there, here).value_or(""), ""};
  Growth growth{PlanDifference(was, is, learned), ""};
  for (const auto& [name, fingerprint] : there.inputs) {
    const auto other = here.inputs.find(name);
    if (growth.Allowed() && other == here.inputs.end())
      growth.difference = fmt::format("{} is used there, but not here", name);
    else if (growth.Allowed() && other->second != fingerprint)
      growth.difference = fmt::format("{} is {} there and {} here", name, fingerprint, other->second);
  }
  if (growth.Allowed()) growth.what = Added(was, is);
  return growth;
}

std::set<std::string> LearnedStages(Connection& database, const RunLayout& layout) {
  std::set<std::string> learned;
  Statement select(database, "SELECT DISTINCT run FROM flown_networks");
  while (select.Step())
    if (const auto place = layout.Place(select.Int(0), 0))
      learned.insert(layout.stages[static_cast<std::size_t>(place->stage)].name);
  return learned;
}

std::vector<std::vector<int>> ArmsAfterGrowth(const RunLayout& there, const RunLayout& here) {
  std::vector<std::vector<int>> numbers;
  for (std::size_t s = 0; s < there.stages.size(); ++s) {
    numbers.emplace_back();
    for (const RunLayout::Arm& arm : there.stages[s].arms) {
      const std::vector<RunLayout::Arm>& arms = here.stages.at(s).arms;
      const auto found = std::find(arms.begin(), arms.end(), arm);
      ED3R_CHECK(found != arms.end(), arm.name);
      numbers.back().push_back(static_cast<int>(found - arms.begin()));
    }
  }
  return numbers;
}

void Grow(Connection& database, const Recipe& recipe, const RunLayout& layout) {
  const std::vector<std::int64_t> numbers = NewNumbers(ReadLayout(database), layout);
  for (const char* table : kTablesByRun) Renumber(database, table, numbers);
  ReplaceRecipe(database, recipe, layout);
}

}  // namespace ed3r::store
