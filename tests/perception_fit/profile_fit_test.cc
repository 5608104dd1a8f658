// The fast tier fitted to looks that a profile with known parameters made.
#include "studies/perception/profile_fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine/core/check.h"
#include "engine/core/random.h"
#include "engine/perception/score.h"

namespace ed3r::perception_fit {
namespace {

PerceptionConfig Truth() {
  PerceptionConfig truth;
  truth.smoke_weight = 0.4;
  truth.distractor_weight = 0.2;
  truth.full = {0.0006, 3.5, 0.96, 0.8, 0.4};
  truth.quantized = {0.0015, 2.5, 0.9, 1.0, 0.6};
  return truth;
}

// As the fast tier draws them, from shares over three decades.
std::vector<PeriodLook> Looks(const PerceptionConfig& truth, int count) {
  std::vector<PeriodLook> looks;
  for (int i = 0; i < count; ++i) {
    Stream stream(7, static_cast<std::uint32_t>(i), Purpose::kFrames);
    PeriodLook look;
    look.quantized = i % 2 == 1;
    look.fire_share = stream.Uniform() < 0.6 ? std::pow(10.0, stream.Uniform(-5.0, -1.5)) : 0.0;
    look.smoke_share = stream.Uniform() < 0.6 ? std::pow(10.0, stream.Uniform(-5.0, -1.0)) : 0.0;
    look.distractor_share = stream.Uniform() < 0.3 ? std::pow(10.0, stream.Uniform(-4.0, -1.0)) : 0.0;
    look.fire_in_view_pixels = look.fire_in_view_geometry = look.fire_share + look.smoke_share > 0.0;
    const ResponseConfig& r = look.quantized ? truth.quantized : truth.full;
    const double signal = std::max(look.fire_share + truth.smoke_weight * look.smoke_share,
                                   truth.distractor_weight * look.distractor_share);
    std::vector<double> frames(33, 0.0);
    if (signal > 0.0) {
      const double logit = r.slope * std::log10(signal / r.half_signal) + r.view_sigma * stream.Normal();
      for (double& c : frames) c = r.ceiling / (1.0 + std::exp(-(logit + r.frame_sigma * stream.Normal())));
    }
    const perception::Score score = perception::StableConfidence(frames, truth.frame_threshold);
    look.mean = score.mean;
    look.deviation = score.standard_deviation;
    looks.push_back(look);
  }
  return looks;
}

TEST(ProfileFitTest, KnownParametersComeBack) {
  const PerceptionConfig truth = Truth();
  const std::vector<PeriodLook> looks = Looks(truth, 8000);
  const ProfileFit fit = FitProfile(looks, PerceptionConfig());
  EXPECT_NEAR(std::log(fit.smoke_weight / truth.smoke_weight), 0.0, 0.15);
  EXPECT_NEAR(std::log(fit.distractor_weight / truth.distractor_weight), 0.0, 0.2);
  for (const auto& [fitted, real] :
       {std::pair{fit.full, truth.full}, std::pair{fit.quantized, truth.quantized}}) {
    EXPECT_NEAR(std::log(fitted.response.half_signal / real.half_signal), 0.0, 0.15);
    EXPECT_NEAR(fitted.response.slope, real.slope, 0.15 * real.slope);
    EXPECT_NEAR(fitted.response.ceiling, real.ceiling, 0.02);
    EXPECT_NEAR(fitted.response.view_sigma, real.view_sigma, 0.2 * real.view_sigma);
    EXPECT_NEAR(fitted.response.frame_sigma, real.frame_sigma, 0.15 * real.frame_sigma);
    EXPECT_GT(fitted.variance_explained, 0.8);
    EXPECT_EQ(fitted.periods, 4000);
  }
  EXPECT_EQ(fit.same_truth_pct, 100.0);
}

TEST(ProfileFitTest, ExpectationIsTheMeanOfTheDraws) {
  const PerceptionConfig truth = Truth();
  PeriodLook look;
  look.fire_share = 0.0009;
  const ResponseConfig& r = truth.full;
  Stream stream(1, 2, Purpose::kFrames);
  const double sigma = std::hypot(r.view_sigma, r.frame_sigma);
  double sum = 0.0;
  constexpr int kDraws = 200000;
  for (int i = 0; i < kDraws; ++i) {
    const double c =
        r.ceiling /
        (1.0 + std::exp(-(r.slope * std::log10(look.fire_share / r.half_signal) + sigma * stream.Normal())));
    sum += c >= truth.frame_threshold ? c : 0.0;
  }
  EXPECT_NEAR(ExpectedConfidence(look, truth), sum / kDraws, 0.004);
  look.fire_share = 0.0;
  EXPECT_EQ(ExpectedConfidence(look, truth), 0.0);
}

TEST(ProfileFitTest, MeansOfAFittedModelAreRightOnAverage) {
  // Every fifth look with a signal saw nothing, for reasons that the geometry does not know.
  std::vector<PeriodLook> looks = Looks(Truth(), 3000);
  double observed = 0.0, expected = 0.0;
  for (std::size_t i = 0; i < looks.size(); ++i) {
    if (i % 10 < 2) looks[i].mean = 0.0;
    observed += looks[i].mean;
  }
  for (const double value : FitProfile(looks, PerceptionConfig()).expected) expected += value;
  EXPECT_NEAR(expected / observed, 1.0, 0.03);
}

TEST(ProfileFitTest, FalseAlarmsAreCountedByTilt) {
  std::vector<PeriodLook> looks = Looks(Truth(), 2000);
  for (PeriodLook& look : looks) look.tilt_rad = 1.0;  // 57 degrees
  // At 15 degrees the networks see fire in two of five empty pictures.
  for (int i = 0; i < 5; ++i) looks.push_back({.tilt_rad = 0.26, .mean = i < 2 ? 0.9 : 0.0});
  const std::vector<FalseAlarmBand> bands = FitProfile(looks, PerceptionConfig()).false_alarms;
  ASSERT_EQ(bands.size(), 9u);
  EXPECT_EQ(bands[1].periods, 5);
  EXPECT_NEAR(bands[1].networks_pct, 40.0, 1e-9);
  EXPECT_EQ(bands[1].fitted_pct, 0.0) << "nothing in view that could mislead the profile";
  EXPECT_GT(bands[5].periods, 250);
  EXPECT_GT(bands[5].networks_pct, 0.0) << "the distractors of these looks";
  EXPECT_EQ(bands[8].periods, 0);
  EXPECT_EQ(bands[8].networks_pct, 0.0);
}

TEST(ProfileFitTest, AlarmProbabilityIsTheShareOfTheDraws) {
  const PerceptionConfig truth = Truth();
  for (const bool quantized : {false, true}) {
    const ResponseConfig& r = quantized ? truth.quantized : truth.full;
    for (const double distractor_share : {0.003, 0.01, 0.03}) {
      const PeriodLook look{.quantized = quantized, .distractor_share = distractor_share};
      const double logit = r.slope * std::log10(truth.distractor_weight * distractor_share / r.half_signal);
      Stream stream(3, 4, Purpose::kFrames);
      constexpr int kDraws = 20000;
      int reliable = 0;
      for (int i = 0; i < kDraws; ++i) {
        const double view = logit + r.view_sigma * stream.Normal();
        std::vector<double> frames(33);
        for (double& c : frames) c = r.ceiling / (1.0 + std::exp(-(view + r.frame_sigma * stream.Normal())));
        reliable += perception::StableConfidence(frames, truth.frame_threshold).mean >= kReliable ? 1 : 0;
      }
      EXPECT_NEAR(AlarmProbability(look, truth), static_cast<double>(reliable) / kDraws, 0.03)
          << quantized << " " << distractor_share;
    }
  }
}

TEST(ProfileFitTest, WhatCannotBeFittedIsRefusedAndZeroWeightsAreNot) {
  const std::vector<PeriodLook> looks = Looks(Truth(), 600);
  PerceptionConfig start;
  start.distractor_weight = 0.0;
  EXPECT_GT(FitProfile(looks, start).distractor_weight, 0.01);
  start.frame_threshold = 0.0;
  EXPECT_THROW(FitProfile(looks, start), UserError);
}

TEST(ProfileFitTest, PeriodsHeldOutAreJudgedAndNotFitted) {
  std::vector<PeriodLook> looks = Looks(Truth(), 2000);
  for (std::size_t i = 0; i < looks.size(); ++i) looks[i].held_out = i % 4 >= 2;
  const ProfileFit fit = FitProfile(looks, PerceptionConfig());
  EXPECT_EQ(fit.full.periods, 500);
  EXPECT_LT(fit.full.always_no_pct, fit.full.same_decision_pct);
  std::vector<PeriodLook> spoilt = looks;
  for (PeriodLook& look : spoilt)
    if (look.held_out) look.mean = 0.0;
  const ProfileFit same = FitProfile(spoilt, PerceptionConfig());
  EXPECT_EQ(same.full.response.half_signal, fit.full.response.half_signal);
  EXPECT_GT(same.full.rms_residual, fit.full.rms_residual);
}

TEST(ProfileFitTest, TooFewLooksAreRefused) {
  const std::vector<PeriodLook> looks = Looks(Truth(), 60);
  EXPECT_THROW(FitProfile(looks, PerceptionConfig()), UserError);
}

}  // namespace
}  // namespace ed3r::perception_fit
