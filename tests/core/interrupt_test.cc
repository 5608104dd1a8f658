#include "engine/core/interrupt.h"

#include <gtest/gtest.h>

#include <csignal>

namespace ed3r {
namespace {

TEST(InterruptTest, ASignalSetsTheFlagOnceAndTheNextOneEndsTheProcess) {
  for (const int signal : {SIGINT, SIGTERM}) {
    InterruptFlag() = false;
    InstallInterruptHandler();
    EXPECT_FALSE(InterruptFlag());
    std::raise(signal);
    EXPECT_TRUE(InterruptFlag());
    EXPECT_EXIT(std::raise(signal), ::testing::KilledBySignal(signal), "");
    std::signal(SIGINT, SIG_DFL);
    std::signal(SIGTERM, SIG_DFL);
  }
  InterruptFlag() = false;
}

TEST(InterruptTest, BeforeThereIsWorkASignalEndsTheProcessWithALineAndAStatus) {
  for (const int signal : {SIGINT, SIGTERM})
    EXPECT_EXIT(
        {
          EndOnInterrupt(130);
          std::raise(signal);
        },
        ::testing::ExitedWithCode(130), "^ed3r: interrupted\n$");
}

}  // namespace
}  // namespace ed3r
