// When in a flown mission what happened: its timesteps one after the other.
#pragma once

#include <algorithm>
#include <vector>

#include "engine/mission/record.h"

namespace ed3r::app {

// A timestep's parts follow one another: it moves, senses, computes, transmits.
inline double MovingS(const mission::TimestepRecord& s) {
  return s.horizontal_s + s.ascent_s + s.descent_s + s.turning_s;
}

inline double DurationS(const mission::TimestepRecord& s) {
  return s.horizontal_s + s.ascent_s + s.descent_s + s.turning_s + s.sensing_s + s.computing_s +
         s.transmitting_s;
}

// Of each timestep, and the mission's end.
inline std::vector<double> BeginsS(const mission::MissionRecord& record) {
  std::vector<double> begins = {0.0};
  for (const mission::TimestepRecord& step : record.steps) begins.push_back(begins.back() + DurationS(step));
  return begins;
}

// Index of the timestep under way at a time, from BeginsS; the last one from the mission's end on.
inline std::size_t StepAt(const std::vector<double>& begins_s, double time_s) {
  const auto next = std::upper_bound(begins_s.begin(), begins_s.end() - 1, time_s);
  return next == begins_s.begin() ? 0 : static_cast<std::size_t>(next - begins_s.begin()) - 1;
}

}  // namespace ed3r::app
