#include "engine/app/stored_run.h"

#include <fmt/format.h>

#include <charconv>
#include <filesystem>

#include "engine/agents/strategy.h"
#include "engine/app/words.h"
#include "engine/config/parameters.h"
#include "engine/core/check.h"
#include "engine/core/files/utf8.h"
#include "engine/sweep/plan_text.h"
#include "engine/sweep/setting.h"

namespace ed3r::app {
namespace {

std::string JoinedLines(const std::vector<std::string>& lines) {
  return fmt::format("{}", fmt::join(lines, "\n"));
}

sweep::SweepPlan StoredPlan(const store::ResultReader& reader, const store::RestoredFiles& files,
                            const std::string& dir) {
  const store::Recipe& recipe = reader.StoredRecipe();
  sweep::SweepPlan plan = sweep::PlanOf(sweep::ReadPlanText(recipe.plan_text), dir);
  if (const auto code = store::CodeDifference(recipe.code, schedule::CodeOf(plan)))
    throw UserError(fmt::format("{}: {}; build that version to fly its missions again", dir, *code));
  if (plan.CanonicalText() != recipe.plan_text)
    throw UserError(fmt::format("{}: its plan is of another version of ed3r", dir));
  for (sweep::Stage& stage : plan.stages)
    for (sweep::Arm& arm : stage.arms)
      for (const auto& [key, called] : arm.files) {
        if (called == sweep::FileNotNeeded(key)) continue;
        const std::string problem = SetParameter(arm.config, key, files.PathOf(called));
        ED3R_CHECK(problem.empty(), problem);
      }
  return plan;
}

void CheckSameInputs(const store::ResultReader& reader, const std::string& dir,
                     const std::map<std::string, std::string>& here) {
  for (const auto& [name, fingerprint] : reader.StoredRecipe().inputs) {
    const auto found = here.find(name);
    if (found == here.end() || found->second != fingerprint)
      throw UserError(fmt::format("{}: {} has changed since it was flown", dir, name));
  }
}

// With their stages in front where the word has one, too.
std::vector<std::string> ArmNames(const sweep::SweepPlan& plan, bool with_stage) {
  std::vector<std::string> names;
  for (const sweep::Stage& stage : plan.stages)
    for (const sweep::Arm& arm : stage.arms)
      if (stage.kind == sweep::StageKind::kFly)
        names.push_back(with_stage ? stage.name + "/" + arm.name : arm.name);
  return names;
}

// What is wrong with "TEXT/NUMBER" when no arm is called TEXT, or with a text that has no number.
std::string UnknownMission(const std::string& mission, const std::string& arm, bool numbered,
                           const sweep::SweepPlan& plan) {
  std::string problem = "expected ARM/NUMBER";
  if (numbered) {
    problem = "no arm " + arm;
    const std::string suggestion = DidYouMean(arm, ArmNames(plan, arm.find('/') != std::string::npos));
    if (!suggestion.empty()) return fmt::format("{}: {}{}", mission, problem, suggestion);
  }
  return fmt::format("{}: {}; the arms are {}", mission, problem, fmt::join(ArmNames(plan, true), ", "));
}

// A mission of the first stage would be taken for one of another.
void CheckOneStage(const std::string& mission, const std::string& arm, const sweep::SweepPlan& plan) {
  std::vector<std::string> found;
  for (const sweep::Stage& stage : plan.stages)
    for (const sweep::Arm& candidate : stage.arms)
      if (stage.kind == sweep::StageKind::kFly && candidate.name == arm)
        found.push_back(stage.name + "/" + arm);
  if (found.size() > 1)
    throw UserError(fmt::format("{}: arm {} is of several stages; give STAGE/ARM/NUMBER, with one of {}",
                                mission, arm, fmt::join(found, ", ")));
}

}  // namespace

std::map<std::string, std::string> NotesOf(const SweepArguments& arguments) {
  const std::string file = std::filesystem::absolute(arguments.file).lexically_normal().string();
  if (!IsUtf8(file)) throw UserError(fmt::format("{}: its path is not UTF-8 text", file));
  return {{"sweep file", file},
          {"sweep --set", JoinedLines(arguments.set)},
          {"sweep --seed", arguments.seed},
          {"sweep --missions", JoinedLines(arguments.missions)}};
}

StoredRun::StoredRun(const std::string& dir, const std::string& cache_dir)
    : dir_(dir),
      gathered_(dir),
      reader_(gathered_.dir()),
      cache_dir_(cache_dir),
      files_(reader_),
      plan_(StoredPlan(reader_, files_, dir)),
      inputs_(plan_) {
  CheckSameInputs(reader_, dir, inputs_.Fingerprints(plan_));
}

sweep::RunId StoredRun::Find(const std::string& mission) const {
  const auto slash = mission.rfind('/');
  const std::string arm_text = slash == std::string::npos ? "" : mission.substr(0, slash);
  int number = -1;
  if (slash != std::string::npos) {
    const char* const end = mission.data() + mission.size();
    const auto read = std::from_chars(mission.data() + slash + 1, end, number);
    if (read.ptr != end || fmt::format("{}", number) != mission.substr(slash + 1)) number = -1;  // 010, too
  }
  CheckOneStage(mission, arm_text, plan_);
  for (std::size_t s = 0; s < plan_.stages.size(); ++s) {
    const sweep::Stage& stage = plan_.stages[s];
    if (stage.kind != sweep::StageKind::kFly) continue;
    for (std::size_t a = 0; a < stage.arms.size(); ++a) {
      const std::string& name = stage.arms[a].name;
      if (arm_text != name && arm_text != stage.name + "/" + name) continue;
      if (number < 0 || number >= stage.missions)
        throw UserError(
            fmt::format("{}: mission numbers of {} are 0 .. {}", mission, arm_text, stage.missions - 1));
      return {static_cast<int>(s), static_cast<int>(a), number};
    }
  }
  throw UserError(UnknownMission(mission, arm_text, number >= 0, plan_));
}

mission::MissionTask StoredRun::Task(const sweep::RunId& id) {
  const sweep::Arm& arm =
      plan_.stages[static_cast<std::size_t>(id.stage)].arms[static_cast<std::size_t>(id.arm)];
  if (agents::FindStrategy(arm.config.mission.strategy).outside)
    throw UserError(
        fmt::format("{}: arm {}: the decisions of strategy {} came from a program, which alone can fly its "
                    "missions again",
                    dir_, arm.name, agents::kOutsideStrategy));
  if (networks_ == nullptr && schedule::NeedsTraining(arm.config)) {
    const store::FlownNetworks flown = reader_.Networks();
    networks_ = flown.uses.empty() ? schedule::TrainNetworks(plan_, {"", reader_.dir(), cache_dir_,
                                                                     schedule::ThreadsFor(0), nullptr})
                                   : schedule::NetworkShelf::From(flown, dir_);
  }
  return schedule::TaskOf(plan_, inputs_, networks_.get(), id);
}

}  // namespace ed3r::app
