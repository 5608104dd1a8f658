#include "engine/robot/power/power_models.h"

#include <gtest/gtest.h>

#include <cmath>

namespace ed3r::fit {
namespace {

const robot::Air kAir{.density_kgm3 = 1.225, .gravity_mps2 = 9.8};

robot::PaperPower<> PaperAt(VerticalForm form, double vertical_mps = 5.0) {
  return robot::PaperPowersW(robot::PaperParameters<>{}, robot::MakeRotorcraft(RobotConfig{}), kAir, 5.0,
                             vertical_mps, HoverForm::kPhysical, form);
}

TEST(PaperPowerTest, GivesTheReadingsFigures) {
  const robot::PaperPower<> power = PaperAt(VerticalForm::kPrinted);
  EXPECT_NEAR(power.hover_w, 135.3, 0.05);                       // R1
  EXPECT_NEAR(power.horizontal_w - power.hover_w, 4.55, 0.005);  // R2
  EXPECT_NEAR(power.ascent_w, 23.7, 0.05);                       // R3
  EXPECT_NEAR(power.descent_w, 11.9, 0.05);
  EXPECT_NEAR(robot::PaperHoverW(robot::MakeRotorcraft(RobotConfig{}), kAir, HoverForm::kPrinted), 5.2, 0.05);
}

TEST(PaperPowerTest, KnowsTheOtherVerticalForms) {
  const double climb_w = 1.816 * 9.8 * 5.0;
  const robot::PaperPower<> climb = PaperAt(VerticalForm::kClimb);
  EXPECT_NEAR(climb.ascent_w, climb.hover_w + climb_w, 1e-9);
  EXPECT_NEAR(climb.descent_w, climb.hover_w - climb_w, 1e-9);
  EXPECT_EQ(PaperAt(VerticalForm::kClimb, 20.0).descent_w, 0.0) << "a descent never charges the battery";
  EXPECT_NEAR(PaperAt(VerticalForm::kMgv).ascent_w, climb_w + 5.9, 0.05);
}

TEST(PaperPowerTest, EfficiencyDividesEveryPower) {
  robot::PaperParameters<> half;
  half.efficiency = 0.5;
  const robot::PaperPower<> at_half =
      robot::PaperPowersW(half, robot::MakeRotorcraft(RobotConfig{}), kAir, 5.0, 5.0, HoverForm::kPhysical,
                          VerticalForm::kPrinted);
  const robot::PaperPower<> at_one = PaperAt(VerticalForm::kPrinted);
  EXPECT_DOUBLE_EQ(at_half.hover_w, 2.0 * at_one.hover_w);
  EXPECT_DOUBLE_EQ(at_half.horizontal_w, 2.0 * at_one.horizontal_w);
  EXPECT_DOUBLE_EQ(at_half.ascent_w, 2.0 * at_one.ascent_w);
  EXPECT_DOUBLE_EQ(at_half.descent_w, 2.0 * at_one.descent_w);
}

TEST(InducedVelocityTest, SolvesGlauertsEquationEverywhere) {
  const double hover = 6.4, square = hover * hover;
  for (int i = 0; i <= 100; ++i) {
    for (int j = 0; j <= 100; ++j) {
      const double across = 0.4 * i, axial = -hover + 0.3 * j;
      const double v = robot::InducedVelocityMps(axial, across, square);
      ASSERT_GT(v, 0.0);
      ASSERT_NEAR(v * std::sqrt(across * across + (axial + v) * (axial + v)), square, 1e-11 * square)
          << "across " << across << ", axial " << axial;
    }
  }
}

TEST(InducedVelocityTest, HasTheKnownLimits) {
  EXPECT_DOUBLE_EQ(robot::InducedVelocityMps(0.0, 0.0, 36.0), 6.0);  // hover
  EXPECT_NEAR(robot::InducedVelocityMps(4.0, 0.0, 36.0), -2.0 + std::sqrt(4.0 + 36.0), 1e-12);
  EXPECT_NEAR(robot::InducedVelocityMps(0.0, 60.0, 36.0), 0.6, 1e-4);  // fast forward flight: h^2 / V
}

class MomentumPowerTest : public ::testing::Test {
 protected:
  robot::MomentumPower<> At(double horizontal_mps, double climb_mps) const {
    return robot::MomentumPowersW(parameters_, kMassKg, horizontal_mps, climb_mps, kAir, kDiscM2);
  }

  static constexpr double kMassKg = 3.68;
  static constexpr double kDiscM2 = 0.363;
  robot::MomentumParameters<> parameters_;
};

TEST_F(MomentumPowerTest, HoverIsThePapersFormTimesAConstant) {
  for (const double mass : {1.0, 3.68, 8.0}) {
    const double factor = (parameters_.induced_factor + parameters_.profile_share) / parameters_.efficiency;
    EXPECT_NEAR(robot::MomentumPowerW(parameters_, mass, 0.0, 0.0, kAir, kDiscM2),
                factor * robot::IdealHoverPowerW(mass, kAir.density_kgm3, kAir.gravity_mps2, kDiscM2), 1e-9);
  }
}

TEST_F(MomentumPowerTest, SlowCruiseIsCheaperThanHoverAndFastCruiseDearer) {
  EXPECT_LT(At(8.0, 0.0).TotalW(), At(0.0, 0.0).TotalW());
  EXPECT_GT(At(25.0, 0.0).TotalW(), At(0.0, 0.0).TotalW());
}

TEST_F(MomentumPowerTest, InterferenceActsInForwardFlightOnly) {
  const double hover = At(0.0, 0.0).TotalW(), climb = At(0.0, 3.0).TotalW(), cruise = At(8.0, 0.0).TotalW();
  parameters_.interference = 0.0;
  EXPECT_EQ(At(0.0, 0.0).TotalW(), hover);
  EXPECT_EQ(At(0.0, 3.0).TotalW(), climb);
  EXPECT_LT(At(8.0, 0.0).TotalW(), cruise);
}

TEST_F(MomentumPowerTest, PaysForWorkAgainstGravity) {
  EXPECT_NEAR(At(5.0, 3.0).climb_w, kMassKg * kAir.gravity_mps2 * 3.0 / parameters_.efficiency, 1e-9);
  EXPECT_NEAR(At(5.0, -3.0).climb_w, -kMassKg * kAir.gravity_mps2 * 3.0 / parameters_.efficiency, 1e-9);
  EXPECT_NEAR(At(10.0, 0.0).parasite_w,
              0.5 * kAir.density_kgm3 * parameters_.drag_area_m2 * 1000.0 / parameters_.efficiency, 1e-9);
}

TEST_F(MomentumPowerTest, IsFiniteNonNegativeAndContinuousInAnyFlight) {
  for (int i = 0; i <= 60; ++i) {
    double before = At(0.5 * i, 15.0).TotalW();
    for (int j = 1; j <= 3000; ++j) {
      const double power = At(0.5 * i, 15.0 - 0.01 * j).TotalW();
      ASSERT_TRUE(std::isfinite(power) && power >= 0.0) << i << " " << j;
      ASSERT_LT(std::abs(power - before), 3.0) << "jump at " << 0.5 * i << " m/s, climb " << 15.0 - 0.01 * j;
      before = power;
    }
  }
}

}  // namespace
}  // namespace ed3r::fit
