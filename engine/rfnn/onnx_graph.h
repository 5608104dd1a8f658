// An ONNX file as far as dense networks need it: nodes in order, float tensors, the names of input and output.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace ed3r::rfnn {

struct OnnxTensor {
  std::vector<std::int64_t> dims;
  std::vector<float> values;
};

struct OnnxNode {
  std::string op;
  std::string name;
  std::vector<std::string> inputs, outputs;
  std::map<std::string, double> numbers;  // attributes that are one number

  double Number(const std::string& attribute, double otherwise) const {
    const auto found = numbers.find(attribute);
    return found == numbers.end() ? otherwise : found->second;
  }
};

struct OnnxGraph {
  std::vector<OnnxNode> nodes;
  std::map<std::string, OnnxTensor> tensors;  // initializers
  std::vector<std::string> inputs, outputs;   // inputs without the initializers among them
  std::map<std::string, std::string> metadata;
};

// Throws UserError that begins with `name`: no ONNX file, tensors that are no floats or not as long as they say.
OnnxGraph ParseOnnxGraph(std::string_view bytes, const std::string& name);

// Files that this program writes have a hash of all that a network computes by in their metadata, "ed3r.sha256".
void SealOnnx(OnnxGraph& graph);
// UserError where a graph has such a hash and it is another one: a bit has turned, or it was changed since.
void CheckOnnxSeal(const OnnxGraph& graph, const std::string& name);

// `features` and `outputs`: widths of the input and of the output.
std::string OnnxGraphBytes(const OnnxGraph& graph, int features, const std::string& graph_name,
                           int outputs = 1);

}  // namespace ed3r::rfnn
