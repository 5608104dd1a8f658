// Detectors of the pixel tier: confidences of "fire or smoke in view", one per rendered frame (Eq. 10 makes the SCS of
// them).
//
// Threads: a detector may be used by any number of threads at once; each call runs on its caller's thread alone and
// takes buffers from a pool that grows to the largest number of simultaneous calls. The built-in detectors give the
// same bits on every CPU with AVX2 and for any number of threads. A user's ONNX model runs through OpenCV, which picks
// its instruction set itself: the same bits on one machine, not between different CPUs.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "engine/config/detector.h"
#include "engine/core/check.h"
#include "engine/perception/image.h"

namespace ed3r::perception {

// A network that fails on a frame, or whose answer is no confidence: not a number, or outside [0, 1]. what() is one line
// that begins with the key and the path of the network. A mission that meets one has failed.
class DetectorError : public UserError {
 public:
  using UserError::UserError;
};

class FrameDetector {
 public:
  virtual ~FrameDetector();

  // One confidence in [0, 1] per frame; frames of another size than the network's are resized (resize.h). Throws
  // DetectorError.
  virtual void Confidences(const FrameStack& frames, std::span<double> confidences) const = 0;
};

struct DetectorPair {
  std::shared_ptr<const FrameDetector> full;
  std::shared_ptr<const FrameDetector> quantized;
  std::string fingerprint;  // SHA-256 over both networks: part of what a result depends on
};

// Loads both and tries each on blank frames. Throws UserError, one line with the key and the path, for a file that is
// missing, is no network, declares another input or output than the configuration, or does not answer as it says.
DetectorPair LoadDetectors(const DetectorConfig& config);

}  // namespace ed3r::perception
