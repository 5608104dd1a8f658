#include <omp.h>

#include <dnnl.hpp>
#include <unordered_map>

#include "kernels/bench/peers.h"

namespace ed3r::bench {
namespace {

using dnnl::memory;
using Format = memory::format_tag;

constexpr auto kF32 = memory::data_type::f32;

// One inner product per layer with bias and ReLU fused in; weights in the layout that oneDNN asks for.
class OneDnnPeer : public InferencePeer {
 public:
  OneDnnPeer(const kernels::DenseShape& shape, const float* flat, int n)
      : engine_(dnnl::engine::kind::cpu, 0), stream_(engine_) {
    omp_set_num_threads(1);
    for (const FlatLayer& layer : FlatLayers(shape, flat)) AddLayer(layer, n, layer.out > 1);
  }

  void Values(const float* inputs, float* values) override {
    arguments_.front().at(DNNL_ARG_SRC).set_data_handle(const_cast<float*>(inputs));
    arguments_.back().at(DNNL_ARG_DST).set_data_handle(values);
    for (std::size_t l = 0; l < primitives_.size(); ++l) primitives_[l].execute(stream_, arguments_[l]);
    stream_.wait();
  }

 private:
  void AddLayer(const FlatLayer& layer, int n, bool relu) {
    const memory::desc src({n, layer.in}, kF32, Format::nc), dst({n, layer.out}, kF32, Format::nc);
    const memory::desc bias({layer.out}, kF32, Format::x), plain({layer.out, layer.in}, kF32, Format::oi);
    dnnl::primitive_attr attributes;
    if (relu) {
      dnnl::post_ops post;
      post.append_eltwise(1.0f, dnnl::algorithm::eltwise_relu, 0.0f, 0.0f);
      attributes.set_post_ops(post);
    }
    const dnnl::inner_product_forward::desc wanted(dnnl::prop_kind::forward_inference, src,
                                                   memory::desc({layer.out, layer.in}, kF32, Format::any),
                                                   bias, dst);
    const dnnl::inner_product_forward::primitive_desc chosen(wanted, attributes, engine_);
    memory from(plain, engine_, const_cast<float*>(layer.weights)), weights(chosen.weights_desc(), engine_);
    dnnl::reorder(from, weights).execute(stream_, from, weights);
    memory biases(bias, engine_);
    std::copy_n(layer.biases, layer.out, static_cast<float*>(biases.get_data_handle()));
    const memory input = arguments_.empty() ? memory(src, engine_) : arguments_.back().at(DNNL_ARG_DST);
    stream_.wait();
    arguments_.push_back({{DNNL_ARG_SRC, input},
                          {DNNL_ARG_WEIGHTS, weights},
                          {DNNL_ARG_BIAS, biases},
                          {DNNL_ARG_DST, memory(dst, engine_)}});
    primitives_.push_back(dnnl::inner_product_forward(chosen));
  }

  dnnl::engine engine_;
  dnnl::stream stream_;
  std::vector<dnnl::primitive> primitives_;
  std::vector<std::unordered_map<int, memory>> arguments_;
};

}  // namespace

std::unique_ptr<InferencePeer> MakeOneDnn(const kernels::DenseShape& shape, const float* flat, int n) {
  return std::make_unique<OneDnnPeer>(shape, flat, n);
}

}  // namespace ed3r::bench
