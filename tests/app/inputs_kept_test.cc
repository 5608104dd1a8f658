// A command never writes over what it reads, however the file was named.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/app/command.h"

namespace ed3r::app {
namespace {

namespace fs = std::filesystem;

const std::string kSweeps = ED3R_SOURCE_DIR "/sweeps/";

class InputsKept : public testing::Test {
 protected:
  // `output` is `input` by this option; the input stays as it is and nothing appears beside it.
  void ExpectKept(const std::string& command, const std::string& option, const fs::path& output,
                  const fs::path& input) {
    const std::string before = ReadAll(input);
    const auto files = [&] {
      return std::distance(fs::directory_iterator(input.parent_path()), fs::directory_iterator());
    };
    const auto count = files();
    const CommandResult result = Ed3r(command);
    EXPECT_EQ(result.status, 2) << command;
    EXPECT_EQ(result.err, fmt::format("{}: '{}' is what this command reads; allowed: another place, so that "
                                      "'{}' stays\n",
                                      option, output.string(), input.string()));
    EXPECT_EQ(ReadAll(input), before);
    EXPECT_EQ(files(), count);
  }

  const ScratchFolder scratch_;
};

TEST_F(InputsKept, ByDetect) {
  const fs::path set = scratch_ / "set";
  ASSERT_EQ(
      Ed3r(fmt::format("frames --out {} --world {}worlds/training_b.yaml --views 4 --frames 1 --pictures 0",
                       set.string(), kSweeps))
          .status,
      0);
  for (const char* input : {"labels.csv", "frames.npy", "manifest.json"})
    ExpectKept(fmt::format("detect {0} --table {0}/{1}", set.string(), input), "--table", set / input,
               set / input);
  fs::create_symlink(set / "labels.csv", scratch_ / "link.csv");
  ExpectKept(fmt::format("detect {} --table {}", set.string(), (scratch_ / "link.csv").string()), "--table",
             scratch_ / "link.csv", set / "labels.csv");
  EXPECT_EQ(Ed3r(fmt::format("detect {0} --table {0}/scores.csv", set.string())).status, 0);
}

TEST_F(InputsKept, ByFit) {
  const std::string shipped = kSweeps + "data/flight/ardupilot_quad_log.csv",
                    folder = scratch_.Path().string();
  for (const char* name : {"flights.csv", "rows.csv"}) {
    const fs::path log = scratch_ / name;
    fs::copy_file(shipped, log);
    ExpectKept(fmt::format("fit {} --out {}", log.string(), folder), "--out", log, log);
    ExpectKept(fmt::format("fit {} --evaluate {} --out {}", shipped, log.string(), folder), "--out", log,
               log);
    fs::remove(log);
  }
  fs::copy_file(shipped, scratch_ / "log.csv");
  fs::create_hard_link(scratch_ / "log.csv", scratch_ / "rows.csv");
  ExpectKept(fmt::format("fit {}/log.csv --out {}", folder, folder), "--out", scratch_ / "rows.csv",
             scratch_ / "log.csv");
}

TEST_F(InputsKept, ByWorldAndStatus) {
  const fs::path world = scratch_ / "world.yaml", run = scratch_ / "run";
  std::ofstream(world) << "base: " << kSweeps << "worlds/paper.yaml\nname: mine\n";
  ExpectKept(fmt::format("world {0} --picture {0}", world.string()), "--picture", world, world);
  ASSERT_EQ(Ed3r(fmt::format("run {}rbs.yaml --missions 1 --quiet --out {}", kSweeps, run.string())).status,
            0);
  const fs::path store = run / "results.sqlite";
  ExpectKept(fmt::format("status {} --html {}", run.string(), store.string()), "--html", store, store);
}

}  // namespace
}  // namespace ed3r::app
