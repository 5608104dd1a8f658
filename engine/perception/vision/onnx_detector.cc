#include "engine/perception/vision/onnx_detector.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <opencv2/core/utility.hpp>
#include <opencv2/dnn.hpp>
#include <vector>

#include "engine/core/check.h"
#include "engine/perception/vision/onnx_gate.h"
#include "engine/perception/vision/pool.h"
#include "engine/perception/vision/resize.h"

namespace ed3r {
namespace {

// OpenCV tells of a failure on stderr before it throws; the one line of our own says it all.
int Quiet(int, const char*, const char*, const char*, int, void*) { return 0; }

// The last line of OpenCV's message, without its version and source file.
std::string Reason(const cv::Exception& error) {
  return error.err.empty() ? std::string(error.what()) : std::string(error.err);
}

class OnnxDetector final : public FrameDetector {
 public:
  OnnxDetector(const std::string& key, const std::string& path, std::string bytes,
               const DetectorConfig& config)
      : name_(fmt::format("{}: {}", key, path)),
        bytes_(std::move(bytes)),
        config_(config),
        networks_([this] { return Load(); }) {
    CheckOnnx(bytes_, name_);
    cv::setNumThreads(1);
    cv::redirectError(Quiet);
    try {
      Probe();
    } catch (...) {
      cv::redirectError(nullptr);
      throw;
    }
    cv::redirectError(nullptr);
  }

  void Confidences(const FrameStack& frames, std::span<double> confidences) const override {
    if (frames.width_px != config_.input_width_px || frames.height_px != config_.input_height_px) {
      Confidences(Resized(frames, config_.input_width_px, config_.input_height_px), confidences);
      return;
    }
    ED3R_CHECK(confidences.size() == static_cast<std::size_t>(frames.frames), "one confidence per frame");
    const std::size_t frame_bytes = 3 * Pixels();
    networks_.With([&](cv::dnn::Net& network) {
      for (std::size_t f = 0; f < confidences.size(); ++f)
        confidences[f] = Confidence(Answer(network, frames.rgb.data() + f * frame_bytes));
    });
  }

 private:
  std::size_t Pixels() const {
    return static_cast<std::size_t>(config_.input_width_px) *
           static_cast<std::size_t>(config_.input_height_px);
  }

  [[noreturn]] void Refuse(const std::string& why) const {
    throw UserError(fmt::format("{}: {}", name_, why));
  }

  std::unique_ptr<cv::dnn::Net> Load() const {
    try {
      auto network = std::make_unique<cv::dnn::Net>(cv::dnn::readNetFromONNX(bytes_.data(), bytes_.size()));
      if (network->empty()) Refuse("is no ONNX model with layers");
      network->setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
      network->setPreferableTarget(cv::dnn::DNN_TARGET_CPU);
      return network;
    } catch (const cv::Exception& error) {
      Refuse(fmt::format("is no ONNX model that OpenCV can read: {}", Reason(error)));
    } catch (const std::bad_alloc&) {
      Refuse("asks for more memory than there is");
    }
  }

  // One frame as the network wants it.
  cv::Mat Input(const std::uint8_t* rgb) const {
    const int sizes[] = {1, 3, config_.input_height_px, config_.input_width_px};
    cv::Mat input(4, sizes, CV_32F);
    const double means[] = {config_.mean_red, config_.mean_green, config_.mean_blue};
    const std::size_t pixels = Pixels();
    for (std::size_t channel = 0; channel < 3; ++channel) {
      const std::size_t colour = config_.channel_order == ChannelOrder::kRgb ? channel : 2 - channel;
      float* plane = input.ptr<float>() + channel * pixels;
      for (std::size_t p = 0; p < pixels; ++p)
        plane[p] = static_cast<float>(config_.scale * (rgb[3 * p + colour] - means[colour]));
    }
    return input;
  }

  std::vector<float> Answer(cv::dnn::Net& network, const std::uint8_t* rgb) const {
    network.setInput(Input(rgb));
    const cv::Mat output = network.forward();
    if (output.depth() != CV_32F) Refuse("its output is not of single precision");
    return {output.ptr<float>(), output.ptr<float>() + output.total()};
  }

  double Confidence(const std::vector<float>& outputs) const {
    const auto chosen = static_cast<double>(outputs[static_cast<std::size_t>(config_.output_index)]);
    switch (config_.output) {
      case DetectorOutput::kProbability:
        return std::clamp(chosen, 0.0, 1.0);
      case DetectorOutput::kSigmoid:
        return 1.0 / (1.0 + std::exp(-chosen));
      case DetectorOutput::kSoftmax:
        break;
    }
    double sum = 0.0;
    for (const float output : outputs) sum += std::exp(static_cast<double>(output) - chosen);
    return 1.0 / sum;
  }

  // Black, grey and white frames: does it take the size, and is the answer what the keys say?
  void Probe() const {
    networks_.With([&](cv::dnn::Net& network) {
      for (const int level : {0, 128, 255}) {
        const std::vector<std::uint8_t> frame(3 * Pixels(), static_cast<std::uint8_t>(level));
        std::vector<float> outputs;
        try {
          outputs = Answer(network, frame.data());
        } catch (const cv::Exception& error) {
          Refuse(
              fmt::format("does not take a frame of {} x {} pixels (perception.detector.input_width_px, "
                          "input_height_px): {}",
                          config_.input_width_px, config_.input_height_px, Reason(error)));
        }
        CheckOutputs(outputs);
      }
    });
  }

  void CheckOutputs(const std::vector<float>& outputs) const {
    if (static_cast<std::size_t>(config_.output_index) >= outputs.size())
      Refuse(fmt::format("has {} outputs; perception.detector.output_index = {} is not in 0 .. {}",
                         outputs.size(), config_.output_index, outputs.size() - 1));
    if (config_.output == DetectorOutput::kSoftmax && outputs.size() < 2)
      Refuse("has one output, of which perception.detector.output = softmax always makes 1");
    const float chosen = outputs[static_cast<std::size_t>(config_.output_index)];
    if (!std::isfinite(chosen)) Refuse(fmt::format("answers {} to a blank frame", chosen));
    if (config_.output == DetectorOutput::kProbability && (chosen < 0.0f || chosen > 1.0f))
      Refuse(fmt::format(
          "answers {}, which is no probability; is perception.detector.output = sigmoid or softmax "
          "meant?",
          chosen));
  }

  std::string name_, bytes_;
  DetectorConfig config_;
  mutable Pool<cv::dnn::Net> networks_;
};

}  // namespace

std::shared_ptr<const FrameDetector> MakeOnnxDetector(const std::string& key, const std::string& path,
                                                      std::string bytes, const DetectorConfig& config) {
  return std::make_shared<OnnxDetector>(key, path, std::move(bytes), config);
}

}  // namespace ed3r
