// How a store that lies beside a run, of a batch system's task, stands to it by what both were flown from.
#pragma once

#include <optional>
#include <set>
#include <string>

#include "engine/store/layout.h"
#include "engine/store/recipe.h"

namespace ed3r::store {

class ResultReader;

enum class PartPlan {
  kSame,     // its missions are the run's
  kEarlier,  // of the plan before the run grew: it holds missions that the run has, too
  kGrown,    // of a plan that the run's may grow into
  kMixed,    // of such a plan, but flown by code that the run does not know
  kOther,    // its missions belong to another run
};

struct PartOfRun {
  PartPlan plan = PartPlan::kSame;
  // Of kGrown: what it has got; of kMixed and kOther: the first that differs, "there" being the run; else "".
  std::string what;

  bool Counts() const { return plan == PartPlan::kSame || plan == PartPlan::kEarlier; }
};

// Compares recipes, neither code nor missions. By the part's own networks: a warm-up that they learned from cannot have grown.
PartOfRun ComparePlans(const Recipe& run, const RunLayout& layout, ResultReader& part);

// The same and the code.
PartOfRun FindPlan(const Recipe& run, const RunLayout& layout, ResultReader& part);

// The stages whose arms have networks in the store, as GrowthOf asks.
std::set<std::string> StagesWithNetworks(ResultReader& reader);

// The mission of that stage, arm and number in `to`, which may have more of all; none where it has no such arm.
std::optional<sweep::RunId> SameMission(const RunLayout& from, const sweep::RunId& id, const RunLayout& to);

}  // namespace ed3r::store
