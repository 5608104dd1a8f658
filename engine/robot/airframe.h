// What flies: mass, inertia, rotors and drag of the robot, and what that body can be asked to do.
//
// Everything is derived from the parameters, so that a 0.5 kg and a 15 kg airframe fly with the same code.
// The rotors stand at the corners of the body as an X-quad; robot.propellers enters the hover power (R1)
// only, each corner stands for propellers / 4 of them. Thrust-to-weight is 2; inertia is that of a
// homogeneous box. Body axes: x forward (depth), y left (width), z up. A value: share it read-only.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>

#include "engine/config/config.h"

namespace ed3r::robot {

inline constexpr int kRotors = 4;

struct Airframe {
  double mass_kg = 0.0;
  double gravity_mps2 = 0.0;
  Eigen::Vector3d size_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d inertia_kgm2 = Eigen::Vector3d::Zero();
  std::array<Eigen::Vector2d, kRotors> rotor_m;  // positions in the body's x-y plane
  std::array<double, kRotors> spin = {};         // +1 or -1: sign of the reaction torque about z
  double rotor_torque_m = 0.0;                   // reaction torque per thrust
  double rotor_thrust_max_n = 0.0;
  double drag_horizontal_kgpm = 0.0;  // 0.5 rho C A: force = this x speed^2 (R2, R3)
  double drag_vertical_kgpm = 0.0;

  explicit Airframe(const Config& config);

  double WeightN() const { return mass_kg * gravity_mps2; }
  double ThrustMaxN() const { return kRotors * rotor_thrust_max_n; }

  // Radius of the sphere that holds the body in any attitude.
  double BoundingRadiusM() const { return 0.5 * size_m.norm(); }

  // Drag on the body at a velocity relative to the air, world axes. Horizontal and vertical drag are
  // separate, as in the paper's power model.
  Eigen::Vector3d DragN(const Eigen::Vector3d& air_velocity_mps) const;
};

// Limits of the reference motion: the parameters, cut to what the rotors can deliver with a reserve for
// control.
struct MotionLimits {
  double speed_mps = 0.0;
  double acceleration_mps2 = 0.0;  // both directions
  double jerk_mps3 = 0.0;
  double smoothing_s = 0.0;  // time over which the jerk is averaged
};

// Bandwidths of the cascade, outermost slowest. They follow from the rotors' lag and the angular acceleration
// that the rotors can produce.
struct Bandwidths {
  double position_radps = 0.0;
  double velocity_radps = 0.0;
  double integral_radps = 0.0;
  double attitude_radps = 0.0;
  double rate_radps = 0.0;
  double yaw_radps = 0.0;
  double yaw_rate_radps = 0.0;
};

Bandwidths BandwidthsOf(const Airframe& airframe);

struct FlightEnvelope {
  MotionLimits horizontal;
  MotionLimits vertical;
  MotionLimits yaw;  // in rad, rad/s, ...
  double tilt_max_rad = 0.0;
};

FlightEnvelope EnvelopeOf(const Airframe& airframe, const Config& config);

// From the robot's centre to the nearest surface ahead when it has halted (R24): the safety distance is that
// of its hull, plus what a halt may overshoot. The hull's reach is that of a level body at any heading.
double HorizontalStandOffM(const RobotConfig& robot);
double VerticalStandOffM(const RobotConfig& robot);

// Whether the airframe can fly, at robot.speed_mps, and hold its place in the configured wind: "" or a clause like CheckParameters'
// ("key: 'value' is not allowed; ...").
[[nodiscard]] std::string CheckFlyable(const Config& config);

}  // namespace ed3r::robot
