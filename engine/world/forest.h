// Where trees stand, and how big they are: from a seed, or from the stem map of a real stand.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/world/scene.h"
#include "engine/world/world_file.h"

namespace ed3r::world {

// A disc that no crown reaches over.
struct ClearDisc {
  double x_m, y_m, radius_m;
};

// Trees on a terrain over an area, crowns within the area, outside all discs, on ground that is not too
// steep. A tree depends on the seed, its own place and the ground there, not on the other trees: moving a
// disc changes no tree elsewhere. `notes`, where given, gains what the stem map's reader estimated or left out. Throws
// UserError for a stem map that cannot be used.
std::vector<Tree> PlantForest(const ForestSpec& spec, const Eigen::Vector3d& size_m, const Terrain& terrain,
                              const std::vector<ClearDisc>& clear, std::uint64_t seed,
                              std::vector<std::string>* notes = nullptr);

}  // namespace ed3r::world
