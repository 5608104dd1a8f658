#include "engine/perception/vision/onnx_detector.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <new>
#include <opencv2/dnn.hpp>
#include <utility>
#include <vector>

#include "engine/core/check.h"
#include "engine/perception/vision/onnx/gate.h"
#include "engine/perception/vision/onnx/outline.h"
#include "engine/perception/vision/onnx/reading.h"
#include "engine/perception/vision/onnx/reason.h"
#include "engine/perception/vision/onnx/rewrite.h"
#include "engine/perception/vision/pool.h"
#include "engine/perception/vision/resize.h"
#include "engine/world/files/quiet_opencv.h"

namespace ed3r::perception {
namespace {

// A softmax in single precision may end this far beyond 1.
constexpr double kRounding = 1e-5;

class OnnxDetector final : public FrameDetector {
 public:
  OnnxDetector(const std::string& key, const std::string& path, const std::string& bytes,
               const DetectorConfig& config)
      : name_(fmt::format("{}: {}", key, path)), config_(config), networks_([this] { return Load(); }) {
    CheckScaling(config_);
    CheckOnnx(bytes, name_);
    outline_ = OutlineOf(bytes, name_);
    reading_ = ReadingOf(outline_, config_, name_);
    bytes_ = ForOpenCv(bytes, outline_, reading_, name_);
    world::QuietOpenCv();
    cv::setNumThreads(1);
    Probe();
  }

  void Confidences(const FrameStack& frames, std::span<double> confidences) const override {
    if (frames.width_px != reading_.width_px || frames.height_px != reading_.height_px) {
      Confidences(Resized(frames, reading_.width_px, reading_.height_px), confidences);
      return;
    }
    ED3R_CHECK(confidences.size() == static_cast<std::size_t>(frames.frames), "one confidence per frame");
    const std::size_t frame_bytes = 3 * Pixels();
    networks_.With([&](cv::dnn::Net& network) {
      for (std::size_t f = 0; f < confidences.size(); ++f) {
        try {
          confidences[f] = Confidence(Answer(network, frames.rgb.data() + f * frame_bytes));
        } catch (const cv::Exception& error) {
          Fail(fmt::format("cannot be run: {}", ReasonOf(error.err.empty() ? error.what() : error.err)));
        }
      }
    });
  }

 private:
  std::size_t Pixels() const {
    return static_cast<std::size_t>(reading_.width_px) * static_cast<std::size_t>(reading_.height_px);
  }

  [[noreturn]] void Refuse(const std::string& why) const {
    throw UserError(fmt::format("{}: {}", name_, why));
  }

  [[noreturn]] void Fail(const std::string& why) const {
    throw DetectorError(fmt::format("{}: {}", name_, why));
  }

  std::unique_ptr<cv::dnn::Net> Load() const {
    try {
      auto network = std::make_unique<cv::dnn::Net>(cv::dnn::readNetFromONNX(bytes_.data(), bytes_.size()));
      if (network->empty()) Refuse("is no ONNX model with layers");
      network->setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
      network->setPreferableTarget(cv::dnn::DNN_TARGET_CPU);
      return network;
    } catch (const cv::Exception& error) {
      Refuse(ReasonOf(error.err.empty() ? error.what() : error.err));
    } catch (const std::bad_alloc&) {
      Refuse("asks for more memory than there is");
    }
  }

  // One frame as the network wants it.
  cv::Mat Input(const std::uint8_t* rgb) const {
    const bool first = reading_.channels == ChannelPlace::kFirst;
    const int sizes[] = {1, first ? 3 : reading_.height_px, first ? reading_.height_px : reading_.width_px,
                         first ? reading_.width_px : 3};
    cv::Mat input(4, sizes, CV_32F);
    const double means[] = {config_.mean_red, config_.mean_green, config_.mean_blue};
    const double deviations[] = {config_.sd_red, config_.sd_green, config_.sd_blue};
    const std::size_t pixels = Pixels();
    for (std::size_t channel = 0; channel < 3; ++channel) {
      const std::size_t colour = config_.channel_order == ChannelOrder::kRgb ? channel : 2 - channel;
      float* values = input.ptr<float>() + (first ? channel * pixels : channel);
      const std::size_t stride = first ? 1 : 3;
      for (std::size_t p = 0; p < pixels; ++p)
        values[stride * p] =
            static_cast<float>(config_.scale * (rgb[3 * p + colour] - means[colour]) / deviations[colour]);
    }
    return input;
  }

