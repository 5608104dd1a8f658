// Pictures of cameras and tools: each kind in a stated way, and none of which a part is missing.
#include "engine/world/files/picture_file.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>
#include <zlib.h>

#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <utility>

#include "engine/core/check.h"

namespace ed3r::world {
namespace {

namespace fs = std::filesystem;

class PictureFile : public testing::Test {
 protected:
  PictureFile() : path_(fs::temp_directory_path() / fmt::format("ed3r-picture-{}", ::getpid())) {}
  ~PictureFile() override { fs::remove(path_); }

  static std::string Encoded(const std::string& ending, const cv::Mat& picture) {
    std::vector<unsigned char> bytes;
    EXPECT_TRUE(cv::imencode(ending, picture, bytes));
    return {bytes.begin(), bytes.end()};
  }

  // What libraries say while it is read would stand on stderr.
  Picture Read(const std::string& bytes) const {
    std::ofstream(path_, std::ios::binary) << bytes;
    testing::internal::CaptureStderr();
    Picture picture;
    std::string refused;
    try {
      picture = ReadPicture(path_.string());
    } catch (const UserError& error) {
      refused = error.what();
    }
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    if (!refused.empty()) throw UserError(refused);
    return picture;
  }

  void ExpectRefusal(const std::string& bytes, const std::string& part) const {
    try {
      Read(bytes);
      ADD_FAILURE() << "read, though " << part;
    } catch (const UserError& error) {
      const std::string said = error.what();
      EXPECT_TRUE(said.starts_with(path_.string() + ": ")) << said;
      EXPECT_NE(said.find(part), std::string::npos) << said;
      EXPECT_EQ(said.find('\n'), std::string::npos) << said;
    }
  }

