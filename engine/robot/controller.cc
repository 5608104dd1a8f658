#include "engine/robot/controller.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace ed3r::robot {
namespace {

// Shares of the weight. Without thrust the rotors cannot turn the robot either, so the wanted lift never
// falls below the first; at less force than the second, its direction is no longer followed ever faster.
constexpr double kLeastLift = 0.3;
constexpr double kLeastTurningForce = 0.5;
constexpr double kMostThrust = 0.95;  // of the largest thrust
// Fastest wanted turns, in bandwidths: what the rotors can also stop. Beyond, saturated torques and lag make
// the attitude swing for ever once a gust or a contact has thrown it far off.
constexpr double kMostTurn = 0.6;    // with the force, attitude bandwidths
constexpr double kMostSwing = 0.15;  // from an attitude error, rate bandwidths

Eigen::Vector3d Clamp(const Eigen::Vector3d& v, double limit) { return v.cwiseMax(-limit).cwiseMin(limit); }

// From level to body z along a direction, the short way.
Eigen::Quaterniond TiltAlong(const Eigen::Vector3d& up) {
  const Eigen::Vector3d z = up.normalized();
  return Eigen::Quaterniond(1.0 + z.z(), -z.y(), z.x(), 0.0).normalized();
}

Eigen::Quaterniond LevelAt(double yaw_rad) {
  return Eigen::Quaterniond(std::cos(0.5 * yaw_rad), 0.0, 0.0, std::sin(0.5 * yaw_rad));
}

}  // namespace

Eigen::Quaterniond AttitudeAlong(const Eigen::Vector3d& up, double yaw_rad) {
  return TiltAlong(up) * LevelAt(yaw_rad);
}

double YawOf(const Eigen::Quaterniond& q) {
  return std::remainder(2.0 * std::atan2(q.z(), q.w()), 2.0 * std::numbers::pi);
}

FlightController::FlightController(const Airframe& airframe, double tilt_max_rad, double step_s)
    : airframe_(airframe),
      gain_(BandwidthsOf(airframe)),
      tilt_max_tan_(std::tan(tilt_max_rad)),
      step_s_(step_s) {}

FlightController::Hover FlightController::StartHover(const Eigen::Vector3d& wind_mps, double yaw_rad) {
  wind_mps_ = wind_mps;
  integral_mps2_.setZero();
  last_velocity_mps_.setZero();
  const Eigen::Vector3d force_n =
      LimitForceN(airframe_.WeightN() * Eigen::Vector3d::UnitZ() - airframe_.DragN(-wind_mps));
  return {AttitudeAlong(force_n, yaw_rad), {force_n.norm(), Eigen::Vector3d::Zero()}};
}

Eigen::Vector3d FlightController::LimitForceN(const Eigen::Vector3d& force_n) const {
  const double thrust_n = kMostThrust * airframe_.ThrustMaxN();
  const double sideways_n = std::hypot(force_n.x(), force_n.y());
  // Sideways before downwards: a descent waits rather than tilt the robot too far. Upwards before sideways.
  const double least_n =
      std::max(kLeastLift * airframe_.WeightN(), std::min(sideways_n / tilt_max_tan_, airframe_.WeightN()));
  const double lift_n = std::clamp(force_n.z(), least_n, thrust_n);
  const double most_n = std::min(std::sqrt(thrust_n * thrust_n - lift_n * lift_n), tilt_max_tan_ * lift_n);
  const double share = sideways_n > most_n ? most_n / sideways_n : 1.0;
  return {share * force_n.x(), share * force_n.y(), lift_n};
}

