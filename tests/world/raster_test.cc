// What a raster says of its units, scale, masks and projection is applied, or refused with the command that mends it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "engine/core/check.h"
#include "engine/world/scene.h"
#include "engine/world/terrain.h"
#include "tests/world/test_rasters.h"
#include "tests/world/world_files.h"

namespace ed3r::world {
namespace {

constexpr double kFootM = 0.3048, kSurveyFootM = 1200.0 / 3937.0;

class RasterTest : public ::testing::Test {
 protected:
  std::shared_ptr<const Scene> Load(const std::string& keys) const {
    return Scene::Load(folder.Write("w.yaml", GridWorld(keys)));
  }
  std::shared_ptr<const Scene> Load(const TestRaster& raster, const std::string& more = "") const {
    WriteRaster(folder.Path("g.tif"), raster);
    return Load("    file: g.tif\n" + more);
  }

  std::string Message(const std::string& keys) const {
    try {
      Load(keys);
    } catch (const UserError& error) {
      std::string text = error.what();
      const std::string prefix = folder.Path("");
      for (auto at = text.find(prefix); at != std::string::npos; at = text.find(prefix))
        text.erase(at, prefix.size());
      const std::string begin = "w.yaml:6:11: terrain.grid.file: ";
      return text.starts_with(begin) ? text.substr(begin.size()) : text;
    }
    return "no error";
  }
  std::string Message(const TestRaster& raster, const std::string& more = "") const {
    WriteRaster(folder.Path("g.tif"), raster);
    return Message("    file: g.tif\n" + more);
  }

