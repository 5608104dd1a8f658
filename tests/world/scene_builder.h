// Small scenes for tests: terrain from a formula, trees where the test puts them.
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "engine/world/scene.h"

namespace ed3r::world {

inline Scene::Parts PartsOf(int nodes, double cell_m, const std::function<double(double, double)>& height_m,
                            std::vector<Tree> trees = {}) {
  Scene::Parts parts;
  parts.name = "test";
  const double side_m = (nodes - 1) * cell_m;
  parts.size_m = {side_m, side_m, 165.0};
  parts.terrain = {.columns = nodes, .rows = nodes, .cell_m = cell_m, .height_m = {}};
  for (int row = 0; row < nodes; ++row)
    for (int column = 0; column < nodes; ++column)
      parts.terrain.height_m.push_back(static_cast<float>(height_m(column * cell_m, row * cell_m)));
  parts.trees = std::move(trees);
  return parts;
}

}  // namespace ed3r::world
