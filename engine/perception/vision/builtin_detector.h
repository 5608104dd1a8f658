// A DetectorModel as a FrameDetector.
#pragma once

#include <memory>

#include "engine/perception/vision/detector_model.h"
#include "engine/perception/vision/frame_detector.h"

namespace ed3r::perception {

enum class Arithmetic { kFloat, kInteger };

std::shared_ptr<const FrameDetector> MakeNetworkDetector(std::shared_ptr<const DetectorModel> model,
                                                         Arithmetic arithmetic);

}  // namespace ed3r::perception
