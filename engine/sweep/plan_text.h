// A plan back from its canonical text: what a run directory knows of the study that made it.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/sweep/plan.h"

namespace ed3r::sweep {

// SweepPlan::CanonicalText() as it stands, also of a version that had other parameters than this one.
struct WrittenPlan {
  struct Arm {
    std::string name;
    std::map<std::string, std::string> settings;  // every parameter, by key
  };
  struct Stage {
    std::string name;
    StageKind kind = StageKind::kFly;
    std::vector<std::string> after;
    int missions = 0;
    std::optional<Precision> precision;
    std::vector<Arm> arms;
    KeptTimesteps timesteps = KeptTimesteps::kAll;
  };
  std::string name;
  std::uint64_t seed = 0;
  std::vector<Stage> stages;
};

// Lines that this version does not know are left out; a line that it knows and cannot read is a UserError.
WrittenPlan ReadPlanText(std::string_view text);

// The plan itself: its canonical text is the one that was read. Its files are named as in the text; `settings` of the
// arms, which only 'ed3r plan' shows, are not in it. UserError that begins with `from` where this version does not know
// a parameter, or knows another one.
SweepPlan PlanOf(const WrittenPlan& written, const std::string& from);

}  // namespace ed3r::sweep
