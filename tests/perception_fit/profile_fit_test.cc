// The fast tier fitted to looks that a profile with known parameters made.
#include "studies/perception/profile_fit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/core/check.h"
#include "engine/core/random.h"
#include "engine/perception/score.h"

namespace ed3r {
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
    const double signal = look.fire_share + truth.smoke_weight * look.smoke_share +
                          truth.distractor_weight * look.distractor_share;
    std::vector<double> frames(33, 0.0);
    if (signal > 0.0) {
      const double logit = r.slope * std::log10(signal / r.half_signal) + r.view_sigma * stream.Normal();
      for (double& c : frames) c = r.ceiling / (1.0 + std::exp(-(logit + r.frame_sigma * stream.Normal())));
    }
    const Score score = StableConfidence(frames, truth.frame_threshold);
    look.mean = score.mean;
    look.deviation = score.standard_deviation;
    looks.push_back(look);
  }
  return looks;
}

TEST(ProfileFitTest, KnownParametersComeBack) {
  const PerceptionConfig truth = Truth();
  const std::vector<PeriodLook> looks = Looks(truth, 6000);
  const ProfileFit fit = FitProfile(looks, PerceptionConfig());
  EXPECT_NEAR(std::log(fit.smoke_weight / truth.smoke_weight), 0.0, 0.15);
  EXPECT_NEAR(std::log(fit.distractor_weight / truth.distractor_weight), 0.0, 0.2);
  for (const auto& [fitted, real] :
       {std::pair{fit.full, truth.full}, std::pair{fit.quantized, truth.quantized}}) {
    EXPECT_NEAR(std::log(fitted.response.half_signal / real.half_signal), 0.0, 0.15);
    EXPECT_NEAR(fitted.response.slope, real.slope, 0.15 * real.slope);
    EXPECT_NEAR(fitted.response.ceiling, real.ceiling, 0.02);
    EXPECT_NEAR(fitted.response.frame_sigma, real.frame_sigma, 0.15 * real.frame_sigma);
    EXPECT_GT(fitted.variance_explained, 0.8);
    EXPECT_EQ(fitted.periods, 3000);
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

TEST(ProfileFitTest, TooFewLooksAreRefused) {
  const std::vector<PeriodLook> looks = Looks(Truth(), 60);
  EXPECT_THROW(FitProfile(looks, PerceptionConfig()), UserError);
}

}  // namespace
}  // namespace ed3r
