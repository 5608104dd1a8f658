#include "engine/robot/energy.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ed3r {
namespace {

double HoverPowerW(const RobotConfig& robot, const EnvironmentConfig& environment, HoverForm form) {
  const double disc_m2 =
      std::numbers::pi * robot.propeller_radius_m * robot.propeller_radius_m;  // A_prop (R1)
  const double g3 = std::pow(environment.gravity_mps2, 3);
  const double mass_term = std::pow(robot.mass_kg, 1.5);
  if (form == HoverForm::kPrinted)
    return mass_term * std::sqrt(g3 / (2.0 * robot.propellers) * environment.air_density_kgm3 * disc_m2);
  return mass_term * std::sqrt(g3 / (2.0 * environment.air_density_kgm3 * robot.propellers * disc_m2));
}

double DragPowerW(double air_density_kgm3, double area_m2, double speed_mps, double coefficient) {
  return 0.5 * air_density_kgm3 * area_m2 * std::pow(speed_mps, 3) * coefficient;
}

}  // namespace

MovementPower PaperMovementPower(const RobotConfig& robot, const EnvironmentConfig& environment,
                                 const EnergyConfig& energy) {
  MovementPower power;
  const double v = robot.speed_mps;
  const double rho = environment.air_density_kgm3;
  power.hover_w = HoverPowerW(robot, environment, energy.hover_form);
  power.horizontal_w = power.hover_w + DragPowerW(rho, robot.FrontAreaM2(), v, robot.drag_horizontal);
  const double drag_w = DragPowerW(rho, robot.TopAreaM2(), v, robot.drag_vertical);
  const double weight_n = robot.mass_kg * environment.gravity_mps2;
  switch (energy.vertical_form) {
    case VerticalForm::kPrinted:  // newtons taken for watts, as printed (R3)
      power.ascent_w = weight_n + drag_w;
      power.descent_w = weight_n - drag_w;
      break;
    case VerticalForm::kClimb:
      power.ascent_w = power.hover_w + weight_n * v;
      power.descent_w = std::max(power.hover_w - weight_n * v, 0.0);  // a descent does not charge the battery
      break;
    case VerticalForm::kMgv:
      power.ascent_w = weight_n * v + drag_w;
      power.descent_w = weight_n * v - drag_w;
      break;
  }
  return power;
}

double SensingEnergyJ(const SensingConfig& sensing) { return sensing.PowerW() * sensing.period_s; }

ComputationCost Computation(const CpuConfig& cpu, const SensingConfig& sensing, double gflop_per_frame,
                            double frequency_hz) {
  const double flop = sensing.Frames() * gflop_per_frame * 1e9;  // N(I_s, s) alpha_l, Eq. 7
  ComputationCost cost;
  cost.time_s = flop / (cpu.flops_per_cycle * cpu.cores * frequency_hz);
  cost.energy_j = cpu.capacitance * flop * frequency_hz * frequency_hz / cpu.flops_per_cycle;
  return cost;
}

double PayloadByte(const SensingConfig& sensing) { return sensing.Frames() * sensing.frame_byte; }

}  // namespace ed3r
