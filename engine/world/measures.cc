#include "engine/world/measures.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "engine/world/sight.h"

namespace ed3r::world {
namespace {

struct Polar {
  double distance_m, bearing_deg;
};

Polar FromStart(const StartArea& start, const Eigen::Vector3d& at_m) {
  const double east_m = at_m.x() - start.x_m;
  const double north_m = at_m.y() - start.y_m;
  const double bearing_deg = std::atan2(east_m, north_m) * 180.0 / std::numbers::pi;
  return {std::hypot(east_m, north_m), bearing_deg < 0.0 ? bearing_deg + 360.0 : bearing_deg};
}

SiteSpread SpreadOf(const std::vector<SiteMeasure>& sites,
                    const std::function<bool(const SiteMeasure&)>& among) {
  SiteSpread spread;
  double sum = 0.0, squares = 0.0;
  for (const SiteMeasure& site : sites) {
    if (!among(site)) continue;
    spread.distance_min_m =
        spread.sites == 0 ? site.distance_m : std::min(spread.distance_min_m, site.distance_m);
    spread.distance_max_m = std::max(spread.distance_max_m, site.distance_m);
    spread.distance_mean_m += site.distance_m;
    sum += site.sight_around;
    squares += site.sight_around * site.sight_around;
    ++spread.sites;
  }
  if (spread.sites == 0) return spread;
  spread.distance_mean_m /= spread.sites;
  spread.sight_mean = sum / spread.sites;
  const double variance = squares / spread.sites - spread.sight_mean * spread.sight_mean;
  if (spread.sight_mean > 0.0)
    spread.sight_variation = std::sqrt(std::max(0.0, variance)) / spread.sight_mean;
  return spread;
}

}  // namespace

WorldMeasures MeasureWorld(const Scene& scene) {
  const StartArea& start = scene.Start();
  const auto sight = [&](const ViewArea& view) {
    return Sight(view, scene.SizeM(), scene.Ground(), scene.Fire(), scene.Geometry(), scene.Trees());
  };
  const Sight from_start = sight(StartView(start));
  const Sight around = sight(AroundStart(start));
  WorldMeasures measures;
  measures.start_height_min_m = start.height_min_m;
  measures.start_height_max_m = start.height_max_m;
  for (const FireSite& site : scene.Sites()) {
    const auto [distance_m, bearing_deg] = FromStart(start, site.base_m);
    measures.sites.push_back(
        {site.name, site.known, distance_m, bearing_deg, from_start.Of(site.base_m), around.Of(site.base_m)});
  }
  for (const BaseStation& station : scene.BaseStations()) {
    const auto [distance_m, bearing_deg] = FromStart(start, station.antenna_m);
    measures.base_stations.push_back({station.name, station.known, distance_m, bearing_deg});
  }
  measures.all = SpreadOf(measures.sites, [](const SiteMeasure&) { return true; });
  measures.known = SpreadOf(measures.sites, [](const SiteMeasure& site) { return site.known; });
  measures.unseen = SpreadOf(measures.sites, [](const SiteMeasure& site) { return !site.known; });
  return measures;
}

}  // namespace ed3r::world
