// Detectors that people bring: what they declare is kept, what does not fit is refused, and nothing is read wrongly without
// a word.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

#include "engine/core/check.h"
#include "engine/perception/vision/frame_detector.h"
#include "tests/vision/onnx_writer.h"

namespace ed3r::perception {
namespace {

namespace fs = std::filesystem;
using test::AddRedMinusBlue;
using test::kOpen;
using test::OnnxWriter;
using test::RedMinusBlue;

double Sigmoid(double logit) { return 1.0 / (1.0 + std::exp(-logit)); }

// One colour all over; single precision holds the bytes over 256 exactly, so that the models' sums have no rounding.
FrameStack Frame(int red, int green, int blue, int width_px = 96, int height_px = 54) {
  FrameStack stack{.frames = 1, .width_px = width_px, .height_px = height_px, .rgb = {}};
  for (int p = 0; p < width_px * height_px; ++p)
    for (const int colour : {red, green, blue}) stack.rgb.push_back(static_cast<std::uint8_t>(colour));
  return stack;
}

const FrameStack kFrame = Frame(200, 90, 136);  // red - blue = 64 = 0.25 x 256
const double kExpected = Sigmoid(0.5 + 4 * 0.25);

class OwnDetector : public testing::Test {
 protected:
  OwnDetector() : folder_(fs::temp_directory_path() / ("ed3r-own-" + std::to_string(::getpid()))) {
    fs::create_directories(folder_);
    config_.full = (folder_ / "mine.onnx").string();
    config_.scale = 1.0 / 256.0;
    config_.output = DetectorOutput::kSigmoid;
  }
  ~OwnDetector() override { fs::remove_all(folder_); }

  void Write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
  }

  double Answer(const test::OnnxWriter& model, const FrameStack& frame = kFrame) const {
    Write("mine.onnx", model.Bytes());
    double confidence = -1.0;
    LoadDetectors(config_).full->Confidences(frame, std::span(&confidence, 1));
    return confidence;
  }

  // The message of the refusal; what the libraries say beside it would stand on stderr.
  std::string Refusal(const test::OnnxWriter& model, const FrameStack& frame = kFrame) const {
    testing::internal::CaptureStderr();
    std::string said = "accepted";
    try {
      said += " and answered " + std::to_string(Answer(model, frame));
    } catch (const UserError& error) {
      said = error.what();
    }
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    EXPECT_EQ(said.find('\n'), std::string::npos) << said;
    EXPECT_EQ(said.find("OpenCV("), std::string::npos) << said;
    return said;
  }

  void ExpectRefusal(const test::OnnxWriter& model, const std::vector<std::string>& parts) const {
    const std::string said = Refusal(model);
    EXPECT_TRUE(said.starts_with("perception.detector.")) << said;
    for (const std::string& part : parts)
      EXPECT_NE(said.find(part), std::string::npos) << part << "\n" << said;
  }