  fs::path path_;
};

// A picture in which every pixel differs from its neighbours.
template <class Pixel>
cv::Mat Pattern(int type) {
  cv::Mat picture(48, 64, type);
  std::uint32_t state = 1;
  for (int y = 0; y < picture.rows; ++y)
    for (int x = 0; x < picture.cols; ++x)
      for (int c = 0; c < Pixel::channels; ++c) {
        state = state * 1664525 + 1013904223;
        picture.at<Pixel>(y, x)[c] = static_cast<typename Pixel::value_type>(state >> 16);
      }
  return picture;
}

bool Same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0.0;
}

TEST_F(PictureFile, ColoursComeBackBitForBit) {
  const cv::Mat colours = Pattern<cv::Vec3b>(CV_8UC3);
  const Picture png = Read(Encoded(".png", colours));
  EXPECT_TRUE(Same(png.bgr, colours));
  EXPECT_EQ(png.note, "");
  const std::string jpeg = Encoded(".jpg", colours);
  const Picture read = Read(jpeg);
  EXPECT_TRUE(Same(read.bgr, cv::imdecode(std::vector<char>(jpeg.begin(), jpeg.end()), cv::IMREAD_COLOR)));
  EXPECT_EQ(read.note, "");
}

// An EXIF block of one entry: the orientation.
std::string ExifBlock(int orientation, bool little) {
  std::string block = little ? std::string("II*\0\x8\0\0\0\x1\0\x12\x1\x3\0\x1\0\0\0", 18)
                             : std::string("MM\0*\0\0\0\x8\0\x1\x1\x12\0\x3\0\0\0\x1", 18);
  if (!little) block += '\0';
  block += static_cast<char>(orientation);
  return block + std::string(little ? 7 : 6, '\0');
}

// A PNG with a chunk behind its header, which begins with its name.
std::string WithChunk(const std::string& png, const std::string& typed) {
  const auto number = [](std::uint32_t value) {
    std::string bytes;
    for (const int shift : {24, 16, 8, 0}) bytes += static_cast<char>(value >> shift);
    return bytes;
  };
  const auto sum = ::crc32(0, reinterpret_cast<const Bytef*>(typed.data()), static_cast<uInt>(typed.size()));
  constexpr std::size_t kAfterHeader = 33;
  return png.substr(0, kAfterHeader) + number(static_cast<std::uint32_t>(typed.size() - 4)) + typed +
         number(static_cast<std::uint32_t>(sum)) + png.substr(kAfterHeader);
}

std::string WithOrientation(const std::string& png, int orientation, bool little) {
  return WithChunk(png, "eXIf" + ExifBlock(orientation, little));
}

// Where the pixel is seen that is stored at (3, 5) of 64 x 48, by each orientation of EXIF.
const cv::Point kSeen[] = {{3, 5}, {60, 5}, {60, 42}, {3, 42}, {5, 3}, {42, 3}, {42, 60}, {5, 60}};

TEST_F(PictureFile, APngIsTurnedAsItsCameraSays) {
  const cv::Mat stored = Pattern<cv::Vec3b>(CV_8UC3);
  const std::string png = Encoded(".png", stored);
  const cv::Vec3b& pixel = stored.at<cv::Vec3b>(5, 3);
  for (int orientation = 1; orientation <= 8; ++orientation)
    for (const bool little : {true, false}) {
      SCOPED_TRACE(orientation);
      const Picture picture = Read(WithOrientation(png, orientation, little));
      EXPECT_EQ(picture.note, orientation == 1 ? "" : "turned as its camera says");
      EXPECT_EQ(picture.bgr.size(), orientation < 5 ? cv::Size(64, 48) : cv::Size(48, 64));
      EXPECT_EQ(picture.bgr.at<cv::Vec3b>(kSeen[orientation - 1]), pixel);
    }
  for (const int none : {0, 9, 255}) EXPECT_TRUE(Same(Read(WithOrientation(png, none, true)).bgr, stored));
  const Picture as_in_a_jpeg =
      Read(WithChunk(png, "eXIf" + std::string("Exif\0\0", 6) + ExifBlock(6, false)));
  EXPECT_EQ(as_in_a_jpeg.note, "turned as its camera says");
  EXPECT_EQ(as_in_a_jpeg.bgr.at<cv::Vec3b>(kSeen[5]), pixel);
}

// What libpng leaves out without a word where its checksum is wrong.
TEST_F(PictureFile, APngsDamagedChunksAreRefused) {
  const std::string png = Encoded(".png", Pattern<cv::Vec3b>(CV_8UC3));
  constexpr std::size_t kInChunk = 33 + 8;
  for (const auto& [chunk, name] : {std::pair("eXIf" + ExifBlock(6, true), "eXIf"),
                                    std::pair("tRNS" + std::string("\0\x9\0\x9\0\x9", 6), "tRNS")}) {
    std::string damaged = WithChunk(png, chunk);
    EXPECT_NO_THROW(Read(damaged));
    damaged[kInChunk + 3] ^= 1;
    ExpectRefusal(damaged, fmt::format("is damaged or cut short: {}: CRC error", name));
  }
}

// libpng gives up chunks behind a thousand others, and long ones.
TEST_F(PictureFile, ACamerasWordCountsWhereverItStands) {
  const std::string png = Encoded(".png", Pattern<cv::Vec3b>(CV_8UC3));
  const std::string exif = "eXIf" + ExifBlock(6, true);
  std::string notes = WithChunk(png, exif);
  for (int note = 0; note < 1500; ++note) notes = WithChunk(notes, std::string("tEXta\0b", 7));
  std::string large = exif;
  large.resize(9'000'000);
  for (const std::string& picture : {notes, WithChunk(png, large)})
    EXPECT_EQ(Read(picture).note, "turned as its camera says");
}

// A PNG of two rows of three pixels, which are numbers of colours; with the chunks in this order, "" for the pixels.
std::string WithPalette(int bits, const std::string& rows, std::vector<std::string> chunks) {
  std::string packed(100, '\0');
  uLongf size = packed.size();
  EXPECT_EQ(::compress(reinterpret_cast<Bytef*>(packed.data()), &size,
                       reinterpret_cast<const Bytef*>(rows.data()), rows.size()),
            Z_OK);
  std::string png = "\x89PNG\r\n\x1a\n";
  std::string header("IHDR\0\0\0\3\0\0\0\2\0\3\0\0\0", 17);
  header[12] = static_cast<char>(bits);
  // Chunks are put behind the header: the last one first.
  png = WithChunk(png + std::string(25, ' '), "IEND");
  for (auto chunk = chunks.rbegin(); chunk != chunks.rend(); ++chunk)
    png = WithChunk(png, chunk->empty() ? "IDAT" + packed.substr(0, size) : *chunk);
  const std::string first = WithChunk(std::string(33, ' '), header).substr(33);
  return png.replace(8, 25, first);
}

TEST_F(PictureFile, APalettesColoursAreThoseOfItsNumbers) {
  const std::string palette = "PLTE\x10\x20\x30\x40\x50\x60\x70\x80\x90", through("tRNS\xff\0", 6);
  const std::string in_bytes("\0\0\1\2\0\2\1\0", 8), in_two_bits("\0\x18\0\x90", 4);
  for (const auto& [bits, rows] : {std::pair(8, in_bytes), std::pair(2, in_two_bits)}) {
    const Picture opaque = Read(WithPalette(bits, rows, {palette, ""}));
    EXPECT_EQ(opaque.note, "");
    const cv::Vec3b colours[] = {{0x30, 0x20, 0x10}, {0x60, 0x50, 0x40}, {0x90, 0x80, 0x70}};
    for (int x = 0; x < 3; ++x) {
      EXPECT_EQ(opaque.bgr.at<cv::Vec3b>(0, x), colours[x]);
      EXPECT_EQ(opaque.bgr.at<cv::Vec3b>(1, x), colours[2 - x]);
    }
    const Picture seen = Read(WithPalette(bits, rows, {palette, through, ""}));
    EXPECT_EQ(seen.note, "see-through parts as black");
    EXPECT_EQ(seen.bgr.at<cv::Vec3b>(0, 1), cv::Vec3b(0, 0, 0));
    EXPECT_EQ(seen.bgr.at<cv::Vec3b>(0, 2), colours[2]);
    const std::string damaged = "is damaged or cut short: ";
    ExpectRefusal(WithPalette(bits, rows, {palette.substr(0, 10), ""}),
                  damaged + "a pixel of colour 2 of 0 .. 1");
    for (const std::vector<std::string>& chunks : {std::vector<std::string>{palette, "", through},
                                                   {through, palette, ""},
                                                   {palette, through + "1234", ""}})
      ExpectRefusal(WithPalette(bits, rows, chunks), damaged + "tRNS: ");
  }
  const std::string png = Encoded(".png", Pattern<cv::Vec3b>(CV_8UC3));
  ExpectRefusal(WithChunk(png, "tRNS12345"), "is damaged or cut short: tRNS: ");
  const std::string with_alpha = Encoded(".png", Pattern<cv::Vec4b>(CV_8UC4));
  EXPECT_TRUE(Same(Read(WithChunk(with_alpha, "tRNS12")).bgr, Read(with_alpha).bgr));
}

// A JPEG with a segment of metadata behind its first marker.
std::string WithMetadata(const std::string& jpeg, const std::string& data) {
  return jpeg.substr(0, 2) + "\xff\xe1" + '\0' + static_cast<char>(data.size() + 2) + data + jpeg.substr(2);
}

TEST_F(PictureFile, JpegsThatAreTurnedSaySo) {
  const std::string jpeg = Encoded(".jpg", Pattern<cv::Vec3b>(CV_8UC3));
  const cv::Vec3b pixel = Read(jpeg).bgr.at<cv::Vec3b>(5, 3);
  for (int orientation = 1; orientation <= 8; ++orientation)
    for (const bool little : {true, false}) {
      const std::string marked =
          WithMetadata(jpeg, std::string("Exif\0\0", 6) + ExifBlock(orientation, little));
      const std::string xmp = std::string("http://ns.adobe.com/xap/1.0/") + '\0' + "<x:xmpmeta/>";
      for (const std::string& camera : {marked, WithMetadata(marked, xmp)}) {
        SCOPED_TRACE(orientation);
        const Picture picture = Read(camera);
        EXPECT_EQ(picture.note, orientation == 1 ? "" : "turned as its camera says");
        EXPECT_EQ(picture.bgr.size(), orientation < 5 ? cv::Size(64, 48) : cv::Size(48, 64));
        EXPECT_EQ(picture.bgr.at<cv::Vec3b>(kSeen[orientation - 1]), pixel);
      }
    }
}

// Some write it in four bytes.
TEST_F(PictureFile, AnOrientationOfFourBytesCounts) {
  const std::string jpeg = Encoded(".jpg", Pattern<cv::Vec3b>(CV_8UC3));
  for (const bool little : {true, false}) {
    std::string block = ExifBlock(6, little);
    block[little ? 12 : 13] = '\x4';
    if (!little) std::swap(block[19], block[21]);
    const Picture picture = Read(WithMetadata(jpeg, std::string("Exif\0\0", 6) + block));
    EXPECT_EQ(picture.note, "turned as its camera says");
    EXPECT_EQ(picture.bgr.size(), cv::Size(48, 64));
  }
}

TEST_F(PictureFile, GreyIsThreeEqualColours) {
  const cv::Mat grey = Pattern<cv::Vec<unsigned char, 1>>(CV_8UC1);
  const Picture picture = Read(Encoded(".png", grey));
  EXPECT_EQ(picture.note, "grey");
  EXPECT_EQ(picture.bgr.at<cv::Vec3b>(7, 9), cv::Vec3b::all(grey.at<unsigned char>(7, 9)));
  EXPECT_EQ(Read(Encoded(".jpg", grey)).note, "grey");
}

TEST_F(PictureFile, OfSixteenBitsTheUpperEightAreTaken) {
  const cv::Mat deep = Pattern<cv::Vec3w>(CV_16UC3);
  const Picture picture = Read(Encoded(".png", deep));
  EXPECT_EQ(picture.note, "upper 8 of 16 bits");
  for (int c = 0; c < 3; ++c) EXPECT_EQ(picture.bgr.at<cv::Vec3b>(5, 6)[c], deep.at<cv::Vec3w>(5, 6)[c] >> 8);
}

TEST_F(PictureFile, ThermalCountsAreNoColours) {
  ExpectRefusal(Encoded(".png", cv::Mat(48, 64, CV_16UC1, cv::Scalar(7315))),
                "has one channel of 16 bits (a thermal picture, raw counts)");
}

TEST_F(PictureFile, WhatIsSeeThroughLiesOverBlack) {
  cv::Mat opaque = Pattern<cv::Vec4b>(CV_8UC4);
  for (int y = 0; y < opaque.rows; ++y)
    for (int x = 0; x < opaque.cols; ++x) opaque.at<cv::Vec4b>(y, x)[3] = 255;
  const Picture plain = Read(Encoded(".png", opaque));
  EXPECT_EQ(plain.note, "");
  EXPECT_EQ(plain.bgr.at<cv::Vec3b>(3, 4)[2], opaque.at<cv::Vec4b>(3, 4)[2]);
  opaque.at<cv::Vec4b>(3, 4) = {200, 100, 51, 0};
  opaque.at<cv::Vec4b>(3, 5) = {200, 100, 51, 51};
  const Picture through = Read(Encoded(".png", opaque));
  EXPECT_EQ(through.note, "see-through parts as black");
  EXPECT_EQ(through.bgr.at<cv::Vec3b>(3, 4), cv::Vec3b(0, 0, 0));
  EXPECT_EQ(through.bgr.at<cv::Vec3b>(3, 5), cv::Vec3b(40, 20, 10));
}

TEST_F(PictureFile, PicturesThatAreNotWholeAreRefused) {
  const std::string jpeg = Encoded(".jpg", Pattern<cv::Vec3b>(CV_8UC3));
  ExpectRefusal(jpeg.substr(0, jpeg.size() / 2), "is cut short");
  ExpectRefusal(jpeg.substr(0, jpeg.size() / 2) + "\xff\xd9", "is damaged or cut short: ");
  ExpectRefusal(jpeg.substr(0, jpeg.size() / 2) + std::string(jpeg.size() / 2, '\0'), "is cut short");
  const std::string png = Encoded(".png", Pattern<cv::Vec3b>(CV_8UC3));
  ExpectRefusal(png.substr(0, png.size() / 2), "is cut short");
  std::string turned = png;
  turned[png.size() / 2] ^= 1;
  ExpectRefusal(turned, "is damaged or cut short: ");
  ExpectRefusal("GIF89a", "is neither a PNG nor a JPEG picture");
}

TEST_F(PictureFile, SidesAreRefusedByTheHeaderAlone) {
  const std::string header("\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR\0\0\xea\x60\0\0\xea\x60\x08\x02\0\0\0", 29);
  ExpectRefusal(header, "a picture of 60000 x 60000 pixels; allowed: sides of 1 .. 20000");
  ExpectRefusal(header + std::string("\0\0\0\0\0\0\0\0IEND\xae\x42\x60\x82", 16), "60000 x 60000");
}

}  // namespace
}  // namespace ed3r::world
