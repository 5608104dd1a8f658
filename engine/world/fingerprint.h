// What makes two scenes the same for a mission.
#pragma once

#include <string>

#include "engine/world/geometry.h"
#include "engine/world/scene.h"

namespace ed3r::world {

// SHA-256 in hexadecimal of all that a mission can meet: area, solid mesh, sites, base stations, start area
// and fire shape. The scene's own name and the file it came from do not count.
std::string SceneFingerprint(const Scene::Parts& parts, const TriangleMesh& mesh);

}  // namespace ed3r::world
