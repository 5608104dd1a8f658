#include "engine/core/files/sealed_file.h"

#include <fmt/format.h>

#include <bit>

#include "engine/core/check.h"
#include "engine/core/files/file.h"
#include "engine/core/sha256.h"

namespace ed3r {
namespace {

constexpr std::size_t kMagicBytes = 8;
constexpr std::size_t kHeaderBytes = kMagicBytes + 4 + 8;
constexpr std::size_t kDigestBytes = 64;  // hexadecimal

template <class Unsigned>
void Append(std::string& bytes, Unsigned value) {
  for (std::size_t i = 0; i < sizeof(Unsigned); ++i)
    bytes.push_back(static_cast<char>(value >> (8 * i) & 0xff));
}

template <class Unsigned>
Unsigned Parse(std::string_view bytes) {
  Unsigned value = 0;
  for (std::size_t i = 0; i < sizeof(Unsigned); ++i)
    value |= static_cast<Unsigned>(static_cast<unsigned char>(bytes[i])) << (8 * i);
  return value;
}

std::string Digest(std::string_view bytes) {
  Sha256 hash;
  hash.Update(bytes);
  return hash.Hex();
}

}  // namespace

void ByteWriter::U32(std::uint32_t value) { Append(bytes_, value); }
void ByteWriter::U64(std::uint64_t value) { Append(bytes_, value); }
void ByteWriter::F64(double value) { Append(bytes_, std::bit_cast<std::uint64_t>(value)); }

void ByteWriter::Text(std::string_view text) {
  U64(text.size());
  bytes_ += text;
}

void ByteWriter::F32s(std::span<const float> values) {
  U64(values.size());
  for (const float value : values) Append(bytes_, std::bit_cast<std::uint32_t>(value));
}

void ByteWriter::F64s(std::span<const double> values) {
  U64(values.size());
  for (const double value : values) F64(value);
}

void ByteReader::Refuse(const std::string& why) const {
  throw UserError(fmt::format("{}: this {} {}", path_, format_.what, why));
}

std::string_view ByteReader::Take(std::size_t size) {
  if (size > bytes_.size()) Refuse("is damaged: it ends too early");
  const std::string_view taken = bytes_.substr(0, size);
  bytes_.remove_prefix(size);
  return taken;
}

std::size_t ByteReader::Count(std::size_t value_bytes) {
  const std::uint64_t count = U64();
  if (count > bytes_.size() / value_bytes) Refuse("is damaged: it ends too early");
  return count;
}

std::uint32_t ByteReader::U32() { return Parse<std::uint32_t>(Take(4)); }
std::uint64_t ByteReader::U64() { return Parse<std::uint64_t>(Take(8)); }
double ByteReader::F64() { return std::bit_cast<double>(U64()); }
std::string ByteReader::Text() { return std::string(Take(Count(1))); }

std::vector<float> ByteReader::F32s() {
  std::vector<float> values(Count(4));
  for (float& value : values) value = std::bit_cast<float>(U32());
  return values;
}

std::vector<double> ByteReader::F64s() {
  std::vector<double> values(Count(8));
  for (double& value : values) value = F64();
  return values;
}

void ByteReader::End() const {
  if (!bytes_.empty()) Refuse("is damaged: it holds more than it should");
}

std::string Sealed(const SealedFormat& format, std::string_view payload) {
  ED3R_CHECK(format.magic.size() == kMagicBytes, std::string(format.magic));
  std::string bytes(format.magic);
  Append(bytes, format.version);
  Append(bytes, static_cast<std::uint64_t>(payload.size()));
  bytes += payload;
  bytes += Digest(bytes);
  return bytes;
}

void WriteSealedFile(const std::string& path, const SealedFormat& format, std::string_view payload) {
  WriteFile(path, Sealed(format, payload));
}

std::string OpenSealed(std::string_view all, const std::string& name, const SealedFormat& format) {
  const auto refuse = [&](const std::string& why) { throw UserError(fmt::format("{}: {}", name, why)); };
  if (all.size() < kMagicBytes || all.substr(0, kMagicBytes) != format.magic)
    refuse(fmt::format("is not a {}", format.what));
  if (all.size() < kHeaderBytes + kDigestBytes)
    refuse(fmt::format("this {} is damaged: it is cut short at {} bytes", format.what, all.size()));
  const auto version = Parse<std::uint32_t>(all.substr(kMagicBytes));
  if (version != format.version)
    refuse(fmt::format("this {} has format version {}; this program reads version {}", format.what, version,
                       format.version));
  const std::uint64_t size = all.size() - kHeaderBytes - kDigestBytes;
  const auto told = Parse<std::uint64_t>(all.substr(kMagicBytes + 4));
  if (told != size)
    refuse(fmt::format("this {} is damaged: it has {} bytes of payload and tells of {}", format.what, size,
                       told));
  const std::string_view sealed = all.substr(0, kHeaderBytes + size);
  if (Digest(sealed) != all.substr(sealed.size()))
    refuse(fmt::format("this {} is damaged: its SHA-256 does not match its content", format.what));
  return std::string(all.substr(kHeaderBytes, size));
}

std::string ReadSealedFile(const std::string& path, const SealedFormat& format) {
  std::string bytes, why;
  if (!TryReadFile(path, kMaxModelBytes, bytes, why))
    throw UserError(fmt::format("{}: cannot read this {}: {}", path, format.what, why));
  return OpenSealed(bytes, path, format);
}

}  // namespace ed3r
