// Missions that look at pixels, as users fly them.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/app/command.h"

namespace ed3r::app {
namespace {

namespace fs = std::filesystem;

const std::string kRun =
    "run " ED3R_SOURCE_DIR "/sweeps/rbs.yaml --quiet --missions 3 --set perception.tier=pixels";

std::string Digest(const fs::path& dir) {
  const CommandResult result = Ed3r("digest " + dir.string());
  EXPECT_EQ(result.status, 0) << result.err;
  return result.out;
}

TEST(PixelsTest, ThreadsAndRepetitionDoNotShow) {
  const ScratchFolder scratch;
  for (const char* name : {"one", "again"})
    ASSERT_EQ(Ed3r(fmt::format("{} --threads 1 --out {}", kRun, (scratch / name).string())).status, 0);
  ASSERT_EQ(Ed3r(fmt::format("{} --threads 2 --out {}", kRun, (scratch / "two").string())).status, 0);
  EXPECT_EQ(Digest(scratch / "again"), Digest(scratch / "one"));
  EXPECT_EQ(Digest(scratch / "two"), Digest(scratch / "one"));
}

TEST(PixelsTest, ReplayFliesTheSameAndWritesWhatTheCameraSaw) {
  const ScratchFolder scratch;
  const std::string dir = (scratch / "run").string();
  ASSERT_EQ(Ed3r(fmt::format("{} --out {}", kRun, dir)).status, 0);
  const CommandResult replay = Ed3r(fmt::format("replay {} rbs/1 --frames 1,2", dir));
  EXPECT_EQ(replay.status, 0) << replay.err;
  EXPECT_NE(replay.out.find("identical to the stored record"), std::string::npos) << replay.out;
  EXPECT_EQ(replay.out.find("pictures only"), std::string::npos) << "the mission looked at these";
  for (const char* picture : {"step001_frames.png", "step001_large.png", "step002_frames.png"})
    EXPECT_GT(fs::file_size(scratch / "run/replay/rbs-1" / picture), 10000u) << picture;
  const CommandResult beyond = Ed3r(fmt::format("replay {} rbs/1 --frames 4000", dir));
  EXPECT_EQ(beyond.status, 2);
  EXPECT_NE(beyond.err.find("--frames 4000: is not allowed; the mission has timesteps 1 .. "),
            std::string::npos)
      << beyond.err;
}

TEST(PixelsTest, AProfileIsFittedToOneWayToLook) {
  const ScratchFolder scratch;
  std::ofstream(scratch / "mixed.yaml")
      << "name: mixed\nmissions: 1\nset: {strategy: rbs, robot.battery_mah: 400, perception.tier: pixels, "
         "mission.world: " ED3R_SOURCE_DIR
         "/sweeps/worlds/ridges.yaml}\n"
         "sweep: {perception.render.noise: [0, 40]}\n";
  const std::string out = (scratch / "run").string();
  ASSERT_EQ(Ed3r(fmt::format("run {} --quiet --out {}", (scratch / "mixed.yaml").string(), out)).status, 0);
  const CommandResult fit = Ed3r("fit --perception " + out);
  EXPECT_EQ(fit.status, 2);
  EXPECT_NE(fit.err.find("do not look alike (perception.render.noise is 0 and 40)"), std::string::npos)
      << fit.err;
  EXPECT_EQ(std::count(fit.err.begin(), fit.err.end(), '\n'), 1) << fit.err;
}

TEST(PixelsTest, ADetectorThatIsNoneIsRefusedBeforeAnythingFlies) {
  const ScratchFolder scratch;
  const std::string out = (scratch / "run").string();
  const CommandResult missing =
      Ed3r(fmt::format("{} --set perception.detector.full=nowhere.onnx --out {}", kRun, out));
  EXPECT_EQ(missing.status, 2);
  EXPECT_NE(missing.err.find("nowhere.onnx"), std::string::npos) << missing.err;
  EXPECT_EQ(std::count(missing.err.begin(), missing.err.end(), '\n'), 1) << missing.err;
  EXPECT_FALSE(fs::exists(out));
}

}  // namespace
}  // namespace ed3r::app
