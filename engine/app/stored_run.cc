#include "engine/app/stored_run.h"

#include <fmt/format.h>

#include <charconv>
#include <filesystem>
#include <sstream>

#include "engine/agents/strategy.h"
#include "engine/app/words.h"
#include "engine/core/check.h"
#include "engine/core/utf8.h"
#include "engine/core/version.h"

namespace ed3r {
namespace {

std::string JoinedLines(const std::vector<std::string>& lines) {
  return fmt::format("{}", fmt::join(lines, "\n"));
}

std::vector<std::string> Lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

SweepPlan ReloadPlan(ResultReader& reader) {
  const std::vector<Session> sessions = reader.Sessions();
  if (sessions.empty() || !sessions.back().notes.contains("sweep file"))
    throw UserError(fmt::format("{}: no session tells which sweep file it was flown from", reader.dir()));
  const std::map<std::string, std::string>& notes = sessions.back().notes;
  SweepArguments arguments;
  arguments.file = notes.at("sweep file");
  arguments.seed = notes.at("sweep --seed");
  arguments.missions = Lines(notes.at("sweep --missions"));
  arguments.set = Lines(notes.at("sweep --set"));
  SweepPlan plan = arguments.Load();
  if (plan.CanonicalText() != reader.StoredRecipe().plan_text)
    throw UserError(fmt::format("{}: {} has changed since it was flown", reader.dir(), arguments.file));
  if (ThisCode().source_hash != reader.StoredRecipe().code_version)
    throw UserError(
        fmt::format("{}: flown by code {}, this is code {}; build that version to fly its missions again",
                    reader.dir(), reader.StoredRecipe().code_version, ThisCode().source_hash));
  return plan;
}

// With their stages in front where the word has one, too.
std::vector<std::string> ArmNames(const SweepPlan& plan, bool with_stage) {
  std::vector<std::string> names;
  for (const Stage& stage : plan.stages)
    for (const Arm& arm : stage.arms)
      if (stage.kind == StageKind::kFly) names.push_back(with_stage ? stage.name + "/" + arm.name : arm.name);
  return names;
}

// What is wrong with "TEXT/NUMBER" when no arm is called TEXT, or with a text that has no number.
std::string UnknownMission(const std::string& mission, const std::string& arm, bool numbered,
                           const SweepPlan& plan) {
  std::string problem = "expected ARM/NUMBER";
  if (numbered) {
    problem = "no arm " + arm;
    const std::string suggestion = DidYouMean(arm, ArmNames(plan, arm.find('/') != std::string::npos));
    if (!suggestion.empty()) return fmt::format("{}: {}{}", mission, problem, suggestion);
  }
  return fmt::format("{}: {}; the arms are {}", mission, problem, fmt::join(ArmNames(plan, true), ", "));
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
    : reader_(dir), cache_dir_(cache_dir), plan_(ReloadPlan(reader_)), inputs_(plan_) {}

RunId StoredRun::Find(const std::string& mission) const {
  const auto slash = mission.rfind('/');
  const std::string arm_text = slash == std::string::npos ? "" : mission.substr(0, slash);
  int number = -1;
  if (slash != std::string::npos) {
    const char* const end = mission.data() + mission.size();
    if (std::from_chars(mission.data() + slash + 1, end, number).ptr != end) number = -1;
  }
  for (std::size_t s = 0; s < plan_.stages.size(); ++s) {
    const Stage& stage = plan_.stages[s];
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

MissionTask StoredRun::Task(const RunId& id) {
  const Arm& arm = plan_.stages[static_cast<std::size_t>(id.stage)].arms[static_cast<std::size_t>(id.arm)];
  if (networks_ == nullptr && !FindStrategy(arm.config.mission.strategy).networks.empty())
    networks_ = TrainNetworks(plan_, {reader_.dir(), cache_dir_, ThreadsFor(0), nullptr});
  return TaskOf(plan_, inputs_, networks_.get(), id);
}

}  // namespace ed3r
