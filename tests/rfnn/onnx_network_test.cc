// Networks of the user's own: what comes back of an export, what other tools write, what is refused.
#include "engine/rfnn/onnx_network.h"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/core/check.h"
#include "engine/core/random.h"
#include "engine/rfnn/model_file.h"
#include "engine/rfnn/onnx_graph.h"

namespace ed3r::rfnn {
namespace {

Model RandomModel(const NetworkDesign& design) {
  ModelData data;
  data.weights.resize(kernels::ParameterCount(ShapeOf(design)));
  Stream stream(9, 0, Purpose::kTraining);
  for (float& weight : data.weights) weight = static_cast<float>(0.2 * stream.Normal());
  for (int i = 0; i < design.inputs(); ++i) {
    data.scaling.input_mean.push_back(stream.Normal() * 1e3);
    data.scaling.input_sd.push_back(i == 3 ? 0.0 : 0.1 + stream.Uniform());
  }
  data.scaling.target_mean = -2.3456789012345;
  data.scaling.target_sd = 0.123456789012345;
  return Model(design, data);
}

// A graph of a tool that writes MatMul and Add and leaves the scales out: y = w2 relu(w1 x + b1).
OnnxGraph SmallGraph() {
  OnnxGraph graph;
  graph.inputs = {"x"};
  graph.outputs = {"y"};
  OnnxTensor w1{{13, 2}, std::vector<float>(26, 0.0F)};
  w1.values[0] = 1.0F;           // neuron 0: feature 0
  w1.values[2 * 8 + 1] = -2.0F;  // neuron 1: -2 x feature 8
  graph.tensors = {{"w1", w1}, {"b1", {{2}, {0.5F, 0.0F}}}, {"w2", {{2, 1}, {1.0F, 10.0F}}}};
  graph.nodes = {{"MatMul", "m1", {"x", "w1"}, {"h"}, {}},
                 {"Add", "a1", {"b1", "h"}, {"hb"}, {}},
                 {"Relu", "r1", {"hb"}, {"hr"}, {}},
                 {"MatMul", "m2", {"hr", "w2"}, {"y"}, {}}};
  return graph;
}

std::string BytesOf(const OnnxGraph& graph) { return OnnxGraphBytes(graph, 13, "test"); }

std::string RefusalOf(const std::string& bytes) {
  try {
    OnnxNetwork::Parse(bytes, "networks.rc: mine.onnx", kRcNetwork);
  } catch (const UserError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(OnnxNetworkTest, AnExportComesBackBitForBit) {
  for (const NetworkDesign* design : {&kRcNetwork, &kRobotNetwork}) {
    const Model model = RandomModel(*design);
    const auto back = OnnxNetwork::Parse(OnnxBytes(model), "export", *design);
    EXPECT_EQ(back->scores()->data().weights, model.data().weights);
    EXPECT_EQ(NetworkHash(*back->scores()), NetworkHash(model));
    EXPECT_EQ(OnnxBytes(*back->scores()), OnnxBytes(model));
  }
}

TEST(OnnxNetworkTest, WithoutTheMetadataItDiffersByRoundingAlone) {
  const Model model = RandomModel(kRcNetwork);
  OnnxGraph graph = ParseOnnxGraph(OnnxBytes(model), "export");
  graph.metadata.clear();
  const auto back = OnnxNetwork::Parse(BytesOf(graph), "export", kRcNetwork);
  Model::Workspace workspace;
  const std::vector<double> state(8, 900.0);
  const std::vector<float> action(5, 800.0F);
  EXPECT_NEAR(back->scores()->Predict(state, action, workspace), model.Predict(state, action, workspace),
              1e-2);
}

TEST(OnnxNetworkTest, MatMulAndAddAreALayer) {
  const auto network = OnnxNetwork::Parse(BytesOf(SmallGraph()), "small", kRcNetwork);
  Model::Workspace workspace;
  std::vector<double> state(8, 0.0);
  state[0] = 3.0;
  EXPECT_EQ(network->scores()->Predict(state, std::vector<float>{-1, 0, 0, 0, 0}, workspace), 3.5 + 20.0);
  EXPECT_EQ(network->scores()->Predict(state, std::vector<float>{+1, 0, 0, 0, 0}, workspace), 3.5);
}

TEST(OnnxNetworkTest, WhatDoesNotFitIsRefusedByName) {
  OnnxGraph graph = SmallGraph();
  graph.nodes[2].op = "Tanh";
  EXPECT_NE(
      RefusalOf(BytesOf(graph)).find("networks.rc: mine.onnx: node 'r1' (Tanh): is not understood here"),
      std::string::npos);
  graph = SmallGraph();
  graph.tensors["w2"] = {{2, 2}, {1, 2, 3, 4}};
  EXPECT_NE(RefusalOf(BytesOf(graph)).find("gives 2 values; allowed: one"), std::string::npos);
  graph = SmallGraph();
  graph.tensors["w1"] = {{12, 2}, std::vector<float>(24)};
  EXPECT_NE(
      RefusalOf(BytesOf(graph)).find("takes 12 values; allowed: 13 (it scores an action) or 8 (it decides)"),
      std::string::npos);
  graph = SmallGraph();
  graph.nodes.erase(graph.nodes.begin() + 2);
  graph.nodes[2].inputs[0] = "hb";
  EXPECT_NE(RefusalOf(BytesOf(graph)).find("no Relu stands between two layers"), std::string::npos);
  graph = SmallGraph();
  graph.tensors["b1"].values[0] = NAN;
  EXPECT_NE(RefusalOf(BytesOf(graph)).find("not finite"), std::string::npos);
  graph = SmallGraph();
  graph.tensors["b1"].values.push_back(1);
  EXPECT_NE(RefusalOf(BytesOf(graph)).find("tensor 'b1' has 3 values, and its shape tells 2"),
            std::string::npos);
  graph = SmallGraph();
  graph.metadata["ed3r.scaling"] = "1 2 3";
  EXPECT_NE(RefusalOf(BytesOf(graph)).find("do not fit its tensors"), std::string::npos);
  graph.metadata.clear();
  std::string features(kRcNetwork.features[0]);
  for (const std::string_view feature : kRcNetwork.features.subspan(1)) features.append(" ").append(feature);
  for (const std::string& other : {features + " more", "g" + features, std::string()}) {
    graph.metadata["ed3r.features"] = other;
    EXPECT_EQ(RefusalOf(BytesOf(graph)), "networks.rc: mine.onnx: its metadata 'ed3r.features' are '" +
                                             other + "'; allowed: '" + features +
                                             "', or none where they are wrong");
  }
  graph.metadata["ed3r.features"] = features;
  EXPECT_EQ(
      OnnxNetwork::Parse(BytesOf(graph), "named", kRcNetwork)->scores()->data().scaling.target_sd,
      OnnxNetwork::Parse(BytesOf(SmallGraph()), "unnamed", kRcNetwork)->scores()->data().scaling.target_sd);
  EXPECT_NE(RefusalOf("not a network").find("is no ONNX model"), std::string::npos);
}

// h = relu(x w1 + b1), y = h w2 + b2, of 8 inputs and 5 values.
DenseChain SmallDecision() {
  OnnxTensor w1{{8, 2}, std::vector<float>(16, 0.0F)};
  w1.values[2 * 6] = 2.0F;       // neuron 0: 2 x the previous score
  w1.values[2 * 3 + 1] = -1.0F;  // neuron 1: -yaw
  const OnnxTensor w2{{2, 5}, {1, 2, 3, 4, 5, 10, 0, 0, 0, 0}};
  return {{}, {}, {w1, w2}, {{{2}, {0.0F, 0.5F}}, {{5}, {0, 0, 0, -1, 0.25F}}}};
}

std::vector<double> DecisionOf(const OnnxNetwork& network, double yaw_rad, double previous_scs) {
  Model::Workspace workspace;
  std::vector<double> values(network.direct()->values());
  std::vector<double> state(8, 0.0);
  state[kRcYaw] = yaw_rad;
  state[kRcPreviousScs] = previous_scs;
  network.direct()->Decide(state, values, workspace);
  return values;
}

TEST(OnnxNetworkTest, EightInputsDecide) {
  const auto network = OnnxNetwork::Parse(OnnxBytes(SmallDecision(), "mine", kRcNetwork), "mine", kRcNetwork);
  ASSERT_EQ(network->scores(), nullptr);
  EXPECT_EQ(DecisionOf(*network, 0.25, 0.5), (std::vector<double>{1 + 2.5, 2, 3, 4 - 1, 5.25}));
  EXPECT_EQ(DecisionOf(*network, 1.0, 0.0),
            (std::vector<double>{0, 0, 0, -1, 0.25}));  // both neurons at rest
}

TEST(OnnxNetworkTest, TheInputsOfADecisionAreScaled) {
  DenseChain chain = SmallDecision();
  chain.mean.assign(8, 0.25F);
  chain.inverse_sd.assign(8, 2.0F);
  const auto network = OnnxNetwork::Parse(OnnxBytes(chain, "mine", kRcNetwork), "mine", kRcNetwork);
  EXPECT_EQ(DecisionOf(*network, 0.25, 0.5), (std::vector<double>{1 + 5.0, 2, 3, 4 - 1, 5.25}));
}

TEST(OnnxNetworkTest, TheValuesOfADecisionAreScaled) {
  OnnxGraph graph = ParseOnnxGraph(OnnxBytes(SmallDecision(), "mine", kRcNetwork), "mine");
  graph.metadata.clear();  // of what is changed on purpose
  graph.tensors["times"] = {{5}, {1, -1, 1, 1, 2}};
  graph.tensors["plus"] = {{5}, {0, 0, 100, 0, 1}};
  graph.nodes.push_back({"Mul", "times", {"decision", "times"}, {"t"}, {}});
  graph.nodes.push_back({"Add", "plus", {"t", "plus"}, {"p"}, {}});
  graph.outputs = {"p"};
  const auto network = OnnxNetwork::Parse(OnnxGraphBytes(graph, 8, "test", 5), "mine", kRcNetwork);
  EXPECT_EQ(DecisionOf(*network, 0.25, 0.5), (std::vector<double>{3.5, -2, 103, 3, 11.5}));
  graph.tensors["times"] = {{1}, {2}};
  EXPECT_NE(RefusalOf(OnnxGraphBytes(graph, 8, "test", 5)).find("has 1 values for 5 outputs"),
            std::string::npos);
}

TEST(OnnxNetworkTest, ADecisionOfTheWrongWidthIsRefused) {
  const auto refusal = [](const DenseChain& chain, const NetworkDesign& design) -> std::string {
    try {
      OnnxBytes(chain, "mine.onnx", design);
    } catch (const UserError& error) {
      return error.what();
    }
    return "accepted";
  };
  DenseChain chain = SmallDecision();
  EXPECT_EQ(refusal(chain, kRcNetwork), "accepted");
  EXPECT_EQ(refusal(chain, kRobotNetwork),
            "mine.onnx: takes 8 values; allowed: 11 (it scores an action) or 9 (it decides)");
  chain.weights[1] = {{2, 4}, std::vector<float>(8)};
  chain.biases[1] = {{4}, std::vector<float>(4)};
  EXPECT_EQ(refusal(chain, kRcNetwork), "mine.onnx: gives 4 values of 8; allowed: 5, its decision");
  chain.biases.pop_back();
  EXPECT_EQ(refusal(chain, kRcNetwork),
            "mine.onnx: has 2 layers of weights and 1 of biases; allowed: as many of each, 1 or more");
}

TEST(OnnxNetworkTest, ATurnedBitIsRefusedOrChangesNothing) {
  const DenseChain chain = SmallDecision();
  const std::string whole = OnnxBytes(chain, "mine", kRcNetwork);
  const std::vector<double> decision = DecisionOf(*OnnxNetwork::Parse(whole, "mine", kRcNetwork), 0.25, 0.5);
  int refused = 0, of_seal = 0;
  for (std::size_t bit = 0; bit < whole.size() * 8; ++bit) {
    std::string turned = whole;
    turned[bit / 8] = static_cast<char>(turned[bit / 8] ^ (1 << bit % 8));
    const std::string refusal = RefusalOf(turned);
    refused += refusal != "accepted";
    of_seal += refusal.find("does not match its metadata 'ed3r.sha256'") != std::string::npos;
    if (refusal == "accepted") {
      EXPECT_EQ(DecisionOf(*OnnxNetwork::Parse(turned, "turned", kRcNetwork), 0.25, 0.5), decision) << bit;
    }
  }
  EXPECT_GT(of_seal, 32 * 16) << "every bit of the weights at least";
  EXPECT_LT(refused, std::ssize(whole) * 8);
}

TEST(OnnxNetworkTest, EveryCutIsRefused) {
  const std::string whole = BytesOf(SmallGraph());
  EXPECT_EQ(RefusalOf(whole), "accepted");
  int accepted = 0;
  for (std::size_t size = 0; size < whole.size(); ++size)
    accepted += RefusalOf(whole.substr(0, size)) == "accepted";
  // What stands behind the graph, the version of the operators, may be missing.
  EXPECT_LE(accepted, 1);
}

}  // namespace
}  // namespace ed3r::rfnn
