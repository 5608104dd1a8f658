// What a detector's ONNX file declares: its inputs, outputs and nodes.
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace ed3r::perception {

struct OnnxDim {
  std::int64_t size = 0;  // 0: told by what it is fed with
  std::string name;       // of such a one; may be empty
};

// An input, an output or a value between.
struct OnnxValue {
  std::string name;
  std::uint64_t type = 0;  // of its elements; 0 for what is no tensor
  bool has_shape = false;
  std::vector<OnnxDim> dims;

  std::string ShapeText() const;  // "[batch, 3, 54, 96]"; "?" where nothing is told
};

struct OnnxStep {
  std::string op, domain, name;
  std::vector<std::string> inputs, outputs;
  bool has_graphs = false;  // within it, as If and Loop have

  std::string Text() const;  // "Conv (node 'conv1')", "com.mine.Op"
};

struct OnnxOutline {
  std::vector<OnnxValue> inputs;  // without the weights among them
  std::vector<OnnxValue> outputs;
  std::vector<OnnxStep> steps;
  std::set<std::string> weights;
};

// `bytes` have passed CheckOnnx. Throws UserError that begins with `name` all the same for bytes that do not nest.
OnnxOutline OutlineOf(std::string_view bytes, const std::string& name);

// One value's message.
OnnxValue ParseOnnxValue(std::string_view bytes, const std::string& name);

}  // namespace ed3r::perception
