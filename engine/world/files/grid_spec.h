// What a world file says of its elevation grid.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "engine/world/files/length_unit.h"
#include "engine/world/files/text_place.h"

namespace ed3r::world {

// Terrain from a real elevation grid. The area's south-west corner lies offset_m from the centre of the
// grid's south-west cell; extent_m of the grid is stretched to the area, heights are multiplied by
// height_scale. What the file tells of its units, scale, offset and masks is applied; length_unit and height_unit
// say what it does not tell.
struct GridTerrainSpec {
  std::string file;  // as the program opens it
  Eigen::Vector2d offset_m = Eigen::Vector2d::Zero();
  Eigen::Vector2d extent_m = Eigen::Vector2d::Zero();
  double height_scale = 1.0;
  std::optional<LengthUnit> length_unit, height_unit;
  TextPlace file_place, extent_place;
};

}  // namespace ed3r::world
