// What figures read from a run directory beside the missions of its arms: which stages were warm-ups, how the arms were
// set, a few whole missions, the world they flew in. Reads stores, flies nothing.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "engine/mission/record.h"
#include "engine/store/reader.h"
#include "engine/sweep/plan.h"
#include "engine/world/scene.h"

namespace ed3r::figures {

// One arm as the stored plan has it.
struct ArmPlan {
  std::string stage, name;
  bool warmup = false;                             // a training stage builds on its stage
  std::map<std::string, std::string> settings;     // every parameter of its configuration, as text
  std::optional<sweep::Precision> precision = {};  // of its stage

  // "" where there is none of that key.
  std::string Setting(const std::string& key) const;
};

// Every arm of SweepPlan::CanonicalText(), those of training stages included, in plan order.
std::vector<ArmPlan> ReadArmPlans(std::string_view plan_text);

// A mission worth showing, with its timesteps.
struct ShownMission {
  std::string stage, arm;
  int number = 0;
  mission::MissionRecord record;
};

// Up to one mission per outcome (success, false positive, battery depleted), all of one world: from the first arm that
// has any with stored timesteps, the one of the median duration. Arms are tried in this order: ed3r-75, other arms, warm-ups.
std::vector<ShownMission> PickMissions(store::ResultReader& reader, std::span<const ArmPlan> plans);

struct FoundScene {
  std::shared_ptr<const world::Scene> scene;
  std::string why_not;  // half a sentence, where there is none
};

// The world `world` (as the plan names it) of the run, from the files that the run keeps, if they make the scene that was
// flown.
FoundScene FindScene(store::ResultReader& reader, const std::string& world);

// All of it at once.
struct RunSource {
  std::vector<ArmPlan> plans;
  std::vector<ShownMission> missions;
  FoundScene scene;  // of the missions
};

// Of a sweep with variants: of this one, with the names that its arms have among themselves.
RunSource ReadRunSource(store::ResultReader& reader, const std::string& variant);

}  // namespace ed3r::figures
