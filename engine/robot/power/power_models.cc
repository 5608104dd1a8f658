#include "engine/robot/power/power_models.h"

#include <numbers>

namespace ed3r::robot {

Rotorcraft MakeRotorcraft(const RobotConfig& robot) {
  return {.mass_kg = robot.mass_kg,
          .propellers = robot.propellers,
          .propeller_area_m2 = std::numbers::pi * robot.propeller_radius_m * robot.propeller_radius_m,
          .front_area_m2 = robot.FrontAreaM2(),
          .top_area_m2 = robot.TopAreaM2()};
}

double IdealHoverPowerW(double mass_kg, double density_kgm3, double gravity_mps2, double disc_area_m2) {
  const double weight_n = mass_kg * gravity_mps2;
  return weight_n * std::sqrt(weight_n / (2.0 * density_kgm3 * disc_area_m2));
}

double PaperHoverW(const Rotorcraft& craft, const Air& air, HoverForm form) {
  if (form == HoverForm::kPhysical)
    return IdealHoverPowerW(craft.mass_kg, air.density_kgm3, air.gravity_mps2, craft.DiscAreaM2());
  const double g = air.gravity_mps2;
  return craft.mass_kg * std::sqrt(craft.mass_kg) *
         std::sqrt(g * g * g / (2.0 * craft.propellers) * air.density_kgm3 * craft.propeller_area_m2);
}

}  // namespace ed3r::robot
