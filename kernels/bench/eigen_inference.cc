#include <Eigen/Core>

#include "kernels/bench/peers.h"

namespace ed3r::bench {
namespace {

using Eigen::MatrixXf;
using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

class EigenPeer : public InferencePeer {
 public:
  EigenPeer(const kernels::DenseShape& shape, const float* flat, int n) : n_(n), inputs_(shape.inputs()) {
    for (const FlatLayer& layer : FlatLayers(shape, flat)) {
      weights_.push_back(Eigen::Map<const RowMajor>(layer.weights, layer.out, layer.in));
      biases_.push_back(Eigen::Map<const Eigen::VectorXf>(layer.biases, layer.out));
      activations_.push_back(MatrixXf(layer.out, n));
    }
  }

  void Values(const float* inputs, float* values) override {
    const std::size_t last = weights_.size() - 1;
    activations_[0].noalias() = weights_[0] * Eigen::Map<const MatrixXf>(inputs, inputs_, n_);
    for (std::size_t l = 0; l < last; ++l) {
      activations_[l] = (activations_[l].colwise() + biases_[l]).cwiseMax(0.0f);
      activations_[l + 1].noalias() = weights_[l + 1] * activations_[l];
    }
    Eigen::Map<Eigen::RowVectorXf>(values, n_) = activations_[last].row(0).array() + biases_[last][0];
  }

 private:
  int n_, inputs_;
  std::vector<MatrixXf> weights_, activations_;
  std::vector<Eigen::VectorXf> biases_;
};

}  // namespace

std::unique_ptr<InferencePeer> MakeEigen(const kernels::DenseShape& shape, const float* flat, int n) {
  return std::make_unique<EigenPeer>(shape, flat, n);
}

}  // namespace ed3r::bench
