// A baseline that the paper lacks: look level, turn where nothing was seen, go where something was. No network, no draw.
//
// Level, the camera sees as far as the forest lets it. Turns of half a field of view sweep the horizon; after a full
// circle without a sign of fire the robot goes ahead and looks around again.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "engine/agents/context.h"
#include "engine/agents/motion_policy.h"

namespace ed3r::agents {

class LookLevel : public MotionPolicy {
 public:
  explicit LookLevel(const AgentContext& context)
      : eta_int_(context.config.agents.eta_int),
        turn_rad_(0.5 * context.config.sensing.camera_hfov_deg * std::numbers::pi / 180.0) {}

  MotionChoice Choose(const MotionQuestion& question) override {
    MotionChoice choice{.command = {}, .rule = MotionRule::kRule, .epsilon = 0.0};
    const bool seen = question.view.previous_scs >= eta_int_;
    if (seen) turned_rad_ = 0.0;
    if (seen || turned_rad_ >= 2.0 * std::numbers::pi) {
      choice.command.displacement_m = Ahead(question.view.pose.yaw_rad, question.ranges.axis_m);
      if (!seen) turned_rad_ = 0.0;
    } else {
      choice.command.turn_rad = std::min(turn_rad_, question.ranges.yaw_rad);
      turned_rad_ += choice.command.turn_rad;
    }
    return choice;
  }

 private:
  // As far ahead as the ranges of both axes let it.
  static Eigen::Vector3d Ahead(double yaw_rad, double axis_m) {
    const Eigen::Vector3d heading(std::cos(yaw_rad), std::sin(yaw_rad), 0.0);
    return heading * (axis_m / heading.cwiseAbs().maxCoeff());
  }

  const double eta_int_;
  const double turn_rad_;
  double turned_rad_ = 0.0;  // since something was seen or the robot went on
};

}  // namespace ed3r::agents
