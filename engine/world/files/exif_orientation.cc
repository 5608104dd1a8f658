#include "engine/world/files/exif_orientation.h"

#include <cstddef>
#include <cstdint>

namespace ed3r::world {
namespace {

// Numbers of a TIFF block, in its byte order; 0 beyond its end.
class Tiff {
 public:
  explicit Tiff(std::string_view bytes) : bytes_(bytes), little_(bytes.starts_with("II")) {}

  std::uint32_t Number(std::size_t at, std::size_t size) const {
    if (at > bytes_.size() || size > bytes_.size() - at) return 0;
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < size; ++i)
      value = value << 8 | static_cast<unsigned char>(bytes_[at + (little_ ? size - 1 - i : i)]);
    return value;
  }

 private:
  std::string_view bytes_;
  bool little_;
};

}  // namespace

int ExifOrientation(std::string_view exif) {
  constexpr std::uint32_t kOrientation = 0x0112, kShort = 3, kLong = 4;
  constexpr std::size_t kEntry = 12;
  if (exif.starts_with(std::string_view("Exif\0\0", 6))) exif.remove_prefix(6);
  if (!exif.starts_with("II") && !exif.starts_with("MM")) return 1;
  const Tiff tiff(exif);
  const std::size_t directory = tiff.Number(4, 4);
  const std::uint32_t entries = tiff.Number(directory, 2);
  for (std::uint32_t i = 0; i < entries; ++i) {
    const std::size_t entry = directory + 2 + kEntry * i;
    const std::uint32_t type = tiff.Number(entry + 2, 2);
    if (tiff.Number(entry, 2) != kOrientation || (type != kShort && type != kLong)) continue;
    const std::uint32_t value = tiff.Number(entry + 8, type == kShort ? 2 : 4);
    return value >= 1 && value <= 8 ? static_cast<int>(value) : 1;
  }
  return 1;
}

cv::Mat Turned(const cv::Mat& picture, int orientation) {
  constexpr int kUpsideDown = 0, kMirrored = 1, kHalfTurn = -1;  // of cv::flip
  cv::Mat turned = picture;
  if (orientation >= 5 && orientation <= 8) cv::transpose(picture, turned);
  cv::Mat upright = turned;
  if (orientation == 2 || orientation == 6) cv::flip(turned, upright, kMirrored);
  if (orientation == 3 || orientation == 7) cv::flip(turned, upright, kHalfTurn);
  if (orientation == 4 || orientation == 8) cv::flip(turned, upright, kUpsideDown);
  return upright;
}

}  // namespace ed3r::world
