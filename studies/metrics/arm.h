// The missions of one arm of a study, as read from a store.
#pragma once

#include <string>
#include <vector>

#include "engine/mission/record.h"

namespace ed3r {

struct ArmData {
  std::string stage, name;
  std::vector<MissionRecord> missions;  // in mission order; without their timesteps
  int failed = 0;                       // threw inside the program; nothing of them counts
  int missing = 0;                      // planned, not flown yet
};

// What the warm-up had seen of a mission's place (the networks learnt on 6 of 14 sites and 1 of 2 stations).
enum class SplitBy { kSite, kBaseStation };

struct KnownUnseen {
  ArmData known, unseen;
};

// The arm's missions in two groups, order kept. Failed and missing missions are in neither: their place is
// not in a record.
KnownUnseen Split(const ArmData& arm, SplitBy by);

}  // namespace ed3r
