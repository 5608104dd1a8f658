// Small binary files that are whole or refused: magic, version, payload, SHA-256 over all of it.
//
// Numbers are little-endian whatever the CPU. Written and read as file.h says: a reader sees the old file or the new
// one, also after a crash.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace ed3r {

// A kind of file. `what` stands in messages: "model file", "training checkpoint".
struct SealedFormat {
  std::string_view magic;  // 8 bytes
  std::uint32_t version = 1;
  std::string_view what;
};

class ByteWriter {
 public:
  void U32(std::uint32_t value);
  void U64(std::uint64_t value);
  void F64(double value);
  void Text(std::string_view text);
  void F32s(std::span<const float> values);
  void F64s(std::span<const double> values);

  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

// Reads what ByteWriter wrote, in the same order. Throws UserError that names the file where the payload ends
// too early or a length cannot be true; nothing large is allocated before its length is checked.
class ByteReader {
 public:
  // `path` and `format` are for messages; all must outlive the reader.
  ByteReader(std::string_view bytes, const std::string& path, const SealedFormat& format)
      : bytes_(bytes), path_(path), format_(format) {}

  std::uint32_t U32();
  std::uint64_t U64();
  double F64();
  std::string Text();
  std::vector<float> F32s();
  std::vector<double> F64s();
  void End() const;  // nothing may be left

  [[noreturn]] void Refuse(const std::string& why) const;

 private:
  std::string_view Take(std::size_t size);
  std::size_t Count(std::size_t value_bytes);

  std::string_view bytes_;
  const std::string& path_;
  const SealedFormat& format_;
};

// The whole of such a file: OpenSealed gives the payload back.
std::string Sealed(const SealedFormat& format, std::string_view payload);

// Throws UserError where the disk refuses.
void WriteSealedFile(const std::string& path, const SealedFormat& format, std::string_view payload);

// The payload. Throws UserError, one line with the path, for a file that is missing, of another kind or
// version, cut short, longer than it says, or damaged.
std::string ReadSealedFile(const std::string& path, const SealedFormat& format);

// The same for a sealed file that is in memory already, e.g. compiled into the program; `name` stands in messages.
std::string OpenSealed(std::string_view bytes, const std::string& name, const SealedFormat& format);

}  // namespace ed3r
