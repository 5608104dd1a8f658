// Bad input: each broken world, grid and stem map with its whole message.
#include <cpl_vsi.h>
#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <string>
#include <vector>

#include "engine/core/check.h"
#include "engine/world/scene.h"
#include "tests/world/world_files.h"

namespace ed3r::world {
namespace {

constexpr const char* kWorld = R"(name: small
size_m: [100, 80, 165]
terrain:
  generated:
    hills_height_m: 20
    ridges:
      - {crest_m: [[0, 40], [100, 40]], height_m: 30, half_width_m: 20}
forest:
  generated:
    spacing_m: 8
sites:
  - {name: a, at_m: [20, 20]}
  - {name: b, at_m: [80, 20, 60]}
base_stations:
  - {name: mast, at_m: [60, 60]}
start: {at_m: [50, 40], radius_m: 5, height_m: [20, 40]}
)";

class BrokenFiles : public ::testing::Test {
 protected:
  // What Load says, with the test's folder cut away.
  std::string Message(const std::string& world) const { return MessageOfFile(folder.Write("w.yaml", world)); }

  std::string MessageOfFile(const std::string& path) const {
    try {
      Scene::Load(path);
    } catch (const UserError& error) {
      std::string text = error.what();
      const std::string prefix = folder.Path("");
      for (auto at = text.find(prefix); at != std::string::npos; at = text.find(prefix))
        text.erase(at, prefix.size());
      return text;
    }
    return "no error";
  }

  // The small world with one passage replaced.
  static std::string With(const std::string& passage, const std::string& replacement) {
    std::string world = kWorld;
    const auto at = world.find(passage);
    EXPECT_NE(at, std::string::npos) << passage;
    return world.replace(at, passage.size(), replacement);
  }

  std::string GridMessage(const std::string& grid_keys) const { return Message(GridWorld(grid_keys)); }

