#include "engine/robot/wind.h"

#include <cmath>

namespace ed3r::robot {

Wind::Wind(const EnvironmentConfig& environment, std::uint64_t seed, std::uint32_t scenario,
           std::uint32_t timestep, double step_s)
    : stream_(seed, scenario, Purpose::kWind, timestep),
      gust_mps_(environment.gust_mps),
      keep_(std::exp(-step_s / kGustCorrelationS)),
      renew_(std::sqrt(1.0 - keep_ * keep_)),  // keeps the standard deviation
      mean_mps_(environment.wind_x_mps, environment.wind_y_mps, 0.0),
      velocity_mps_(mean_mps_) {
  if (gust_mps_ > 0.0) velocity_mps_ += Draw(gust_mps_);
}

Eigen::Vector3d Wind::Draw(double sigma_mps) {
  const double x = stream_.Normal();
  const double y = stream_.Normal();
  const double z = stream_.Normal();
  return sigma_mps * Eigen::Vector3d(x, y, z);
}

void Wind::Step() {
  if (gust_mps_ <= 0.0) return;
  velocity_mps_ = mean_mps_ + keep_ * (velocity_mps_ - mean_mps_) + Draw(renew_ * gust_mps_);
}

}  // namespace ed3r::robot
