#include "tests/vision/reference_network.h"

#include <algorithm>
#include <cmath>

#include "engine/core/random.h"

namespace ed3r::test {
namespace {

// Calls term(weight index, input index or -1 for padding) for every weight of one output.
template <class Term>
void ForEachWeight(const perception::LayerShape& s, int out, int y, int x, Term&& term) {
  for (int in = 0; in < s.in_channels; ++in)
    for (int ky = 0; ky < s.kernel_height; ++ky)
      for (int kx = 0; kx < s.kernel_width; ++kx) {
        const int row = y * s.stride + ky - s.padding, column = x * s.stride + kx - s.padding;
        const bool inside = row >= 0 && row < s.in_height && column >= 0 && column < s.in_width;
        const int weight = ((out * s.in_channels + in) * s.kernel_height + ky) * s.kernel_width + kx;
        term(static_cast<std::size_t>(weight), inside ? (in * s.in_height + row) * s.in_width + column : -1);
      }
}

// Value(layer, output, row, column) for all outputs, planes first.
template <class Value, class Result>
void ForEachOutput(const perception::LayerShape& s, std::vector<Result>& results, Value&& value) {
  for (int out = 0; out < s.out_channels; ++out)
    for (int y = 0; y < s.out_height; ++y)
      for (int x = 0; x < s.out_width; ++x) results.push_back(value(out, y, x));
}

template <class Number, class Convert>
std::vector<Number> Planes(std::span<const std::uint8_t> rgb, Convert&& convert) {
  std::vector<Number> planes(rgb.size());
  for (std::size_t i = 0; i < rgb.size(); ++i) planes[i % 3 * (rgb.size() / 3) + i / 3] = convert(rgb[i]);
  return planes;
}

}  // namespace

double ReferenceFloatLogit(const perception::DetectorModel& model, std::span<const std::uint8_t> rgb) {
  const std::vector<perception::LayerShape> shapes = perception::Layers(model.topology);
  std::vector<double> inputs = Planes<double>(
      rgb, [&](int byte) { return (byte - model.pixel_offset) * static_cast<double>(model.pixel_scale); });
  for (std::size_t l = 0; l < shapes.size(); ++l) {
    std::vector<double> outputs;
    ForEachOutput(shapes[l], outputs, [&](int out, int y, int x) {
      double sum = model.layers[l].biases[static_cast<std::size_t>(out)];
      ForEachWeight(shapes[l], out, y, x, [&](std::size_t weight, int input) {
        if (input >= 0)
          sum +=
              static_cast<double>(model.layers[l].weights[weight]) * inputs[static_cast<std::size_t>(input)];
      });
      return l + 1 < shapes.size() && sum < 0 ? sum * static_cast<double>(model.topology.leaky_slope) : sum;
    });
    inputs = std::move(outputs);
  }
  return inputs.front();
}

float ReferenceIntegerLogit(const perception::DetectorModel& model, std::span<const std::uint8_t> rgb) {
  const std::vector<perception::LayerShape> shapes = perception::Layers(model.topology);
  std::vector<std::int64_t> inputs = Planes<std::int64_t>(rgb, [](int byte) { return byte; });
  for (std::size_t l = 0;; ++l) {
    const perception::LayerQuantization& q = model.quantization[l];
    const std::vector<std::int8_t> weights = perception::QuantizedWeights(model.layers[l], q);
    const float scale = q.input_scale * q.weight_scale;
    std::vector<float> outputs;
    ForEachOutput(shapes[l], outputs, [&](int out, int y, int x) {
      std::int64_t sum = 0;
      ForEachWeight(shapes[l], out, y, x, [&](std::size_t weight, int input) {
        if (input >= 0)
          sum += weights[weight] * (inputs[static_cast<std::size_t>(input)] - q.input_zero_point);
      });
      const float value =
          static_cast<float>(sum) * scale + model.layers[l].biases[static_cast<std::size_t>(out)];
      return l + 1 < shapes.size() && value < 0.0f ? value * model.topology.leaky_slope : value;
    });
    if (l + 1 == shapes.size()) return outputs.front();
    const perception::LayerQuantization& next = model.quantization[l + 1];
    const float inverse = 1.0f / next.input_scale;
    inputs.clear();
    for (const float value : outputs) {
      const auto integer = static_cast<std::int64_t>(std::nearbyint(value * inverse)) + next.input_zero_point;
      inputs.push_back(std::clamp<std::int64_t>(integer, 0, next.input_max));
    }
  }
}

std::vector<std::uint8_t> NoiseFrames(const perception::Topology& topology, int frames, std::uint64_t seed) {
  const int block = std::max(1, topology.width_px / 12);
  std::vector<std::uint8_t> rgb;
  for (int f = 0; f < frames; ++f)
    for (int y = 0; y < topology.height_px; ++y)
      for (int x = 0; x < topology.width_px; ++x) {
        Stream coarse(seed, static_cast<std::uint32_t>(f), Purpose::kTraining,
                      static_cast<std::uint32_t>(y / block * 4096 + x / block));
        Stream fine(seed + 1, static_cast<std::uint32_t>(f), Purpose::kTraining,
                    static_cast<std::uint32_t>(y * 4096 + x));
        for (int c = 0; c < 3; ++c) {
          const double value = 300.0 * coarse.Uniform() - 25.0 + 40.0 * fine.Uniform(-1.0, 1.0);
          rgb.push_back(static_cast<std::uint8_t>(std::clamp(value, 0.0, 255.0)));
        }
      }
  return rgb;
}

}  // namespace ed3r::test
