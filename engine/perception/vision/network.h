// Inference of a DetectorModel through oneDNN, for a fixed number of frames at a time.
//
// A frame's logit does not depend on the frames beside it, on the CPU (the code path is pinned, onednn.h) or on the
// number of threads. Threads: one object, one thread at a time; different objects are independent.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "engine/perception/vision/detector_model.h"

namespace ed3r::perception {

class Network {
 public:
  virtual ~Network() = default;

  // rgb: logits.size() frames of the topology's size, laid out as in FrameStack.
  virtual void Logits(std::span<const std::uint8_t> rgb, std::span<float> logits) = 0;
};

// Single precision. `batch`: frames that run together; it decides speed alone.
std::unique_ptr<Network> MakeFloatNetwork(const DetectorModel& model, int batch);

// 8-bit integers (LayerQuantization): u8 activations x s8 weights summed in s32, exact. Between layers, in single
// precision without fused operations:
//   y = float(sum) (input_scale weight_scale) + bias,  LeakyReLU,  q = clamp(round_half_even(y / next scale) + zero point)
// The model must have quantisation scales.
std::unique_ptr<Network> MakeIntegerNetwork(const DetectorModel& model, int batch);

}  // namespace ed3r::perception
