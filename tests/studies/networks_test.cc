// Intervals of arms that flew with several trained networks include the luck of training.
#include <gtest/gtest.h>

#include <cmath>

#include "studies/metrics/metrics.h"

namespace ed3r {
namespace {

// 100 missions for each network, each with the given energy per mission give or take 10 %.
metrics::ArmData ArmOf(const std::vector<double>& energies_kj) {
  metrics::ArmData arm{"online", "ed3r-75", {}};
  for (std::size_t network = 0; network < energies_kj.size(); ++network) {
    for (int i = 0; i < 100; ++i) {
      mission::MissionRecord mission;
      mission.network = static_cast<std::int64_t>(network);
      mission.timesteps = mission.full_local = 10;
      mission.duration_s = 100;
      mission.total_j = mission.movement_j = 1000 * energies_kj[network] * (0.9 + 0.002 * i);
      arm.missions.push_back(mission);
    }
  }
  return arm;
}

TEST(NetworksTest, LuckyAndUnluckyNetworksWidenTheInterval) {
  const metrics::MetricValue energy = metrics::ComputeMetrics(ArmOf({10, 20, 30}))["total_energy_kj"];
  EXPECT_NEAR(energy.value, 20 * 0.999, 1e-9);
  // By hand: three networks of 9.99, 19.98, 29.97 kJ; t with 2 degrees of freedom, 4.303 x 9.99 / sqrt(3) = 24.8.
  EXPECT_EQ(energy.lo, 0.0);
  EXPECT_NEAR(energy.hi, 19.98 + 4.30265 * 9.99 / std::sqrt(3.0), 0.01);
}

TEST(NetworksTest, NetworksThatAgreeByAccidentNarrowNothing) {
  const metrics::ArmData one = ArmOf({20});
  metrics::ArmData three = ArmOf({20, 20, 20});
  const metrics::MetricValue over_missions = [&] {
    metrics::ArmData merged = three;
    for (mission::MissionRecord& mission : merged.missions) mission.network = 0;
    return metrics::ComputeMetrics(merged)["total_energy_kj"];
  }();
  const metrics::MetricValue with_networks = metrics::ComputeMetrics(three)["total_energy_kj"];
  EXPECT_EQ(with_networks.lo, over_missions.lo);
  EXPECT_EQ(with_networks.hi, over_missions.hi);
  EXPECT_EQ(metrics::ComputeMetrics(three).networks, 3);
  EXPECT_EQ(metrics::ComputeMetrics(one).networks, 0);
}

}  // namespace
}  // namespace ed3r
