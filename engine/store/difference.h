// Where two runs part: the first number that differs.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace ed3r::store {

class ResultReader;

struct FirstDifference {
  std::string mission;      // "stage online, arm rbs, mission 12"
  int timestep = 0;         // 0: of the mission's own record
  std::string quantity;     // name of the column; "mission" or "timestep" where only one run has it
  std::string here, there;  // as text, in full; "" where that run has none
};

struct RunDifference {
  std::optional<FirstDifference>
      first;                   // in the order of the plan; a mission's timesteps come before its record
  std::int64_t compared = 0;   // missions that both runs hold
  std::int64_t differing = 0;  // of those
  std::int64_t only_here = 0, only_there = 0;
};

// Missions are paired by the names of their stage and arm and their number, so that runs of different plans can be
// compared where they have arms in common. `first` is of those, unless they are alike and one run has arms more.
RunDifference DiffRuns(ResultReader& here, ResultReader& there);

}  // namespace ed3r::store
