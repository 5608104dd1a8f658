// Turns terrain and trees into the one triangle mesh that rays and contacts meet.
#pragma once

#include <vector>

#include "engine/world/geometry.h"
#include "engine/world/scene.h"

namespace ed3r::world {

// The terrain's triangles come first (two per cell, row by row from the south-west), then a constant number
// per tree in the order given: a triangle's number tells what it belongs to.
inline constexpr int kTrianglesPerTree = 40;
inline constexpr int kTrunkTriangles = 16;  // the first of each tree; the rest is its crown

// Terrain: each cell split along its south-west to north-east diagonal. Tree: two closed surfaces, a
// five-sided trunk that is rooted below ground and ends inside the crown, and a six-sided crown.
TriangleMesh Bake(const Terrain& terrain, const std::vector<Tree>& trees);

}  // namespace ed3r::world
