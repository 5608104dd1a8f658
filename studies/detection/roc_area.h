// Area under the ROC curve of frames that may count several times: a resample of views holds some twice, others never.
#pragma once

#include <span>
#include <vector>

#include "studies/detection/frame_set.h"

namespace ed3r::detection {

// Sorts the frames once; each area after that is one pass over them. Immutable, for any number of threads.
class RocArea {
 public:
  // One confidence per label, of the frames chosen; `unit_of_chosen` says for each of these which unit it is drawn
  // with. ED3R_CHECK: lengths that agree.
  RocArea(std::span<const double> confidences, std::span<const FrameLabel> labels,
          const std::vector<std::size_t>& chosen, std::span<const int> unit_of_chosen);

  // The area with each frame as often as its unit counts: the share of pairs (positive, negative) that the confidences
  // put in the right order, ties by half (Mann-Whitney). NaN where one kind of frame is missing.
  double Of(std::span<const int> count_of_unit) const;

 private:
  struct Frame {
    int unit;
    bool positive;
    bool tied;  // with the frame before
  };
  std::vector<Frame> frames_;  // by rising confidence
};

}  // namespace ed3r::detection
