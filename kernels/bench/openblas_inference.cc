#include <cblas.h>

#include <algorithm>

#include "kernels/bench/peers.h"

namespace ed3r::bench {
namespace {

class OpenBlasPeer : public InferencePeer {
 public:
  OpenBlasPeer(const kernels::DenseShape& shape, const float* flat, int n)
      : n_(n), flat_(flat, flat + kernels::ParameterCount(shape)), layers_(FlatLayers(shape, flat_.data())) {
    openblas_set_num_threads(1);
    for (std::vector<float>& h : activations_)
      h.resize(static_cast<std::size_t>(kernels::WidestLayer(shape)) * n);
  }

  void Values(const float* inputs, float* values) override {
    const float* x = inputs;
    for (std::size_t l = 0; l < layers_.size(); ++l) {
      const FlatLayer& layer = layers_[l];
      const bool last = l + 1 == layers_.size();
      float* y = last ? values : activations_[l % 2].data();
      if (last)
        cblas_sgemv(CblasRowMajor, CblasNoTrans, n_, layer.in, 1.0f, x, layer.in, layer.weights, 1, 0.0f, y,
                    1);
      else
        cblas_sgemm(CblasRowMajor, CblasNoTrans, CblasTrans, n_, layer.out, layer.in, 1.0f, x, layer.in,
                    layer.weights, layer.in, 0.0f, y, layer.out);
      AddBias(layer, !last, y);
      x = y;
    }
  }

 private:
  void AddBias(const FlatLayer& layer, bool relu, float* y) const {
    const float floor = relu ? 0.0f : -3e38f;
    for (int r = 0; r < n_; ++r)
      for (int o = 0; o < layer.out; ++o) {
        float& v = y[static_cast<std::size_t>(r) * layer.out + o];
        v = std::max(v + layer.biases[o], floor);
      }
  }

  int n_;
  std::vector<float> flat_;
  std::vector<FlatLayer> layers_;
  std::vector<float> activations_[2];
};

}  // namespace

std::unique_ptr<InferencePeer> MakeOpenBlas(const kernels::DenseShape& shape, const float* flat, int n) {
  return std::make_unique<OpenBlasPeer>(shape, flat, n);
}

}  // namespace ed3r::bench
