// How a detector's ONNX model is read: what it declares, held against perception.detector.
#pragma once

#include <string>

#include "engine/config/detector.h"
#include "engine/perception/vision/onnx/outline.h"

namespace ed3r::perception {

enum class ChannelPlace { kFirst, kLast };  // 1 x 3 x height x width, 1 x height x width x 3

struct OnnxReading {
  std::string input;
  ChannelPlace channels = ChannelPlace::kFirst;
  int width_px = 0;
  int height_px = 0;
  bool pinned = false;  // a side of the input was left open and is now the frame's
  std::string output;
};

// Which input and output of the model are used, and the size of its frames. Throws UserError that begins with `name`: more
// than one input, another number of channels, a size that is not the configured one, an output that the model does not
// have, that is no number or vector, or whose last step is already what perception.detector.output would do to it.
OnnxReading ReadingOf(const OnnxOutline& outline, const DetectorConfig& config, const std::string& name);

// Throws UserError for means and standard deviations in other units than those of detector.h.
void CheckScaling(const DetectorConfig& config);

// "[1, 5]" has one side that is not 1, "[1, 2, 64, 64]" three: more than one is a map or a table of boxes.
template <class Sides>
int LongSides(const Sides& sides) {
  int found = 0;
  for (const auto side : sides) found += side > 1 ? 1 : 0;
  return found;
}

}  // namespace ed3r::perception
