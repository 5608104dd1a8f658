#include "engine/perception/score.h"

#include <algorithm>
#include <cmath>

namespace ed3r::perception {

Score StableConfidence(std::span<const double> confidences, double frame_threshold) {
  Score score;
  if (confidences.empty()) return score;
  const auto counted = [frame_threshold](double confidence) {
    return confidence < frame_threshold ? 0.0 : confidence;
  };
  const double n = static_cast<double>(confidences.size());
  double sum = 0.0;
  for (const double confidence : confidences) sum += counted(confidence);
  score.mean = sum / n;
  double squares = 0.0;
  for (const double confidence : confidences) {
    const double deviation = counted(confidence) - score.mean;
    squares += deviation * deviation;
  }
  score.standard_deviation = std::sqrt(squares / n);
  // mean (1 - sd / mean) without the 0 / 0.
  score.scs = std::max(0.0, score.mean - score.standard_deviation);
  return score;
}

}  // namespace ed3r::perception
