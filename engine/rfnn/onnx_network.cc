#include "engine/rfnn/onnx_network.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <utility>

#include "engine/core/check.h"
#include "engine/core/file.h"
#include "engine/core/sha256.h"
#include "engine/rfnn/onnx_graph.h"

namespace ed3r {
namespace {

constexpr char kScalingKey[] = "ed3r.scaling";
constexpr std::uintmax_t kMostBytes = 256U << 20;
constexpr std::int64_t kMostNeurons = 65536;

// outputs x inputs, row-major.
struct Layer {
  int inputs = 0, outputs = 0;
  std::vector<float> weights, biases;
  bool has_bias = false, has_relu = false;
};

// Walks the chain of nodes from the input to the output.
class Chain {
 public:
  Chain(const OnnxGraph& graph, const std::string& name, const NetworkDesign& design)
      : graph_(graph), name_(name), design_(design) {
    scaling_.input_mean.assign(static_cast<std::size_t>(design.inputs()), 0.0);
    scaling_.input_sd.assign(static_cast<std::size_t>(design.inputs()), 1.0);
  }

  void Walk() {
    if (graph_.inputs.size() != 1 || graph_.outputs.size() != 1)
      Refuse(fmt::format("has {} inputs and {} outputs; allowed: one of each", graph_.inputs.size(),
                         graph_.outputs.size()));
    value_ = graph_.inputs.front();
    for (const OnnxNode& node : graph_.nodes) Step(node);
    if (value_ != graph_.outputs.front())
      Refuse(fmt::format("its output '{}' is not the end of its chain of nodes", graph_.outputs.front()));
    if (layers_.empty() || layers_.back().outputs != 1)
      Refuse(fmt::format("gives {} values; allowed: one, the score of an action",
                         layers_.empty() ? 0 : layers_.back().outputs));
    if (layers_.back().has_relu) Refuse("has a Relu behind its last layer");
    if (layers_.size() > kMaxDenseLayers)
      Refuse(fmt::format("has {} dense layers; allowed: 1 .. {}", layers_.size(), kMaxDenseLayers));
  }

  std::vector<int> Hidden() const {
    std::vector<int> hidden;
    for (std::size_t i = 0; i + 1 < layers_.size(); ++i) hidden.push_back(layers_[i].outputs);
    return hidden;
  }

  std::vector<float> Weights() const {
    std::vector<float> flat;
    for (const Layer& layer : layers_) {
      flat.insert(flat.end(), layer.weights.begin(), layer.weights.end());
      flat.insert(flat.end(), layer.biases.begin(), layer.biases.end());
    }
    if (!std::all_of(flat.begin(), flat.end(), [](float w) { return std::isfinite(w); }))
      Refuse("has a weight that is not finite");
    return flat;
  }

  const Scaling& scaling() const { return scaling_; }

 private:
  [[noreturn]] void Refuse(const std::string& why) const {
    throw UserError(fmt::format("{}: {}", name_, why));
  }
  [[noreturn]] void RefuseNode(const OnnxNode& node, const std::string& why) const {
    Refuse(fmt::format(
        "node '{}' ({}): {}; allowed: Sub, Div or Mul of the inputs, then Gemm or MatMul and Add with "
        "Relu between them, then Mul and Add of the output",
        node.name, node.op, why));
  }

  // The node's tensor beside the chain's value, which comes first, or second where the order does not matter.
  const OnnxTensor& Operand(const OnnxNode& node, bool either) const {
    if (node.inputs.size() < 2) RefuseNode(node, "lacks an input");
    const bool swapped = either && node.inputs[1] == value_;
    if (node.inputs[swapped ? 1 : 0] != value_) RefuseNode(node, "does not go on from the node before it");
    return TensorOf(node, node.inputs[swapped ? 0 : 1]);
  }
  const OnnxTensor& TensorOf(const OnnxNode& node, const std::string& tensor) const {
    const auto found = graph_.tensors.find(tensor);
    if (found == graph_.tensors.end()) RefuseNode(node, fmt::format("'{}' is no tensor of floats", tensor));
    return found->second;
  }

