// Forms of operators over a frame that is wider than high, against the plain loops of the standard; and forms that OpenCV
// reads otherwise, which are refused.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>

#include "engine/core/check.h"
#include "engine/perception/vision/frame_detector.h"
#include "tests/vision/onnx_writer.h"

namespace ed3r::perception {
namespace {

namespace fs = std::filesystem;
using Ints = std::vector<std::int64_t>;
using Attributes = std::vector<test::OnnxAttribute>;

constexpr int kHeight = 9, kWidth = 12;

double Pixel(int channel, int y, int x) { return (channel * 61 + y * 29 + x * 17) % 256; }

class Forms : public testing::Test {
 protected:
  Forms() : file_(fs::temp_directory_path() / ("ed3r-forms-" + std::to_string(::getpid()) + ".onnx")) {
    config_.full = file_.string();
    config_.mean_red = config_.mean_green = config_.mean_blue = 128.0;
    config_.scale = 1.0 / 32.0;
    config_.input_width_px = kWidth, config_.input_height_px = kHeight;
    config_.output = DetectorOutput::kSigmoid;
    Begin();
  }
  ~Forms() override { fs::remove(file_); }

  void Begin() {
    model_ = test::OnnxWriter().Opset(13).Input("x", {1, 3, kHeight, kWidth}).Output("y", {1, test::kOpen});
  }

  // -4 .. 4, of both signs.
  static double In(int channel, int y, int x) { return (Pixel(channel, y, x) - 128.0) / 32.0; }

  std::unique_ptr<DetectorPair> Read() {
    model_.Step("Flatten", {"z"}, {"y"});
    std::ofstream(file_, std::ios::binary) << model_.Bytes();
    return std::make_unique<DetectorPair>(LoadDetectors(config_));
  }

  using Value = std::function<double(int, int, int)>;
  // That 'z' is [1, channels, height, width] of these values.
  void Expect(const std::string& what, int channels, int height, int width, const Value& value) {
    FrameStack frame{.frames = 1, .width_px = kWidth, .height_px = kHeight, .rgb = {}};
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        for (int c = 0; c < 3; ++c) frame.rgb.push_back(static_cast<std::uint8_t>(Pixel(c, y, x)));
    const test::OnnxWriter model = model_;
    for (const int at : {0, 1, width, height * width - 1, channels * height * width - 2}) {
      model_ = model;
      config_.output_index = at;
      double confidence = -1.0;
      Read()->full->Confidences(frame, std::span(&confidence, 1));
      const double expected = value(at / (height * width), at / width % height, at % width);
      EXPECT_NEAR(confidence, 1.0 / (1.0 + std::exp(-expected)), 2e-6) << what << " at " << at;
    }
    Begin();
  }

  void Refuses(const std::string& part) {
    try {
      Read();
      ADD_FAILURE() << "takes what should be refused: " << part;
    } catch (const UserError& error) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
    Begin();
  }

