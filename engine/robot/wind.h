// Wind at the robot: the mean of environment.wind_*_mps plus gusts, a first-order Gauss-Markov process on
// each axis with standard deviation environment.gust_mps and correlation time kGustCorrelationS (after the
// Dryden model: its length scale at tree height, some 25 m, over a typical 8 m/s).
//
// Gusts are drawn afresh at each timestep's move: the seconds of sensing in between outlast their memory, and
// so the wind of a timestep does not depend on how long the robot flew before. Threads: one object per move.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "engine/config/config.h"
#include "engine/core/random.h"

namespace ed3r::robot {

inline constexpr double kGustCorrelationS = 3.0;

class Wind {
 public:
  Wind(const EnvironmentConfig& environment, std::uint64_t seed, std::uint32_t scenario,
       std::uint32_t timestep, double step_s);  // step_s: of physics

  const Eigen::Vector3d& VelocityMps() const { return velocity_mps_; }

  // Moves on by one physics step.
  void Step();

 private:
  Eigen::Vector3d Draw(double sigma_mps);

  Stream stream_;
  double gust_mps_;
  double keep_, renew_;  // of a gust, in one step
  Eigen::Vector3d mean_mps_;
  Eigen::Vector3d velocity_mps_;
};

}  // namespace ed3r::robot
