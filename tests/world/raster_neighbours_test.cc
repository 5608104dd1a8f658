// What stands beside a raster counts, also beside a link, and may not contradict it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/world/test_rasters.h"
#include "tests/world/world_files.h"

namespace ed3r::world {
namespace {

namespace fs = std::filesystem;

constexpr double kSurveyFootM = 1200.0 / 3937.0;

const std::string kUtm =
    "PROJCS[\"NAD_1983_UTM_Zone_10N\",GEOGCS[\"GCS_North_American_1983\",DATUM[\"D_North_American_1983\","
    "SPHEROID[\"GRS_1980\",6378137.0,298.257222101]],PRIMEM[\"Greenwich\",0.0],UNIT[\"Degree\","
    "0.0174532925199433]],PROJECTION[\"Transverse_Mercator\"],PARAMETER[\"False_Easting\",500000.0],"
    "PARAMETER[\"False_Northing\",0.0],PARAMETER[\"Central_Meridian\",-123.0],PARAMETER[\"Scale_Factor\","
    "0.9996],PARAMETER[\"Latitude_Of_Origin\",0.0],UNIT[\"Meter\",1.0]]";
const std::string kFeet =
    "[\"NAVD_1988\",VDATUM[\"North_American_Vertical_Datum_1988\"],PARAMETER[\"Vertical_Shift\",0.0],"
    "PARAMETER[\"Direction\",1.0],UNIT[\"Foot_US\",0.3048006096012192]]";

class RasterNeighboursTest : public ::testing::Test {
 protected:
  std::string Height(const std::string& file) const { return HeightOrProblem(folder, file); }

  // 44 in its unit at [100, 80] m.
  void WriteText(const std::string& name) const {
    fs::create_directories(fs::path(folder.Path(name)).parent_path());
    folder.WriteGrid(name, 11, 9, 10.0, [](int column, int row) { return 2.0 * column + 3.0 * row; });
  }
  TestRaster Slope() const {
    TestRaster raster;
    raster.system = "EPSG:32610";
    raster.stored = [](int column, int row) { return 2.0 * column + 3.0 * row; };
    return raster;
  }
  void Link(const std::string& from, const std::string& to) const {
    fs::create_symlink(to, folder.Path(from));
  }

