#include <Eigen/Core>
#include <cmath>
#include <random>

#include "kernels/bench/peers.h"

namespace ed3r::bench {
namespace {

using Eigen::ArrayXXf;
using Eigen::MatrixXf;
using Eigen::VectorXf;
using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// A parameter array with its gradient and Adam's moments.
template <class Array>
struct Parameter {
  explicit Parameter(const Array& start)
      : value(start), gradient(start), m(Array::Zero(start.rows(), start.cols())), v(m) {}

  void Update(const kernels::TrainOptions& o, float rate, float root_factor) {
    const auto g = gradient.array();
    m.array() = static_cast<float>(o.beta1) * m.array() + static_cast<float>(1.0 - o.beta1) * g;
    v.array() = static_cast<float>(o.beta2) * v.array() + static_cast<float>(1.0 - o.beta2) * g * g;
    value.array() -= rate * m.array() / (v.array().sqrt() * root_factor + static_cast<float>(o.epsilon));
  }

  Array value, gradient, m, v;
};

enum class Draws { kEigens, kOurs };

class EigenTraining : public TrainingPeer {
 public:
  EigenTraining(const kernels::DenseShape& shape, const float* flat, const kernels::TrainOptions& options,
                Draws draws)
      : shape_(shape), options_(options), draws_(draws) {
    for (const FlatLayer& layer : FlatLayers(shape, flat)) {
      weights_.emplace_back(MatrixXf(Eigen::Map<const RowMajor>(layer.weights, layer.out, layer.in)));
      biases_.emplace_back(VectorXf(Eigen::Map<const VectorXf>(layer.biases, layer.out)));
    }
    activations_.resize(shape.layers + 1);
    deltas_.resize(shape.layers + 1);
  }

  double Step(const float* inputs, const float* targets, const std::uint32_t* rows, int n) override {
    const double loss = Forward(inputs, targets, rows, n);
    const float scale = static_cast<float>(1.0 / (1.0 - options_.dropout));
    for (int l = shape_.layers - 1; l >= 0; --l) {
      weights_[l].gradient.noalias() = deltas_[l + 1] * activations_[l].transpose();
      biases_[l].gradient = deltas_[l + 1].rowwise().sum();
      if (l == 0) break;
      deltas_[l].noalias() = weights_[l].value.transpose() * deltas_[l + 1];
      deltas_[l].array() = (activations_[l].array() > 0.0f).select(deltas_[l].array() * scale, 0.0f);
    }
    beta1_power_ *= options_.beta1;
    beta2_power_ *= options_.beta2;
    const float rate = static_cast<float>(options_.learning_rate / (1.0 - beta1_power_));
    const float root_factor = static_cast<float>(1.0 / std::sqrt(1.0 - beta2_power_));
    for (Parameter<MatrixXf>& w : weights_) w.Update(options_, rate, root_factor);
    for (Parameter<VectorXf>& b : biases_) b.Update(options_, rate, root_factor);
    return loss;
  }

 private:
  double Forward(const float* inputs, const float* targets, const std::uint32_t* rows, int n) {
    activations_[0].resize(shape_.inputs(), n);
    Eigen::RowVectorXf wanted(n);
    for (int r = 0; r < n; ++r) {
      activations_[0].col(r) = Eigen::Map<const VectorXf>(
          inputs + static_cast<std::size_t>(rows[r]) * shape_.inputs(), shape_.inputs());
      wanted[r] = targets[rows[r]];
    }
    for (int l = 0; l < shape_.layers; ++l) {
      MatrixXf& z = activations_[l + 1];
      z.noalias() = weights_[l].value * activations_[l];
      if (l + 1 == shape_.layers) {
        z.colwise() += biases_[l].value;
      } else {
        draws_ == Draws::kOurs ? HashMask(l + 1, n) : RandomMask(l + 1, n);
        z = (z.colwise() + biases_[l].value).cwiseMax(0.0f).cwiseProduct(mask_);
      }
    }
    const Eigen::RowVectorXf error = activations_.back() - wanted;
    deltas_.back() = (2.0f / static_cast<float>(n)) * error;
    return error.cast<double>().squaredNorm() / n;
  }

  // What Eigen itself offers: a coefficient is uniform in [-1, 1].
  void RandomMask(int layer, int n) {
    const float scale = static_cast<float>(1.0 / (1.0 - options_.dropout));
    const auto limit = static_cast<float>(2.0 * options_.dropout - 1.0);
    mask_.setRandom(shape_.sizes[layer], n);
    mask_ = (mask_.array() < limit).select(0.0f, MatrixXf::Constant(mask_.rows(), n, scale));
  }

  // As cheap a draw as that of kernels/train.h, in a loop that the compiler vectorises.
  void HashMask(int layer, int n) {
    const auto limit = static_cast<std::int32_t>((options_.dropout - 0.5) * 4294967296.0);
    const float scale = static_cast<float>(1.0 / (1.0 - options_.dropout));
    const int neurons = shape_.sizes[layer];
    mask_.resize(neurons, n);
    keys_.resize(neurons);
    for (std::uint32_t& key : keys_) key = static_cast<std::uint32_t>(random_());
    for (int r = 0; r < n; ++r) {
      float* column = mask_.col(r).data();
      const auto row_key = static_cast<std::uint32_t>(random_());
      for (int j = 0; j < neurons; ++j) {
        const std::uint32_t y = row_key ^ keys_[j];
        column[j] = static_cast<std::int32_t>((y ^ (y >> 15)) * 0x846ca68bu) < limit ? 0.0f : scale;
      }
    }
  }

  kernels::DenseShape shape_;
  kernels::TrainOptions options_;
  Draws draws_;
  std::minstd_rand random_;
  std::vector<std::uint32_t> keys_;
  double beta1_power_ = 1.0, beta2_power_ = 1.0;
  std::vector<Parameter<MatrixXf>> weights_;
  std::vector<Parameter<VectorXf>> biases_;
  std::vector<MatrixXf> activations_, deltas_;  // neurons x rows
  MatrixXf mask_;
};

}  // namespace

std::unique_ptr<TrainingPeer> MakeEigenTraining(const kernels::DenseShape& shape, const float* flat,
                                                const kernels::TrainOptions& options) {
  return std::make_unique<EigenTraining>(shape, flat, options, Draws::kEigens);
}

std::unique_ptr<TrainingPeer> MakeEigenTrainingWithOurDraws(const kernels::DenseShape& shape,
                                                            const float* flat,
                                                            const kernels::TrainOptions& options) {
  return std::make_unique<EigenTraining>(shape, flat, options, Draws::kOurs);
}

}  // namespace ed3r::bench
