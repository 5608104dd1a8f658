// A sweep, read and expanded: stages of arms of numbered missions. What a run does is a pure function of this
// plan (and the code): the plan's canonical text is its identity.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/config/config.h"
#include "engine/sweep/kept_timesteps.h"

namespace ed3r::sweep {

enum class StageKind { kFly, kTrain };

// One cell of the study: a name and its full configuration.
struct Arm {
  std::string name;
  Config config;
  // What the top-level axes of a sweep with stages set: "" without such axes. Every stage is flown once per variant, and
  // a variant's networks learn from its own warm-up.
  std::string variant;
  std::vector<std::pair<std::string, std::string>> settings;  // what the axes set, for tables

  // By key, the parameters that name files (world, detectors) as the canonical text has them: relative to the sweep
  // file's folder, or absolute where they were written so. In `config` they can be opened as they stand. Without an
  // entry (a plan made by hand) the two are the same.
  std::map<std::string, std::string> files;

  // `config` with its files as the canonical text has them.
  Config CanonicalConfig() const;
};

// An arm stops early once the 95 % interval of one metric is narrow enough. Looked at after every `every` missions in the
// order of their numbers, so that the end does not depend on threads or interruptions. Looking often makes the last
// interval a little too narrow: choose `every` large.
struct Precision {
  std::string metric;
  double half_width = 0.0;  // in the metric's unit
  int every = 140;          // five missions at each of the 28 places of the default world
};

struct Stage {
  std::string name;
  StageKind kind = StageKind::kFly;
  std::vector<std::string> after;  // stages that must be finished first; earlier in the plan
  int missions = 0;                // per arm, at most where `precision` is set; 0 for a training stage
  std::optional<Precision> precision;
  std::vector<Arm> arms;
  KeptTimesteps timesteps = KeptTimesteps::kAll;
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

}  // namespace ed3r::sweep
