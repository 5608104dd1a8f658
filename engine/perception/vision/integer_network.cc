#include <algorithm>
#include <cstring>
#include <vector>

#include "engine/core/check.h"
#include "engine/perception/vision/network.h"
#include "engine/perception/vision/onednn.h"
#include "engine/perception/vision/requantize.h"

namespace ed3r::perception {
namespace {

using dnnl::memory;
using Format = memory::format_tag;

// A layer with its input and its sums. Padding is part of the input buffer and holds the zero point, so that oneDNN
// sees a plain integer convolution without padding; the zero point's share of the sums is taken off in the bias.
struct IntegerLayer {
  LayerShape shape;
  int in_height, in_width;  // with padding
  memory input;             // u8, frame, row, column, channel
  memory sums;              // s32, likewise
  PrimitiveStep step;
  Requantization to_next;
};

class IntegerNetwork final : public Network {
 public:
  IntegerNetwork(const DetectorModel& model, int batch) : batch_(batch), stream_(PinnedEngine()) {
    CheckRoomForCode();
    const OneThread one_thread;
    const std::vector<LayerShape> shapes = Layers(model.topology);
    ED3R_CHECK(model.quantization.size() == shapes.size(), "a model without quantisation scales");
    for (std::size_t l = 0; l < shapes.size(); ++l) {
      AddLayer(shapes[l], model.layers[l], model.quantization[l]);
      const bool last = l + 1 == shapes.size();
      layers_.back().to_next.leaky_slope = last ? 1.0f : model.topology.leaky_slope;
      if (last) continue;
      layers_.back().to_next.inverse_scale = 1.0f / model.quantization[l + 1].input_scale;
      layers_.back().to_next.zero_point = model.quantization[l + 1].input_zero_point;
      layers_.back().to_next.max = model.quantization[l + 1].input_max;
    }
  }

  void Logits(std::span<const std::uint8_t> rgb, std::span<float> logits) override {
    const std::size_t frame_bytes = static_cast<std::size_t>(layers_.front().shape.Inputs());
    ED3R_CHECK(rgb.size() == logits.size() * frame_bytes, "frames of another size");
    const OneThread one_thread;
    const auto batch = static_cast<std::size_t>(batch_);
    for (std::size_t begin = 0; begin < logits.size(); begin += batch) {
      const std::size_t frames = std::min(batch, logits.size() - begin);
      for (std::size_t f = 0; f < frames; ++f) SetInput(f, rgb.data() + (begin + f) * frame_bytes);
      for (std::size_t l = 0; l < layers_.size(); ++l) {
        layers_[l].step.primitive.execute(stream_, layers_[l].step.arguments);
        stream_.wait();
        if (l + 1 < layers_.size()) Pass(layers_[l], layers_[l + 1], frames);
      }
      const auto* sums = static_cast<const std::int32_t*>(layers_.back().sums.get_data_handle());
      for (std::size_t f = 0; f < frames; ++f)
        logits[begin + f] = Dequantized(layers_.back().to_next, sums[f]);
    }
  }

 private:
  // First byte of a row inside the padding.
  static std::uint8_t* Row(const IntegerLayer& layer, std::size_t frame, int row) {
    const LayerShape& s = layer.shape;
    const std::size_t y =
        frame * static_cast<std::size_t>(layer.in_height) + static_cast<std::size_t>(row + s.padding);
    const std::size_t pixel =
        y * static_cast<std::size_t>(layer.in_width) + static_cast<std::size_t>(s.padding);
    return static_cast<std::uint8_t*>(layer.input.get_data_handle()) +
           pixel * static_cast<std::size_t>(s.in_channels);
  }

  void SetInput(std::size_t frame, const std::uint8_t* rgb) {
    const LayerShape& s = layers_.front().shape;
    const auto row_bytes = static_cast<std::size_t>(s.in_width) * static_cast<std::size_t>(s.in_channels);
    for (int row = 0; row < s.in_height; ++row)
      std::memcpy(Row(layers_.front(), frame, row), rgb + static_cast<std::size_t>(row) * row_bytes,
                  row_bytes);
  }

  static void Pass(const IntegerLayer& from, const IntegerLayer& to, std::size_t frames) {
    const LayerShape& s = from.shape;
    const auto row_values = static_cast<std::size_t>(s.out_width) * static_cast<std::size_t>(s.out_channels);
    const auto* sums = static_cast<const std::int32_t*>(from.sums.get_data_handle());
    for (std::size_t f = 0; f < frames; ++f)
      for (int row = 0; row < s.out_height; ++row, sums += row_values)
        RequantizeRow(from.to_next, sums, Row(to, f, row));
  }

