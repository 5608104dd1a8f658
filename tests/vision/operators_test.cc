// What detectors are made of, through OpenCV's reader, against numbers worked out by hand: where it reads a step otherwise
// than the ONNX standard says, the answer must be the standard's or a refusal that names the step.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "engine/core/check.h"
#include "engine/perception/vision/frame_detector.h"
#include "tests/vision/onnx_writer.h"

namespace ed3r::perception {
namespace {

namespace fs = std::filesystem;
using test::OnnxAttribute;
using test::OnnxWriter;
using Ints = std::vector<std::int64_t>;

// An 8 x 8 frame whose pixel (x, y) is (16 + x, 100 + 2 y, 3 x): over 256, exact in single precision.
FrameStack Pattern() {
  FrameStack frame{.frames = 1, .width_px = 8, .height_px = 8, .rgb = {}};
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x)
      for (const int colour : {16 + x, 100 + 2 * y, 3 * x})
        frame.rgb.push_back(static_cast<std::uint8_t>(colour));
  return frame;
}

class Operators : public testing::Test {
 protected:
  Operators()
      : file_(fs::temp_directory_path() / ("ed3r-operators-" + std::to_string(::getpid()) + ".onnx")) {
    model_.Input("frame", {1, 3, 8, 8}).Output("y", {test::kOpen, test::kOpen});
    config_.full = file_.string();
    config_.scale = 1.0 / 256.0;
    config_.output = DetectorOutput::kSigmoid;
    config_.input_width_px = config_.input_height_px = 8;
  }
  ~Operators() override { fs::remove(file_); }

  // The logit that value `index` of the output 'y' is.
  double Value(int index) {
    std::ofstream(file_, std::ios::binary) << model_.Bytes();
    config_.output_index = index;
    double confidence = -1.0;
    LoadDetectors(config_).full->Confidences(Pattern(), std::span(&confidence, 1));
    return std::log(confidence / (1.0 - confidence));
  }

  void Expect(const std::vector<double>& values) {
    for (std::size_t i = 0; i < values.size(); ++i)
      EXPECT_NEAR(Value(static_cast<int>(i)), values[i], 2e-6) << i;
  }

  void ExpectRefusal(const std::string& part) {
    try {
      const double value = Value(0);
      ADD_FAILURE() << "gives " << value;
    } catch (const UserError& error) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
    }
  }

  // 'flat' [1, 3]: the means of the channels: 19.5, 107 and 10.5 of 256.
  test::OnnxWriter& Means() {
    return model_.Step("GlobalAveragePool", {"frame"}, {"means"})
        .Step("Flatten", {"means"}, {"flat"}, {{"axis", std::int64_t{1}}});
  }

  const double red_ = 19.5 / 256, green_ = 107.0 / 256, blue_ = 10.5 / 256;
  fs::path file_;
  test::OnnxWriter model_;
  DetectorConfig config_;
};

TEST_F(Operators, GemmOfASquareMatrixIsNotTurnedRound) {
  Means().Weights("w", {3, 3}, {1, 2, 0, 0, 1, 0, 4, 0, 1}).Weights("b", {3}, {0, 0.5F, 0});
  model_.Step("Gemm", {"flat", "w", "b"}, {"y"});
  Expect({red_ + 4 * blue_, 2 * red_ + green_ + 0.5, blue_});
}

TEST_F(Operators, GemmWithTransBIsTakenAsItStands) {
  Means().Weights("w", {2, 3}, {1, 2, 0, 0, 1, 4});
  model_.Step("Gemm", {"flat", "w"}, {"y"}, {{"transB", std::int64_t{1}}});
  Expect({red_ + 2 * green_, green_ + 4 * blue_});
}

TEST_F(Operators, GemmWithFactorsIsRefused) {
  Means().Weights("w", {3, 3}, {1, 0, 0, 0, 1, 0, 0, 0, 1});
  model_.Step("Gemm", {"flat", "w"}, {"y"}, {{"alpha", 0.5F}});
  ExpectRefusal("operator Gemm (node 'the Gemm') has alpha = 0.5; allowed: 1");
}

// OpenCV gave 0.74 for 0.68.
TEST_F(Operators, QuantisedNumbersAreRefused) {
  model_.Weights("scale", {}, {1.0F / 255.0F});
  model_.Step("QuantizeLinear", {"frame", "scale"}, {"q"})
      .Step("DequantizeLinear", {"q", "scale"}, {"frame2"});
  model_.Step("GlobalAveragePool", {"frame2"}, {"means"}).Step("Flatten", {"means"}, {"y"});
  ExpectRefusal(
      "operator QuantizeLinear (node 'the QuantizeLinear') is not among those that OpenCV is known to read "
      "as "
      "the standard says; allowed: Abs, Add,");
}

