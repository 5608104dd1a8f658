// Both agents with networks: greedy choice, exploration, hovering, regions.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "engine/agents/features.h"
#include "engine/agents/remote_controller.h"
#include "engine/agents/robot_agent.h"
#include "engine/core/check.h"
#include "kernels/dense_net.h"

namespace ed3r::agents {
namespace {

// A network of the design with random weights: some function of its inputs.
rfnn::Model RandomModel(const rfnn::NetworkDesign& design, std::uint32_t seed) {
  rfnn::ModelData data;
  data.weights.resize(kernels::ParameterCount(rfnn::ShapeOf(design)));
  Stream stream(seed, 0, Purpose::kTraining);
  for (float& weight : data.weights) weight = static_cast<float>(0.2 * stream.Normal());
  data.scaling.input_mean.assign(design.features.size(), 0.0);
  data.scaling.input_sd.assign(design.features.size(), 10.0);
  return rfnn::Model(design, data);
}

class GreedyTest : public ::testing::Test {
 protected:
  AgentContext Context(std::string_view strategy, double epsilon) {
    return {config_, FindStrategy(strategy), {&rc_, &robot_}, {530, 530, 165}, 1, 2, epsilon};
  }
  RcView View() {
    RcView view;
    view.pose = {{250, 260, 60}, 0.3, 0.4};
    view.rc_distance_m = 50;
    return view;
  }

