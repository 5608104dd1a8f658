#include "engine/perception/vision/detector_model.h"

#include <algorithm>
#include <cmath>

#include "engine/core/random.h"

namespace ed3r::perception {

std::vector<std::int8_t> QuantizedWeights(const LayerWeights& layer, const LayerQuantization& quantization) {
  const auto limit = static_cast<float>(WeightLimit(quantization.input_max));
  std::vector<std::int8_t> integers(layer.weights.size());
  std::transform(layer.weights.begin(), layer.weights.end(), integers.begin(), [&](float weight) {
    const float scaled = std::nearbyint(weight / quantization.weight_scale);
    return static_cast<std::int8_t>(std::clamp(scaled, -limit, limit));
  });
  return integers;
}

double Confidence(double logit, const Calibration& calibration) {
  return 1.0 / (1.0 + std::exp(-(logit / calibration.temperature + calibration.offset)));
}

DetectorModel RandomDetectorModel(const Topology& topology, std::uint64_t seed) {
  DetectorModel model;
  model.topology = topology;
  std::uint32_t index = 0;
  for (const LayerShape& shape : Layers(topology)) {
    Stream stream(seed, 0, Purpose::kTraining, index);
    const auto fan_in = static_cast<double>(shape.Weights() / shape.out_channels);
    const double limit = std::sqrt(6.0 / fan_in);  // of the uniform distribution with He's variance
    LayerWeights layer;
    layer.weights.resize(static_cast<std::size_t>(shape.Weights()));
    for (float& weight : layer.weights) weight = static_cast<float>(stream.Uniform(-limit, limit));
    layer.biases.resize(static_cast<std::size_t>(shape.out_channels));
    for (float& bias : layer.biases) bias = static_cast<float>(stream.Uniform(-0.1, 0.1));
    model.layers.push_back(std::move(layer));

    LayerQuantization quantization{
        .input_scale = 0.04f, .input_zero_point = 20, .input_max = 127, .weight_scale = 0.0f};
    if (index == 0)
      quantization = {
          .input_scale = model.pixel_scale, .input_zero_point = model.pixel_offset, .input_max = 255};
    quantization.weight_scale =
        static_cast<float>(limit) / static_cast<float>(WeightLimit(quantization.input_max));
    model.quantization.push_back(quantization);
    ++index;
  }
  return model;
}

}  // namespace ed3r::perception
