#include "engine/robot/airframe.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "engine/robot/rotors.h"

namespace ed3r::robot {
namespace {

constexpr double kThrustToWeight = 2.0;
// Small propellers: torque / thrust = C_Q D / C_T, about 0.07 diameters.
constexpr double kTorquePerRadius = 0.15;

// Shares that steady flight may use; the rest is left to control.
constexpr double kThrustShare = 0.85;    // of the largest thrust, in a horizontal leg
constexpr double kClimbShare = 0.90;     // of the largest thrust, in a vertical leg
constexpr double kFreeFallShare = 0.65;  // of gravity: without thrust there is no control
constexpr double kWindShare = 1.2;  // lift per sideways force of the wind, at least: tilt up to 40 degrees
constexpr double kDragShare = 0.5;  // of the sideways force, spent on drag at cruise
constexpr double kVerticalDragShare = 0.3;  // of the weight
constexpr double kYawShare = 0.5;           // of the reaction torque at hover thrust

// Time in which the acceleration of a leg builds up, and over which that is smoothed: in time constants of
// the loop that must follow, the tilt or the thrust.
constexpr double kTiltTime = 1.2;
constexpr double kThrustTime = 4.0;
constexpr double kTiltingWind =
    0.25;  // sideways force per weight from which a vertical leg is as slow to tilt

constexpr double kLeastCruiseMps = 0.5;  // lower bound of robot.speed_mps
// Below this the loops are so slow that the robot wanders: tall bodies on short arms, weak gravity.
constexpr double kLeastRateRadps = 5.0;
// What a halt may overshoot.
constexpr double kHaltReserveM = 0.05;
// Free distance beyond the stand-off that the LiDARs must be able to see, for a robot that moves at all.
constexpr double kLeastSightM = 2.0;

// Sideways force that is left when the weight is carried.
double SidewaysN(const Airframe& airframe) {
  const double thrust_n = kThrustShare * airframe.ThrustMaxN();
  return std::sqrt(thrust_n * thrust_n - airframe.WeightN() * airframe.WeightN());
}

// Fastest air speed at which drag uses no more than a force.
double AirSpeedMps(double force_n, double drag_kgpm) {
  return drag_kgpm > 0.0 ? std::sqrt(force_n / drag_kgpm) : 1e3;
}

double WindMps(const EnvironmentConfig& environment) {
  return std::hypot(environment.wind_x_mps, environment.wind_y_mps) + environment.gust_mps;
}

// Speed from which the robot can brake within what its LiDARs see; negative when they see too little to move.
double SightSpeedMps(const MotionLimits& limits, double stand_off_m, const SensingConfig& sensing) {
  const double room_m = sensing.lidar_range_m - stand_off_m;
  if (room_m <= 0.0) return -1.0;
  // Braking that begins before cruise is reached: v^2 / (2 a) + 3/2 v a / j; the robot sees from half
  // the smoothing behind, and in between two scans it goes on unseeing.
  const double a = limits.acceleration_mps2;
  const double delay_s = 1.5 * a / limits.jerk_mps3 + 0.5 * limits.smoothing_s + 2.0 / sensing.lidar_rate_hz;
  return a * (std::sqrt(delay_s * delay_s + 2.0 * room_m / a) - delay_s);
}

double YawAcceleration(const Airframe& airframe) {
  return kYawShare * airframe.WeightN() * airframe.rotor_torque_m / airframe.inertia_kgm2.z();
}

void SetSmoothing(MotionLimits& limits, double smoothing_s) {
  limits.smoothing_s = smoothing_s;
  limits.jerk_mps3 = limits.acceleration_mps2 / smoothing_s;
}

void KeepInSight(MotionLimits& limits, double stand_off_m, const Config& config) {
  if (!config.agents.obstacle_avoidance) return;
  const double sight_mps = SightSpeedMps(limits, stand_off_m, config.sensing);
  limits.speed_mps = std::min(limits.speed_mps, std::max(sight_mps, kLeastCruiseMps));
}

MotionLimits HorizontalLimits(const Airframe& airframe, const Config& config) {
  const double sideways_n = SidewaysN(airframe);
  const double cruise_mps =
      AirSpeedMps(kDragShare * sideways_n, airframe.drag_horizontal_kgpm) - WindMps(config.environment);
  MotionLimits limits;
  limits.speed_mps = std::min(config.robot.speed_mps, std::max(cruise_mps, kLeastCruiseMps));
  limits.acceleration_mps2 =
      std::min(config.robot.acceleration_mps2, (1.0 - kDragShare) * sideways_n / airframe.mass_kg);
  SetSmoothing(limits, kTiltTime / BandwidthsOf(airframe).attitude_radps);
  KeepInSight(limits, HorizontalStandOffM(config.robot), config);
  return limits;
}

MotionLimits VerticalLimits(const Airframe& airframe, const Config& config) {
  const double weight_n = airframe.WeightN();
  const double wind_mps = WindMps(config.environment);
  const double wind_n = airframe.drag_horizontal_kgpm * wind_mps * wind_mps;
  MotionLimits limits;
  limits.speed_mps = std::min(config.robot.speed_mps,
                              AirSpeedMps(kVerticalDragShare * weight_n, airframe.drag_vertical_kgpm));
  const double drag_n = airframe.drag_vertical_kgpm * limits.speed_mps * limits.speed_mps;
  const double thrust_n = kClimbShare * airframe.ThrustMaxN();
  const double lift_n = std::sqrt(thrust_n * thrust_n - wind_n * wind_n);
  limits.acceleration_mps2 = std::min({config.robot.acceleration_mps2, kFreeFallShare * airframe.gravity_mps2,
                                       (lift_n - weight_n - drag_n) / airframe.mass_kg,
                                       (weight_n - kWindShare * wind_n) / airframe.mass_kg});
  // In wind the tilt must change with the lift.
  const double tilt_share = std::min(1.0, wind_n / (kTiltingWind * weight_n));
  SetSmoothing(limits,
               kThrustTime * kRotorLagS + tilt_share * kTiltTime / BandwidthsOf(airframe).attitude_radps);
  KeepInSight(limits, VerticalStandOffM(config.robot), config);
  return limits;
}

}  // namespace

Airframe::Airframe(const Config& config)
    : mass_kg(config.robot.mass_kg),
      gravity_mps2(config.environment.gravity_mps2),
      size_m(config.robot.depth_m, config.robot.width_m, config.robot.height_m) {
  const Eigen::Vector3d square = size_m.cwiseProduct(size_m);
  inertia_kgm2 = mass_kg / 12.0 * (Eigen::Vector3d::Constant(square.sum()) - square);

  // Neighbouring propellers must not overlap, whatever the body's size.
  const double least_arm_m = 1.05 * config.robot.propeller_radius_m;
  const double x_m = std::max(0.5 * size_m.x(), least_arm_m);
  const double y_m = std::max(0.5 * size_m.y(), least_arm_m);
  rotor_m = {Eigen::Vector2d(x_m, y_m), Eigen::Vector2d(-x_m, y_m), Eigen::Vector2d(-x_m, -y_m),
             Eigen::Vector2d(x_m, -y_m)};
  spin = {1.0, -1.0, 1.0, -1.0};
  rotor_torque_m = kTorquePerRadius * config.robot.propeller_radius_m;
  rotor_thrust_max_n = kThrustToWeight * WeightN() / kRotors;

  const double half_density = 0.5 * config.environment.air_density_kgm3;
  drag_horizontal_kgpm = half_density * config.robot.drag_horizontal * config.robot.FrontAreaM2();
  drag_vertical_kgpm = half_density * config.robot.drag_vertical * config.robot.TopAreaM2();
}

Eigen::Vector3d Airframe::DragN(const Eigen::Vector3d& v) const {
  const double horizontal = drag_horizontal_kgpm * std::sqrt(v.x() * v.x() + v.y() * v.y());
  return {-horizontal * v.x(), -horizontal * v.y(), -drag_vertical_kgpm * std::abs(v.z()) * v.z()};
}

Bandwidths BandwidthsOf(const Airframe& airframe) {
  // Rate loop: damping 0.7 behind the rotors' first-order lag would be 1 / (2 lag); 0.4 leaves room for the
  // sampling. A weak airframe is slower: an attitude error of 0.3 rad may use half of the angular
  // acceleration.
  const double lateral = airframe.rotor_m[0].minCoeff() * airframe.WeightN() /
                         std::max(airframe.inertia_kgm2.x(), airframe.inertia_kgm2.y());
  Bandwidths b;
  b.rate_radps = std::min(0.4 / kRotorLagS, std::sqrt(4.0 * lateral));
  b.attitude_radps = 0.4 * b.rate_radps;
  b.velocity_radps = 0.6 * b.attitude_radps;
  b.position_radps = 0.45 * b.velocity_radps;
  b.integral_radps = 0.3 * b.velocity_radps;
  b.yaw_rate_radps = std::min(b.rate_radps, std::sqrt(8.0 * YawAcceleration(airframe)));
  b.yaw_radps = 0.4 * b.yaw_rate_radps;
  return b;
}

FlightEnvelope EnvelopeOf(const Airframe& airframe, const Config& config) {
  FlightEnvelope envelope;
  envelope.tilt_max_rad = std::atan2(SidewaysN(airframe), airframe.WeightN());
  envelope.horizontal = HorizontalLimits(airframe, config);
  envelope.vertical = VerticalLimits(airframe, config);
  envelope.yaw.speed_mps = config.robot.yaw_rate_degps * std::numbers::pi / 180.0;
  envelope.yaw.acceleration_mps2 = YawAcceleration(airframe);
  SetSmoothing(envelope.yaw, kThrustTime * kRotorLagS);
  return envelope;
}

double HorizontalStandOffM(const RobotConfig& robot) {
  return robot.safety_distance_m + 0.5 * std::hypot(robot.width_m, robot.depth_m) + kHaltReserveM;
}

double VerticalStandOffM(const RobotConfig& robot) {
  return robot.safety_distance_m + 0.5 * robot.height_m + kHaltReserveM;
}

namespace {

// A leg is billed at robot.speed_mps: an airframe that must fly slower would be billed for another flight.
std::string CheckSpeed(const Airframe& airframe, const Config& config) {
  Config unseeing = config;
  unseeing.agents.obstacle_avoidance = false;
  const FlightEnvelope envelope = EnvelopeOf(airframe, config), by_force = EnvelopeOf(airframe, unseeing);
  for (const auto& [flown, forced, way] :
       {std::tuple(&envelope.horizontal, &by_force.horizontal, "across"),
        std::tuple(&envelope.vertical, &by_force.vertical, "up and down")}) {
    if (flown->speed_mps >= config.robot.speed_mps) continue;
    return fmt::format("robot.speed_mps: '{:g}' is not allowed; {} the robot flies at most {:.2f} m/s {}",
                       config.robot.speed_mps, way, std::floor(100.0 * flown->speed_mps) / 100.0,
                       flown->speed_mps < forced->speed_mps
                           ? "to brake within sensing.lidar_range_m and robot.safety_distance_m"
                           : "against its drag (robot.drag_horizontal, drag_vertical) and the wind");
  }
  return "";
}

}  // namespace

std::string CheckFlyable(const Config& config) {
  const Airframe airframe(config);
  const RobotConfig& robot = config.robot;
  const double rate_radps = BandwidthsOf(airframe).rate_radps;
  if (rate_radps < kLeastRateRadps)
    return fmt::format(
        "robot.height_m: '{:g}' is not allowed; with robot.width_m = {:g} and robot.depth_m = {:g} the "
        "rotors "
        "turn the body too slowly to fly",
        robot.height_m, robot.width_m, robot.depth_m);
  const double wind_mps = WindMps(config.environment);
  const double most_mps =
      AirSpeedMps(kDragShare * SidewaysN(airframe), airframe.drag_horizontal_kgpm) - kLeastCruiseMps;
  if (wind_mps > most_mps)
    return fmt::format(
        "environment.wind_x_mps: '{:g}' is not allowed; with robot.mass_kg = {:g} and its drag the robot "
        "holds "
        "its place in at most {:.1f} m/s, wind and gust together, not {:.1f}",
        config.environment.wind_x_mps, robot.mass_kg, std::max(0.0, most_mps), wind_mps);
  const double least_range_m = std::max(HorizontalStandOffM(robot), VerticalStandOffM(robot)) + kLeastSightM;
  if (config.agents.obstacle_avoidance && config.sensing.lidar_range_m < least_range_m)
    return fmt::format(
        "sensing.lidar_range_m: '{:g}' is not allowed; with robot.safety_distance_m = {:g} and the robot's "
        "size at least {:.1f} m",
        config.sensing.lidar_range_m, robot.safety_distance_m, least_range_m);
  return CheckSpeed(airframe, config);
}

}  // namespace ed3r::robot
