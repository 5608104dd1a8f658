// Runs a sweep from its plan to stored results: stage by stage, each resumable.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "engine/mission/mission.h"
#include "engine/schedule/scheduler.h"
#include "engine/schedule/todo.h"
#include "engine/schedule/training_stage.h"
#include "engine/sweep/plan.h"
#include "engine/world/scene.h"

namespace ed3r {

// World files of a plan, each built once.
using Worlds = std::map<std::string, std::shared_ptr<const Scene>>;

// Builds every world of the plan and checks every arm against it: strategy, sites in play, airframe. Throws UserError
// that names the sweep file and the arm. Also CheckTraining. Writes nothing.
Worlds LoadWorlds(const SweepPlan& plan);

// What a plan makes of a mission: the same for flying, replaying and explaining.
// `networks` may be null for arms that ask none. Plan, worlds and networks must outlive the task.
MissionTask TaskOf(const SweepPlan& plan, const Worlds& worlds, const NetworkShelf* networks,
                   const RunId& id);

struct SweepOptions {
  std::string dir;
  std::string cache_dir;  // networks of all sweeps
  Shard shard;
  ScheduleOptions schedule;
  std::map<std::string, std::string> notes;  // on machine and libraries, stored with the session
};

struct SweepSummary {
  RunSummary flown;                      // of this session
  std::int64_t stored_before = 0;        // missions that were there already
  std::vector<ShelvedNetwork> networks;  // trained or found
  std::string waiting_stage;  // a stage that could not begin because a shard or a failed mission is missing
};

// Flies what is missing. The same call again continues where it stopped.
SweepSummary RunSweep(const SweepPlan& plan, const Worlds& worlds, const SweepOptions& options);

}  // namespace ed3r