  void AddLayer(const LayerShape& s, const LayerWeights& layer, const LayerQuantization& q) {
    IntegerLayer added{.shape = s,
                       .in_height = s.in_height + 2 * s.padding,
                       .in_width = s.in_width + 2 * s.padding,
                       .input = {},
                       .sums = {},
                       .step = {},
                       .to_next = {}};
    const memory::dims in{batch_, s.in_channels, added.in_height, added.in_width};
    added.input = memory({in, memory::data_type::u8, Format::nhwc}, PinnedEngine());
    std::memset(added.input.get_data_handle(), q.input_zero_point, added.input.get_desc().get_size());

    const std::vector<std::int8_t> integers = QuantizedWeights(layer, q);
    added.to_next.scale = q.input_scale * q.weight_scale;
    std::vector<std::int32_t> zero_point_sums(layer.biases.size(), 0);
    const std::size_t per_output = integers.size() / layer.biases.size();
    for (std::size_t i = 0; i < integers.size(); ++i)
      zero_point_sums[i / per_output] += q.input_zero_point * integers[i];
    for (int x = 0; x < s.out_width; ++x) {
      Requantization& r = added.to_next;
      r.biases.insert(r.biases.end(), layer.biases.begin(), layer.biases.end());
      r.zero_point_sums.insert(r.zero_point_sums.end(), zero_point_sums.begin(), zero_point_sums.end());
    }

    if (s.dense)
      MakeDense(added, in, integers);
    else
      MakeConvolution(added, in, integers);
    layers_.push_back(std::move(added));
  }

  template <class Primitive, class Description>
  void Finish(IntegerLayer& layer, const Description& chosen, const memory::desc& plain,
              const std::vector<std::int8_t>& integers) {
    const memory given(plain, PinnedEngine(), const_cast<std::int8_t*>(integers.data()));
    const memory weights = Copied(given, chosen.weights_desc());
    layer.sums = ZeroedMemory(chosen.dst_desc());
    layer.step = MakeStep<Primitive>(chosen, layer.input, weights, layer.sums);
  }

  void MakeConvolution(IntegerLayer& layer, const memory::dims& in,
                       const std::vector<std::int8_t>& integers) {
    const LayerShape& s = layer.shape;
    const memory::dims kernel{s.out_channels, s.in_channels, s.kernel_height, s.kernel_width};
    const dnnl::convolution_forward::desc wanted(
        dnnl::prop_kind::forward_inference, dnnl::algorithm::convolution_direct,
        memory::desc(in, memory::data_type::u8, Format::nhwc),
        memory::desc(kernel, memory::data_type::s8, Format::any),
        memory::desc({batch_, s.out_channels, s.out_height, s.out_width}, memory::data_type::s32,
                     Format::nhwc),
        {s.stride, s.stride}, {0, 0}, {0, 0});
    const dnnl::convolution_forward::primitive_desc chosen(wanted, AttributesWithOwnScratchpad(),
                                                           PinnedEngine());
    Finish<dnnl::convolution_forward>(layer, chosen, {kernel, memory::data_type::s8, Format::oihw}, integers);
  }

  void MakeDense(IntegerLayer& layer, const memory::dims& in, const std::vector<std::int8_t>& integers) {
    const LayerShape& s = layer.shape;
    const memory::dims kernel{s.out_channels, s.in_channels, s.kernel_height, s.kernel_width};
    const dnnl::inner_product_forward::desc wanted(
        dnnl::prop_kind::forward_inference, memory::desc(in, memory::data_type::u8, Format::nhwc),
        memory::desc(kernel, memory::data_type::s8, Format::any),
        memory::desc({batch_, s.out_channels}, memory::data_type::s32, Format::nc));
    const dnnl::inner_product_forward::primitive_desc chosen(wanted, AttributesWithOwnScratchpad(),
                                                             PinnedEngine());
    Finish<dnnl::inner_product_forward>(layer, chosen, {kernel, memory::data_type::s8, Format::oihw},
                                        integers);
  }

  int batch_;
  dnnl::stream stream_;
  std::vector<IntegerLayer> layers_;
};

}  // namespace

std::unique_ptr<Network> MakeIntegerNetwork(const DetectorModel& model, int batch) {
  return std::make_unique<IntegerNetwork>(model, batch);
}

}  // namespace ed3r::perception
