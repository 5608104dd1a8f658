#include "engine/rfnn/onnx_network.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "engine/core/check.h"
#include "engine/core/files/file.h"
#include "engine/core/message.h"
#include "engine/core/sha256.h"

namespace ed3r::rfnn {
namespace {

constexpr char kScalingKey[] = "ed3r.scaling";
constexpr char kFeaturesKey[] = "ed3r.features";
constexpr std::uintmax_t kMostBytes = 256U << 20;
constexpr std::int64_t kMostNeurons = 65536;

// outputs x inputs, row-major.
struct Layer {
  int inputs = 0, outputs = 0;
  std::vector<float> weights, biases;
  bool has_bias = false, has_relu = false;
};

std::string FeatureNames(std::span<const std::string_view> features) {
  return fmt::format("{}", fmt::join(features, " "));
}

// Walks the chain of nodes from the input to the output.
class Chain {
 public:
  Chain(const OnnxGraph& graph, const std::string& name, const NetworkDesign& design)
      : graph_(graph), name_(name), design_(design) {}

  void Walk() {
    if (graph_.inputs.size() != 1 || graph_.outputs.size() != 1)
      Refuse(fmt::format("has {} inputs and {} outputs; allowed: one of each", graph_.inputs.size(),
                         graph_.outputs.size()));
    value_ = graph_.inputs.front();
    for (const OnnxNode& node : graph_.nodes) Step(node);
    if (value_ != graph_.outputs.front())
      Refuse(fmt::format("its output '{}' is not the end of its chain of nodes", graph_.outputs.front()));
    if (layers_.empty()) Refuse("has no dense layer; allowed: 1 or more");
    if (Decides() && layers_.back().outputs != design_.decision)
      Refuse(fmt::format("gives {} values of {}; allowed: {}, its decision", layers_.back().outputs, width_,
                         design_.decision));
    if (!Decides() && layers_.back().outputs != 1)
      Refuse(fmt::format("gives {} values; allowed: one, the score of an action", layers_.back().outputs));
    if (layers_.back().has_relu) Refuse("has a Relu behind its last layer");
    if (layers_.size() > kernels::kMaxDenseLayers)
      Refuse(fmt::format("has {} dense layers; allowed: 1 .. {}", layers_.size(), kernels::kMaxDenseLayers));
  }

  std::vector<int> Hidden() const {
    std::vector<int> hidden;
    for (std::size_t i = 0; i + 1 < layers_.size(); ++i) hidden.push_back(layers_[i].outputs);
    return hidden;
  }

  // Of the network of one output.
  std::vector<float> Weights(int output) const {
    std::vector<float> flat;
    for (std::size_t l = 0; l + 1 < layers_.size(); ++l) {
      flat.insert(flat.end(), layers_[l].weights.begin(), layers_[l].weights.end());
      flat.insert(flat.end(), layers_[l].biases.begin(), layers_[l].biases.end());
    }
    const Layer& last = layers_.back();
    const auto row = last.weights.begin() + static_cast<std::ptrdiff_t>(output) * last.inputs;
    flat.insert(flat.end(), row, row + last.inputs);
    flat.push_back(last.biases[static_cast<std::size_t>(output)]);
    if (!std::all_of(flat.begin(), flat.end(), [](float w) { return std::isfinite(w); }))
      Refuse("has a weight that is not finite");
    return flat;
  }

  const Scaling& scaling() const { return scaling_; }
  int width() const { return width_; }
  bool Decides() const { return width_ == design_.states; }

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
      if (layers_.empty())
        ScaleInput(node, operand);
      else if (Decides())
        ShiftDecision(node, operand);
      else
        ShiftOutput(node, operand);
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

  // The first node that tells how many inputs there are tells what the network is for.
  void SetWidth(std::int64_t width) {
    if (width_ != 0) return;
    if (width != design_.inputs() && width != design_.states)
      Refuse(fmt::format("takes {} values; allowed: {} (it scores an action) or {} (it decides)", width,
                         design_.inputs(), design_.states));
    width_ = static_cast<int>(width);
    scaling_.input_mean.assign(static_cast<std::size_t>(width), 0.0);
    scaling_.input_sd.assign(static_cast<std::size_t>(width), 1.0);
  }

