// Runs a sweep from its plan to stored results: stage by stage, each resumable.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/mission/mission.h"
#include "engine/schedule/inputs.h"
#include "engine/schedule/phase_sampler.h"
#include "engine/schedule/progress_of_stage.h"
#include "engine/schedule/scheduler.h"
#include "engine/schedule/todo.h"
#include "engine/schedule/training_stage.h"
#include "engine/store/recipe.h"
#include "engine/store/records.h"
#include "engine/sweep/plan.h"

namespace ed3r::schedule {

// The code that decides this plan's results: of the subsystems that its arms use, and of the C library's mathematical functions.
store::CodeIdentities CodeOf(const sweep::SweepPlan& plan);

// UserError where the run that a stage builds on, in `dir`, was made by code `there` that is not all of this program's, `here`.
void RefuseOtherCode(const std::string& dir, const store::CodeIdentities& there,
                     const store::CodeIdentities& here);

// What a plan makes of a mission: the same for flying, replaying and explaining.
// `networks` may be null for arms that ask none. Plan, inputs and networks must outlive the task.
mission::MissionTask TaskOf(const sweep::SweepPlan& plan, const Inputs& inputs, const NetworkShelf* networks,
                            const sweep::RunId& id);

// Flies missions of one arm whose decisions come from outside (strategy external). Each that has ended is offered, or why it
// failed; what is left when `stop` becomes true is flown another time. What it throws ends the sweep; what was offered is
// kept.
using OfferFn = std::function<void(const sweep::RunId& id, std::optional<mission::MissionRecord> record,
                                   store::Failure failure)>;
using OutsideFn = std::function<void(const sweep::Arm& arm, const std::vector<sweep::RunId>& todo,
                                     const OfferFn& offer, const std::atomic<bool>& stop)>;

struct SweepOptions {
  std::string dir;
  std::string stage = {};       // fly or train only this one; "" all
  std::string foundation = {};  // the run directory that holds what the stage builds on; "" dir itself
  std::string cache_dir;        // networks of all sweeps
  Shard shard;
  ScheduleOptions schedule;
  bool repair = false;                       // take damaged missions of this part out and fly them again
  bool only_failed = false;                  // fly what has failed again, and nothing that is missing
  bool profile = false;                      // look where the time goes
  bool accept_mixed = false;                 // continue what other code has begun
  HalfWidthFn half_width;                    // asked by stages with a precision
  OutsideFn outside;                         // without it a plan with such arms is refused
  std::string outside_identity;              // of what decides: a run is continued by the same alone
  std::map<std::string, std::string> notes;  // on machine and libraries, stored with the session
};

struct SweepSummary {
  RunSummary flown;                // of this session
  std::string grown;               // what the plan has got since the run was begun; "" where nothing
  std::int64_t stored_before = 0;  // missions that were there already
  std::vector<store::DamagedMission> repaired;  // taken out to be flown again
  std::vector<ShelvedNetwork> networks;         // trained or found
  PhaseTimes profile;         // of options.profile; also a note of the session, kProfileNote
  std::string waiting_stage;  // a stage that could not begin because a shard or a failed mission is missing
};

// Flies what is missing. The same call again continues where it stopped. Everything that is stored is compared with its
// checksums first: UserError that names the first damaged mission, unless this call may repair it and flies it again.
//
// A task of a batch system gives `stage` and `foundation`: it flies its shard of one stage into a store of its own and
// reads the missions and networks of the stages before from the merged run, which it does not change. Of a stage with a
// precision it flies its shard of the round that is due by what the foundation holds.
SweepSummary RunSweep(const sweep::SweepPlan& plan, const Inputs& inputs, const SweepOptions& options);

}  // namespace ed3r::schedule
