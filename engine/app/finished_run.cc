#include "engine/app/finished_run.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <exception>

#include "engine/app/words.h"
#include "engine/core/version.h"
#include "engine/schedule/input_files.h"
#include "engine/schedule/sweep_runner.h"
#include "engine/store/reader.h"

namespace ed3r::app {
namespace {

// This very build, with this cache: what it prints may differ from what another one does.
std::string ThisCommand(const std::string& cache) {
  struct stat found = {};
  if (stat("/proc/self/exe", &found) != 0) return "";
  return fmt::format("{} {} {}.{:09} {}", ThisCode().source_hash, found.st_size, found.st_mtim.tv_sec,
                     found.st_mtim.tv_nsec, cache);
}

// By what the files contain: worlds and detectors need not be loaded for that.
bool SameRecipe(const sweep::SweepPlan& plan, store::ResultReader& reader) {
  const store::Recipe& recipe = reader.StoredRecipe();
  if (recipe.plan_text != plan.CanonicalText() || store::CodeDifference(recipe.code, schedule::CodeOf(plan)))
    return false;
  const schedule::InputFiles here = schedule::ReadInputFiles(plan);
  return recipe.places == here.places && reader.Files() == here.files;
}

}  // namespace

bool TellFinishedRun(const sweep::SweepPlan& plan, const std::string& dir, const std::string& cache,
                     bool quiet) {
  try {
    const std::string command = ThisCommand(cache);
    const auto finished = command.empty() ? std::nullopt : store::RecallFinished(dir, command);
    if (!finished || (!quiet && finished->table.empty())) return false;
    store::ResultReader reader(dir);
    if (!SameRecipe(plan, reader)) return false;
    // A bad disk leaves the times as they are.
    const bool compared = reader.IsQuicklyCompared();
    if (compared && !reader.FindDamage().empty()) return false;
    reader.Networks();  // compared, too
    reader.CheckViews();
    if (!quiet)
      fmt::print("{}\n{}: {} stored ({} before)\n{}", finished->table, dir,
                 Counted(finished->missions, "mission"), finished->missions, finished->networks);
    FlushOutput();
    if (!compared)
      Tell(
          "note: {}: complete since it was flown, and not compared with its checksums again; 'ed3r verify "
          "{}' does",
          dir, dir);
    return true;
  } catch (const std::exception&) {
    return false;
  }
}

void RememberFinishedRun(const sweep::SweepPlan& plan, const std::string& dir, const std::string& cache,
                         const store::FileMoment& told, std::int64_t missions, const std::string& table,
                         const std::string& networks) {
  const std::string command = ThisCommand(cache);
  if (command.empty()) return;
  try {
    store::RememberFinished(dir, told, plan.CanonicalText(), {command, missions, table, networks});
  } catch (const std::exception&) {  // it saves time, and the results are stored
  }
}

}  // namespace ed3r::app
