#include "engine/world/files/geo_keys.h"

#include <fmt/format.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <fstream>

namespace ed3r::world {
namespace {

// A TIFF's numbers by their places, in its order of bytes.
class TiffNumbers {
 public:
  explicit TiffNumbers(const std::filesystem::path& path) : file_(path, std::ios::binary) {
    std::array<char, 2> order{};
    file_.read(order.data(), order.size());
    little_ = order[0] == 'I';
  }

  std::uint64_t At(std::uint64_t place, std::size_t bytes) {  // 0 beyond the end
    std::array<unsigned char, 8> raw{};
    file_.clear();
    file_.seekg(static_cast<std::streamoff>(place));
    file_.read(reinterpret_cast<char*>(raw.data()), static_cast<std::streamsize>(bytes));
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < bytes; ++i) value = value << 8 | raw[little_ ? bytes - 1 - i : i];
    return value;
  }

 private:
  std::ifstream file_;
  bool little_ = true;
};

}  // namespace

std::map<int, int> ReadGeoKeys(const std::filesystem::path& file) {
  constexpr std::uint64_t kClassic = 42, kBig = 43, kKeyDirectory = 34735, kShorts = 3, kMaxKeys = 1000,
                          kMaxTags = 65535;
  TiffNumbers numbers(file);
  const std::uint64_t version = numbers.At(2, 2);
  if (version != kClassic && version != kBig) return {};
  const bool big = version == kBig;
  const std::size_t offset_bytes = big ? 8 : 4, tag_bytes = big ? 20 : 12, count_bytes = big ? 8 : 2;
  const std::uint64_t directory = numbers.At(big ? 8 : 4, offset_bytes);
  const std::uint64_t tags = numbers.At(directory, count_bytes);
  std::map<int, int> keys;
  for (std::uint64_t i = 0; i < tags && i < kMaxTags; ++i) {
    const std::uint64_t tag = directory + count_bytes + i * tag_bytes;
    if (numbers.At(tag, 2) != kKeyDirectory || numbers.At(tag + 2, 2) != kShorts) continue;
    // A version, two of the revision, their number; then for each its name, where it is, how many, the value.
    const std::uint64_t begin = numbers.At(tag + 4 + offset_bytes, offset_bytes);
    const std::uint64_t count = numbers.At(begin + 6, 2);
    for (std::uint64_t k = 1; k <= count && k <= kMaxKeys; ++k)
      if (numbers.At(begin + 8 * k + 2, 2) == 0)
        keys[static_cast<int>(numbers.At(begin + 8 * k, 2))] =
            static_cast<int>(numbers.At(begin + 8 * k + 6, 2));
  }
  return keys;
}

std::string UnitOfKey(const std::map<int, int>& keys, int key) {
  constexpr int kUndefined = 0, kElsewhere = 32767;
  const auto found = keys.find(key);
  if (found == keys.end() || found->second == kUndefined || found->second == kElsewhere) return "";
  // By their numbers in the EPSG register.
  switch (found->second) {
    case 9001:
      return "m";
    case 9002:
      return "ft";
    case 9003:
      return "us-ft";
    case 9036:
      return "km";
    case 1033:
      return "cm";
    case 1025:
      return "mm";
    default:
      return fmt::format("EPSG unit {}", found->second);
  }
}

}  // namespace ed3r::world
