// What a part of a run ('ed3r run SWEEP --shard I/N') tells at its end.
#pragma once

#include <string>

#include "engine/schedule/todo.h"
#include "engine/sweep/plan.h"

namespace ed3r::app {

// The missions of the part by stage and arm: how many there are, and are done, failed and missing in the store `dir`. `stage`: of
// this one alone; "": of all that fly.
std::string ShardTable(const sweep::SweepPlan& plan, const schedule::Shard& shard, const std::string& stage,
                       const std::string& dir);

// What to do next: one line. `waiting_stage`: what could not begin because it builds on the other parts, too; "" where
// nothing waits.
std::string AfterShard(const sweep::SweepPlan& plan, const schedule::Shard& shard, const std::string& stage,
                       const std::string& dir, const std::string& waiting_stage);

}  // namespace ed3r::app
