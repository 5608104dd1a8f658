// Sweeps whose networks come from files.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>

#include "engine/core/check.h"
#include "engine/core/files/file.h"
#include "engine/core/random.h"
#include "engine/schedule/sweep_runner.h"
#include "engine/store/digest.h"
#include "engine/store/reader.h"
#include "engine/sweep/sweep_file.h"

namespace ed3r::schedule {
namespace {

namespace fs = std::filesystem;

rfnn::Model RandomModel(const rfnn::NetworkDesign& design) {
  rfnn::ModelData data;
  data.weights.resize(kernels::ParameterCount(rfnn::ShapeOf(design)));
  Stream stream(4, 0, Purpose::kTraining);
  for (float& weight : data.weights) weight = static_cast<float>(0.2 * stream.Normal());
  data.scaling.input_mean.assign(design.features.size(), 0.1);
  data.scaling.input_sd.assign(design.features.size(), 11.3);
  return rfnn::Model(design, data);
}

class OwnNetworksTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("ed3r_own_networks_" + std::to_string(getpid()));
    fs::create_directories(folder_);
    WriteFile(folder_ / "rc.onnx", rfnn::OnnxBytes(rc_));
    WriteFile(folder_ / "robot.onnx", rfnn::OnnxBytes(robot_));
  }
  void TearDown() override { fs::remove_all(folder_); }

  sweep::SweepPlan Plan(const std::string& set) const {
    WriteFile(folder_ / "own.yaml",
              "# own\nname: own\nmissions: 3\nseed: 8\nset: {mission.world: " ED3R_SOURCE_DIR
              "/sweeps/worlds/paper.yaml, robot.battery_mah: 900, agents.candidates: 50, "
              "agents.epsilon_decay: 0.1, " +
                  set + "}\n");
    return sweep::LoadSweep((folder_ / "own.yaml").string());
  }

  std::string RefusalOf(const std::string& set) const {
    try {
      const Inputs inputs(Plan(set));
    } catch (const UserError& error) {
      return error.what();
    }
    return "accepted";
  }

  fs::path folder_;
  rfnn::Model rc_ = RandomModel(rfnn::kRcNetwork);
  rfnn::Model robot_ = RandomModel(rfnn::kRobotNetwork);
};

TEST_F(OwnNetworksTest, TheyFlyAsTheNetworksThatWereExported) {
  const sweep::SweepPlan plan = Plan("strategy: ed3r, networks: {rc: rc.onnx, robot: robot.onnx}");
  EXPECT_FALSE(NeedsNetworks(plan));
  const Inputs inputs(plan);
  SweepOptions options;
  options.dir = (folder_ / "run").string();
  options.cache_dir = (folder_ / "cache").string();
  options.schedule.quiet = true;
  EXPECT_EQ(RunSweep(plan, inputs, options).flown.stored, 3);

  store::ResultReader reader(options.dir);
  EXPECT_TRUE(reader.StoredRecipe().inputs.contains("network rc.onnx"));
  bool greedy = false;
  for (int mission = 0; mission < 3; ++mission) {
    const store::StoredMission stored = reader.LoadMission({0, 0, mission});
    mission::MissionTask task = TaskOf(plan, inputs, nullptr, {0, 0, mission});
    EXPECT_NE(task.networks.rc, nullptr);
    task.networks.rc = &rc_, task.networks.robot = &robot_;
    EXPECT_EQ(store::DigestOf(mission::FlyMission(task)), store::DigestOf(stored.record));
    for (const mission::TimestepRecord& step : stored.record.steps)
      greedy = greedy || step.motion_rule == static_cast<std::int64_t>(agents::MotionRule::kGreedy);
  }
  EXPECT_TRUE(greedy);
}

