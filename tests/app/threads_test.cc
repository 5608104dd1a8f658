// A machine that gives no more threads: what can go on with fewer goes on, the rest ends in one line.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/app/command.h"

namespace ed3r::app {
namespace {

const std::string kRbs = ED3R_SOURCE_DIR "/sweeps/rbs.yaml --set robot.battery_mah=150 --missions 4 --quiet";
const std::string kNone =
    "ed3r: failed inside: a thread cannot be made, see ulimit -u: "
    "Resource temporarily unavailable\n";

// With so many threads beside the first.
CommandResult With(int threads, const std::string& arguments) {
  return Ed3r(arguments, fmt::format("ASAN_OPTIONS=verify_asan_link_order=0 LD_PRELOAD={} SHIM_THREADS={}",
                                     ED3R_THREAD_SHIM, threads));
}

class ThreadsTest : public testing::Test {
 protected:
  std::string In(const std::string& name) const { return (scratch_ / name).string(); }
  ScratchFolder scratch_;
};

TEST_F(ThreadsTest, MergeReadsWithTheThreadsThatThereAre) {
  for (int shard : {1, 2})
    ASSERT_EQ(
        Ed3r(fmt::format("run {} --shard {}/2 --out {}", kRbs, shard, In(std::to_string(shard)))).status, 0);
  ASSERT_EQ(Ed3r(fmt::format("merge {} {} {}", In("two"), In("1"), In("2"))).status, 0);
  const CommandResult one = With(1, fmt::format("merge {} {} {}", In("one"), In("1"), In("2")));
  EXPECT_EQ(one.status, 0) << one.err;
  EXPECT_EQ(Ed3r("digest " + In("one")).out.substr(0, 64), Ed3r("digest " + In("two")).out.substr(0, 64));
  const CommandResult none = With(0, fmt::format("merge {} {} {}", In("none"), In("1"), In("2")));
  EXPECT_EQ(none.status, 1);
  EXPECT_EQ(none.err, kNone);
}

TEST_F(ThreadsTest, ARunTellsHowManyThereAre) {
  const std::string run = fmt::format("run {} --out {} --threads ", kRbs, In("run"));
  const CommandResult none = With(0, run + "1");
  EXPECT_EQ(none.status, 1);
  EXPECT_EQ(none.err, kNone);
  const CommandResult profile = With(0, run + "1 --profile");
  EXPECT_EQ(profile.err, kNone);
  EXPECT_FALSE(std::filesystem::exists(scratch_ / "run" / "results.sqlite")) << "it has not begun";
  // One of them stores.
  const CommandResult two = With(2, run + "3");
  EXPECT_EQ(two.status, 1);
  EXPECT_EQ(two.err,
            "ed3r: failed inside: 2 of 3 threads can be made, see ulimit -u or ask for fewer: "
            "Resource temporarily unavailable\n");
  const CommandResult enough = With(2, run + "2");
  EXPECT_EQ(enough.status, 0) << enough.err;
}

// The libraries that build worlds and draw pictures make none that they do not need.
TEST_F(ThreadsTest, WorldsAndReportsNeedOneThread) {
  const CommandResult world =
      With(0, "world " ED3R_SOURCE_DIR "/sweeps/worlds/training_a.yaml --picture " + In("map.png"));
  EXPECT_EQ(world.status, 0) << world.err;
  EXPECT_EQ(world.err, "");
  ASSERT_EQ(Ed3r(fmt::format("run {} --out {}", kRbs, In("run"))).status, 0);
  const CommandResult report = With(0, "report " + In("run"));
  EXPECT_EQ(report.status, 0) << report.err;
  EXPECT_EQ(report.err, Ed3r("report " + In("run")).err);
}

TEST_F(ThreadsTest, AFilmThatFFmpegCannotWriteIsToldInOneLine) {
  ASSERT_EQ(Ed3r(fmt::format("run {} --out {}", kRbs, In("run"))).status, 0);
  const CommandResult film =
      With(0, fmt::format("replay {} rbs/0 --out {} --video {}", In("run"), In("replay"), In("f.mp4")));
  EXPECT_EQ(film.status, 1);
  EXPECT_EQ(film.err.rfind("ed3r: failed inside: --video " + In("f.mp4") + ": 0 of ", 0), 0u) << film.err;
  EXPECT_EQ(film.err.find('\n'), film.err.size() - 1) << film.err;
}

}  // namespace
}  // namespace ed3r::app
