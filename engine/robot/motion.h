// The language of motion between RC, robot and ledger (paper: motion command P_k; Eq. 2; R4, R14, R35).
#pragma once

#include <Eigen/Core>

namespace ed3r::robot {

// yaw: 0 = east, counter-clockwise. tilt: camera below the horizon, 0 = level, pi/2 = straight down.
struct Pose {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  double yaw_rad = 0.0;
  double tilt_rad = 0.0;
};

// The RC's action {dx, dy, dz, dyaw, tilt}: displacements in world axes, a turn, and the camera tilt to hold.
struct MotionCommand {
  Eigen::Vector3d displacement_m = Eigen::Vector3d::Zero();
  double turn_rad = 0.0;
  double tilt_rad = 0.0;
  bool hover = false;  // stay: displacement and turn are zero, the tilt is held
};

// What flying a command took (Eq. 2): seconds by movement type, as flown.
struct FlownMove {
  Pose end;
  double horizontal_s = 0.0;
  double ascent_s = 0.0;
  double descent_s = 0.0;
  double hovering_s = 0.0;  // turning beyond the legs' own time (R35)
  double distance_m = 0.0;  // length of the path flown
  Eigen::Vector2d course =
      Eigen::Vector2d::Zero();  // unit vector of the horizontal leg; zero where there was none
  bool halted = false;          // the 2 m safety rule cut a leg short
  int contact_steps = 0;        // physics steps with contact; 0 in normal operation
};

}  // namespace ed3r::robot
