// Which networks look at rendered frames: the built-in ones, or the user's own ONNX models.
//
// The built-in Full looks at frames of 192 x 108 in single precision. The paper's Quantized costs a quarter of its Full
// (5.05 of 20.23 GFLOP), which 8-bit integers alone do not give, as they leave the number of operations: so the built-in
// Quantized is a network of the same layers for frames of half the width and height, in 8-bit integers. With
// quantized_input full it is Full itself in 8-bit integers.
//
// A user's model gets one frame at a time, 1 x 3 x input_height_px x input_width_px (or 1 x height x width x 3, where it
// declares so), shrunk or stretched to that size:
//   x = scale (byte - mean) / sd     byte in 0 .. 255, channels in channel_order, mean and sd of the byte's colour
// and answers, as output_name, with a vector, of which output_index is the logit or the probability of "fire or smoke in
// view". mean is in bytes, sd in units of scale times bytes: torchvision's 0.485 and 0.229 of pixels in 0 .. 1 are
// scale = 1/255, mean_red = 123.675, sd_red = 0.229.
#pragma once

#include <string>

#include "engine/config/field.h"

namespace ed3r {

enum class ChannelOrder { kRgb, kBgr };
template <>
struct EnumNames<ChannelOrder> {
  static constexpr EnumName<ChannelOrder> kNames[] = {{ChannelOrder::kRgb, "rgb"},
                                                      {ChannelOrder::kBgr, "bgr"}};
};

enum class DetectorOutput { kProbability, kSigmoid, kSoftmax };
template <>
struct EnumNames<DetectorOutput> {
  static constexpr EnumName<DetectorOutput> kNames[] = {{DetectorOutput::kProbability, "probability"},
                                                        {DetectorOutput::kSigmoid, "sigmoid"},
                                                        {DetectorOutput::kSoftmax, "softmax"}};
};

// Which frames the built-in Quantized network looks at.
enum class QuantizedInput { kHalf, kFull };
template <>
struct EnumNames<QuantizedInput> {
  static constexpr EnumName<QuantizedInput> kNames[] = {{QuantizedInput::kHalf, "half"},
                                                        {QuantizedInput::kFull, "full"}};
};

struct DetectorConfig {
  std::string full = "builtin";
  std::string quantized = "builtin";
  QuantizedInput quantized_input = QuantizedInput::kHalf;
  int input_width_px = 96;
  int input_height_px = 54;
  ChannelOrder channel_order = ChannelOrder::kRgb;
  double scale = 1.0 / 255.0;
  double mean_red = 0.0;
  double mean_green = 0.0;
  double mean_blue = 0.0;
  double sd_red = 1.0;
  double sd_green = 1.0;
  double sd_blue = 1.0;
  std::string output_name = "first";
  int output_index = 0;
  DetectorOutput output = DetectorOutput::kProbability;

  template <class Self, class Visitor>
  static void Describe(Self& self, Visitor&& visit) {
    constexpr std::string_view kSource = "none in the paper";
    constexpr std::string_view kModel = "Table of CV models";
    visit("full", self.full,
          {.source = kModel,
           .meaning = "Full network: builtin, or an ONNX model's path from the sweep file",
           .is_file = true,
           .or_else = "builtin"});
    visit("quantized", self.quantized,
          {.source = kModel,
           .meaning = "Quantized network: builtin, or an ONNX model's path from the sweep file",
           .is_file = true,
           .or_else = "builtin"});
    visit("quantized_input", self.quantized_input,
          {.source = "R38, Table of CV models",
           .meaning = "frames of the built-in Quantized network: half the width and height, or as Full's"});
    visit("input_width_px", self.input_width_px,
          {.unit = "px",
           .min = 0,
           .max = 2048,
           .source = kSource,
           .meaning = "input width of the ONNX models; 0: as each declares"});
    visit("input_height_px", self.input_height_px,
          {.unit = "px",
           .min = 0,
           .max = 2048,
           .source = kSource,
           .meaning = "input height of the ONNX models; 0: as each declares"});
    visit("channel_order", self.channel_order,
          {.source = kSource, .meaning = "order of the colour channels that the ONNX models want"});
    visit("scale", self.scale,
          {.min = 1e-6,
           .max = 1e3,
           .source = kSource,
           .meaning = "factor on (byte - mean) for the ONNX models"});
    DescribeMeans(self, visit);
    DescribeDeviations(self, visit);
    visit("output_name", self.output_name,
          {.source = kSource,
           .meaning = "which output of the ONNX models is read; first: the first that each declares"});
    visit("output_index", self.output_index,
          {.min = 0,
           .max = 1e6,
           .source = kSource,
           .meaning = "which value of the ONNX models' output means fire, from 0 on"});
    visit("output", self.output,
          {.source = kSource,
           .meaning = "what the ONNX models put out: probabilities, or logits to turn into them"});
  }

 private:
  template <class Self, class Visitor>
  static void DescribeMeans(Self& self, Visitor& visit) {
    constexpr FieldInfo kInfo{
        .min = 0,
        .max = 255,
        .source = "none in the paper",
        .meaning = "taken off this channel's bytes before scaling, for the ONNX models"};
    visit("mean_red", self.mean_red, kInfo);
    visit("mean_green", self.mean_green, kInfo);
    visit("mean_blue", self.mean_blue, kInfo);
  }

  template <class Self, class Visitor>
  static void DescribeDeviations(Self& self, Visitor& visit) {
    constexpr FieldInfo kInfo{
        .min = 1e-3,
        .max = 1e3,
        .source = "none in the paper",
        .meaning =
            "standard deviation by which this channel's scaled bytes are divided, for the ONNX models"};
    visit("sd_red", self.sd_red, kInfo);
    visit("sd_green", self.sd_green, kInfo);
    visit("sd_blue", self.sd_blue, kInfo);
  }
};

}  // namespace ed3r
