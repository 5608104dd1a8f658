#include "engine/world/world_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string_view>

#include "engine/world/files/stem_map.h"
#include "engine/world/files/strict_map.h"

namespace ed3r::world {
namespace {

constexpr double kMaxSideM = 4000.0;
constexpr double kMaxCells = 5e5;     // two triangles each; leaves half of Bullet's tree to the forest
constexpr std::size_t kMaxBases = 8;  // one on top of another
constexpr AllowedRange kPosition{.min = 0, .max = kMaxSideM, .unit = "m"};

// Files named in a world file lie relative to it.
std::string Beside(const std::string& world_file, const std::string& named) {
  return (std::filesystem::path(world_file).parent_path() / named).string();
}

// A world file with the keys of its bases, which are added to `bases`. `above` are the files that led here.
StrictMap WithBases(const std::string& file, std::vector<std::string> above,
                    std::vector<std::string>& bases) {
  StrictMap map = StrictMap::FromFile(file);
  std::string base;
  if (!map.Read("base", base)) return map;
  const std::string base_file = Beside(file, base);
  above.push_back(std::filesystem::weakly_canonical(file).string());
  const std::string canonical = std::filesystem::weakly_canonical(base_file).string();
  if (std::find(above.begin(), above.end(), canonical) != above.end())
    map.Fail("base", fmt::format("'{}' is not allowed; it takes over this file", base));
  if (above.size() > kMaxBases)
    map.Fail("base",
             fmt::format("'{}' is not allowed; at most {} bases on top of one another", base, kMaxBases));
  if (!std::filesystem::is_regular_file(base_file))
    map.Fail("base", fmt::format("'{}' is no file", base_file));
  bases.push_back(base_file);
  map.TakeOver(WithBases(base_file, std::move(above), bases));
  return map;
}

void ReadSize(StrictMap& map, WorldSpec& spec) {
  std::vector<double> size;
  map.Require("size_m", size, std::size_t{3}, std::size_t{3},
              AllowedRange{.min = 20, .max = kMaxSideM, .unit = "m"});
  if (size.size() == 3) spec.size_m = {size[0], size[1], size[2]};
  spec.size_place = map.Place("size_m");
}

RidgeSpec ReadRidge(StrictMap& map) {
  RidgeSpec ridge;
  // A crest may begin outside the area.
  map.Require("crest_m", ridge.crest_m, std::size_t{2}, std::size_t{50},
              AllowedRange{.min = -kMaxSideM, .max = 2 * kMaxSideM, .unit = "m"});
  map.Require("height_m", ridge.height_m, AllowedRange{.min = 0, .max = 1000, .unit = "m"});
  map.Require("half_width_m", ridge.half_width_m, AllowedRange{.min = 5, .max = 2000, .unit = "m"});
  map.Finish();
  return ridge;
}

GeneratedTerrainSpec ReadGenerated(StrictMap& map) {
  GeneratedTerrainSpec spec;
  map.Read("hills_height_m", spec.hills_height_m, {.min = 0, .max = 500, .unit = "m"});
  map.Read("hills_size_m", spec.hills_size_m, {.min = 20, .max = 5000, .unit = "m"});
  map.Read("bend_m", spec.bend_m, {.min = 0, .max = 200, .unit = "m"});
  map.Read("spurs", spec.spurs, {.min = 0, .max = 1});
  map.Read("saddles", spec.saddles, {.min = 0, .max = 1});
  map.Read("roughness_m", spec.roughness_m, {.min = 0, .max = 20, .unit = "m"});
  for (StrictMap& ridge : map.RequireMaps("ridges", 0, 50)) spec.ridges.push_back(ReadRidge(ridge));
  map.Finish();
  return spec;
}

std::optional<LengthUnit> ReadUnit(StrictMap& map, std::string_view key) {
  std::string word;
  if (!map.Read(key, word)) return std::nullopt;
  const std::optional<LengthUnit> unit = FindLengthUnit(word);
  if (!unit) map.Fail(key, fmt::format("'{}' is not allowed; allowed: {}", word, KnownLengthUnits()));
  return unit;
}

GridTerrainSpec ReadGrid(StrictMap& map, const WorldSpec& world) {
  GridTerrainSpec spec;
  spec.extent_m = world.size_m.head<2>();
  map.Require("file", spec.file);
  map.Read("offset_m", spec.offset_m, {.min = 0, .max = 1e7, .unit = "m"});
  map.Read("extent_m", spec.extent_m, {.min = 1, .max = 1e6, .unit = "m"});
  map.Read("height_scale", spec.height_scale, {.min = 0.001, .max = 1000});
  spec.length_unit = ReadUnit(map, "length_unit");
  spec.height_unit = ReadUnit(map, "height_unit");
  map.Finish();
  spec.file = Beside(map.File(), spec.file);
  spec.file_place = map.Place("file");
  spec.extent_place = map.Has("extent_m")   ? map.Place("extent_m")
                      : map.Has("offset_m") ? map.Place("offset_m")
                                            : spec.file_place;
  return spec;
}

void ReadTerrain(StrictMap& map, WorldSpec& spec) {
  map.RequireOneOf("generated", "grid");
  map.Read("cell_m", spec.cell_m, {.min = 0.5, .max = 50, .unit = "m"});
  if (auto generated = map.ReadMap("generated")) spec.generated = ReadGenerated(*generated);
  if (auto grid = map.ReadMap("grid")) spec.grid = ReadGrid(*grid, spec);
  map.Finish();
  const double columns = spec.size_m.x() / spec.cell_m;
  const double rows = spec.size_m.y() / spec.cell_m;
  const auto whole = [](double cells) { return std::abs(cells - std::round(cells)) < 1e-9; };
  if (!whole(columns) || !whole(rows) || columns < 2 || rows < 2)
    map.Fail("cell_m", fmt::format("{:g} m does not divide the area of {:g} x {:g} m into whole cells",
                                   spec.cell_m, spec.size_m.x(), spec.size_m.y()));
  if (columns * rows > kMaxCells)
    map.Fail("cell_m", fmt::format("{:g} m gives {:.0f} cells; allowed: at most {:.0f}", spec.cell_m,
                                   columns * rows, kMaxCells));
}

// [low, high]
void CheckOrder(const StrictMap& map, std::string_view key, const Eigen::Vector2d& interval) {
  if (interval.x() > interval.y())
    map.Fail(key, fmt::format("[{:g}, {:g}] is not allowed; the first must not exceed the second",
                              interval.x(), interval.y()));
}

GeneratedForestSpec ReadGeneratedForest(StrictMap& map) {
  GeneratedForestSpec spec;
  map.Read("spacing_m", spec.spacing_m, {.min = 2, .max = 200, .unit = "m"});
  map.Read("cover", spec.cover, {.min = 0, .max = 1});
  map.Read("clearing_size_m", spec.clearing_size_m, {.min = 10, .max = 1000, .unit = "m"});
  map.Read("height_m", spec.height_m, {.min = 1, .max = 120, .unit = "m"});
  map.Read("crown_radius_m", spec.crown_radius_m, {.min = 0.3, .max = 20, .unit = "m"});
  map.Finish();
  CheckOrder(map, "height_m", spec.height_m);
  CheckOrder(map, "crown_radius_m", spec.crown_radius_m);
  return spec;
}

void ReadStemColumns(StrictMap& map, StemMapSpec& spec) {
  std::optional<StrictMap> columns = map.ReadMap("columns");
  if (!columns) return;
  spec.columns_place = map.Place("columns");
  for (const std::string_view name : StemColumnNames()) {
    std::string header;
    if (columns->Read(name, header)) spec.columns[std::string(name)] = header;
  }
  columns->Finish();
}

StemMapSpec ReadStemMapSpec(StrictMap& map) {
  StemMapSpec spec;
  Eigen::Vector2d extent_m;
  map.Require("file", spec.file);
  map.Read("offset_m", spec.offset_m, {.min = 0, .max = 1e5, .unit = "m"});
  if (map.Read("extent_m", extent_m, {.min = 10, .max = 1e5, .unit = "m"})) spec.extent_m = extent_m;
  map.Read("height_scale", spec.height_scale, {.min = 0.05, .max = 10});
  map.Read("crown_scale", spec.crown_scale, {.min = 0.05, .max = 10});
  map.Read("min_height_m", spec.min_height_m, {.min = 0, .max = 120, .unit = "m"});
  map.Read("keep", spec.keep, {.min = 0, .max = 1});
  ReadStemColumns(map, spec);
  std::string word;
  if (map.Read("estimate_missing", word)) {
    spec.estimate_missing = FindForestKind(word);
    if (!spec.estimate_missing)
      map.Fail("estimate_missing",
               fmt::format("'{}' is not allowed; allowed: conifers | deciduous | mixed | tropical", word));
  }
  if (map.Read("same_spot", word)) {
    if (word != "tallest") map.Fail("same_spot", fmt::format("'{}' is not allowed; allowed: tallest", word));
    spec.tallest_of_a_spot = true;
  }
  map.Finish();
  spec.file = Beside(map.File(), spec.file);
  spec.file_place = map.Place("file");
  return spec;
}

ForestSpec ReadForest(StrictMap& map) {
  ForestSpec spec;
  constexpr AllowedRange kClear{.min = 0, .max = 200, .unit = "m"};
  map.RequireOneOf("generated", "stem_map");
  map.Read("slope_max", spec.slope_max, {.min = 0, .max = 100});
  map.Read("site_clear_m", spec.site_clear_m, kClear);
  map.Read("station_clear_m", spec.station_clear_m, kClear);
  map.Read("start_clear_m", spec.start_clear_m, kClear);
  if (auto generated = map.ReadMap("generated")) spec.generated = ReadGeneratedForest(*generated);
  if (auto stem_map = map.ReadMap("stem_map")) spec.stem_map = ReadStemMapSpec(*stem_map);
  map.Finish();
  return spec;
}

void ReadFromStart(StrictMap& map, PointSpec& point) {
  double distance_m = 0.0, bearing_deg = 0.0;
  map.Require("distance_m", distance_m, AllowedRange{.min = 0, .max = 2 * kMaxSideM, .unit = "m"});
  map.Require("bearing_deg", bearing_deg, AllowedRange{.min = -360, .max = 360, .unit = "degrees"});
  map.Finish();
  const double bearing = bearing_deg * std::numbers::pi / 180.0;
  point.at_m = distance_m * Eigen::Vector2d(std::sin(bearing), std::cos(bearing));
  point.from_start = true;
}

void ReadPosition(StrictMap& map, PointSpec& point) {
  map.RequireOneOf("at_m", "from_start");
  std::vector<double> at;
  if (map.Read("at_m", at, std::size_t{2}, std::size_t{3},
               AllowedRange{.min = -1e6, .max = 1e6, .unit = "m"}))
    point.at_m = {at[0], at[1]};
  if (at.size() == 3) point.z_m = at[2];
  if (auto from_start = map.ReadMap("from_start")) ReadFromStart(*from_start, point);
  point.place = map.Place(point.from_start ? "from_start" : "at_m");
}

std::vector<PointSpec> ReadPoints(StrictMap& world, std::string_view key, bool stations) {
  std::vector<PointSpec> points;
  for (StrictMap& map : world.RequireMaps(key, 1, 1000)) {
    PointSpec point;
    map.Require("name", point.name);
    ReadPosition(map, point);
    map.Read("known", point.known);
    if (stations) {
      point.above_ground_m = 10.0;
      if (map.Read("above_ground_m", point.above_ground_m, {.min = 0.5, .max = 100, .unit = "m"}) &&
          point.z_m)
        map.Fail("above_ground_m", "is not allowed together with a third number in at_m");
    }
    map.Finish();
    for (const PointSpec& other : points)
      if (other.name == point.name) map.Fail("name", fmt::format("'{}' is the name of two", point.name));
    points.push_back(std::move(point));
  }
  return points;
}

PlacedSitesSpec ReadPlaced(StrictMap& map) {
  PlacedSitesSpec spec;
  constexpr AllowedRange kCount{.min = 0, .max = 500};
  map.Read("seed", spec.seed);
  map.Require("known", spec.known, kCount);
  map.Require("unseen", spec.unseen, kCount);
  map.Require("distance_m", spec.distance_m, kPosition);
  map.Read("in_sight", spec.in_sight, {.min = 0, .max = 1});
  map.Read("apart_m", spec.apart_m, {.min = 0, .max = 1000, .unit = "m"});
  map.Finish();
  CheckOrder(map, "distance_m", spec.distance_m);
  CheckOrder(map, "in_sight", spec.in_sight);
  if (spec.known + spec.unseen == 0) map.Fail("known", "'0' is not allowed together with unseen: 0");
  return spec;
}

void ReadSites(StrictMap& map, WorldSpec& spec) {
  if (!map.HasMap("sites")) {
    spec.sites = ReadPoints(map, "sites", /*stations=*/false);
    return;
  }
  StrictMap sites = *map.ReadMap("sites");
  if (auto placed = sites.RequireMap("placed")) {
    spec.placed_sites = ReadPlaced(*placed);
    spec.placed_sites->place = sites.Place("placed");
  }
  sites.Finish();
}

void ReadStart(StrictMap& map, WorldSpec& spec) {
  Eigen::Vector2d at_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d height_m = Eigen::Vector2d::Zero();
  map.Require("at_m", at_m, kPosition);
  map.Require("radius_m", spec.start.radius_m, AllowedRange{.min = 0, .max = 500, .unit = "m"});
  map.Require("height_m", height_m, AllowedRange{.min = 1, .max = 500, .unit = "m"});
  map.Finish();
  CheckOrder(map, "height_m", height_m);
  spec.start.x_m = at_m.x();
  spec.start.y_m = at_m.y();
  spec.start.height_min_m = height_m.x();
  spec.start.height_max_m = height_m.y();
  spec.start_place = map.Place("at_m");
}

void ReadFire(StrictMap& map, FireShape& fire) {
  constexpr AllowedRange kLength{.min = 0.5, .max = 300, .unit = "m"};
  constexpr AllowedRange kLean{.min = -100, .max = 100, .unit = "m"};
  Eigen::Vector2d lean_m{fire.lean_x_m, fire.lean_y_m};
  map.Read("flame_height_m", fire.flame_height_m, kLength);
  map.Read("flame_radius_m", fire.flame_radius_m, kLength);
  map.Read("total_height_m", fire.total_height_m, kLength);
  map.Read("smoke_top_radius_m", fire.smoke_top_radius_m, kLength);
  map.Read("lean_m", lean_m, kLean);
  map.Finish();
  fire.lean_x_m = lean_m.x();
  fire.lean_y_m = lean_m.y();
  if (fire.total_height_m < fire.flame_height_m)
    map.Fail("total_height_m", fmt::format("'{:g}' is not allowed; at least flame_height_m = {:g}",
                                           fire.total_height_m, fire.flame_height_m));
}

}  // namespace

WorldSpec ReadWorldFile(const std::string& file) {
  WorldSpec spec;
  StrictMap map = WithBases(file, {}, spec.bases);
  spec.file = file;
  map.Require("name", spec.name);
  map.Read("seed", spec.seed);
  ReadSize(map, spec);
  std::optional<StrictMap> terrain = map.RequireMap("terrain");
  if (auto forest = map.ReadMap("forest")) {
    spec.forest = ReadForest(*forest);
    spec.forest->place = map.Place("forest");
  }
  ReadSites(map, spec);
  spec.base_stations = ReadPoints(map, "base_stations", /*stations=*/true);
  if (auto start = map.RequireMap("start")) ReadStart(*start, spec);
  for (std::vector<PointSpec>* points : {&spec.sites, &spec.base_stations})
    for (PointSpec& point : *points)
      if (point.from_start) point.at_m += Eigen::Vector2d(spec.start.x_m, spec.start.y_m);
  if (auto fire = map.ReadMap("fire")) ReadFire(*fire, spec.fire);
  map.Finish();
  ReadTerrain(*terrain, spec);  // after Finish: the grid of cells needs the area's size
  return spec;
}

std::vector<std::string> FilesOf(const WorldSpec& spec) {
  std::vector<std::string> files = spec.bases;
  files.push_back(spec.file);
  if (spec.grid) files.push_back(spec.grid->file);
  if (spec.forest && spec.forest->stem_map) files.push_back(spec.forest->stem_map->file);
  return files;
}

}  // namespace ed3r::world
