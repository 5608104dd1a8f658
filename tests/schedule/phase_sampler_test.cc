#include "engine/schedule/phase_sampler.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <latch>
#include <thread>
#include <vector>

namespace ed3r::schedule {
namespace {

std::vector<Phase> Seen() {
  std::vector<Phase> seen;
  LookAtThreads([&](Phase phase) { seen.push_back(phase); });
  return seen;
}

TEST(PhaseTest, IsTheInnermostMarkAndGoesBackToTheOneBefore) {
  const WatchedThread watched;
  EXPECT_EQ(Seen(), std::vector{Phase::kOther});
  {
    const InPhase control(Phase::kControl);
    {
      const InPhase physics(Phase::kPhysics);
      EXPECT_EQ(Seen(), std::vector{Phase::kPhysics});
    }
    EXPECT_EQ(Seen(), std::vector{Phase::kControl});
  }
  EXPECT_EQ(Seen(), std::vector{Phase::kOther});
}

TEST(PhaseTest, AThreadIsSeenOnceHoweverOftenItIsWatchedAndNotAfterwards) {
  EXPECT_TRUE(Seen().empty());
  {
    const WatchedThread first;
    const WatchedThread second;
    EXPECT_EQ(Seen().size(), 1u);
  }
  EXPECT_TRUE(Seen().empty());
}

TEST(PhaseTest, OtherThreadsAreSeenAtWhatTheyAreAt) {
  std::latch begun(2), seen(1);
  const auto be_at = [&](Phase phase) {
    const WatchedThread watched;
    const InPhase at(phase);
    begun.count_down();
    seen.wait();
  };
  std::jthread one(be_at, Phase::kTraining), two(be_at, Phase::kStore);
  begun.wait();
  std::vector<Phase> phases = Seen();
  std::sort(phases.begin(), phases.end());
  EXPECT_EQ(phases, (std::vector{Phase::kTraining, Phase::kStore}));
  seen.count_down();
}

TEST(PhaseSamplerTest, AddsTimeToWhatAThreadIsAtAndToNothingElse) {
  const WatchedThread watched;
  PhaseSampler sampler;
  {
    const InPhase training(Phase::kTraining);
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  const PhaseTimes times = sampler.Finish();
  EXPECT_GT(times.seconds[static_cast<std::size_t>(Phase::kTraining)], 0.0);
  EXPECT_EQ(times.seconds[static_cast<std::size_t>(Phase::kPhysics)], 0.0);
  EXPECT_NE(times.Text().find("training "), std::string::npos) << times.Text();
  EXPECT_EQ(times.Text().find("physics"), std::string::npos) << times.Text();
}

TEST(PhaseSamplerTest, TextNamesTheLargestFirst) {
  PhaseTimes times;
  EXPECT_EQ(times.Text(), "");
  times.seconds[static_cast<std::size_t>(Phase::kPhysics)] = 1;
  times.seconds[static_cast<std::size_t>(Phase::kTraining)] = 3;
  EXPECT_EQ(times.Text(), "training 75.0 %, physics 25.0 %, of 4.0 thread seconds");
}

}  // namespace
}  // namespace ed3r::schedule
