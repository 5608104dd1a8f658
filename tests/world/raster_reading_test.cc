// What GDAL passes over without a word is refused: side files and tags that are cut, keys of units; and nothing of its
// environment changes a number.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "engine/core/files/file.h"
#include "tests/world/test_rasters.h"
#include "tests/world/world_files.h"

namespace ed3r::world {
namespace {

constexpr double kFootM = 0.3048;

class RasterReadingTest : public ::testing::Test {
 protected:
  std::string Height(const std::string& file = "g.tif") const { return HeightOrProblem(folder, file); }

  // Heights of 0 .. 44 stored, in UTM.
  TestRaster Slope() const {
    TestRaster raster;
    raster.system = "EPSG:32633";
    raster.stored = [](int column, int row) { return 2.0 * column + 3.0 * row; };
    return raster;
  }

  // Turns bytes of a file into others.
  void Patch(const std::string& name, const std::string& from, const std::string& to) const {
    std::ifstream file(folder.Path(name), std::ios::binary);
    std::string bytes{std::istreambuf_iterator<char>(file), {}};
    const auto at = bytes.find(from);
    ASSERT_NE(at, std::string::npos);
    folder.Write(name, bytes.replace(at, to.size(), to));
  }

  // A GeoTIFF's key: its number, where it is (here), how many, its value.
  static std::string Key(int number, int value) { return Shorts({number, 0, 1, value}); }
  static std::string Shorts(const std::vector<int>& numbers) {
    std::string bytes;
    for (const int number : numbers) {
      bytes += static_cast<char>(number & 0xff);
      bytes += static_cast<char>(number >> 8);
    }
    return bytes;
  }

