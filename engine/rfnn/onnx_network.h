// Networks of the user's own: ONNX files that score an action, as the networks that a run trains do.
//
// The graph is one chain from one input of [n, 13] floats for the RC or [n, 11] for the robot, in the order and the units
// of features.h, to one output of [n, 1]: the predicted reward, or anything else of which more is better:
//
//   (x - mean) / sd     optional: Sub with 13 (11) values, then Div, or Mul by the inverses
//   Gemm | MatMul, Add  a dense layer, alpha = beta = 1; after each but the last a Relu
//   y sd + mean         optional: Mul by one value > 0, then Add of one
//
// with Identity anywhere; at most kMaxDenseLayers layers of at most 65536 neurons. That is what torch.onnx.export makes of
// nn.Sequential(nn.Linear, nn.ReLU, ...). Everything else is refused with the node that does not fit. Such a network runs
// on the engine's own kernels: as fast as a trained one, and the same bits on every CPU.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "engine/rfnn/model.h"

namespace ed3r {

class OnnxNetwork {
 public:
  // `design`: kRcNetwork or kRobotNetwork; its hidden layers do not count. `name` begins the messages. Throws UserError.
  static std::shared_ptr<const OnnxNetwork> Parse(std::string_view bytes, const std::string& name,
                                                  const NetworkDesign& design);
  static std::shared_ptr<const OnnxNetwork> Read(const std::string& path, const std::string& key,
                                                 const NetworkDesign& design);

  const Model& model() const { return *model_; }
  const std::string& sha256() const { return sha256_; }  // of the file

  OnnxNetwork(const OnnxNetwork&) = delete;
  OnnxNetwork& operator=(const OnnxNetwork&) = delete;

 private:
  OnnxNetwork() = default;

  std::vector<int> hidden_;  // the model's design refers to it
  std::unique_ptr<const Model> model_;
  std::string sha256_;
};

// A network as an ONNX file of this form (opset 13). The means and deviations that the engine keeps in double precision
// are also in the file's metadata ("ed3r.scaling"), so that Parse gives the same choices, bit for bit.
std::string OnnxBytes(const Model& model);

}  // namespace ed3r
