#include "engine/perception/detector.h"

#include <gtest/gtest.h>

namespace ed3r::perception {
namespace {

double MeanScs(double fire_share, DetectionModel model) {
  const PerceptionConfig perception;
  double sum = 0.0;
  for (std::uint32_t scenario = 0; scenario < 500; ++scenario)
    sum += DetectFromProfile({.fire_share = fire_share}, perception, model, 33,
                             {.seed = 1, .scenario = scenario})
               .scs;
  return sum / 500;
}

TEST(ProfileDetectorTest, NothingInViewIsNothingDetected) {
  EXPECT_EQ(MeanScs(0.0, DetectionModel::kFull), 0.0);
  EXPECT_EQ(MeanScs(0.0, DetectionModel::kQuantized), 0.0);
}

TEST(ProfileDetectorTest, MoreFireMoreConfidence) {
  EXPECT_LT(MeanScs(0.0005, DetectionModel::kFull), MeanScs(0.005, DetectionModel::kFull));
  EXPECT_GT(MeanScs(0.2, DetectionModel::kFull), 0.9);
}

TEST(ProfileDetectorTest, QuantizedIsTheWeakerModel) {
  for (const double share : {0.002, 0.01, 0.05})
    EXPECT_LT(MeanScs(share, DetectionModel::kQuantized), MeanScs(share, DetectionModel::kFull)) << share;
}

TEST(ProfileDetectorTest, DrawsAreKeyed) {
  const PerceptionConfig perception;
  const View view{.fire_share = 0.004};
  const auto detect = [&](std::uint32_t scenario, std::uint32_t timestep) {
    return DetectFromProfile(view, perception, DetectionModel::kFull, 33,
                             {.seed = 1, .scenario = scenario, .timestep = timestep, .view = timestep})
        .mean;
  };
  EXPECT_EQ(detect(1, 1), detect(1, 1));
  EXPECT_NE(detect(1, 1), detect(1, 2));
  EXPECT_NE(detect(1, 1), detect(2, 1));
}

TEST(ProfileDetectorTest, TheStrongerOfFireAndDistractorCounts) {
  PerceptionConfig perception;
  perception.distractor_weight = 2.0;
  perception.full.distractor_gain = 0.5;
  perception.quantized.distractor_gain = 3.0;
  const auto detect = [&](const View& view, DetectionModel model) {
    return DetectFromProfile(view, perception, model, 33, {.seed = 1}).mean;
  };
  const double fire = detect({.fire_share = 0.001}, DetectionModel::kFull);
  EXPECT_GT(fire, 0.0);
  EXPECT_EQ(detect({.fire_share = 0.001, .distractor_share = 0.0009}, DetectionModel::kFull), fire);
  EXPECT_EQ(detect({.fire_share = 0.0001, .distractor_share = 0.001}, DetectionModel::kFull), fire);
  EXPECT_EQ(detect({.distractor_share = 0.001}, DetectionModel::kQuantized),
            detect({.fire_share = 0.006}, DetectionModel::kQuantized));
}

TEST(ProfileDetectorTest, AViewKeepsItsFluctuation) {
  PerceptionConfig perception;
  perception.full.frame_sigma = 0.0;
  const auto detect = [&](std::uint32_t timestep, std::uint32_t view) {
    return DetectFromProfile({.fire_share = 0.004}, perception, DetectionModel::kFull, 33,
                             {.seed = 1, .timestep = timestep, .view = view})
        .mean;
  };
  EXPECT_EQ(detect(5, 4), detect(4, 4));
  EXPECT_NE(detect(5, 5), detect(4, 4));
}

}  // namespace
}  // namespace ed3r::perception