  const TestFolder folder;
};

double Slope(int column, int row) { return 2.0 * column + 3.0 * row; }

// A slope of 2 and 3 in the raster's unit of height a cell, over cells of so many metres.
void ExpectSlope(const Scene& scene, double cell_m, double height_m) {
  for (const double x : {0.0, 40.0, 100.0})
    for (const double y : {0.0, 40.0, 80.0})
      EXPECT_NEAR(scene.Ground().HeightAt(x, y), height_m * (2.0 * x + 3.0 * y) / cell_m, 2e-3)
          << x << " " << y;
}

// New York's state plane, in US survey feet: was read as metres.
TestRaster NewYork() {
  TestRaster raster;
  raster.system = "EPSG:2263";
  raster.cell = 30.0;
  raster.west = 980000.0;
  raster.south = 200000.0;
  raster.columns = raster.rows = 40;
  raster.stored = Slope;
  return raster;
}

TEST_F(RasterTest, LengthsInFeetBecomeMetres) {
  const auto scene = Load(NewYork(), "    height_unit: m\n");
  ExpectSlope(*scene, 30.0 * kSurveyFootM, 1.0);
  EXPECT_EQ(scene->Notes(), std::vector<std::string>{"elevation grid: lengths in us-ft"});
  // 39 cells of 30 ft are 356.6 m, not 1170 m.
  EXPECT_EQ(
      Message(NewYork(), "    height_unit: m\n    offset_m: [300, 0]\n"),
      "w.yaml:8:15: terrain.grid: 'g.tif' is too small: offset_m + extent_m = [400, 80] m; allowed: up to "
      "[356.617, 356.617] m (40 x 40 cells of 9.14402 m)");
}

TEST_F(RasterTest, HeightsInFeetBecomeMetres) {
  TestRaster raster = NewYork();
  raster.unit = "US survey foot";
  ExpectSlope(*Load(raster), 30.0 * kSurveyFootM, kSurveyFootM);
  raster.unit = "ft";
  ExpectSlope(*Load(raster), 30.0 * kSurveyFootM, kFootM);
  raster.system = "EPSG:32618";
  raster.west = 580000.0;
  raster.south = 4500000.0;
  ExpectSlope(*Load(raster), 30.0, kFootM);
  raster.unit = "metre";
  ExpectSlope(*Load(raster), 30.0, 1.0);
}

TEST_F(RasterTest, AVerticalCoordinateSystemTellsTheUnitOfHeights) {
  TestRaster raster = NewYork();
  raster.system = "EPSG:2263+6360";  // NAVD88 height (ftUS)
  const auto scene = Load(raster);
  ExpectSlope(*scene, 30.0 * kSurveyFootM, kSurveyFootM);
  EXPECT_EQ(scene->Notes(), std::vector<std::string>{"elevation grid: lengths in us-ft, heights in us-ft"});
  raster.system = "EPSG:2263+5703";  // NAVD88 height
  ExpectSlope(*Load(raster), 30.0 * kSurveyFootM, 1.0);
}

TEST_F(RasterTest, NobodyGuessesTheUnitOfHeights) {
  EXPECT_EQ(Message(NewYork()),
            "'g.tif': its lengths are in us-ft, and nothing tells the unit of its heights; add 'height_unit: "
            "us-ft' or "
            "'height_unit: m' to terrain.grid");
  TestRaster raster = NewYork();
  raster.unit = "fathoms";
  EXPECT_EQ(Message(raster),
            "'g.tif': its heights are in 'fathoms', which is unknown; add 'height_unit: m' (or m | ft | "
            "us-ft | dm | cm | "
            "mm | km) to terrain.grid");
  raster.unit = "m";
  EXPECT_EQ(Message(raster, "    height_unit: ft\n"),
            "'g.tif': its heights are in m, terrain.grid.height_unit says ft; leave height_unit out");
  raster.system = "EPSG:2263+6360";
  EXPECT_EQ(Message(raster),
            "'g.tif': its heights are in m here and in us-ft there (unit of the band, vertical system, key "
            "VerticalUnits, .prj); correct the one that is wrong");
  EXPECT_EQ(Message(NewYork(), "    height_unit: yards\n"),
            "w.yaml:7:18: terrain.grid.height_unit: 'yards' is not allowed; allowed: m | ft | us-ft | dm | "
            "cm | mm | km");
}

TEST_F(RasterTest, WithoutACoordinateSystemTheWorldFileTells) {
  TestRaster raster = NewYork();
  raster.system = "";
  ExpectSlope(*Load(raster), 30.0, 1.0);
  ExpectSlope(*Load(raster, "    length_unit: ft\n    height_unit: ft\n"), 30.0 * kFootM, kFootM);
  EXPECT_EQ(
      Message(raster, "    length_unit: ft\n"),
      "'g.tif': its lengths are in ft, and nothing tells the unit of its heights; add 'height_unit: ft' or "
      "'height_unit: m' to terrain.grid");
}

// Integers with a scale of 0.1 and an offset of 100 were read as they are stored.
TEST_F(RasterTest, ScaleAndOffsetAreApplied) {
  TestRaster raster;
  raster.type = GDT_Int16;
  raster.scale = 0.1;
  raster.offset = 100.0;
  raster.stored = [](int column, int row) { return 20.0 * column + 30.0 * row; };
  const auto scene = Load(raster);
  ExpectSlope(*scene, 10.0, 1.0);
  EXPECT_EQ(scene->Notes(),
            std::vector<std::string>{"elevation grid: heights are 0.1 times what is stored, and 100"});
  raster.unit = "ft";
  ExpectSlope(*Load(raster), 10.0, kFootM);
  raster.scale = 0.0;
  EXPECT_EQ(
      Message(raster),
      "'g.tif': its heights are 0 times the stored number and 100; allowed: a finite scale other than 0");
}

// A masked cell was a cliff to whatever number lies under the mask.
TEST_F(RasterTest, MaskedCellsAreHoles) {
  TestRaster raster;
  raster.stored = [](int column, int row) { return column == 5 && row == 4 ? -300.0 : 44.0; };
  raster.masked = [](int column, int row) { return column == 5 && row == 4; };
  EXPECT_EQ(Message(raster),
            "'g.tif': 1 of the 99 cells that the area needs have no data (NODATA or masked), the first at "
            "[50, 40] m from "
            "the south-west cell; move or shrink offset_m and extent_m");
  EXPECT_EQ(Message(raster, "    extent_m: [40, 40]\n"), "no error");
  raster.transparent = raster.masked;
  raster.masked = nullptr;
  EXPECT_NE(Message(raster).find("1 of the 99 cells that the area needs have no data"), std::string::npos)
      << Message(raster);
}

TEST_F(RasterTest, MarksThatAreNotDeclaredAreNamedAsHoles) {
  TestRaster raster;
  for (const double mark : {-32768.0, -9999.0, -3.4028234663852886e38}) {
    raster.stored = [mark](int column, int row) { return column == 5 && row == 4 ? mark : 44.0; };
    raster.no_data.reset();
    const std::string text = Message(raster);
    EXPECT_TRUE(text.starts_with("'g.tif': 1 of the 99 cells that the area needs are -")) << text;
    EXPECT_NE(
        text.find(
            "the first at [50, 40] m from the south-west cell: holes that it does not declare; declare them "
            "(gdal_translate -a_nodata -"),
        std::string::npos)
        << text;
    raster.no_data = mark;
    EXPECT_NE(Message(raster).find("have no data (NODATA)"), std::string::npos) << Message(raster);
  }
  raster.no_data.reset();
  raster.type = GDT_UInt16;
  raster.scale = 0.01;
  raster.stored = [](int column, int row) { return column == 5 && row == 4 ? 65535.0 : 4400.0; };
  EXPECT_NE(Message(raster).find("are 65535, the first at"), std::string::npos) << Message(raster);
}

// What gdalwarp leaves in the corners of a turned grid that declares no NODATA.
TEST_F(RasterTest, ZerosFarBelowAllElseAreHoles) {
  TestRaster raster;
  raster.stored = [](int column, int row) { return column + row < 3 ? 0.0 : 344.0 + column; };
  EXPECT_EQ(
      Message(raster),
      "'g.tif': 6 of the 99 cells that the area needs are 0, the first at [0, 0] m from the south-west cell: "
      "holes "
      "that it does not declare; declare them (gdal_translate -a_nodata 0) and move or shrink offset_m and "
      "extent_m");
  raster.stored = [](int column, int row) { return 10.0 * std::max(0, column + row - 3); };  // a shore
  EXPECT_EQ(Message(raster), "no error");
}

TEST_F(RasterTest, DegreesAreRefusedWithTheCommandThatMendsThem) {
  TestRaster raster;
  raster.system = "EPSG:4326";
  raster.west = -121.5;
  raster.south = 44.2;
  raster.cell = 1.0 / 10800.0;
  const std::string mend =
      "'g.tif': in degrees (cells of 9.25926e-05); allowed: a projected grid: gdalwarp -t_srs EPSG:32610 -r "
      "cubic -ot "
      "Float32 -dstnodata -9999 'g.tif' 'g_utm.tif'";
  EXPECT_EQ(Message(raster), mend);
  raster.system = "";
  EXPECT_EQ(Message(raster), mend);
  raster.system = "EPSG:4326";
  raster.west = 174.7;
  raster.south = -36.9;
  EXPECT_NE(Message(raster).find("-t_srs EPSG:32760 "), std::string::npos) << Message(raster);
}

TEST_F(RasterTest, WebMercatorIsRefusedWithTheCommandThatMendsIt) {
  TestRaster raster;
  raster.system = "EPSG:3857";
  raster.west = -13525000.0;
  raster.south = 5500000.0;
  EXPECT_EQ(Message(raster),
            "'g.tif': a metre of 'WGS 84 / Pseudo-Mercator' is 0.718 x 0.715 m on the ground there; allowed: "
            "within 2 %, "
            "not Web Mercator: gdalwarp -t_srs EPSG:32610 -r cubic -ot Float32 -dstnodata -9999 'g.tif' "
            "'g_utm.tif'");
  raster.west = 1000.0;
  raster.south = 2000.0;
  EXPECT_NE(Message(raster).find("not Web Mercator: gdalwarp"), std::string::npos) << Message(raster);
}

TEST_F(RasterTest, ProjectionsOfLargeAreasAreMeasured) {
  TestRaster raster;
  raster.system = "EPSG:32662";  // plate carree: degrees times 111 km
  raster.west = 1113194.9;
  raster.south = 5565974.5;  // 50 degrees north
  EXPECT_NE(Message(raster).find("is 0.644 x 0.999 m on the ground there"), std::string::npos)
      << Message(raster);
  raster.system = "EPSG:3035";  // equal-area, Europe
  raster.west = 4321000.0;
  raster.south = 3210000.0;
  EXPECT_EQ(Message(raster), "no error");
  raster.system = "EPSG:5070";  // equal-area, conterminous United States
  raster.west = -2000000.0;
  raster.south = 2700000.0;
  EXPECT_EQ(Message(raster), "no error");
}

TEST_F(RasterTest, PicturesAreNoHeights) {
  TestRaster raster;
  raster.type = GDT_CFloat32;
  EXPECT_EQ(Message(raster), "'g.tif': complex numbers; allowed: heights");
}

// -1, -500, 4000: whatever a program writes where it knows nothing.
TEST_F(RasterTest, ACellFarFromAllOthersIsAHoleOrASpike) {
  TestRaster raster;
  for (const double odd : {-1.0, -500.0, 4000.0}) {
    raster.stored = [odd](int column, int row) {
      return column == 4 && row == 3 ? odd : 300.0 + Slope(column, row);
    };
    EXPECT_EQ(
        Message(raster),
        fmt::format(
            "'g.tif': 1 of the 99 cells that the area needs lie more than 180 m {} all others, the "
            "first, of {:g} m, at [40, 30] m from the south-west cell: holes or spikes that it does not "
            "declare; mend them (gdal_fillnodata.py) or move or shrink offset_m and extent_m",
            odd < 0.0 ? "below" : "above", odd));
  }
  raster.stored = [](int column, int row) { return 20.0 + 12.0 * column + 3.0 * row; };  // steep, but ground
  EXPECT_EQ(Message(raster), "no error");
}

TEST_F(RasterTest, ABandThatIsCalledAUnitIsAskedFor) {
  TestRaster raster;
  raster.stored = Slope;
  for (const auto& [name, units] :
       {std::pair("Elevation (ft)", "ft', 'us-ft'"), std::pair("DEM_feet", "ft', 'us-ft'"),
        std::pair("z usft", "ft', 'us-ft'"), std::pair("Elevation (dm)", "dm'"),
        std::pair("height_cm", "cm'"), std::pair("[mm]", "mm'"), std::pair("Height in decimeters", "dm'"),
        std::pair("z: kilometres", "km'"), std::pair("elevation..ft.", "ft', 'us-ft'"),
        std::pair("z.2020.feet", "ft', 'us-ft'")}) {
    raster.name = name;
    EXPECT_EQ(
        Message(raster),
        fmt::format("'g.tif': its band is called '{}', and nothing else tells the unit of its heights; add "
                    "'height_unit: {} or 'm' to terrain.grid",
                    name, units));
    ExpectSlope(*Load(raster, "    height_unit: ft\n"), 10.0, kFootM);
  }
  for (const char* name : {"Elevation (yd)", "DEM_yards", "z, fathoms", "Height in"}) {
    raster.name = name;
    EXPECT_EQ(
        Message(raster),
        fmt::format("'g.tif': its band is called '{}', and nothing else tells the unit of its heights; "
                    "convert them (gdal_calc.py), or add 'height_unit: m' to terrain.grid if they are in "
                    "metres",
                    name));
    ExpectSlope(*Load(raster, "    height_unit: m\n"), 10.0, 1.0);
  }
  for (const char* name :
       {"Elevation (m)", "height_metres", "DEM", "DEM 10m", "DEM.10m.", "Height in metres", "soft.shift"}) {
    raster.name = name;
    ExpectSlope(*Load(raster), 10.0, 1.0);
  }
}

TEST_F(RasterTest, HeightsOfEightBitsAreSaid) {
  TestRaster raster;
  raster.type = GDT_Byte;
  raster.stored = Slope;
  const auto scene = Load(raster);
  ExpectSlope(*scene, 10.0, 1.0);
  ASSERT_EQ(scene->Notes().size(), 1u);
  EXPECT_NE(scene->Notes().front().find("heights of 8 bits"), std::string::npos);
}

class TextGridTest : public RasterTest {
 protected:
  TextGridTest() { folder.WriteGrid("g.asc", 40, 40, 30.0, Slope); }
  void WritePrj(const std::string& system) const {
    OGRSpatialReference reference;
    ASSERT_EQ(reference.SetFromUserInput(system.c_str()), OGRERR_NONE);
    const char* const options[] = {"FORMAT=WKT1_ESRI", nullptr};
    char* text = nullptr;
    ASSERT_EQ(reference.exportToWkt(&text, options), OGRERR_NONE);
    folder.Write("g.prj", text);
    CPLFree(text);
  }
  const std::string kGrid = "    file: g.asc\n";
};

// Was sheared without a word: each row began where the one before had ended.
TEST_F(TextGridTest, RowsAreAsLongAsTheHeaderSays) {
  const auto text = [](int ncols, int nrows, const std::string& end, const std::string& more = "") {
    std::string grid =
        fmt::format("ncols {}\nnrows {}\nxllcorner 0\nyllcorner 0\ncellsize 10\n", ncols, nrows);
    for (int row = 11; row >= 0; --row)
      for (int column = 0; column < 16; ++column)
        grid += fmt::format("{}{}", Slope(column, row), column == 15 ? "\n" : end);
    return grid + more;
  };
  const auto says = [&](const std::string& grid) {
    folder.Write("g.asc", grid);
    return Message(kGrid);
  };
  EXPECT_EQ(says(text(16, 12, " ")), "no error");
  EXPECT_EQ(says(text(16, 12, "\n")), "no error");  // one height a line
  ExpectSlope(*Load(kGrid), 10.0, 1.0);
  const std::string mend = "; correct the header, or bring the whole file";
  EXPECT_EQ(
      says(text(15, 12, " ")),
      "'g.asc': 192 heights, 16 a line, but its header says ncols 15 and nrows 12, which makes 180" + mend);
  EXPECT_EQ(
      says(text(17, 12, " ")),
      "'g.asc': 192 heights, 16 a line, but its header says ncols 17 and nrows 12, which makes 204" + mend);
  const auto exchanged = [](int ncols, int nrows) {
    return fmt::format(
        "'g.asc': {0} lines of {1} heights each, but its header says ncols {0} and nrows {1}; exchange the "
        "two, "
        "or bring the lines to {0} heights",
        ncols, nrows);
  };
  EXPECT_EQ(says(text(12, 16, " ")), exchanged(12, 16));
  EXPECT_EQ(says(text(16, 12, " ", "1 2 3\n")),
            "'g.asc': 195 heights, but its header says ncols 16 and nrows 12, which makes 192" + mend);
}

TEST_F(TextGridTest, ItsPrjTellsTheUnits) {
  ExpectSlope(*Load(kGrid), 30.0, 1.0);
  WritePrj("EPSG:2263");
  EXPECT_NE(Message(kGrid).find("its lengths are in us-ft, and nothing tells the unit of its heights"),
            std::string::npos)
      << Message(kGrid);
  ExpectSlope(*Load(kGrid + "    height_unit: us-ft\n"), 30.0 * kSurveyFootM, kSurveyFootM);
  WritePrj("EPSG:4326");
  EXPECT_NE(Message(kGrid).find("in degrees"), std::string::npos) << Message(kGrid);
}

// Two systems in a row, as ArcGIS writes them.
TEST_F(TextGridTest, ItsPrjTellsTheUnitOfHeights) {
  WritePrj("EPSG:2263");
  std::ofstream(folder.Path("g.prj"), std::ios::app)
      << ",VERTCS[\"NAVD_1988_Foot_US\",VDATUM[\"North_American_Vertical_Datum_1988\"],PARAMETER[\"Vertical_"
         "Shift\",0.0],"
         "PARAMETER[\"Direction\",1.0],UNIT[\"Foot_US\",0.3048006096012192]]";
  ExpectSlope(*Load(kGrid), 30.0 * kSurveyFootM, kSurveyFootM);
}

TEST_F(TextGridTest, ItsPrjTellsTheUnitOfHeightsInARowOfItsOwn) {
  WritePrj("EPSG:32618");
  std::ofstream(folder.Path("g.prj"), std::ios::app)
      << "\r\nVERTCS[\"NAVD_1988_Foot_US\",VDATUM[\"North_American_Vertical_Datum_1988\"],PARAMETER["
         "\"Vertical_Shift\","
         "0.0],PARAMETER[\"Direction\",1.0],UNIT[\"Foot_US\",0.3048006096012192]]\r\n";
  ExpectSlope(*Load(kGrid), 30.0, kSurveyFootM);
}

TEST_F(TextGridTest, AnOldPrjTellsTheUnits) {
  folder.Write(
      "g.prj",
      "Projection    STATEPLANE\nFipszone      3104\nDatum         NAD83\nSpheroid      GRS80\nUnits         "
      "FEET\nZunits        FEET\nXshift        0.0\nYshift        0.0\nParameters\n");
  ExpectSlope(*Load(kGrid), 30.0 * kSurveyFootM, kFootM);
}

TEST_F(TextGridTest, APrjThatIsNotUnderstoodIsRefused) {
  folder.Write("g.prj", "my own metres\n");
  EXPECT_EQ(Message(kGrid),
            "'g.asc': beside it stands g.prj, which is not understood; allowed: a coordinate system as ESRI "
            "writes it");
}

TEST_F(TextGridTest, APrjBesideAGeoTiffWithoutASystemCounts) {
  TestRaster raster = NewYork();
  raster.system = "";
  WritePrj("EPSG:2263");
  EXPECT_NE(Message(raster).find("its lengths are in us-ft"), std::string::npos) << Message(raster);
}

TEST_F(TextGridTest, FilesThatCountAreNamed) {
  WritePrj("EPSG:32618");
  GridTerrainSpec spec;
  spec.file = folder.Path("g.asc");
  std::vector<std::string> names;
  for (const std::string& file : ElevationGridFiles(spec))
    names.push_back(std::filesystem::path(file).filename().string());
  EXPECT_EQ(names, (std::vector<std::string>{"g.asc", "g.prj"}));
}

}  // namespace
}  // namespace ed3r::world
