#include "studies/fit/energy_model.h"

#include <ceres/jet.h>

#include <cmath>

#include "engine/config/parameters.h"
#include "engine/robot/power/power_models.h"

namespace ed3r::fit {
namespace {

// A power formula with everything but row and parameters bound.
struct Airframe {
  robot::Rotorcraft craft;
  double gravity_mps2;

  robot::Air AirAt(const FlightRow& row) const { return {row.density_kgm3, gravity_mps2}; }
  robot::Rotorcraft Loaded(const FlightRow& row) const {
    robot::Rotorcraft loaded = craft;
    loaded.mass_kg = row.mass_kg;
    return loaded;
  }
};

template <VerticalForm kForm>
struct PaperFormula {
  // The climb form has no vertical drag, so C_dv cannot be estimated with it.
  static constexpr int kSize = kForm == VerticalForm::kClimb ? 2 : 3;

  template <class T>
  static T PowerW(const Airframe& airframe, const FlightRow& row, const T* p) {
    robot::PaperParameters<T> parameters{.efficiency = p[0], .drag_horizontal = p[1]};
    if constexpr (kSize == 3) parameters.drag_vertical = p[2];
    const robot::PaperPower<T> power =
        robot::PaperPowersW(parameters, airframe.Loaded(row), airframe.AirAt(row), row.airspeed_mps,
                            std::abs(row.climb_mps), HoverForm::kPhysical, kForm);
    if (row.climb_mps > kVerticalMps) return power.ascent_w;
    if (row.climb_mps < -kVerticalMps) return power.descent_w;
    return power.horizontal_w;
  }
};

template <bool kInterference>
struct MomentumFormula {
  static constexpr int kSize = kInterference ? 5 : 4;

  template <class T>
  static T PowerW(const Airframe& airframe, const FlightRow& row, const T* p) {
    const robot::MomentumParameters<T> parameters{.efficiency = p[0],
                                                  .induced_factor = p[1],
                                                  .interference = kInterference ? p[kSize - 1] : T(0.0),
                                                  .profile_share = p[2],
                                                  .drag_area_m2 = p[3]};
    return robot::MomentumPowerW(parameters, row.mass_kg, row.airspeed_mps, row.climb_mps,
                                 airframe.AirAt(row), airframe.craft.DiscAreaM2());
  }
};

template <class Formula>
class FormulaModel final : public EnergyModel {
 public:
  FormulaModel(std::string name, std::string meaning, std::vector<ParameterSpec> parameters,
               const Airframe& airframe)
      : EnergyModel(std::move(name), std::move(meaning), std::move(parameters)), airframe_(airframe) {}

  double PowerW(const FlightRow& row, const double* parameters) const override {
    return Formula::PowerW(airframe_, row, parameters);
  }

  double PowerW(const FlightRow& row, const double* parameters, double* gradient) const override {
    using Jet = ceres::Jet<double, Formula::kSize>;
    Jet p[Formula::kSize];
    for (int i = 0; i < Formula::kSize; ++i) p[i] = Jet(parameters[i], i);
    const Jet power = Formula::PowerW(airframe_, row, p);
    for (int i = 0; i < Formula::kSize; ++i) gradient[i] = power.v[i];
    return power.a;
  }

 private:
  Airframe airframe_;
};

// A fit may not find what a sweep may not set: unit and bounds are those of the key.
ParameterSpec Fitted(const std::string& name, const std::string& key, double start) {
  const ParameterInfo& info = ParameterOf(key);
  return {name, key, info.unit, info.min, info.max, start};
}

}  // namespace

std::vector<std::unique_ptr<EnergyModel>> MakeEnergyModels(const RobotConfig& robot, double gravity_mps2) {
  const Airframe airframe{robot::MakeRotorcraft(robot), gravity_mps2};
  const ParameterSpec paper_efficiency = Fitted("efficiency", "energy.paper_efficiency", 0.6);
  const ParameterSpec c_dh = Fitted("C_dh", "robot.drag_horizontal", 0.55);
  const ParameterSpec c_dv = Fitted("C_dv", "robot.drag_vertical", 0.35);
  const std::vector<ParameterSpec> isolated = {Fitted("efficiency", "energy.momentum_efficiency", 0.7),
                                               Fitted("induced_factor", "energy.induced_factor", 1.15),
                                               Fitted("profile_share", "energy.profile_share", 0.3),
                                               Fitted("drag_area", "energy.drag_area_m2", 0.03)};
  std::vector<ParameterSpec> interfering = isolated;
  interfering.push_back(Fitted("interference", "energy.interference", 0.5));

  using Printed = FormulaModel<PaperFormula<VerticalForm::kPrinted>>;
  using Climb = FormulaModel<PaperFormula<VerticalForm::kClimb>>;
  std::vector<std::unique_ptr<EnergyModel>> models;
  models.push_back(std::make_unique<Printed>("paper",
                                             "the paper's three powers as printed, over an efficiency",
                                             std::vector{paper_efficiency, c_dh, c_dv}, airframe));
  models.push_back(std::make_unique<Climb>("paper-climb",
                                           "the paper's powers with vertical power P_hov + m g v (R3)",
                                           std::vector{paper_efficiency, c_dh}, airframe));
  models.push_back(std::make_unique<FormulaModel<MomentumFormula<false>>>(
      "momentum-isolated", "momentum theory, rotors that do not disturb each other", isolated, airframe));
  models.push_back(std::make_unique<FormulaModel<MomentumFormula<true>>>(
      "momentum", "momentum theory with rotor interference in forward flight", interfering, airframe));
  return models;
}

}  // namespace ed3r::fit