  const TestFolder folder;
};

const std::string kFeet =
    "<PAMDataset><PAMRasterBand band=\"1\"><UnitType>ft</UnitType></PAMRasterBand></PAMDataset>\n";

TEST_F(RasterReadingTest, AnAuxXmlThatIsNotUnderstoodIsRefused) {
  WriteRaster(folder.Path("g.tif"), Slope());
  EXPECT_EQ(Height(), "44.00");
  folder.Write("g.tif.aux.xml", kFeet);
  EXPECT_EQ(Height(), fmt::format("{:.2f}", 44.0 * kFootM));
  for (const std::string& text :
       {std::string(), kFeet.substr(0, 60), std::string(100, '\0'), std::string("\xFF\xFE<\0P\0A\0M\0", 10),
        "<?xml version=\"1.0\"?>" + kFeet}) {
    folder.Write("g.tif.aux.xml", text);
    EXPECT_EQ(
        Height(),
        "'g.tif': beside it stands g.tif.aux.xml, which is not understood; allowed: XML that begins with "
        "<PAMDataset>, whole; mend it, or take it away");
  }
  std::filesystem::remove(folder.Path("g.tif.aux.xml"));
  folder.Write("g.tif.AUX.XML", kFeet);
  EXPECT_EQ(
      Height(),
      "'g.tif': beside it stands g.tif.AUX.XML, which is not read under that name; call it g.tif.aux.xml");
}

TEST_F(RasterReadingTest, AMaskThatCannotBeReadIsRefused) {
  TestRaster mask;
  mask.type = GDT_Byte;
  mask.stored = [](int column, int row) { return column == 5 && row == 4 ? 0.0 : 255.0; };
  WriteRaster(folder.Path("g.tif"), Slope());
  const auto write_mask = [&](bool is_mask) {
    WriteRaster(folder.Path("g.tif.msk"), mask);
    if (!is_mask) return;
    auto* dataset = GDALDataset::Open(folder.Path("g.tif.msk").c_str(), GDAL_OF_UPDATE);
    ASSERT_NE(dataset, nullptr);
    dataset->SetMetadataItem("INTERNAL_MASK_FLAGS_1", "2");
    GDALClose(dataset);
  };
  write_mask(true);
  const std::string hole = "'g.tif': 1 of the 99 cells that the area needs have no data (NODATA or masked)";
  EXPECT_EQ(Height().substr(0, hole.size()), hole);
  const std::string refusal =
      "'g.tif': beside it stands g.tif.msk, which is no mask that can be read; allowed: a GeoTIFF as GDAL "
      "writes "
      "masks; mend it, or take it away";
  std::filesystem::resize_file(folder.Path("g.tif.msk"), 100);
  EXPECT_EQ(Height(), refusal);
  folder.Write("g.tif.msk", "");
  EXPECT_EQ(Height(), refusal);
  folder.Write("g.tif.msk", "no mask");
  EXPECT_EQ(Height(), refusal);
  std::filesystem::remove(folder.Path("g.tif.msk"));
  write_mask(false);
  EXPECT_EQ(Height(), refusal);
  mask.columns = 12;
  write_mask(true);
  EXPECT_EQ(Height(), "'g.tif': its mask has 12 x 9 cells; allowed: as many as its heights, 11 x 9");
}

TEST_F(RasterReadingTest, ACutTagIsRefused) {
  TestRaster raster = Slope();
  raster.scale = 0.5;
  WriteRaster(folder.Path("g.tif"), raster);
  EXPECT_EQ(Height(), "22.00");
  Patch("g.tif", "</GDALMetadata>", "</GDALMetabata>");
  const std::string text = Height();
  EXPECT_TRUE(text.starts_with("'g.tif': not read as it stands (")) << text;
  EXPECT_TRUE(text.ends_with("); mend the file (gdalinfo shows more), or write it anew (gdal_translate)"))
      << text;
}

// Each of them changed heights.
TEST_F(RasterReadingTest, GdalsEnvironmentChangesNothing) {
  TestRaster raster = Slope();
  WriteRaster(folder.Path("g.tif"), raster);
  folder.Write("g.tif.aux.xml", kFeet);
  folder.WriteGrid("g.asc", 12, 10, 10.0, [](int column, int row) { return 1.25 * column + row; });
  for (const auto& [name, value] :
       std::vector<std::pair<std::string, std::string>>{{"GDAL_PAM_ENABLED", "NO"},
                                                        {"GDAL_DISABLE_READDIR_ON_OPEN", "EMPTY_DIR"},
                                                        {"AAIGRID_DATATYPE", "Int32"},
                                                        {"GTIFF_IGNORE_READ_ERRORS", "YES"},
                                                        {"GDAL_GEOREF_SOURCES", "NONE"},
                                                        {"CPL_DEBUG", "ON"},
                                                        {"CPL_DEBUG", "OFF"},
                                                        {"CPL_DEBUG", ""},
                                                        {"GTIFF_HONOUR_NEGATIVE_SCALEY", "YES"}}) {
    SCOPED_TRACE(name);
    setenv(name.c_str(), value.c_str(), 1);
    EXPECT_EQ(Height(), fmt::format("{:.2f}", 44.0 * kFootM));
    EXPECT_EQ(Height("g.asc"), "20.50");
    unsetenv(name.c_str());
  }
}

TEST_F(RasterReadingTest, ACoordinateSystemThatIsNotKnownIsRefused) {
  WriteRaster(folder.Path("g.tif"), Slope());
  folder.Write("g.tif.aux.xml", "<PAMDataset><SRS>EPSG:30000</SRS></PAMDataset>");
  EXPECT_EQ(Height(),
            "'g.tif': not read as it stands (PROJ: proj_create_from_database: crs not found); mend the file "
            "(gdalinfo "
            "shows more), or write it anew (gdal_translate)");
  std::filesystem::remove(folder.Path("g.tif.aux.xml"));
  Patch("g.tif", Key(3072, 32633), Key(3072, 30000));
  EXPECT_TRUE(
      Height().starts_with("'g.tif': not read as it stands (PROJ: proj_create_from_database: crs not found)"))
      << Height();
}

// Was read as metres.
TEST_F(RasterReadingTest, TheUnitOfAnUnknownSystemCounts) {
  WriteRaster(folder.Path("g.tif"), Slope());
  Patch("g.tif", Key(3072, 32633), Key(3072, 32767));
  EXPECT_EQ(Height(), "44.00");
  for (const auto& [code, unit] :
       {std::pair(9002, "ft"), std::pair(9003, "us-ft"), std::pair(9005, "EPSG unit 9005")}) {
    WriteRaster(folder.Path("g.tif"), Slope());
    Patch("g.tif", Key(3072, 32633), Key(3072, 32767));
    Patch("g.tif", Key(3076, 9001), Key(3076, code));
    EXPECT_EQ(Height(),
              fmt::format("'g.tif': its lengths are in {} by its key ProjLinearUnits, and in m by its "
                          "coordinate system; give it one that is known (gdal_edit.py -a_srs EPSG:NUMBER)",
                          unit));
  }
}

TEST_F(RasterReadingTest, AnAuxXmlMayNotContradictTheLengthsOfAGeoTiff) {
  WriteRaster(folder.Path("g.tif"), Slope());
  Patch("g.tif", Key(3076, 9001), Key(5000, 9001));  // as if it were not there
  folder.Write("g.tif.aux.xml", "<PAMDataset><SRS>EPSG:26910</SRS></PAMDataset>");
  EXPECT_EQ(Height(), "44.00");
  folder.Write("g.tif.aux.xml", "<PAMDataset><SRS>EPSG:2263</SRS></PAMDataset>");
  EXPECT_EQ(Height(),
            "'g.tif': its lengths are in m by its coordinate system, and in us-ft by the .aux.xml beside it; "
            "correct the one that is wrong, or take it away");
}

TEST_F(RasterReadingTest, TheUnitOfHeightsBesideAVerticalSystemCounts) {
  OGRSpatialReference utm;
  utm.importFromEPSG(32633);
  char* text = nullptr;
  utm.exportToWkt(&text);
  TestRaster raster = Slope();
  raster.system = fmt::format(
      "COMPD_CS[\"both\",{},VERT_CS[\"height\",VERT_DATUM[\"North American Vertical Datum 1988\",2005],"
      "UNIT[\"US survey foot\",0.304800609601219,AUTHORITY[\"EPSG\",\"9003\"]],AXIS[\"Up\",UP]]]",
      text);
  CPLFree(text);
  WriteRaster(folder.Path("g.tif"), raster);
  EXPECT_EQ(Height(), fmt::format("{:.2f}", 44.0 * 1200.0 / 3937.0));
  Patch("g.tif", Shorts({4097, 34737, 7, 5}), Key(4096, 5703));  // in metres by itself
  EXPECT_EQ(Height(),
            "'g.tif': its heights are in m here and in us-ft there (unit of the band, vertical system, key "
            "VerticalUnits, .prj); correct the one that is wrong");
}

// Was refused: "EPSG unit 9036" is the kilometre.
TEST_F(RasterReadingTest, LengthsInKilometresAgreeWithTheirKey) {
  TestRaster raster = Slope();
  raster.system = "+proj=utm +zone=33 +datum=WGS84 +units=km";
  raster.cell = 0.01;
  raster.west = 500.0;
  raster.south = 4000.0;
  raster.unit = "m";
  WriteRaster(folder.Path("g.tif"), raster);
  Patch("g.tif", Key(3076, 9036), Key(3076, 9036));
  EXPECT_EQ(Height(), "44.00");
}

TEST_F(RasterReadingTest, AWorldFileMustHaveTheCellsOfTheRaster) {
  WriteRaster(folder.Path("g.tif"), Slope());
  folder.Write("g.tfw", "10\n0\n0\n-10\n500005\n4000085\n");
  EXPECT_EQ(Height(), "44.00");
  folder.Write("g.tfw", "30\n0\n0\n-30\n500015\n4000255\n");
  EXPECT_EQ(Height(),
            "'g.tif': its cells are 10 x 10, and 30 x 30 by the .tfw beside it; correct it, or take it away");
}

// Were ground at 0 m.
TEST_F(RasterReadingTest, BlocksThatASparseGeoTiffLacksAreHoles) {
  TestRaster raster = Slope();
  raster.stored = [](int column, int row) { return row < 3 ? 0.0 : 5.0 + column; };
  WriteRaster(folder.Path("full.tif"), raster);
  EXPECT_EQ(Height("full.tif"), "16.08");  // 15, and the dip of a curve that comes from 0
  GDALDataset* full = GDALDataset::Open(folder.Path("full.tif").c_str());
  const char* const options[] = {"SPARSE_OK=TRUE", "TILED=YES", "BLOCKXSIZE=16", "BLOCKYSIZE=16", nullptr};
  const char* const strips[] = {"SPARSE_OK=TRUE", "BLOCKYSIZE=3", nullptr};
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GTiff");
  for (const auto* how : {options, strips})
    GDALClose(driver->CreateCopy(folder.Path(how == strips ? "g.tif" : "tiled.tif").c_str(), full, FALSE,
                                 const_cast<char**>(how), nullptr, nullptr));
  GDALClose(full);
  EXPECT_EQ(Height("tiled.tif"), "16.08");
  EXPECT_EQ(
      Height(),
      "'g.tif': 33 of the 99 cells that the area needs have no data (NODATA), the first at [0, 0] m from "
      "the south-west cell; move or shrink offset_m and extent_m");
}

TEST_F(RasterReadingTest, HeightsOfEightBitsMayHaveASign) {
  TestRaster raster = Slope();
  raster.type = GDT_Byte;
  raster.stored = [](int column, int row) {
    return column + row < 9 ? 256 - 9 + column + row : column + row - 9;
  };
  WriteRaster(folder.Path("g.tif"), raster);
  Patch("g.tif", Shorts({339, 3, 1, 0, 1}), Shorts({339, 3, 1, 0, 2}));
  EXPECT_EQ(Height(), "18.00");  // from -9 to 9
}

TEST_F(RasterReadingTest, ATextGridsHeaderSaysEachThingOnce) {
  const auto says = [&](const std::string& header, const std::string& first) {
    std::string grid = "ncols 12\nnrows 10\n" + header + "xllcorner 0\nyllcorner 0\n" + first;
    for (int i = 1; i < 120; ++i) grid += fmt::format(" {}", i % 12);
    folder.Write("g.asc", grid + "\n");
    return Height("g.asc");
  };
  EXPECT_EQ(says("cellsize 10\n", "0"), "10.00");
  EXPECT_EQ(says("cellsize 10\nCELLSIZE 30\n", "0"),
            "'g.asc': line 4: 'CELLSIZE' is there twice; leave one out");
  EXPECT_EQ(says("dx 10\ndy 10\ncellsize 30\n", "0"),
            "'g.asc': line 5: 'cellsize' beside 'dx' or 'dy'; leave one out");
  EXPECT_EQ(says("", "0\ncellsize 10\n"),
            "'g.asc': line 6: 'cellsize' stands below heights; put it above them");
  EXPECT_EQ(says("cellsize 10\n", "4294967298"), "10.00");  // in no cell that the area needs
  std::string text = "ncols 4294967308\nnrows 10\nxllcorner 0\nyllcorner 0\ncellsize 10\n0";
  for (int i = 1; i < 120; ++i) text += fmt::format(" {}", i % 12);
  folder.Write("g.asc", text + "\n");
  EXPECT_EQ(Height("g.asc"), "'g.asc': line 1: ncols is '4294967308'; allowed: a whole number of 32 bits");
}

// GDAL begins the heights at the first line that begins with no letter: all rows were shifted.
TEST_F(RasterReadingTest, ATextGridsHeightsBeginBehindItsHeader) {
  const auto says = [&](const std::string& header, const std::string& first, const std::string& format) {
    std::string grid = header + first;
    for (int i = 1; i < 120; ++i) {
      const int column = i % 12, row = 9 - i / 12;
      grid += (column == 0 ? "\n" : " ") + fmt::format(fmt::runtime(format), 2.0 * column + 3.0 * row);
    }
    folder.Write("g.asc", grid + "\n");
    return Height("g.asc");
  };
  const std::string counts = "ncols 12\nnrows 10\n", corner = "xllcorner 0\nyllcorner 0\n";
  const std::string header = counts + corner + "cellsize 10\nNODATA_value nan\n";
  for (const std::string format : {"{:.0f}", "{:.1f}"}) {
    EXPECT_EQ(says(header, "27", format), "44.00");
    EXPECT_EQ(says(header, "nan", format), "44.00");
    EXPECT_EQ(says("ncols 12\n nrows 10\n" + corner + "cellsize 10\n", "27", format), "44.00");
    EXPECT_EQ(says(counts + corner + "cellsize\n10\n", "27", format), "44.00");
    EXPECT_EQ(says(counts + corner + "cellsize 10 ", "27", format), "44.00");
  }
  EXPECT_EQ(
      says(header, "nan", fmt::format("{{:{}.1f}}", 120)),
      "'g.asc': not readable as an ESRI ASCII grid or a GeoTIFF (g.asc: Couldn't find data values in ASCII "
      "Grid "
      "file.); write a number where its heights begin, and no letter: NODATA_value -9999, and -9999 for "
      "nan");
}

// GDAL makes 0 of them.
TEST_F(RasterReadingTest, ATextGridsWordsAreNoHeightOf0) {
  const auto says = [&](const std::string& one, const std::string& others) {
    std::string grid = "ncols 12\nnrows 10\nxllcorner 0\nyllcorner 0\ncellsize 10\nNODATA_value nan\n";
    for (int i = 0; i < 120; ++i) grid += (i == 63 ? one : others) + (i % 12 == 11 ? "\n" : " ");
    folder.Write("g.asc", grid);
    return Height("g.asc");
  };
  for (const std::string others : {"20", "20.5"}) {
    EXPECT_EQ(
        says("nan", others),
        "'g.asc': 1 of the 99 cells that the area needs have no data (NODATA), the first at [30, 40] m from "
        "the south-west cell; move or shrink offset_m and extent_m");
    EXPECT_EQ(says("+-12", others), "'g.asc': line 12: '+-12' is no number");
    EXPECT_EQ(says("+12", others), others == "20" ? "8.00" : "8.50");
  }
}

// Where one number divides the other, exchanged ones passed; lines that are no rows were refused.
TEST_F(RasterReadingTest, ATextGridsLinesNeedNotBeItsRows) {
  const auto says = [&](int ncols, int nrows, int in_line) {
    std::string grid =
        fmt::format("ncols {}\nnrows {}\nxllcorner 0\nyllcorner 0\ncellsize 10\n", ncols, nrows);
    for (int i = 0; i < ncols * nrows; ++i)
      grid += fmt::format("{}{}", 2 * (i % ncols) + 3 * (nrows - 1 - i / ncols),
                          i % in_line == in_line - 1 ? "\n" : " ");
    folder.Write("g.asc", grid);
    return Height("g.asc");
  };
  EXPECT_EQ(
      says(24, 12, 12),
      "'g.asc': 24 lines of 12 heights each, but its header says ncols 24 and nrows 12; exchange the two, "
      "or bring the lines to 24 heights");
  EXPECT_EQ(says(12, 24, 12), "44.00");
  for (const int in_line : {1, 10, 15, 30, 300}) EXPECT_EQ(says(12, 25, in_line), "44.00") << in_line;
}

// Was passed over without a word. The heights may be unpacked, so that it is no fault.
TEST_F(RasterReadingTest, ScaleAndOffsetInTheMetadataAreSaid) {
  const auto notes = [&](const TestRaster& raster, const std::string& scale, const std::string& offset) {
    WriteRaster(folder.Path("g.tif"), raster);
    GDALDataset* dataset = GDALDataset::Open(folder.Path("g.tif").c_str(), GDAL_OF_UPDATE);
    dataset->GetRasterBand(1)->SetMetadataItem("scale_factor", scale.c_str());
    dataset->GetRasterBand(1)->SetMetadataItem("add_offset", offset.c_str());
    GDALClose(dataset);
    return Scene::Load(folder.Write("w.yaml", GridWorld("    file: g.tif\n")))->Notes();
  };
  using Notes = std::vector<std::string>;
  EXPECT_EQ(notes(Slope(), "0.1", "5"),
            Notes{"elevation grid: scale_factor 0.1 in its metadata is not applied, add_offset 5 in its "
                  "metadata is not applied"});
  EXPECT_EQ(Height(), "44.00");
  EXPECT_EQ(notes(Slope(), "1", "0"), Notes{});
  TestRaster packed = Slope();
  packed.scale = static_cast<double>(0.1f);
  packed.offset = 5.0;
  EXPECT_EQ(notes(packed, "0.1", "5"), Notes{"elevation grid: heights are 0.1 times what is stored, and 5"});
}

// Each was read, a million numbers of each: for minutes. libtiff takes the first.
TEST_F(RasterReadingTest, OfATagThatIsThereTwiceTheFirstCounts) {
  WriteRaster(folder.Path("g.tif"), Slope());
  std::string tiff = ReadFile(folder.Path("g.tif"), 1 << 20), tags;
  const auto number = [&](std::size_t at, int bytes) {
    std::size_t value = 0;
    for (int i = bytes; i-- > 0;)
      value = value << 8 | static_cast<unsigned char>(tiff[at + static_cast<std::size_t>(i)]);
    return value;
  };
  const std::size_t directory = number(4, 4), end = tiff.size();
  int count = 0;
  for (std::size_t i = 0; i < number(directory, 2); ++i) {
    const std::string tag = tiff.substr(directory + 2 + 12 * i, 12);
    const auto name = static_cast<int>(number(directory + 2 + 12 * i, 2));
    const bool of_blocks = name == 273 || name == 279;
    tags += tag;
    for (int again = 0; again < (of_blocks ? 500 : 0); ++again) tags += Shorts({name, 4, 0, 16, 8, 0});
    count += of_blocks ? 501 : 1;
  }
  tiff.replace(4, 4, Shorts({static_cast<int>(end), 0}));
  folder.Write("g.tif", tiff + Shorts({count}) + tags + Shorts({0, 0}));
  EXPECT_EQ(Height(), "44.00");
}

// The first page was taken, without a word.
TEST_F(RasterReadingTest, ATiffHasOnePage) {
  WriteRaster(folder.Path("g.tif"), Slope());
  GDALDataset* one = GDALDataset::Open(folder.Path("g.tif").c_str(), GDAL_OF_UPDATE);
  const int overview = 2;
  ASSERT_EQ(one->BuildOverviews("AVERAGE", 1, &overview, 0, nullptr, nullptr, nullptr), CE_None);
  GDALClose(one);
  EXPECT_EQ(Height(), "44.00");
  one = GDALDataset::Open(folder.Path("g.tif").c_str());
  const char* const append[] = {"APPEND_SUBDATASET=YES", nullptr};
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GTiff");
  WriteRaster(folder.Path("pages.tif"), Slope());
  GDALClose(driver->CreateCopy(folder.Path("pages.tif").c_str(), one, FALSE, const_cast<char**>(append),
                               nullptr, nullptr));
  GDALClose(one);
  EXPECT_EQ(Height("pages.tif"),
            "'pages.tif': 2 pages; an elevation grid has one: take one out (gdal_translate "
            "GTIFF_DIR:1:'pages.tif' one.tif)");
}

}  // namespace
}  // namespace ed3r::world
