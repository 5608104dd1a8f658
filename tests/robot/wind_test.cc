#include "engine/robot/wind.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace ed3r::robot {
namespace {

constexpr double kStepS = 1.0 / 240.0;

TEST(WindTest, WithoutGustsIsTheMean) {
  EnvironmentConfig environment;
  environment.wind_x_mps = 3;
  environment.wind_y_mps = -4;
  Wind wind(environment, 1, 2, 3, kStepS);
  for (int i = 0; i < 100; ++i) wind.Step();
  EXPECT_EQ(wind.VelocityMps(), Eigen::Vector3d(3, -4, 0));
}

TEST(WindTest, GustsHaveTheirSpreadAndMemory) {
  EnvironmentConfig environment;
  environment.wind_x_mps = 3;
  environment.gust_mps = 2;
  const int lag = static_cast<int>(kGustCorrelationS / kStepS);
  const int runs = 4000;
  double sum = 0, square = 0, product = 0;
  for (int run = 0; run < runs; ++run) {
    Wind wind(environment, 7, run, 0, kStepS);
    const double before = wind.VelocityMps().x() - 3;
    for (int i = 0; i < lag; ++i) wind.Step();
    const double after = wind.VelocityMps().x() - 3;
    sum += after;
    square += after * after;
    product += before * after;
  }
  // Five standard errors.
  EXPECT_NEAR(sum / runs, 0.0, 5 * 2 / std::sqrt(runs));
  EXPECT_NEAR(square / runs, 4.0, 5 * 4 * std::sqrt(2.0 / runs));
  EXPECT_NEAR(product / runs, 4.0 * std::exp(-1.0), 5 * 4 * 1.1 / std::sqrt(runs));
}

TEST(WindTest, IsAFunctionOfItsKey) {
  EnvironmentConfig environment;
  environment.gust_mps = 2;
  const auto after = [&](std::uint64_t seed, std::uint32_t scenario, std::uint32_t timestep) {
    Wind wind(environment, seed, scenario, timestep, kStepS);
    for (int i = 0; i < 10; ++i) wind.Step();
    return wind.VelocityMps();
  };
  EXPECT_EQ(after(1, 2, 3), after(1, 2, 3));
  EXPECT_NE(after(1, 2, 3), after(1, 2, 4));
  EXPECT_NE(after(1, 2, 3), after(1, 3, 3));
  EXPECT_NE(after(1, 2, 3), after(2, 2, 3));
}

}  // namespace
}  // namespace ed3r::robot
