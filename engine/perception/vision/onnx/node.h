// One step of an ONNX model as its file tells it, and what is known of the values around it.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace ed3r::perception {

// What an attribute holds: one of these, or something else.
enum class OnnxHeld { kNothing, kFloat, kInt, kInts, kText, kTensor, kElse };

struct OnnxAttribute {
  OnnxHeld held = OnnxHeld::kNothing;
  double number = 0.0;  // of one number
  std::vector<std::int64_t> numbers;
  std::string text;

  std::vector<std::string> Values() const;  // as text, one or several
};

// Its attributes that are numbers or words.
struct OnnxNode {
  std::string op, domain, name;
  std::vector<std::string> inputs, outputs;
  std::map<std::string, OnnxAttribute> attributes;

  double Number(const std::string& attribute, double otherwise) const;
  std::vector<std::int64_t> Numbers(const std::string& attribute) const;  // empty where it is not given
  std::string Word(const std::string& attribute, const std::string& otherwise) const;
  bool Has(const std::string& attribute) const { return attributes.contains(attribute); }
  bool HasInput(std::size_t i) const { return i < inputs.size() && !inputs[i].empty(); }
  std::string Text() const;  // "Conv (node 'conv1')", "com.mine.Op (node '')"
};

// `bytes` have passed CheckOnnx; `name` stands in messages.
OnnxNode NodeOf(std::string_view bytes, const std::string& name);

struct OnnxConstant {
  std::uint64_t type = 0;
  std::vector<std::int64_t> sides;
  // Of up to 64 elements, else empty.
  std::vector<float> floats;
  std::vector<std::int64_t> whole;
};
OnnxConstant ConstantOf(std::string_view tensor, const std::string& name);

// What the steps stand among.
struct OnnxSurroundings {
  std::int64_t opset = 1;
  std::map<std::string, OnnxConstant> constants;
};

}  // namespace ed3r::perception
