// What makes a world hard or easy, in numbers: how far its fires are, and how well they can be seen.
#pragma once

#include <string>
#include <vector>

#include "engine/world/scene.h"

namespace ed3r::world {

struct SiteMeasure {
  std::string name;
  bool known = false;
  double distance_m = 0.0;    // from the start's centre, horizontally
  double bearing_deg = 0.0;   // from the start's centre, clockwise from north, 0 .. 360
  double sight_start = 0.0;   // from the start disc at the start heights (sight.h)
  double sight_around = 0.0;  // from any place within 150 m of the start, 5 .. 100 m above ground
};

struct StationMeasure {
  std::string name;
  bool known = false;
  double distance_m = 0.0;
  double bearing_deg = 0.0;
};

// How alike some sites are.
struct SiteSpread {
  int sites = 0;
  double sight_mean = 0.0;       // of sight_around; 0 without sites
  double sight_variation = 0.0;  // its standard deviation (over n) by its mean; 0 where the mean is 0
  double distance_min_m = 0.0, distance_mean_m = 0.0, distance_max_m = 0.0;
};

struct WorldMeasures {
  std::vector<SiteMeasure> sites;  // in the scene's order
  std::vector<StationMeasure> base_stations;
  SiteSpread all, known, unseen;
  double start_height_min_m = 0.0, start_height_max_m = 0.0;  // above ground
};

WorldMeasures MeasureWorld(const Scene& scene);

}  // namespace ed3r::world
