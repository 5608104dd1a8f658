#include "engine/world/files/picture_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "engine/core/check.h"
#include "engine/core/files/file.h"
#include "engine/world/files/exif_orientation.h"
#include "engine/world/files/jpeg_check.h"
#include "engine/world/files/png_pixels.h"
#include "engine/world/files/quiet_opencv.h"

namespace ed3r::world {
namespace {

constexpr std::string_view kPngMagic = "\x89PNG\r\n\x1a\n";
constexpr std::string_view kJpegMagic = "\xff\xd8\xff";
constexpr char kTurned[] = "turned as its camera says";

class HeaderReader {
 public:
  HeaderReader(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {}

  PictureSides Read() {
    if (bytes_.starts_with(kPngMagic)) return Png();
    if (bytes_.starts_with(kJpegMagic)) return Jpeg();
    Refuse("is neither a PNG nor a JPEG picture");
  }

  // Of a JPEG, after Read: its EXIF block, "" for none.
  std::string_view Exif() const { return exif_; }

 private:
  [[noreturn]] void Refuse(const std::string& why) const {
    throw UserError(fmt::format("{}: {}", name_, why));
  }

  // Big-endian, of `size` bytes.
  std::uint32_t Number(std::size_t at, std::size_t size) const {
    if (at > bytes_.size() || size > bytes_.size() - at) Refuse("is cut short");
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < size; ++i) value = value << 8 | static_cast<unsigned char>(bytes_[at + i]);
    return value;
  }

  struct Sides {
    std::uint32_t width, height;
  };

  // Chunks: length, name, data, checksum. The first tells the sides, the last is IEND.
  PictureSides Png() const {
    constexpr std::size_t kFrame = 12;
    std::size_t at = kPngMagic.size();
    if (bytes_.size() < at + kFrame) Refuse("is cut short");
    if (bytes_.substr(at + 4, 4) != "IHDR") Refuse("is damaged: its header does not stand first");
    const PictureSides sides = Checked({Number(at + 8, 4), Number(at + 12, 4)});
    while (true) {
      const std::uint32_t length = Number(at, 4);
      const bool last = bytes_.substr(std::min(at + 4, bytes_.size()), 4) == "IEND";
      if (bytes_.size() - at < kFrame || bytes_.size() - at - kFrame < length) Refuse("is cut short");
      if (last) break;
      at += kFrame + length;
    }
    return sides;
  }

  // Segments: marker, length, data. A frame header (SOF) tells the sides.
  PictureSides Jpeg() {
    std::size_t at = 2;
    while (true) {
      if (Number(at, 1) != 0xff) Refuse("is damaged: a marker is missing");
      const std::uint32_t marker = Number(at + 1, 1);
      if (marker == 0xff) {  // a fill byte
        ++at;
        continue;
      }
      const bool frame =
          marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
      if (frame) break;
      if (marker == 0xd9 || marker == 0xda) Refuse("is damaged: its sides are not told before its pixels");
      const bool bare = marker == 0x01 || (marker >= 0xd0 && marker <= 0xd8);
      const std::uint32_t length = bare ? 0 : Number(at + 2, 2);
      if (!bare && length < 2) Refuse("is damaged: a segment without a length");
      const std::string_view data = bytes_.substr(std::min(at + 4, bytes_.size()), std::max(length, 2u) - 2);
      if (marker == 0xe1 && exif_.empty() && data.starts_with(std::string_view("Exif\0\0", 6))) exif_ = data;
      at += 2 + length;
    }
    const PictureSides sides = Checked({Number(at + 7, 2), Number(at + 5, 2)});
    const std::size_t end = bytes_.rfind("\xff\xd9");
    if (end == std::string_view::npos || end < at) Refuse("is cut short");
    return sides;
  }