// OpenCV pads the other side, and passes over the dilations of pools.
TEST_F(Operators, WindowsThatOpenCvReadsOtherwiseAreRefused) {
  using Numbers = std::vector<std::int64_t>;
  const test::OnnxWriter empty = model_;
  model_.Step(
      "MaxPool", {"frame"}, {"m"},
      {{"kernel_shape", Numbers{3, 3}}, {"strides", Numbers{2, 2}}, {"auto_pad", std::string("SAME_LOWER")}});
  model_.Step("GlobalAveragePool", {"m"}, {"means"}).Step("Flatten", {"means"}, {"y"});
  ExpectRefusal(
      "operator MaxPool (node 'the MaxPool') has auto_pad = SAME_LOWER; allowed: NOTSET, VALID, SAME_UPPER");
  model_ = empty;
  model_.Step("MaxPool", {"frame"}, {"m"}, {{"kernel_shape", Numbers{2, 2}}, {"dilations", Numbers{2, 2}}});
  model_.Step("GlobalAveragePool", {"m"}, {"means"}).Step("Flatten", {"means"}, {"y"});
  ExpectRefusal("has dilations = 2; allowed: 1");
}

TEST_F(Operators, MatMulAndAdd) {
  Means().Weights("w", {3, 2}, {1, 2, 0, 1, 4, 0}).Weights("b", {2}, {0.25F, -0.5F});
  model_.Step("MatMul", {"flat", "w"}, {"m"}).Step("Add", {"m", "b"}, {"y"});
  Expect({red_ + 4 * blue_ + 0.25, 2 * red_ + green_ - 0.5});
}

TEST_F(Operators, ActivationsWithAndWithoutTheirAttributes) {
  const auto through = [&](const std::string& op, const std::vector<test::OnnxAttribute>& attributes,
                           double at, double expected) {
    model_ = test::OnnxWriter().Input("frame", {1, 3, 8, 8}).Output("y", {1, 3});
    Means().Weights("shift", {3}, {static_cast<float>(at - red_), 0, 0});
    model_.Step("Add", {"flat", "shift"}, {"x"}).Step(op, {"x"}, {"y"}, attributes);
    EXPECT_NEAR(Value(0), expected, 2e-6) << op << " at " << at;
  };
  through("Relu", {}, -0.5, 0.0);
  through("Relu", {}, 0.5, 0.5);
  through("LeakyRelu", {}, -0.5, -0.005);
  through("LeakyRelu", {{"alpha", 0.25F}}, -0.5, -0.125);
  through("Elu", {}, -0.5, std::expm1(-0.5));
  through("Elu", {{"alpha", 0.5F}}, -0.5, 0.5 * std::expm1(-0.5));
  through("HardSigmoid", {}, 0.5, 0.6);
  through("HardSigmoid", {{"alpha", 0.25F}, {"beta", 0.25F}}, 0.5, 0.375);
  through("Selu", {}, -0.5, 1.0507009873554805 * 1.6732632423543772 * std::expm1(-0.5));
  through("Tanh", {}, 0.5, std::tanh(0.5));
  through("Softplus", {}, 0.5, std::log1p(std::exp(0.5)));
  through("Sqrt", {}, 0.25, 0.5);
  through("Exp", {}, 0.25, std::exp(0.25));
  through("Neg", {}, 0.25, -0.25);
}

TEST_F(Operators, ClipTakesItsBoundsFromInputs) {
  Means().Weights("low", {}, {0.05F}).Weights("high", {}, {0.4F});
  model_.Step("Clip", {"flat", "low", "high"}, {"y"});
  Expect({red_, static_cast<double>(0.4F), static_cast<double>(0.05F)});
}

TEST_F(Operators, BatchNormalization) {
  Means()
      .Weights("gain", {3}, {2, 1, 4})
      .Weights("bias", {3}, {0.5F, 0, -1})
      .Weights("mean", {3}, {0.25F, 0, 0})
      .Weights("var", {3}, {0.25F, 1, 4});
  model_.Step("BatchNormalization", {"means", "gain", "bias", "mean", "var"}, {"n"})
      .Step("Flatten", {"n"}, {"y"}, {{"axis", std::int64_t{1}}});
  const auto expected = [](double x, double gain, double bias, double mean, double var) {
    return gain * (x - mean) / std::sqrt(var + 1e-5) + bias;
  };
  Expect({expected(red_, 2, 0.5, 0.25, 0.25), expected(green_, 1, 0, 0, 1), expected(blue_, 4, -1, 0, 4)});
}

