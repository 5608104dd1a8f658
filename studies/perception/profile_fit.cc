#include "studies/perception/profile_fit.h"

#include <ceres/ceres.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/core/check.h"
#include "studies/perception/profile_judgement.h"
#include "studies/perception/profile_model.h"

namespace ed3r::perception_fit {
namespace {

using profile::Given, profile::Response, profile::Weights;

constexpr int kMinPeriods = 50;

// The mean alone leaves open whether a flat response fluctuates little or a steep one much; how often a period is reliable
// tells them apart, and is what missions live on.
struct Residual {
  PeriodLook look;
  perception_fit::profile::Given given;

  template <class T>
  bool operator()(const T* weights, const T* response, T* residual) const {
    residual[0] = profile::ExpectedMean(look, given, weights, response) - look.mean;
    residual[1] = profile::ProbabilityAbove(kReliable, look, given, weights, response) -
                  (look.mean >= kReliable ? 1.0 : 0.0);
    return true;
  }
};

// Spread of the logit from frame to frame, where thresholding leaves the spread of the confidences alone and the ceiling
// does not yet bend it.
double FrameSigma(std::span<const PeriodLook> looks, bool quantized, double threshold) {
  double ceiling = threshold;
  for (const PeriodLook& look : looks)
    if (look.quantized == quantized) ceiling = std::max(ceiling, look.mean);
  std::vector<double> spreads;
  for (const PeriodLook& look : looks) {
    if (look.quantized != quantized || look.mean - 3.0 * look.deviation < threshold ||
        look.mean > 0.9 * ceiling)
      continue;
    spreads.push_back(look.deviation * ceiling / (look.mean * (ceiling - look.mean)));
  }
  if (spreads.empty()) return 0.1;
  const auto middle = spreads.begin() + static_cast<std::ptrdiff_t>(spreads.size() / 2);
  std::nth_element(spreads.begin(), middle, spreads.end());
  return *middle;
}

// Of each model the periods with some signal that are not held out, evenly thinned: only they say anything of the response.
std::vector<PeriodLook> LooksToFit(std::span<const PeriodLook> looks) {
  std::vector<PeriodLook> fitted;
  for (const bool quantized : {false, true}) {
    std::vector<PeriodLook> telling;
    for (const PeriodLook& look : looks)
      if (look.quantized == quantized && !look.held_out &&
          look.fire_share + look.smoke_share + look.distractor_share > 0.0)
        telling.push_back(look);
    if (telling.size() < kMinPeriods)
      throw UserError(
          fmt::format("{} sensing periods with fire, smoke or a distractor in view are too few for the {} "
                      "model; needed: {}",
                      telling.size(), quantized ? "Quantized" : "Full", kMinPeriods));
    const std::size_t stride = (telling.size() + kMostFitted - 1) / kMostFitted;
    for (std::size_t i = 0; i < telling.size(); i += stride) fitted.push_back(telling[i]);
  }
  return fitted;
}

struct Solution {
  perception_fit::profile::Weights weights;
  perception_fit::profile::Response full, quantized;
  double cost = std::numeric_limits<double>::infinity();
};

// Bounds of a block of parameters, into which a start outside is moved.
template <std::size_t kCount>
void Bound(ceres::Problem& problem, std::array<double, kCount>& block,
           const std::array<std::array<double, 2>, kCount>& bounds) {
  for (std::size_t i = 0; i < kCount; ++i) {
    block[i] = std::clamp(block[i], bounds[i][0], bounds[i][1]);
    problem.SetParameterLowerBound(block.data(), static_cast<int>(i), bounds[i][0]);
    problem.SetParameterUpperBound(block.data(), static_cast<int>(i), bounds[i][1]);
  }
}

void Solve(std::span<const PeriodLook> looks, const perception_fit::profile::Given& full_given,
           const perception_fit::profile::Given& quantized_given, Solution& solution) {
  auto& [weights, full, quantized, cost] = solution;
  ceres::Problem problem;
  for (const PeriodLook& look : looks)
    problem.AddResidualBlock(new ceres::AutoDiffCostFunction<Residual, 2, 2, 4>(
                                 new Residual{look, look.quantized ? quantized_given : full_given}),
                             nullptr, weights.data(), look.quantized ? quantized.data() : full.data());
  Bound<2>(problem, weights, {{{std::log(1e-4), std::log(10.0)}, {std::log(1e-4), std::log(10.0)}}});
  const double least_ceiling = std::max(full_given.threshold, kReliable) + 0.05;
  for (perception_fit::profile::Response* response : {&full, &quantized})
    Bound<4>(problem, *response,
             {{{std::log(1e-6), std::log(0.5)},
               {0.2, 40.0},
               {least_ceiling, 1.0},
               {std::log(0.05), std::log(8.0)}}});
  ceres::Solver::Options options;
  options.max_num_iterations = 100;
  options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  ED3R_CHECK(summary.IsSolutionUsable(), summary.message);
  cost = summary.final_cost;
}

// A steep and a flat response can both be local minima: several starts, the least cost wins.
Solution BestOfStarts(std::span<const PeriodLook> looks, const perception_fit::profile::Given& full,
                      const perception_fit::profile::Given& quantized, const PerceptionConfig& start) {
  Solution best;
  for (const double slope : {3.0, 8.0}) {
    for (const double sigma : {0.7, 2.0}) {
      Solution solution{profile::WeightsOf(start, start.full),
                        profile::ResponseOf(start.full, start.fire_weight),
                        profile::ResponseOf(start.quantized, start.fire_weight)};
      for (perception_fit::profile::Response* response : {&solution.full, &solution.quantized}) {
        (*response)[1] = slope;
        (*response)[3] = std::log(sigma);
      }
      Solve(looks, full, quantized, solution);
      if (solution.cost < best.cost) best = solution;
    }
  }
  return best;
}

}  // namespace

namespace profile {

Weights WeightsOf(const PerceptionConfig& p, const ResponseConfig& r) {
  return {std::log(p.smoke_weight / p.fire_weight),
          std::log(r.distractor_gain * p.distractor_weight / p.fire_weight)};
}

Response ResponseOf(const ResponseConfig& r, double fire_weight) {
  return {std::log(r.half_signal / fire_weight), r.slope, r.ceiling, std::log(std::max(r.view_sigma, 1e-3))};
}

}  // namespace profile

ProfileFit FitProfile(std::span<const PeriodLook> looks, const PerceptionConfig& start) {
  if (start.frame_threshold <= 0.0 || start.frame_threshold > 0.9 || start.fire_weight <= 0.0)
    throw UserError(
        fmt::format("perception.frame_threshold: {:g} and perception.fire_weight: {:g} leave nothing to fit; "
                    "allowed: a threshold above 0 and up to 0.9, a weight above 0",
                    start.frame_threshold, start.fire_weight));
  const std::vector<PeriodLook> fitted = LooksToFit(looks);
  const perception_fit::profile::Given full_given{start.frame_threshold,
                                                  FrameSigma(fitted, false, start.frame_threshold)};
  const perception_fit::profile::Given quantized_given{start.frame_threshold,
                                                       FrameSigma(fitted, true, start.frame_threshold)};
  const auto [weights, full, quantized, cost] = BestOfStarts(fitted, full_given, quantized_given, start);

  ProfileFit fit;
  fit.smoke_weight = std::exp(weights[0]);
  fit.distractor_weight = std::exp(weights[1]);
  const auto config_of = [](const perception_fit::profile::Response& r,
                            const perception_fit::profile::Given& given) {
    return ResponseConfig{std::exp(r[0]), r[1], r[2], std::exp(r[3]), given.frame_sigma};
  };
  fit.full.response = config_of(full, full_given);
  fit.quantized.response = config_of(quantized, quantized_given);
  JudgeFit(looks, start, fit);
  return fit;
}

double ExpectedConfidence(const PeriodLook& look, const PerceptionConfig& perception) {
  const ResponseConfig& r = look.quantized ? perception.quantized : perception.full;
  const perception_fit::profile::Weights weights = profile::WeightsOf(perception, r);
  const perception_fit::profile::Response response = profile::ResponseOf(r, perception.fire_weight);
  return profile::ExpectedMean(look,
                               perception_fit::profile::Given{perception.frame_threshold, r.frame_sigma},
                               weights.data(), response.data());
}

double AlarmProbability(const PeriodLook& look, const PerceptionConfig& perception) {
  const ResponseConfig& r = look.quantized ? perception.quantized : perception.full;
  const perception_fit::profile::Weights weights = profile::WeightsOf(perception, r);
  const perception_fit::profile::Response response = profile::ResponseOf(r, perception.fire_weight);
  return profile::ProbabilityAbove(kReliable, look,
                                   perception_fit::profile::Given{perception.frame_threshold, r.frame_sigma},
                                   weights.data(), response.data());
}

}  // namespace ed3r::perception_fit