  void AddLayer(const OnnxNode& node, const OnnxTensor& weights, bool transposed) {
    if (weights.dims.size() != 2) RefuseNode(node, "its weights have no two dimensions");
    const std::int64_t inputs = weights.dims[transposed ? 1 : 0], outputs = weights.dims[transposed ? 0 : 1];
    SetWidth(inputs);
    const int expected = layers_.empty() ? width_ : layers_.back().outputs;
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
    SetWidth(static_cast<std::int64_t>(operand.values.size()));
    const auto inputs = static_cast<std::size_t>(width_);
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

  // y scale + shift of a decision goes into the last layer.
  void ShiftDecision(const OnnxNode& node, const OnnxTensor& operand) {
    Layer& layer = layers_.back();
    if (node.op == "Add" && !layer.has_bias && !layer.has_relu && !scaled_output_) {
      SetBias(node, operand);
      return;
    }
    const auto outputs = static_cast<std::size_t>(layer.outputs),
               inputs = static_cast<std::size_t>(layer.inputs);
    const bool scales = node.op == "Mul" && !scaled_output_, shifts = node.op == "Add" && !shifted_output_;
    if (layer.has_relu || (!scales && !shifts)) RefuseNode(node, "does not belong here");
    if (operand.values.size() != outputs)
      RefuseNode(node, fmt::format("has {} values for {} outputs", operand.values.size(), outputs));
    for (std::size_t o = 0; o < outputs; ++o) {
      if (shifts) layer.biases[o] += operand.values[o];
      if (!scales) continue;
      layer.biases[o] *= operand.values[o];
      for (std::size_t i = 0; i < inputs; ++i) layer.weights[o * inputs + i] *= operand.values[o];
    }
    scaled_output_ = true;
    shifted_output_ = shifts;
  }

  const OnnxGraph& graph_;
  const std::string& name_;
  const NetworkDesign& design_;
  std::string value_;  // what the next node goes on from
  int width_ = 0;      // inputs; 0: not known yet
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

// A network learnt nothing of inputs other than those that its file names, nor of these in another order.
void CheckFeatures(const OnnxGraph& graph, const std::string& expected, const std::string& name) {
  const auto found = graph.metadata.find(kFeaturesKey);
  if (found == graph.metadata.end() || found->second == expected) return;
  throw UserError(
      OneLine(fmt::format("{}: its metadata '{}' are '{}'; allowed: '{}', or none where they are wrong", name,
                          kFeaturesKey, found->second, expected)));
}

}  // namespace

std::shared_ptr<const OnnxNetwork> OnnxNetwork::Parse(std::string_view bytes, const std::string& name,
                                                      const NetworkDesign& design) {
  const OnnxGraph graph = ParseOnnxGraph(bytes, name);
  CheckOnnxSeal(graph, name);
  Chain chain(graph, name, design);
  chain.Walk();
  CheckFeatures(graph, FeatureNames(design.features.first(static_cast<std::size_t>(chain.width()))), name);
  std::shared_ptr<OnnxNetwork> network(new OnnxNetwork());
  network->hidden_ = chain.Hidden();
  const auto model_of = [&](int output, const Scaling& scaling) {
    const NetworkDesign own{design.name, design.features.first(static_cast<std::size_t>(chain.width())),
                            design.states, network->hidden_};
    ModelData data;
    data.weights = chain.Weights(output);
    data.scaling = scaling;
    return Model(own, std::move(data));
  };
  if (chain.Decides()) {
    std::vector<Model> values;
    for (int output = 0; output < design.decision; ++output)
      values.push_back(model_of(output, chain.scaling()));
    network->direct_ = std::make_unique<const DirectNetwork>(std::move(values));
  } else {
    const std::optional<Scaling> kept = KeptScaling(graph, chain.scaling(), name);
    network->scores_ = std::make_unique<const Model>(model_of(0, kept ? *kept : chain.scaling()));
  }
  Sha256 sha;
  sha.Update(bytes);
  network->sha256_ = sha.Hex();
  return network;
}

std::shared_ptr<const OnnxNetwork> OnnxNetwork::Read(const std::string& path, const std::string& key,
                                                     const NetworkDesign& design) {
  return Parse(ReadFile(path, kMostBytes), fmt::format("{}: {}", key, path), design);
}

namespace {

// A graph that grows node by node behind one input.
class ChainWriter {
 public:
  ChainWriter(const NetworkDesign& design, const std::string& input, const std::string& output)
      : value_(input) {
    graph_.inputs = {input};
    graph_.outputs = {output};
    graph_.metadata[kFeaturesKey] = FeatureNames(design.features);
  }

  void Add(const std::string& op, const std::string& name, std::vector<std::string> operands) {
    operands.insert(operands.begin(), value_);
    value_ = name + "_out";
    graph_.nodes.push_back({op, name, std::move(operands), {value_}, {}});
  }

