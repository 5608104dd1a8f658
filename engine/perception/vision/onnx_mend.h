// Steps of ONNX models that OpenCV 4.6 reads otherwise than the standard says, put so that both agree, or refused.
//
//   Gemm          unless transB is 1 the weights are taken the wrong way round: an error for most, wrong numbers for square
//                 ones; alpha and beta are not looked at
//   AveragePool   whether padding counts goes by who made the file, not by count_include_pad
//   LeakyRelu     without alpha the slope is 0, not 0.01
//   Clip          bounds that are inputs are not understood; here they become attributes, as of old
//   Split         sizes that are an input are passed over: equal parts; here they become an attribute
//   Reduce*       axes that are an input are passed over: all are reduced; here they become an attribute
//   Div           of a constant vector by what is computed is turned round; refused
//   Conv          dilations beside auto_pad are passed over, of ConvTranspose also alone, and output_shape; refused
//   Resize        antialias is passed over; refused
//   Softmax       without an axis it is taken over side 1, which opset 13 no longer says; here it gets its axis
//
// tests/vision/operators_test.cc holds what detectors are made of against numbers worked out by hand.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace ed3r::perception {

// Names of steps that hand on what another step takes; the other's text follows.
inline constexpr char kFirstOperand[] = "first operand of ", kSecondOperand[] = "second operand of ",
                      kFlattened[] = "flattened from side ";

// What the steps stand among.
struct OnnxSurroundings {
  std::string producer;                          // the model's producer_name
  std::map<std::string, float> bounds;           // constants of one number
  std::map<std::string, std::int64_t> elements;  // of all constants
  std::int64_t opset = 1;
  std::set<std::string> whole;  // values that are whole numbers, or come from shapes and constants alone
  std::map<std::string, std::vector<std::int64_t>> lists;  // constants of whole numbers
};

// Adds the tensor to the bounds if it is one float, to the lists if it is of int64.
void AddConstant(std::string_view tensor, const std::string& value, const std::string& name,
                 OnnxSurroundings& around);

// The step as one or more nodes to stand in its place, in order. `name` begins messages. Throws UserError for forms that
// cannot be put so.
std::vector<std::string> Mended(std::string_view node, const OnnxSurroundings& around,
                                const std::string& name);

}  // namespace ed3r::perception
