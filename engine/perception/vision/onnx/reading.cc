#include "engine/perception/vision/onnx/reading.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "engine/core/check.h"
#include "engine/perception/vision/onnx/fields.h"

namespace ed3r::perception {
namespace {

constexpr char kSizeKeys[] = "perception.detector.input_width_px and input_height_px";

class Reader {
 public:
  Reader(const OnnxOutline& outline, const DetectorConfig& config, const std::string& name)
      : outline_(outline), config_(config), name_(name) {}

  OnnxReading Read() {
    if (outline_.inputs.size() != 1)
      Refuse(fmt::format("has {} inputs ({}); allowed: one, the frame", outline_.inputs.size(),
                         Names(outline_.inputs)));
    ReadInput(outline_.inputs.front());
    ReadOutput();
    return reading_;
  }

 private:
  [[noreturn]] void Refuse(const std::string& why) const {
    throw UserError(fmt::format("{}: {}", name_, why));
  }

  static std::string Names(const std::vector<OnnxValue>& values) {
    std::vector<std::string> texts;
    for (const OnnxValue& value : values)
      texts.push_back(fmt::format("'{}' {}", value.name, value.ShapeText()));
    return fmt::format("{}", fmt::join(texts, ", "));
  }

  void ReadInput(const OnnxValue& input) {
    const auto refuse = [&](const std::string& what) {
      Refuse(fmt::format(
          "its input '{}' {}; allowed: float, [1, 3, height, width] or [1, height, width, 3] in red, green, "
          "blue or the reverse",
          input.name, what));
    };
    if (input.type != onnx::kFloat && input.type != onnx::kFloat16)
      refuse(fmt::format("takes {}", onnx::TypeName(input.type)));
    if (!input.has_shape || input.dims.size() != 4)
      refuse(fmt::format("has the shape {}", input.ShapeText()));
    if (input.dims[0].size > 1)
      refuse(fmt::format("has the shape {}: {} frames at a time", input.ShapeText(), input.dims[0].size));
    if (input.dims[1].size == 3 || (input.dims[1].size == 0 && input.dims[3].size != 3)) {
      reading_.channels = ChannelPlace::kFirst;
    } else if (input.dims[3].size == 3) {
      reading_.channels = ChannelPlace::kLast;
    } else {
      refuse(fmt::format("has the shape {}: not three channels", input.ShapeText()));
    }
    reading_.input = input.name;
    const bool first = reading_.channels == ChannelPlace::kFirst;
    ReadSize(input, input.dims[first ? 3 : 2].size, input.dims[first ? 2 : 1].size);
    for (const OnnxDim& dim : input.dims) reading_.pinned = reading_.pinned || dim.size == 0;
  }

  // A declared side of 0 is open, a configured one of 0 is the declared one.
  void ReadSize(const OnnxValue& input, std::int64_t width_px, std::int64_t height_px) {
    const std::int64_t asked_width = config_.input_width_px, asked_height = config_.input_height_px;
    if ((width_px == 0 && asked_width == 0) || (height_px == 0 && asked_height == 0))
      Refuse(fmt::format(
          "its input '{}' {} leaves the size of its frames open; set {} to that it was trained on",
          input.name, input.ShapeText(), kSizeKeys));
    const auto differs = [](std::int64_t declared, std::int64_t asked) {
      return declared != 0 && asked != 0 && declared != asked;
    };
    const std::int64_t width = width_px != 0 ? width_px : asked_width;
    const std::int64_t height = height_px != 0 ? height_px : asked_height;
    if (differs(width_px, asked_width) || differs(height_px, asked_height))
      Refuse(fmt::format(
          "takes frames of {} x {} pixels (its input '{}' is {}), and {} are {} and {}; set them "
          "to {} and {}, or to 0: as the model declares",
          width, height, input.name, input.ShapeText(), kSizeKeys, asked_width, asked_height, width, height));
    constexpr std::int64_t kLeast = 8, kMost = 2048;
    if (width < kLeast || width > kMost || height < kLeast || height > kMost)
      Refuse(fmt::format("takes frames of {} x {} pixels; allowed: sides of {} .. {}", width, height, kLeast,
                         kMost));
    reading_.width_px = static_cast<int>(width);
    reading_.height_px = static_cast<int>(height);
  }

