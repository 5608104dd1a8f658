// Two ways to a terrain: from a seed, and from a real elevation grid.
#pragma once

#include <cstdint>

#include "engine/world/scene.h"
#include "engine/world/world_file.h"

namespace ed3r {

// A grid of nodes over the area, heights all 0.
Terrain FlatTerrain(const Eigen::Vector3d& size_m, double cell_m);

// Lowers or lifts the terrain so that its lowest node is at 0.
void PutLowestAtZero(Terrain& terrain);

// Hills, ridges and a rough surface; the same bits for the same arguments on every machine.
Terrain GenerateTerrain(const GeneratedTerrainSpec& spec, const Eigen::Vector3d& size_m, double cell_m,
                        std::uint64_t seed);

// Reads an ESRI ASCII grid or a GeoTIFF through GDAL; cubic (Catmull-Rom) interpolation between cell centres.
// Throws UserError at the world file's key: unreadable, wrong kind of grid, too small, or without data where
// the area needs it.
Terrain ReadElevationGrid(const GridTerrainSpec& spec, const Eigen::Vector3d& size_m, double cell_m);

}  // namespace ed3r
