// The worlds that are shipped, and what every loaded scene promises.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "engine/core/random.h"
#include "engine/world/scene.h"
#include "tests/world/world_files.h"

namespace ed3r::world {
namespace {

using Eigen::Vector3d;

std::string Shipped(const std::string& name) {
  return std::string(ED3R_SOURCE_DIR) + "/sweeps/worlds/" + name + ".yaml";
}

// Share of the fire's axis up to a height that can be seen from a point.
double VisibleShare(const Scene& scene, const Vector3d& eye_m, const FireSite& site, double height_m) {
  constexpr int kPoints = 46;
  int visible = 0;
  for (int i = 0; i < kPoints; ++i) {
    const double share = (i + 0.5) / kPoints * height_m / scene.Fire().total_height_m;
    const Vector3d point = site.base_m + share * Vector3d(scene.Fire().lean_x_m, scene.Fire().lean_y_m,
                                                          scene.Fire().total_height_m);
    if (!scene.Geometry().Occluded(eye_m, point)) ++visible;
  }
  return static_cast<double>(visible) / kPoints;
}

// Loading takes about a second: each world once for all tests.
const std::shared_ptr<const Scene>& LoadedOnce(const std::string& name) {
  static std::map<std::string, std::shared_ptr<const Scene>> worlds;
  std::shared_ptr<const Scene>& world = worlds[name];
  if (!world) world = Scene::Load(Shipped(name));
  return world;
}

class ShippedWorld : public ::testing::TestWithParam<const char*> {
 protected:
  const std::shared_ptr<const Scene> scene = LoadedOnce(GetParam());
};

TEST_P(ShippedWorld, HasThePapersNumbers) {
  EXPECT_EQ(scene->Name(), GetParam());
  EXPECT_EQ(scene->SizeM().head<2>(), Eigen::Vector2d(530, 530));
  EXPECT_EQ(scene->Sites().size(), 14u);
  EXPECT_EQ(std::ranges::count_if(scene->Sites(), &FireSite::known), 6);
  EXPECT_EQ(scene->BaseStations().size(), 2u);
  EXPECT_EQ(std::ranges::count_if(scene->BaseStations(), &BaseStation::known), 1);
  EXPECT_DOUBLE_EQ(scene->Fire().total_height_m, 46.0);
  EXPECT_GE(scene->Trees().size(), 3000u);
  EXPECT_LE(scene->Trees().size(), 5000u);
}

TEST_P(ShippedWorld, LeavesRoomToFly) {
  double top_m = 0.0;
  for (const Tree& tree : scene->Trees()) top_m = std::max(top_m, tree.ground_m + tree.height_m);
  EXPECT_LT(top_m, scene->SizeM().z() - 40.0);
}

TEST_P(ShippedWorld, TreesStandOnTheGroundWithinTheArea) {
  for (const Tree& tree : scene->Trees()) {
    ASSERT_DOUBLE_EQ(tree.ground_m, scene->Ground().HeightAt(tree.x_m, tree.y_m));
    ASSERT_GE(std::min(tree.x_m, tree.y_m), tree.crown_radius_m);
    ASSERT_LE(std::max(tree.x_m, tree.y_m), 530.0 - tree.crown_radius_m);
    ASSERT_GE(tree.trunk_radius_m, 0.15);
    ASSERT_LE(tree.crown_depth_m, tree.height_m);
    ASSERT_LE(tree.height_m, 25.2);
  }
}

TEST_P(ShippedWorld, StartColumnsAreClear) {
  // Straight down from any start there is nothing but the ground.
  Stream stream(1, 0, Purpose::kScenario);
  const StartArea& start = scene->Start();
  for (int i = 0; i < 2000; ++i) {
    const double radius_m = start.radius_m * std::sqrt(stream.Uniform());
    const double angle = stream.Uniform(0.0, 6.283185307179586);
    const double x = start.x_m + radius_m * std::cos(angle);
    const double y = start.y_m + radius_m * std::sin(angle);
    const double height_m = stream.Uniform(start.height_min_m, start.height_max_m);
    const double z = scene->Ground().HeightAt(x, y) + height_m;
    ASSERT_LE(z, scene->SizeM().z());
    ASSERT_NEAR(scene->Geometry().Distance({x, y, z}, -Vector3d::UnitZ(), 200.0), height_m, 1e-3);
  }
}

TEST_P(ShippedWorld, FiresAndAntennasStandClearOfTrees) {
  for (const FireSite& site : scene->Sites()) {
    EXPECT_NEAR(site.base_m.z(), scene->Ground().HeightAt(site.base_m.x(), site.base_m.y()), 1e-9);
    for (const Tree& tree : scene->Trees())
      ASSERT_GT(std::hypot(tree.x_m - site.base_m.x(), tree.y_m - site.base_m.y()),
                scene->Fire().flame_radius_m + tree.crown_radius_m);
  }
  for (const BaseStation& station : scene->BaseStations())
    EXPECT_NEAR(scene->Geometry().Distance(station.antenna_m, -Vector3d::UnitZ(), 100.0), 10.0, 1e-3);
}

TEST_P(ShippedWorld, SomeFiresAreOpenAndSomeAreHidden) {
  const StartArea& start = scene->Start();
  const Vector3d eye_m(start.x_m, start.y_m, scene->Ground().HeightAt(start.x_m, start.y_m) + 40.0);
  int open = 0;
  int hidden = 0;
  for (const FireSite& site : scene->Sites()) {
    open += VisibleShare(*scene, eye_m, site, scene->Fire().total_height_m) > 0.6;
    hidden += VisibleShare(*scene, eye_m, site, scene->Fire().flame_height_m) <
              0.25;  // smoke may rise above a ridge
  }
  EXPECT_GE(open, 5);
  EXPECT_GE(hidden, 4);
}

TEST_P(ShippedWorld, LoadsTheSameTwice) {
  EXPECT_EQ(Scene::Load(Shipped(GetParam()))->Fingerprint(), scene->Fingerprint());
}

INSTANTIATE_TEST_SUITE_P(Worlds, ShippedWorld, ::testing::Values("ridges", "cascades", "maungawhau"));

std::string GeneratedWorld(int seed, const std::string& sites) {
  return "name: small\nseed: " + std::to_string(seed) +
         "\nsize_m: [200, 200, 165]\nterrain:\n  generated:\n    ridges:\n"
         "      - {crest_m: [[100, -20], [100, 220]], height_m: 60, half_width_m: 50}\n"
         "forest:\n  generated:\n    spacing_m: 7\nsites:\n" +
         sites +
         "base_stations:\n  - {name: mast, at_m: [60, 60]}\n"
         "start: {at_m: [150, 100], radius_m: 10, height_m: [20, 40]}\n";
}

TEST(GeneratedWorld, SeedsGiveDifferentWorlds) {
  const TestFolder folder;
  const std::string sites = "  - {name: a, at_m: [30, 30]}\n";
  const auto one = Scene::Load(folder.Write("1.yaml", GeneratedWorld(1, sites)));
  const auto two = Scene::Load(folder.Write("2.yaml", GeneratedWorld(2, sites)));
  EXPECT_NE(one->Fingerprint(), two->Fingerprint());
  EXPECT_NE(one->Ground().height_m, two->Ground().height_m);
}

TEST(GeneratedWorld, ARidgeRisesAndHidesWhatLiesBehind) {
  const TestFolder folder;
  const auto scene =
      Scene::Load(folder.Write("w.yaml", GeneratedWorld(1, "  - {name: a, at_m: [30, 100]}\n")));
  const Terrain& ground = scene->Ground();
  double crest_m = 0.0;
  for (double x = 80.0; x <= 120.0; x += 2.0) crest_m = std::max(crest_m, ground.HeightAt(x, 100.0));
  EXPECT_GT(crest_m, ground.HeightAt(30.0, 100.0) + 30.0);
  EXPECT_GT(crest_m, ground.HeightAt(170.0, 100.0) + 30.0);
  const Vector3d eye_m(170.0, 100.0, ground.HeightAt(170.0, 100.0) + 10.0);
  EXPECT_TRUE(scene->Geometry().Occluded(eye_m, scene->Sites()[0].base_m + Vector3d(0, 0, 10)));
}

TEST(GeneratedWorld, MovingASiteMovesNoTreeElsewhere) {
  const TestFolder folder;
  const auto here = Scene::Load(folder.Write("1.yaml", GeneratedWorld(1, "  - {name: a, at_m: [30, 30]}\n")));
  const auto there =
      Scene::Load(folder.Write("2.yaml", GeneratedWorld(1, "  - {name: a, at_m: [170, 170]}\n")));
  const auto far_trees = [](const Scene& scene) {
    std::vector<std::pair<double, double>> places;
    for (const Tree& tree : scene.Trees())
      if (std::hypot(tree.x_m - 30, tree.y_m - 30) > 20 && std::hypot(tree.x_m - 170, tree.y_m - 170) > 20)
        places.emplace_back(tree.x_m, tree.height_m);
    return places;
  };
  EXPECT_GT(far_trees(*here).size(), 200u);
  EXPECT_EQ(far_trees(*here), far_trees(*there));
}

TEST(StemMapWorld, TilesTheStandAndMirrorsEveryOtherTile) {
  const TestFolder folder;
  folder.Write("stems.csv",
               "y_m,x_m,species,dbh_cm,height_m,crown_depth_m,crown_radius_m\n"
               "200,100,DF,20,30,10,1\n210,120,DF,80,40,20,2\n240,140,DF,10,5,2,1\n");
  folder.WriteGrid("flat.asc", 11, 9, 10.0, [](int, int) { return 7.0; });
  const auto scene = Scene::Load(folder.Write(
      "w.yaml",
      GridWorld("    file: flat.asc\n") +
          "forest:\n  site_clear_m: 0\n  station_clear_m: 0\n  start_clear_m: 0\n"
          "  stem_map: {file: stems.csv, height_scale: 0.5, crown_scale: 0.75, min_height_m: 10}\n"));
  // The stand measures 40 x 40 m; its first tree stands in a corner, where its crown leaves the first tile's
  // area or meets its mirror image, its second at (20, 10); its third is too low.
  std::vector<std::pair<double, double>> tall;
  for (const Tree& tree : scene->Trees()) {
    if (tree.height_m != 20.0) continue;
    tall.emplace_back(tree.x_m, tree.y_m);
    EXPECT_DOUBLE_EQ(tree.crown_radius_m, 1.5);
    EXPECT_DOUBLE_EQ(tree.crown_depth_m, 10.0);
    EXPECT_DOUBLE_EQ(tree.trunk_radius_m, 0.2);
  }
  std::ranges::sort(tall);
  const std::vector<std::pair<double, double>> expected = {{20, 10}, {20, 70}, {60, 10}, {60, 70}};
  EXPECT_EQ(tall, expected);
  for (const Tree& tree : scene->Trees()) EXPECT_GE(tree.height_m, 10.0);
}

// A tree far from the others makes a stand that the world takes an empty corner of.
TEST(StemMapWorld, AForestWithoutATreeIsSaid) {
  const TestFolder folder;
  folder.Write("stems.csv",
               "x_m,y_m,dbh_cm,height_m,crown_depth_m,crown_radius_m\n"
               "0,0,20,30,10,1\n2000,1500,80,40,20,2\n2010,1520,20,20,8,2\n");
  folder.WriteGrid("flat.asc", 11, 9, 10.0, [](int, int) { return 7.0; });
  const auto scene = Scene::Load(
      folder.Write("w.yaml", GridWorld("    file: flat.asc\n") + "forest:\n  stem_map: {file: stems.csv}\n"));
  EXPECT_TRUE(scene->Trees().empty());
  const std::vector<std::string> notes = {
      "stem map: one tree in 102 ha of a stand of 2010 x 1520 m; farthest away is the tree at [0, 0] m",
      "stem map: none of its 2 trees stands in this world (the stand's part of 2010 x 1520 m, laid over 100 "
      "x 80 m; "
      "clearings, slope_max, min_height_m, keep)"};
  EXPECT_EQ(scene->Notes(), notes);
}

}  // namespace
}  // namespace ed3r::world
