// Stem maps as people have them: other separators, names, units, missing crowns, trees twice, degrees.
#include "engine/world/files/stem_map.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "engine/core/check.h"
#include "tests/world/world_files.h"

namespace ed3r::world {
namespace {

const std::string kHeader = "x_m,y_m,dbh_cm,height_m,crown_depth_m,crown_radius_m\n";
const std::string kRows = "3,7,20,15,8,2\n63,57,30,21.5,9,2.5\n";

class StemMapTest : public ::testing::Test {
 protected:
  StemMap Read(const std::string& text) {
    spec.file = folder.Write("stems.csv", text);
    return ReadStemMap(spec);
  }

  std::string Message(const std::string& text) {
    try {
      Read(text);
    } catch (const UserError& error) {
      std::string message = error.what();
      const std::string prefix = folder.Path("");
      for (auto at = message.find(prefix); at != std::string::npos; at = message.find(prefix))
        message.erase(at, prefix.size());
      return message;
    }
    return "no error";
  }

  // The two trees of kRows, exactly.
  void ExpectTrees(const std::string& text) {
    SCOPED_TRACE(text);
    const StemMap map = Read(text);
    ASSERT_EQ(map.stems.size(), 2u);
    EXPECT_EQ(map.size_m, Eigen::Vector2d(60, 50));
    EXPECT_EQ(map.stems[1].x_m, 60.0);
    EXPECT_EQ(map.stems[1].y_m, 50.0);
    EXPECT_NEAR(map.stems[1].height_m, 21.5, 1e-9);
    EXPECT_NEAR(map.stems[1].trunk_radius_m, 0.15, 1e-12);
    EXPECT_NEAR(map.stems[1].crown_depth_m, 9.0, 1e-9);
    EXPECT_NEAR(map.stems[1].crown_radius_m, 2.5, 1e-12);
  }

