// A small flat world with three fires, quick to build.
#pragma once

#include "engine/world/scene.h"

namespace ed3r::mission {

inline world::Scene::Parts FlatParts() {
  world::Scene::Parts parts;
  parts.name = "flat";
  parts.size_m = {400, 400, 165};
  parts.terrain = {
      .columns = 101, .rows = 101, .cell_m = 4.0, .height_m = std::vector<float>(101 * 101, 0.0F)};
  parts.sites = {{.name = "near", .base_m = {260, 200, 0}, .known = true},
                 {.name = "far", .base_m = {60, 330, 0}, .known = false},
                 {.name = "east", .base_m = {330, 120, 0}, .known = true}};
  parts.base_stations = {{.name = "one", .antenna_m = {200, 170, 12}, .known = true},
                         {.name = "two", .antenna_m = {180, 230, 12}, .known = false}};
  parts.start = {.x_m = 200, .y_m = 200, .radius_m = 10, .height_min_m = 30, .height_max_m = 50};
  return parts;
}

}  // namespace ed3r::mission
