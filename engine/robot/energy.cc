#include "engine/robot/energy.h"

#include <fmt/format.h>

#include <cmath>

#include "engine/robot/power/power_models.h"

namespace ed3r::robot {
namespace {

MovementPower PaperModel(const Rotorcraft& craft, const Air& air, const RobotConfig& robot,
                         const EnergyConfig& energy) {
  const PaperParameters<> parameters{energy.paper_efficiency, robot.drag_horizontal, robot.drag_vertical};
  const PaperPower<> power = PaperPowersW(parameters, craft, air, robot.speed_mps, robot.speed_mps,
                                          energy.hover_form, energy.vertical_form);
  return {power.hover_w, power.horizontal_w, power.ascent_w, power.descent_w};
}

MovementPower MomentumModel(const Rotorcraft& craft, const Air& air, double speed_mps,
                            const EnergyConfig& energy, const Eigen::Vector2d& wind_mps,
                            const Eigen::Vector2d& course) {
  const MomentumParameters<> parameters{energy.momentum_efficiency, energy.induced_factor,
                                        energy.interference, energy.profile_share, energy.drag_area_m2};
  const auto power_w = [&](double horizontal_mps, double climb_mps) {
    return MomentumPowerW(parameters, craft.mass_kg, horizontal_mps, climb_mps, air, craft.DiscAreaM2());
  };
  const double drift_mps = wind_mps.norm();
  const double across_mps =
      course.isZero() ? std::hypot(speed_mps, drift_mps) : (speed_mps * course - wind_mps).norm();
  return {power_w(drift_mps, 0.0), power_w(across_mps, 0.0), power_w(drift_mps, speed_mps),
          power_w(drift_mps, -speed_mps)};
}

double DescentW(const Config& config, double speed_mps) {
  RobotConfig robot = config.robot;
  robot.speed_mps = speed_mps;
  return MovementPowerOf(robot, config.environment, config.energy).descent_w;
}

}  // namespace

MovementPower MovementPowerOf(const RobotConfig& robot, const EnvironmentConfig& environment,
                              const EnergyConfig& energy, const Eigen::Vector2d& course) {
  const Rotorcraft craft = MakeRotorcraft(robot);
  const Air air{environment.air_density_kgm3, environment.gravity_mps2};
  if (energy.model == PowerModel::kMomentum)
    return MomentumModel(craft, air, robot.speed_mps, energy,
                         {environment.wind_x_mps, environment.wind_y_mps}, course);
  return PaperModel(craft, air, robot, energy);
}

bool BillsWind(const EnvironmentConfig& environment, const EnergyConfig& energy) {
  return energy.model == PowerModel::kMomentum &&
         (environment.wind_x_mps != 0.0 || environment.wind_y_mps != 0.0);
}

std::string CheckBilledPower(const Config& config) {
  const double speed_mps = config.robot.speed_mps;
  const double power_w = DescentW(config, speed_mps);
  if (power_w >= 0.0) return "";
  double allowed_mps = 0.0;
  for (double above_mps = speed_mps; above_mps - allowed_mps > 1e-3;) {
    const double middle_mps = 0.5 * (allowed_mps + above_mps);
    (DescentW(config, middle_mps) >= 0.0 ? allowed_mps : above_mps) = middle_mps;
  }
  return fmt::format(
      "robot.speed_mps: '{:g}' is not allowed; a descent would charge the battery ({:.1f} W with "
      "energy.vertical_form = "
      "{}): at most {:.2f} m/s, or energy.vertical_form climb, or energy.model momentum",
      speed_mps, power_w, NameOf(config.energy.vertical_form), std::floor(100.0 * allowed_mps) / 100.0);
}

double SensingEnergyJ(const SensingConfig& sensing) { return sensing.PowerW() * sensing.period_s; }  // Eq. 3

ComputationCost Computation(const CpuConfig& cpu, const SensingConfig& sensing, double gflop_per_frame,
                            double frequency_hz) {
  const double flop = sensing.Frames() * gflop_per_frame * 1e9;  // N(I_s, s) alpha_l, Eq. 7
  ComputationCost cost;
  cost.time_s = flop / (cpu.flops_per_cycle * cpu.cores * frequency_hz);                       // Eq. 5
  cost.energy_j = cpu.capacitance * flop * frequency_hz * frequency_hz / cpu.flops_per_cycle;  // Eq. 6
  return cost;
}

double PayloadByte(const SensingConfig& sensing) { return sensing.Frames() * sensing.frame_byte; }

}  // namespace ed3r::robot
