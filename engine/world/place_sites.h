// Draws the fire sites of a world whose file says `sites: {placed: ...}`.
#pragma once

#include <vector>

#include "engine/world/scene.h"
#include "engine/world/world_file.h"

namespace ed3r::world {

// Sites on the ground, `site 1` .. in the order of their bearing sectors, known and unseen alternating. `parts`
// holds the world without sites, its forest cleared around stations and start alone; a candidate is measured as
// if its own clearing and those of the sites before it were made. A pure function of the file.
// Throws UserError in one line when too few places qualify: how many were found, what sight was met.
std::vector<FireSite> PlaceSites(const WorldSpec& spec, const Scene::Parts& parts);

}  // namespace ed3r::world
