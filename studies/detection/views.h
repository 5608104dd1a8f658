// The frames of one view show one scene moments apart: where chance is counted, they are one draw.
#pragma once

#include <span>
#include <vector>

#include "studies/detection/frame_set.h"

namespace ed3r::detection {

struct Views {
  std::vector<int> of_frame;  // for each chosen frame its view, 0 .. count-1, in the order of (world, view)
  int count = 0;
};
Views ViewsOf(std::span<const FrameLabel> labels, const std::vector<std::size_t>& chosen);

}  // namespace ed3r::detection
