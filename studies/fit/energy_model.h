// The energy models that a fit compares: each is one of the engine's power formulas (power_models.h) with the
// parameters that are estimated, their bounds and the configuration keys that they set.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "engine/config/robot.h"
#include "studies/fit/flight_log.h"

namespace ed3r::fit {

struct ParameterSpec {
  std::string name;
  std::string key;      // configuration key that takes the value
  std::string unit;     // "" for none
  double lower, upper;  // those of the key
  double start;         // a plausible value; other starts are spread over the bounds
};

// Immutable; thread-safe.
class EnergyModel {
 public:
  virtual ~EnergyModel() = default;

  const std::string& name() const { return name_; }
  const std::string& meaning() const { return meaning_; }
  const std::vector<ParameterSpec>& parameters() const { return parameters_; }
  int size() const { return static_cast<int>(parameters_.size()); }

  // Predicted electrical power. parameters: size() values in the order of parameters().
  virtual double PowerW(const FlightRow& row, const double* parameters) const = 0;
  // The same, with its derivatives by the parameters (automatic differentiation).
  virtual double PowerW(const FlightRow& row, const double* parameters, double* gradient) const = 0;

 protected:
  EnergyModel(std::string name, std::string meaning, std::vector<ParameterSpec> parameters)
      : name_(std::move(name)), meaning_(std::move(meaning)), parameters_(std::move(parameters)) {}

 private:
  std::string name_, meaning_;
  std::vector<ParameterSpec> parameters_;
};

// In the order of the report:
//   paper              hover, horizontal and vertical power as printed (R1-R3), and an efficiency
//   paper-climb        the same with vertical power P_hov + m g v (R3)
//   momentum-isolated  momentum theory, rotors that do not disturb each other (chi = 0)
//   momentum           momentum theory with rotor interference
// A log row is in vertical motion where |climb| exceeds kVerticalMps, else in horizontal motion, which is
// hovering at speed 0: the paper knows no diagonal flight (R4).
std::vector<std::unique_ptr<EnergyModel>> MakeEnergyModels(const RobotConfig& robot, double gravity_mps2);

inline constexpr double kVerticalMps = 0.5;

}  // namespace ed3r::fit
