// Networks of the user's own: ONNX files that score an action, as the networks that a run trains do, or that decide.
//
// The graph is one chain from one input to one output, the inputs raw, in the order and the units of features.h:
//
//            scores an action   decides (direct_network.h)
//   RC       [n, 13] to [n, 1]  [n, 8] to [n, 5]: dx_m, dy_m, dz_m, turn_rad, tilt_command_rad, cut to the ranges in force
//   robot    [n, 11] to [n, 1]  [n, 9] to [n, 3]: how much it likes offload, Full, Quantized
//
// A score is the predicted reward, or anything else of which more is better. The chain:
//
//   (x - mean) / sd     optional: Sub with a value for each input, then Div, or Mul by the inverses
//   Gemm | MatMul, Add  a dense layer, alpha = beta = 1; after each but the last a Relu
//   y sd + mean         optional: Mul by one value > 0, then Add of one; of a decision by one value each, of any sign
//
// with Identity anywhere; at most kMaxDenseLayers layers of at most 65536 neurons. That is what torch.onnx.export makes of
// nn.Sequential(nn.Linear, nn.ReLU, ...). Everything else is refused with the node that does not fit. Such a network runs
// on the engine's own kernels: as fast as a trained one, and the same bits on every CPU.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "engine/rfnn/direct_network.h"
#include "engine/rfnn/model.h"
#include "engine/rfnn/onnx_graph.h"

namespace ed3r::rfnn {

class OnnxNetwork {
 public:
  // `design`: kRcNetwork or kRobotNetwork; its hidden layers do not count. `name` begins the messages. Throws UserError.
  static std::shared_ptr<const OnnxNetwork> Parse(std::string_view bytes, const std::string& name,
                                                  const NetworkDesign& design);
  static std::shared_ptr<const OnnxNetwork> Read(const std::string& path, const std::string& key,
                                                 const NetworkDesign& design);

  // One of the two; the other is null.
  const Model* scores() const { return scores_.get(); }
  const DirectNetwork* direct() const { return direct_.get(); }
  const std::string& sha256() const { return sha256_; }  // of the file

  OnnxNetwork(const OnnxNetwork&) = delete;
  OnnxNetwork& operator=(const OnnxNetwork&) = delete;

 private:
  OnnxNetwork() = default;

  std::vector<int> hidden_;  // the models' designs refer to it
  std::unique_ptr<const Model> scores_;
  std::unique_ptr<const DirectNetwork> direct_;
  std::string sha256_;
};

// A network as an ONNX file of this form (opset 13). The means and deviations that the engine keeps in double precision
// are also in the file's metadata ("ed3r.scaling"), so that Parse gives the same choices, bit for bit. The names of the inputs are
// there too ("ed3r.features"): where a file has them, Parse refuses others or another order.
std::string OnnxBytes(const Model& model);

// A network of numbers from elsewhere. Layer l maps x to x weights[l] + biases[l], with a Relu between layers.
struct DenseChain {
  std::vector<float> mean, inverse_sd;  // of the inputs; empty: the inputs go in as they are
  std::vector<OnnxTensor> weights;      // inputs x outputs
  std::vector<OnnxTensor> biases;
};

// The chain as an ONNX file of this form. Throws UserError, as Parse, for one that Parse would refuse.
std::string OnnxBytes(const DenseChain& chain, const std::string& name, const NetworkDesign& design);

}  // namespace ed3r::rfnn
