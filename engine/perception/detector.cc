#include "engine/perception/detector.h"

#include <cmath>
#include <vector>

#include "engine/core/random.h"

namespace ed3r {

Score DetectFromProfile(const View& view, const PerceptionConfig& perception, DetectionModel model,
                        int frames, std::uint64_t seed, std::uint32_t scenario, std::uint32_t timestep) {
  const double signal = perception.fire_weight * view.fire_share +
                        perception.smoke_weight * view.smoke_share +
                        perception.distractor_weight * view.distractor_share;
  if (signal <= 0.0) return {};
  const ResponseConfig& response = model == DetectionModel::kFull ? perception.full : perception.quantized;
  Stream stream(seed, scenario, Purpose::kFrames, timestep);
  const double logit =
      response.slope * std::log10(signal / response.half_signal) + response.view_sigma * stream.Normal();
  std::vector<double> confidences(static_cast<std::size_t>(frames));
  for (double& confidence : confidences)
    confidence = response.ceiling / (1.0 + std::exp(-(logit + response.frame_sigma * stream.Normal())));
  return StableConfidence(confidences, perception.frame_threshold);
}

}  // namespace ed3r
