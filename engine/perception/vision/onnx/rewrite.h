// A detector's ONNX model in the form that OpenCV's reader takes.
//
// OpenCV 4.6 knows no half precision, stumbles over sides that are left open, answers with whatever output stands last,
// loads what nobody reads and goes by the model's maker. So the model is written anew: the asked output alone, the steps and
// weights that it needs, each step checked (forms.h, shapes.h) and put as mend.h says, the frame's size put into the input,
// half precision made single (every half is a float, so nothing is rounded), constants by one name each, a divisor of its own
// for every quotient, and the maker by whose name OpenCV lets padding count in averages as the model has it.
#pragma once

#include <string>
#include <string_view>

#include "engine/perception/vision/onnx/outline.h"
#include "engine/perception/vision/onnx/reading.h"

namespace ed3r::perception {

// `bytes` have passed CheckOnnx, `outline` and `reading` are theirs. Throws UserError that begins with `name` for steps
// that cannot be run: graphs within graphs, forms and shapes that OpenCV reads otherwise than the standard says, padding that
// counts in some averages only.
std::string ForOpenCv(std::string_view bytes, const OnnxOutline& outline, const OnnxReading& reading,
                      const std::string& name);

}  // namespace ed3r::perception
