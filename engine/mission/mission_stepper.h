// A mission whose decisions come from outside the engine, in the paper's two stages:
//
//   MissionStepper mission(task);                      // strategy external
//   while (!mission.Ended()) {
//     mission.Move(command of mission.ControllerSees());      // stage 1, at the RC
//     mission.Detect(execution of mission.RobotSees());       // stage 2, on board
//     ... mission.LastStep(): outcome, energy, reward
//   }
//   MissionRecord record = mission.Record();           // as FlyMission's: stored, compared, reported
//
// The RC still follows the Algorithm (agents.early_completion): where it orders to hover, the command is not asked for;
// elsewhere the command is cut to the ranges that it orders; and it ends the mission when the confidence has been reliable
// for long enough. The same commands and executions give the same bits, whatever else flies.
#pragma once

#include "engine/agents/remote_controller.h"
#include "engine/mission/mission.h"

namespace ed3r::mission {

class MissionStepper {
 public:
  // The task must ask for the external strategy and, with what it points to, outlive this.
  explicit MissionStepper(const MissionTask& task);

  // The RC has completed the mission, or the battery could not pay the last timestep.
  bool Ended() const { return mission_.Ended(); }
  std::optional<Outcome> Result() const { return mission_.Result(); }
  // mission.max_timesteps were flown without an end: what FlyMission calls a defect, and a learner a truncation.
  bool AtLimit() const;

  // Stage 1. What the RC sees (S_RC,k) and what the Algorithm orders. After the end: as of the last timestep.
  const agents::RcView& ControllerSees() const { return rc_view_; }
  const agents::CompletionOrder& Order() const { return order_; }
  std::uint32_t Timestep() const { return mission_.Timestep(); }
  // Throws UserError for a command that is not finite; the mission is then as before.
  void Move(const robot::MotionCommand& command);

  // Stage 2, once it has moved.
  const agents::RobotView& RobotSees() const { return robot_view_; }
  void Detect(agents::Execution execution);

  const TimestepRecord& LastStep() const { return mission_.LastStep(); }

  // Once, when it has ended.
  MissionRecord Record() { return mission_.Record(); }

 private:
  void Observe();

  Mission mission_;
  agents::RemoteController controller_;
  std::int64_t max_timesteps_;
  agents::RcView rc_view_;
  agents::CompletionOrder order_;
  agents::RobotView robot_view_;
};

}  // namespace ed3r::mission
