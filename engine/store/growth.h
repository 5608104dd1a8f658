// A run may grow: more missions per arm, or arms that were not there. It may not change otherwise: every mission that is
// stored stays what it was, with its scenario, its parameters and the networks that it flew with.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "engine/store/layout.h"
#include "engine/store/recipe.h"
#include "engine/store/sqlite.h"

namespace ed3r::store {

// How the plan of a run becomes another one.
struct Growth {
  std::string
      difference;  // what forbids it, half a sentence with what is there and what is here; "" where nothing does
  std::string what;  // what is added: "stage online: 20 missions per arm for 10; more arms: rbs,heavy"

  bool Allowed() const { return difference.empty(); }
};

// Of two different plans. `learned`: stages whose arms have networks in the run, which learned from its warm-up: that
// must stay as it is. Code is compared elsewhere. Pure.
Growth GrowthOf(const Recipe& there, const Recipe& here, const std::set<std::string>& learned);

// The stages whose arms have networks in the file.
std::set<std::string> LearnedStages(Connection& database, const RunLayout& layout);

// The arm's number in the grown plan, by stage and number there.
std::vector<std::vector<int>> ArmsAfterGrowth(const RunLayout& there, const RunLayout& here);

// Gives the file the grown plan and its missions the numbers that their arms have in it. Call it in a transaction.
void Grow(Connection& database, const Recipe& recipe, const RunLayout& layout);

}  // namespace ed3r::store
