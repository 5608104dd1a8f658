// The wire format of protocol buffers, as far as ONNX files need it: what the readers of policies (engine/rfnn) and of
// detectors (engine/perception/vision) walk.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

namespace ed3r {

struct ProtobufField {
  enum class Wire { kNumber, kFixed64, kBytes, kFixed32 };

  std::uint32_t number = 0;
  Wire wire = Wire::kNumber;
  std::uint64_t value = 0;  // of a number
  std::string_view bytes;   // of anything else; inside the message
  std::string_view whole;   // with its key, as it stands in the message

  bool IsBytes() const { return wire == Wire::kBytes; }
};

// Calls visit for every field of a message, in order. Throws UserError that begins with `name` where the message does not
// end as it should.
void ForEachField(std::string_view message, const std::string& name,
                  const std::function<void(const ProtobufField&)>& visit);

// Takes one number off the front.
std::uint64_t TakeVarint(std::string_view& bytes, const std::string& name);

class ProtobufWriter {
 public:
  ProtobufWriter& Number(std::uint32_t field, std::uint64_t value);
  ProtobufWriter& Float(std::uint32_t field, float value);
  ProtobufWriter& Bytes(std::uint32_t field, std::string_view value);  // texts and messages
  ProtobufWriter& Copy(const ProtobufField& field);                    // as it was read

  const std::string& bytes() const { return bytes_; }

 private:
  void Varint(std::uint64_t value);

  std::string bytes_;
};

}  // namespace ed3r
