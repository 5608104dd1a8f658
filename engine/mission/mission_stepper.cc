#include "engine/mission/mission_stepper.h"

#include "engine/core/check.h"

namespace ed3r::mission {

MissionStepper::MissionStepper(const MissionTask& task)
    : mission_(task), controller_(mission_.Agents()), max_timesteps_(task.config.mission.max_timesteps) {
  ED3R_CHECK(mission_.Agents().strategy.outside, "the strategy decides itself");
  Observe();
}

bool MissionStepper::AtLimit() const {
  return !Ended() && static_cast<std::int64_t>(Timestep()) > max_timesteps_;
}

void MissionStepper::Observe() {
  rc_view_ = mission_.ControllerView();
  order_ = controller_.Observe(rc_view_, mission_.Timestep());
  if (order_.complete) mission_.Complete();
}

void MissionStepper::Move(const robot::MotionCommand& command) {
  mission_.Execute(controller_.Take(rc_view_, command));
  robot_view_ = mission_.OnboardView();
}

void MissionStepper::Detect(agents::Execution execution) {
  mission_.Detect({.execution = execution, .by = agents::DecidedBy::kStrategy});
  if (!Ended()) Observe();
}

}  // namespace ed3r::mission
