#include <ATen/Parallel.h>
#include <torch/torch.h>

#include <algorithm>

#include "kernels/bench/peers.h"

namespace ed3r::bench {
namespace {

class TorchPeer : public InferencePeer {
 public:
  TorchPeer(const kernels::DenseShape& shape, const float* flat, int n) : n_(n), inputs_(shape.inputs()) {
    at::set_num_threads(1);
    for (const FlatLayer& layer : FlatLayers(shape, flat)) {
      weights_.push_back(torch::from_blob(const_cast<float*>(layer.weights), {layer.out, layer.in}).clone());
      biases_.push_back(torch::from_blob(const_cast<float*>(layer.biases), {layer.out}).clone());
    }
  }

  void Values(const float* inputs, float* values) override {
    const c10::InferenceMode inference;
    torch::Tensor h = torch::from_blob(const_cast<float*>(inputs), {n_, inputs_});
    for (std::size_t l = 0; l < weights_.size(); ++l) {
      h = torch::linear(h, weights_[l], biases_[l]);
      if (l + 1 < weights_.size()) h.relu_();
    }
    std::copy_n(h.data_ptr<float>(), n_, values);
  }

 private:
  int n_, inputs_;
  std::vector<torch::Tensor> weights_, biases_;
};

}  // namespace

std::unique_ptr<InferencePeer> MakeTorch(const kernels::DenseShape& shape, const float* flat, int n) {
  return std::make_unique<TorchPeer>(shape, flat, n);
}

}  // namespace ed3r::bench
