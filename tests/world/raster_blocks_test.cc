// One bit in what a GeoTIFF says of its blocks of heights (how many cells, where they stand, how long they are) gave other
// heights, of which GDAL says nothing.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "tests/world/test_rasters.h"
#include "tests/world/world_files.h"

namespace ed3r::world {
namespace {

constexpr int kWidth = 256, kLength = 257, kStrips = 273, kRowsPerStrip = 278, kStripBytes = 279,
              kKeys = 34735;

std::string Number(int value, int bytes) {
  std::string text;
  for (int i = 0; i < bytes; ++i) text += static_cast<char>(value >> (8 * i) & 0xff);
  return text;
}

// A GeoTIFF of 32-bit floats without compression, as tests change it. Heights of 0 .. 44, and 44 at the place that is asked.
class Tiff {
 public:
  explicit Tiff(const TestFolder& folder) : folder_(folder) {
    TestRaster raster;
    raster.system = "EPSG:32633";
    raster.stored = [](int column, int row) { return 2.0 * column + 3.0 * row; };
    WriteRaster(folder.Path("g.tif"), raster);
    std::ifstream file(folder.Path("g.tif"), std::ios::binary);
    bytes.assign(std::istreambuf_iterator<char>(file), {});
  }

  int At(std::size_t place, int size) const {
    int value = 0;
    for (int i = size; i-- > 0;)
      value = value << 8 | static_cast<unsigned char>(bytes[place + static_cast<std::size_t>(i)]);
    return value;
  }
  // Of what a tag says itself: its value, or where its values are.
  std::size_t PlaceOf(int tag) const {
    const auto directory = static_cast<std::size_t>(At(4, 4));
    for (int i = 0; i < At(directory, 2); ++i)
      if (const std::size_t at = directory + 2 + 12 * static_cast<std::size_t>(i); At(at, 2) == tag)
        return at + 8;
    ADD_FAILURE() << tag;
    return 8;
  }
  int Value(int tag) const { return At(PlaceOf(tag), 4); }
  void Set(int tag, int value) { bytes.replace(PlaceOf(tag), 4, Number(value, 4)); }

  // One more tag, of one value that stands elsewhere, in a directory at the end of the file.
  void Add(int tag, int type, int place) {
    const auto directory = static_cast<std::size_t>(At(4, 4));
    const int count = At(directory, 2);
    std::vector<std::string> tags = {Number(tag, 2) + Number(type, 2) + Number(1, 4) + Number(place, 4)};
    for (int i = 0; i < count; ++i)
      tags.push_back(bytes.substr(directory + 2 + 12 * static_cast<std::size_t>(i), 12));
    const auto name = [](const std::string& t) {
      return static_cast<unsigned char>(t[1]) << 8 | static_cast<unsigned char>(t[0]);
    };
    std::sort(tags.begin(), tags.end(), [&](const auto& a, const auto& b) { return name(a) < name(b); });
    bytes.replace(4, 4, Number(static_cast<int>(bytes.size()), 4));
    bytes += Number(count + 1, 2);
    for (const std::string& each : tags) bytes += each;
    bytes += Number(0, 4);
  }

  // Into strips of some rows.
  void Split(int rows) {
    const int columns = Value(kWidth), length = Value(kLength), begin = Value(kStrips);
    const int strips = (length + rows - 1) / rows;
    std::string begins, sizes;
    for (int row = 0; row < length; row += rows) {
      begins += Number(begin + 4 * columns * row, 4);
      sizes += Number(4 * columns * std::min(rows, length - row), 4);
    }
    for (const auto& [tag, numbers] : {std::pair(kStrips, begins), std::pair(kStripBytes, sizes)}) {
      Set(tag, static_cast<int>(bytes.size()));
      bytes.replace(PlaceOf(tag) - 4, 4, Number(strips, 4));
      bytes += numbers;
    }
    Set(kRowsPerStrip, rows);
  }

  std::string Height() const {
    folder_.Write("g.tif", bytes);
    return HeightOrProblem(folder_, "g.tif");
  }

  std::string bytes;