  void Step(const OnnxNode& node) {
    if (node.inputs.empty() || node.outputs.size() != 1) RefuseNode(node, "has no input or several outputs");
    if (node.op == "Gemm") {
      Gemm(node);
    } else if (node.op == "MatMul") {
      AddLayer(node, Operand(node, false), false);
    } else if (node.op == "Relu") {
      Relu(node);
    } else if (node.op == "Add" || node.op == "Mul" || node.op == "Sub" || node.op == "Div") {
      const OnnxTensor& operand = Operand(node, node.op == "Add" || node.op == "Mul");
      layers_.empty() ? ScaleInput(node, operand) : ShiftOutput(node, operand);
    } else if (node.op != "Identity" || node.inputs[0] != value_) {
      RefuseNode(node, "is not understood here");
    }
    value_ = node.outputs.front();
  }

  void Gemm(const OnnxNode& node) {
    if (node.Number("alpha", 1) != 1 || node.Number("beta", 1) != 1 || node.Number("transA", 0) != 0)
      RefuseNode(node, "has an alpha or a beta that is not 1, or a transA");
    AddLayer(node, Operand(node, false), node.Number("transB", 0) != 0);
    if (node.inputs.size() > 2) SetBias(node, TensorOf(node, node.inputs[2]));
  }

  void AddLayer(const OnnxNode& node, const OnnxTensor& weights, bool transposed) {
    if (weights.dims.size() != 2) RefuseNode(node, "its weights have no two dimensions");
    const std::int64_t inputs = weights.dims[transposed ? 1 : 0], outputs = weights.dims[transposed ? 0 : 1];
    const int expected = layers_.empty() ? design_.inputs() : layers_.back().outputs;
    if (inputs != expected || outputs > kMostNeurons)
      RefuseNode(node, fmt::format("takes {} values and gives {}; {} come, and at most {} go", inputs,
                                   outputs, expected, kMostNeurons));
    if (!layers_.empty() && !layers_.back().has_relu) RefuseNode(node, "no Relu stands between two layers");
    if (scaled_output_) RefuseNode(node, "stands behind the output's scale");
    Layer layer{.inputs = static_cast<int>(inputs),
                .outputs = static_cast<int>(outputs),
                .weights = {},
                .biases = {}};
    layer.weights.resize(weights.values.size());
    for (std::int64_t o = 0; o < outputs; ++o)
      for (std::int64_t i = 0; i < inputs; ++i)
        layer.weights[static_cast<std::size_t>(o * inputs + i)] =
            weights.values[static_cast<std::size_t>(transposed ? o * inputs + i : i * outputs + o)];
    layer.biases.assign(static_cast<std::size_t>(outputs), 0.0F);
    layers_.push_back(std::move(layer));
  }

  void SetBias(const OnnxNode& node, const OnnxTensor& bias) {
    Layer& layer = layers_.back();
    if (bias.values.size() != layer.biases.size())
      RefuseNode(node, fmt::format("has {} biases for {} neurons", bias.values.size(), layer.biases.size()));
    layer.biases = bias.values;
    layer.has_bias = true;
  }

  void Relu(const OnnxNode& node) {
    if (node.inputs[0] != value_ || layers_.empty() || layers_.back().has_relu || scaled_output_)
      RefuseNode(node, "does not stand behind a layer");
    layers_.back().has_relu = true;
  }

