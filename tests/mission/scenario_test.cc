#include "engine/mission/scenario.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "engine/core/check.h"
#include "tests/mission/small_world.h"

namespace ed3r::mission {
namespace {

TEST(ScenarioTest, PlacesTakeTurns) {
  const world::Scene scene(FlatParts());
  std::map<std::pair<int, int>, int> counts;
  for (std::uint32_t i = 0; i < 850; ++i) {
    const Scenario scenario = DealScenario(scene, MissionConfig(), 7, i);
    ++counts[{scenario.site, scenario.base_station}];
  }
  EXPECT_EQ(counts.size(), 6u);
  for (const auto& [place, count] : counts) EXPECT_NEAR(count, 850 / 6.0, 1.0);
  EXPECT_EQ(PlacesInPlay(scene, MissionConfig()), 6);
}

TEST(ScenarioTest, WarmupUsesKnownPlacesOnly) {
  const world::Scene scene(FlatParts());
  MissionConfig known;
  known.sites = known.base_stations = SiteSet::kKnown;
  for (std::uint32_t i = 0; i < 50; ++i) {
    const Scenario scenario = DealScenario(scene, known, 7, i);
    EXPECT_NE(scenario.site, 1);
    EXPECT_EQ(scenario.base_station, 0);
  }
}

TEST(ScenarioTest, NoKnownPlacesIsBadInput) {
  world::Scene::Parts parts = FlatParts();
  for (world::FireSite& site : parts.sites) site.known = false;
  const world::Scene scene(parts);
  MissionConfig known;
  known.sites = SiteSet::kKnown;
  try {
    DealScenario(scene, known, 7, 0);
    FAIL();
  } catch (const UserError& error) {
    EXPECT_STREQ(error.what(), "mission.sites: 'known' is not allowed; world 'flat' has none of these");
  }
}

TEST(ScenarioTest, StartsLieOnTheDiscAndYawIsDrawnOrFixed) {
  const world::Scene scene(FlatParts());
  MissionConfig fixed;
  fixed.start_yaw = StartYaw::kFixed;
  double lowest = 1e9, highest = -1e9, least_yaw = 1e9, greatest_yaw = -1e9;
  for (std::uint32_t i = 0; i < 500; ++i) {
    const robot::Pose start = DealScenario(scene, MissionConfig(), 7, i).start;
    ASSERT_LE(std::hypot(start.position_m.x() - 200, start.position_m.y() - 200), 10.0);
    lowest = std::min(lowest, start.position_m.z());
    highest = std::max(highest, start.position_m.z());
    least_yaw = std::min(least_yaw, start.yaw_rad);
    greatest_yaw = std::max(greatest_yaw, start.yaw_rad);
    const robot::Pose turned = DealScenario(scene, fixed, 7, i).start;
    ASSERT_EQ(turned.position_m, start.position_m);
    ASSERT_EQ(turned.yaw_rad, 0.0);
  }
  EXPECT_NEAR(lowest, 30, 0.5);
  EXPECT_NEAR(highest, 50, 0.5);
  EXPECT_LT(least_yaw, -3.0);
  EXPECT_GT(greatest_yaw, 3.0);
}

TEST(ScenarioTest, ConditionsStayInTheirRanges) {
  const Config config;
  double shadowing_squares = 0.0;
  for (std::uint32_t k = 0; k < 4000; ++k) {
    const Conditions conditions = DrawConditions(config, 7, 1, k);
    ASSERT_GE(conditions.cpu_hz, 1.5e9);
    ASSERT_LE(conditions.cpu_hz, 3.2e9);
    ASSERT_GE(conditions.bandwidth_hz, 15e6);
    ASSERT_LE(conditions.bandwidth_hz, 30e6);
    shadowing_squares += conditions.shadowing_db * conditions.shadowing_db;
  }
  EXPECT_NEAR(std::sqrt(shadowing_squares / 4000), 8.0, 0.45);  // five standard errors
}

}  // namespace
}  // namespace ed3r::mission
