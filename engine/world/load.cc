#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "engine/world/bake.h"
#include "engine/world/forest.h"
#include "engine/world/place_sites.h"
#include "engine/world/scene.h"
#include "engine/world/terrain.h"
#include "engine/world/world_file.h"

namespace ed3r::world {
namespace {

Terrain BuildTerrain(const WorldSpec& spec, std::vector<std::string>& notes) {
  Terrain terrain = spec.grid ? ReadElevationGrid(*spec.grid, spec.size_m, spec.cell_m, &notes)
                              : GenerateTerrain(*spec.generated, spec.size_m, spec.cell_m, spec.seed);
  const float highest = *std::max_element(terrain.height_m.begin(), terrain.height_m.end());
  if (highest >= spec.size_m.z())
    FailAt(spec.size_place,
           fmt::format("size_m: the ground rises to {:.1f} m; allowed: below the area's height "
                       "of {:g} m (raise it or lower the terrain)",
                       highest, spec.size_m.z()));
  return terrain;
}

// Where a point stands: on the ground, or at a height of its own between the ground and the area's top.
Eigen::Vector3d Place(const PointSpec& point, const std::string& what, const WorldSpec& spec,
                      const Terrain& terrain) {
  const double x = point.at_m.x();
  const double y = point.at_m.y();
  if (x < 0.0 || y < 0.0 || x > spec.size_m.x() || y > spec.size_m.y())
    FailAt(point.place,
           fmt::format("{} '{}' at [{:g}, {:g}] m lies outside the terrain; allowed: 0 .. {:g} m east, "
                       "0 .. {:g} m north",
                       what, point.name, x, y, spec.size_m.x(), spec.size_m.y()));
  const double ground_m = terrain.HeightAt(x, y);
  const double z_m = point.z_m.value_or(ground_m + point.above_ground_m);
  if (z_m < ground_m || z_m > spec.size_m.z())
    FailAt(point.place,
           fmt::format("{} '{}' at {:g} m is {}; allowed there: {:.2f} .. {:g} m", what, point.name, z_m,
                       z_m < ground_m ? "inside the ground" : "above the area", ground_m, spec.size_m.z()));
  return {x, y, z_m};
}

void CheckStart(const WorldSpec& spec, const Terrain& terrain) {
  const StartArea& start = spec.start;
  if (start.x_m - start.radius_m < 0.0 || start.y_m - start.radius_m < 0.0 ||
      start.x_m + start.radius_m > spec.size_m.x() || start.y_m + start.radius_m > spec.size_m.y())
    FailAt(spec.start_place,
           fmt::format("start: a disc of {:g} m around [{:g}, {:g}] m leaves the area of {:g} x {:g} m",
                       start.radius_m, start.x_m, start.y_m, spec.size_m.x(), spec.size_m.y()));
  // The nodes around the disc bound its ground: no start may lie above the area.
  const auto node = [&](double at_m, int last) {
    return std::clamp(static_cast<int>(std::lround(at_m / terrain.cell_m)), 0, last);
  };
  float highest_m = 0.0f;
  for (int row = node(start.y_m - start.radius_m - terrain.cell_m, terrain.rows - 1);
       row <= node(start.y_m + start.radius_m + terrain.cell_m, terrain.rows - 1); ++row)
    for (int column = node(start.x_m - start.radius_m - terrain.cell_m, terrain.columns - 1);
         column <= node(start.x_m + start.radius_m + terrain.cell_m, terrain.columns - 1); ++column)
      highest_m =
          std::max(highest_m, terrain.height_m[static_cast<std::size_t>(row) * terrain.columns + column]);
  if (highest_m + start.height_max_m > spec.size_m.z())
    FailAt(spec.start_place,
           fmt::format("start: {:g} m above ground of {:.1f} m is above the area of {:g} m height",
                       start.height_max_m, highest_m, spec.size_m.z()));
}

std::vector<ClearDisc> ClearDiscs(const ForestSpec& forest, const Scene::Parts& parts) {
  std::vector<ClearDisc> discs;
  for (const FireSite& site : parts.sites)
    discs.push_back({site.base_m.x(), site.base_m.y(), forest.site_clear_m});
  for (const BaseStation& station : parts.base_stations)
    discs.push_back({station.antenna_m.x(), station.antenna_m.y(), forest.station_clear_m});
  discs.push_back({parts.start.x_m, parts.start.y_m, parts.start.radius_m + forest.start_clear_m});
  return discs;
}

std::vector<Tree> BuildForest(const WorldSpec& spec, const Scene::Parts& parts,
                              std::vector<std::string>* notes = nullptr) {
  if (!spec.forest) return {};
  std::vector<Tree> trees = PlantForest(*spec.forest, parts.size_m, parts.terrain,
                                        ClearDiscs(*spec.forest, parts), spec.seed, notes);
  const std::size_t cells = static_cast<std::size_t>(parts.terrain.columns - 1) * (parts.terrain.rows - 1);
  const std::size_t most = (StaticGeometry::kMaxTriangles - 2 * cells) / kTrianglesPerTree;
  if (trees.size() > most)
    FailAt(spec.forest->place, fmt::format("forest: {} trees on {} cells of ground; allowed: up to {}",
                                           trees.size(), cells, most));
  return trees;
}

}  // namespace

std::shared_ptr<const Scene> Scene::Load(const std::string& world_file) {
  const WorldSpec spec = ReadWorldFile(world_file);
  Parts parts;
  parts.name = spec.name;
  parts.size_m = spec.size_m;
  parts.terrain = BuildTerrain(spec, parts.notes);
  for (const PointSpec& site : spec.sites)
    parts.sites.push_back({site.name, Place(site, "site", spec, parts.terrain), site.known});
  for (const PointSpec& station : spec.base_stations)
    parts.base_stations.push_back(
        {station.name, Place(station, "base station", spec, parts.terrain), station.known});
  CheckStart(spec, parts.terrain);
  parts.start = spec.start;
  parts.fire = spec.fire;
  if (spec.placed_sites) {
    parts.trees = BuildForest(spec, parts);  // without clearings for sites: they are not known yet
    parts.sites = PlaceSites(spec, parts);
  }
  parts.trees = BuildForest(spec, parts, &parts.notes);
  return std::make_shared<const Scene>(std::move(parts));
}

}  // namespace ed3r::world