  const std::string in_feet = fmt::format("{:.2f}", 44.0 * kSurveyFootM);
  const TestFolder folder;
};

// A store of contents has each file in a folder of its own, and links to them beside each other.
TEST_F(RasterNeighboursTest, WhatStandsBesideALinkCounts) {
  WriteText("1/x.asc");
  fs::create_directories(folder.Path("2"));
  folder.Write("2/y.prj", kUtm + ",VERTCS" + kFeet);
  Link("link.asc", "1/x.asc");
  EXPECT_EQ(Height("link.asc"), "44.00");
  Link("link.prj", "2/y.prj");
  EXPECT_EQ(Height("link.asc"), in_feet);
  Link("again.asc", "link.asc");
  EXPECT_EQ(Height("again.asc"), in_feet);
  GridTerrainSpec spec;
  spec.file = folder.Path("again.asc");
  EXPECT_EQ(ElevationGridFiles(spec),
            (std::vector<std::string>{folder.Path("link.asc"), folder.Path("link.prj")}));
}

TEST_F(RasterNeighboursTest, WhatStandsBesideTheTargetOfALinkCounts) {
  WriteText("1/x.asc");
  folder.Write("1/x.prj", kUtm + ",VERTCS" + kFeet);
  Link("link.asc", "1/x.asc");
  EXPECT_EQ(Height("link.asc"), in_feet);
  folder.Write("link.prj", kUtm + ",VERTCS" + kFeet);
  EXPECT_EQ(Height("link.asc"), in_feet);
  folder.Write("link.prj", kUtm);
  EXPECT_EQ(
      Height("link.asc"),
      "'link.asc': it is a link, and 'link.prj' is not the same as '1/x.prj' beside what it leads to; make "
      "them alike, or take one away");
}

TEST_F(RasterNeighboursTest, WhatBelongsToALinkStandsInOnePlace) {
  fs::create_directories(folder.Path("1"));
  WriteRaster(folder.Path("1/x.tif"), Slope());
  folder.Write(
      "1/x.tif.aux.xml",
      "<PAMDataset><PAMRasterBand band=\"1\"><UnitType>us-ft</UnitType></PAMRasterBand></PAMDataset>");
  Link("link.tif", "1/x.tif");
  EXPECT_EQ(Height("link.tif"), in_feet);
  folder.Write("link.prj", kUtm);
  EXPECT_EQ(Height("link.tif"),
            "'link.tif': it is a link, and what belongs to it stands in two places, '1/x.tif.aux.xml' and "
            "'link.prj'; bring all to one: beside the link, or beside what it leads to");
}

// A store may lack the contents of a link.
TEST_F(RasterNeighboursTest, ALinkThatLeadsNowhereIsNotPassedOver) {
  WriteText("g.asc");
  Link("g.prj", "store/y.prj");
  EXPECT_EQ(Height("g.asc"),
            "'g.asc': beside it stands g.prj, which is no file, or a link that leads to none");
  std::filesystem::remove(folder.Path("g.prj"));
  Link("g_old.prj", "store/y.prj");
  EXPECT_EQ(Height("g.asc"), "44.00");
}

// Other spellings than "VERTCS[" were passed over: metres.
TEST_F(RasterNeighboursTest, AVerticalSystemCountsHoweverItIsSpelled) {
  const std::string old =
      "[\"NAVD88 height (ftUS)\",VERT_DATUM[\"North American Vertical Datum 1988\",2005],UNIT[\"US survey "
      "foot\",0.304800609601219],AXIS[\"Up\",UP]]";
  WriteText("g.asc");
  for (const std::string& prj :
       {kUtm + "\nVertCS" + kFeet, kUtm + "\nVERTCS " + kFeet, kUtm + ",VertCs" + kFeet,
        kUtm + ",VERT_CS" + old, kUtm + "\r\nvert_cs" + old + "\r\n",
        "COMPD_CS[\"both\"," + kUtm + ",VERT_CS" + old + "]"}) {
    folder.Write("g.prj", prj);
    EXPECT_EQ(Height("g.asc"), in_feet) << prj;
    WriteRaster(folder.Path("g.tif"), Slope());
    EXPECT_EQ(Height("g.tif"), in_feet) << prj;
  }
  folder.Write("g.prj", kUtm + ",VERT_CS" + old.substr(0, old.rfind("UP]]")) + "DOWN]]");
  EXPECT_EQ(Height("g.asc"), "'g.asc': its heights are depths, down from the surface; allowed: heights");
}

TEST_F(RasterNeighboursTest, APrjMayNotContradictTheLengthsOfAGeoTiff) {
  WriteRaster(folder.Path("g.tif"), Slope());
  folder.Write("g.prj", kUtm);
  EXPECT_EQ(Height("g.tif"), "44.00");
  std::string feet = kUtm;
  feet.replace(feet.find("UNIT[\"Meter\",1.0]"), 17, "UNIT[\"Foot_US\",0.3048006096012192]");
  folder.Write("g.prj", feet);
  EXPECT_EQ(Height("g.tif"),
            "'g.tif': its lengths are in m by its coordinate system, and in us-ft by g.prj; correct the one "
            "that is wrong, or take it away");
  TestRaster raster = Slope();
  raster.system = "EPSG:2263";
  raster.west = 980000.0;
  raster.south = 200000.0;
  raster.cell = 10.0 / kSurveyFootM;
  raster.unit = "m";
  WriteRaster(folder.Path("feet.tif"), raster);
  feet.replace(feet.find("0.3048006096012192"), 18, "0.3048006");  // rounded
  folder.Write("feet.prj", feet);
  EXPECT_EQ(Height("feet.tif"), "44.00");
  folder.Write("g.prj", kUtm.substr(kUtm.find("GEOGCS"), kUtm.find(",PROJECTION") - kUtm.find("GEOGCS")));
  EXPECT_EQ(
      Height("g.tif"),
      "'g.tif': its lengths are in m by its coordinate system, and in degrees by g.prj; correct the one "
      "that is wrong, or take it away");
}

// The .aux.xml won, without a word.
TEST_F(RasterNeighboursTest, AnAuxXmlMayNotContradictTheCellsOfAGeoTiff) {
  WriteRaster(folder.Path("g.tif"), Slope());
  const auto with = [&](const std::string& transform) {
    folder.Write("g.tif.aux.xml", "<PAMDataset><GeoTransform>" + transform + "</GeoTransform></PAMDataset>");
    return Height("g.tif");
  };
  EXPECT_EQ(with("500000, 10, 0, 4000090, 0, -10"), "44.00");
  const std::string end = " by the .aux.xml beside it; correct it, or take it away";
  EXPECT_EQ(with("500000, 20, 0, 4000090, 0, -20"), "'g.tif': its cells are 10 x -10, and 20 x -20" + end);
  EXPECT_EQ(with("500000, 10, 0, 4000000, 0, 10"), "'g.tif': its cells are 10 x -10, and 10 x 10" + end);
  folder.Write("g.tfw", "20\n0\n0\n-20\n500010\n4000080\n");
  EXPECT_EQ(with("500000, 20, 0, 4000090, 0, -20"), "'g.tif': its cells are 10 x -10, and 20 x -20" + end);
}

// As rioxarray and others write what they know of their data: was read as metres.
TEST_F(RasterNeighboursTest, AUnitAmongTheMetadataOfARasterIsAskedFor) {
  const auto with = [&](const std::string& item, bool of_band) {
    WriteRaster(folder.Path("g.tif"), Slope());
    GDALDataset* dataset = GDALDataset::Open(folder.Path("g.tif").c_str(), GDAL_OF_UPDATE);
    GDALMajorObject* object = dataset;
    if (of_band) object = dataset->GetRasterBand(1);
    object->SetMetadataItem(item.substr(0, item.find('=')).c_str(), item.substr(item.find('=') + 1).c_str());
    GDALClose(dataset);
    return Height("g.tif");
  };
  for (const bool of_band : {false, true}) {
    EXPECT_EQ(with("units=feet", of_band),
              "'g.tif': its metadata have units 'feet', and nothing else tells the unit of its heights; add "
              "'height_unit: ft', 'us-ft' or 'm' to terrain.grid");
    EXPECT_EQ(with("units=m", of_band), "44.00");
    EXPECT_EQ(with("community=Seven Mile", of_band), "44.00");
    EXPECT_EQ(with("TIFFTAG_RESOLUTIONUNIT=2 (pixels/inch)", of_band), "44.00");
  }
}

// Was read as metres: GDAL reads none of these files.
TEST_F(RasterNeighboursTest, MetadataThatSpeakOfAnotherUnitAreAskedFor) {
  WriteRaster(folder.Path("g.tif"), Slope());
  const auto says = [&](const std::string& name, const std::string& text) {
    folder.Write(name, text);
    std::string message = Height("g.tif");
    fs::remove(folder.Path(name));
    return message;
  };
  const auto asks = [](const std::string& name, const std::string& unit) {
    return fmt::format(
        "'g.tif': {} beside it has a unit '{}', and nothing else tells the unit of its heights; add "
        "'height_unit: ft', 'us-ft' or 'm' to terrain.grid",
        name, unit);
  };
  const auto fgdc = [](const std::string& unit) {
    return "<?xml version=\"1.0\"?>\n<metadata><idinfo><descript><purpose>contours of 5 feet, a unit of 3 "
           "miles</purpose></descript></idinfo><spref><horizsys><geograph><geogunit>Decimal "
           "degrees</geogunit>"
           "</geograph><planar><planci><plandu>survey "
           "feet</plandu></planci></planar></horizsys><vertdef><altsys>"
           "<altdatum>NAVD88</altdatum><altres>1 ft</altres><altunits>" +
           unit + "</altunits></altsys></vertdef></spref></metadata>";
  };
  for (const char* name : {"g.tif.xml", "g.xml", "G.TIF.XML"}) {
    EXPECT_EQ(says(name, fgdc("US survey feet")), asks(name, "US survey feet"));
    EXPECT_EQ(says(name, fgdc("meters")), "44.00") << name;
  }
  const std::string esri =
      "<metadata><Esri><peXml>WKT&gt;PROJCS[&quot;UTM&quot;,UNIT[&quot;Foot&quot;,0.3048]],";
  EXPECT_EQ(says("g.tif.xml", esri + "VERTCS[&quot;NAVD&quot;,UNIT[&quot;Foot_US&quot;,0.3]]</peXml></Esri>"),
            asks("g.tif.xml", "&quot;Foot_US&quot;"));
  EXPECT_EQ(says("g.tif.xml", esri + "</peXml></Esri></metadata>"), "44.00");
  for (const char* name : {"g.aux.json", "g.tif.aux.json", "g.json"}) {
    EXPECT_EQ(says(name, "{\"raster:bands\": [{\"unit\": \"ft\"}]}"), asks(name, "ft"));
    EXPECT_EQ(says(name, "{\"units\": [\"feet\"]}"), asks(name, "feet"));
    EXPECT_EQ(says(name, "{\"unit\": \"m\", \"community\": \"Seven Mile\", \"by\": \"unit 3 ft\"}"), "44.00");
  }
  EXPECT_EQ(says("other.tif.xml", fgdc("feet")), "44.00");
  TestRaster told = Slope();
  told.unit = "m";
  WriteRaster(folder.Path("g.tif"), told);
  EXPECT_EQ(says("g.tif.xml", fgdc("feet")), "44.00");  // the raster tells itself
}

}  // namespace
}  // namespace ed3r::world
