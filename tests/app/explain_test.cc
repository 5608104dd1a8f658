// A stored mission looked at again: what 'ed3r explain' and 'ed3r replay' say and write.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/app/command.h"

namespace ed3r {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

void Fly(const std::string& sweep, const std::string& arguments, const fs::path& dir) {
  const CommandResult result = Ed3r(
      fmt::format("run " ED3R_SOURCE_DIR "/sweeps/{} {} --quiet --out {}", sweep, arguments, dir.string()));
  ASSERT_EQ(result.status, 0) << result.err;
}

// One small run for all tests that only read it.
class ExplainTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    scratch_ = new ScratchFolder;
    Fly("rbs.yaml", "--missions 4", *scratch_ / "run");
  }
  static void TearDownTestSuite() { delete scratch_; }

  static std::string Dir() { return (*scratch_ / "run").string(); }

  static void ExpectRefusal(const std::string& arguments, const std::string& message) {
    const CommandResult result = Ed3r(arguments);
    EXPECT_EQ(result.status, 2) << arguments;
    EXPECT_EQ(result.err, message + "\n") << arguments;
    EXPECT_EQ(result.out, "") << arguments;
  }

 private:
  static ScratchFolder* scratch_;
};

ScratchFolder* ExplainTest::scratch_ = nullptr;

bool Contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST_F(ExplainTest, AMistypedArmIsAnsweredWithTheNearest) {
  const std::string explain = "explain --step 1 " + Dir() + " ";
  ExpectRefusal(explain + "rsb/1", "rsb/1: no arm rsb; did you mean rbs?");
  ExpectRefusal(explain + "online/rsb/1", "online/rsb/1: no arm online/rsb; did you mean online/rbs?");
  ExpectRefusal(explain + "aardvark/1", "aardvark/1: no arm aardvark; the arms are online/rbs");
  ExpectRefusal(explain + "rbs", "rbs: expected ARM/NUMBER; the arms are online/rbs");
  ExpectRefusal(explain + "rsb/x", "rsb/x: expected ARM/NUMBER; the arms are online/rbs");
  ExpectRefusal(explain + "rbs/4", "rbs/4: mission numbers of rbs are 0 .. 3");
  for (const char* command : {"explain", "replay"})
    EXPECT_TRUE(Contains(Ed3r(fmt::format("{} --help", command)).out, "missions count from 0")) << command;
  EXPECT_TRUE(Contains(Ed3r("explain --help").out, "timesteps count from 1"));
}

}  // namespace
}  // namespace ed3r
