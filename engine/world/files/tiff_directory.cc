#include "engine/world/files/tiff_directory.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <utility>
#include <vector>

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

struct Bytes {
  std::uint64_t begin = 0, end = 0;
  auto operator<=>(const Bytes&) const = default;  // NOLINT(modernize-use-nullptr)
};

struct Tag {
  std::uint64_t type = 0, count = 0;
  std::uint64_t begin = 0;  // of its values
};

// The first one of a TIFF; without tags for other files.
class TiffDirectory {
 public:
  explicit TiffDirectory(const std::filesystem::path& path) : numbers_(path) {
    constexpr std::uint64_t kClassic = 42, kBig = 43, kMaxTags = 65535;
    const std::uint64_t version = numbers_.At(2, 2);
    if (version != kClassic && version != kBig) return;
    const bool big = version == kBig;
    const std::size_t offset_bytes = big ? 8 : 4, tag_bytes = big ? 20 : 12, count_bytes = big ? 8 : 2;
    header_.end = big ? 16 : 8;
    directory_.begin = numbers_.At(big ? 8 : 4, offset_bytes);
    const std::uint64_t tags = std::min(numbers_.At(directory_.begin, count_bytes), kMaxTags);
    directory_.end = directory_.begin + count_bytes + tags * tag_bytes + offset_bytes;
    for (std::uint64_t i = 0; i < tags; ++i) {
      const std::uint64_t at = directory_.begin + count_bytes + i * tag_bytes;
      Tag tag{numbers_.At(at + 2, 2), numbers_.At(at + 4, offset_bytes), at + 4 + offset_bytes};
      if (tag.count > offset_bytes / std::max<std::size_t>(1, SizeOf(tag)))
        tag.begin = numbers_.At(tag.begin, offset_bytes);
      tags_.emplace(numbers_.At(at, 2), tag);
    }
  }

  std::uint64_t At(std::uint64_t place, std::size_t bytes) { return numbers_.At(place, bytes); }
  // Null where it is not there. Of two of one name the first, which libtiff takes.
  const Tag* Find(std::uint64_t name) const {
    const auto found = tags_.find(name);
    return found == tags_.end() ? nullptr : &found->second;
  }
  Bytes header() const { return header_; }
  Bytes directory() const { return directory_; }

  // Whole numbers of the tag; none where it is not there.
  std::vector<std::uint64_t> Numbers(std::uint64_t name) {
    constexpr std::uint64_t kMostBlocks = 1 << 20;
    std::vector<std::uint64_t> values;
    const Tag* const tag = Find(name);
    if (tag == nullptr || SizeOf(*tag) == 0) return values;
    for (std::uint64_t i = 0; i < std::min(tag->count, kMostBlocks); ++i)
      values.push_back(numbers_.At(tag->begin + i * SizeOf(*tag), SizeOf(*tag)));
    return values;
  }

 private:
  static std::size_t SizeOf(const Tag& tag) {  // of one number
    return tag.type == 3 ? 2 : tag.type == 4 ? 4 : tag.type == 16 ? 8 : 0;
  }

  TiffNumbers numbers_;
  Bytes header_, directory_;
  std::map<std::uint64_t, Tag> tags_;  // by their numbers
};

}  // namespace

std::map<int, int> ReadGeoKeys(const std::filesystem::path& file) {
  constexpr std::uint64_t kKeyDirectory = 34735, kShorts = 3, kMaxKeys = 1000;
  TiffDirectory tiff(file);
  std::map<int, int> keys;
  const Tag* const tag = tiff.Find(kKeyDirectory);
  if (tag == nullptr || tag->type != kShorts) return keys;
  // A version, two of the revision, their number; then for each its name, where it is, how many, the value.
  const std::uint64_t begin = tag->begin, count = tiff.At(begin + 6, 2);
  for (std::uint64_t k = 1; k <= count && k <= kMaxKeys; ++k)
    if (tiff.At(begin + 8 * k + 2, 2) == 0)
      keys[static_cast<int>(tiff.At(begin + 8 * k, 2))] = static_cast<int>(tiff.At(begin + 8 * k + 6, 2));
  return keys;
}

std::string WhyBlocksAreElsewhere(const std::filesystem::path& file) {
  constexpr std::uint64_t kStrips = 273, kStripBytes = 279, kTiles = 324, kTileBytes = 325;
  TiffDirectory tiff(file);
  std::vector<Bytes> places = {tiff.header(), tiff.directory()};
  for (const auto& [where, how_many] : {std::pair(kStrips, kStripBytes), std::pair(kTiles, kTileBytes)}) {
    const std::vector<std::uint64_t> begins = tiff.Numbers(where), sizes = tiff.Numbers(how_many);
    for (std::size_t i = 0; i < std::min(begins.size(), sizes.size()); ++i)
      if (sizes[i] > 0) places.push_back({begins[i], begins[i] + sizes[i]});
  }
  std::sort(places.begin(), places.end());
  places.erase(std::unique(places.begin(), places.end()), places.end());  // equal blocks may be stored once
  for (std::size_t i = 1; i < places.size(); ++i)
    if (places[i].begin < places[i - 1].end)
      return fmt::format(
          "damaged: a block of its heights begins at byte {}, where others stand; bring the whole file, or "
          "write it anew "
          "(gdal_translate)",
          places[i].begin);
  return "";
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
