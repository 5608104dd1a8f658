// What each agent may know (paper: State of the Environment). The mission fills these; an agent sees nothing
// else.
#pragma once

#include "engine/robot/motion.h"

namespace ed3r::agents {

// S_RC,k: as of the end of timestep k-1; zeros for the previous score and energy at k = 1 (R17).
struct RcView {
  robot::Pose pose;
  double rc_distance_m = 0.0;
  double previous_scs = 0.0;
  double previous_energy_j = 0.0;
};

// S_k: after the move of timestep k.
struct RobotView {
  double yaw_rad = 0.0;
  double tilt_rad = 0.0;
  double battery_ratio = 1.0;  // beta_k / beta_max
  double cpu_ratio = 1.0;      // f_k / f_max
  double rc_distance_m = 0.0;
  double bandwidth_hz = 0.0;
  double rate_bps = 0.0;
  double previous_scs = 0.0;
  double previous_energy_j = 0.0;
  double rate_ratio = 0.0;  // d_k / (b_max se_max), for the rules of RBS (R25)
};

}  // namespace ed3r::agents
