#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <thread>
#include <vector>

#include "engine/core/check.h"
#include "engine/perception/render/pictures.h"
#include "engine/perception/render/renderer.h"
#include "tests/perception/render/small_view.h"

namespace ed3r::perception {
namespace {

class Frames : public testing::Test {
 protected:
  static constexpr std::uint64_t kSeed = 5;
  std::shared_ptr<const world::Scene> scene_ = FireScene(
      [](double x_m, double y_m) { return 8.0 + 6.0 * std::sin(0.03 * x_m) * std::cos(0.04 * y_m); },
      {300, 200});
  std::shared_ptr<const TraceScene> traced_ = std::make_shared<TraceScene>(*scene_);
  PerceptionConfig perception_;
  robot::Pose pose_ = LookFrom(230, 190, 30, 5, 10);

  Renderer MakeRenderer(std::uint32_t scenario = 3, int site = 0) const {
    return Renderer(traced_, site, perception_, SensingConfig(), kSeed, scenario);
  }
};

double Difference(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::abs(static_cast<double>(a[i]) - b[i]);
  return sum / static_cast<double>(a.size());
}

TEST_F(Frames, AreThirtyThreeOfTheConfiguredSize) {
  perception_.render.width_px = 64;
  perception_.render.height_px = 36;
  perception_.render.frame_step = 1;
  const SensingFrames sensed = MakeRenderer().Sense(pose_, 1);
  EXPECT_EQ(sensed.frames.frames, 33);
  EXPECT_EQ(sensed.frames.width_px, 64);
  EXPECT_EQ(sensed.frames.height_px, 36);
  EXPECT_EQ(sensed.frames.rgb.size(), 33u * 64 * 36 * 3);
}

TEST_F(Frames, AreTheSameBytesAgainAndFromOtherThreads) {
  const Renderer renderer = MakeRenderer();
  const auto first = renderer.Sense(pose_, 4).frames.rgb;
  EXPECT_EQ(renderer.Sense(pose_, 4).frames.rgb, first);
  std::vector<std::vector<std::uint8_t>> from_threads(2);
  std::vector<std::thread> threads;
  for (auto& result : from_threads)
    threads.emplace_back([&] { result = MakeRenderer().Sense(pose_, 4).frames.rgb; });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(from_threads[0], first);
  EXPECT_EQ(from_threads[1], first);
}

TEST_F(Frames, OneInSoManyIsThatOfAll) {
  perception_.render.width_px = 64;
  perception_.render.height_px = 36;
  perception_.render.frame_step = 1;
  const auto all = MakeRenderer().Sense(pose_, 2).frames.rgb;
  const std::size_t bytes = 64 * 36 * 3;
  for (const auto& [step, frames] :
       {std::pair{3, 11}, std::pair{7, 5}, std::pair{33, 1}, std::pair{100, 1}}) {
    perception_.render.frame_step = step;
    const FrameStack some = MakeRenderer().Sense(pose_, 2).frames;
    ASSERT_EQ(some.frames, frames);
    ASSERT_EQ(some.rgb.size(), static_cast<std::size_t>(frames) * bytes);
    for (int i = 0; i < frames; ++i)
      EXPECT_TRUE(std::equal(some.rgb.begin() + static_cast<std::ptrdiff_t>(i * bytes),
                             some.rgb.begin() + static_cast<std::ptrdiff_t>((i + 1) * bytes),
                             all.begin() + static_cast<std::ptrdiff_t>(i * step * bytes)))
          << step << ", " << i;
  }
}

TEST_F(Frames, OneAloneEqualsOneOfAll) {
  perception_.render.width_px = 96;
  perception_.render.height_px = 54;
  perception_.render.frame_step = 1;
  const Renderer renderer = MakeRenderer();
  const auto all = renderer.Sense(pose_, 2).frames.rgb;
  const int some[] = {31, 7};
  const auto two = renderer.Sense(pose_, 2, some, {}).frames.rgb;
  const std::size_t bytes = 96 * 54 * 3;
  EXPECT_TRUE(std::equal(two.begin(), two.begin() + bytes, all.begin() + 31 * bytes));
  EXPECT_TRUE(std::equal(two.begin() + bytes, two.end(), all.begin() + 7 * bytes));
}

TEST_F(Frames, DifferByTimestepScenarioAndSeedOnly) {
  const int first[] = {0};
  const auto base = MakeRenderer(3).Sense(pose_, 1, first, {}).frames.rgb;
  EXPECT_GT(Difference(base, MakeRenderer(3).Sense(pose_, 2, first, {}).frames.rgb), 0.5);
  EXPECT_GT(Difference(base, MakeRenderer(4).Sense(pose_, 1, first, {}).frames.rgb), 2.0);
  EXPECT_EQ(Difference(base, MakeRenderer(3).Sense(pose_, 1, first, {}).frames.rgb), 0.0);
}

TEST_F(Frames, FireFlickersAndStillGroundDoesNot) {
  perception_ = ClearView();
  perception_.render.noise = 0.0;
  perception_.render.jitter_deg = 0.0;
  const int two[] = {0, 5};
  const auto changed = [&](int site) {
    const auto rgb = MakeRenderer(3, site).Sense(pose_, 1, two, {}).frames.rgb;
    const std::size_t half = rgb.size() / 2;
    int count = 0;
    for (std::size_t i = 0; i < half; ++i) count += std::abs(rgb[i] - rgb[half + i]) > 8;
    return count;
  };
  EXPECT_EQ(changed(-1), 0);
  EXPECT_GT(changed(0), 150);
}

TEST_F(Frames, AFireIsOrangeAndSmokeIsNot) {
  perception_ = ClearView();
  const int first[] = {0};
  const auto orange = [&](int site) {
    const auto rgb = MakeRenderer(3, site).Sense(pose_, 1, first, {}).frames.rgb;
    int count = 0;
    for (std::size_t i = 0; i < rgb.size(); i += 3) count += rgb[i] > 200 && rgb[i] > rgb[i + 2] + 70;
    return count;
  };
  EXPECT_EQ(orange(-1), 0);
  EXPECT_GT(orange(0), 25);
}

TEST_F(Frames, RefuseSizesAndNumbersOutOfRange) {
  const Renderer renderer = MakeRenderer();
  const int first[] = {0};
  const int beyond[] = {33};
  EXPECT_THROW(renderer.Sense(pose_, 1, first, {15, 54}), InternalError);
  EXPECT_THROW(renderer.Sense(pose_, 1, first, {96, 8}), InternalError);
  EXPECT_THROW(renderer.Sense(pose_, 1, first, {1921, 1080}), InternalError);
  EXPECT_THROW(renderer.Sense(pose_, 1, beyond, {}), InternalError);
  EXPECT_THROW(MakeRenderer(1, 1), InternalError);  // the scene has one site
  EXPECT_EQ(renderer.Sense(pose_, 1, first, {1920, 1080}).frames.rgb.size(), 1920u * 1080 * 3);
  EXPECT_EQ(renderer.Sense(pose_, 1, first, {16, 9}).frames.rgb.size(), 16u * 9 * 3);
}

TEST_F(Frames, PicturesAreRefusedWhereTheyCannotBeWritten) {
  EXPECT_THROW(WriteFramePictures(MakeRenderer(), pose_, 1, {}, "/nonexistent/folder/step"), UserError);
}

}  // namespace
}  // namespace ed3r::perception
