// Sites that a world file leaves to a seed.
#include "engine/world/place_sites.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "engine/core/check.h"
#include "engine/world/measures.h"
#include "engine/world/scene.h"
#include "tests/world/world_files.h"

namespace ed3r::world {
namespace {

class PlacedSites : public ::testing::Test {
 protected:
  // 440 x 440 m, a ridge east of the start, sparse trees.
  std::string World(const std::string& placed) const {
    return folder.Write(
        "w.yaml",
        "name: placed\nseed: 2\nsize_m: [440, 440, 165]\nterrain:\n  cell_m: 4\n  generated:\n"
        "    ridges:\n      - {crest_m: [[300, -20], [300, 460]], height_m: 60, half_width_m: 60}\n"
        "forest:\n  generated:\n    spacing_m: 14\nsites:\n  placed: {" +
            placed +
            "}\nbase_stations:\n  - {name: mast, at_m: [200, 200]}\n"
            "start: {at_m: [220, 220], radius_m: 10, height_m: [20, 40]}\n");
  }

  std::string Message(const std::string& placed) const {
    const std::string file = World(placed);
    try {
      Scene::Load(file);
    } catch (const UserError& error) {
      return std::string(error.what()).substr(file.size() - std::string("w.yaml").size());
    }
    return "no error";
  }

  const TestFolder folder;
};

TEST_F(PlacedSites, TheSameSeedGivesTheSameSitesAndAnotherOthers) {
  const std::string keys = "known: 2, unseen: 3, distance_m: [80, 180], apart_m: 40, seed: ";
  const auto one = Scene::Load(World(keys + "1"));
  const auto again = Scene::Load(World(keys + "1"));
  const auto other = Scene::Load(World(keys + "2"));
  EXPECT_EQ(one->Fingerprint(), again->Fingerprint());
  for (std::size_t i = 0; i < one->Sites().size(); ++i)
    EXPECT_GT((one->Sites()[i].base_m - other->Sites()[i].base_m).norm(), 0.1);
}

TEST_F(PlacedSites, ObeyRingDistanceSightAndCounts) {
  for (int seed = 0; seed < 3; ++seed) {
    const auto scene = Scene::Load(World(fmt::format(
        "seed: {}, known: 4, unseen: 6, distance_m: [90, 190], in_sight: [0.4, 0.7], apart_m: 50", seed)));
    const WorldMeasures measures = MeasureWorld(*scene);
    ASSERT_EQ(measures.all.sites, 10);
    EXPECT_EQ(measures.known.sites, 4);
    EXPECT_GE(measures.all.distance_min_m, 90.0);
    EXPECT_LE(measures.all.distance_max_m, 190.0);
    for (const SiteMeasure& site : measures.sites) {
      // Clearings of sites that were drawn later may open a view a little further.
      EXPECT_GE(site.sight_around, 0.4);
      EXPECT_LE(site.sight_around, 0.73);
    }
    for (const FireSite& site : scene->Sites()) {
      EXPECT_EQ(site.base_m.z(), scene->Ground().HeightAt(site.base_m.x(), site.base_m.y()));
      EXPECT_GE(std::min(site.base_m.x(), site.base_m.y()), 20.0);
      EXPECT_LE(std::max(site.base_m.x(), site.base_m.y()), 420.0);
      for (const FireSite& other : scene->Sites())
        EXPECT_TRUE(other.name == site.name || (other.base_m - site.base_m).head<2>().norm() >= 50.0);
    }
  }
}

TEST_F(PlacedSites, LieAllAroundTheStartAndTakeTurns) {
  const auto scene = Scene::Load(World("known: 4, unseen: 4, distance_m: [80, 180]"));
  std::vector<int> quadrants(4, 0);
  for (const SiteMeasure& site : MeasureWorld(*scene).sites)
    ++quadrants[static_cast<std::size_t>(site.bearing_deg / 90.0)];
  for (const int sites : quadrants) EXPECT_GE(sites, 1);
  for (std::size_t i = 1; i < scene->Sites().size(); ++i)
    EXPECT_NE(scene->Sites()[i].known, scene->Sites()[i - 1].known);
  EXPECT_EQ(scene->Sites()[0].name, "site 1");
}

TEST_F(PlacedSites, MoveNoTreeElsewhere) {
  const auto one = Scene::Load(World("seed: 1, known: 1, unseen: 1, distance_m: [80, 180]"));
  const auto other = Scene::Load(World("seed: 2, known: 1, unseen: 1, distance_m: [80, 180]"));
  const auto far_trees = [&](const Scene& scene) {
    std::vector<std::pair<double, double>> places;
    for (const Tree& tree : scene.Trees()) {
      const auto near = [&](const FireSite& site) {
        return std::hypot(tree.x_m - site.base_m.x(), tree.y_m - site.base_m.y()) < 20.0;
      };
      if (std::ranges::none_of(one->Sites(), near) && std::ranges::none_of(other->Sites(), near))
        places.emplace_back(tree.x_m, tree.height_m);
    }
    return places;
  };
  EXPECT_GT(far_trees(*one).size(), 200u);
  EXPECT_EQ(far_trees(*one), far_trees(*other));
}

TEST_F(PlacedSites, RefusalsSayWhatWasFoundAndWhatToWiden) {
  const std::string sight = Message("known: 2, unseen: 2, distance_m: [80, 180], in_sight: [0.99, 1]");
  EXPECT_TRUE(
      sight.starts_with("w.yaml:13:11: sites.placed: 0 of 4 sites found in 4000 draws; sight_around there: "))
      << sight;
  EXPECT_TRUE(
      sight.ends_with("; widen in_sight = [0.99, 1] or distance_m = [80, 180], or lower apart_m = 40"))
      << sight;
  const std::string apart = Message("known: 2, unseen: 2, distance_m: [10, 20], apart_m: 60");
  EXPECT_TRUE(apart.starts_with("w.yaml:13:11: sites.placed: 1 of 4 sites found in 4000 draws; ")) << apart;
  EXPECT_EQ(Message("known: 2, unseen: 2, distance_m: [400, 500]"),
            "w.yaml:13:11: sites.placed: 0 of 4 sites found in 4000 draws; no place of the ring lies 20 m "
            "inside the area; change distance_m = [400, 500], or the area");
}

TEST_F(PlacedSites, RefuseBadKeys) {
  EXPECT_EQ(Message("known: 0, unseen: 0, distance_m: [80, 180]"),
            "w.yaml:13:19: sites.placed.known: '0' is not allowed together with unseen: 0");
  EXPECT_EQ(Message("known: 1, unseen: 1, distance_m: [180, 80]"),
            "w.yaml:13:45: sites.placed.distance_m: [180, 80] is not allowed; the first must not exceed the "
            "second");
  EXPECT_EQ(Message("known: 1, unseen: 1"), "w.yaml:13:11: sites.placed.distance_m: is missing");
  EXPECT_EQ(Message("known: 1, unseen: 1, distance_m: [80, 180], insight: [0, 1]"),
            "w.yaml:13:56: sites.placed.insight: unknown key; did you mean sites.placed.in_sight?");
}

}  // namespace
}  // namespace ed3r::world
