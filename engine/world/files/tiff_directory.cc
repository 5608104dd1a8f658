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
  bool apart = false;       // they stand outside the directory
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
      tag.apart = tag.count > offset_bytes / std::max<std::size_t>(1, SizeOf(tag));
      if (tag.apart) tag.begin = numbers_.At(tag.begin, offset_bytes);
      tags_.emplace(numbers_.At(at, 2), tag);
    }
  }

  std::uint64_t At(std::uint64_t place, std::size_t bytes) { return numbers_.At(place, bytes); }
  // Null where it is not there. Of two of one name the first, which libtiff takes.
  const Tag* Find(std::uint64_t name) const {
    const auto found = tags_.find(name);
    return found == tags_.end() ? nullptr : &found->second;
  }

  // What stands in the file beside blocks: header, directory, values of tags. These may lie over each other: some writers store
  // equal values once.
  std::vector<Bytes> PlacesOfTags() const {
    std::vector<Bytes> places = {header_, directory_};
    for (const auto& [name, tag] : tags_)
      if (tag.apart) places.push_back({tag.begin, tag.begin + tag.count * SizeOf(tag)});
    return places;
  }

  // Whole numbers of the tag; none where it is not there.
  std::vector<std::uint64_t> Numbers(std::uint64_t name) {
    constexpr std::uint64_t kMostBlocks = 1 << 20;
    std::vector<std::uint64_t> values;
    const Tag* const tag = Find(name);
    if (tag == nullptr || !IsWhole(*tag)) return values;
    for (std::uint64_t i = 0; i < std::min(tag->count, kMostBlocks); ++i)
      values.push_back(numbers_.At(tag->begin + i * SizeOf(*tag), SizeOf(*tag)));
    return values;
  }
  std::uint64_t Number(std::uint64_t name, std::uint64_t otherwise) {
    const std::vector<std::uint64_t> values = Numbers(name);
    return values.empty() ? otherwise : values.front();
  }

 private:
  static std::size_t SizeOf(const Tag& tag) {  // of one value, by its type; 0 for unknown ones
    constexpr std::array<std::size_t, 19> kSizes = {0, 1, 1, 2, 4, 8, 1, 1, 2, 4, 8, 4, 8, 4, 0, 0, 8, 8, 8};
    return tag.type < kSizes.size() ? kSizes[tag.type] : 0;
  }
  static bool IsWhole(const Tag& tag) { return tag.type == 3 || tag.type == 4 || tag.type == 16; }

  TiffNumbers numbers_;
  Bytes header_, directory_;
  std::map<std::uint64_t, Tag> tags_;  // by their numbers
};

constexpr std::uint64_t kWidth = 256, kLength = 257, kBits = 258, kCompression = 259, kStrips = 273,
                        kSamples = 277, kRowsPerStrip = 278, kStripBytes = 279, kPlanes = 284,
                        kTileWidth = 322, kTileLength = 323, kTiles = 324, kTileBytes = 325;

// The blocks that the sides of the grid make.
struct BlockShape {
  std::uint64_t in_plane = 0, planes = 1;       // how many; none where the file does not tell its sides
  std::uint64_t cell_bytes = 1, row_bytes = 0;  // without compression
  std::uint64_t rows = 0, last_rows = 0;        // of a block, of the last one of a plane
};

BlockShape ShapeOf(TiffDirectory& tiff, bool tiled) {
  constexpr std::uint64_t kApart = 2, kBitsPerByte = 8;
  const auto blocks = [](std::uint64_t cells, std::uint64_t of) { return (cells + of - 1) / of; };
  const std::uint64_t length = tiff.Number(kLength, 0), width = tiff.Number(kWidth, 0);
  const std::uint64_t samples = tiff.Number(kSamples, 1);
  const bool apart = tiff.Number(kPlanes, 1) == kApart;
  const std::uint64_t columns = tiled ? tiff.Number(kTileWidth, 0) : width;
  BlockShape shape;
  shape.planes = apart ? samples : 1;
  shape.rows = tiled ? tiff.Number(kTileLength, 0) : std::min(length, tiff.Number(kRowsPerStrip, length));
  if (columns == 0 || shape.rows == 0) return shape;
  const std::uint64_t down = blocks(length, shape.rows);
  shape.in_plane = blocks(width, columns) * down;
  const std::uint64_t cell_bits = (apart ? 1 : samples) * tiff.Number(kBits, 1);
  shape.cell_bytes = std::max<std::uint64_t>(1, cell_bits / kBitsPerByte);
  shape.row_bytes = blocks(columns * cell_bits, kBitsPerByte);
  shape.last_rows = tiled ? shape.rows : length - (down - 1) * shape.rows;
  return shape;
}

