// Somebody's own ground through the command: what was applied is said, and a run keeps all that it took.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/app/command.h"

namespace ed3r::app {
namespace {

namespace fs = std::filesystem;

// A slope of 1 ft in 10 over 1500 ft, its .prj in feet, and a sweep over it.
void WriteGround(const fs::path& folder) {
  fs::create_directories(folder);
  std::ofstream grid(folder / "g.asc");
  grid << "ncols 51\nnrows 51\nxllcorner 980000\nyllcorner 200000\ncellsize 30\nNODATA_value -9999\n";
  for (int row = 0; row < 51; ++row)
    for (int column = 0; column < 51; ++column) grid << 3 * column << (column < 50 ? ' ' : '\n');
  std::ofstream(folder / "g.prj")
      << "Projection STATEPLANE\nFipszone 3104\nDatum NAD83\nSpheroid GRS80\nUnits FEET\n"
         "Zunits FEET\nParameters\n";
  std::ofstream(folder / "w.yaml")
      << "name: slope\nsize_m: [400, 400, 165]\nterrain:\n  cell_m: 10\n  grid: {file: "
         "g.asc}\nsites:\n  - {name: a, at_m: [300, 250]}\nbase_stations:\n  - {name: b, "
         "at_m: [100, 100]}\nstart: {at_m: [200, 200], radius_m: 10, height_m: [20, 40]}\n";
  std::ofstream(folder / "s.yaml")
      << "# Feet?\nname: feet\nmissions: 2\nset: {strategy: rbs, mission.world: w.yaml}\n";
}

TEST(OwnGroundTest, WhatWasAppliedIsSaid) {
  const ScratchFolder scratch;
  WriteGround(scratch / "mine");
  const std::string world = "world " + (scratch / "mine" / "w.yaml").string();
  const CommandResult text = Ed3r(world);
  ASSERT_EQ(text.status, 0) << text.err;
  EXPECT_EQ(text.err, "");
  EXPECT_NE(text.out.find("ground 0.0 .. 40.0 m, 0 trees"), std::string::npos) << text.out;
  EXPECT_NE(text.out.find("\nelevation grid: lengths in us-ft, heights in ft\n"), std::string::npos)
      << text.out;
  const auto json = nlohmann::json::parse(Ed3r(world + " --json").out);
  EXPECT_EQ(json["notes"].size(), 1u);
}

TEST(OwnGroundTest, ARunKeepsWhatStandsBesideItsGrid) {
  const ScratchFolder scratch;
  WriteGround(scratch / "mine");
  const std::string run = (scratch / "run").string();
  const CommandResult flown = Ed3r("run " + (scratch / "mine" / "s.yaml").string() + " --quiet --out " + run);
  ASSERT_EQ(flown.status, 0) << flown.err;
  fs::remove_all(scratch / "mine");
  const CommandResult again = Ed3r("replay " + run + " rbs/1 --out " + (scratch / "again").string());
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_NE(again.out.find("identical"), std::string::npos) << again.out;
}

// GDAL's own way to keep side files in a folder of their own, and its configuration files.
TEST(OwnGroundTest, WhatStandsBesideTheGridCountsAlone) {
  const ScratchFolder scratch;
  WriteGround(scratch / "mine");
  const std::string world = "world " + (scratch / "mine" / "w.yaml").string();
  const auto half = [&](const fs::path& file) {
    std::ofstream(file)
        << "<PAMDataset><PAMRasterBand band=\"1\"><Scale>0.5</Scale></PAMRasterBand></PAMDataset>";
  };
  const auto proxies = [&](const std::string& name, const std::string& of) {
    fs::create_directories(scratch / name);
    std::string header = "GDAL_PROXY        1";
    header.resize(100, ' ');
    std::ofstream(scratch / name / "gdal_pam_proxy.dat") << header << of << '\0' << "x.aux.xml" << '\0';
    return "GDAL_PAM_PROXY_DIR=" + (scratch / name).string();
  };
  const std::string halving = proxies("halving", fs::canonical(scratch / "mine" / "g.asc").string());
  half(scratch / "halving" / "x.aux.xml");
  EXPECT_NE(Ed3r(world, halving).out.find("ground 0.0 .. 40.0 m"), std::string::npos)
      << Ed3r(world, halving).out;

  const std::string hiding = proxies("hiding", fs::canonical(scratch / "mine" / "g.asc").string());
  std::ofstream(scratch / "hiding" / "x.aux.xml") << "<PAMDataset/>";
  std::ofstream(scratch / "rc") << "[configoptions]\nGDAL_PAM_ENABLED=NO\n";
  half(scratch / "mine" / "g.asc.aux.xml");
  for (const std::string& environment : {std::string(), hiding, std::string("GDAL_PAM_ENABLED=NO"),
                                         "GDAL_CONFIG_FILE=" + (scratch / "rc").string()}) {
    const CommandResult told = Ed3r(world, environment);
    EXPECT_NE(told.out.find("ground 0.0 .. 20.0 m"), std::string::npos)
        << environment << told.out << told.err;
  }
}

}  // namespace
}  // namespace ed3r::app
