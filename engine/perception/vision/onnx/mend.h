// Steps in the forms of forms.h that OpenCV 4.6 reads otherwise than the standard says, put so that both agree.
//
//   Gemm          unless transB is 1 the weights are taken the wrong way round: an error for most, wrong numbers for square
//                 ones
//   Resize        linear ones without coordinates are read by who made the file; here they get those of the standard
//   InstanceNormalization
//                 without epsilon it is refused; here it gets its epsilon
//   LeakyRelu     without alpha the slope is 0, not 0.01
//   Clip          bounds that are inputs are not understood; here they become attributes, as of old
//   Split, Squeeze, Reduce*
//                 sizes or axes that are an input are passed over or refused; here they become an attribute
//   Squeeze       axes from the end on are misread; here they count from the front
//   Elu, Exp, HardSigmoid, ReduceL2, Sqrt, Tanh
//                 are taken for parts of a softmax, a norm, a batch normalization, a swish, a celu or a mish that they are not;
//                 here an Identity behind them breaks every such pattern
//   Softmax       without an axis it is taken over side 1, which opset 13 no longer says; here it gets its axis
//
// What takes more than the step itself (a divisor of its own for Div, constants by other names, what padding counts) is in
// rewrite.cc. tests/vision/operators_test.cc and forms_test.cc hold all of it against numbers worked out by hand.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "engine/perception/vision/onnx/node.h"

namespace ed3r::perception {

// The step as one or more nodes to stand in its place, in order. `rank`: of its first input. `name` begins messages. Throws UserError for forms that
// cannot be put so.
std::vector<std::string> Mended(std::string_view node, std::size_t rank, const OnnxSurroundings& around,
                                const std::string& name);

}  // namespace ed3r::perception
