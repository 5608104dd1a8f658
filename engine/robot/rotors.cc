#include "engine/robot/rotors.h"

#include <algorithm>
#include <cmath>

namespace ed3r::robot {

RotorThrusts Mix(const Airframe& airframe, const Wrench& wanted) {
  const double limit_n = airframe.rotor_thrust_max_n;
  const double roll = wanted.torque_nm.x() / kRotors;
  const double pitch = wanted.torque_nm.y() / kRotors;
  RotorThrusts tilt;
  for (int i = 0; i < kRotors; ++i)
    tilt[i] = roll / airframe.rotor_m[i].y() - pitch / airframe.rotor_m[i].x();
  const auto [lowest, highest] = std::minmax_element(tilt.begin(), tilt.end());
  const double spread = *highest - *lowest;
  const double scale = spread > limit_n ? limit_n / spread : 1.0;

  const double base =
      std::clamp(wanted.thrust_n / kRotors, -scale * *lowest, std::max(limit_n - scale * *highest, 0.0));
  const double yaw = wanted.torque_nm.z() / (kRotors * airframe.rotor_torque_m);
  double yaw_share = 1.0;
  RotorThrusts thrusts;
  for (int i = 0; i < kRotors; ++i) {
    thrusts[i] = std::clamp(base + scale * tilt[i], 0.0, limit_n);
    const double change = yaw * airframe.spin[i];
    const double room = change > 0.0 ? limit_n - thrusts[i] : thrusts[i];
    if (std::abs(change) > room) yaw_share = std::min(yaw_share, room / std::abs(change));
  }
  for (int i = 0; i < kRotors; ++i)
    thrusts[i] = std::clamp(thrusts[i] + yaw_share * yaw * airframe.spin[i], 0.0, limit_n);
  return thrusts;
}

Wrench WrenchOf(const Airframe& airframe, const RotorThrusts& thrusts) {
  Wrench wrench;
  for (int i = 0; i < kRotors; ++i) {
    wrench.thrust_n += thrusts[i];
    wrench.torque_nm += thrusts[i] * Eigen::Vector3d(airframe.rotor_m[i].y(), -airframe.rotor_m[i].x(),
                                                     airframe.spin[i] * airframe.rotor_torque_m);
  }
  return wrench;
}

Rotors::Rotors(const Airframe& airframe, double step_s)
    : airframe_(airframe), follow_(1.0 - std::exp(-step_s / kMotorLagS)) {}

void Rotors::Settle(const Wrench& wanted) { thrusts_n_ = Mix(airframe_, wanted); }

Wrench Rotors::Step(const Wrench& wanted) {
  const RotorThrusts target_n = Mix(airframe_, wanted);
  for (int i = 0; i < kRotors; ++i) {
    const double command_n =
        std::clamp(thrusts_n_[i] + kMotorLagS / kRotorLagS * (target_n[i] - thrusts_n_[i]), 0.0,
                   airframe_.rotor_thrust_max_n);
    thrusts_n_[i] += follow_ * (command_n - thrusts_n_[i]);
  }
  return WrenchOf(airframe_, thrusts_n_);
}

}  // namespace ed3r::robot