  Config config_;
  rfnn::Model rc_ = RandomModel(rfnn::kRcNetwork, 1);
  rfnn::Model robot_ = RandomModel(rfnn::kRobotNetwork, 2);
  rfnn::Model::Workspace workspace_;
};

TEST_F(GreedyTest, TheRcTakesTheBestOfItsCandidates) {
  RemoteController controller(Context("ed3r", 0.0));
  CandidateTrace trace;
  const MotionDecision decision = controller.ChooseMotion(View(), 1, &trace);
  EXPECT_EQ(decision.rule, MotionRule::kGreedy);
  ASSERT_EQ(trace.commands.size(), 1000u);
  for (std::size_t i = 0; i < trace.commands.size(); ++i) {
    const double reward = rc_.Predict(StateOf(View()), ActionOf(trace.commands[i]), workspace_);
    ASSERT_EQ(reward, trace.rewards[i]);
    ASSERT_LE(reward, decision.predicted_reward);
  }
  EXPECT_EQ(decision.predicted_reward, trace.rewards[static_cast<std::size_t>(trace.chosen)]);
}

TEST_F(GreedyTest, EpsilonOneExplores) {
  RemoteController controller(Context("ed3r", 1.0));
  const MotionDecision decision = controller.ChooseMotion(View(), 1);
  EXPECT_EQ(decision.rule, MotionRule::kRandom);
  EXPECT_FALSE(
      std::isnan(decision.predicted_reward));  // what the network says of a random command is recorded too
}

TEST_F(GreedyTest, EpsilonIsAShareOfTimesteps) {
  int explored = 0;
  for (std::uint32_t scenario = 0; scenario < 400; ++scenario) {
    AgentContext context = Context("ed3r", 0.25);
    context.scenario = scenario;
    RemoteController controller(context);
    explored += controller.ChooseMotion(View(), 1).rule == MotionRule::kRandom;
  }
  EXPECT_NEAR(explored, 100, 44);  // five standard deviations
}

TEST_F(GreedyTest, EpsilonDecaysPerMissionToItsFloor) {
  AgentsConfig agents;
  agents.epsilon_missions = 0;
  EXPECT_EQ(EpsilonOfMission(agents, 0), 1.0);
  EXPECT_NEAR(EpsilonOfMission(agents, 10), std::pow(0.95, 10), 1e-12);
  EXPECT_EQ(EpsilonOfMission(agents, 849), 0.01);
}

// A run of 56 missions explores as much as one of 850: what it measures does not hang on how many are flown.
TEST_F(GreedyTest, AnyMissionsInARowExploreAlike) {
  const AgentsConfig agents;
  std::multiset<double> phase, numbered;
  for (int i = 0; i < 850; ++i) {
    phase.insert(EpsilonOfMission(agents, 7000 + i));
    AgentsConfig in_order;
    in_order.epsilon_missions = 0;
    numbered.insert(EpsilonOfMission(in_order, i));
  }
  EXPECT_EQ(phase, numbered) << "each mission of the online phase once";
  for (int first = 0; first < 850; ++first) {
    int early = 0;  // of the first 85, a tenth
    for (int i = first; i < first + 50; ++i) early += EpsilonOfMission(agents, i) > std::pow(0.95, 84.5);
    EXPECT_GE(early, 4) << first;
    EXPECT_LE(early, 6) << first;
  }
  AgentsConfig one;
  one.epsilon_missions = 1;
  EXPECT_EQ(EpsilonOfMission(one, 5), 1.0);
}

TEST_F(GreedyTest, ARandomWalkIsAllExploration) {
  EXPECT_EQ(RemoteController(Context("rbs", 0.01)).ChooseMotion(View(), 1).epsilon, 1.0);
}

// A command from outside takes the strategy's place where the Algorithm leaves the choice, cut to the ranges.
TEST_F(GreedyTest, ACommandFromOutsideIsCutToTheRanges) {
  RemoteController controller(Context("external", 0.0));
  RcView view = View();
  EXPECT_FALSE(controller.Observe(view, 1).hover);
  const MotionDecision first =
      controller.Take(view, {.displacement_m = {100, -3, 2}, .turn_rad = -9, .tilt_rad = 0.1});
  EXPECT_EQ(first.rule, MotionRule::kOutside);
  EXPECT_EQ(first.command.displacement_m, Eigen::Vector3d(20, -3, 2));
  EXPECT_NEAR(first.command.turn_rad, -1.5707963267948966, 1e-15);
  EXPECT_EQ(first.command.tilt_rad, 0.1);
  EXPECT_THROW(controller.Take(view, {.turn_rad = NAN}), UserError);
  EXPECT_THROW(controller.ChooseMotion(view, 2), InternalError);  // nobody inside decides

  view.previous_scs = 0.9;
  EXPECT_TRUE(controller.Observe(view, 3).hover);
  EXPECT_TRUE(controller.Take(view, {.displacement_m = {5, 5, 5}}).command.hover);
  EXPECT_TRUE(controller.Observe(view, 4).complete);
}

TEST_F(GreedyTest, AReliableDetectionHovers) {
  RemoteController controller(Context("ed3r", 0.0));
  RcView view = View();
  controller.ChooseMotion(view, 1);
  view.previous_scs = 0.9;
  const MotionDecision decision = controller.ChooseMotion(view, 2);
  EXPECT_EQ(decision.rule, MotionRule::kHover);
  EXPECT_TRUE(decision.command.hover);
  EXPECT_EQ(decision.command.displacement_m.norm(), 0.0);
  EXPECT_EQ(decision.command.tilt_rad, view.pose.tilt_rad);
  EXPECT_TRUE(controller.ChooseMotion(view, 3).complete);
}

TEST_F(GreedyTest, StuckInARegionItLeaves) {
  RemoteController controller(Context("ed3r", 0.0));
  RcView view = View();
  view.pose.position_m = {235, 270, 55};  // 5 m from the next cubes in x and z
  for (std::uint32_t k = 1; k <= 21; ++k)
    EXPECT_EQ(controller.ChooseMotion(view, k).rule, MotionRule::kGreedy);
  const MotionDecision decision = controller.ChooseMotion(view, 22);  // the 21st visit counted
  EXPECT_EQ(decision.rule, MotionRule::kRegionUnexplored);
  const Eigen::Vector3d end_m = view.pose.position_m + decision.command.displacement_m;
  const auto cube = [](const Eigen::Vector3d& p) { return (p / 60.0).array().floor().matrix().eval(); };
  EXPECT_NE(cube(end_m), cube(view.pose.position_m));

  config_.agents.region_avoidance = false;
  RemoteController careless(Context("ed3r", 0.0));
  for (std::uint32_t k = 1; k <= 30; ++k) EXPECT_EQ(careless.ChooseMotion(view, k).rule, MotionRule::kGreedy);
}

TEST_F(GreedyTest, TheRobotTakesTheBestAllowedAction) {
  RobotView view;
  view.bandwidth_hz = 20;
  view.rate_bps = 30;
  for (const char* name : {"ed3r", "ablation-3"}) {
    RobotAgent robot(Context(name, 0.0));
    const std::array<double, 3> rewards = robot.PredictAll(view);
    const ExecutionDecision decision = robot.ChooseExecution(view, 0.0, 1);
    EXPECT_FALSE(decision.random);
    for (const Execution execution : {Execution::kOffload, Execution::kFull, Execution::kQuantized}) {
      if (FindStrategy(name).execution.allowed.Allows(execution)) {
        EXPECT_LE(rewards[static_cast<std::size_t>(execution)], decision.predicted_reward) << name;
      }
    }
    EXPECT_TRUE(FindStrategy(name).execution.allowed.Allows(decision.execution));
  }
}

TEST_F(GreedyTest, FixedExecutionsAskNoNetwork) {
  AgentContext context = Context("ablation-2", 1.0);
  context.networks.robot = nullptr;
  RobotAgent robot(context);
  const ExecutionDecision decision = robot.ChooseExecution(RobotView(), 1.0, 1);
  EXPECT_EQ(decision.execution, Execution::kQuantized);
  EXPECT_FALSE(decision.random);
  EXPECT_TRUE(std::isnan(decision.predicted_reward));
}

TEST_F(GreedyTest, MissingNetworksAreAnInternalError) {
  AgentContext context = Context("ed3r", 0.0);
  context.networks = {};
  EXPECT_THROW(RemoteController{context}, InternalError);
  EXPECT_THROW(RobotAgent{context}, InternalError);
}

}  // namespace
}  // namespace ed3r::agents
