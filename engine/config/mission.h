// What a mission is: strategy, world, scenarios, start (R26, R27, R31).
#pragma once

#include <string>

#include "engine/config/field.h"

namespace ed3r {

enum class SiteSet { kAll, kKnown };
template <>
struct EnumNames<SiteSet> {
  static constexpr EnumName<SiteSet> kNames[] = {{SiteSet::kAll, "all"}, {SiteSet::kKnown, "known"}};
};

enum class StartYaw { kDrawn, kFixed };
template <>
struct EnumNames<StartYaw> {
  static constexpr EnumName<StartYaw> kNames[] = {{StartYaw::kDrawn, "drawn"}, {StartYaw::kFixed, "fixed"}};
};

struct MissionConfig {
  std::string strategy = "rbs";
  std::string world = "worlds/paper.yaml";
  SiteSet sites = SiteSet::kAll;
  SiteSet base_stations = SiteSet::kAll;
  int first_scenario = 0;
  StartYaw start_yaw = StartYaw::kDrawn;
  double start_yaw_deg = 0.0;
  int max_timesteps = 2000;
  double physics_hz = 120.0;

  template <class Self, class Visitor>
  static void Describe(Self& self, Visitor&& visit) {
    visit("strategy", self.strategy,
          {.source = "Result 2, Result 3", .meaning = "who decides what: a name of the strategy table"});
    visit("world", self.world,
          {.source = "3D Environment", .meaning = "world file, relative to the sweep file", .is_file = true});
    visit("sites", self.sites,
          {.source = "R26, R27", .meaning = "fire sites in play: all, or those known from the warm-up"});
    visit("base_stations", self.base_stations,
          {.source = "R26, R27", .meaning = "base stations in play: all, or those known from the warm-up"});
    visit("first_scenario", self.first_scenario,
          {.min = 0,
           .max = 1000000000,
           .source = "R27",
           .meaning = "mission i flies scenario first_scenario + i; equal scenarios meet equal draws"});
    visit("start_yaw", self.start_yaw,
          {.source = "R31", .meaning = "start heading: drawn per mission, or fixed"});
    visit("start_yaw_deg", self.start_yaw_deg,
          {.unit = "deg",
           .min = -180,
           .max = 180,
           .source = "R31",
           .meaning = "heading of a fixed start; 0 east, counter-clockwise"});
    visit("max_timesteps", self.max_timesteps,
          {.min = 1,
           .max = 100000,
           .source = "R9",
           .meaning = "a mission that is longer is a failed record (the battery ends it far earlier)"});
    visit("physics_hz", self.physics_hz,
          {.unit = "Hz",
           .min = 60,
           .max = 4800,
           .source = "none in the paper",
           .meaning = "steps of flight, its controller and rotors a second"});
  }
};

}  // namespace ed3r
