// Measures of worlds so small that their sights are known.
#include "engine/world/measures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "engine/world/sight.h"
#include "tests/world/scene_builder.h"

namespace ed3r::world {
namespace {

using Eigen::Vector3d;

// 600 x 600 m around a start in the middle, the ground as given.
Scene::Parts Around(const std::function<double(double, double)>& height_m, std::vector<Tree> trees = {}) {
  Scene::Parts parts = PartsOf(301, 2.0, height_m, std::move(trees));
  parts.start = {.x_m = 300, .y_m = 300, .radius_m = 15, .height_min_m = 20, .height_max_m = 40};
  return parts;
}

FireSite SiteAt(const Scene::Parts& parts, const char* name, double x_m, double y_m, bool known) {
  return {name, {x_m, y_m, parts.terrain.HeightAt(x_m, y_m)}, known};
}

double Flat(double, double) { return 5.0; }

// A wall across the area, higher than everything that could look over it.
double Wall(double, double y_m) { return y_m > 480 && y_m < 490 ? 160.0 : 5.0; }

TEST(Measures, OpenGroundIsSeenWholeAndBehindAWallNothing) {
  Scene::Parts parts = Around(Wall);
  parts.sites = {SiteAt(parts, "open", 300, 120, true), SiteAt(parts, "hidden", 300, 550, false)};
  const WorldMeasures measures = MeasureWorld(Scene(std::move(parts)));
  EXPECT_DOUBLE_EQ(measures.sites[0].sight_start, 1.0);
  // Only the places that are above or too near for a level camera are lost.
  EXPECT_GT(measures.sites[0].sight_around, 0.75);
  EXPECT_DOUBLE_EQ(measures.sites[1].sight_start, 0.0);
  EXPECT_DOUBLE_EQ(measures.sites[1].sight_around, 0.0);
}

TEST(Measures, DistanceAndBearingAreSeenFromTheStart) {
  Scene::Parts parts = Around(Flat);
  parts.sites = {SiteAt(parts, "north", 300, 450, true), SiteAt(parts, "east", 500, 300, false),
                 SiteAt(parts, "south-west", 200, 200, false)};
  parts.base_stations = {{"mast", {280, 300, 15}, true}};
  const WorldMeasures measures = MeasureWorld(Scene(std::move(parts)));
  EXPECT_DOUBLE_EQ(measures.sites[0].distance_m, 150.0);
  EXPECT_DOUBLE_EQ(measures.sites[0].bearing_deg, 0.0);
  EXPECT_DOUBLE_EQ(measures.sites[1].bearing_deg, 90.0);
  EXPECT_DOUBLE_EQ(measures.sites[2].bearing_deg, 225.0);
  EXPECT_TRUE(measures.sites[0].known);
  EXPECT_DOUBLE_EQ(measures.base_stations[0].distance_m, 20.0);
  EXPECT_DOUBLE_EQ(measures.base_stations[0].bearing_deg, 270.0);
  EXPECT_DOUBLE_EQ(measures.all.distance_max_m, 200.0);
  EXPECT_NEAR(measures.all.distance_min_m, 141.42, 0.01);
  EXPECT_NEAR(measures.unseen.distance_mean_m, 170.71, 0.01);
  EXPECT_EQ(measures.start_height_max_m, 40.0);
}

TEST(Measures, SpreadTellsAlikeFromUnlike) {
  Scene::Parts parts = Around(Wall);
  parts.sites = {SiteAt(parts, "open", 300, 120, true), SiteAt(parts, "open too", 301, 120, true),
                 SiteAt(parts, "hidden", 300, 550, false)};
  const WorldMeasures measures = MeasureWorld(Scene(std::move(parts)));
  EXPECT_EQ(measures.known.sites, 2);
  EXPECT_LT(measures.known.sight_variation, 0.05);
  EXPECT_EQ(measures.unseen.sight_mean, 0.0);
  EXPECT_EQ(measures.unseen.sight_variation, 0.0);
  // Values a, a, 0: the mean is 2a/3, the deviation a sqrt(2)/3.
  EXPECT_NEAR(measures.all.sight_variation, std::sqrt(0.5), 0.03);
}

TEST(Sight, ALevelCameraLosesWhatIsFarAboveOrBelow) {
  Scene::Parts parts = Around(Flat);
  const Scene scene(std::move(parts));
  const ViewArea high{{300, 300}, 0.0, 100.0, 100.0};
  const Sight sight(high, scene.SizeM(), scene.Ground(), scene.Fire(), scene.Geometry(), scene.Trees());
  EXPECT_EQ(sight.Of({310, 300, 5}), 0.0);      // all of it more than 25 degrees below the horizon
  EXPECT_EQ(sight.Of({580, 300, 5}), 1.0);      // all of it less
  const double part = sight.Of({430, 300, 5});  // 46 m of fire from 100 m above: the flame is below the frame
  EXPECT_GT(part, 0.1);
  EXPECT_LT(part, 0.9);
}

TEST(Sight, ViewpointsStayInsideTheAreaAndBelowItsTop) {
  Scene::Parts parts = Around([](double x_m, double) { return 0.2 * x_m; });
  parts.start.x_m = 20;
  parts.start.y_m = 580;
  const Scene scene(std::move(parts));
  const Sight sight(AroundStart(scene.Start()), scene.SizeM(), scene.Ground(), scene.Fire(), scene.Geometry(),
                    scene.Trees());
  ASSERT_EQ(sight.ViewpointsM().size(), static_cast<std::size_t>(Sight::kViewpoints));
  for (const Vector3d& at_m : sight.ViewpointsM()) {
    EXPECT_GE(at_m.x(), 0.0);
    EXPECT_LE(at_m.y(), 600.0);
    EXPECT_LE(std::hypot(at_m.x() - 20, at_m.y() - 580), 150.0);
    const double above_m = at_m.z() - scene.Ground().HeightAt(at_m.x(), at_m.y());
    EXPECT_GE(above_m, 5.0);
    EXPECT_LE(at_m.z(), scene.SizeM().z());
  }
}

TEST(Sight, AFelledTreeHidesNothing) {
  // A ring of trees close around the site, and one further away that stays.
  std::vector<Tree> trees;
  for (int i = 0; i < 24; ++i) {
    const double angle = i * 2.0 * 3.14159265358979 / 24;
    trees.push_back({450 + 10 * std::cos(angle), 300 + 10 * std::sin(angle), 5, 25, 0.4, 3.0, 20});
  }
  const std::vector<Tree> ring = trees;
  trees.push_back({400, 300, 5, 30, 0.5, 5.0, 25});
  const Scene forest(Around(Flat, trees));
  const Scene cleared(Around(Flat, {trees.back()}));
  const Sight in_forest(StartView(forest.Start()), forest.SizeM(), forest.Ground(), forest.Fire(),
                        forest.Geometry(), forest.Trees());
  const Sight in_clearing(StartView(cleared.Start()), cleared.SizeM(), cleared.Ground(), cleared.Fire(),
                          cleared.Geometry(), cleared.Trees());
  const Vector3d site(450, 300, 5);
  const std::vector<ClearDisc> clearing = {{450, 300, 8}};
  EXPECT_LT(in_forest.Of(site), in_clearing.Of(site) - 0.05);
  EXPECT_EQ(in_forest.Of(site, clearing), in_clearing.Of(site));
}

}  // namespace
}  // namespace ed3r::world
