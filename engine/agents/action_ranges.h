// The RC's action ranges A_RC,k and how the Algorithm shrinks and widens them (R14, R21).
#pragma once

#include "engine/config/agents.h"
#include "engine/core/random.h"
#include "engine/robot/motion.h"

namespace ed3r::agents {

struct ActionRanges {
  double axis_m = 0.0;    // each displacement lies in [-axis_m, axis_m]
  double yaw_rad = 0.0;   // the turn lies in [-yaw_rad, yaw_rad]
  double tilt_rad = 0.0;  // width of the tilt interval

  static ActionRanges Full(const AgentsConfig& agents);
  ActionRanges Decreased(const AgentsConfig& agents) const;  // line 9
  ActionRanges Increased(const AgentsConfig& agents) const;  // line 11; never beyond Full
};

// Interval of tilt commands: all of [0, tilt range] when the width is full, else centred on the present tilt
// and cut to that interval.
struct TiltInterval {
  double low_rad = 0.0, high_rad = 0.0;
};
TiltInterval TiltCommands(const ActionRanges& ranges, const AgentsConfig& agents, double tilt_rad);

// A command drawn uniformly from the ranges. Takes exactly five draws.
robot::MotionCommand DrawCommand(const ActionRanges& ranges, const AgentsConfig& agents, double tilt_rad,
                                 Stream& stream);

// The command cut to the ranges, value by value. Throws UserError for one that is not finite.
robot::MotionCommand Clamped(const robot::MotionCommand& command, const ActionRanges& ranges,
                             const AgentsConfig& agents, double tilt_rad);

}  // namespace ed3r::agents