  void ReadOutput() {
    if (outline_.outputs.empty()) Refuse("has no output");
    const OnnxValue* output = nullptr;
    for (const OnnxValue& candidate : outline_.outputs)
      if (candidate.name == config_.output_name) output = &candidate;
    if (output == nullptr && config_.output_name != "first")
      Refuse(fmt::format("has no output '{}' (perception.detector.output_name); its outputs: {}",
                         config_.output_name, Names(outline_.outputs)));
    if (output == nullptr) output = &outline_.outputs.front();
    if (output->type != onnx::kFloat && output->type != onnx::kFloat16)
      Refuse(fmt::format("its output '{}' is {}; allowed: float{}", output->name,
                         output->type == 0 ? "no tensor" : "of " + onnx::TypeName(output->type), Others()));
    std::vector<std::int64_t> sides;
    for (const OnnxDim& dim : output->dims) sides.push_back(dim.size);
    if (LongSides(sides) > 1)
      Refuse(fmt::format("its output '{}' has the shape {}; allowed: one number, or one vector{}",
                         output->name, output->ShapeText(), Others()));
    reading_.output = output->name;
    CheckLastStep(*output);
  }

  // What else perception.detector.output_name could be.
  std::string Others() const {
    if (outline_.outputs.size() < 2) return "; the confidence of fire or smoke in the whole frame";
    return fmt::format("; choose by perception.detector.output_name among {}", Names(outline_.outputs));
  }

  // A probability that is taken for a logit gives 0.5 .. 0.73 and says nothing.
  void CheckLastStep(const OnnxValue& output) const {
    if (config_.output == DetectorOutput::kProbability) return;
    for (const OnnxStep& step : outline_.steps)
      if (std::find(step.outputs.begin(), step.outputs.end(), output.name) != step.outputs.end() &&
          (step.op == "Sigmoid" || step.op == "Softmax"))
        Refuse(
            fmt::format("its output '{}' comes from {}, so it is a probability and "
                        "perception.detector.output = {} would bend it again; allowed: probability",
                        output.name, step.Text(), NameOf(config_.output)));
  }

  const OnnxOutline& outline_;
  const DetectorConfig& config_;
  const std::string& name_;
  OnnxReading reading_;
};

}  // namespace

OnnxReading ReadingOf(const OnnxOutline& outline, const DetectorConfig& config, const std::string& name) {
  return Reader(outline, config, name).Read();
}

void CheckScaling(const DetectorConfig& config) {
  const std::array<std::pair<const char*, double>, 3> means = {
      {{"red", config.mean_red}, {"green", config.mean_green}, {"blue", config.mean_blue}}};
  for (const auto& [colour, mean] : means)
    if (mean > 0.0 && mean < 1.0)
      throw UserError(fmt::format(
          "perception.detector.mean_{}: '{}' is not allowed; it is taken off bytes of 0 .. 255: is {} meant "
          "(255 times as much)?",
          colour, mean, 255.0 * mean));
  const std::array<std::pair<const char*, double>, 3> deviations = {
      {{"red", config.sd_red}, {"green", config.sd_green}, {"blue", config.sd_blue}}};
  constexpr double kNarrowest = 0.1, kWidest = 300.0;
  for (const auto& [colour, sd] : deviations) {
    const double range = 255.0 * config.scale / sd;
    if (sd != 1.0 && (range < kNarrowest || range > kWidest))
      throw UserError(fmt::format(
          "perception.detector.sd_{}: '{}' is not allowed with perception.detector.scale = {}: black and "
          "white "
          "would lie {:.4g} apart; allowed: {} .. {} (sd is in units of scale times bytes: 0.229 with "
          "1/255 = 0.00392, 58.4 with 1)",
          colour, sd, config.scale, range, kNarrowest, kWidest));
  }
}

}  // namespace ed3r::perception