// Of red 16 + x: 2 x 2 windows in steps of 2 and one pixel of padding around.
TEST_F(Operators, AveragesCountTheirPaddingAsTheModelSays) {
  const auto pool = [&](bool counts, const std::string& producer) {
    model_ = test::OnnxWriter().Input("frame", {1, 3, 8, 8}).Output("y", {1, 75});
    std::vector<test::OnnxAttribute> attributes = {
        {"kernel_shape", Ints{2, 2}}, {"strides", Ints{2, 2}}, {"pads", Ints{1, 1, 1, 1}}};
    if (counts) attributes.push_back({"count_include_pad", std::int64_t{1}});
    model_.Producer(producer).Step("AveragePool", {"frame"}, {"p"}, attributes);
    model_.Step("Flatten", {"p"}, {"y"}, {{"axis", std::int64_t{1}}});
  };
  for (const std::string producer : {"tool", "pytorch"}) {
    pool(false, producer);
    Expect({16.0 / 256, 17.5 / 256});
    pool(true, producer);
    Expect({16.0 / 4 / 256, 17.5 / 2 / 256});
  }
  model_ = test::OnnxWriter().Input("frame", {1, 3, 8, 8}).Output("y", {1, 192});
  const std::vector<test::OnnxAttribute> window = {{"kernel_shape", Ints{3, 3}}, {"pads", Ints{1, 1, 1, 1}}};
  std::vector<test::OnnxAttribute> counting = window;
  counting.push_back({"count_include_pad", std::int64_t{1}});
  model_.Step("AveragePool", {"frame"}, {"p"}, window).Step("AveragePool", {"p"}, {"q"}, counting);
  model_.Step("Flatten", {"q"}, {"y"}, {{"axis", std::int64_t{1}}});
  ExpectRefusal(
      "operator AveragePool (node 'the AveragePool') has count_include_pad = 1, and one before it 0; "
      "allowed: alike");
}

TEST_F(Operators, WindowsThatDoNotFitAreCutOrCounted) {
  const auto pool = [&](const std::vector<test::OnnxAttribute>& more) {
    model_ = test::OnnxWriter().Input("frame", {1, 3, 8, 8}).Output("y", {test::kOpen, test::kOpen});
    std::vector<test::OnnxAttribute> attributes = {{"kernel_shape", Ints{3, 3}}, {"strides", Ints{3, 3}}};
    attributes.insert(attributes.end(), more.begin(), more.end());
    model_.Step("MaxPool", {"frame"}, {"p"}, attributes);
    model_.Step("Flatten", {"p"}, {"y"}, {{"axis", std::int64_t{1}}});
  };
  pool({});
  Expect({18.0 / 256, 21.0 / 256, 18.0 / 256});
  pool({{"ceil_mode", std::int64_t{1}}});
  Expect({18.0 / 256, 21.0 / 256, 23.0 / 256, 18.0 / 256});
}

TEST_F(Operators, ConvolutionsWithPaddingStridesAndGroups) {
  model_.Weights("k", {3, 1, 2, 2}, {1, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1}).Weights("b", {3}, {0.5F, 0, 0});
  model_.Step("Conv", {"frame", "k", "b"}, {"c"},
              {{"kernel_shape", Ints{2, 2}},
               {"strides", Ints{4, 4}},
               {"pads", Ints{0, 1, 0, 0}},
               {"group", std::int64_t{3}}});
  model_.Step("Flatten", {"c"}, {"y"}, {{"axis", std::int64_t{1}}});
  // Columns -1 and 3 of the left corners, rows 0 and 4.
  Expect({0.5, 0.5 + 19.0 / 256, 0.5, 0.5 + 19.0 / 256, 102.0 / 256, 102.0 / 256});
}

TEST_F(Operators, SoftmaxOverTheChannelsOfAVector) {
  config_.output = DetectorOutput::kProbability;
  Means().Step("Softmax", {"flat"}, {"y"});
  std::ofstream(file_, std::ios::binary) << model_.Bytes();
  double confidence = -1.0;
  LoadDetectors(config_).full->Confidences(Pattern(), std::span(&confidence, 1));
  EXPECT_NEAR(confidence, std::exp(red_) / (std::exp(red_) + std::exp(green_) + std::exp(blue_)), 1e-6);
}

