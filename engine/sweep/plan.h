// A sweep, read and expanded: stages of arms of numbered missions. What a run does is a pure function of this
// plan (and the code): the plan's canonical text is its identity.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "engine/config/config.h"

namespace ed3r {

enum class StageKind { kFly, kTrain };

// One cell of the study: a name and its full configuration.
struct Arm {
  std::string name;
  Config config;
  // What the top-level axes of a sweep with stages set: "" without such axes. Every stage is flown once per variant, and
  // a variant's networks learn from its own warm-up.
  std::string variant;
  std::vector<std::pair<std::string, std::string>> settings;  // what the axes set, for tables

  // config.mission.world as the canonical text has it: relative to the sweep file's folder, or absolute where
  // it was written so. config.mission.world itself can be opened as it stands. "" (a plan made by hand): the
  // two are the same.
  std::string world;
};

struct Stage {
  std::string name;
  StageKind kind = StageKind::kFly;
  std::vector<std::string> after;  // stages that must be finished first; earlier in the plan
  int missions = 0;                // per arm; 0 for a training stage
  std::vector<Arm> arms;
};

struct SweepPlan {
  std::string name;
  std::string question;  // first comment line of the file
  std::string file;      // as given
  std::uint64_t seed = 0;
  std::vector<Stage> stages;

  std::int64_t Missions() const;  // of all stages and arms
  // Every stage, arm and parameter in order: equal plans give equal text, wherever the file lies.
  std::string CanonicalText() const;
};

// A mission of the plan.
struct RunId {
  int stage = 0;
  int arm = 0;
  int mission = 0;
  auto operator<=>(const RunId&) const = default;
};

}  // namespace ed3r