  fs::path file_;
  test::OnnxWriter model_;
  DetectorConfig config_;
};

TEST_F(Forms, ConvolutionsOfAllPaddings) {
  const auto conv = [&](const Attributes& attributes, int stride, int dilation, int top, int left, int height,
                        int width) {
    std::vector<float> kernel;
    for (int i = 0; i < 2 * 3 * 3 * 3; ++i) kernel.push_back(static_cast<float>(i * 7 % 11 - 5) / 16.0F);
    Attributes all = attributes;
    all.push_back({"kernel_shape", Ints{3, 3}});
    all.push_back({"strides", Ints{stride, stride}});
    model_.Weights("k", {2, 3, 3, 3}, kernel).Step("Conv", {"x", "k"}, {"z"}, all);
    Expect("Conv", 2, height, width, [=](int o, int y, int x) {
      double sum = 0.0;
      for (int i = 0; i < 27; ++i) {
        const int in_y = y * stride - top + i / 3 % 3 * dilation, in_x = x * stride - left + i % 3 * dilation;
        if (in_y < 0 || in_y >= kHeight || in_x < 0 || in_x >= kWidth) continue;
        sum += static_cast<double>(kernel[static_cast<std::size_t>(o * 27 + i)]) * In(i / 9, in_y, in_x);
      }
      return sum;
    });
  };
  conv({}, 1, 1, 0, 0, 7, 10);
  conv({{"pads", Ints{0, 1, 2, 1}}}, 2, 1, 0, 1, 5, 6);
  conv({{"auto_pad", std::string("SAME_UPPER")}}, 2, 1, 1, 0, 5, 6);
  conv({{"auto_pad", std::string("VALID")}}, 2, 1, 0, 0, 4, 5);
  conv({{"pads", Ints{2, 2, 2, 2}}, {"dilations", Ints{2, 2}}}, 1, 2, 2, 2, 9, 12);
}

TEST_F(Forms, SlopesAndOperandsOfChannels) {
  model_.Weights("s", {3, 1, 1}, {0.5F, -0.25F, 2.0F}).Step("PRelu", {"x", "s"}, {"z"});
  const double slopes[] = {0.5, -0.25, 2.0};
  Expect("PRelu", 3, kHeight, kWidth,
         [&](int c, int y, int x) { return In(c, y, x) * (In(c, y, x) < 0 ? slopes[c] : 1.0); });
  model_.Weights("s", {1, 3, 1, 1}, {0.5F, -0.25F, 2.0F}).Step("Sub", {"s", "x"}, {"z"});
  Expect("Sub", 3, kHeight, kWidth, [&](int c, int y, int x) { return slopes[c] - In(c, y, x); });
  model_.Weights("s", {kWidth}, std::vector<float>(kWidth, 0.5F)).Step("PRelu", {"x", "s"}, {"z"});
  Refuses(
      "operator PRelu (node 'the PRelu') has slopes [12] for [1, 3, 9, 12]; allowed: one slope, or one a "
      "channel");
  model_.Integers("s", {3}).Step("Mul", {"x", "s"}, {"z"});
  Refuses(
      "operator Mul (node 'the Mul') takes computed constant whole numbers; allowed: computed computed or");
}

TEST_F(Forms, GatesSpreadOverTheMap) {
  const auto mean = [&](int channel) {
    double sum = 0.0;
    for (int i = 0; i < kHeight * kWidth; ++i) sum += In(channel, i / kWidth, i % kWidth);
    return sum / (kHeight * kWidth);
  };
  for (const bool first : {false, true}) {
    model_.Step("GlobalAveragePool", {"x"}, {"g"});
    model_.Step("Mul", {first ? "g" : "x", first ? "x" : "g"}, {"z"});
    Expect("Mul", 3, kHeight, kWidth, [&](int c, int y, int x) { return In(c, y, x) * mean(c); });
  }
  model_.Step("GlobalAveragePool", {"x"}, {"g"}).Step("Add", {"x", "g"}, {"z"});
  Expect("Add", 3, kHeight, kWidth, [&](int c, int y, int x) { return In(c, y, x) + mean(c); });
  model_.Step("GlobalAveragePool", {"x"}, {"g"}).Step("Add", {"g", "x"}, {"z"});
  Refuses("operator Add (node 'the Add') takes [1, 3, 1, 1] and [1, 3, 9, 12]; allowed: equal shapes, or");
  model_.Step("ReduceMean", {"x"}, {"rows"}, {{"axes", Ints{3}}});
  model_.Step("MaxPool", {"x"}, {"columns"}, {{"kernel_shape", Ints{kHeight, 1}}});
  model_.Step("Div", {"rows", "columns"}, {"z"});
  Refuses("takes [1, 3, 9, 1] and [1, 3, 1, 12]; allowed: equal shapes, or");
}

// OpenCV takes the Mul for a mish of the Softplus' operand.
TEST_F(Forms, WhatLooksLikeAMishIsNone) {
  model_.Step("Softplus", {"x"}, {"p"})
      .Step("Tanh", {"p"}, {"t"})
      .Step("Neg", {"x"}, {"n"})
      .Step("Mul", {"n", "t"}, {"z"});
  Expect("Mul", 3, kHeight, kWidth,
         [&](int c, int y, int x) { return -In(c, y, x) * std::tanh(std::log1p(std::exp(In(c, y, x)))); });
}

// OpenCV takes the Mul for a swish or a celu, whatever the other operand is.
TEST_F(Forms, WhatLooksLikeASwishOrACeluIsNone) {
  const auto hard = [](double a) { return std::clamp(a / 6 + 0.5, 0.0, 1.0); };
  const Attributes swish = {{"alpha", 1.0F / 6}, {"beta", 0.5F}};
  for (const bool first : {false, true}) {
    model_.Step("Neg", {"x"}, {"n"}).Step("HardSigmoid", {"n"}, {"h"}, swish);
    model_.Step("Mul", {first ? "h" : "x", first ? "x" : "h"}, {"z"});
    Expect("Mul", 3, kHeight, kWidth, [&](int c, int y, int x) { return In(c, y, x) * hard(-In(c, y, x)); });
  }
  model_.Step("HardSigmoid", {"x"}, {"z"}, swish);
  Expect("HardSigmoid", 3, kHeight, kWidth, [&](int c, int y, int x) { return hard(In(c, y, x)); });
  const auto elu = [](double a) { return a > 0 ? a : std::expm1(a); };
  for (const bool constant : {false, true}) {
    model_.Weights("two", {1}, {2}).Weights("three", {1}, {3}).Step("Div", {"x", "two"}, {"d"});
    model_.Step("Elu", {"d"}, {"e"}).Step("Mul", {"e", constant ? "three" : "x"}, {"z"});
    Expect("Mul", 3, kHeight, kWidth,
           [&](int c, int y, int x) { return (constant ? 3 : In(c, y, x)) * elu(In(c, y, x) / 2); });
  }
}

// As sums of squares and of exponentials are put in parts, here over values that are not those divided.
TEST_F(Forms, WhatLooksLikeANormOrASoftmaxIsNone) {
  const auto sum = [&](int y, int x, const std::function<double(double)>& of) {
    return of(In(0, y, x)) + of(In(1, y, x)) + of(In(2, y, x));
  };
  const test::OnnxAttribute axes = {"axes", Ints{1}};
  model_.Step("Neg", {"x"}, {"n"}).Step("Exp", {"n"}, {"e"}).Step("Exp", {"x"}, {"p"});
  model_.Opset(12).Step("ReduceSum", {"p"}, {"s"}, {axes}).Step("Div", {"e", "s"}, {"z"});
  Expect("exponentials", 3, kHeight, kWidth, [&](int c, int y, int x) {
    return std::exp(-In(c, y, x)) / sum(y, x, [](double a) { return std::exp(a); });
  });
  model_.Weights("ten", {1}, {10}).Step("Add", {"x", "ten"}, {"p"}).Step("ReduceL2", {"p"}, {"s"}, {axes});
  model_.Step("Div", {"x", "s"}, {"z"});
  Expect("lengths", 3, kHeight, kWidth, [&](int c, int y, int x) {
    return In(c, y, x) / std::sqrt(sum(y, x, [](double a) { return (a + 10) * (a + 10); }));
  });
  model_.Weights("ten", {1}, {10}).Step("Add", {"x", "ten"}, {"p"}).Step("Mul", {"p", "p"}, {"q"});
  model_.Opset(12).Step("ReduceSum", {"q"}, {"r"}, {axes}).Step("Sqrt", {"r"}, {"s"});
  model_.Step("Div", {"x", "s"}, {"z"});
  Expect("roots", 3, kHeight, kWidth, [&](int c, int y, int x) {
    return In(c, y, x) / std::sqrt(sum(y, x, [](double a) { return (a + 10) * (a + 10); }));
  });
}

TEST_F(Forms, MapsAreMadeLargerByWholeFactors) {
  const auto resize = [&](float scale, const Attributes& attributes) {
    Attributes all = attributes;
    all.push_back({"mode", std::string("nearest")});
    model_.Weights("s", {4}, {1, 1, scale, scale}).Step("Resize", {"x", "", "s"}, {"z"}, all);
  };
  const test::OnnxAttribute asymmetric = {"coordinate_transformation_mode", std::string("asymmetric")};
  const test::OnnxAttribute floor = {"nearest_mode", std::string("floor")};
  const auto value = [&](int c, int y, int x) { return In(c, y / 3, x / 3); };
  resize(3, {asymmetric, floor});
  Expect("Resize", 3, 3 * kHeight, 3 * kWidth, value);
  resize(3, {});
  Expect("Resize", 3, 3 * kHeight, 3 * kWidth, value);
  resize(3, {asymmetric});
  Refuses(
      "operator Resize (node 'the Resize') makes 27 of side 2 of [1, 3, 9, 12]; allowed: scales that give "
      "whole");
  resize(1.5F, {asymmetric, floor});
  Refuses("makes 13.5 of side 2 of [1, 3, 9, 12]");
  resize(2, {asymmetric, {"nearest_mode", std::string("ceil")}});
  Refuses("has nearest_mode = ceil; allowed: floor, round_prefer_floor");
}

TEST_F(Forms, WhatIsNotInTheTableIsRefused) {
  model_.Step("Concat", {"x"}, {"z"}, {{"axis", std::int64_t{1}}});
  Refuses(
      "operator Concat (node 'the Concat') takes computed; allowed: computed computed computed (and more)");
  model_.Integers("i", {-1}).Step("Gather", {"x", "i"}, {"z"}, {{"axis", std::int64_t{1}}});
  Refuses("takes [-1] of side 1 of [1, 3, 9, 12]; allowed: one constant index from 0 on, or a Slice");
  model_.Step("MaxPool", {"x"}, {"z"},
              {{"kernel_shape", Ints{2, 2}}, {"strides", Ints{3, 3}}, {"ceil_mode", std::int64_t{1}}});
  Refuses("has ceil_mode = 1 and a last window that begins beyond [1, 3, 9, 12]");
  model_.Opset(24).Step("Relu", {"x"}, {"z"});
  Refuses("has operators of version (opset) 24; allowed: 6 .. 23");
}

TEST_F(Forms, ADivisorIsThatForNoOtherStep) {
  model_.Weights("s", {1, 3, 1, 1}, {0.5F, 2.0F, 4.0F})
      .Step("Div", {"x", "s"}, {"d"})
      .Step("Neg", {"d"}, {"n"});
  model_.Step("Div", {"n", "s"}, {"e"}).Step("Mul", {"e", "s"}, {"z"});
  const double divisors[] = {0.5, 2.0, 4.0};
  Expect("Div", 3, kHeight, kWidth, [&](int c, int y, int x) { return -In(c, y, x) / divisors[c]; });
}

TEST_F(Forms, ASideOfOneIsTheMiddleOrRefused) {
  const auto resize = [&](const std::string& coordinates) {
    model_.Integers("s", {1, 3, 1, kWidth})
        .Step("Resize", {"x", "", "", "s"}, {"z"},
              {{"mode", std::string("linear")}, {"coordinate_transformation_mode", coordinates}});
  };
  resize("half_pixel");
  Expect("half_pixel", 3, 1, kWidth, [&](int c, int, int x) { return In(c, kHeight / 2, x); });
  resize("align_corners");
  Expect("align_corners", 3, 1, kWidth, [&](int c, int, int x) { return In(c, 0, x); });
  for (const std::string maker : {"pytorch", "tool"}) {
    model_.Producer(maker).Integers("s", {1, 3, 1, kWidth});
    model_.Step("Resize", {"x", "", "", "s"}, {"z"}, {{"mode", std::string("linear")}});
    Expect(maker, 3, 1, kWidth, [&](int c, int, int x) { return In(c, kHeight / 2, x); });
  }
  resize("pytorch_half_pixel");
  Refuses(
      "makes 1 of side 2 of [1, 3, 9, 12]; allowed: scales that give whole heights and widths, with nearest");
  model_.Integers("s", {1, 3, 29, kWidth})
      .Step("Resize", {"x", "", "", "s"}, {"z"},
            {{"mode", std::string("nearest")},
             {"coordinate_transformation_mode", std::string("asymmetric")},
             {"nearest_mode", std::string("floor")}});
  Refuses("makes 29 of side 2 of [1, 3, 9, 12]; allowed: scales that give whole heights and widths");
}

TEST_F(Forms, AttributesOfAnotherKindAreRefused) {
  model_.Weights("k", {3, 1, 1, 1}, {1, 1, 1});
  const auto conv = [&](const test::OnnxAttribute& group) {
    model_.Weights("k", {3, 1, 1, 1}, {1, 1, 1})
        .Step("ConvTranspose", {"x", "k"}, {"z"}, {{"kernel_shape", Ints{1, 1}}, group});
  };
  const std::string group =
      "operator ConvTranspose (node 'the ConvTranspose') has group that is not a whole number";
  Begin();
  conv({"group", 0.0F});
  Refuses(group + "; allowed: a whole number");
  conv({"group", std::string("all")});
  Refuses(group);
  conv({"group", Ints{3}});
  Refuses(group);
  model_.Step("Softmax", {"x"}, {"z"}, {{"axis", std::nanf("")}});
  Refuses("operator Softmax (node 'the Softmax') has axis that is not a whole number");
  model_.Step("Elu", {"x"}, {"z"}, {{"alpha", std::int64_t{2}}});
  Refuses("operator Elu (node 'the Elu') has alpha that is not a float; allowed: a float");
  model_.Step("MaxPool", {"x"}, {"z"}, {{"kernel_shape", std::int64_t{2}}});
  Refuses("has kernel_shape that is not a list of whole numbers");
}

TEST_F(Forms, RefusalsShowNoMarksOfTheTable) {
  model_.Step("Concat", {"x", "x"}, {"z"});
  Refuses("operator Concat (node 'the Concat') has no axis; allowed: axis");
  model_.Step("MaxPool", {"x"}, {"z"}, {{"kernel_shape", Ints{2, 2}}, {"padding", std::int64_t{1}}});
  Refuses(
      "has padding = 1; allowed attributes: kernel_shape, strides, pads, auto_pad = NOTSET or VALID or "
      "SAME_UPPER, ceil_mode, count_include_pad, storage_order = 0, dilations = 1");
  model_.Opset(10).Weights("s", {4}, {1, 1, 2, 2});
  model_.Step("Resize", {"x", "s"}, {"z"}, {{"mode", std::string("linear")}});
  Refuses("operator Resize (node 'the Resize') has mode = linear; allowed: nearest");
}

// As PyTorch writes shared weights, views and squeezed means.
TEST_F(Forms, WhatExportersWriteIsRead) {
  const auto whole = [&](int c, int y, int x) { return In(c, y, x); };
  model_.Opset(14).Integers("s", {1, 3, kHeight, -1});
  model_.Step("Reshape", {"x", "s"}, {"z"}, {{"allowzero", std::int64_t{1}}});
  Expect("Reshape", 3, kHeight, kWidth, whole);
  model_.Opset(14).Integers("s", {0, 3, kHeight, kWidth});
  model_.Step("Reshape", {"x", "s"}, {"z"}, {{"allowzero", std::int64_t{1}}});
  Refuses("makes [0, 3, 9, 12] with allowzero = 1: of nothing; allowed: sides from 1 on, or one of -1");

  model_.Weights("s", {1, 3, 1, 1}, {0.5F, 2.0F, 4.0F}).Step("Identity", {"s"}, {"t"});
  model_.Step("Identity", {"t"}, {"u"}).Step("Mul", {"x", "u"}, {"z"});
  const double factors[] = {0.5, 2.0, 4.0};
  Expect("Identity", 3, kHeight, kWidth, [&](int c, int y, int x) { return In(c, y, x) * factors[c]; });

  model_.Step("ReduceMean", {"x"}, {"m"}, {{"axes", Ints{3}}}).Integers("a", {-1});
  model_.Step("Squeeze", {"m", "a"}, {"z"});
  Expect("Squeeze", 3, kHeight, 1, [&](int c, int y, int) {
    double sum = 0.0;
    for (int i = 0; i < kWidth; ++i) sum += In(c, y, i);
    return sum / kWidth;
  });

  model_.Integers("from", {-100}).Integers("to", {5}).Integers("a", {3});
  model_.Step("Slice", {"x", "from", "to", "a"}, {"z"});
  Expect("Slice", 3, kHeight, 5, whole);

  model_.Weights("one", {3}, {1, 1, 1}).Weights("nought", {3}, {0, 0, 0});
  model_.Step("InstanceNormalization", {"x", "one", "nought"}, {"z"});
  Expect("InstanceNormalization", 3, kHeight, kWidth, [&](int c, int y, int x) {
    double sum = 0.0, squares = 0.0;
    for (int i = 0; i < kHeight * kWidth; ++i) {
      const double value = In(c, i / kWidth, i % kWidth);
      sum += value / (kHeight * kWidth), squares += value * value / (kHeight * kWidth);
    }
    return (In(c, y, x) - sum) / std::sqrt(squares - sum * sum + 1e-5);
  });
}

// 9 / 2 = 4 rows of 81 values each, averaged.
TEST_F(Forms, SizesAreDividedAsWholeNumbers) {
  const auto rows = [&](bool floats) {
    model_.Integers("at", {2}).Integers("two", {2}).Integers("rest", {-1}).Step("Shape", {"x"}, {"sides"});
    model_.Step("Gather", {"sides", "at"}, {"h"});
    if (floats) model_.Step("Cast", {"h"}, {"f"}, {{"to", std::int64_t{1}}});
    model_.Step("Div", {floats ? "f" : "h", "two"}, {"half"});
    model_.Step("Concat", {"half", "rest"}, {"shape"}, {{"axis", std::int64_t{0}}});
    model_.Step("Reshape", {"x", "shape"}, {"r"}).Step("ReduceMean", {"r"}, {"z"}, {{"axes", Ints{1}}});
  };
  rows(false);
  Expect("Div", 1, 4, 1, [&](int, int row, int) {
    double sum = 0.0;
    for (int i = row * 81; i < (row + 1) * 81; ++i)
      sum += In(i / (kHeight * kWidth), i / kWidth % kHeight, i % kWidth);
    return sum / 81;
  });
  rows(true);
  Refuses("operator Div (node 'the Div') divides sizes that were made float; allowed: int64");
}

}  // namespace
}  // namespace ed3r::perception