FlightController::Force FlightController::WantedForce(const world::RigidBodyState& state,
                                                      const FlightReference& r) {
  const Eigen::Vector3d speed_wanted =
      r.velocity_mps + gain_.position_radps * (r.position_m - state.position_m);
  const Eigen::Vector3d speed_error = speed_wanted - state.velocity_mps;
  const Eigen::Vector3d integral_rate = gain_.velocity_radps * gain_.integral_radps * speed_error;
  Eigen::Vector3d acceleration = r.acceleration_mps2 + gain_.velocity_radps * speed_error + integral_mps2_;
  acceleration.z() += airframe_.gravity_mps2;
  const Eigen::Vector3d asked_n =
      airframe_.mass_kg * acceleration - airframe_.DragN(r.velocity_mps - wind_mps_);
  const Eigen::Vector3d force_n = LimitForceN(asked_n);
  // The integral learns nothing from an error that the rotors cannot mend.
  if (force_n == asked_n) integral_mps2_ += step_s_ * integral_rate;

  const Eigen::Vector3d measured = (state.velocity_mps - last_velocity_mps_) / step_s_;
  last_velocity_mps_ = state.velocity_mps;
  const Eigen::Vector3d speed_error_rate =
      r.acceleration_mps2 - measured + gain_.position_radps * (r.velocity_mps - state.velocity_mps);
  return {force_n, r.jerk_mps3 + gain_.velocity_radps * speed_error_rate + integral_rate,
          airframe_.mass_kg / std::max(force_n.norm(), kLeastTurningForce * airframe_.WeightN())};
}

const Eigen::Quaterniond& FlightController::Heading(double yaw_rad) {
  if (yaw_rad != yaw_rad_) {
    yaw_rad_ = yaw_rad;
    heading_ = LevelAt(yaw_rad);
  }
  return heading_;
}

Eigen::Vector3d FlightController::WantedRate(const Eigen::Quaterniond& attitude, const Force& force,
                                             const FlightReference& r) {
  // Error as a rotation vector in body axes (small-angle form of the quaternion error).
  Eigen::Quaterniond error = attitude.conjugate() * (TiltAlong(force.newton) * Heading(r.yaw_rad));
  if (error.w() < 0.0) error.coeffs() = -error.coeffs();
  const Eigen::Vector3d angle = 2.0 * error.vec();
  const Eigen::Vector3d swing = Clamp(gain_.attitude_radps * angle, kMostSwing * gain_.rate_radps);
  const Eigen::Vector3d turn =
      Clamp(force.per_newton * (attitude.conjugate() * force.jerk_mps3), kMostTurn * gain_.attitude_radps);
  const double upright = (attitude * Eigen::Vector3d::UnitZ()).z();
  return {swing.x() - turn.y(), swing.y() + turn.x(),
          gain_.yaw_radps * angle.z() + upright * r.yaw_rate_radps};
}

Wrench FlightController::Step(const world::RigidBodyState& state, const FlightReference& r) {
  const Force force = WantedForce(state, r);
  Wrench wrench;
  // The thrust arrives kRotorLagS late: ask for what will be wanted then.
  const Eigen::Vector3d soon_n = force.newton + kRotorLagS * airframe_.mass_kg * r.jerk_mps3;
  wrench.thrust_n = std::max(soon_n.dot(state.attitude * Eigen::Vector3d::UnitZ()), 0.0);

  const Eigen::Vector3d turn_up = force.per_newton * (state.attitude.conjugate() * r.snap_mps4);
  const Eigen::Vector3d rate_error = WantedRate(state.attitude, force, r) - state.rate_radps;
  const Eigen::Vector3d gain(gain_.rate_radps, gain_.rate_radps, gain_.yaw_rate_radps);
  const Eigen::Vector3d spin_up =
      gain.cwiseProduct(rate_error) + Eigen::Vector3d(-turn_up.y(), turn_up.x(), r.yaw_acceleration_radps2);
  const Eigen::Vector3d momentum = airframe_.inertia_kgm2.cwiseProduct(state.rate_radps);
  wrench.torque_nm = airframe_.inertia_kgm2.cwiseProduct(spin_up) + state.rate_radps.cross(momentum);
  return wrench;
}

}  // namespace ed3r::robot
