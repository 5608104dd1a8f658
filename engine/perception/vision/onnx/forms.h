// The forms of ONNX operators that have been checked against the standard as OpenCV 4.6 reads them: one by one, in the shapes
// that shapes.h allows, put as mend.h and rewrite.h say. What is not in the table is refused: OpenCV reads many other forms
// otherwise, and says nothing. It also puts one step in the place of several, which mend.h prevents.
#pragma once

#include <string>

#include "engine/perception/vision/onnx/node.h"

namespace ed3r::perception {

// What is asked of the shapes of the inputs, and how those of the outputs follow.
enum class OnnxRule {
  kSame,
  kOfChannels,
  kConv,
  kConvTranspose,
  kPool,
  kGlobal,
  kSpread,
  kPRelu,
  kSoftmax,
  kConcat,
  kFlatten,
  kReshape,
  kSqueeze,
  kUnsqueeze,
  kTranspose,
  kGemm,
  kMatMul,
  kPad,
  kSplit,
  kSlice,
  kGather,
  kReduce,
  kResize,
  kConstant,
  kShape,
  kNumbers
};

// The rule of the node's form. `kinds`: a letter for each input: x computed from the frame, c a constant of float, i of whole
// numbers, o of another type, n whole numbers from shapes, - left out. Throws UserError that begins with `name` for what is not in
// the table: one line with the node, what was found and what is allowed.
OnnxRule RuleOf(const OnnxNode& node, const std::string& kinds, std::int64_t opset, const std::string& name);

}  // namespace ed3r::perception
