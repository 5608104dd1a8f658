// One mission: one world, one thread, no clock, no I/O. A record is a pure function of the task.
//
// Each timestep reads like the paper: the RC decides a motion (stage 1), the robot flies it, decides where and how to
// detect (stage 2), senses and detects, and everything is billed. Nothing is learned online (R18).
//
// A Mission takes the decisions of whoever makes them; FlyMission() is the loop over it with the agents of the strategy,
// mission_stepper.h the one for decisions from outside.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "engine/agents/context.h"
#include "engine/agents/remote_controller.h"
#include "engine/agents/robot_agent.h"
#include "engine/config/config.h"
#include "engine/mission/record.h"
#include "engine/mission/scenario.h"
#include "engine/perception/pixels/pixel_sensor.h"
#include "engine/perception/sensor.h"
#include "engine/radio/link.h"
#include "engine/robot/flight.h"
#include "engine/robot/ledger.h"
#include "engine/world/scene.h"

namespace ed3r::mission {

// What both agents saw and thought in one timestep, for `ed3r explain`.
struct DecisionProbe {
  std::uint32_t timestep = 0;  // which one is asked for
  bool reached = false;        // the mission got that far
  agents::RcView rc_view;
  agents::MotionDecision motion;
  agents::CandidateTrace candidates;  // empty where the choice was not greedy
  agents::RobotView robot_view;
  agents::ExecutionDecision execution;
  std::array<double, 3> robot_rewards{};  // predicted, by Execution; NaN without a network
};

struct MissionTask {
  const world::Scene& scene;
  const Config& config;
  const perception::PixelTier* pixels = nullptr;  // where perception.tier is pixels
  std::uint64_t seed = 0;
  std::uint32_t scenario = 0;
  int mission = 0;                          // its number within its arm, for the decay of epsilon (R20)
  agents::Networks networks = {};           // where the strategy asks any
  int network_seed = -1;                    // which of the arm's training seeds these are, for the record
  const std::atomic<bool>* stop = nullptr;  // checked between timesteps; set: Interrupted is thrown
  DecisionProbe* probe = nullptr;
  robot::TraceSink* trace = nullptr;  // receives the flown path; for replays
};

// What stage 2 needs to know once the robot has arrived.
struct Arrival {
  Conditions conditions;
  double rc_distance_m = 0.0;
  radio::Link link;
};

// A mission that is flown timestep by timestep, two stages each:
//
//   ControllerView() -> the RC decides -> Execute(motion), or Complete()
//   OnboardView() -> the robot decides -> Detect(execution)
//
// until Ended(); then Record(). Calls in another order are an InternalError. Scene, configuration and what else the task
// points to must outlive it. Threads: one mission, one thread; missions are independent of each other.
class Mission {
 public:
  explicit Mission(const MissionTask& task);

  agents::AgentContext Agents() const;           // what its agents are made from
  std::uint32_t Timestep() const { return k_; }  // the one that is decided next, or goes on
  bool Ended() const { return outcome_.has_value(); }
  std::optional<Outcome> Result() const { return outcome_; }  // none until it has ended

  agents::RcView ControllerView() const;
  void Execute(const agents::MotionDecision& motion);  // flies it: Bullet, LiDAR veto
  void Complete();                                     // in place of Execute: the RC ends the mission

  agents::RobotView OnboardView() const;
  void Detect(const agents::ExecutionDecision&
                  execution);  // senses, detects, bills; ends it where the battery cannot pay

  // What the timestep that Detect ended came to. One that the battery could not pay is not part of the record.
  const TimestepRecord& LastStep() const { return last_; }

  // To be called once, when it has ended: the mission with everything summed and its ledger proven.
  MissionRecord Record();

 private:
  enum class Stage { kMotion, kExecution };

  void Sense(agents::Execution execution);
  robot::StepTime TimeOf(agents::Execution execution) const;
  robot::MovementPower PowerOfMove() const;
  robot::DeviceEnergy DevicesOf(agents::Execution execution) const;
  robot::ComputationCost OnboardCost(agents::Execution execution) const;
  Outcome OutcomeOfCompletion() const;

  const MissionTask task_;
  const Config& config_;
  const Scenario scenario_;
  const Eigen::Vector3d antenna_m_;
  const robot::MovementPower power_;  // a horizontal leg's in wind apart
  robot::Flight flight_;
  const std::unique_ptr<perception::Sensor> sensor_;
  double battery_j_;  // beta_k
  double distance_m_ = 0.0;
  std::vector<TimestepRecord> steps_;
  std::vector<double> horizontal_w_;  // of each of them, where wind is billed
  std::optional<Outcome> outcome_;

  // Of the timestep that is under way.
  std::uint32_t k_ = 1;
  Stage stage_ = Stage::kMotion;
  std::uint32_t view_begin_ = 1;  // the timestep in which the robot came to where it is
  agents::MotionDecision motion_;
  robot::FlownMove move_;
  Arrival arrival_;
  TimestepRecord last_;
};

// Throws BrokenInvariant (invariants.h), InternalError for any other defect, UserError when the configuration does not fit
// the world, Interrupted.
// Threads: tasks may share scene and config.
MissionRecord FlyMission(const MissionTask& task);

}  // namespace ed3r::mission
