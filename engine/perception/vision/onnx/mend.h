// Steps in the forms of forms.h that OpenCV 4.6 reads otherwise than the standard says, put so that both agree.
//
//   Gemm          unless transB is 1 the weights are taken the wrong way round: an error for most, wrong numbers for square
//                 ones
//   AveragePool   whether padding counts goes by who made the file, not by count_include_pad; refused where they differ
//   LeakyRelu     without alpha the slope is 0, not 0.01
//   Clip          bounds that are inputs are not understood; here they become attributes, as of old
//   Split, Squeeze, Reduce*
//                 sizes or axes that are an input are passed over or refused; here they become an attribute
//   Elu, Exp, HardSigmoid, ReduceL2, Sqrt, Tanh
//                 are taken for parts of a softmax, a norm, a batch normalization, a swish, a celu or a mish that they are not;
//                 here an Identity behind them breaks every such pattern
//   Softmax       without an axis it is taken over side 1, which opset 13 no longer says; here it gets its axis
//
// tests/vision/operators_test.cc holds what detectors are made of against numbers worked out by hand.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "engine/perception/vision/onnx/node.h"

namespace ed3r::perception {

// The step as one or more nodes to stand in its place, in order. `name` begins messages. Throws UserError for forms that
// cannot be put so.
std::vector<std::string> Mended(std::string_view node, const OnnxSurroundings& around,
                                const std::string& name);

}  // namespace ed3r::perception
