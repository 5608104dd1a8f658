#include "engine/world/place_sites.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "engine/core/random.h"
#include "engine/world/bake.h"
#include "engine/world/files/text_place.h"
#include "engine/world/sight.h"

namespace ed3r::world {
namespace {

constexpr int kDraws = 4000;     // of all sites together
constexpr double kEdgeM = 20.0;  // from the area's edge, for the plume and its clearing

class Placing {
 public:
  Placing(const WorldSpec& spec, const Scene::Parts& parts)
      : wanted_(*spec.placed_sites),
        parts_(parts),
        clear_m_(spec.forest ? spec.forest->site_clear_m : 0.0),
        geometry_(Bake(parts.terrain, parts.trees)),
        around_(AroundStart(parts.start), parts.size_m, parts.terrain, parts.fire, geometry_, parts.trees),
        turn_(Stream(wanted_.seed, 0, Purpose::kSites).Uniform()) {}

  std::vector<FireSite> Place() {
    const int count = wanted_.known + wanted_.unseen;
    for (int i = 0; i < count; ++i) PlaceOne(i, count);
    if (static_cast<int>(sites_.size()) < count) Refuse(count);
    return std::move(sites_);
  }

 private:
  // Looks in the site's own sector first, so that sites lie all around the start, then in every direction: a
  // sector may lie outside the area or offer no sight that is wanted.
  void PlaceOne(int index, int count) {
    Stream stream(wanted_.seed, 1 + static_cast<std::uint32_t>(index), Purpose::kSites);
    const int draws = kDraws / count;
    for (int draw = 0; draw < draws; ++draw) {
      const double sector = stream.Uniform();
      const double share = 2 * draw < draws ? (index + sector) / count : sector;
      const double near2 = wanted_.distance_m.x() * wanted_.distance_m.x();
      const double far2 = wanted_.distance_m.y() * wanted_.distance_m.y();
      const double radius_m = std::sqrt(stream.Uniform(near2, far2));
      const double bearing = 2.0 * std::numbers::pi * (turn_ + share);
      const double x_m = parts_.start.x_m + radius_m * std::sin(bearing);
      const double y_m = parts_.start.y_m + radius_m * std::cos(bearing);
      if (!Qualifies(x_m, y_m)) continue;
      // Bresenham's line: the known ones are spread evenly among all.
      const bool known = (index + 1) * wanted_.known / count > index * wanted_.known / count;
      sites_.push_back(
          {fmt::format("site {}", index + 1), {x_m, y_m, parts_.terrain.HeightAt(x_m, y_m)}, known});
      felled_.push_back({x_m, y_m, clear_m_});
      return;
    }
  }

  bool Qualifies(double x_m, double y_m) {
    if (x_m < kEdgeM || y_m < kEdgeM || x_m > parts_.size_m.x() - kEdgeM || y_m > parts_.size_m.y() - kEdgeM)
      return false;
    for (const FireSite& other : sites_)
      if (std::hypot(x_m - other.base_m.x(), y_m - other.base_m.y()) < wanted_.apart_m) return false;
    felled_.push_back({x_m, y_m, clear_m_});
    const double sight = around_.Of({x_m, y_m, parts_.terrain.HeightAt(x_m, y_m)}, felled_);
    felled_.pop_back();
    least_seen_ = std::min(least_seen_, sight);
    most_seen_ = std::max(most_seen_, sight);
    return sight >= wanted_.in_sight.x() && sight <= wanted_.in_sight.y();
  }

  [[noreturn]] void Refuse(int count) const {
    const std::string found = fmt::format("sites.placed: {} of {} sites found in {} draws", sites_.size(),
                                          count, kDraws / count * count);
    if (most_seen_ < least_seen_)
      FailAt(wanted_.place,
             fmt::format("{}; no place of the ring lies {:g} m inside the area; change distance_m = [{:g}, "
                         "{:g}], or the area",
                         found, kEdgeM, wanted_.distance_m.x(), wanted_.distance_m.y()));
    FailAt(
        wanted_.place,
        fmt::format("{}; sight_around there: {:.2f} .. {:.2f}; widen in_sight = [{:g}, {:g}] or distance_m "
                    "= [{:g}, {:g}], or lower apart_m = {:g}",
                    found, least_seen_, most_seen_, wanted_.in_sight.x(), wanted_.in_sight.y(),
                    wanted_.distance_m.x(), wanted_.distance_m.y(), wanted_.apart_m));
  }

  const PlacedSitesSpec& wanted_;
  const Scene::Parts& parts_;
  const double clear_m_;
  const StaticGeometry geometry_;
  const Sight around_;
  const double turn_;
  std::vector<FireSite> sites_;
  std::vector<ClearDisc> felled_;
  double least_seen_ = 1.0, most_seen_ = -1.0;
};

}  // namespace

std::vector<FireSite> PlaceSites(const WorldSpec& spec, const Scene::Parts& parts) {
  return Placing(spec, parts).Place();
}

}  // namespace ed3r::world