  // With an operand of one row.
  void Add(const std::string& op, const std::string& name, const std::string& operand,
           std::vector<float> values) {
    graph_.tensors[operand] = {{static_cast<std::int64_t>(values.size())}, std::move(values)};
    Add(op, name, {operand});
  }

  void AddLayer(std::size_t number, OnnxTensor weights, OnnxTensor biases, bool transposed, bool relu) {
    const std::string w = fmt::format("weights_{}", number), b = fmt::format("biases_{}", number);
    graph_.tensors[w] = std::move(weights);
    graph_.tensors[b] = std::move(biases);
    Add("Gemm", fmt::format("layer_{}", number), {w, b});
    graph_.nodes.back().numbers["transB"] = transposed ? 1 : 0;
    if (relu) Add("Relu", fmt::format("relu_{}", number), {});
  }

  std::string Bytes(int inputs, const std::string& name, int outputs) {
    graph_.nodes.back().outputs = graph_.outputs;
    SealOnnx(graph_);
    return OnnxGraphBytes(graph_, inputs, name, outputs);
  }

  OnnxGraph& graph() { return graph_; }

 private:
  OnnxGraph graph_;
  std::string value_;  // what the next node goes on from
};

}  // namespace

std::string OnnxBytes(const Model& model) {
  const Scaling& scaling = model.data().scaling;
  const kernels::DenseShape shape = ShapeOf(model.design());
  ChainWriter writer(model.design(), "state_and_action", "reward");
  writer.graph().metadata[kScalingKey] = ScalingText(scaling);
  std::vector<float> inverse(scaling.input_sd.size());
  std::transform(scaling.input_sd.begin(), scaling.input_sd.end(), inverse.begin(), Inverse);
  writer.Add("Sub", "centre", "mean", {scaling.input_mean.begin(), scaling.input_mean.end()});
  writer.Add("Mul", "scale", "inverse_sd", std::move(inverse));
  const float* flat = model.data().weights.data();
  for (int layer = 0; layer < shape.layers; ++layer) {
    const int inputs = shape.sizes[layer], outputs = shape.sizes[layer + 1];
    OnnxTensor weights{{outputs, inputs}, {flat, flat + inputs * outputs}};
    flat += inputs * outputs;
    OnnxTensor biases{{outputs}, {flat, flat + outputs}};
    flat += outputs;
    writer.AddLayer(static_cast<std::size_t>(layer), std::move(weights), std::move(biases), true,
                    layer + 1 < shape.layers);
  }
  writer.Add("Mul", "unscale", "reward_sd", {static_cast<float>(scaling.target_sd)});
  writer.Add("Add", "uncentre", "reward_mean", {static_cast<float>(scaling.target_mean)});
  return writer.Bytes(shape.inputs(), std::string(model.design().name), 1);
}

std::string OnnxBytes(const DenseChain& chain, const std::string& name, const NetworkDesign& design) {
  const std::size_t layers = chain.weights.size();
  if (layers == 0 || chain.biases.size() != layers)
    throw UserError(
        fmt::format("{}: has {} layers of weights and {} of biases; allowed: as many of each, 1 or more",
                    name, layers, chain.biases.size()));
  for (const OnnxTensor& weights : chain.weights)
    if (weights.dims.size() != 2 || weights.values.empty())
      throw UserError(fmt::format("{}: has weights of {} dimensions; allowed: inputs x outputs", name,
                                  weights.dims.size()));
  const std::int64_t inputs = chain.weights.front().dims[0], outputs = chain.weights.back().dims[1];
  const bool decides = inputs == design.states;
  NetworkDesign seen = design;
  if (decides) seen.features = design.features.first(static_cast<std::size_t>(design.states));
  ChainWriter writer(seen, decides ? "state" : "state_and_action", decides ? "decision" : "score");
  if (!chain.mean.empty()) writer.Add("Sub", "centre", "mean", chain.mean);
  if (!chain.inverse_sd.empty()) writer.Add("Mul", "scale", "inverse_sd", chain.inverse_sd);
  for (std::size_t l = 0; l < layers; ++l)
    writer.AddLayer(l, chain.weights[l], chain.biases[l], false, l + 1 < layers);
  std::string bytes =
      writer.Bytes(static_cast<int>(inputs), std::string(design.name), static_cast<int>(outputs));
  OnnxNetwork::Parse(bytes, name, design);
  return bytes;
}

}  // namespace ed3r::rfnn
