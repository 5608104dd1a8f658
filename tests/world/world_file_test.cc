// World files on top of others, and points that are placed from the start.
#include "engine/world/world_file.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "engine/core/check.h"
#include "engine/world/scene.h"
#include "tests/world/world_files.h"

namespace ed3r::world {
namespace {

class WorldFile : public ::testing::Test {
 protected:
  WorldFile() {
    folder.WriteGrid("flat.asc", 11, 9, 10.0, [](int, int) { return 7.0; });
    base = folder.Write("base.yaml", GridWorld("    file: flat.asc\n"));
  }

  // What reading and building says, with the test's folder cut away.
  std::string Message(const std::string& file) const {
    try {
      Scene::Load(file);
    } catch (const UserError& error) {
      std::string text = error.what();
      const std::string prefix = folder.Path("");
      for (auto at = text.find(prefix); at != std::string::npos; at = text.find(prefix))
        text.erase(at, prefix.size());
      return text;
    }
    return "no error";
  }

  const TestFolder folder;
  std::string base;
};

TEST_F(WorldFile, TakesOverItsBaseAndReplacesWholeKeys) {
  const WorldSpec spec = ReadWorldFile(folder.Write("w.yaml",
                                                    "base: base.yaml\nname: other\nsites:\n  - {name: c, "
                                                    "at_m: [30, 30]}\n  - {name: d, at_m: [40, 40]}\n"));
  EXPECT_EQ(spec.name, "other");
  EXPECT_EQ(spec.size_m, Eigen::Vector3d(100, 80, 165));
  ASSERT_EQ(spec.sites.size(), 2u);
  EXPECT_EQ(spec.sites[0].name, "c");
  ASSERT_EQ(spec.base_stations.size(), 1u);
  EXPECT_EQ(spec.base_stations[0].name, "b");
  EXPECT_EQ(spec.start.x_m, 50.0);
}

TEST_F(WorldFile, AnEmptyChangeIsTheSameWorld) {
  EXPECT_EQ(Scene::Load(folder.Write("w.yaml", "base: base.yaml\n"))->Fingerprint(),
            Scene::Load(base)->Fingerprint());
}

TEST_F(WorldFile, FilesOfABaseLieBesideIt) {
  std::filesystem::create_directories(folder.Path("sub"));
  const std::string inside = folder.Write("sub/w.yaml", "base: ../base.yaml\n");
  EXPECT_EQ(Scene::Load(inside)->Ground().height_m.size(), 51u * 41u);
  const std::string own =
      folder.Write("sub/own.yaml", "base: ../base.yaml\nterrain: {grid: {file: flat.asc}}\n");
  EXPECT_TRUE(Message(own).starts_with("sub/own.yaml:2:")) << Message(own);
}

TEST_F(WorldFile, ABaseMayHaveABase) {
  folder.Write("middle.yaml", "base: base.yaml\nname: middle\nseed: 4\n");
  const WorldSpec spec = ReadWorldFile(folder.Write("w.yaml", "base: middle.yaml\nseed: 5\n"));
  EXPECT_EQ(spec.name, "middle");
  EXPECT_EQ(spec.seed, 5u);
  EXPECT_EQ(spec.cell_m, 2.0);
}

TEST_F(WorldFile, ErrorsNameTheFileThatTheyStandIn) {
  folder.Write("bad.yaml", GridWorld("    file: flat.asc\n    offset_m: [-1, 0]\n"));
  EXPECT_EQ(Message(folder.Write("1.yaml", "base: bad.yaml\nname: x\n")),
            "bad.yaml:7:16: terrain.grid.offset_m: '-1' is not allowed; allowed: 0 .. 1e+07 m");
  folder.Write("far.yaml", "base: base.yaml\nsites:\n  - {name: a, at_m: [20, 200]}\n");
  EXPECT_TRUE(Message(folder.Write("2.yaml", "base: far.yaml\nname: x\n"))
                  .starts_with("far.yaml:3:21: site 'a' at [20, 200] m lies outside the terrain"));
  folder.Write("word.yaml", "base: base.yaml\nforrest: {}\n");
  EXPECT_EQ(Message(folder.Write("3.yaml", "base: word.yaml\n")),
            "word.yaml:2:1: forrest: unknown key; did you mean forest?");
  EXPECT_EQ(Message(folder.Write("4.yaml", "base: base.yaml\nsize_m: [100, 80]\n")),
            "4.yaml:2:9: size_m: '[...]' is not allowed; allowed: a list of 3 numbers (here 2)");
}

TEST_F(WorldFile, RefusesCyclesAndMissingBases) {
  EXPECT_EQ(Message(folder.Write("self.yaml", "base: self.yaml\n")),
            "self.yaml:1:7: base: 'self.yaml' is not allowed; it takes over this file");
  folder.Write("one.yaml", "base: two.yaml\n");
  folder.Write("two.yaml", "base: one.yaml\n");
  EXPECT_EQ(Message(folder.Path("one.yaml")),
            "two.yaml:1:7: base: 'one.yaml' is not allowed; it takes over this file");
  EXPECT_EQ(Message(folder.Write("w.yaml", "name: x\nbase: nowhere.yaml\n")),
            "w.yaml:2:7: base: 'nowhere.yaml' is no file");
}

TEST_F(WorldFile, RefusesALongChain) {
  for (int i = 0; i < 8; ++i)
    folder.Write(fmt::format("c{}.yaml", i), fmt::format("base: c{}.yaml\n", i + 1));
  folder.Write("c8.yaml", "base: base.yaml\n");
  EXPECT_EQ(Message(folder.Path("c0.yaml")),
            "c8.yaml:1:7: base: 'base.yaml' is not allowed; at most 8 bases on top of one another");
  EXPECT_EQ(Message(folder.Path("c1.yaml")), "no error");
}

TEST_F(WorldFile, PlacesPointsFromTheStart) {
  const WorldSpec spec = ReadWorldFile(folder.Write(
      "w.yaml",
      "base: base.yaml\n"
      "sites:\n  - {name: north, from_start: {distance_m: 20, bearing_deg: 0}, known: true}\n"
      "  - {name: east, from_start: {distance_m: 30, bearing_deg: 90}}\n"
      "base_stations:\n  - {name: b, from_start: {distance_m: 10, bearing_deg: 225}, above_ground_m: 5}\n"));
  EXPECT_NEAR((spec.sites[0].at_m - Eigen::Vector2d(50, 60)).norm(), 0.0, 1e-9);
  EXPECT_NEAR((spec.sites[1].at_m - Eigen::Vector2d(80, 40)).norm(), 0.0, 1e-9);
  const double diagonal_m = 10.0 * std::sqrt(0.5);
  EXPECT_NEAR((spec.base_stations[0].at_m - Eigen::Vector2d(50 - diagonal_m, 40 - diagonal_m)).norm(), 0.0,
              1e-9);
  EXPECT_EQ(spec.base_stations[0].above_ground_m, 5.0);
}

TEST_F(WorldFile, RefusesTwoPlacesOrNone) {
  EXPECT_EQ(
      Message(folder.Write("1.yaml",
                           "base: base.yaml\nsites:\n"
                           "  - {name: a, at_m: [1, 2], from_start: {distance_m: 1, bearing_deg: 2}}\n")),
      "1.yaml:3:41: sites[1].from_start: is not allowed together with sites[1].at_m");
  EXPECT_EQ(Message(folder.Write("2.yaml", "base: base.yaml\nsites:\n  - {name: a}\n")),
            "2.yaml:3:5: sites[1].at_m or from_start: is missing");
  EXPECT_EQ(
      Message(folder.Write(
                  "3.yaml",
                  "base: base.yaml\nsites:\n  - {name: a, from_start: {distance_m: 60, bearing_deg: 90}}\n"))
          .substr(0, 56),
      "3.yaml:3:27: site 'a' at [110, 40] m lies outside the te");
}

}  // namespace
}  // namespace ed3r::world
