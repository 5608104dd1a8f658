// A user's ONNX model as a FrameDetector, through OpenCV DNN on one thread.
#pragma once

#include <memory>
#include <string>

#include "engine/config/detector.h"
#include "engine/perception/vision/frame_detector.h"

namespace ed3r::perception {

// `key` stands in messages (perception.detector.full); `bytes` is the model, its weights inside, `path` its name. Sets
// OpenCV's threads to one and silences it, for the whole process. Throws UserError for bytes that are no network that
// OpenCV can run, for a model that declares another input or output than the configuration, and for an answer that is not
// what the configuration says.
std::shared_ptr<const FrameDetector> MakeOnnxDetector(const std::string& key, const std::string& path,
                                                      const std::string& bytes, const DetectorConfig& config);

}  // namespace ed3r::perception
