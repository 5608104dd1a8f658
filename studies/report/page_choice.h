// Missions worth watching, for viewer pages beside a report.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "studies/figures/run_source.h"

namespace ed3r::report {

struct Report;
struct RunResults;

struct ChosenMission {
  std::string mission;  // STAGE/ARM/NUMBER
  std::string what;     // "a typical success", "the longest", ...
};

// Of the arm that the study is about (ed3r-75, else the one with the most successes): the success of the median duration, the
// one for the least energy, the longest mission; of each kind of failure the median one, of that arm if it has any, else of the
// arm with the most. Warm-ups only where nothing else was flown. `plans`: of the arms.
std::vector<ChosenMission> ChooseMissions(const Report& report, const RunResults& results,
                                          std::span<const figures::ArmPlan> plans);

}  // namespace ed3r::report
