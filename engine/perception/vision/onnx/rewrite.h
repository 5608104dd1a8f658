// A detector's ONNX model in the form that OpenCV's reader takes.
//
// OpenCV 4.6 knows no half precision, stumbles over sides that are left open, answers with whatever output stands last
// and loads what nobody reads. So the model is written anew: the asked output alone, the steps and weights that it needs,
// the frame's size put into the input, and half precision made single (every half is a float, so nothing is rounded).
#pragma once

#include <string>
#include <string_view>

#include "engine/perception/vision/onnx/outline.h"
#include "engine/perception/vision/onnx/reading.h"

namespace ed3r::perception {

// `bytes` have passed CheckOnnx, `outline` and `reading` are theirs. Throws UserError that begins with `name` for steps
// that cannot be run: graphs within graphs.
std::string ForOpenCv(std::string_view bytes, const OnnxOutline& outline, const OnnxReading& reading,
                      const std::string& name);

}  // namespace ed3r::perception