// The standard's axis is the last since opset 13; OpenCV takes side 1. Green is 100 + 2 y alike along x: an eighth each.
TEST_F(Operators, SoftmaxWithoutAnAxisGoesByTheOpset) {
  model_ = test::OnnxWriter().Input("frame", {1, 3, 8, 8}).Output("y", {1, 192});
  model_.Opset(13).Step("Softmax", {"frame"}, {"s"}).Step("Flatten", {"s"}, {"y"});
  EXPECT_NEAR(Value(64), 0.125, 2e-6);
  EXPECT_NEAR(Value(127), 0.125, 2e-6);
}

TEST_F(Operators, ReductionsKeepOrDropTheirSides) {
  for (const std::int64_t keep : {0, 1}) {
    model_ = test::OnnxWriter().Input("frame", {1, 3, 8, 8}).Output("y", {1, 3});
    model_.Step("ReduceMean", {"frame"}, {"m"}, {{"axes", Ints{2, 3}}, {"keepdims", keep}});
    model_.Step("Flatten", {"m"}, {"y"}, {{"axis", std::int64_t{1}}});
    Expect({red_, green_, blue_});
  }
}

TEST_F(Operators, PartsAreJoinedAndScaled) {
  Means().Weights("half", {1}, {0.5F});
  model_.Step("Mul", {"flat", "half"}, {"h"})
      .Step("Concat", {"h", "flat"}, {"y"}, {{"axis", std::int64_t{1}}});
  Expect({red_ / 2, green_ / 2, blue_ / 2, red_, green_, blue_});
}

TEST_F(Operators, SplitTakesItsSizesFromAnInput) {
  Means().Integers("sizes", {2, 1});
  model_.Step("Split", {"flat", "sizes"}, {"a", "b"}, {{"axis", std::int64_t{1}}});
  model_.Step("Concat", {"b", "a"}, {"y"}, {{"axis", std::int64_t{1}}});
  Expect({blue_, red_, green_});
  model_ = test::OnnxWriter().Input("frame", {1, 3, 8, 8}).Output("y", {1, 3});
  Means().Step("Shape", {"flat"}, {"sizes"}).Step("Split", {"flat", "sizes"}, {"y", "b"});
  ExpectRefusal(
      "operator Split (node 'the Split') takes computed whole numbers; allowed: computed constant whole "
      "numbers");
}

TEST_F(Operators, ReductionsTakeTheirAxesFromAnInput) {
  model_.Integers("axes", {2, 3});
  model_.Step("ReduceMean", {"frame", "axes"}, {"y"}, {{"keepdims", std::int64_t{0}}});
  Expect({red_, green_, blue_});
  model_ = test::OnnxWriter().Input("frame", {1, 3, 8, 8}).Output("y", {1, 3});
  model_.Step("Shape", {"frame"}, {"axes"}).Step("ReduceMax", {"frame", "axes"}, {"y"});
  ExpectRefusal(
      "operator ReduceMax (node 'the ReduceMax') takes computed whole numbers; allowed: computed constant");
}

TEST_F(Operators, AConstantVectorByWhatIsComputedIsRefused) {
  Means().Weights("c", {3}, {1, 2, 4}).Step("Div", {"c", "flat"}, {"y"});
  ExpectRefusal("operator Div (node 'the Div') divides a constant of several numbers");
  model_ = test::OnnxWriter().Input("frame", {1, 3, 8, 8}).Output("y", {1, 3});
  Means().Weights("c", {}, {0.25F}).Step("Exp", {"flat"}, {"e"}).Step("Div", {"c", "e"}, {"y"});
  Expect({0.25 * std::exp(-red_), 0.25 * std::exp(-green_), 0.25 * std::exp(-blue_)});
}

// OpenCV passes over them, or pads as if they were 1.
TEST_F(Operators, DilationsThatOpenCvPassesOverAreRefused) {
  const auto through = [&](const std::string& op, const std::vector<test::OnnxAttribute>& attributes,
                           const std::string& refusal) {
    model_ = test::OnnxWriter().Input("frame", {1, 3, 8, 8}).Output("y", {1, 1});
    model_.Weights("k", {3, 1, 1, 1}, {1, 1, 1}).Weights("k1", {1, 3, 1, 1}, {1, 1, 1});
    std::vector<test::OnnxAttribute> all = attributes;
    all.push_back({"kernel_shape", Ints{1, 1}});
    model_.Step(op, {"frame", op == "Conv" ? "k1" : "k"}, {"c"}, all);
    model_.Step("GlobalAveragePool", {"c"}, {"means"}).Step("Flatten", {"means"}, {"y"});
    ExpectRefusal("operator " + op + " (node 'the " + op + "') has " + refusal);
  };
  const test::OnnxAttribute dilations = {"dilations", Ints{2, 2}},
                            same = {"auto_pad", std::string("SAME_UPPER")};
  through("Conv", {dilations, same}, "dilations beside auto_pad");
  through("ConvTranspose", {dilations}, "dilations = 2; allowed: 1");
  through("ConvTranspose", {same}, "auto_pad = SAME_UPPER; allowed: NOTSET, VALID");
  through("ConvTranspose", {{"output_shape", Ints{8, 8}}}, "output_shape = 8, 8; allowed attributes: ");
}