  void ScaleInput(const OnnxNode& node, const OnnxTensor& operand) {
    const auto inputs = static_cast<std::size_t>(design_.inputs());
    if (operand.values.size() != inputs)
      RefuseNode(node, fmt::format("has {} values for {} inputs", operand.values.size(), inputs));
    if (node.op == "Sub" && !shifted_input_ && !scaled_input_) {
      scaling_.input_mean.assign(operand.values.begin(), operand.values.end());
      shifted_input_ = true;
      return;
    }
    if ((node.op != "Div" && node.op != "Mul") || scaled_input_) RefuseNode(node, "does not belong here");
    for (std::size_t i = 0; i < inputs; ++i) {
      const double value = operand.values[i];
      if (!std::isfinite(value) || value < 0.0 || (value == 0.0 && node.op == "Div"))
        RefuseNode(node, fmt::format("scales an input by {}", value));
      scaling_.input_sd[i] = node.op == "Div" ? value : (value == 0.0 ? 0.0 : 1.0 / value);
    }
    scaled_input_ = true;
  }

  void ShiftOutput(const OnnxNode& node, const OnnxTensor& operand) {
    Layer& layer = layers_.back();
    if (node.op == "Add" && !layer.has_bias && !layer.has_relu && !scaled_output_) {
      SetBias(node, operand);
      return;
    }
    if (layer.outputs != 1 || layer.has_relu || operand.values.size() != 1 || shifted_output_)
      RefuseNode(node, "does not belong here");
    const double value = operand.values.front();
    if (node.op == "Mul" && !scaled_output_ && value > 0.0 && std::isfinite(value)) {
      scaling_.target_sd = value;
      scaled_output_ = true;
    } else if (node.op == "Add" && std::isfinite(value)) {
      scaling_.target_mean = value;
      scaled_output_ = shifted_output_ = true;
    } else {
      RefuseNode(node, fmt::format("{} of the output by {}", node.op, value));
    }
  }