  fs::path folder_;
  DetectorConfig config_;
};

TEST_F(OwnDetector, ADeclaredSizeIsKeptOrTheMismatchRefused) {
  const test::OnnxWriter model = test::RedMinusBlue({1, 3, 64, 48});
  ExpectRefusal(model, {"takes frames of 48 x 64 pixels", "'frame' is [1, 3, 64, 48]", "are 96 and 54",
                        "set them to 48 and 64"});
  config_.input_width_px = 48;
  ExpectRefusal(model, {"are 48 and 54", "set them to 48 and 64"});
  config_.input_height_px = 64;
  EXPECT_NEAR(Answer(model), kExpected, 1e-6);
  config_.input_width_px = config_.input_height_px = 0;
  EXPECT_NEAR(Answer(model), kExpected, 1e-6);
  ExpectRefusal(test::RedMinusBlue({1, 3, 4, 4}),
                {"takes frames of 4 x 4 pixels; allowed: sides of 8 .. 2048"});
}

TEST_F(OwnDetector, OtherInputsAreRefused) {
  const std::string allowed = "[1, 3, height, width] or [1, height, width, 3]";
  ExpectRefusal(test::RedMinusBlue({1, 1, 54, 96}), {"[1, 1, 54, 96]: not three channels", allowed});
  ExpectRefusal(test::RedMinusBlue({1, 54, 96, 1}), {"[1, 54, 96, 1]: not three channels", allowed});
  ExpectRefusal(test::RedMinusBlue({8, 3, 54, 96}), {"[8, 3, 54, 96]: 8 frames at a time", allowed});
  ExpectRefusal(test::RedMinusBlue({3, 54, 96}), {"has the shape [3, 54, 96]", allowed});
  test::OnnxWriter bytes;
  bytes.Input("frame", {1, 3, 54, 96}, test::kUint8).Output("y", {1, 2});
  test::AddRedMinusBlue(bytes, "frame");
  ExpectRefusal(bytes, {"'frame' takes uint8", allowed});
  test::OnnxWriter two = test::RedMinusBlue({1, 3, 54, 96});
  two.Input("sizes", {1, 2});
  ExpectRefusal(two, {"has 2 inputs ('frame' [1, 3, 54, 96], 'sizes' [1, 2]); allowed: one"});
}

TEST_F(OwnDetector, ChannelsMayStandLast) {
  test::OnnxWriter model;
  model.Input("frame", {test::kOpen, 54, 96, 3}).Output("y", {test::kOpen, 2});
  model.Step("Transpose", {"frame"}, {"planes"}, {{"perm", std::vector<std::int64_t>{0, 3, 1, 2}}});
  test::AddRedMinusBlue(model, "planes");
  EXPECT_NEAR(Answer(model), kExpected, 1e-6);
  config_.channel_order = ChannelOrder::kBgr;
  EXPECT_NEAR(Answer(model), Sigmoid(0.5 - 4 * 0.25), 1e-6);
  config_.input_width_px = 54, config_.input_height_px = 96;
  ExpectRefusal(model, {"takes frames of 96 x 54 pixels"});
}

// As torch.onnx.export writes x.view(x.size(0), -1) with open sides.
TEST_F(OwnDetector, OpenSidesBecomeTheFrames) {
  EXPECT_NEAR(Answer(test::RedMinusBlue({test::kOpen, 3, test::kOpen, test::kOpen})), kExpected, 1e-6);
  EXPECT_NEAR(Answer(test::RedMinusBlue({test::kOpen, test::kOpen, test::kOpen, test::kOpen})), kExpected,
              1e-6);
  EXPECT_NEAR(Answer(test::RedMinusBlue({test::kOpenAsNumber, 3, test::kOpenAsNumber, test::kOpenAsNumber})),
              kExpected, 1e-6);
  test::OnnxWriter viewed;
  viewed.Input("frame", {test::kOpen, 3, test::kOpen, test::kOpen}).Output("y", {test::kOpen, 2});
  viewed.Weights("w", {3, 2}, {4, 0, 0, 0, -4, 0}).Weights("b", {2}, {0.5F, -0.25F});
  viewed.Integers("zero", {0}).Integers("rest", {-1});
  viewed.Step("GlobalAveragePool", {"frame"}, {"means"})
      .Step("Shape", {"means"}, {"shape"})
      .Step("Gather", {"shape", "zero"}, {"batch"}, {{"axis", std::int64_t{0}}})
      .Step("Concat", {"batch", "rest"}, {"flat_shape"}, {{"axis", std::int64_t{0}}})
      .Step("Reshape", {"means", "flat_shape"}, {"flat"})
      .Step("Gemm", {"flat", "w", "b"}, {"y"});
  EXPECT_NEAR(Answer(viewed), kExpected, 1e-6);
  config_.input_width_px = config_.input_height_px = 0;
  ExpectRefusal(viewed, {"leaves the size of its frames open", "input_width_px and input_height_px"});
}

// A map of two values a pixel, a score and a table of boxes.
test::OnnxWriter SeveralOutputs(const std::vector<std::string>& order) {
  test::OnnxWriter model;
  model.Input("frame", {1, 3, 54, 96});
  for (const std::string& output : order) {
    if (output == "map") model.Output("map", {1, 2, 54, 96});
    if (output == "open map") model.Output("map", {test::kOpen, test::kOpen, test::kOpen, test::kOpen});
    if (output == "boxes") model.Output("boxes", {1, 1728, 9});
    if (output == "label") model.Output("label", {1}, test::kInt64);
    if (output == "y") model.Output("y", {1, 2});
  }
  model.Weights("k", {2, 3, 1, 1}, {1, 0, 0, 0, 0, 1})
      .Step("Conv", {"frame", "k"}, {"map"}, {{"kernel_shape", std::vector<std::int64_t>{1, 1}}});
  model.Integers("s", {1, 1728, 9}).Step("Reshape", {"frame", "s"}, {"boxes"});
  model.Step("Nonsense", {"map"}, {"label"});  // of no concern to whoever does not ask for it
  test::AddRedMinusBlue(model, "frame");
  return model;
}

TEST_F(OwnDetector, TheFirstDeclaredOutputIsReadOrTheNamedOne) {
  EXPECT_NEAR(Answer(SeveralOutputs({"y", "map", "boxes", "label"})), kExpected, 1e-6);
  ExpectRefusal(SeveralOutputs({"map", "y"}),
                {"its output 'map' has the shape [1, 2, 54, 96]; allowed: one number, or one vector",
                 "perception.detector.output_name", "'y' [1, 2]"});
  ExpectRefusal(SeveralOutputs({"boxes", "y"}), {"'boxes' has the shape [1, 1728, 9]"});
  ExpectRefusal(SeveralOutputs({"label", "y"}), {"'label' is of int64; allowed: float", "'y' [1, 2]"});
  config_.output = DetectorOutput::kSoftmax;
  ExpectRefusal(SeveralOutputs({"open map", "y"}), {"'map' has the shape [1, 2, 54, 96]", "one vector"});
  config_.output_name = "y";
  EXPECT_NEAR(Answer(SeveralOutputs({"map", "boxes", "y"})), Sigmoid(0.5 + 1.0 + 0.25), 1e-6);
  config_.output_name = "score";
  ExpectRefusal(SeveralOutputs({"map", "y"}), {"has no output 'score'", "'map' [1, 2, 54, 96], 'y' [1, 2]"});
}

TEST_F(OwnDetector, OneOfTheOutputsOfAStepIsThatOne) {
  for (const bool second : {false, true}) {
    test::OnnxWriter model;
    model.Input("frame", {1, 3, 54, 96}).Output("left", {1, 1}).Output("right", {1, 1});
    test::AddRedMinusBlue(model, "frame");
    model.Step("Split", {"y"}, {"left", "right"},
               {{"axis", std::int64_t{1}}, {"split", std::vector<std::int64_t>{1, 1}}});
    config_.output_name = second ? "right" : "left";
    EXPECT_NEAR(Answer(model), second ? Sigmoid(-0.25) : kExpected, 1e-6);
  }
}

TEST_F(OwnDetector, AProbabilityIsNotTakenForALogit) {
  test::OnnxWriter model;
  model.Input("frame", {1, 3, 54, 96}).Output("p", {1, 2});
  test::AddRedMinusBlue(model, "frame");
  model.Step("Sigmoid", {"y"}, {"p"});
  ExpectRefusal(model, {"'p' comes from Sigmoid", "perception.detector.output = sigmoid", "probability"});
  config_.output = DetectorOutput::kProbability;
  EXPECT_NEAR(Answer(model), kExpected, 1e-6);
}

TEST_F(OwnDetector, EachChannelHasItsMeanAndDeviation) {
  const test::OnnxWriter model = test::RedMinusBlue({1, 3, 54, 96});
  config_.mean_red = 128, config_.sd_red = 0.5;
  config_.mean_blue = 64, config_.sd_blue = 0.25;
  const double red = (200.0 - 128.0) / 256.0 / 0.5, blue = (136.0 - 64.0) / 256.0 / 0.25;
  EXPECT_NEAR(Answer(model), Sigmoid(0.5 + 4 * (red - blue)), 1e-6);
  config_.channel_order = ChannelOrder::kBgr;
  EXPECT_NEAR(Answer(model), Sigmoid(0.5 + 4 * (blue - red)), 1e-6);
}

TEST_F(OwnDetector, MeansAndDeviationsOfOtherUnitsAreRefused) {
  const test::OnnxWriter model = test::RedMinusBlue({1, 3, 54, 96});
  config_.mean_green = 0.456;
  EXPECT_EQ(
      Refusal(model),
      "perception.detector.mean_green: '0.456' is not allowed; it is taken off bytes of 0 .. 255: is 116.28 "
      "meant (255 times as much)?");
  config_.mean_green = 0.0;
  config_.scale = 1.0 / 255.0, config_.sd_red = 58.4;
  EXPECT_NE(Refusal(model).find("perception.detector.sd_red: '58.4' is not allowed"), std::string::npos);
  config_.scale = 1.0, config_.sd_red = 0.229;
  EXPECT_NE(Refusal(model).find("would lie 1114 apart"), std::string::npos) << Refusal(model);
  config_.sd_red = config_.sd_green = config_.sd_blue = 58.4;
  EXPECT_NEAR(Answer(model), Sigmoid(0.5 + 4 * 64.0 / 58.4), 1e-5);
}

TEST_F(OwnDetector, HalfPrecisionWeightsAreRead) {
  for (const bool raw : {true, false}) {
    test::OnnxWriter model;
    model.Input("frame", {1, 3, 54, 96}, test::kFloat16).Output("y", {1, 2}, test::kFloat16);
    model.Halves("w", {3, 2}, {4, 0, 0, 0, -4, 0}, raw).Halves("b", {2}, {0.5F, -0.25F}, raw);
    model.Step("GlobalAveragePool", {"frame"}, {"means"})
        .Step("Flatten", {"means"}, {"flat"}, {{"axis", std::int64_t{1}}})
        .Step("Gemm", {"flat", "w", "b"}, {"y"});
    EXPECT_NEAR(Answer(model), kExpected, 1e-6) << raw;
  }
  test::OnnxWriter cast;  // as converters write a model whose input and output stay single
  cast.Input("frame", {1, 3, 54, 96}).Output("y", {1, 2});
  cast.Halves("w", {3, 2}, {4, 0, 0, 0, -4, 0}).Halves("b", {2}, {0.5F, -0.25F});
  cast.Step("Cast", {"frame"}, {"half"}, {{"to", std::int64_t{test::kFloat16}}})
      .Step("GlobalAveragePool", {"half"}, {"means"})
      .Step("Flatten", {"means"}, {"flat"}, {{"axis", std::int64_t{1}}})
      .Step("Gemm", {"flat", "w", "b"}, {"half_y"})
      .Step("Cast", {"half_y"}, {"y"}, {{"to", std::int64_t{test::kFloat}}});
  EXPECT_NEAR(Answer(cast), kExpected, 1e-6);
  EXPECT_EQ(test::HalfBits(-0.25F), 0xb400);
}

test::OnnxWriter WithWeightsOutside(const std::string& file, const std::string& offset,
                                    const std::string& length) {
  test::OnnxWriter model;
  model.Input("frame", {1, 3, 54, 96}).Output("y", {1, 2});
  model.Outside("w", {3, 2}, file, offset, length).Weights("b", {2}, {0.5F, -0.25F});
  model.Step("GlobalAveragePool", {"frame"}, {"means"})
      .Step("Flatten", {"means"}, {"flat"}, {{"axis", std::int64_t{1}}})
      .Step("Gemm", {"flat", "w", "b"}, {"y"});
  return model;
}

TEST_F(OwnDetector, WeightsInAFileBesideAreRead) {
  const auto data = [&](float gain) {
    const float weights[] = {gain, 0, 0, 0, -gain, 0};
    return std::string(8, 'x') + std::string(reinterpret_cast<const char*>(weights), sizeof weights);
  };
  Write("mine.onnx.data", data(4));
  EXPECT_NEAR(Answer(WithWeightsOutside("mine.onnx.data", "8", "24")), kExpected, 1e-6);
  EXPECT_NEAR(Answer(WithWeightsOutside("mine.onnx.data", "8", "")), kExpected, 1e-6);
  const std::string before = LoadDetectors(config_).fingerprint;
  Write("mine.onnx.data", data(8));
  EXPECT_NE(LoadDetectors(config_).fingerprint, before) << "results depend on that file";
  EXPECT_NEAR(Answer(WithWeightsOutside("mine.onnx.data", "8", "24")), Sigmoid(0.5 + 8 * 0.25), 1e-6);

  ExpectRefusal(WithWeightsOutside("gone.data", "0", "24"),
                {"mine.onnx: keeps weights in 'gone.data', which cannot be read: No such file"});
  ExpectRefusal(WithWeightsOutside("../mine.onnx.data", "0", "24"),
                {"allowed: a file in the model's folder"});
  ExpectRefusal(WithWeightsOutside("/etc/passwd", "0", "24"), {"allowed: a file in the model's folder"});
  ExpectRefusal(WithWeightsOutside("mine.onnx.data", "16", "24"),
                {"takes 24 bytes from 16 on of 'mine.onnx.data', which has 32", "cut short"});
  ExpectRefusal(WithWeightsOutside("mine.onnx.data", "8", "20"), {"'w' of 6 elements with 20 bytes"});
  ExpectRefusal(WithWeightsOutside("mine.onnx.data", "-8", "24"), {"offset '-8'", "a whole number"});
}

// What protocol buffers skip as unknown, OpenCV would find missing.
TEST_F(OwnDetector, NumbersWrittenInOtherFieldsAreRefused) {
  const auto said = [&](std::string bytes, const std::string& found, const std::string& instead) {
    const std::size_t at = bytes.find(found);
    EXPECT_NE(at, std::string::npos);
    Write("mine.onnx", bytes.replace(at, found.size(), instead));
    try {
      LoadDetectors(config_);
    } catch (const UserError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  const std::string name = "perception.detector.full: " + config_.full;
  test::OnnxWriter pool;
  pool.Input("frame", {1, 3, 54, 96}).Output("y", {1, 2});
  pool.Step("MaxPool", {"frame"}, {"p"},
            {{"kernel_shape", std::vector<std::int64_t>{2, 2}}, {"strides", 0.0F}});
  test::AddRedMinusBlue(pool, "p");
  EXPECT_EQ(said(pool.Bytes(), "strides\x15", "strides\x45"),
            name + ": has a list of whole numbers that are none; allowed: int64");
  EXPECT_EQ(
      said(pool.Bytes(), "strides\x15", "strides\x15"),
      name +
          ": operator MaxPool (node 'the MaxPool') has strides that is not a list of whole numbers; allowed: "
          "a list of whole numbers");
  // The weights 'b' of two floats, as int32s.
  EXPECT_EQ(said(test::RedMinusBlue({1, 3, 54, 96}).Bytes(), "\x42\x01\x62\x4a\x08", "\x42\x01\x62\x2a\x08"),
            name + ": has a tensor 'b' of 2 elements with 0 values");
}

TEST_F(OwnDetector, OperatorsThatCannotBeRunAreNamed) {
  const auto ends_with = [](const std::string& op, const std::string& domain = "") {
    test::OnnxWriter model;
    model.Input("frame", {1, 3, 54, 96}).Output("z", {1, 2});
    test::AddRedMinusBlue(model, "frame");
    return model.Step(op, {"y"}, {"z"}, {}, domain);
  };
  ExpectRefusal(ends_with("NonMaxSuppression"), {"operator NonMaxSuppression", "the NonMaxSuppression"});
  ExpectRefusal(ends_with("Mystery", "com.mine"), {"operator com.mine.Mystery"});
  ExpectRefusal(ends_with("STFT"), {"operator STFT"});
  test::OnnxWriter shape;
  shape.Input("frame", {1, 3, 54, 96}).Output("z", {1, 2}).Weights("w", {5, 2}, std::vector<float>(10));
  shape.Step("GlobalAveragePool", {"frame"}, {"means"})
      .Step("Flatten", {"means"}, {"flat"}, {{"axis", std::int64_t{1}}})
      .Step("MatMul", {"flat", "w"}, {"z"});
  ExpectRefusal(shape, {"operator MatMul (node 'the MatMul') takes [1, 3] and [5, 2]; allowed: "});
  test::OnnxWriter apart = test::RedMinusBlue({1, 3, 54, 96});
  apart.Output("b", {2});
  config_.output_name = "b";
  ExpectRefusal(apart, {"its output 'b' does not depend on its input 'frame'"});
}

// Fine on blank frames, so that it is met first in flight.
TEST_F(OwnDetector, AnswersThatAreNoConfidenceAreErrorsThatNameTheModel) {
  const auto said_of = [&](const test::OnnxWriter& model, const FrameStack& frame) {
    Write("mine.onnx", model.Bytes());
    const DetectorPair pair = LoadDetectors(config_);
    double confidence = -1.0;
    try {
      pair.full->Confidences(frame, std::span(&confidence, 1));
    } catch (const DetectorError& error) {
      return std::string(error.what());
    }
    return "answers " + std::to_string(confidence);
  };
  config_.output = DetectorOutput::kProbability;
  test::OnnxWriter root;
  root.Input("frame", {1, 3, 54, 96}).Output("root", {1, 2});
  test::AddRedMinusBlue(root, "frame");
  root.Step("Sqrt", {"y"}, {"root"});
  const std::string name = "perception.detector.full: " + config_.full;
  EXPECT_EQ(said_of(root, Frame(0, 0, 255)), name + ": answers not a number, which is no probability");
  EXPECT_EQ(said_of(root, Frame(90, 0, 90)), "answers 0.707107");
  const test::OnnxWriter line = test::RedMinusBlue({1, 3, 54, 96});
  EXPECT_TRUE(
      said_of(line, Frame(255, 0, 0)).starts_with(name + ": answers 4.484375, which is no probability"));
  EXPECT_TRUE(
      said_of(line, Frame(0, 0, 255)).starts_with(name + ": answers -3.484375, which is no probability"));
  config_.output = DetectorOutput::kSigmoid;
  EXPECT_EQ(said_of(root, Frame(0, 0, 255)), name + ": answers not a number, which is no logit");
}

}  // namespace
}  // namespace ed3r::perception
