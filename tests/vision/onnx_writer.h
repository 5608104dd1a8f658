// ONNX models as other tools write them, put together in a test.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace ed3r::test {

struct OnnxAttribute {
  std::string name;
  std::variant<std::int64_t, float, std::vector<std::int64_t>, std::string> value;
};

inline constexpr std::int64_t kOpen = -1;          // a side that is told when the model runs
inline constexpr std::int64_t kOpenAsNumber = -2;  // the same as tf2onnx writes it: -1
inline constexpr int kFloat = 1, kUint8 = 2, kInt64 = 7, kFloat16 = 10, kBfloat16 = 16;

class OnnxWriter {
 public:
  OnnxWriter& Input(const std::string& name, const std::vector<std::int64_t>& dims, int type = kFloat);
  OnnxWriter& Output(const std::string& name, const std::vector<std::int64_t>& dims, int type = kFloat);
  OnnxWriter& Weights(const std::string& name, const std::vector<std::int64_t>& dims,
                      const std::vector<float>& values);
  OnnxWriter& Halves(const std::string& name, const std::vector<std::int64_t>& dims,
                     const std::vector<float>& values, bool raw = true);
  OnnxWriter& Integers(const std::string& name, const std::vector<std::int64_t>& values);
  // Of floats that lie in another file.
  OnnxWriter& Outside(const std::string& name, const std::vector<std::int64_t>& dims, const std::string& file,
                      const std::string& offset, const std::string& length);
  OnnxWriter& Step(const std::string& op, const std::vector<std::string>& inputs,
                   const std::vector<std::string>& outputs, const std::vector<OnnxAttribute>& attributes = {},
                   const std::string& domain = "");
  OnnxWriter& Producer(const std::string& name);
  OnnxWriter& Opset(std::uint64_t version);

  std::string Bytes() const;

 private:
  std::string steps_, weights_, inputs_, outputs_, producer_ = "test";
  std::uint64_t opset_ = 11;
};

// Half precision, exact for the values of the tests.
std::uint16_t HalfBits(float value);

// The mean of the frame's three colours times 4, 0 and -4, plus 0.5, as 'y' [1, 2] beside a constant -0.25: what
// data/red_minus_blue.onnx computes, of `input` [1, 3, height, width], for any size.
OnnxWriter RedMinusBlue(const std::vector<std::int64_t>& input);
// What stands behind its input 'frame', from the value `colours` [1, 3, height, width] on.
void AddRedMinusBlue(OnnxWriter& writer, const std::string& colours);

}  // namespace ed3r::test
