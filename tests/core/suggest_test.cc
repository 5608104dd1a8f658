#include "engine/core/suggest.h"

#include <gtest/gtest.h>

namespace ed3r {
namespace {

const std::vector<std::string> kWords = {"robot.mass_kg", "robot.speed_mps", "radio.noise_dbm_per_hz"};

TEST(NearestWordTest, FindsSlips) {
  EXPECT_EQ(NearestWord("robot.mas_kg", kWords), "robot.mass_kg");
  EXPECT_EQ(NearestWord("robot.mass_gk", kWords), "robot.mass_kg");
  EXPECT_EQ(NearestWord("speed_mps", kWords), "robot.speed_mps");
  EXPECT_EQ(NearestWord("robot.speed", kWords), "robot.speed_mps") << "the unit was forgotten";
}

TEST(NearestWordTest, StaysSilentWhenNothingIsNear) { EXPECT_EQ(NearestWord("zebra", kWords), ""); }

}  // namespace
}  // namespace ed3r
