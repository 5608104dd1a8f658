// What a plan is refused for before anything flies, and files that change while they are read.
#include "engine/schedule/inputs.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>

#include "engine/core/check.h"
#include "engine/sweep/sweep_file.h"

namespace ed3r::schedule {
namespace {

namespace fs = std::filesystem;

class InputsTest : public ::testing::Test {
 protected:
  InputsTest() {
    std::string pattern = (fs::temp_directory_path() / "ed3r_inputs_XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
    fs::copy_file(ED3R_SOURCE_DIR "/scripts/trust_parts/tiny_world.yaml", folder_ / "world.yaml");
  }
  ~InputsTest() override { fs::remove_all(folder_); }

  sweep::SweepPlan Plan(const std::string& text) const {
    std::ofstream(folder_ / "x.yaml") << text;
    return sweep::LoadSweep((folder_ / "x.yaml").string());
  }
  template <class Action>
  std::string ErrorOf(const Action& action) const {
    try {
      action();
    } catch (const UserError& error) {
      return error.what();
    }
    return "";
  }

  fs::path folder_;
};

TEST_F(InputsTest, AFileThatChangesWhileItIsReadIsRefused) {
  const sweep::SweepPlan plan =
      Plan("name: x\nmissions: 2\nset: {strategy: rbs, mission.world: world.yaml}\n");
  const Inputs inputs(plan);
  EXPECT_EQ(inputs.Files(plan).files.size(), 1u);
  std::ofstream(folder_ / "world.yaml", std::ios::app) << "\n# changed\n";
  EXPECT_NE(ErrorOf([&] { inputs.Files(plan); }).find("world.yaml was changed while it was read"),
            std::string::npos);
}

// Which of them was meant is not known; the first was taken once.
TEST_F(InputsTest, TwoWarmupsOfOneStrategyAreRefused) {
  const std::string end = "  - {name: online, after: training, sweep: {strategy: [rbs, ed3r]}}\n";
  const std::string head = "name: x\nmissions: 12\nset: {mission.world: world.yaml}\nstages:\n";
  const auto refusal = [&](const std::string& stages) {
    return ErrorOf([&] { CheckPlan(Plan(head + stages + end)); });
  };
  EXPECT_NE(refusal("  - {name: w1, set: {strategy: random}}\n  - {name: w2, set: {strategy: random}}\n"
                    "  - {name: training, kind: train, after: [w1, w2]}\n")
                .find("could learn from arm warmup of stage w1 and from arm warmup of stage w2"),
            std::string::npos);
  EXPECT_NE(refusal("  - {name: w, set: {strategy: random}, sweep: {robot.mass_kg: [2, 3]}}\n"
                    "  - {name: training, kind: train, after: w}\n")
                .find("could learn from"),
            std::string::npos);
  EXPECT_EQ(refusal("  - {name: w, sweep: {strategy: [random, random-offload]}}\n"
                    "  - {name: training, kind: train, after: w}\n"),
            "");
}

}  // namespace
}  // namespace ed3r::schedule