  const TestFolder folder;
  StemMapSpec spec;
};

TEST_F(StemMapTest, TablesAsProgramsWriteThem) {
  ExpectTrees(kHeader + kRows);
  ExpectTrees("\xEF\xBB\xBF" + kHeader + kRows);
  ExpectTrees(
      "\"x_m\",\"y_m\",\"dbh_cm\",\"height_m\",\"crown_depth_m\",\"crown_radius_m\"\r\n3,7,20,15,8,2\r\n"
      "63,57,30,21.5,9,2.5\r\n");
  ExpectTrees("x_m;y_m;dbh_cm;height_m;crown_depth_m;crown_radius_m\n3;7;20;15;8;2\n63;57;30;21,5;9;2,5\n");
  ExpectTrees(
      "\xEF\xBB\xBF\"x_m\";\"y_m\";\"dbh_cm\";\"height_m\";\"crown_depth_m\";\"crown_radius_m\"\n3;7;20;15;8;"
      "2\n"
      "63;57;30;\"21,5\";9;2,5\n");
  ExpectTrees(
      "x_m\ty_m\tdbh_cm\theight_m\tcrown_depth_m\tcrown_radius_m\n3\t7\t20\t15\t8\t2\n63\t57\t30\t21.5\t9\t2."
      "5\n");
  ExpectTrees("x_m,y_m,dbh_cm,height_m,crown_depth_m,crown_radius_m\r3,7,20,15,8,2\r63,57,30,21.5,9,2.5\r");
  ExpectTrees("# plot\r" + kHeader + "# pines\r3,7,20,15,8,2\n# oaks\r63,57,30,21.5,9,2.5\n");
  ExpectTrees(
      "\"\",\"x_m\",\"y_m\",\"dbh_cm\",\"height_m\",\"crown_depth_m\",\"crown_radius_m\"\n\"1\",3,7,20,15,8,"
      "2\n"
      "\"2\",63,57,30,21.5,9,2.5\n");  // write.csv of R
  ExpectTrees(
      "sep=;\nx_m;y_m;dbh_cm;height_m;crown_depth_m;crown_radius_m\n3;7;20;15;8;2\n63;57;30;21,5;9;2,5\n");
  ExpectTrees(
      ",x_m,y_m,dbh_cm,height_m,crown_depth_m,crown_radius_m\n0,3,7,20,15,8,2\n1,63,57,30,21.5,9,2.5\n");
}

TEST_F(StemMapTest, ADelimiterAtTheEndOfEveryLineAndRowsOfThemAlone) {
  ExpectTrees(
      "x_m;y_m;dbh_cm;height_m;crown_depth_m;crown_radius_m;\n3;7;20;15;8;2;\n63;57;30;21,5;9;2,5;\n;;;;;;\n"
      ";;;;;;\n");
}

TEST_F(StemMapTest, ComplaintsNameThePlaceInTheFileAsItIs) {
  EXPECT_EQ(
      Message("x_m;y_m;dbh_cm;height_m;crown_depth_m;crown_radius_m\n3;7;20;15;8;2\n63;57;30;tall;9;2,5\n"),
      "stems.csv:3:10: height_m: 'tall' is not allowed; allowed: 0.5 .. 130 m");
  EXPECT_EQ(Message("x_m y_m dbh_cm height_m crown_depth_m crown_radius_m\n3 7 20 15 8 2\n"),
            "stems.csv: its cells are apart by spaces; allowed: commas, semicolons or tabs");
  ExpectTrees(kHeader + "+3,7,20,15,8,2\n63,57,30,+21.5,9,2.5\n");
  ExpectTrees("sep=\n" + kHeader + "3,7,20,15,8,2\n63,57,30,21.5,9,2.5\n");
  EXPECT_EQ(Message("sep=;\n" + kHeader + "3,7,20,15,8,2\n"),
            "stems.csv:1:5: sep=;: the names of the columns are parted by ','; correct this line");
  EXPECT_EQ(Message(std::string("\xFF\xFE\x78\x00", 4)), "stems.csv: UTF-16 text; save it as UTF-8");
  EXPECT_EQ(Message(std::string("PK\3\4\0\0", 6)),
            "stems.csv: is no text; allowed: a table with commas, semicolons or tabs");
  EXPECT_EQ(Message("id," + kHeader + "\"a,3,7,20,15,8,2\nb,63,57,30,21.5,9,2.5\n"),
            "stems.csv:2:1: a quotation mark is not closed; cells over several lines are not read");
}

// Places of 1,023 m became 1.023 m, beside others of 900 m.
TEST_F(StemMapTest, ThousandsCommasAreRefused) {
  const std::string header = "x_m\ty_m\tdbh_cm\theight_m\tcrown_depth_m\tcrown_radius_m\n";
  EXPECT_EQ(Message(header + "900\t7\t20\t15\t8\t2\n1,023\t57\t30\t21.5\t9\t2.5\n"),
            "stems.csv:3:1: x_m: '1,023' here and '21.5' in line 3: a decimal comma and a decimal point, or "
            "thousands? "
            "allowed: one decimal sign in the columns that are read, and none for thousands");
  EXPECT_EQ(Message(header + "900\t7\t20\t15\t8\t2\n1,023\t57\t30\t21\t9\t2\n"),
            "stems.csv:3:1: x_m: '1,023': every number with a comma has three digits after it in the columns "
            "that are read: decimals or thousands? "
            "allowed: no sign for thousands (1234), and decimal points where all have three decimals");
}

TEST_F(StemMapTest, ColumnsThatAreNotReadTellNothingOfCommas) {
  const std::string header = "code;x_m;y_m;dbh_cm;height_m;crown_depth_m;crown_radius_m\n";
  EXPECT_EQ(Message(header + "1,4;900;7;20;15;8;2\n2;1,023;57;30;21;9;2\n"),
            "stems.csv:3:3: x_m: '1,023': every number with a comma has three digits after it in the columns "
            "that are read: decimals or thousands? "
            "allowed: no sign for thousands (1234), and decimal points where all have three decimals");
  for (const char* code : {"1.2", "29.11", "1,4", "1,400", "1.234,5"}) {
    EXPECT_EQ(Read(header + code + ";3;7;20;15;8;2\n2;63,5;57;30;21,5;9;2,5\n").size_m,
              Eigen::Vector2d(60.5, 50));
    EXPECT_EQ(Read(header + code + ";3;7;20;15;8;2\n2;63.5;57;30;21.5;9;2.5\n").size_m,
              Eigen::Vector2d(60.5, 50));
  }
}

// Were left out without a word.
TEST_F(StemMapTest, ARowThatBeginsAsACommentIsRefused) {
  const std::string text =
      "# by A, B, C, D, E, and F\nid," + kHeader + "# plot 2, surveyed twice\na,3,7,20,15,8,2\n";
  EXPECT_EQ(Message(text + "#2,63,57,30,21.5,9,2.5\n"),
            "stems.csv:5:1: '#2' begins with # and has as many cells as the header: a row or a comment? "
            "allowed: a row that begins with another sign (the cell in quotes will do: \"#1\"), or no such "
            "line");
  EXPECT_EQ(Read(text + "\"#2\",63,57,30,21.5,9,2.5\n").stems.size(), 2u);
}

// One such row, and the stand was a kilometre wide.
TEST_F(StemMapTest, AMissingPlaceIsNoPlace) {
  for (const char* mark : {"-99", "-999", "-999.0", "-9999"})
    EXPECT_EQ(Message(kHeader + kRows + mark + ",9,20,15,8,2\n"),
              fmt::format("stems.csv:4:1: x_m: '{}' is missing; measure it or leave the tree out", mark));
  EXPECT_EQ(Read(kHeader + kRows + "-99,9,20,15,8,2\n-12,9,20,15,8,2\n").size_m, Eigen::Vector2d(162, 50));
}

// Was 3 km of nothing, without a word.
TEST_F(StemMapTest, AStandThatIsMostlyEmptyIsSaid) {
  EXPECT_TRUE(Read(kHeader + kRows).notes.empty());
  EXPECT_EQ(Read(kHeader + kRows + "9,5057,30,21.5,9,2.5\n12,12,30,21.5,9,2.5\n").notes,
            std::vector<std::string>{
                "stem map: one tree in 7.58 ha of a stand of 60 x 5050 m; farthest away is the "
                "tree at [9, 5057] m"});
}

TEST_F(StemMapTest, AColumnHasOneMeaning) {
  spec.columns = {{"x_m", "y_m"}};
  spec.columns_place = "w.yaml:7:5";
  EXPECT_EQ(Message(kHeader + kRows),
            "w.yaml:7:5: forest.stem_map.columns: 'y_m' is both the position east and the position north; "
            "allowed: one "
            "meaning a column");
}

// Feet were read as metres, inches as centimetres: forests of a third of their height.
TEST_F(StemMapTest, AColumnIsNotMappedAgainstTheUnitOfItsName) {
  spec.columns_place = "w.yaml:7:5";
  const auto says = [&](const std::string& name, const std::string& header) {
    spec.columns = {{name, header}};
    std::string text = kHeader;
    const std::string plain = name.starts_with("dbh") ? "dbh_cm" : "height_m";
    return Message(text.replace(text.find(plain), plain.size(), header) + kRows);
  };
  const auto refused = [](const std::string& name, const std::string& header, const std::string& unit) {
    return fmt::format(
        "w.yaml:7:5: forest.stem_map.columns: {} is '{}', whose name says {}; allowed: {}, or a name "
        "that says the unit of its values; correct one of them",
        name, header, unit,
        name.starts_with("dbh") ? "dbh_cm | dbh_mm | dbh_m | dbh_in" : "height_m | height_ft");
  };
  for (const auto& [header, unit] :
       {std::pair("HT_FT", "ft"), std::pair("heightFeet", "ft"), std::pair("Height (yd)", "yd"),
        std::pair("h [cm]", "cm"), std::pair("h_chains", "chains"), std::pair("Height..ft.", "ft"),
        std::pair("Ht.ft", "ft"), std::pair("heightft", "ft"), std::pair("HEIGHTFT", "ft"),
        std::pair("treeheightfeet", "ft"), std::pair("htft", "ft"), std::pair("hgtcm", "cm"),
        std::pair("HT.feet", "ft"), std::pair("Height.2020..ft.", "ft")})
    EXPECT_EQ(says("height_m", header), refused("height_m", header, unit));
  for (const auto& [header, unit] :
       {std::pair("DBH in", "in"), std::pair("d_mm", "mm"), std::pair("DBH..in.", "in"),
        std::pair("dbh.inches", "inches"), std::pair("dbh.mm", "mm"), std::pair("DBHin", "in"),
        std::pair("dbhinches", "inches")})
    EXPECT_EQ(says("dbh_cm", header), refused("dbh_cm", header, unit));
  for (const char* header : {"DBH", "DBH_1.3m", "DBH (cm) in 2020", "DBH at 1.3 m", "DBH_cm", "dbh_1.3m",
                             "DBH..1.3.m.", "DBH.1.3..m.", "DBH..cm.", "DBH..cm..at.1.3.m", "Diameter",
                             "diameters", "dbhcm", "dbhm", "based", "weight"})
    EXPECT_EQ(says("dbh_cm", header), "no error") << header;
  for (const char* header : {"HT", "height in metres", "shift_top", "Height in 2019", "Chain height",
                             "H_Mile_Stand", "Height..m.", "left", "aircraft", "soft", "lift", "draft",
                             "heightm", "htmetres", "shift", "heightindex", "weight", "altitude"})
    EXPECT_EQ(says("height_m", header), "no error") << header;
}

TEST_F(StemMapTest, ColumnsByOtherNamesAndInOtherUnits) {
  spec.columns = {{"x_m", "E"}, {"y_m", "N"}, {"dbh_mm", "DBH"}, {"height_ft", "HT"}};
  spec.columns["crown_base_m"] = "CBH";
  spec.columns["crown_diameter_m"] = "crown width";
  ExpectTrees(
      "tree,E,N,DBH,HT,CBH,crown width\na,3,7,200,49.2126,7,4\nb,63,57,300,70.53805774278215,12.5,5\n");
  spec.columns.clear();
  ExpectTrees(
      "x_m,y_m,dbh_in,height_m,crown_base_m,crown_diameter_m\n3,7,8,15,7,4\n63,57,11.811023622047244,21.5,12."
      "5,5\n");
}

TEST_F(StemMapTest, AColumnWithoutAUnitIsAskedFor) {
  EXPECT_EQ(Message("x_m,y_m,DBH,height_m,crown_depth_m,crown_radius_m\n" + kRows),
            "stems.csv: no column for the diameter at breast height (dbh_cm | dbh_mm | dbh_m | dbh_in); is "
            "it 'DBH'? Then "
            "add 'columns: {dbh_cm: DBH}' to forest.stem_map, with its unit; or add 'estimate_missing: "
            "conifers' (or "
            "deciduous, mixed, tropical); columns: x_m, y_m, DBH, height_m, crown_depth_m, crown_radius_m");
  EXPECT_EQ(Message("a,b,dbh_cm,height_m,crown_depth_m,crown_radius_m\n" + kRows),
            "stems.csv: no column for the position east (x_m | x_ft); name it in forest.stem_map.columns; "
            "columns: a, b, "
            "dbh_cm, height_m, crown_depth_m, crown_radius_m");
  spec.columns = {{"dbh_cm", "diameter"}};
  EXPECT_EQ(Message(kHeader + kRows),
            "stems.csv:1:1: no column 'diameter' (forest.stem_map.columns has it as dbh_cm); columns: x_m, "
            "y_m, dbh_cm, "
            "height_m, crown_depth_m, crown_radius_m");
}

// Diameters of mm under a header of cm gave trunks of 3 m.
TEST_F(StemMapTest, UnitsThatCannotBeAreNamed) {
  const auto stand = [](double dbh, double height) {
    std::string text = kHeader;
    for (int i = 0; i < 8; ++i) text += fmt::format("{},{},{},{},4,2\n", 10 * i, 7 * i, dbh + i, height);
    return text;
  };
  EXPECT_EQ(Message(stand(25, 18)), "no error");
  EXPECT_EQ(Message(stand(250, 18)),
            "stems.csv: half of its trees are less than 7.11 diameters high, with 'dbh_cm' in cm and "
            "'height_m' in m; "
            "diameters in mm?: another unit (dbh_cm | dbh_mm | dbh_m | dbh_in, height_m | height_ft in "
            "forest.stem_map.columns)");
  EXPECT_NE(Message(stand(25, 80)).find("heights in feet, or diameters in inches or m?"), std::string::npos);
}

// Inches in a column of cm, and girths: they may be so, so it is said.
TEST_F(StemMapTest, TreesThatAreSeldomSoSlenderAreSaid) {
  const auto notes = [this](double dbh, double height) {
    std::string text = kHeader;
    for (int i = 0; i < 8; ++i) text += fmt::format("{},{},{},{},4,2\n", 10 * i, 7 * i, dbh, height);
    return Read(text).notes;
  };
  EXPECT_TRUE(notes(30, 20).empty());
  EXPECT_EQ(notes(30 / 2.54, 20),
            std::vector<std::string>{
                "stem map: half of its trees are more than 169 diameters high, with 'dbh_cm' in "
                "cm: slender trees, or diameters in inches (dbh_in)"});
  EXPECT_EQ(notes(30 * std::numbers::pi, 20),
            std::vector<std::string>{
                "stem map: half of its trees are less than 21 diameters high, with 'dbh_cm' in "
                "cm: stout trees, or girths in place of diameters"});
}

TEST_F(StemMapTest, CrownsAreNoWiderThanTheirTreesAreHigh) {
  EXPECT_EQ(Message(kHeader + "3,7,20,15,8,2\n63,57,30,21.5,9,25\n"),
            "stems.csv:3:17: crown_radius_m: '25' is not allowed; allowed: 0.1 .. 21.5 m");
  EXPECT_EQ(Message(kHeader + "3,7,20,15,8,2\n63,57,30,1.5,1,2.9\n"), "no error");  // a shrub
}

TEST_F(StemMapTest, LongitudeAndLatitudeAreNamed) {
  const std::string mend =
      "are longitude and latitude; allowed: metres or feet of a projected system: ogr2ogr -f CSV "
      "stems_utm.csv "
      "'stems.csv' -oo X_POSSIBLE_NAMES=";
  const std::string rows = "-121.51,44.21,20,15,8,2\n-121.5105,44.2102,30,21.5,9,2.5\n";
  std::string text = Message("lon,lat,dbh_cm,height_m,crown_depth_m,crown_radius_m\n" + rows);
  EXPECT_TRUE(text.starts_with("stems.csv: 'lon' and 'lat' " + mend + "lon")) << text;
  EXPECT_NE(text.find("-t_srs EPSG:32610 -lco GEOMETRY=AS_XY"), std::string::npos) << text;
  text = Message(kHeader + rows);
  EXPECT_TRUE(text.starts_with("stems.csv: 'x_m' and 'y_m' " + mend + "x_m")) << text;
}

TEST_F(StemMapTest, ATreeFarFromAllOthersIsNamed) {
  EXPECT_EQ(Message(kHeader + "500003,4000007,20,15,8,2\n500063,4000057,30,21.5,9,2.5\n0,0,30,21.5,9,2.5\n"),
            "stems.csv: the stand measures 500063 x 4.00006e+06 m; allowed: up to 20000 m a side; farthest "
            "away is the "
            "tree at [0, 0] m");
  EXPECT_EQ(Message(kHeader + kRows + "-9999,-9999,20,15,8,2\n"),
            "stems.csv:4:1: x_m: '-9999' is missing; measure it or leave the tree out");
}

TEST_F(StemMapTest, TwoTreesAtOneSpotAreNamedOrTheTallestStays) {
  const std::string twice = kHeader + kRows + "3,7.004,25,18,9,2\n63,57,30,20,9,2.5\n";
  EXPECT_EQ(
      Message(twice),
      "stems.csv:4:1: a tree at [3, 7.004] m, where that of line 2 stands; leave one out, or add 'same_spot: "
      "tallest' to forest.stem_map");
  spec.tallest_of_a_spot = true;
  const StemMap map = Read(twice);
  ASSERT_EQ(map.stems.size(), 2u);
  EXPECT_EQ(map.stems[0].height_m, 21.5);
  EXPECT_EQ(map.stems[1].height_m, 18.0);
  EXPECT_EQ(map.notes,
            std::vector<std::string>{"stem map: 2 of 4 trees left out, each at the spot of a taller one"});
}

// Each taller than those before it: all of them were looked at again for each.
TEST_F(StemMapTest, OfVeryManyTreesAtOneSpotTheTallestStays) {
  std::string text = kHeader + kRows;
  for (int i = 1; i <= 100'000; ++i) text += fmt::format("3,7.004,25,{:.4f},9,2\n", 20 + 1e-4 * i);
  spec.tallest_of_a_spot = true;
  const StemMap map = Read(text);
  ASSERT_EQ(map.stems.size(), 2u);
  EXPECT_EQ(map.stems[1].height_m, 30.0);
  EXPECT_EQ(map.notes, std::vector<std::string>{
                           "stem map: 100000 of 100002 trees left out, each at the spot of a taller one"});
}

TEST_F(StemMapTest, MissingCrownsAreRefusedUnlessTheyAreToBeEstimated) {
  EXPECT_EQ(Message(kHeader + "3,7,20,15,,2\n63,57,30,21.5,9,2.5\n"),
            "stems.csv:2:11: crown_depth_m: '' is missing; measure it or leave the tree out, or add "
            "'estimate_missing: "
            "conifers' (or deciduous, mixed, tropical) to forest.stem_map");
  EXPECT_NE(
      Message("x_m,y_m,dbh_cm,height_m\n3,7,20,15\n63,57,30,21.5\n").find("no column for the crown's depth"),
      std::string::npos);
  spec.estimate_missing = ForestKind::kConifers;
  const StemMap map = Read(kHeader + "3,7,20,15,,2\n63,57,30,21.5,9,NA\n");
  EXPECT_NEAR(map.stems[0].crown_depth_m, 0.3106775 * std::pow(15.0, 1.098), 1e-12);
  EXPECT_EQ(map.stems[0].crown_radius_m, 2.0);
  EXPECT_EQ(map.stems[1].crown_depth_m, 9.0);
  EXPECT_NEAR(map.stems[1].crown_radius_m, (3.75105 - 0.17919 * 21.5 + 0.01241 * 21.5 * 21.5) / 2.0, 1e-12);
  EXPECT_EQ(map.notes,
            (std::vector<std::string>{
                "stem map: crown radius of 1 of 2 trees from their height (conifers: Popescu and Wynne 2004)",
                "stem map: crown depth of 1 of 2 trees from their height (Poorter et al. 2006)"}));
}

// What lidar gives: places and heights.
TEST_F(StemMapTest, ATreeOfItsHeightAlone) {
  spec.estimate_missing = ForestKind::kTropical;
  const StemMap map = Read("x_m,y_m,height_m\n3,7,15\n63,57,40\n");
  const double radius_m = std::sqrt(0.156766 * std::pow(40.0, 1.888) / std::numbers::pi);
  EXPECT_NEAR(map.stems[1].crown_radius_m, radius_m, 1e-12);
  EXPECT_NEAR(map.stems[1].trunk_radius_m,
              0.005 * 0.557 * std::pow(80.0 * radius_m, 0.809) * std::exp(0.056 * 0.056 / 2.0), 1e-12);
  EXPECT_EQ(map.notes.back(),
            "stem map: diameter of 2 of 2 trees from their height and crown (Jucker et al. 2017)");
  EXPECT_NE(Message("x_m,y_m,height_m\n3,7,15\n63,57,\n")
                .find("stems.csv:3:7: height_m: '' is missing; measure it"),
            std::string::npos);
}

TEST(TreeAllometryTest, CrownsStayWithinTheirTrees) {
  for (const ForestKind kind :
       {ForestKind::kConifers, ForestKind::kDeciduous, ForestKind::kMixed, ForestKind::kTropical})
    for (const double height_m : {0.5, 2.0, 10.0, 30.0, 31.0, 60.0, 130.0}) {
      EXPECT_LE(2.0 * CrownRadiusM(kind, height_m), height_m);
      EXPECT_LT(CrownDepthM(height_m), height_m);
      EXPECT_GT(BreastHeightDiameterM(height_m, CrownRadiusM(kind, height_m)), 0.0);
      EXPECT_EQ(FindForestKind(NameOf(kind)), kind);
    }
  EXPECT_EQ(CrownRadiusM(ForestKind::kMixed, 30.0), CrownRadiusM(ForestKind::kMixed, 60.0));
  EXPECT_NEAR(CrownRadiusM(ForestKind::kDeciduous, 20.0), (3.09632 + 0.00895 * 400.0) / 2.0, 1e-12);
}

}  // namespace
}  // namespace ed3r::world
