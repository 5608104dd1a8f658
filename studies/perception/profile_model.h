// What the fast tier expects of a sensing period, as templates over the number type, for fitting and for judging.
// The formulas are those of profile_fit.h.
#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "studies/perception/profile_fit.h"

namespace ed3r::perception_fit::profile {

// Shared by the models: (ln w_smoke, ln w_distractor), against flame.
using Weights = std::array<double, 2>;
// Of one model: (ln half_signal, slope, ceiling, ln view_sigma).
using Response = std::array<double, 4>;

// What is not searched: confidences below `threshold` count as 0, and frame_sigma is known from the spread within periods.
struct Given {
  double threshold = 0.5;
  double frame_sigma = 0.3;
};

template <class T>
T SignalOf(const PeriodLook& look, const T* weights) {
  using std::exp;
  const T fire = look.fire_share + exp(weights[0]) * look.smoke_share;
  const T distractor = exp(weights[1]) * look.distractor_share;
  return distractor > fire ? distractor : fire;
}

// The logit of a period before it fluctuates; only where there is a signal.
template <class T>
T LogitOf(const T& signal, const T* response) {
  using std::log;
  return response[1] * (log(signal) - response[0]) / std::numbers::ln10;
}

// Probability that the mean of a whole period exceeds a confidence: that its logit does, as the frames average out. The
// spread of the frames flattens the logistic curve that they average to (probit approximation).
template <class T>
T ProbabilityAbove(double confidence, const PeriodLook& look, const Given& given, const T* weights,
                   const T* response) {
  using std::erfc, std::exp, std::log;
  const T signal = SignalOf(look, weights);
  if (!(signal > 0.0)) return T(0.0);
  if (!(response[2] > confidence)) return T(0.0);
  const double flattened = std::sqrt(1.0 + std::numbers::pi / 8.0 * given.frame_sigma * given.frame_sigma);
  const T short_of = flattened * log(confidence / (response[2] - confidence)) - LogitOf(signal, response);
  return 0.5 * erfc(short_of / (exp(response[3]) * std::sqrt(2.0)));
}

// E of profile_fit.h: Simpson's rule over the logit, from the threshold up.
template <class T>
T ExpectedMean(const PeriodLook& look, const Given& given, const T* weights, const T* response) {
  using std::erfc, std::exp, std::log, std::sqrt;
  constexpr int kNodes = 32;
  constexpr double kLogitSpan = 12;  // beyond it a logistic curve is flat and a normal density is nothing
  const T signal = SignalOf(look, weights);
  if (!(signal > 0.0)) return T(0.0);
  const T z = LogitOf(signal, response);
  const T ceiling = response[2];
  const T sigma = sqrt(exp(2.0 * response[3]) + given.frame_sigma * given.frame_sigma);
  const T from = log(given.threshold / (ceiling - given.threshold));
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

// The parameters of a configuration, on these scales; a weight of 0 is -infinity. The distractors' weight is that for the
// model of `response`, its gain included.
Weights WeightsOf(const PerceptionConfig& perception, const ResponseConfig& response);
Response ResponseOf(const ResponseConfig& response, double fire_weight);

}  // namespace ed3r::perception_fit::profile
