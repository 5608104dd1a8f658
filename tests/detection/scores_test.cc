#include "studies/detection/scores.h"

#include <gtest/gtest.h>

#include <cmath>

namespace ed3r::detection {
namespace {

FrameLabel Label(bool positive, double distance_m = 0, double occluded = 0, double pixels = 0, int view = 0) {
  return {.world = "w",
          .view = view,
          .distance_m = distance_m,
          .fire_px = pixels,
          .occluded = occluded,
          .positive = positive};
}

TEST(Scores, CountsAndAccuracyAreThoseCountedByHand) {
  const std::vector<FrameLabel> labels = {Label(true), Label(true), Label(true), Label(false), Label(false)};
  const std::vector<double> confidences = {0.9, 0.5, 0.2, 0.4, 0.7};
  const DetectionScores s = ScoresOf(confidences, labels, All(labels).frames);
  EXPECT_EQ(s.true_positives, 2);
  EXPECT_EQ(s.false_negatives, 1);
  EXPECT_EQ(s.false_positives, 1);
  EXPECT_EQ(s.true_negatives, 1);
  EXPECT_DOUBLE_EQ(s.accuracy, 0.6);
  // Pairs (positive, negative) in the right order: 0.9 above both, 0.5 above 0.4, 0.2 above none: 3 of 6.
  EXPECT_DOUBLE_EQ(s.auc, 0.5);
}

TEST(Scores, TiesCountHalf) {
  const std::vector<FrameLabel> labels = {Label(true), Label(false), Label(false)};
  EXPECT_DOUBLE_EQ(ScoresOf(std::vector<double>{0.3, 0.3, 0.1}, labels, {0, 1, 2}).auc, 0.75);
}

TEST(Scores, OneKindOfFrameHasNoAuc) {
  const std::vector<FrameLabel> labels = {Label(true), Label(true)};
  EXPECT_TRUE(std::isnan(ScoresOf(std::vector<double>{0.3, 0.6}, labels, {0, 1}).auc));
}

// 0.2 twice with one positive, 0.9 with none: (|0.4 - 1| + |0.9 - 0|) / 3.
TEST(Scores, CalibrationErrorIsTheWeightedDistanceOfTheBins) {
  const std::vector<FrameLabel> labels = {Label(true), Label(false), Label(false)};
  EXPECT_NEAR(ScoresOf(std::vector<double>{0.2, 0.2, 0.9}, labels, {0, 1, 2}).calibration_error, 0.5, 1e-12);
}

TEST(Scores, TheIntervalTreatsTheFramesOfAViewAsOneDraw) {
  std::vector<FrameLabel> alone, together;
  std::vector<double> confidences;
  for (int i = 0; i < 400; ++i) {
    alone.push_back(Label(true, 0, 0, 0, i));
    together.push_back(Label(true, 0, 0, 0, i / 10));
    confidences.push_back(i / 10 % 4 == 0 ? 0.1 : 0.9);
  }
  const auto width = [&](const std::vector<FrameLabel>& labels) {
    const statistics::Interval interval = ScoresOf(confidences, labels, All(labels).frames).accuracy_interval;
    return interval.hi - interval.lo;
  };
  EXPECT_GT(width(together), 2.0 * width(alone));
}

TEST(Scores, EachBandHoldsItsPositivesAndAllNegatives) {
  const std::vector<FrameLabel> labels = {Label(true, 20, 0.0, 300), Label(true, 120, 0.95, 3),
                                          Label(false, 20), Label(false, 400), Label(true, 50, 0.1, 8)};
  const std::vector<Group> distance = ByDistance(labels);
  ASSERT_EQ(distance.size(), 3u);
  EXPECT_EQ(distance[0].frames, (std::vector<std::size_t>{0, 2, 3}));
  EXPECT_EQ(distance[1].frames, (std::vector<std::size_t>{2, 3, 4}));
  EXPECT_EQ(distance[2].frames, (std::vector<std::size_t>{1, 2, 3}));
  EXPECT_EQ(ByOcclusion(labels).size(), 3u);
  EXPECT_EQ(BySize(labels).front().frames, (std::vector<std::size_t>{1, 2, 3}));
}

}  // namespace
}  // namespace ed3r::detection
