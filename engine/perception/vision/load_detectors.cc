#include <fmt/format.h>

#include <utility>

#include "engine/config/parameters.h"
#include "engine/core/check.h"
#include "engine/core/files/file.h"
#include "engine/core/sha256.h"
#include "engine/perception/vision/builtin_detector.h"
#include "engine/perception/vision/frame_detector.h"
#include "engine/perception/vision/model_file.h"
#include "engine/perception/vision/onnx/external.h"
#include "engine/perception/vision/onnx_detector.h"

namespace ed3r::perception {
namespace {

constexpr std::string_view kBuiltin = "builtin";

// How the networks are asked. The files themselves count by their bytes, not by their names.
std::string SettingsText(const DetectorConfig& detector) {
  Config config;
  config.perception.detector = detector;
  std::string text;
  for (const ParameterInfo& parameter : Parameters())
    if (parameter.key.starts_with("perception.detector.") && !parameter.is_file)
      text += fmt::format("{}={}\n", parameter.key, GetParameter(config, parameter.key));
  return text;
}

std::string ReadBytes(const std::string& key, const std::string& path) {
  std::string bytes, why;
  if (!TryReadFile(path, kMaxModelBytes, bytes, why))
    throw UserError(fmt::format(
        "{}: {}: cannot be read: {}; 'builtin' or the path of an ONNX model is allowed", key, path, why));
  return bytes;
}

std::string_view BuiltinBytes(Arithmetic arithmetic, const DetectorConfig& config) {
  const bool halved = arithmetic == Arithmetic::kInteger && config.quantized_input == QuantizedInput::kHalf;
  return halved ? BuiltinQuantizedBytes() : BuiltinFullBytes();
}

// Built-in networks also come from a file of scripts/train_detector.py, which starts with its magic bytes.
std::shared_ptr<const FrameDetector> Load(const std::string& key, const std::string& name,
                                          Arithmetic arithmetic, const DetectorConfig& config,
                                          Sha256& fingerprint) {
  const bool builtin = name == kBuiltin;
  std::string bytes = builtin ? std::string(BuiltinBytes(arithmetic, config)) : ReadBytes(key, name);
  const bool ours = builtin || bytes.starts_with("ED3RCNN\n");
  if (!ours) bytes = WithWeightsInside(std::move(bytes), name, fmt::format("{}: {}", key, name));
  fingerprint.Update(fmt::format("{} {}\n", key, bytes.size()));
  fingerprint.Update(bytes);
  if (!ours) return MakeOnnxDetector(key, name, bytes, config);
  auto model =
      std::make_shared<const DetectorModel>(ParseDetectorModel(bytes, fmt::format("{}: {}", key, name)));
  if (arithmetic == Arithmetic::kInteger && model->quantization.empty())
    throw UserError(fmt::format("{}: {}: this detector network has no integer scales", key, name));
  std::shared_ptr<const FrameDetector> detector = MakeNetworkDetector(model, arithmetic);
  const std::size_t frame_bytes = static_cast<std::size_t>(Layers(model->topology).front().Inputs());
  const FrameStack blank{.frames = 1,
                         .width_px = model->topology.width_px,
                         .height_px = model->topology.height_px,
                         .rgb = std::vector<std::uint8_t>(frame_bytes, 128)};
  double confidence = 0.0;
  detector->Confidences(blank, std::span(&confidence, 1));
  return detector;
}

}  // namespace

FrameDetector::~FrameDetector() = default;

DetectorPair LoadDetectors(const DetectorConfig& config) {
  Sha256 fingerprint;
  DetectorPair pair;
  pair.full = Load("perception.detector.full", config.full, Arithmetic::kFloat, config, fingerprint);
  pair.quantized =
      Load("perception.detector.quantized", config.quantized, Arithmetic::kInteger, config, fingerprint);
  fingerprint.Update(SettingsText(config));
  pair.fingerprint = fingerprint.Hex();
  return pair;
}

}  // namespace ed3r::perception