 private:
  const TestFolder& folder_;
};

std::string Damaged(const std::string& why) {
  return "'g.tif': damaged: " + why + "; bring the whole file, or write it anew (gdal_translate)";
}

TEST(RasterBlocks, LieOverNothingElse) {
  const TestFolder folder;
  const Tiff whole(folder);
  const int keys = whole.Value(kKeys), directory = whole.At(4, 4);
  const int header = 4;
  for (const int to : {header, directory, keys, keys + 8}) {
    Tiff moved = whole;
    moved.Set(kStrips, to);
    EXPECT_EQ(moved.Height(),
              Damaged(fmt::format("a block of its heights lies at byte {}, where others stand", to)));
  }
  EXPECT_EQ(whole.Height(), "44.00");
}

// Some writers store equal values of tags once.
TEST(RasterBlocks, TagsMayShareTheirValues) {
  const TestFolder folder;
  Tiff tiff(folder);
  const auto resolution = static_cast<int>(tiff.bytes.size());
  tiff.bytes += Number(1, 4) + Number(1, 4);
  for (const int x_or_y : {282, 283}) tiff.Add(x_or_y, 5, resolution);
  EXPECT_EQ(tiff.Height(), "44.00");
}

// Only those of one height: some writers store these once.
TEST(RasterBlocks, LieAtOnePlaceEach) {
  const TestFolder folder;
  Tiff tiff(folder);
  tiff.Split(1);
  const auto begins = static_cast<std::size_t>(tiff.Value(kStrips));
  const int third = tiff.At(begins + 8, 4);
  tiff.bytes.replace(begins, 4, Number(third, 4));
  EXPECT_EQ(tiff.Height(), Damaged(fmt::format("two blocks of its heights lie at byte {}", third)));
  const auto row = static_cast<std::size_t>(third);
  for (std::size_t column = 1; column < 11; ++column)
    tiff.bytes.replace(row + 4 * column, 4, tiff.bytes.substr(row, 4));
  EXPECT_EQ(tiff.Height(), "18.00");
}

TEST(RasterBlocks, AreAsTheSidesMakeThem) {
  const TestFolder folder;
  const Tiff one(folder);
  Tiff strips = one, rows = one;
  strips.Split(4);  // 4, 4, 1
  rows.Split(1);
  const auto with = [](Tiff tiff, int tag, int value) {
    tiff.Set(tag, value);
    return tiff.Height();
  };
  const auto bytes = [](int block, int has, const std::string& sides, int make) {
    return Damaged(fmt::format("block {} of its heights has {} bytes, and its {} cells make {}", block, has,
                               sides, make));
  };
  const auto count = [](int has, const std::string& sides, int make) {
    return Damaged(fmt::format("it has {} blocks of heights, and its {} cells make {}", has, sides, make));
  };
  for (const Tiff& tiff : {one, strips, rows}) EXPECT_EQ(tiff.Height(), "44.00");
  EXPECT_EQ(with(one, kWidth, 10), bytes(1, 396, "10 x 9", 360));
  EXPECT_EQ(with(one, kLength, 8), bytes(1, 396, "11 x 8", 352));
  EXPECT_EQ(with(strips, kWidth, 10), bytes(1, 176, "10 x 9", 160));
  EXPECT_EQ(with(strips, kLength, 8), count(3, "11 x 8", 2));
  EXPECT_EQ(with(rows, kWidth, 10), bytes(1, 44, "10 x 9", 40));
  EXPECT_EQ(with(rows, kLength, 8), count(9, "11 x 8", 8));
  EXPECT_EQ(with(rows, kRowsPerStrip, 3), count(9, "11 x 9", 3));
}

TEST(RasterBlocks, AreReadInEveryFormThatGdalWrites) {
  const TestFolder folder;
  using Options = std::vector<const char*>;
  for (const bool alpha : {false, true})
    for (const Options& options :
         {Options{"BLOCKYSIZE=4"}, Options{"TILED=YES", "BLOCKXSIZE=16", "BLOCKYSIZE=16"},
          Options{"BIGTIFF=YES", "BLOCKYSIZE=2"}, Options{"INTERLEAVE=BAND", "BLOCKYSIZE=4"},
          Options{"NBITS=12"}, Options{"COMPRESS=DEFLATE", "BLOCKYSIZE=4"},
          Options{"SPARSE_OK=TRUE", "BLOCKYSIZE=1"}, Options{"ENDIANNESS=BIG"}}) {
      SCOPED_TRACE(options.front());
      TestRaster raster;
      raster.type = GDT_UInt16;
      raster.system = "EPSG:32633";
      raster.stored = [](int column, int row) { return 2.0 * column + 3.0 * row; };
      if (alpha) raster.transparent = [](int, int) { return false; };
      WriteRaster(folder.Path("plain.tif"), raster);
      GDALDataset* const plain = GDALDataset::Open(folder.Path("plain.tif").c_str());
      Options ended = options;
      ended.push_back(nullptr);
      GDALDriver* const driver = GetGDALDriverManager()->GetDriverByName("GTiff");
      GDALClose(driver->CreateCopy(folder.Path("g.tif").c_str(), plain, FALSE,
                                   const_cast<char**>(ended.data()), nullptr, nullptr));
      GDALClose(plain);
      EXPECT_EQ(HeightOrProblem(folder, "g.tif"), "44.00");
    }
}

// It may be one that was filled up, or one bit in the number of rows: gdal_translate tells, and writes it as it should be.
TEST(RasterBlocks, TheLastStripHasTheRowsThatAreLeft) {
  const TestFolder folder;
  Tiff tiff(folder);
  tiff.Split(4);
  const auto last_size = static_cast<std::size_t>(tiff.Value(kStripBytes)) + 8;
  tiff.bytes.replace(last_size, 4, Number(4 * 4 * 11, 4));
  // The last row and what fills it up, at the end of the file.
  const auto last_begin = static_cast<std::size_t>(tiff.Value(kStrips)) + 8;
  const std::string row = tiff.bytes.substr(static_cast<std::size_t>(tiff.At(last_begin, 4)), 44);
  tiff.bytes.replace(last_begin, 4, Number(static_cast<int>(tiff.bytes.size()), 4));
  tiff.bytes += row + std::string(3 * 44, '\0');
  EXPECT_EQ(tiff.Height(), Damaged("block 3 of its heights has 176 bytes, and its 11 x 9 cells make 44"));
  tiff.bytes.replace(last_size, 4, Number(44, 4));
  EXPECT_EQ(tiff.Height(), "44.00");
}

}  // namespace
}  // namespace ed3r::world
