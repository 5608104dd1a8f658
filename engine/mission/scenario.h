// What nature deals a mission: site, base station, start pose, and per timestep CPU, bandwidth and shadowing.
// All of it is keyed by (seed, scenario, timestep), so every arm that flies a scenario meets the same (R26, R27, R31).
#pragma once

#include <cstdint>

#include "engine/config/config.h"
#include "engine/robot/motion.h"
#include "engine/world/scene.h"

namespace ed3r::mission {

struct Scenario {
  std::uint32_t number = 0;
  int site = 0;          // index into Scene::Sites
  int base_station = 0;  // index into Scene::BaseStations
  robot::Pose start;
};

// Sites and base stations in play take turns, so that any run of missions is balanced as evenly as its length allows.
// Throws UserError when the world has none of the asked kind.
Scenario DealScenario(const world::Scene& scene, const MissionConfig& mission, std::uint64_t seed,
                      std::uint32_t number);

// Number of (site, base station) pairs in play: that many missions in a row meet each once.
int PlacesInPlay(const world::Scene& scene, const MissionConfig& mission);

struct Conditions {
  double cpu_hz = 0.0;
  double bandwidth_hz = 0.0;
  double shadowing_db = 0.0;
};
Conditions DrawConditions(const Config& config, std::uint64_t seed, std::uint32_t scenario,
                          std::uint32_t timestep);

}  // namespace ed3r::mission
