// Cascaded flight control: position -> velocity -> attitude -> body rate, at every physics step.
//
//   v_d = v_r + k_p (p_r - p)                 a_d = a_r + k_v (v_d - v) + k_v k_i integral of (v_d - v)
//   F   = m (a_d + g z) - drag at v_r         thrust: F along body z; attitude: body z along F, heading to
//   yaw_r w_d = turn of F + k_a (attitude error)    torque = J (turn-up of F + k_w (w_d - w)) + w x J w
//
// The drag is that in the wind of the last hover; gusts since are left to the feedback. The reference's jerk
// and snap and the derivative of the feedback say how fast F turns and how that changes (differential
// flatness), so that the attitude follows without lag; the acceleration is measured, as by an accelerometer.
// Gains: BandwidthsOf(). Threads: one object per mission.
#pragma once

#include <Eigen/Core>

#include "engine/robot/airframe.h"
#include "engine/robot/rotors.h"
#include "engine/world/flight_world.h"

namespace ed3r::robot {

struct FlightReference {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_mps = Eigen::Vector3d::Zero();
  Eigen::Vector3d acceleration_mps2 = Eigen::Vector3d::Zero();
  Eigen::Vector3d jerk_mps3 = Eigen::Vector3d::Zero();
  Eigen::Vector3d snap_mps4 = Eigen::Vector3d::Zero();  // kRotorLagS ahead: torques arrive that late
  double yaw_rad = 0.0;
  double yaw_rate_radps = 0.0;
  double yaw_acceleration_radps2 = 0.0;
};

class FlightController {
 public:
  // step_s: of physics.
  FlightController(const Airframe& airframe, double tilt_max_rad, double step_s);

  // Starts from a hover in a wind, world axes: a robot that has hovered for a while has found out how hard
  // the wind pushes it. Returns the attitude and the wrench of that hover.
  struct Hover {
    Eigen::Quaterniond attitude;
    Wrench wrench;
  };
  Hover StartHover(const Eigen::Vector3d& wind_mps, double yaw_rad);

  // The wrench to ask of the rotors for the next physics step.
  Wrench Step(const world::RigidBodyState& state, const FlightReference& reference);

 private:
  struct Force {
    Eigen::Vector3d newton;
    Eigen::Vector3d jerk_mps3;  // its derivative, per mass
    double per_newton = 0.0;    // mass over its size
  };
  Force WantedForce(const world::RigidBodyState& state, const FlightReference& reference);
  Eigen::Vector3d WantedRate(const Eigen::Quaterniond& attitude, const Force& force,
                             const FlightReference& reference);
  const Eigen::Quaterniond& Heading(double yaw_rad);
  Eigen::Vector3d LimitForceN(const Eigen::Vector3d& force_n) const;

  const Airframe& airframe_;
  const Bandwidths gain_;
  double tilt_max_tan_;
  double step_s_;
  Eigen::Vector3d wind_mps_ = Eigen::Vector3d::Zero();  // as at the last hover
  Eigen::Vector3d last_velocity_mps_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d integral_mps2_ = Eigen::Vector3d::Zero();
  // The heading asked for last: most steps ask for the same.
  double yaw_rad_ = 0.0;
  Eigen::Quaterniond heading_ = Eigen::Quaterniond::Identity();
};

// Level attitude of a heading, then tilted the short way until body z points along a direction (not straight
// down). Tilting in a straight line then takes no turn about body z, which rotors are weak at.
Eigen::Quaterniond AttitudeAlong(const Eigen::Vector3d& up, double yaw_rad);

// Heading of such an attitude.
double YawOf(const Eigen::Quaterniond& attitude);

}  // namespace ed3r::robot
