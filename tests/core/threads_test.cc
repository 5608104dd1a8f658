#include "engine/core/threads.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <thread>

namespace ed3r {
namespace {

TEST(ThreadsTest, AsManyThreadsCanBeMadeAsAreAskedWhereTheMachineHasThem) {
  EXPECT_EQ(PossibleThreads(1), 1);
  EXPECT_EQ(PossibleThreads(5), 5);
}

TEST(ThreadsTest, ARegionRunsOnTheCallingThread) {
  for (const int threads : {1, 3, 2, 3}) {
    std::thread::id here;
    WithTeam(threads, [&] { here = std::this_thread::get_id(); });
    EXPECT_EQ(here, std::this_thread::get_id()) << threads;
  }
}

// The team of the parent is not in it.
TEST(ThreadsTest, InAForkedProcessARegionThatHadATeamRunsOnAnotherThread) {
  const auto is_elsewhere = [](int threads) {
    std::thread::id there;
    WithTeam(threads, [&] { there = std::this_thread::get_id(); });
    return there != std::this_thread::get_id();
  };
  WithTeam(2, [] {});
  EXPECT_EXIT(_exit(is_elsewhere(2) && is_elsewhere(3) && is_elsewhere(1) ? 0 : 1),
              ::testing::ExitedWithCode(0), "");
}

TEST(ThreadsTest, WhatARegionThrowsComesThrough) {
  const auto refuse = [] { WithTeam(2, [] { throw 7; }); };
  EXPECT_THROW(refuse(), int);
  EXPECT_EXIT(
      {
        try {
          refuse();
        } catch (int seven) {
          _exit(seven);
        }
      },
      ::testing::ExitedWithCode(7), "");
}

}  // namespace
}  // namespace ed3r
