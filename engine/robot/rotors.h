// The four rotors: from a wanted thrust and torque to what the air gives.
//
// Mixer: roll and pitch come first, then thrust, then yaw, each within 0 .. rotor_thrust_max_n per rotor.
// Lag: a rotor's thrust follows its command with kMotorLagS; speed controllers that feed the rotor speed back
// (as usual ones do) over-drive the motor, within its limits, so that small changes arrive with kRotorLagS.
// Threads: one object per mission.
#pragma once

#include <Eigen/Core>
#include <array>

#include "engine/robot/airframe.h"

namespace ed3r::robot {

inline constexpr double kMotorLagS = 0.050;
inline constexpr double kRotorLagS = 0.020;

struct Wrench {
  double thrust_n = 0.0;                                // along body z
  Eigen::Vector3d torque_nm = Eigen::Vector3d::Zero();  // body axes
};

using RotorThrusts = std::array<double, kRotors>;  // N

// The thrusts that give the wrench, cut to what the rotors can do.
RotorThrusts Mix(const Airframe& airframe, const Wrench& wanted);

// The wrench of given thrusts.
Wrench WrenchOf(const Airframe& airframe, const RotorThrusts& thrusts);

class Rotors {
 public:
  // step_s: of physics.
  Rotors(const Airframe& airframe, double step_s);

  // Present thrusts, as after a long time of that command.
  void Settle(const Wrench& wanted);

  // Moves the rotors towards the wanted wrench for one physics step and returns the wrench they give.
  Wrench Step(const Wrench& wanted);

  const RotorThrusts& ThrustsN() const { return thrusts_n_; }

 private:
  const Airframe& airframe_;
  double follow_ = 0.0;  // share of the way to its command that a motor goes in one step
  RotorThrusts thrusts_n_ = {};
};

}  // namespace ed3r::robot
