// What missions are expected to take, for plans and batch scripts.
#pragma once

#include <cstdint>

#include "engine/sweep/plan.h"

namespace ed3r::app {

// Seconds of one core for one mission of the arm, on this engine's reference machine.
double ExpectedCoreS(const sweep::Arm& arm);

// For all missions of a stage; 0 for a training stage.
double ExpectedCoreS(const sweep::Stage& stage);

// What the networks of a plan take; none where nothing is trained, or by several stages.
struct ExpectedTraining {
  std::int64_t networks = 0;
  double core_s = 0.0;  // of one of them, on one core
};
ExpectedTraining ExpectedTrainingOf(const sweep::SweepPlan& plan);

// The tasks that a stage is divided into, as 'ed3r run --shard I/N' and 'ed3r slurm' do it.
struct ExpectedShards {
  std::int64_t tasks = 0;          // no more than there are missions
  double missions = 0.0;           // of a task, mean
  double core_s = 0.0;             // of a task, mean
  double longest_over_mean = 1.0;  // of all tasks' durations, expected
};

// Tasks have the same missions of every arm, so that they differ by the luck of their missions alone, and the fewer they
// have the more (results/scale.md: expected 1.10, 1.36 and 1.98 where 1.11, 1.39 and 2.00 were found). For a stage that flies.
ExpectedShards ExpectedShardsOf(const sweep::Stage& stage, std::int64_t shards);

}  // namespace ed3r::app