  const TestFolder folder;
};

TEST_F(BrokenFiles, TheSmallWorldItselfIsFine) { EXPECT_EQ(Message(kWorld), "no error"); }

TEST_F(BrokenFiles, File) {
  EXPECT_EQ(MessageOfFile(folder.Path("none.yaml")), "none.yaml: cannot be read: No such file or directory");
  EXPECT_EQ(MessageOfFile(folder.Path("")), ": cannot be read: Is a directory");
  EXPECT_EQ(Message(""), "w.yaml:1:1: '' is not allowed; allowed: keys with values");
  EXPECT_EQ(Message("- a\n- b\n"), "w.yaml:1:1: '[...]' is not allowed; allowed: keys with values");
  EXPECT_EQ(Message(std::string(kWorld) + "---\nname: another\n"),
            "w.yaml:17:1: a second document is not allowed; a file holds one");
  EXPECT_EQ(Message("name: [a\nsize_m: 3\n"), "w.yaml:2:7: not valid YAML: end of sequence flow not found");
}

TEST_F(BrokenFiles, TextIsReadAsStrictlyAsASweepFile) {
  EXPECT_EQ(Message(With("name: small", "name: !!str small")),
            "w.yaml:1:7: tag 'tag:yaml.org,2002:str' is not allowed");
  EXPECT_EQ(Message(With("name: small", "name: &a small")),
            "w.yaml:1:7: anchors and aliases are not allowed; write the value out");
  EXPECT_EQ(Message(With("name: small", "name: |\n  two\n  lines")),
            "w.yaml:1:7: a value of several lines or with control characters is not allowed");
  EXPECT_EQ(Message(With("name: small", "name: sm\xe4ll")),
            "w.yaml:1:9: byte 0xe4 is not allowed; a YAML file is UTF-8 text");
  std::string utf16 = "\xff\xfe";
  for (const char* c = kWorld; *c != '\0'; ++c) utf16 += {*c, '\0'};
  EXPECT_EQ(Message(utf16), "w.yaml:1:1: byte 0xff is not allowed; a YAML file is UTF-8 text");
  EXPECT_EQ(Message(With("name: small", "name: " + std::string(2'000'000, 'x'))),
            "w.yaml: is too long; allowed: at most 1048576 bytes");
  ASSERT_EQ(mkfifo(folder.Path("pipe.yaml").c_str(), 0600), 0);
  EXPECT_EQ(MessageOfFile(folder.Path("pipe.yaml")), "pipe.yaml: cannot be read: a FIFO, not a file");
}

TEST_F(BrokenFiles, Keys) {
  EXPECT_EQ(Message(With("forest:", "forrest:")), "w.yaml:8:1: forrest: unknown key; did you mean forest?");
  EXPECT_EQ(Message(With("half_width_m", "half_with_m")),
            "w.yaml:7:55: terrain.generated.ridges[1].half_with_m: unknown key; did you mean "
            "terrain.generated.ridges[1].half_width_m?");
  EXPECT_EQ(Message(With("spacing_m", "oak_share")),
            "w.yaml:10:5: forest.generated.oak_share: unknown key; known here: spacing_m, cover, "
            "clearing_size_m, height_m, crown_radius_m");
  EXPECT_EQ(Message(With("start:", "begin:")),
            "w.yaml:16:1: begin: unknown key; known here: base, name, seed, size_m, terrain, forest, sites, "
            "base_stations, start, fire");
  EXPECT_EQ(Message(With("name: small\n", "")), "w.yaml:1:1: name: is missing");
  EXPECT_EQ(Message(With("name: small", "name: small\nname: large")),
            "w.yaml:2:1: name: duplicate key; it stands first at w.yaml:1:1");
  EXPECT_EQ(Message(With("  generated:\n    hills", "  grid: {file: x.asc}\n  generated:\n    hills")),
            "w.yaml:4:9: terrain.grid: is not allowed together with terrain.generated");
  EXPECT_EQ(Message(With("  generated:\n    spacing_m: 8", "  slope_max: 1")),
            "w.yaml:9:3: forest.generated or stem_map: is missing");
}

TEST_F(BrokenFiles, Values) {
  EXPECT_EQ(Message(With("hills_height_m: 20", "hills_height_m: -3")),
            "w.yaml:5:21: terrain.generated.hills_height_m: '-3' is not allowed; allowed: 0 .. 500 m");
  EXPECT_EQ(Message(With("hills_height_m: 20", "hills_height_m: high")),
            "w.yaml:5:21: terrain.generated.hills_height_m: 'high' is not allowed; allowed: 0 .. 500 m");
  EXPECT_EQ(Message(With("hills_height_m: 20", "hills_height_m: nan")),
            "w.yaml:5:21: terrain.generated.hills_height_m: 'nan' is not allowed; allowed: 0 .. 500 m");
  EXPECT_EQ(Message(With("[100, 80, 165]", "[100, 80]")),
            "w.yaml:2:9: size_m: '[...]' is not allowed; allowed: a list of 3 numbers (here 2)");
  EXPECT_EQ(Message(With("[100, 80, 165]", "[100, 81, 165]")),
            "w.yaml:4:3: terrain.cell_m: 2 m does not divide the area of 100 x 81 m into whole cells");
  EXPECT_EQ(Message(With("[100, 80, 165]", "[100, 80, 20]")),
            "w.yaml:2:9: size_m: the ground rises to 30.9 m; allowed: below the area's height of 20 m (raise "
            "it or lower the terrain)");
  EXPECT_EQ(Message(With("[[0, 40], [100, 40]]", "[[0, 40], [100]]")),
            "w.yaml:7:29: terrain.generated.ridges[1].crest_m: '[...]' is not allowed; allowed: a list of 2 "
            "numbers (here 1)");
  EXPECT_EQ(Message(With("spacing_m: 8", "height_m: [20, 10]")),
            "w.yaml:10:15: forest.generated.height_m: [20, 10] is not allowed; the first must not exceed the "
            "second");
  EXPECT_EQ(Message(With("at_m: [20, 20]}", "at_m: [20, 20], known: yes}")),
            "w.yaml:12:38: sites[1].known: 'yes' is not allowed; allowed: true | false");
  EXPECT_EQ(Message(With("name: small", "seed: -1\nname: small")),
            "w.yaml:1:7: seed: '-1' is not allowed; allowed: 0 .. 18446744073709551615 (a whole number)");
  EXPECT_EQ(Message(With("{name: b,", "{name: a,")), "w.yaml:13:12: sites[2].name: 'a' is the name of two");
}

TEST_F(BrokenFiles, Places) {
  EXPECT_EQ(Message(With("[20, 20]", "[120, 20]")),
            "w.yaml:12:21: site 'a' at [120, 20] m lies outside the terrain; allowed: 0 .. 100 m east, 0 .. "
            "80 m north");
  EXPECT_EQ(Message(With("[80, 20, 60]", "[80, 20, 1]")),
            "w.yaml:13:21: site 'b' at 1 m is inside the ground; allowed there: 3.04 .. 165 m");
  EXPECT_EQ(Message(With("[80, 20, 60]", "[80, 20, 166]")),
            "w.yaml:13:21: site 'b' at 166 m is above the area; allowed there: 3.04 .. 165 m");
  EXPECT_EQ(Message(With("[60, 60]", "[60, -1]")),
            "w.yaml:15:24: base station 'mast' at [60, -1] m lies outside the terrain; allowed: 0 .. 100 m "
            "east, 0 .. 80 m north");
  EXPECT_EQ(Message(With("radius_m: 5", "radius_m: 41")),
            "w.yaml:16:15: start: a disc of 41 m around [50, 40] m leaves the area of 100 x 80 m");
  EXPECT_EQ(Message(With("[20, 40]}", "[20, 140]}")),
            "w.yaml:16:15: start: 140 m above ground of 29.1 m is above the area of 165 m height");
}

TEST_F(BrokenFiles, Grids) {
  const auto flat = [](int, int) { return 5.0; };
  folder.WriteGrid("small.asc", 8, 9, 10.0, flat);
  folder.WriteGrid("hole.asc", 11, 9, 10.0,
                   [](int column, int row) { return column == 4 && row >= 6 ? -9999.0 : 5.0; });
  folder.WriteGrid("steep.asc", 11, 9, 10.0, [](int column, int) { return 30.0 * column; });
  folder.Write("cut.asc", "ncols 11\nnrows 9\nxllcorner 0\nyllcorner 0\ncellsize 10\n1 2 3\n");
  folder.Write("text.asc", "this is no grid\n");
  EXPECT_EQ(GridMessage("    file: none.asc\n"),
            "w.yaml:6:11: terrain.grid.file: 'none.asc': cannot be read: No such file or directory");
  EXPECT_EQ(GridMessage("    file: text.asc\n"),
            "w.yaml:6:11: terrain.grid.file: 'text.asc': not readable as an ESRI ASCII grid or a GeoTIFF "
            "(`text.asc' not recognized as a supported file format.); a text grid must begin with 'ncols', "
            "without a byte order mark, blank or line before it");
  EXPECT_EQ(GridMessage("    file: cut.asc\n"),
            "w.yaml:6:11: terrain.grid.file: 'cut.asc': 3 heights, 3 a line, but its header says ncols 11 "
            "and nrows 9, "
            "which makes 99; correct the header, or bring the whole file");
  EXPECT_EQ(GridMessage("    file: small.asc\n"),
            "w.yaml:6:11: terrain.grid: 'small.asc' is too small: offset_m + extent_m = [100, 80] m; "
            "allowed: up to [70, 80] m (8 x 9 cells of 10 m)");
  EXPECT_EQ(GridMessage("    file: small.asc\n    offset_m: [10, 10]\n    extent_m: [50, 71]\n"),
            "w.yaml:8:15: terrain.grid: 'small.asc' is too small: offset_m + extent_m = [60, 81] m; allowed: "
            "up to [70, 80] m (8 x 9 cells of 10 m)");
  EXPECT_EQ(
      GridMessage("    file: hole.asc\n"),
      "w.yaml:6:11: terrain.grid.file: 'hole.asc': 3 of the 99 cells that the area needs have no data "
      "(NODATA), the first at [40, 60] m from the south-west cell; move or shrink offset_m and extent_m");
  EXPECT_EQ(GridMessage("    file: steep.asc\n"),
            "w.yaml:2:9: size_m: the ground rises to 300.0 m; allowed: below the area's height of 165 m "
            "(raise it or lower the terrain)");
  EXPECT_EQ(GridMessage("    height_scale: 2\n"), "w.yaml:6:5: terrain.grid.file: is missing");
}

// A cell as wide as many areas had no neighbour to go on from (endless recursion), and numbers that no float holds
// became flat ground.
TEST_F(BrokenFiles, GridsOfImpossibleNumbers) {
  const auto grid = [&](const std::string& cell, const std::string& height) {
    std::string text =
        "ncols 3\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize " + cell + "\nNODATA_value -9999\n";
    for (int row = 0; row < 3; ++row) text += height + " " + height + " " + height + "\n";
    folder.Write("g.asc", text);
    return GridMessage("    file: g.asc\n");
  };
  EXPECT_EQ(grid("1e12", "5"),
            "w.yaml:6:11: terrain.grid: 'g.asc' has cells of 1e+12 x 1e+12 m; allowed for an extent of [100, "
            "80] m: "
            "at least one a side, at most 6e+07 in all");
  EXPECT_EQ(grid("50", "5"), "no error");
  for (const char* height : {"inf", "-inf", "nan", "1e39", "1e300", "-32768", "deep", "1O", "1,5"})
    EXPECT_NE(grid("50", height), "no error") << height;
  EXPECT_EQ(
      grid("50", "9001"),
      "w.yaml:6:11: terrain.grid.file: 'g.asc': a height of 9001 m at [0, 0] m from the south-west cell; "
      "allowed, after height_scale: -12000 .. 9000 m");
  for (const char* cell : {"0", "-5", "nan", "inf", "1e-300"}) EXPECT_NE(grid(cell, "5"), "no error") << cell;
}

// As doubles, which a GeoTIFF may hold.
TEST_F(BrokenFiles, RasterOfHeightsThatNoFloatHolds) {
  Scene::Load(folder.Write("w.yaml", kWorld));  // registers GDAL's drivers
  GDALDataset* raster = GetGDALDriverManager()->GetDriverByName("GTiff")->Create(
      folder.Path("g.tif").c_str(), 12, 12, 1, GDT_Float64, nullptr);
  ASSERT_NE(raster, nullptr);
  double transform[] = {0, 10, 0, 120, 0, -10};
  raster->SetGeoTransform(transform);
  std::vector<double> heights(144, 1e39);
  ASSERT_EQ(
      raster->GetRasterBand(1)->RasterIO(GF_Write, 0, 0, 12, 12, heights.data(), 12, 12, GDT_Float64, 0, 0),
      CE_None);
  GDALClose(raster);
  EXPECT_EQ(
      GridMessage("    file: g.tif\n"),
      "w.yaml:6:11: terrain.grid.file: 'g.tif': a height of 1e+39 m at [0, 0] m from the south-west cell; "
      "allowed, after height_scale: -12000 .. 9000 m");
}

// Each missing row was looked for in all those before it, which took for ever.
TEST_F(BrokenFiles, AGridWithoutItsLastRows) {
  std::string text = "ncols 60\nnrows 60\nxllcorner 0\nyllcorner 0\ncellsize 10\n";
  for (int row = 0; row < 30; ++row) {
    for (int column = 0; column < 60; ++column) text += "1 ";
    text += "\n";
  }
  folder.Write("short.asc", text);
  EXPECT_EQ(GridMessage("    file: short.asc\n"),
            "w.yaml:6:11: terrain.grid.file: 'short.asc': 1800 heights, 60 a line, but its header says ncols "
            "60 and "
            "nrows 60, which makes 3600; correct the header, or bring the whole file");
}

TEST_F(BrokenFiles, GridsThatAreNoFiles) {
  ASSERT_EQ(mkfifo(folder.Path("pipe.asc").c_str(), 0600), 0);
  EXPECT_EQ(GridMessage("    file: pipe.asc\n"),
            "w.yaml:6:11: terrain.grid.file: 'pipe.asc': cannot be read: a FIFO, not a file");
  for (const char* path :
       {"/vsicurl/http://127.0.0.1:9/g.tif", "/vsistdin/", "/vsizip/g.zip/g.tif", "GTIFF_DIR:1:g.tif"})
    EXPECT_NE(GridMessage(std::string("    file: ") + path + "\n")
                  .find("cannot be read: No such file or directory"),
              std::string::npos)
        << path;
  folder.WriteGrid("g.asc", 11, 9, 10.0, [](int, int) { return 5.0; });
  ASSERT_EQ(mkfifo(folder.Path("g.prj").c_str(), 0600), 0);
  EXPECT_EQ(GridMessage("    file: g.asc\n"),
            "w.yaml:6:11: terrain.grid.file: 'g.asc': beside it stands g.prj, which is no file");
}

TEST_F(BrokenFiles, GdalOpensNoVirtualFiles) {
  Scene::Load(folder.Write("w.yaml", kWorld));
  folder.WriteGrid("g.asc", 11, 9, 10.0, [](int, int) { return 5.0; });
  GridMessage("    file: g.asc\n");
  EXPECT_EQ(VSIFOpenL("/vsicurl/http://127.0.0.1:9/x", "rb"), nullptr);
  EXPECT_EQ(VSIFOpenL("/vsistdin/", "rb"), nullptr);
  EXPECT_EQ(GetGDALDriverManager()->GetDriverCount(), 2);
}

TEST_F(BrokenFiles, StemMaps) {
  const auto message = [&](const std::string& csv, const std::string& more = "") {
    folder.Write("stems.csv", csv);
    return Message(With("  generated:\n    spacing_m: 8", "  stem_map: {file: stems.csv" + more + "}"));
  };
  const std::string header = "x_m,y_m,dbh_cm,height_m,crown_depth_m,crown_radius_m\n";
  const std::string rows = "0,0,20,15,8,2\n60,50,20,15,8,2\n";
  EXPECT_EQ(message(header + rows), "no error");
  EXPECT_EQ(message("# a comment\n" + header + rows), "no error");
  EXPECT_EQ(
      message("x_m,y_m,height_m\n1,2,3\n"),
      "stems.csv: no column for the diameter at breast height (dbh_cm | dbh_mm | dbh_m | dbh_in); name it in "
      "forest.stem_map.columns; or add 'estimate_missing: conifers' (or deciduous, mixed, tropical); "
      "columns: x_m, "
      "y_m, height_m");
  EXPECT_EQ(message(header + rows + "5,5,20,tall,8,2\n"),
            "stems.csv:4:8: height_m: 'tall' is not allowed; allowed: 0.5 .. 130 m");
  EXPECT_EQ(message(header + rows + "5,5,20,15,16,2\n"),
            "stems.csv:4:11: crown_depth_m: '16' is not allowed; allowed: 0.1 .. 15 m");
  EXPECT_EQ(message(header + rows + "5,5,20,15\n"),
            "stems.csv:4:10: 4 cells, but the header names 6 columns");
  EXPECT_EQ(message(header), "stems.csv: no trees in this stem map");
  EXPECT_EQ(message("x_m,y_m,dbh_cm,height_m,crown_depth_m,crown_radius_m,height_m\n0,0,20,15,8,2,3\n"),
            "stems.csv:1:54: column 'height_m' is there twice");
  EXPECT_EQ(message(header + "0,0,20,15,8,2\n3,50,20,15,8,2\n"),
            "stems.csv: the stand measures 3 x 50 m; allowed: at least 10 m a side");
  EXPECT_EQ(message(header + rows, ", extent_m: [61, 50]"),
            "w.yaml:9:20: forest.stem_map: 'stems.csv' is too small: offset_m + extent_m = [61, 50] m; the "
            "stand measures [60, 50] m");
  EXPECT_EQ(message(header + rows, ", offset_m: [10, 10], extent_m: [20, 20]"),
            "w.yaml:9:20: forest.stem_map: no tree of 'stems.csv' stands within offset_m and extent_m");
}

}  // namespace
}  // namespace ed3r::world
