#include "engine/rfnn/features.h"

#include <gtest/gtest.h>

#include <set>

#include "engine/rfnn/model.h"

namespace ed3r::rfnn {
namespace {

TEST(FeaturesTest, DesignsAreThePapers) {
  EXPECT_EQ(kRcNetwork.inputs(), 13);
  EXPECT_EQ(kRcNetwork.states, 8);
  EXPECT_EQ(kRobotNetwork.inputs(), 11);
  EXPECT_EQ(kRobotNetwork.states, 9);
  EXPECT_EQ(kernels::ParameterCount(ShapeOf(kRcNetwork)), 14u * 128 + 129 * 64 + 65 * 64 + 65 * 32 + 33);
  EXPECT_EQ(kernels::ParameterCount(ShapeOf(kRobotNetwork)), 12u * 128 + 129 * 64 + 65 * 32 + 33);
}

TEST(FeaturesTest, NamesStandWhereTheirColumnsAre) {
  EXPECT_EQ(kRcFeatures[kRcYaw], "yaw_rad");
  EXPECT_EQ(kRcFeatures[kRcPreviousEnergy], "previous_energy_j");
  EXPECT_EQ(kRcFeatures[kRcMoveX], "dx_m");
  EXPECT_EQ(kRcFeatures[kRcTiltCommand], "tilt_command_rad");
  EXPECT_EQ(kRobotFeatures[kRobotRate], "rate_bps");
  EXPECT_EQ(kRobotFeatures[kRobotPreviousEnergy], "previous_energy_j");
  EXPECT_EQ(kRobotFeatures[kRobotOffload], "offload");
  EXPECT_EQ(kRobotFeatures[kRobotQuantized], "quantized");
  for (const NetworkDesign& design : {kRcNetwork, kRobotNetwork}) {
    const std::set<std::string_view> names(design.features.begin(), design.features.end());
    EXPECT_EQ(names.size(), design.features.size());
    EXPECT_FALSE(names.contains(""));
  }
}

}  // namespace
}  // namespace ed3r::rfnn