  std::vector<float> Answer(cv::dnn::Net& network, const std::uint8_t* rgb) const {
    network.setInput(Input(rgb));
    const cv::Mat output = network.forward();
    if (output.depth() != CV_32F) Fail("its output is not of single precision");
    const std::vector<int> sides(output.size.p, output.size.p + output.dims);
    if (LongSides(sides) > 1)
      Fail(fmt::format("its output '{}' has the shape [{}]; allowed: one number, or one vector",
                       reading_.output, fmt::join(sides, ", ")));
    return {output.ptr<float>(), output.ptr<float>() + output.total()};
  }

  double Confidence(const std::vector<float>& outputs) const {
    const auto index = static_cast<std::size_t>(config_.output_index);
    const double chosen = outputs.at(index);
    double sum = 0.0;
    for (std::size_t i = 0; i < outputs.size(); ++i) {
      const bool counts = i == index || config_.output == DetectorOutput::kSoftmax;
      if (counts && !std::isfinite(outputs[i]))
        Fail(fmt::format("answers {}, which is no {}", Number(outputs[i]),
                         config_.output == DetectorOutput::kProbability ? "probability" : "logit"));
      sum += std::exp(static_cast<double>(outputs[i]) - chosen);
    }
    switch (config_.output) {
      case DetectorOutput::kProbability:
        break;
      case DetectorOutput::kSigmoid:
        return 1.0 / (1.0 + std::exp(-chosen));
      case DetectorOutput::kSoftmax:
        return 1.0 / sum;
    }
    if (chosen < -kRounding || chosen > 1.0 + kRounding)
      Fail(fmt::format(
          "answers {}, which is no probability; is perception.detector.output = sigmoid or softmax "
          "meant?",
          chosen));
    return std::clamp(chosen, 0.0, 1.0);
  }

  // "-nan" is a matter of one bit that means nothing.
  static std::string Number(float value) {
    return std::isnan(value) ? "not a number" : value < 0 ? "minus infinity" : "infinity";
  }

  // Black, grey and white frames: does it run, and is the answer what the keys say?
  void Probe() const {
    networks_.With([&](cv::dnn::Net& network) {
      for (const int level : {0, 128, 255}) {
        const std::vector<std::uint8_t> frame(3 * Pixels(), static_cast<std::uint8_t>(level));
        try {
          const std::vector<float> outputs = Answer(network, frame.data());
          CheckOutputs(outputs);
          CheckDeclared(outputs.size());
          Confidence(outputs);
        } catch (const DetectorError& error) {
          throw UserError(fmt::format("{} (to a blank frame)", error.what()));
        } catch (const cv::Exception& error) {
          Refuse(ReasonOf(error.err.empty() ? error.what() : error.err));
        } catch (const std::bad_alloc&) {
          Refuse("asks for more memory than there is");
        }
      }
    });
  }

  void CheckOutputs(const std::vector<float>& outputs) const {
    if (static_cast<std::size_t>(config_.output_index) >= outputs.size())
      Refuse(fmt::format(
          "its output '{}' has {} values; perception.detector.output_index = {} is not in 0 .. {}",
          reading_.output, outputs.size(), config_.output_index, outputs.size() - 1));
    if (config_.output == DetectorOutput::kSoftmax && outputs.size() < 2)
      Refuse("has one output, of which perception.detector.output = softmax always makes 1");
  }

  // Where the file tells all sides in numbers, another count means that a step was read otherwise than it says.
  void CheckDeclared(std::size_t values) const {
    for (const OnnxValue& output : outline_.outputs) {
      if (output.name != reading_.output || output.dims.empty()) continue;
      std::size_t declared = 1;
      for (const OnnxDim& dim : output.dims) declared *= static_cast<std::size_t>(dim.size);
      if (declared != 0 && declared != values)
        Refuse(fmt::format(
            "its output '{}' is declared as {} and has {} values as OpenCV reads the model; allowed: "
            "a model whose steps give what it declares",
            output.name, output.ShapeText(), values));
    }
  }

  std::string name_, bytes_;
  DetectorConfig config_;
  OnnxOutline outline_;
  OnnxReading reading_;
  mutable Pool<cv::dnn::Net> networks_;
};

}  // namespace

std::shared_ptr<const FrameDetector> MakeOnnxDetector(const std::string& key, const std::string& path,
                                                      const std::string& bytes,
                                                      const DetectorConfig& config) {
  return std::make_shared<OnnxDetector>(key, path, bytes, config);
}

}  // namespace ed3r::perception
