// Closed forms of the energy model: movement powers, sensing, computation (Eqs. 1-7, Appendix; R1-R7).
// Pure functions of their arguments.
#pragma once

#include <Eigen/Core>
#include <string>

#include "engine/config/config.h"
#include "engine/config/energy.h"
#include "engine/config/environment.h"
#include "engine/config/robot.h"

namespace ed3r::robot {

// P_m for each movement type, in watts. Vertical movement is split by direction (the indicator of Eq. P_ver).
struct MovementPower {
  double hover_w = 0.0;
  double horizontal_w = 0.0;
  double ascent_w = 0.0;
  double descent_w = 0.0;
};
// By energy.model: the paper's powers, which are those of still air, or momentum theory at airspeeds (engine/robot/power): what
// the robot flies over ground less the mean wind, so that to hold a place in wind takes the power of flying as fast. Gusts are
// flown and not billed. course: of the horizontal leg over ground, east and north, of length 1; zero: across the wind.
MovementPower MovementPowerOf(const RobotConfig& robot, const EnvironmentConfig& environment,
                              const EnergyConfig& energy,
                              const Eigen::Vector2d& course = Eigen::Vector2d::Zero());

// Whether the power of a horizontal leg depends on its course.
bool BillsWind(const EnvironmentConfig& environment, const EnergyConfig& energy);

// Whether every movement of a mission draws power, as closed forms have it: "" or a clause like CheckParameters'. The paper's
// power of a descent is weight less drag, which ends below nothing where the robot is fast.
[[nodiscard]] std::string CheckBilledPower(const Config& config);

// Eq. 3: all sensors over one sensing period.
double SensingEnergyJ(const SensingConfig& sensing);

// What one detection model costs on board for all frames of a sensing period at CPU frequency f (Eqs. 5, 6).
struct ComputationCost {
  double time_s = 0.0;
  double energy_j = 0.0;
};
ComputationCost Computation(const CpuConfig& cpu, const SensingConfig& sensing, double gflop_per_frame,
                            double frequency_hz);

// Bytes of one offload: all frames of a sensing period (Eq. 8; R6: LiDAR is not sent).
double PayloadByte(const SensingConfig& sensing);

}  // namespace ed3r::robot
