// The Stable Confidence Score of one sensing period (Eq. 10; R13, R33).
#pragma once

#include <span>

namespace ed3r::perception {

struct Score {
  double mean = 0.0;                // of the frame confidences
  double standard_deviation = 0.0;  // population
  double scs = 0.0;                 // max(0, mean - standard deviation), 0 when the mean is 0
};

// Confidences in [0, 1], one per frame; those below frame_threshold count as 0 (R33). No frames: all zero.
Score StableConfidence(std::span<const double> confidences, double frame_threshold);

}  // namespace ed3r::perception
