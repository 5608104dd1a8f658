#include "engine/world/scene.h"

#include <gtest/gtest.h>

#include <utility>

#include "engine/core/check.h"
#include "tests/world/scene_builder.h"

namespace ed3r::world {
namespace {

double Slope(double x_m, double y_m) { return 0.2 * x_m + 0.1 * y_m; }

Scene::Parts Example() {
  Scene::Parts parts = PartsOf(51, 2.0, Slope,
                               {{.x_m = 20,
                                 .y_m = 20,
                                 .ground_m = 6,
                                 .height_m = 15,
                                 .trunk_radius_m = 0.2,
                                 .crown_radius_m = 2,
                                 .crown_depth_m = 9}});
  parts.sites = {{.name = "north", .base_m = {50, 80, 18}, .known = true}};
  parts.base_stations = {{.name = "mast", .antenna_m = {60, 40, 30}, .known = true}};
  parts.start = {.x_m = 50, .y_m = 50, .radius_m = 10, .height_min_m = 20, .height_max_m = 40};
  return parts;
}

TEST(Fingerprint, IsTheSameForEqualScenes) {
  const Scene a(Example());
  const Scene b(Example());
  EXPECT_EQ(a.Fingerprint(), b.Fingerprint());
  EXPECT_EQ(a.Fingerprint().size(), 64u);
}

TEST(Fingerprint, ChangesWithEverythingThatAMissionCanMeet) {
  const std::string original = Scene(Example()).Fingerprint();
  const auto changed = [&](auto change) {
    Scene::Parts parts = Example();
    change(parts);
    return Scene(std::move(parts)).Fingerprint() != original;
  };
  EXPECT_TRUE(changed([](Scene::Parts& p) { p.size_m.z() = 164.0; }));
  EXPECT_TRUE(changed([](Scene::Parts& p) { p.terrain.height_m[700] += 0.001f; }));
  EXPECT_TRUE(changed([](Scene::Parts& p) { p.trees[0].crown_radius_m = 2.1; }));
  EXPECT_TRUE(changed([](Scene::Parts& p) { p.trees.clear(); }));
  EXPECT_TRUE(changed([](Scene::Parts& p) { p.sites[0].base_m.x() += 1.0; }));
  EXPECT_TRUE(changed([](Scene::Parts& p) { p.sites[0].known = false; }));
  EXPECT_TRUE(changed([](Scene::Parts& p) { p.base_stations[0].antenna_m.z() += 1.0; }));
  EXPECT_TRUE(changed([](Scene::Parts& p) { p.start.height_max_m = 41.0; }));
  EXPECT_TRUE(changed([](Scene::Parts& p) { p.fire.lean_x_m = 9.0; }));
  EXPECT_FALSE(changed([](Scene::Parts& p) { p.name = "another"; }));
}

TEST(Scene, RefusesATreeOverTheStartArea) {
  Scene::Parts parts = Example();
  parts.trees[0].x_m = 50.0;
  parts.trees[0].y_m = 38.5;  // the crown's edge reaches half a metre over the disc
  EXPECT_THROW(Scene(std::move(parts)), InternalError);
}

TEST(Scene, RefusesATerrainThatIsNoGrid) {
  Scene::Parts parts = Example();
  parts.terrain.height_m.pop_back();
  EXPECT_THROW(Scene(std::move(parts)), InternalError);
}

}  // namespace
}  // namespace ed3r::world
