#include "studies/perception/profile_fit.h"

#include <ceres/ceres.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "engine/core/check.h"

namespace ed3r {
namespace {

constexpr int kMinPeriods = 50;
constexpr int kNodes = 32;         // of Simpson's rule
constexpr double kLogitSpan = 12;  // beyond it a logistic curve is flat and a normal density is nothing

// Parameters: shared (ln w_smoke, ln w_distractor), and for each model (ln half_signal, slope, ceiling, ln sigma).
using Weights = std::array<double, 2>;
using Response = std::array<double, 4>;

template <class T>
T Expected(const PeriodLook& look, double threshold, const T* weights, const T* response) {
  using std::exp, std::log;
  const T signal =
      look.fire_share + exp(weights[0]) * look.smoke_share + exp(weights[1]) * look.distractor_share;
  if (!(signal > 0.0)) return T(0.0);
  const T z = response[1] * (log(signal) - response[0]) / std::numbers::ln10;
  const T ceiling = response[2];
  const T sigma = exp(response[3]);
  const T from = log(threshold / (ceiling - threshold));
  T sum(0.0);
  for (int i = 0; i <= kNodes; ++i) {
    const double step = kLogitSpan / kNodes;
    const T at = from + i * step;
    const T u = (at - z) / sigma;
    const T density = exp(-0.5 * u * u) / (sigma * std::sqrt(2.0 * std::numbers::pi));
    const double weight = i == 0 || i == kNodes ? 1.0 : i % 2 == 1 ? 4.0 : 2.0;
    sum += weight * step / 3.0 * density * ceiling / (1.0 + exp(-at));
  }
  // Above the last node the curve is at its ceiling: what is left of the normal distribution counts with that.
  const T rest = (from + kLogitSpan - z) / sigma;
  return sum + ceiling * 0.5 * erfc(rest / std::sqrt(2.0));
}

struct Residual {
  PeriodLook look;
  double threshold;