TEST_F(Operators, ResizeWithAntialiasIsRefused) {
  model_.Weights("s", {4}, {1, 1, 0.5F, 0.5F});
  model_.Step("Resize", {"frame", "", "s"}, {"r"},
              {{"mode", std::string("linear")}, {"antialias", std::int64_t{1}}});
  model_.Step("GlobalAveragePool", {"r"}, {"means"}).Step("Flatten", {"means"}, {"y"});
  ExpectRefusal("operator Resize (node 'the Resize') has antialias = 1");
}

TEST_F(Operators, AnOutputOfAnotherSizeThanDeclaredIsRefused) {
  model_ = test::OnnxWriter().Input("frame", {1, 3, 8, 8}).Output("y", {1, 4});
  Means().Step("Relu", {"flat"}, {"y"});
  ExpectRefusal(
      "its output 'y' is declared as [1, 4] and has 3 values as OpenCV reads the model; allowed: a model");
}

TEST_F(Operators, AMeanByItsMapIsRefusedAndTheMapByItsMeanIsNot) {
  model_.Step("Exp", {"frame"}, {"e"}).Step("GlobalAveragePool", {"e"}, {"m"});
  const test::OnnxWriter before = model_;
  model_.Step("Div", {"m", "e"}, {"d"}).Step("GlobalAveragePool", {"d"}, {"g"}).Step("Flatten", {"g"}, {"y"});
  ExpectRefusal(
      "operator Div (node 'the Div') takes [1, 3, 1, 1] and [1, 3, 8, 8]; allowed: equal shapes, or");
  model_ = before;
  model_.Step("Div", {"e", "m"}, {"d"}).Step("Relu", {"d"}, {"r"}).Step("Flatten", {"r"}, {"y"});
  double mean = 0.0;
  for (int x = 0; x < 8; ++x) mean += std::exp((16.0 + x) / 256) / 8;
  EXPECT_NEAR(Value(0), std::exp(16.0 / 256) / mean, 2e-6);
}

TEST_F(Operators, SoftmaxOfAMapBeforeOpset13IsRefused) {
  model_.Step("Softmax", {"frame"}, {"s"}, {{"axis", std::int64_t{1}}}).Step("Flatten", {"s"}, {"y"});
  ExpectRefusal("operator Softmax (node 'the Softmax') is taken of [1, 3, 8, 8] from side 1 on as one");
}

TEST_F(Operators, ACastThatCutsOffIsRefusedAndOneOfShapesIsNot) {
  Means().Step("Cast", {"flat"}, {"c"}, {{"to", std::int64_t{7}}});
  model_.Step("Cast", {"c"}, {"y"}, {{"to", std::int64_t{1}}});
  ExpectRefusal("operator Cast (node 'the Cast') has to = 7; allowed: 1, 10, 11");
  model_ = test::OnnxWriter().Input("frame", {1, 3, 8, 8}).Output("y", {1, 3});
  model_.Step("GlobalAveragePool", {"frame"}, {"m"}).Step("Shape", {"m"}, {"s"}).Integers("at", {0});
  model_.Step("Gather", {"s", "at"}, {"n"}, {{"axis", std::int64_t{0}}}).Integers("rest", {-1});
  model_.Step("Cast", {"n"}, {"i"}, {{"to", std::int64_t{7}}});
  model_.Step("Concat", {"i", "rest"}, {"to"}, {{"axis", std::int64_t{0}}})
      .Step("Reshape", {"m", "to"}, {"y"});
  Expect({red_, green_, blue_});
}

TEST_F(Operators, DifferencesAndQuotientsKeepTheirOrder) {
  Means().Weights("c", {3}, {0.5F, 0.25F, 2}).Step("Sub", {"c", "flat"}, {"s"});
  model_.Step("Div", {"s", "c"}, {"y"});
  Expect({(0.5 - red_) / 0.5, (0.25 - green_) / 0.25, (2 - blue_) / 2});
}

}  // namespace
}  // namespace ed3r::perception
