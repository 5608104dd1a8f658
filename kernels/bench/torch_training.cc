#include <ATen/Parallel.h>
#include <torch/torch.h>

#include "kernels/bench/peers.h"

namespace ed3r::bench {
namespace {

class TorchTraining : public TrainingPeer {
 public:
  TorchTraining(const kernels::DenseShape& shape, const float* flat, const kernels::TrainOptions& options)
      : inputs_(shape.inputs()), dropout_(options.dropout) {
    at::set_num_threads(1);
    std::vector<torch::Tensor> parameters;
    for (const FlatLayer& layer : FlatLayers(shape, flat)) {
      weights_.push_back(torch::from_blob(const_cast<float*>(layer.weights), {layer.out, layer.in}).clone());
      biases_.push_back(torch::from_blob(const_cast<float*>(layer.biases), {layer.out}).clone());
      for (torch::Tensor* t : {&weights_.back(), &biases_.back()}) {
        t->set_requires_grad(true);
        parameters.push_back(*t);
      }
    }
    adam_ = std::make_unique<torch::optim::Adam>(parameters, torch::optim::AdamOptions(options.learning_rate)
                                                                 .betas({options.beta1, options.beta2})
                                                                 .eps(options.epsilon));
  }

  double Step(const float* inputs, const float* targets, const std::uint32_t* rows, int n) override {
    torch::Tensor h = torch::empty({n, inputs_}), wanted = torch::empty({n});
    for (int r = 0; r < n; ++r) {
      const float* row = inputs + static_cast<std::size_t>(rows[r]) * inputs_;
      std::copy(row, row + inputs_, h.data_ptr<float>() + r * inputs_);
      wanted.data_ptr<float>()[r] = targets[rows[r]];
    }
    for (std::size_t l = 0; l < weights_.size(); ++l) {
      h = torch::linear(h, weights_[l], biases_[l]);
      if (l + 1 == weights_.size()) break;
      h = torch::relu(h);
      if (dropout_ > 0) h = torch::dropout(h, dropout_, true);
    }
    const torch::Tensor loss = torch::mse_loss(h.squeeze(1), wanted);
    adam_->zero_grad();
    loss.backward();
    adam_->step();
    return loss.item<double>();
  }

 private:
  int inputs_;
  double dropout_;
  std::vector<torch::Tensor> weights_, biases_;
  std::unique_ptr<torch::optim::Adam> adam_;
};

}  // namespace

std::unique_ptr<TrainingPeer> MakeTorchTraining(const kernels::DenseShape& shape, const float* flat,
                                                const kernels::TrainOptions& options) {
  return std::make_unique<TorchTraining>(shape, flat, options);
}

}  // namespace ed3r::bench
