#include <algorithm>
#include <cstring>
#include <vector>

#include "engine/core/check.h"
#include "engine/perception/vision/network.h"
#include "engine/perception/vision/onednn.h"

namespace ed3r::perception {
namespace {

using dnnl::memory;
using Format = memory::format_tag;
constexpr auto kF32 = memory::data_type::f32;

class FloatNetwork final : public Network {
 public:
  FloatNetwork(const DetectorModel& model, int batch)
      : batch_(batch),
        pixel_offset_(model.pixel_offset),
        pixel_scale_(model.pixel_scale),
        stream_(PinnedEngine()) {
    CheckRoomForCode();
    const OneThread one_thread;
    const std::vector<LayerShape> shapes = Layers(model.topology);
    const LayerShape& first = shapes.front();
    pixels_ = static_cast<std::size_t>(first.in_height) * static_cast<std::size_t>(first.in_width);
    input_ = ZeroedMemory({{batch, first.in_channels, first.in_height, first.in_width}, kF32, Format::nchw});
    memory activation = input_;
    for (std::size_t l = 0; l < shapes.size(); ++l) {
      const bool last = l + 1 == shapes.size();
      // Fully connected layers are convolutions, too: the matrix product that oneDNN takes for inner products sums
      // in an order that depends on the batch.
      activation =
          AddConvolution(shapes[l], model.layers[l], activation, last ? 1.0f : model.topology.leaky_slope);
    }
    output_ = InLayout(activation, {{batch, 1, 1, 1}, kF32, Format::nchw});
  }

  void Logits(std::span<const std::uint8_t> rgb, std::span<float> logits) override {
    const std::size_t frame_bytes = 3 * pixels_;
    ED3R_CHECK(rgb.size() == logits.size() * frame_bytes, "frames of another size");
    const OneThread one_thread;
    const auto batch = static_cast<std::size_t>(batch_);
    for (std::size_t begin = 0; begin < logits.size(); begin += batch) {
      const std::size_t frames = std::min(batch, logits.size() - begin);
      for (std::size_t f = 0; f < frames; ++f) SetInput(f, rgb.data() + (begin + f) * frame_bytes);
      for (PrimitiveStep& step : steps_) step.primitive.execute(stream_, step.arguments);
      stream_.wait();
      std::memcpy(logits.data() + begin, output_.get_data_handle(), frames * sizeof(float));
    }
  }

 private:
  void SetInput(std::size_t frame, const std::uint8_t* rgb) {
    float* planes = static_cast<float*>(input_.get_data_handle()) + frame * 3 * pixels_;
    for (std::size_t p = 0; p < pixels_; ++p)
      for (std::size_t c = 0; c < 3; ++c)
        planes[c * pixels_ + p] = static_cast<float>(rgb[3 * p + c] - pixel_offset_) * pixel_scale_;
  }

  static dnnl::primitive_attr Attributes(float leaky_slope) {
    dnnl::primitive_attr attributes = AttributesWithOwnScratchpad();
    if (leaky_slope == 1.0f) return attributes;
    dnnl::post_ops post;
    post.append_eltwise(1.0f, dnnl::algorithm::eltwise_relu, leaky_slope, 0.0f);
    attributes.set_post_ops(post);
    return attributes;
  }

  memory Biases(const LayerWeights& layer, const memory::desc& description) {
    memory biases = ZeroedMemory(description);
    std::copy(layer.biases.begin(), layer.biases.end(), static_cast<float*>(biases.get_data_handle()));
    return biases;
  }

  memory Add(const dnnl::convolution_forward::primitive_desc& chosen, const memory& source,
             const memory::desc& plain_weights, const LayerWeights& layer) {
    const memory given(plain_weights, PinnedEngine(), const_cast<float*>(layer.weights.data()));
    const memory weights = Copied(given, chosen.weights_desc());
    memory destination = ZeroedMemory(chosen.dst_desc());
    PrimitiveStep step = MakeStep<dnnl::convolution_forward>(chosen, InLayout(source, chosen.src_desc()),
                                                             weights, destination);
    step.arguments.emplace(DNNL_ARG_BIAS, Biases(layer, chosen.bias_desc()));
    steps_.push_back(std::move(step));
    return destination;
  }

  // A reorder that runs with every batch, where the next layer wants another layout.
  memory InLayout(const memory& source, const memory::desc& wanted) {
    if (source.get_desc() == wanted) return source;
    memory moved = ZeroedMemory(wanted);
    const dnnl::reorder::primitive_desc chosen(PinnedEngine(), source.get_desc(), PinnedEngine(), wanted,
                                               AttributesWithOwnScratchpad());
    steps_.push_back({dnnl::reorder(chosen),
                      {{DNNL_ARG_FROM, source},
                       {DNNL_ARG_TO, moved},
                       {DNNL_ARG_SCRATCHPAD, memory(chosen.scratchpad_desc(), PinnedEngine())}}});
    return moved;
  }

  memory AddConvolution(const LayerShape& s, const LayerWeights& layer, const memory& source,
                        float leaky_slope) {
    const bool first = steps_.empty();
    const memory::desc src =
        first ? source.get_desc()
              : memory::desc({batch_, s.in_channels, s.in_height, s.in_width}, kF32, Format::any);
    const memory::dims kernel{s.out_channels, s.in_channels, s.kernel_height, s.kernel_width};
    const memory::desc dst({batch_, s.out_channels, s.out_height, s.out_width}, kF32, Format::any);
    const dnnl::convolution_forward::desc wanted(
        dnnl::prop_kind::forward_inference, dnnl::algorithm::convolution_direct, src,
        memory::desc(kernel, kF32, Format::any), memory::desc({s.out_channels}, kF32, Format::x), dst,
        {s.stride, s.stride}, {s.padding, s.padding}, {s.padding, s.padding});
    const dnnl::convolution_forward::primitive_desc chosen(wanted, Attributes(leaky_slope), PinnedEngine());
    return Add(chosen, source, memory::desc(kernel, kF32, Format::oihw), layer);
  }

  int batch_;
  std::int32_t pixel_offset_;
  float pixel_scale_;
  std::size_t pixels_ = 0;
  dnnl::stream stream_;
  memory input_, output_;
  std::vector<PrimitiveStep> steps_;
};

}  // namespace

std::unique_ptr<Network> MakeFloatNetwork(const DetectorModel& model, int batch) {
  return std::make_unique<FloatNetwork>(model, batch);
}

}  // namespace ed3r::perception