  const OnnxGraph& graph_;
  const std::string& name_;
  const NetworkDesign& design_;
  std::string value_;  // what the next node goes on from
  std::vector<Layer> layers_;
  Scaling scaling_;
  bool shifted_input_ = false, scaled_input_ = false, scaled_output_ = false, shifted_output_ = false;
};

std::string ScalingText(const Scaling& scaling) {
  return fmt::format("{} {} {} {}", fmt::join(scaling.input_mean, " "), fmt::join(scaling.input_sd, " "),
                     scaling.target_mean, scaling.target_sd);
}

float Inverse(double sd) { return sd == 0.0 ? 0.0F : static_cast<float>(1.0 / sd); }

// The scaling in double precision that an export keeps beside the tensors; none where the file has none.
std::optional<Scaling> KeptScaling(const OnnxGraph& graph, const Scaling& seen, const std::string& name) {
  const auto found = graph.metadata.find(kScalingKey);
  if (found == graph.metadata.end()) return std::nullopt;
  std::vector<double> values;
  const char* at = found->second.data();
  const char* const end = at + found->second.size();
  while (at != end) {
    double value = 0;
    const auto [next, error] = std::from_chars(at, end, value);
    if (error != std::errc()) break;
    values.push_back(value);
    at = next != end && *next == ' ' ? next + 1 : next;
  }
  const std::size_t n = seen.input_mean.size();
  bool fits = at == end && values.size() == 2 * n + 2;
  Scaling kept;
  if (fits) {
    kept.input_mean.assign(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(n));
    kept.input_sd.assign(values.begin() + static_cast<std::ptrdiff_t>(n),
                         values.begin() + static_cast<std::ptrdiff_t>(2 * n));
    kept.target_mean = values[2 * n];
    kept.target_sd = values[2 * n + 1];
    for (std::size_t i = 0; i < n; ++i)
      fits = fits && static_cast<float>(kept.input_mean[i]) == static_cast<float>(seen.input_mean[i]) &&
             Inverse(kept.input_sd[i]) == Inverse(seen.input_sd[i]) && kept.input_sd[i] >= 0.0;
    fits = fits && static_cast<float>(kept.target_mean) == static_cast<float>(seen.target_mean) &&
           static_cast<float>(kept.target_sd) == static_cast<float>(seen.target_sd) && kept.target_sd > 0.0;
  }
  if (!fits)
    throw UserError(
        fmt::format("{}: its metadata '{}' do not fit its tensors; export it again, or take them out", name,
                    kScalingKey));
  return kept;
}

}  // namespace

std::shared_ptr<const OnnxNetwork> OnnxNetwork::Parse(std::string_view bytes, const std::string& name,
                                                      const NetworkDesign& design) {
  const OnnxGraph graph = ParseOnnxGraph(bytes, name);
  Chain chain(graph, name, design);
  chain.Walk();
  std::shared_ptr<OnnxNetwork> network(new OnnxNetwork());
  network->hidden_ = chain.Hidden();
  ModelData data;
  data.weights = chain.Weights();
  data.scaling = chain.scaling();
  if (const std::optional<Scaling> kept = KeptScaling(graph, chain.scaling(), name)) data.scaling = *kept;
  const NetworkDesign own{design.name, design.features, design.states, network->hidden_};
  network->model_ = std::make_unique<const Model>(own, std::move(data));
  Sha256 sha;
  sha.Update(bytes);
  network->sha256_ = sha.Hex();
  return network;
}

std::shared_ptr<const OnnxNetwork> OnnxNetwork::Read(const std::string& path, const std::string& key,
                                                     const NetworkDesign& design) {
  return Parse(ReadFile(path, kMostBytes), fmt::format("{}: {}", key, path), design);
}

std::string OnnxBytes(const Model& model) {
  const Scaling& scaling = model.data().scaling;
  const DenseShape shape = ShapeOf(model.design());
  OnnxGraph graph;
  graph.inputs = {"state_and_action"};
  graph.outputs = {"reward"};
  graph.metadata[kScalingKey] = ScalingText(scaling);
  graph.metadata["ed3r.features"] = fmt::format("{}", fmt::join(model.design().features, " "));
  std::string value = graph.inputs.front();
  const auto add = [&](const std::string& op, const std::string& name, std::vector<std::string> operands) {
    operands.insert(operands.begin(), value);
    value = name + "_out";
    graph.nodes.push_back({op, name, std::move(operands), {value}, {}});
  };
  const auto width = static_cast<std::int64_t>(shape.inputs());
  graph.tensors["mean"] = {{width}, {scaling.input_mean.begin(), scaling.input_mean.end()}};
  std::vector<float> inverse(scaling.input_sd.size());
  std::transform(scaling.input_sd.begin(), scaling.input_sd.end(), inverse.begin(), Inverse);
  graph.tensors["inverse_sd"] = {{width}, std::move(inverse)};
  add("Sub", "centre", {"mean"});
  add("Mul", "scale", {"inverse_sd"});
  const float* flat = model.data().weights.data();
  for (int layer = 0; layer < shape.layers; ++layer) {
    const int inputs = shape.sizes[layer], outputs = shape.sizes[layer + 1];
    const std::string w = fmt::format("weights_{}", layer), b = fmt::format("biases_{}", layer);
    graph.tensors[w] = {{outputs, inputs}, {flat, flat + inputs * outputs}};
    flat += inputs * outputs;
    graph.tensors[b] = {{outputs}, {flat, flat + outputs}};
    flat += outputs;
    add("Gemm", fmt::format("layer_{}", layer), {w, b});
    graph.nodes.back().numbers["transB"] = 1;
    if (layer + 1 < shape.layers) add("Relu", fmt::format("relu_{}", layer), {});
  }
  graph.tensors["reward_sd"] = {{1}, {static_cast<float>(scaling.target_sd)}};
  graph.tensors["reward_mean"] = {{1}, {static_cast<float>(scaling.target_mean)}};
  add("Mul", "unscale", {"reward_sd"});
  add("Add", "uncentre", {"reward_mean"});
  graph.nodes.back().outputs = graph.outputs;
  return OnnxGraphBytes(graph, shape.inputs(), std::string(model.design().name));
}

}  // namespace ed3r
