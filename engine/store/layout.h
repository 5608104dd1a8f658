// The shape of a run as the store needs it: names and numbers of stages and arms, nothing of their content.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/sweep/plan.h"

namespace ed3r::store {

struct RunLayout {
  struct Arm {
    std::string name;
    std::int64_t first_scenario = 0;  // mission i flies scenario first_scenario + i
    bool operator==(const Arm&) const = default;
  };
  struct Stage {
    std::string name;
    std::int64_t missions = 0;  // per arm; 0 for a training stage
    std::vector<Arm> arms;
    bool operator==(const Stage&) const = default;
  };
  std::string name;  // of the sweep
  std::uint64_t seed = 0;
  std::vector<Stage> stages;

  // Equal in all that decides which missions there are; the sweep's name may differ.
  bool SameMissions(const RunLayout& other) const { return seed == other.seed && stages == other.stages; }

  std::int64_t Missions() const;
  // Number of an arm counted over all stages: the key `run` of the tables. InternalError when there is none.
  std::int64_t RunIndex(int stage, int arm) const;
  std::int64_t RunIndex(const sweep::RunId& id) const;
  // Number of a mission counted over all stages and arms, in plan order.
  std::int64_t LinearIndex(const sweep::RunId& id) const;
  bool Contains(const sweep::RunId& id) const;
  std::int64_t Scenario(const sweep::RunId& id) const;
  // The mission that the tables keep under these keys; none where the plan has no such mission.
  std::optional<sweep::RunId> Place(std::int64_t run, std::int64_t mission) const;
  // "stage online, arm rbs, mission 12"
  std::string Describe(const sweep::RunId& id) const;
  // The same for keys that need not be in the plan: "run 99, mission 12" where there is no such arm.
  std::string DescribeKeys(std::int64_t run, std::int64_t mission) const;
};

RunLayout LayoutOf(const sweep::SweepPlan& plan);

}  // namespace ed3r::store
