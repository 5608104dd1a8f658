// Every file that the missions of a plan read, for keeping with their results.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "engine/store/recipe.h"
#include "engine/sweep/plan.h"

namespace ed3r::schedule {

// Larger files are named, but not kept: a run directory is to stay one small file.
constexpr std::int64_t kLargestKeptFile = 16 * 1024 * 1024;

struct InputFiles {
  std::vector<store::InputFile> files;        // by name, each relative to the folder that holds them all
  std::map<std::string, std::string> places;  // what the plan calls a file -> its name
};

// Worlds with their elevation grids (and what stands beside these) and stem maps, and detectors that are files. UserError where one cannot be read.
InputFiles ReadInputFiles(const sweep::SweepPlan& plan);

}  // namespace ed3r::schedule
