// All parameters of a mission. Plain data: defaults are the paper's values and the readings'.
// Thread safety: a value; share it read-only.
#pragma once

#include "engine/config/agents.h"
#include "engine/config/energy.h"
#include "engine/config/environment.h"
#include "engine/config/mission.h"
#include "engine/config/perception.h"
#include "engine/config/robot.h"
#include "engine/config/training.h"

namespace ed3r {

// The point at which `ed3r physics` evaluates the closed forms; in a mission these are drawn per timestep.
struct OperatingPoint {
  double cpu_frequency_hz = 3.2e9;
  double radio_distance_m = 60.0;
  double radio_bandwidth_hz = 22.5e6;
  double radio_shadowing_db = 0.0;
};

struct Config {
  MissionConfig mission;
  RobotConfig robot;
  CpuConfig cpu;
  SensingConfig sensing;
  RadioConfig radio;
  EnvironmentConfig environment;
  EnergyConfig energy;
  PerceptionConfig perception;
  AgentsConfig agents;
  RbsConfig rbs;
  NetworksConfig networks;
  TrainingConfig training;
  OperatingPoint point;

  template <class Self, class Visitor>
  static void Describe(Self& self, Visitor&& visit) {
    visit.Nested("mission", self.mission);
    visit.Nested("robot", self.robot);
    visit.Nested("cpu", self.cpu);
    visit.Nested("sensing", self.sensing);
    visit.Nested("radio", self.radio);
    visit.Nested("environment", self.environment);
    visit.Nested("energy", self.energy);
    visit.Nested("perception", self.perception);
    visit.Nested("agents", self.agents);
    visit.Nested("rbs", self.rbs);
    visit.Nested("networks", self.networks);
    visit.Nested("training", self.training);
    constexpr std::string_view kSource = "ed3r physics only";
    visit("cpu.frequency_hz", self.point.cpu_frequency_hz,
          {.unit = "Hz",
           .min = 1e8,
           .max = 1e10,
           .source = kSource,
           .meaning = "f_k",
           .scope = Scope::kPhysicsOnly});
    visit("radio.distance_m", self.point.radio_distance_m,
          {.unit = "m",
           .min = 0,
           .max = 100000,
           .source = kSource,
           .meaning = "distance to the RC",
           .scope = Scope::kPhysicsOnly});
    visit("radio.bandwidth_hz", self.point.radio_bandwidth_hz,
          {.unit = "Hz",
           .min = 1e5,
           .max = 1e9,
           .source = kSource,
           .meaning = "b_k",
           .scope = Scope::kPhysicsOnly});
    visit("radio.shadowing_db", self.point.radio_shadowing_db,
          {.unit = "dB",
           .min = -60,
           .max = 60,
           .source = kSource,
           .meaning = "shadowing added to the path loss",
           .scope = Scope::kPhysicsOnly});
  }
};

}  // namespace ed3r
