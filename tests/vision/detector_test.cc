#include <gtest/gtest.h>
#include <omp.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "engine/core/check.h"
#include "engine/perception/vision/builtin_detector.h"
#include "engine/perception/vision/frame_detector.h"
#include "engine/perception/vision/model_file.h"
#include "engine/perception/vision/network.h"
#include "engine/perception/vision/resize.h"
#include "tests/vision/reference_network.h"

namespace ed3r::perception {
namespace {

const std::string kOnnx = ED3R_SOURCE_DIR "/tests/vision/data/red_minus_blue.onnx";

class TemporaryFolder {
 public:
  TemporaryFolder() {
    path_ = std::filesystem::temp_directory_path() / ("ed3r-vision-" + std::to_string(::getpid()));
    std::filesystem::create_directories(path_);
  }
  ~TemporaryFolder() { std::filesystem::remove_all(path_); }
  std::string File(const std::string& name) const { return path_ / name; }
  std::string Write(const std::string& name, const std::string& bytes) const {
    std::ofstream(File(name), std::ios::binary) << bytes;
    return File(name);
  }

 private:
  std::filesystem::path path_;
};

std::string Bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

FrameStack Uniform(int frames, int red, int green, int blue, int width_px = 96, int height_px = 54) {
  FrameStack stack{.frames = frames, .width_px = width_px, .height_px = height_px, .rgb = {}};
  for (int p = 0; p < frames * width_px * height_px; ++p)
    for (const int colour : {red, green, blue}) stack.rgb.push_back(static_cast<std::uint8_t>(colour));
  return stack;
}

double ConfidenceIn(const FrameDetector& detector, const FrameStack& frames) {
  std::vector<double> confidences(static_cast<std::size_t>(frames.frames));
  detector.Confidences(frames, confidences);
  return confidences.front();
}

DetectorConfig OnnxConfig() {
  DetectorConfig config;
  config.full = config.quantized = kOnnx;
  config.output = DetectorOutput::kSigmoid;
  return config;
}

// The message of the UserError that loading throws; "" when it throws none.
std::string Refusal(const DetectorConfig& config) {
  try {
    LoadDetectors(config);
  } catch (const UserError& error) {
    return error.what();
  }
  return "";
}

void ExpectRefusal(const DetectorConfig& config, const std::vector<std::string>& parts) {
  const std::string message = Refusal(config);
  for (const std::string& part : parts)
    EXPECT_NE(message.find(part), std::string::npos) << part << "\n" << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

TEST(ModelFile, WhatIsWrittenIsRead) {
  const TemporaryFolder folder;
  DetectorModel model = RandomDetectorModel(CompactQuantizedTopology(), 3);
  model.full = {.temperature = 1.5, .offset = -0.25};
  model.quantized = {.temperature = 2.5, .offset = 0.75};
  model.provenance = R"({"seed": 3})";
  WriteDetectorModel(folder.File("a.ed3rnet"), model);
  const DetectorModel read = ReadDetectorModel(folder.File("a.ed3rnet"));
  EXPECT_EQ(read.topology.name, model.topology.name);
  EXPECT_EQ(read.layers.back().weights, model.layers.back().weights);
  EXPECT_EQ(read.layers.front().biases, model.layers.front().biases);
  EXPECT_EQ(read.quantization[4].weight_scale, model.quantization[4].weight_scale);
  EXPECT_EQ(read.quantized.offset, 0.75);
  EXPECT_EQ(read.provenance, model.provenance);
  const std::vector<std::uint8_t> rgb = test::NoiseFrames(model.topology, 1, 1);
  float before = 0.0f, after = 1.0f;
  MakeIntegerNetwork(model, 1)->Logits(rgb, std::span(&before, 1));
  MakeIntegerNetwork(read, 1)->Logits(rgb, std::span(&after, 1));
  EXPECT_EQ(before, after);
}

TEST(ModelFile, RefusesDamagedAndForeignFiles) {
  const TemporaryFolder folder;
  WriteDetectorModel(folder.File("good.ed3rnet"), RandomDetectorModel(CompactQuantizedTopology(), 4));
  const std::string good = Bytes(folder.File("good.ed3rnet"));
  const auto refused = [&](const std::string& bytes, const std::string& why) {
    const std::string path = folder.Write("bad.ed3rnet", bytes);
    try {
      ReadDetectorModel(path);
      ADD_FAILURE() << why;
    } catch (const UserError& error) {
      EXPECT_EQ(std::string(error.what()).find(path), 0u) << error.what();
      EXPECT_NE(std::string(error.what()).find(why), std::string::npos) << error.what();
    }
  };
  std::string flipped = good;
  flipped[good.size() / 2] ^= 1;
  refused(flipped, "SHA-256");
  refused(good.substr(0, good.size() - 100), "damaged");
  refused(good.substr(0, 20), "cut short");
  refused("weights of another kind", "is not a detector network");
  refused("", "is not a detector network");
}

TEST(ModelFile, RefusesScalesThatCannotBeUsed) {
  const TemporaryFolder folder;
  const auto refused = [&](auto&& spoil) {
    DetectorModel model = RandomDetectorModel(CompactQuantizedTopology(), 5);
    spoil(model);
    WriteDetectorModel(folder.File("spoilt.ed3rnet"), model);
    EXPECT_THROW(ReadDetectorModel(folder.File("spoilt.ed3rnet")), UserError);
  };
  refused([](DetectorModel& m) { m.quantization[3].input_scale = 0.0f; });
  refused([](DetectorModel& m) { m.quantization[3].input_zero_point = 128; });
  refused([](DetectorModel& m) { m.quantization.pop_back(); });
  refused([](DetectorModel& m) { m.quantization[0].input_zero_point = 0; });
  refused([](DetectorModel& m) { m.full.temperature = -1.0; });
  refused([](DetectorModel& m) { m.layers[2].weights[5] = NAN; });
  refused([](DetectorModel& m) { m.layers[2].biases.pop_back(); });
  refused([](DetectorModel& m) { m.topology.convolutions[0].stride = 3; });
}

TEST(BuiltinDetectors, LoadAndAnswerProbabilities) {
  const DetectorPair pair = LoadDetectors({});
  EXPECT_EQ(pair.fingerprint.size(), 64u);
  for (const auto& detector : {pair.full, pair.quantized}) {
    const double confidence = ConfidenceIn(*detector, Uniform(33, 40, 70, 30));
    EXPECT_GT(confidence, 0.0);
    EXPECT_LT(confidence, 1.0);
  }
  EXPECT_EQ(LoadDetectors({}).fingerprint, pair.fingerprint);
}

FrameStack Noise(int width_px, int height_px) {
  Topology size = CompactFullTopology();
  size.width_px = width_px;
  size.height_px = height_px;
  return {.frames = 1, .width_px = width_px, .height_px = height_px, .rgb = test::NoiseFrames(size, 1, 3)};
}

TEST(BuiltinDetectors, QuantizedLooksAtTheHalfOfAFrameAndFullDoesNot) {
  const FrameStack frame = Noise(192, 108);
  const FrameStack half = Resized(frame, 96, 54);
  const DetectorPair pair = LoadDetectors({});
  EXPECT_EQ(ConfidenceIn(*pair.quantized, frame), ConfidenceIn(*pair.quantized, half));
  EXPECT_NE(ConfidenceIn(*pair.full, frame), ConfidenceIn(*pair.full, half));
}

TEST(BuiltinDetectors, QuantizedInputFullIsFullInIntegers) {
  const FrameStack frame = Noise(192, 108);
  DetectorConfig config;
  config.quantized_input = QuantizedInput::kFull;
  const DetectorPair pair = LoadDetectors(config);
  const auto full = std::make_shared<const DetectorModel>(ParseDetectorModel(BuiltinFullBytes(), "full"));
  EXPECT_EQ(ConfidenceIn(*pair.quantized, frame),
            ConfidenceIn(*MakeNetworkDetector(full, Arithmetic::kInteger), frame));
  const DetectorPair halved = LoadDetectors({});
  EXPECT_NE(ConfidenceIn(*pair.quantized, frame), ConfidenceIn(*halved.quantized, frame));
  EXPECT_EQ(ConfidenceIn(*pair.full, frame), ConfidenceIn(*halved.full, frame));
  EXPECT_NE(pair.fingerprint, halved.fingerprint);
}

TEST(BuiltinDetectors, AreOfTheTopologiesThatAreTold) {
  const auto same = [](std::string_view bytes, const Topology& told) {
    const Topology built_in = ParseDetectorModel(bytes, told.name).topology;
    EXPECT_EQ(built_in.name, told.name);
    EXPECT_EQ(built_in.width_px, told.width_px);
    EXPECT_EQ(built_in.height_px, told.height_px);
    EXPECT_EQ(MultiplyAdds(built_in), MultiplyAdds(told));
    EXPECT_EQ(ParameterCount(built_in), ParameterCount(told));
  };
  same(BuiltinFullBytes(), CompactFullTopology());
  same(BuiltinQuantizedBytes(), CompactQuantizedTopology());
}

TEST(BuiltinDetectors, ManyThreadsShareOneDetectorAndGetTheSameBits) {
  const auto model =
      std::make_shared<const DetectorModel>(RandomDetectorModel(CompactQuantizedTopology(), 6));
  for (const Arithmetic arithmetic : {Arithmetic::kFloat, Arithmetic::kInteger}) {
    const auto detector = MakeNetworkDetector(model, arithmetic);
    const FrameStack frames{
        .frames = 33, .width_px = 96, .height_px = 54, .rgb = test::NoiseFrames(model->topology, 33, 2)};
    std::vector<double> expected(33);
    detector->Confidences(frames, expected);
    std::vector<std::vector<double>> found(16, std::vector<double>(33));
    omp_set_dynamic(0);
#pragma omp parallel for num_threads(4)
    for (std::size_t i = 0; i < found.size(); ++i) detector->Confidences(frames, found[i]);
    for (const std::vector<double>& confidences : found) EXPECT_EQ(confidences, expected);
  }
}

// Numbers that single precision holds exactly, so that the model's sums have no rounding.
TEST(OnnxDetector, AnswersWhatTheModelComputes) {
  const FrameStack frame = Uniform(2, 200, 90, 136);  // red - blue: 64 = 0.25 x 256
  const auto sigmoid = [](double logit) { return 1.0 / (1.0 + std::exp(-logit)); };
  DetectorConfig config = OnnxConfig();
  config.scale = 1.0 / 256.0;
  EXPECT_NEAR(ConfidenceIn(*LoadDetectors(config).full, frame), sigmoid(0.5 + 4 * 0.25), 1e-6);
  DetectorConfig bgr = config;
  bgr.channel_order = ChannelOrder::kBgr;
  EXPECT_NEAR(ConfidenceIn(*LoadDetectors(bgr).full, frame), sigmoid(0.5 - 4 * 0.25), 1e-6);
  DetectorConfig mean = config;
  mean.mean_red = 128;  // the red channel loses 0.5
  EXPECT_NEAR(ConfidenceIn(*LoadDetectors(mean).full, frame), sigmoid(0.5 + 4 * (0.25 - 0.5)), 1e-6);
  DetectorConfig scale = config;
  scale.scale = 2.0 / 256.0;
  EXPECT_NEAR(ConfidenceIn(*LoadDetectors(scale).full, frame), sigmoid(0.5 + 8 * 0.25), 1e-6);
  DetectorConfig softmax = config;
  softmax.output = DetectorOutput::kSoftmax;
  EXPECT_NEAR(ConfidenceIn(*LoadDetectors(softmax).full, frame), sigmoid(0.5 + 4 * 0.25 + 0.25), 1e-6);
}

TEST(OnnxDetector, FramesOfAnotherSizeAreResized) {
  const auto detector = LoadDetectors(OnnxConfig()).full;
  EXPECT_NEAR(ConfidenceIn(*detector, Uniform(1, 200, 90, 149, 320, 240)),
              ConfidenceIn(*detector, Uniform(1, 200, 90, 149)), 1e-12);
}

TEST(OnnxDetector, RefusesWhatCannotWorkBeforeAnythingFlies) {
  const TemporaryFolder folder;
  DetectorConfig missing = OnnxConfig();
  missing.full = folder.File("nowhere.onnx");
  ExpectRefusal(missing, {"perception.detector.full", "nowhere.onnx", "No such file", "builtin"});

  DetectorConfig foreign = OnnxConfig();
  foreign.quantized = folder.Write("text.onnx", "this is no network\n");
  ExpectRefusal(foreign, {"perception.detector.quantized", "text.onnx", "no ONNX model"});

  DetectorConfig empty = OnnxConfig();
  empty.full = folder.Write("empty.onnx", "");
  ExpectRefusal(empty, {"perception.detector.full", "empty.onnx"});

  DetectorConfig cut = OnnxConfig();
  cut.full = folder.Write("cut.onnx", Bytes(kOnnx).substr(0, 300));
  ExpectRefusal(cut, {"perception.detector.full", "cut.onnx"});

  DetectorConfig shape = OnnxConfig();
  shape.input_width_px = shape.input_height_px = 224;
  ExpectRefusal(
      shape, {"red_minus_blue.onnx", "takes frames of 96 x 54 pixels", "are 224 and 224", "input_width_px"});

  DetectorConfig index = OnnxConfig();
  index.output_index = 2;
  ExpectRefusal(index, {"red_minus_blue.onnx", "output_index = 2", "0 .. 1"});

  DetectorConfig logits = OnnxConfig();
  logits.output = DetectorOutput::kProbability;
  logits.output_index = 1;
  ExpectRefusal(logits, {"red_minus_blue.onnx", "-0.25", "no probability", "sigmoid"});
}

TEST(Resize, MeansAreExact) {
  // 4 x 2 to 2 x 1: two blocks of four; 3 columns to 2: the middle one is shared.
  FrameStack frame{.frames = 1, .width_px = 4, .height_px = 2, .rgb = {}};
  for (const int value : {0, 10, 20, 30, 40, 50, 60, 71})
    for (int c = 0; c < 3; ++c) frame.rgb.push_back(static_cast<std::uint8_t>(value + c));
  const FrameStack half = Resized(frame, 2, 1);
  EXPECT_EQ(half.rgb, (std::vector<std::uint8_t>{25, 26, 27, 45, 46, 47}));
  const FrameStack three{
      .frames = 1, .width_px = 3, .height_px = 1, .rgb = {0, 0, 0, 30, 30, 30, 90, 90, 90}};
  EXPECT_EQ(Resized(three, 2, 1).rgb, (std::vector<std::uint8_t>{10, 10, 10, 70, 70, 70}));
  EXPECT_EQ(Resized(frame, 4, 2).rgb, frame.rgb);
}

// Halving has a way of its own; stretched first, the same frame takes the general one.
TEST(Resize, HalvesAreThoseOfTheGeneralCase) {
  const FrameStack frame = Noise(12, 6);
  const FrameStack half = Resized(frame, 6, 3);
  ASSERT_EQ(half.rgb.size(), 6u * 3 * 3);
  EXPECT_EQ(Resized(Resized(frame, 24, 12), 6, 3).rgb, half.rgb);
}

}  // namespace
}  // namespace ed3r::perception
