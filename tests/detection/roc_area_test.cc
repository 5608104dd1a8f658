#include "studies/detection/roc_area.h"

#include <gtest/gtest.h>

#include <cmath>

#include "studies/detection/scores.h"
#include "studies/detection/views.h"

namespace ed3r::detection {
namespace {

FrameLabel Label(bool positive, int view, const char* world = "w") {
  return {.world = world, .view = view, .positive = positive};
}

const std::vector<FrameLabel> kLabels = {Label(true, 0),  Label(true, 0),  Label(false, 1), Label(false, 1),
                                         Label(false, 2), Label(false, 2), Label(true, 3)};
const std::vector<double> kConfidences = {0.9, 0.4, 0.4, 0.1, 0.6, 0.4, 0.7};

// A frame that counts n times is n equal frames.
TEST(RocArea, CountsAreCopies) {
  const std::vector<std::size_t> all = All(kLabels).frames;
  const Views views = ViewsOf(kLabels, all);
  const std::vector<int> counts = {2, 3, 1, 0};
  std::vector<std::size_t> copies;
  for (const std::size_t i : all)
    for (int n = 0; n < counts[static_cast<std::size_t>(views.of_frame[i])]; ++n) copies.push_back(i);
  const RocArea area(kConfidences, kLabels, all, views.of_frame);
  EXPECT_EQ(area.Of(counts), ScoresOf(kConfidences, kLabels, copies).auc);
  // By hand: 0.9 (twice) is above all 8 negatives; 0.4 (twice) is above three and ties with four.
  EXPECT_DOUBLE_EQ(area.Of(counts), (2 * 8 + 2 * (3 + 0.5 * 4)) / 32.0);
}

TEST(RocArea, ManyCountsAreAsOneWhereAllAreEqual) {
  const std::vector<std::size_t> all = All(kLabels).frames;
  const Views views = ViewsOf(kLabels, all);
  const RocArea area(kConfidences, kLabels, all, views.of_frame);
  EXPECT_EQ(area.Of(std::vector<int>(4, 1)), area.Of(std::vector<int>(4, 7)));
}

TEST(RocArea, AResampleWithoutOneKindOfFrameHasNone) {
  const std::vector<std::size_t> all = All(kLabels).frames;
  const RocArea area(kConfidences, kLabels, all, ViewsOf(kLabels, all).of_frame);
  EXPECT_TRUE(std::isnan(area.Of(std::vector<int>{2, 0, 0, 2})));
  EXPECT_TRUE(std::isnan(area.Of(std::vector<int>{0, 2, 2, 0})));
}

TEST(Views, AreThoseOfAWorldInTheChosenFrames) {
  const std::vector<FrameLabel> labels = {Label(true, 5, "b"), Label(true, 5, "a"), Label(true, 2, "b"),
                                          Label(true, 9, "a"), Label(true, 5, "b")};
  const Views views = ViewsOf(labels, {0, 1, 2, 4});
  EXPECT_EQ(views.count, 3);
  EXPECT_EQ(views.of_frame, (std::vector<int>{2, 0, 1, 2}));
}

}  // namespace
}  // namespace ed3r::detection