// Without compression libtiff reads as many bytes as it needs, whatever is said; other sides shear or shift the heights.
std::string WhySizesDiffer(TiffDirectory& tiff, const BlockShape& shape, std::uint64_t count,
                           const std::vector<std::uint64_t>& sizes) {
  if (shape.in_plane == 0) return "";
  const std::string sides = fmt::format("{} x {} cells", tiff.Number(kWidth, 0), tiff.Number(kLength, 0));
  if (count != shape.in_plane * shape.planes)
    return fmt::format("it has {} blocks of heights, and its {} make {}", count, sides,
                       shape.in_plane * shape.planes);
  if (tiff.Number(kCompression, 1) != 1) return "";
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const bool last = (i + 1) % shape.in_plane == 0;
    const std::uint64_t bytes = shape.row_bytes * (last ? shape.last_rows : shape.rows);
    if (sizes[i] != 0 && sizes[i] != bytes)
      return fmt::format("block {} of its heights has {} bytes, and its {} make {}", i + 1, sizes[i], sides,
                         bytes);
  }
  return "";
}

bool IsOneHeight(TiffDirectory& tiff, const Bytes& block, std::uint64_t cell_bytes) {
  constexpr std::uint64_t kMostCells = 1 << 24;
  if (cell_bytes > 8 || (block.end - block.begin) / cell_bytes > kMostCells) return false;
  const std::uint64_t first = tiff.At(block.begin, cell_bytes);
  for (std::uint64_t at = block.begin; at + cell_bytes <= block.end; at += cell_bytes)
    if (tiff.At(at, cell_bytes) != first) return false;
  return true;
}

// Some writers store blocks of one height (most often NODATA) once. Ground does not repeat itself: there, one bit turned the
// place of one block into that of another. Compressed, their lengths would differ.
std::string WhyTwoAtOnePlace(TiffDirectory& tiff, const std::vector<Bytes>& sorted,
                             std::uint64_t cell_bytes) {
  if (tiff.Number(kCompression, 1) != 1) return "";
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    const bool second = sorted[i] == sorted[i - 1] && (i < 2 || sorted[i] != sorted[i - 2]);
    if (second && !IsOneHeight(tiff, sorted[i], cell_bytes))
      return fmt::format("two blocks of its heights lie at byte {}", sorted[i].begin);
  }
  return "";
}

std::string WhyOverOthers(std::vector<Bytes> blocks, const std::vector<Bytes>& others) {
  blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
  std::vector<std::pair<Bytes, bool>> places;  // true: a block
  places.reserve(blocks.size() + others.size());
  for (const Bytes& block : blocks) places.emplace_back(block, true);
  for (const Bytes& other : others) places.emplace_back(other, false);
  std::sort(places.begin(), places.end());
  std::uint64_t blocks_end = 0, others_end = 0;
  for (const auto& [place, is_block] : places) {
    if (place.begin < blocks_end || (is_block && place.begin < others_end))
      return fmt::format("a block of its heights lies at byte {}, where others stand", place.begin);
    std::uint64_t& end = is_block ? blocks_end : others_end;
    end = std::max(end, place.end);
  }
  return "";
}

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

std::string WhyBlocksDoNotFit(const std::filesystem::path& file) {
  TiffDirectory tiff(file);
  const BlockShape shape = ShapeOf(tiff, tiff.Find(kTileWidth) != nullptr);
  std::string why;
  std::vector<Bytes> blocks;
  for (const auto& [where, how_many] : {std::pair(kStrips, kStripBytes), std::pair(kTiles, kTileBytes)}) {
    const Tag* const tag = tiff.Find(where);
    if (tag == nullptr) continue;
    const std::vector<std::uint64_t> begins = tiff.Numbers(where), sizes = tiff.Numbers(how_many);
    if (why.empty()) why = WhySizesDiffer(tiff, shape, tag->count, sizes);
    for (std::size_t i = 0; i < std::min(begins.size(), sizes.size()); ++i)
      if (sizes[i] > 0) blocks.push_back({begins[i], begins[i] + sizes[i]});
  }
  std::sort(blocks.begin(), blocks.end());
  if (why.empty()) why = WhyTwoAtOnePlace(tiff, blocks, shape.cell_bytes);
  if (why.empty()) why = WhyOverOthers(blocks, tiff.PlacesOfTags());
  if (why.empty()) return why;
  return fmt::format("damaged: {}; bring the whole file, or write it anew (gdal_translate)", why);
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
