// One mission: one world, one thread, no clock, no I/O. A record is a pure function of the task.
//
// Each timestep reads like the paper: the RC decides a motion (stage 1), the robot flies it, decides where and how to
// detect (stage 2), senses and detects, and everything is billed. Nothing is learned online (R18).
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

#include "engine/agents/context.h"
#include "engine/agents/remote_controller.h"
#include "engine/agents/robot_agent.h"
#include "engine/config/config.h"
#include "engine/mission/record.h"
#include "engine/perception/pixels/pixel_sensor.h"
#include "engine/robot/flight.h"
#include "engine/world/scene.h"

namespace ed3r {

// What both agents saw and thought in one timestep, for `ed3r explain`.
struct DecisionProbe {
  std::uint32_t timestep = 0;  // which one is asked for
  bool reached = false;        // the mission got that far
  RcView rc_view;
  MotionDecision motion;
  CandidateTrace candidates;  // empty where the choice was not greedy
  RobotView robot_view;
  ExecutionDecision execution;
  std::array<double, 3> robot_rewards{};  // predicted, by Execution; NaN without a network
};

struct MissionTask {
  const Scene& scene;
  const Config& config;
  const PixelTier* pixels = nullptr;  // where perception.tier is pixels
  std::uint64_t seed = 0;
  std::uint32_t scenario = 0;
  int mission = 0;                          // its number within its arm, for the decay of epsilon (R20)
  Networks networks = {};                   // where the strategy asks any
  int network_seed = -1;                    // which of the arm's training seeds these are, for the record
  const std::atomic<bool>* stop = nullptr;  // checked between timesteps; set: Interrupted is thrown
  DecisionProbe* probe = nullptr;
  TraceSink* trace = nullptr;  // receives the flown path; for replays
};

// Throws BrokenInvariant (invariants.h), InternalError for any other defect, UserError when the configuration does not fit
// the world, Interrupted.
// Threads: tasks may share scene and config.
MissionRecord FlyMission(const MissionTask& task);

}  // namespace ed3r
