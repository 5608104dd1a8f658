#include "engine/core/sealed_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <bit>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "engine/core/check.h"
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

[[noreturn]] void FailToWrite(const std::string& path, int error) {
  throw UserError(fmt::format("{}: cannot write: {}", path, std::strerror(error)));
}

// Flushes to disk before closing; 0 or the error.
int WriteAndSync(int file, std::string_view bytes) {
  int error = 0;
  while (!bytes.empty() && error == 0) {
    const ssize_t written = ::write(file, bytes.data(), bytes.size());
    if (written >= 0)
      bytes.remove_prefix(static_cast<std::size_t>(written));
    else if (errno != EINTR)
      error = errno;
  }
  if (error == 0 && ::fsync(file) != 0) error = errno;
  if (::close(file) != 0 && error == 0) error = errno;
  return error;
}

// A new file beside `path`, not shared with another process or thread that writes the same place.
int OpenTemporary(const std::string& path, std::string& temporary) {
  for (int attempt = 0;; ++attempt) {
    temporary = fmt::format("{}.{}-{}.tmp", path, ::getpid(), attempt);
    const int file = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (file >= 0) return file;
    if (errno != EEXIST || attempt == 1000) FailToWrite(path, errno);
  }
}

// The new name itself must survive a crash. A file system that cannot sync a directory is no reason to fail.
void SyncDirectoryOf(const std::string& path) {
  const std::filesystem::path parent = std::filesystem::path(path).parent_path();
  const int directory = ::open(parent.empty() ? "." : parent.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (directory < 0) return;
  ::fsync(directory);
  ::close(directory);
}

std::string ReadWholeFile(const std::string& path, const SealedFormat& format) {
  const auto fail = [&](int error) {
    throw UserError(fmt::format("{}: cannot read this {}: {}", path, format.what, std::strerror(error)));
  };
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) fail(errno);
  std::string bytes;
  std::array<char, 65536> block;
  int error = 0;
  for (ssize_t size = 1; size != 0 && error == 0;) {
    size = ::read(file, block.data(), block.size());
    if (size > 0)
      bytes.append(block.data(), static_cast<std::size_t>(size));
    else if (size < 0 && errno != EINTR)
      error = errno;
  }
  ::close(file);
  if (error != 0) fail(error);
  return bytes;
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
  const std::string bytes = Sealed(format, payload);
  std::string temporary;
  const int file = OpenTemporary(path, temporary);
  int error = WriteAndSync(file, bytes);
  if (error == 0 && ::rename(temporary.c_str(), path.c_str()) != 0) error = errno;
  if (error != 0) {
    ::unlink(temporary.c_str());
    FailToWrite(path, error);
  }
  SyncDirectoryOf(path);
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
  return OpenSealed(ReadWholeFile(path, format), path, format);
}

}  // namespace ed3r
