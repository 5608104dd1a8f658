// Missions worth watching, for viewer pages beside a report.
#pragma once

#include <string>
#include <vector>

namespace ed3r::report {

struct Report;
struct RunResults;

struct ChosenMission {
  std::string mission;  // STAGE/ARM/NUMBER
  std::string what;     // "a typical success", "the longest", ...
};

// Of the arm that the study is about (ed3r-75, else the one with the most successes): the success of the median duration, the
// one for the least energy, the longest mission; of each kind of failure the median one, of that arm if it has any, else of the
// arm with the most. Warm-ups only where nothing else was flown. Throws UserError as LoadRun.
std::vector<ChosenMission> ChooseMissions(const Report& report, const RunResults& results,
                                          const std::string& dir);

}  // namespace ed3r::report
