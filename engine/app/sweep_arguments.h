// What commands that take a sweep have in common: the file, its overrides, where its results lie.
#pragma once

#include <string>
#include <vector>

#include "engine/app/command_line.h"
#include "engine/sweep/plan.h"

namespace ed3r::app {

struct SweepArguments {
  std::string file;
  std::vector<std::string> set;
  std::string seed;                   // "" for the file's own
  std::vector<std::string> missions;  // "N" or "STAGE=N"; empty for the file's own

  void AddTo(CommandLine& parser);
  sweep::SweepPlan Load() const;  // throws UserError
};

// results/runs/<sweep name>
std::string DefaultRunDir(const sweep::SweepPlan& plan);

}  // namespace ed3r::app