  PictureSides Checked(Sides sides) const {
    const bool good = sides.width >= 1 && sides.height >= 1 && sides.width <= kMaxPictureSidePx &&
                      sides.height <= kMaxPictureSidePx &&
                      std::uint64_t{sides.width} * sides.height <= kMaxPicturePixels;
    if (!good)
      Refuse(fmt::format("a picture of {} x {} pixels; allowed: sides of 1 .. {}, at most {} pixels",
                         sides.width, sides.height, kMaxPictureSidePx, kMaxPicturePixels));
    return {static_cast<int>(sides.width), static_cast<int>(sides.height)};
  }

  std::string_view bytes_;
  const std::string& name_;
  std::string_view exif_;
};

// True where something is see-through; `bgr` is what is seen over black.
bool OverBlack(const cv::Mat& bgra, cv::Mat& bgr) {
  bool through = false;
  bgr.create(bgra.size(), CV_8UC3);
  for (int y = 0; y < bgra.rows; ++y)
    for (int x = 0; x < bgra.cols; ++x) {
      const cv::Vec4b& from = bgra.at<cv::Vec4b>(y, x);
      through = through || from[3] != 255;
      for (int c = 0; c < 3; ++c)
        bgr.at<cv::Vec3b>(y, x)[c] = static_cast<unsigned char>((from[c] * from[3] + 127) / 255);
    }
  return through;
}

Picture PngPicture(const std::string& bytes, const std::string& path) {
  const PngPixels png = DecodePng(bytes, path);
  if (png.grey && png.sixteen_bits)
    throw UserError(
        fmt::format("{}: has one channel of 16 bits (a thermal picture, raw counts), which is no colour; "
                    "allowed: 8 bits, "
                    "or three channels",
                    path));
  Picture picture;
  const bool through = OverBlack(png.bgra, picture.bgr);
  picture.bgr = Turned(picture.bgr, png.orientation);
  std::vector<std::string> notes;
  if (png.grey) notes.push_back("grey");
  if (png.sixteen_bits) notes.push_back("upper 8 of 16 bits");
  if (through) notes.push_back("see-through parts as black");
  if (png.orientation != 1) notes.push_back(kTurned);
  picture.note = fmt::format("{}", fmt::join(notes, ", "));
  return picture;
}

Picture JpegPicture(const std::string& bytes, const std::string& path) {
  const int channels = CheckJpeg(bytes, path);
  QuietOpenCv();
  Picture picture;
  try {
    const cv::Mat wrapped(1, static_cast<int>(bytes.size()), CV_8UC1, const_cast<char*>(bytes.data()));
    // OpenCV looks for the orientation in the first segment of metadata alone, which may be XMP.
    picture.bgr = cv::imdecode(wrapped, cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception&) {
    picture.bgr.release();
  }
  if (picture.bgr.empty()) throw UserError(fmt::format("{}: is no picture that can be read", path));
  std::vector<std::string> notes;
  if (channels == 1) notes.push_back("grey");
  if (channels == 4) notes.push_back("from four inks");
  HeaderReader header(bytes, path);
  header.Read();
  const int orientation = ExifOrientation(header.Exif());
  picture.bgr = Turned(picture.bgr, orientation);
  if (orientation != 1) notes.push_back(kTurned);
  picture.note = fmt::format("{}", fmt::join(notes, ", "));
  return picture;
}

}  // namespace

PictureSides ReadPictureSides(std::string_view bytes, const std::string& name) {
  return HeaderReader(bytes, name).Read();
}

Picture ReadPicture(const std::string& path) {
  const std::string bytes = ReadFile(path);
  ReadPictureSides(bytes, path);
  return bytes.starts_with(kPngMagic) ? PngPicture(bytes, path) : JpegPicture(bytes, path);
}

void WritePicture(const cv::Mat& picture, const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  if (ending != ".png" && ending != ".jpg" && ending != ".jpeg")
    throw UserError(fmt::format("{}: cannot be written; allowed endings: .png, .jpg", path));
  std::vector<unsigned char> bytes;
  ED3R_CHECK(cv::imencode(ending, picture, bytes), path);
  WriteFile(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace ed3r::world
