#include "engine/agents/region_memory.h"

#include <gtest/gtest.h>

namespace ed3r::agents {
namespace {

using Eigen::Vector3d;

// 9 x 9 x 3 cubes of 60 m.
RegionMemory PaperRegions() { return {AgentsConfig(), Vector3d(530, 530, 165)}; }

void VisitOften(RegionMemory& memory, const Vector3d& position_m, double scs, int times) {
  for (int i = 0; i < times; ++i) memory.Visit(position_m, scs);
}

TEST(RegionMemoryTest, MoreThanTwentyFruitlessVisitsAreStuck) {
  RegionMemory memory = PaperRegions();
  const Vector3d here(30, 30, 30);
  VisitOften(memory, here, 0.0, 20);
  EXPECT_FALSE(memory.Stuck(here));
  memory.Visit(Vector3d(59, 59, 59), 0.0);  // the same cube
  EXPECT_TRUE(memory.Stuck(here));
  EXPECT_FALSE(memory.Stuck(Vector3d(61, 30, 30)));  // the next cube
}

TEST(RegionMemoryTest, AnyConfidenceMakesACubeInformative) {
  RegionMemory memory = PaperRegions();
  const Vector3d here(30, 30, 30);
  VisitOften(memory, here, 0.0, 40);
  memory.Visit(here, 0.1);
  EXPECT_FALSE(memory.Stuck(here));
}

TEST(RegionMemoryTest, TheMostPromisingReachableCubeComesFirst) {
  RegionMemory memory = PaperRegions();
  VisitOften(memory, {30, 30, 30}, 0.0, 21);
  memory.Visit({90, 30, 30}, 0.3);
  memory.Visit({30, 90, 30}, 0.6);
  memory.Visit({300, 300, 30}, 0.9);  // better, but out of reach
  const std::vector<Vector3d> ends = {{30, 30, 30}, {70, 30, 30}, {30, 70, 30}, {30, 30, 70}, {40, 65, 10}};
  const RegionMemory::Selection selection = memory.Select(ends);
  EXPECT_EQ(selection.rule, MotionRule::kRegionPromising);
  EXPECT_EQ(selection.candidates, (std::vector<int>{2, 4}));
}

TEST(RegionMemoryTest, ThenTheUnexplored) {
  RegionMemory memory = PaperRegions();
  VisitOften(memory, {30, 30, 30}, 0.0, 21);
  memory.Visit({90, 30, 30}, 0.0);
  const std::vector<Vector3d> ends = {{30, 30, 30}, {70, 30, 30}, {30, 70, 30}};
  const RegionMemory::Selection selection = memory.Select(ends);
  EXPECT_EQ(selection.rule, MotionRule::kRegionUnexplored);
  EXPECT_EQ(selection.candidates, (std::vector<int>{2}));
}

TEST(RegionMemoryTest, ElseTheCandidateThatGetsNearest) {
  RegionMemory memory = PaperRegions();
  VisitOften(memory, {30, 30, 30}, 0.0, 21);
  const std::vector<Vector3d> ends = {{10, 30, 30}, {50, 30, 30}, {45, 30, 30}};
  const RegionMemory::Selection selection = memory.Select(ends);
  EXPECT_EQ(selection.rule, MotionRule::kRegionNearest);
  EXPECT_EQ(selection.candidates, (std::vector<int>{1}));
}

TEST(RegionMemoryTest, WithNowhereToGoAllCandidatesCount) {
  AgentsConfig agents;
  agents.region_size_m = 500;
  RegionMemory memory(agents, Vector3d(400, 400, 165));  // one cube
  VisitOften(memory, {30, 30, 30}, 0.0, 21);
  const std::vector<Vector3d> ends = {{30, 30, 30}};
  EXPECT_TRUE(memory.Select(ends).candidates.empty());
}

}  // namespace
}  // namespace ed3r::agents
