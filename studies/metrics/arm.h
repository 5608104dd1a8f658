// The missions of one arm of a study, as read from a store.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "engine/mission/record.h"

namespace ed3r::metrics {

struct ArmData {
  std::string stage, name;
  std::vector<mission::MissionRecord> missions;  // in mission order; without their timesteps
  int failed = 0;                                // threw inside the program; nothing of them counts
  int missing = 0;                               // planned, not flown yet
  std::string world = {};         // fingerprint of what it was flown in; "" where it is not known
  std::vector<int> numbers = {};  // of the missions in the plan; none where they are of no store
};

// What the warm-up had seen of a mission's place (the networks learnt on 6 of 14 sites and 1 of 2 stations).
enum class SplitBy { kSite, kBaseStation };

struct KnownUnseen {
  ArmData known, unseen;
};

// The arm's missions in two groups, order kept. Failed and missing missions are in neither: their place is
// not in a record.
KnownUnseen Split(const ArmData& arm, SplitBy by);

// How many missions `percent` of them are, to the nearest.
constexpr std::size_t SizeOfShare(std::size_t missions, int percent) {
  return (missions * static_cast<std::size_t>(percent) + 50) / 100;
}

// The `percent` of the arm's missions (0..100, rounded to the nearest mission, half up) that took longest; of
// equally long ones those that come first. Order, stage and name kept; failed and missing missions are not in
// it.
ArmData LongestShare(const ArmData& arm, int percent);

inline constexpr int kP85Percent = 15;
constexpr std::size_t SizeOfP85(std::size_t missions) { return SizeOfShare(missions, kP85Percent); }

// The paper's P85 group: the 15 % longest missions (R30; 128 of 850), under the paper's name for it
// (paper/arms.h).
ArmData P85Group(const ArmData& arm);

}  // namespace ed3r::metrics
