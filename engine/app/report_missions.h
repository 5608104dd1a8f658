// Missions worth watching, beside a report: viewer pages for a few of a run.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "studies/figures/run_source.h"

namespace ed3r::report {
struct Report;
struct RunResults;
}  // namespace ed3r::report

namespace ed3r::app {

struct WatchedMission {
  std::string mission;  // STAGE/ARM/NUMBER
  std::string what;     // as in studies/report/page_choice.h
  std::string file;     // below the report's folder
  std::string page;
};

struct WatchedMissions {
  std::vector<WatchedMission> list;
  std::string note;  // why there are none, though they were wanted; "" otherwise
};

// Those of ChooseMissions, flown again. None where the viewer's program is missing; none and a note in the pixel tier (a flight
// is dear) and where the run cannot be flown again by this code.
WatchedMissions WatchMissions(const report::Report& report, const report::RunResults& results,
                              std::span<const figures::ArmPlan> plans, const std::string& dir,
                              const std::string& cache_dir);

}  // namespace ed3r::app
