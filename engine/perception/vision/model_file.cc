#include "engine/perception/vision/model_file.h"

#include <fmt/format.h>

#include <cmath>

#include "engine/core/check.h"
#include "engine/core/files/sealed_file.h"

namespace ed3r::perception {
namespace {

constexpr SealedFormat kFormat{.magic = "ED3RCNN\n", .version = 1, .what = "detector network"};
constexpr std::uint32_t kMaxLayers = 1000;

void WriteTopology(const Topology& t, ByteWriter& writer) {
  writer.Text(t.name);
  writer.U32(static_cast<std::uint32_t>(t.width_px));
  writer.U32(static_cast<std::uint32_t>(t.height_px));
  writer.U32(static_cast<std::uint32_t>(t.colours));
  writer.F64(static_cast<double>(t.leaky_slope));
  writer.U32(static_cast<std::uint32_t>(t.convolutions.size()));
  for (const ConvolutionDesign& c : t.convolutions)
    for (const int value : {c.channels, c.kernel, c.stride}) writer.U32(static_cast<std::uint32_t>(value));
  writer.U32(static_cast<std::uint32_t>(t.dense.size()));
  for (const int outputs : t.dense) writer.U32(static_cast<std::uint32_t>(outputs));
}

class ModelReader {
 public:
  ModelReader(std::string_view payload, const std::string& name) : bytes_(payload, name, kFormat) {}

  DetectorModel Read() {
    DetectorModel model;
    ReadTopology(model.topology);
    model.pixel_offset = Int(255);
    model.pixel_scale = Scale("pixel scale");
    std::vector<LayerShape> shapes;
    try {
      shapes = Layers(model.topology);
    } catch (const UserError& error) {
      bytes_.Refuse(fmt::format("holds a network that cannot be: {}", error.what()));
    }
    for (const LayerShape& shape : shapes) model.layers.push_back(ReadLayer(shape));
    const std::int32_t quantised = Int(kMaxLayers);
    if (quantised != 0 && static_cast<std::size_t>(quantised) != shapes.size())
      bytes_.Refuse(fmt::format("has {} quantised layers of {}", quantised, shapes.size()));
    for (std::int32_t l = 0; l < quantised; ++l) model.quantization.push_back(ReadQuantization());
    model.full = ReadCalibration();
    model.quantized = ReadCalibration();
    model.provenance = bytes_.Text();
    bytes_.End();
    CheckFirstLayer(model);
    return model;
  }

 private:
  std::int32_t Int(std::uint32_t max) {
    const std::uint32_t value = bytes_.U32();
    if (value > max) bytes_.Refuse(fmt::format("holds {}, where at most {} is allowed", value, max));
    return static_cast<std::int32_t>(value);
  }

  float Scale(const char* what) {
    const double value = bytes_.F64();
    if (!(value > 1e-30 && value < 1e30)) bytes_.Refuse(fmt::format("has the {} {}", what, value));
    return static_cast<float>(value);
  }

  void ReadTopology(Topology& t) {
    constexpr std::uint32_t kMaxSize = 1u << 20;
    t.name = bytes_.Text();
    t.width_px = Int(kMaxSize);
    t.height_px = Int(kMaxSize);
    t.colours = Int(kMaxSize);
    t.leaky_slope = static_cast<float>(bytes_.F64());
    t.convolutions.resize(static_cast<std::size_t>(Int(kMaxLayers)));
    for (ConvolutionDesign& c : t.convolutions) {
      c.channels = Int(kMaxSize);
      c.kernel = Int(kMaxSize);
      c.stride = Int(kMaxSize);
    }
    t.dense.resize(static_cast<std::size_t>(Int(kMaxLayers)));
    for (int& outputs : t.dense) outputs = Int(kMaxSize);
  }

  LayerWeights ReadLayer(const LayerShape& shape) {
    LayerWeights layer{.weights = bytes_.F32s(), .biases = bytes_.F32s()};
    if (layer.weights.size() != static_cast<std::size_t>(shape.Weights()) ||
        layer.biases.size() != static_cast<std::size_t>(shape.out_channels))
      bytes_.Refuse(fmt::format("has a layer of {} weights and {} biases where its shape needs {} and {}",
                                layer.weights.size(), layer.biases.size(), shape.Weights(),
                                shape.out_channels));
    for (const std::vector<float>* values : {&layer.weights, &layer.biases})
      for (const float value : *values)
        if (!std::isfinite(value)) bytes_.Refuse("has a weight that is not a finite number");
    return layer;
  }

  LayerQuantization ReadQuantization() {
    LayerQuantization q;
    q.input_scale = Scale("activation scale");
    q.input_zero_point = Int(255);
    q.input_max = Int(255);
    q.weight_scale = Scale("weight scale");
    if (q.input_max < 1 || q.input_zero_point > q.input_max)
      bytes_.Refuse(fmt::format("has the zero point {} of 0 .. {}", q.input_zero_point, q.input_max));
    return q;
  }

  Calibration ReadCalibration() {
    const double temperature = static_cast<double>(Scale("temperature"));
    const Calibration calibration{.temperature = temperature, .offset = bytes_.F64()};
    if (!std::isfinite(calibration.offset))
      bytes_.Refuse("has a calibration offset that is not a finite number");
    return calibration;
  }

  // The integer twin reads pixels as they are.
  void CheckFirstLayer(const DetectorModel& model) {
    if (model.quantization.empty()) return;
    const LayerQuantization& first = model.quantization.front();
    if (first.input_scale != model.pixel_scale || first.input_zero_point != model.pixel_offset ||
        first.input_max != 255)
      bytes_.Refuse("quantises its input otherwise than its pixels are scaled");
  }

  ByteReader bytes_;
};

}  // namespace

void WriteDetectorModel(const std::string& path, const DetectorModel& model) {
  ByteWriter writer;
  WriteTopology(model.topology, writer);
  writer.U32(static_cast<std::uint32_t>(model.pixel_offset));
  writer.F64(static_cast<double>(model.pixel_scale));
  for (const LayerWeights& layer : model.layers) {
    writer.F32s(layer.weights);
    writer.F32s(layer.biases);
  }
  writer.U32(static_cast<std::uint32_t>(model.quantization.size()));
  for (const LayerQuantization& q : model.quantization) {
    writer.F64(static_cast<double>(q.input_scale));
    writer.U32(static_cast<std::uint32_t>(q.input_zero_point));
    writer.U32(static_cast<std::uint32_t>(q.input_max));
    writer.F64(static_cast<double>(q.weight_scale));
  }
  for (const Calibration& calibration : {model.full, model.quantized}) {
    writer.F64(calibration.temperature);
    writer.F64(calibration.offset);
  }
  writer.Text(model.provenance);
  WriteSealedFile(path, kFormat, writer.bytes());
}

DetectorModel ParseDetectorModel(std::string_view bytes, const std::string& name) {
  const std::string payload = OpenSealed(bytes, name, kFormat);
  return ModelReader(payload, name).Read();
}

DetectorModel ReadDetectorModel(const std::string& path) {
  const std::string payload = ReadSealedFile(path, kFormat);
  return ModelReader(payload, path).Read();
}

}  // namespace ed3r::perception