  template <class T>
  bool operator()(const T* weights, const T* response, T* residual) const {
    residual[0] = Expected(look, threshold, weights, response) - look.mean;
    return true;
  }
};

Weights WeightsOf(const PerceptionConfig& p) {
  return {std::log(p.smoke_weight / p.fire_weight), std::log(p.distractor_weight / p.fire_weight)};
}

Response ResponseOf(const ResponseConfig& r, double fire_weight) {
  return {std::log(r.half_signal / fire_weight), r.slope, r.ceiling,
          0.5 * std::log(r.view_sigma * r.view_sigma + r.frame_sigma * r.frame_sigma)};
}

// Spread of the logit from frame to frame, where thresholding leaves the spread of the confidences alone and the ceiling
// does not yet bend it.
double FrameSigma(std::span<const PeriodLook> looks, bool quantized, double ceiling, double threshold) {
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

double SignalOf(const PeriodLook& look, const ProfileFit& fit) {
  return look.fire_share + fit.smoke_weight * look.smoke_share +
         fit.distractor_weight * look.distractor_share;
}

ResponseFit Judge(std::span<const PeriodLook> looks, bool quantized, double threshold,
                  const std::vector<double>& expected) {
  ResponseFit fit;
  double squares = 0.0, sum = 0.0, total = 0.0;
  int same = 0;
  for (std::size_t i = 0; i < looks.size(); ++i) {
    if (looks[i].quantized != quantized) continue;
    ++fit.periods;
    squares += (looks[i].mean - expected[i]) * (looks[i].mean - expected[i]);
    sum += looks[i].mean;
    total += looks[i].mean * looks[i].mean;
    same += (looks[i].mean >= threshold) == (expected[i] >= threshold) ? 1 : 0;
  }
  fit.rms_residual = std::sqrt(squares / fit.periods);
  fit.variance_explained = 1.0 - squares / (total - sum * sum / fit.periods);
  fit.same_decision_pct = 100.0 * same / fit.periods;
  return fit;
}

std::vector<AgreementBand> Bands(std::span<const PeriodLook> looks, const ProfileFit& fit) {
  std::vector<AgreementBand> bands;
  const double edges[] = {0.0, 1e-12, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2, 1e-1, 1e3};
  for (const bool quantized : {false, true}) {
    for (std::size_t b = 0; b + 1 < std::size(edges); ++b) {
      AgreementBand band{quantized, edges[b], edges[b + 1]};
      for (std::size_t i = 0; i < looks.size(); ++i) {
        const double signal = SignalOf(looks[i], fit);
        if (looks[i].quantized != quantized || signal < edges[b] || signal >= edges[b + 1]) continue;
        ++band.periods;
        band.observed += looks[i].mean;
        band.expected += fit.expected[i];
      }
      if (band.periods == 0) continue;
      band.observed /= band.periods;
      band.expected /= band.periods;
      bands.push_back(band);
    }
  }
  return bands;
}

// Only periods with some signal say anything about the response.
int CountSignals(std::span<const PeriodLook> looks, bool quantized) {
  return static_cast<int>(std::count_if(looks.begin(), looks.end(), [&](const PeriodLook& look) {
    return look.quantized == quantized && look.fire_share + look.smoke_share + look.distractor_share > 0.0;
  }));
}

struct Solution {
  Weights weights;
  Response full, quantized;
  double cost = std::numeric_limits<double>::infinity();
};

void Solve(std::span<const PeriodLook> looks, double threshold, Solution& solution) {
  auto& [weights, full, quantized, cost] = solution;
  ceres::Problem problem;
  for (const PeriodLook& look : looks) {
    if (look.fire_share + look.smoke_share + look.distractor_share <= 0.0) continue;
    problem.AddResidualBlock(
        new ceres::AutoDiffCostFunction<Residual, 1, 2, 4>(new Residual{look, threshold}),
        new ceres::HuberLoss(0.3), weights.data(), look.quantized ? quantized.data() : full.data());
  }
  for (const int i : {0, 1}) {
    problem.SetParameterLowerBound(weights.data(), i, std::log(1e-4));
    problem.SetParameterUpperBound(weights.data(), i, std::log(10.0));
  }
  for (Response* response : {&full, &quantized}) {
    const std::array<std::array<double, 2>, 4> bounds = {{{std::log(1e-6), std::log(0.5)},
                                                          {0.2, 40.0},
                                                          {threshold + 0.05, 1.0},
                                                          {std::log(0.05), std::log(8.0)}}};
    for (int i = 0; i < 4; ++i) {
      problem.SetParameterLowerBound(response->data(), i, bounds[static_cast<std::size_t>(i)][0]);
      problem.SetParameterUpperBound(response->data(), i, bounds[static_cast<std::size_t>(i)][1]);
    }
  }
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
Solution BestOfStarts(std::span<const PeriodLook> looks, double threshold, const PerceptionConfig& start) {
  Solution best;
  for (const double slope : {3.0, 8.0}) {
    for (const double sigma : {0.7, 2.0}) {
      Solution solution{WeightsOf(start), ResponseOf(start.full, start.fire_weight),
                        ResponseOf(start.quantized, start.fire_weight)};
      for (Response* response : {&solution.full, &solution.quantized}) {
        (*response)[1] = slope;
        (*response)[3] = std::log(sigma);
      }
      Solve(looks, threshold, solution);
      if (solution.cost < best.cost) best = solution;
    }
  }
  return best;
}

ResponseConfig ConfigOf(const Response& r, double frame_sigma) {
  const double sigma = std::exp(r[3]);
  const double view_sigma = std::sqrt(std::max(0.0, sigma * sigma - frame_sigma * frame_sigma));
  return {std::exp(r[0]), r[1], r[2], view_sigma, frame_sigma};
}

}  // namespace

ProfileFit FitProfile(std::span<const PeriodLook> looks, const PerceptionConfig& start) {
  for (const bool quantized : {false, true})
    if (const int count = CountSignals(looks, quantized); count < kMinPeriods)
      throw UserError(
          fmt::format("{} sensing periods with fire, smoke or a distractor in view are too few for the {} "
                      "model; needed: {}",
                      count, quantized ? "Quantized" : "Full", kMinPeriods));
  const double threshold = start.frame_threshold;
  const auto [weights, full, quantized, cost] = BestOfStarts(looks, threshold, start);

  ProfileFit fit;
  fit.smoke_weight = std::exp(weights[0]);
  fit.distractor_weight = std::exp(weights[1]);
  int same_truth = 0;
  for (const PeriodLook& look : looks) {
    fit.expected.push_back(
        Expected(look, threshold, weights.data(), (look.quantized ? quantized : full).data()));
    same_truth += look.fire_in_view_pixels == look.fire_in_view_geometry ? 1 : 0;
  }
  fit.same_truth_pct = 100.0 * same_truth / static_cast<double>(looks.size());
  fit.full = Judge(looks, false, threshold, fit.expected);
  fit.quantized = Judge(looks, true, threshold, fit.expected);
  fit.full.response = ConfigOf(full, FrameSigma(looks, false, full[2], threshold));
  fit.quantized.response = ConfigOf(quantized, FrameSigma(looks, true, quantized[2], threshold));
  fit.bands = Bands(looks, fit);
  return fit;
}

double ExpectedConfidence(const PeriodLook& look, const PerceptionConfig& perception) {
  const Weights weights = WeightsOf(perception);
  const Response response =
      ResponseOf(look.quantized ? perception.quantized : perception.full, perception.fire_weight);
  return Expected(look, perception.frame_threshold, weights.data(), response.data());
}

}  // namespace ed3r
