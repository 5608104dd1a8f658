#include "engine/app/report_missions.h"

#include <algorithm>

#include "engine/app/pictures/mission_viewer.h"
#include "engine/core/check.h"
#include "studies/report/page_choice.h"
#include "studies/report/web_page.h"

namespace ed3r::app {
namespace {

std::string NameOf(std::string mission) {
  std::replace(mission.begin(), mission.end(), '/', '-');
  return mission + ".html";
}

std::string FileOf(const std::string& mission) { return "missions/" + NameOf(mission); }

WatchedMissions Fly(const std::vector<report::ChosenMission>& chosen, const report::WebBundle& bundle,
                    const std::string& dir, const std::string& cache_dir) {
  StoredRun run(dir, cache_dir);
  WatchedMissions watched;
  // Beside one another in one folder, below the report.
  const auto link = [&](std::size_t at) {
    return at < chosen.size()
               ? nlohmann::ordered_json{{"file", NameOf(chosen[at].mission)}, {"what", chosen[at].what}}
               : nlohmann::ordered_json(nullptr);
  };
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const auto& [mission, what] = chosen[i];
    const mission::MissionTask task = run.Task(run.Find(mission));
    if (task.pixels != nullptr)
      return {{},
              "no missions to watch: those that look at pixels take long; 'ed3r replay DIR MISSION --html'"};
    const nlohmann::ordered_json data = {{"format", 1},
                                         {"run", run.Plan().name},
                                         {"report", "../index.html"},
                                         {"what", what},
                                         {"previous", i > 0 ? link(i - 1) : nlohmann::ordered_json(nullptr)},
                                         {"next", link(i + 1)},
                                         {"world", ViewerWorld(task.scene)},
                                         {"missions", {ViewerMission(run, mission)}}};
    watched.list.push_back({mission, what, FileOf(mission),
                            report::SelfContainedPage(mission + report::kMissionTitle, bundle, data, "")});
  }
  return watched;
}

}  // namespace

WatchedMissions WatchMissions(const report::Report& report, const report::RunResults& results,
                              std::span<const figures::ArmPlan> plans, const std::string& dir,
                              const std::string& cache_dir) {
  const report::FoundBundle found = report::FindWebBundle("viewer");
  if (!found.bundle) return {};
  try {
    return Fly(report::ChooseMissions(report, results, plans), *found.bundle, dir, cache_dir);
  } catch (const UserError& error) {
    return {{}, std::string("no missions to watch: ") + error.what()};
  }
}

}  // namespace ed3r::app
