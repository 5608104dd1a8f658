// How well confidences tell frames with fire or smoke from frames without: figures by distance and by occlusion.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "studies/detection/frame_set.h"
#include "studies/statistics/intervals.h"

namespace ed3r::detection {

// "Fire" is said from this confidence on (the frame threshold, R33).
constexpr double kDecision = 0.5;

struct DetectionScores {
  int true_positives = 0, false_negatives = 0, false_positives = 0, true_negatives = 0;
  double auc = 0.0;                        // area under the ROC curve; NaN where one kind of frame is missing
  double accuracy = 0.0;                   // NaN for no frames
  statistics::Interval accuracy_interval;  // 95 %, frames of one view counted as one draw
  double calibration_error = 0.0;  // mean |confidence - share of positives| over 10 bins, weighted by frames

  int Frames() const { return true_positives + false_negatives + false_positives + true_negatives; }
};

// One confidence per label, of the frames chosen.
DetectionScores ScoresOf(std::span<const double> confidences, std::span<const FrameLabel> labels,
                         const std::vector<std::size_t>& chosen);

// Frames that are looked at together. Positive frames belong to one band of distance and one of occlusion; every band
// is compared with all negative frames, of which a band of their own says nothing about what is hidden.
struct Group {
  std::string name;
  std::vector<std::size_t> frames;
};
std::vector<Group> ByDistance(std::span<const FrameLabel> labels);
std::vector<Group> ByOcclusion(std::span<const FrameLabel> labels);
std::vector<Group> BySize(std::span<const FrameLabel> labels);  // visible fire and smoke pixels
std::vector<Group> ByWorld(std::span<const FrameLabel> labels);
Group All(std::span<const FrameLabel> labels);

}  // namespace ed3r::detection
