#include "engine/perception/detector.h"

#include <algorithm>
#include <boost/container/small_vector.hpp>
#include <cmath>

#include "engine/core/random.h"

namespace ed3r::perception {
namespace {

constexpr std::size_t kUsualFrames = 64;  // more are kept on the heap; a sensing period has 33 by default

}  // namespace

Score DetectFromProfile(const View& view, const PerceptionConfig& perception, DetectionModel model,
                        int frames, const LookDraws& draws) {
  const ResponseConfig& response = model == DetectionModel::kFull ? perception.full : perception.quantized;
  const double fire = perception.fire_weight * view.fire_share + perception.smoke_weight * view.smoke_share;
  const double distractor = response.distractor_gain * perception.distractor_weight * view.distractor_share;
  const double signal = std::max(fire, distractor);
  if (signal <= 0.0) return {};
  const double fluctuation = Stream(draws.seed, draws.scenario, Purpose::kView, draws.view).Normal();
  const double logit =
      response.slope * std::log10(signal / response.half_signal) + response.view_sigma * fluctuation;
  Stream stream(draws.seed, draws.scenario, Purpose::kFrames, draws.timestep);
  boost::container::small_vector<double, kUsualFrames> confidences(static_cast<std::size_t>(frames));
  for (double& confidence : confidences)
    confidence = response.ceiling / (1.0 + std::exp(-(logit + response.frame_sigma * stream.Normal())));
  return StableConfidence({confidences.data(), confidences.size()}, perception.frame_threshold);
}

}  // namespace ed3r::perception