TEST_F(OwnNetworksTest, WhatIsMissingIsSaid) {
  EXPECT_EQ(RefusalOf("strategy: ablation-2, networks.rc: rc.onnx"), "accepted");  // its robot has no choice
  const std::string no_robot = RefusalOf("strategy: ed3r, networks.rc: rc.onnx");
  EXPECT_NE(no_robot.find(
                "has networks.rc from a file, but strategy ed3r asks the robot's network too, and "
                "nothing trains it; allowed: networks.robot: FILE.onnx, a strategy that asks no such "
                "network (ablation-1 | ablation-2 | ablation-4), or, before this stage, a training stage"),
            std::string::npos)
      << no_robot;
  const std::string no_rc = RefusalOf("strategy: ed3r, networks.robot: robot.onnx");
  EXPECT_NE(
      no_rc.find(
          "asks the RC's network too, and nothing trains it; allowed: networks.rc: FILE.onnx, or, before"),
      std::string::npos)
      << no_rc;
  const std::string neither = RefusalOf("strategy: ed3r");
  EXPECT_NE(neither.find("asks networks, so the stage must come after a training stage"), std::string::npos);
  EXPECT_NE(neither.find("or give networks.rc and networks.robot"), std::string::npos) << neither;
  EXPECT_NE(RefusalOf("strategy: ablation-2").find("or give networks.rc"), std::string::npos);
  EXPECT_NE(RefusalOf("strategy: rbs, networks.rc: rc.onnx").find("strategy rbs asks no such network"),
            std::string::npos);
  const std::string refusal = RefusalOf("strategy: ablation-2, networks.rc: robot.onnx");
  EXPECT_NE(refusal.find("takes 11 values; allowed: 13"), std::string::npos) << refusal;
  EXPECT_NE(RefusalOf("strategy: ablation-2, networks.rc: none.onnx").find("'trained' is allowed too"),
            std::string::npos);
}

// A network that decides: turns by 0.6 rad and looks 0.1 rad down, whatever it sees; on board it likes Full least and
// offloading most.
TEST_F(OwnNetworksTest, TheyMayDecideThemselves) {
  const auto constant = [](std::int64_t inputs, std::vector<float> values) {
    const auto outputs = static_cast<std::int64_t>(values.size());
    const rfnn::OnnxTensor weights{{inputs, outputs},
                                   std::vector<float>(static_cast<std::size_t>(inputs * outputs))};
    return rfnn::DenseChain{{}, {}, {weights}, {{{outputs}, std::move(values)}}};
  };
  WriteFile(folder_ / "turn.onnx",
            rfnn::OnnxBytes(constant(8, {0, 0, 0, 0.6F, 0.1F}), "turn", rfnn::kRcNetwork));
  WriteFile(folder_ / "liked.onnx", rfnn::OnnxBytes(constant(9, {3, 1, 2}), "liked", rfnn::kRobotNetwork));
  for (const auto& [strategy, execution] : {std::pair{"ed3r", agents::Execution::kOffload},
                                            std::pair{"ablation-3", agents::Execution::kQuantized}}) {
    const sweep::SweepPlan plan =
        Plan(std::string("strategy: ") + strategy + ", networks: {rc: turn.onnx, robot: liked.onnx}");
    EXPECT_FALSE(NeedsNetworks(plan));
    const Inputs inputs(plan);
    EXPECT_TRUE(inputs.Fingerprints(plan).contains("network turn.onnx"));
    const mission::MissionRecord record = mission::FlyMission(TaskOf(plan, inputs, nullptr, {0, 0, 0}));
    int commanded = 0;
    for (const mission::TimestepRecord& step : record.steps) {
      EXPECT_EQ(step.execution, static_cast<std::int64_t>(execution));
      if (step.motion_rule != static_cast<std::int64_t>(agents::MotionRule::kCommanded)) continue;
      ++commanded;
      EXPECT_EQ(step.command_dx_m, 0.0);
      EXPECT_EQ(step.epsilon, 0.0);
      EXPECT_TRUE(std::isnan(step.rc_predicted_reward));
      EXPECT_LE(step.command_turn_rad, static_cast<double>(0.6F));
    }
    EXPECT_GT(commanded, 0);
    EXPECT_EQ(record.steps.front().command_turn_rad, static_cast<double>(0.6F));
    EXPECT_EQ(record.steps.front().command_tilt_rad, static_cast<double>(0.1F));
  }
  const std::string refusal = RefusalOf("strategy: ablation-2, networks.rc: liked.onnx");
  EXPECT_NE(refusal.find("networks.rc: "), std::string::npos) << refusal;
  EXPECT_NE(refusal.find("takes 9 values; allowed: 13 (it scores an action) or 8 (it decides)"),
            std::string::npos)
      << refusal;
}

// Arms of strategy external are flown by a program alone.
TEST_F(OwnNetworksTest, DecisionsFromOutsideNeedAProgram) {
  const sweep::SweepPlan plan = Plan("strategy: external");
  const Inputs inputs(plan);
  SweepOptions options;
  options.dir = (folder_ / "outside").string();
  EXPECT_THROW(RunSweep(plan, inputs, options), UserError);
  EXPECT_FALSE(fs::exists(options.dir));
}

}  // namespace
}  // namespace ed3r::schedule
