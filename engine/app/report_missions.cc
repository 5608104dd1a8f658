#include "engine/app/report_missions.h"

#include <algorithm>

#include "engine/app/mission_viewer.h"
#include "engine/core/check.h"
#include "studies/report/page_choice.h"
#include "studies/report/web_page.h"

namespace ed3r::app {
namespace {

std::string FileOf(std::string mission) {
  std::replace(mission.begin(), mission.end(), '/', '-');
  return "missions/" + mission + ".html";
}

WatchedMissions Fly(const std::vector<report::ChosenMission>& chosen, const report::WebBundle& bundle,
                    const std::string& dir, const std::string& cache_dir) {
  StoredRun run(dir, cache_dir);
  WatchedMissions watched;
  for (const auto& [mission, what] : chosen) {
    const mission::MissionTask task = run.Task(run.Find(mission));
    if (task.pixels != nullptr)
      return {{},
              "no missions to watch: those that look at pixels take long; 'ed3r replay DIR MISSION --html'"};
    const nlohmann::ordered_json data = {{"format", 1},
                                         {"run", run.Plan().name},
                                         {"world", ViewerWorld(task.scene)},
                                         {"missions", {ViewerMission(run, mission)}}};
    watched.list.push_back({mission, what, FileOf(mission),
                            report::SelfContainedPage(mission + " – ED³R mission", bundle, data, "")});
  }
  return watched;
}

}  // namespace

WatchedMissions WatchMissions(const report::Report& report, const report::RunResults& results,
                              const std::string& dir, const std::string& cache_dir) {
  const report::FoundBundle found = report::FindWebBundle("viewer");
  if (!found.bundle) return {};
  try {
    return Fly(report::ChooseMissions(report, results, dir), *found.bundle, dir, cache_dir);
  } catch (const UserError& error) {
    return {{}, std::string("no missions to watch: ") + error.what()};
  }
}

}  // namespace ed3r::app
