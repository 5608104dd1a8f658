// Two ways to a terrain: from a seed, and from a real elevation grid.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/world/scene.h"
#include "engine/world/world_file.h"

namespace ed3r::world {

// A grid of nodes over the area, heights all 0.
Terrain FlatTerrain(const Eigen::Vector3d& size_m, double cell_m);

// Lowers or lifts the terrain so that its lowest node is at 0.
void PutLowestAtZero(Terrain& terrain);

// Hills, ridges and a rough surface; the same bits for the same arguments on every machine.
Terrain GenerateTerrain(const GeneratedTerrainSpec& spec, const Eigen::Vector3d& size_m, double cell_m,
                        std::uint64_t seed);

// Reads an ESRI ASCII grid or a GeoTIFF (raster_file.h); cubic (Catmull-Rom) interpolation between cell centres.
// `notes`, where given, gains a line when the file's units or scale were applied. Throws UserError at the world file's
// key: unreadable, wrong kind of grid or projection, too small, or without data where the area needs it.
Terrain ReadElevationGrid(const GridTerrainSpec& spec, const Eigen::Vector3d& size_m, double cell_m,
                          std::vector<std::string>* notes = nullptr);

// The grid's file (canonical) and those beside it that say how it is to be read. Throws as above.
std::vector<std::string> ElevationGridFiles(const GridTerrainSpec& spec);

}  // namespace ed3r::world
