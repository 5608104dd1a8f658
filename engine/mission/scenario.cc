#include "engine/mission/scenario.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "engine/core/check.h"
#include "engine/core/random.h"

namespace ed3r::mission {
namespace {

template <class Place>
std::vector<int> InPlay(const std::vector<Place>& places, SiteSet set, const char* key,
                        const std::string& world) {
  std::vector<int> indices;
  for (std::size_t i = 0; i < places.size(); ++i)
    if (set == SiteSet::kAll || places[i].known) indices.push_back(static_cast<int>(i));
  if (indices.empty())
    throw UserError(
        fmt::format("{}: '{}' is not allowed; world '{}' has none of these", key, NameOf(set), world));
  return indices;
}

}  // namespace

Scenario DealScenario(const world::Scene& scene, const MissionConfig& mission, std::uint64_t seed,
                      std::uint32_t number) {
  const auto sites = InPlay(scene.Sites(), mission.sites, "mission.sites", scene.Name());
  const auto stations =
      InPlay(scene.BaseStations(), mission.base_stations, "mission.base_stations", scene.Name());
  Scenario scenario;
  scenario.number = number;
  scenario.site = sites[number % sites.size()];
  scenario.base_station = stations[number / sites.size() % stations.size()];

  Stream stream(seed, number, Purpose::kScenario);
  const world::StartArea& area = scene.Start();
  const double radius_m = area.radius_m * std::sqrt(stream.Uniform());
  const double angle_rad = stream.Uniform(0.0, 2.0 * std::numbers::pi);
  const double x_m = area.x_m + radius_m * std::cos(angle_rad);
  const double y_m = area.y_m + radius_m * std::sin(angle_rad);
  const double height_m = stream.Uniform(area.height_min_m, area.height_max_m);
  const double yaw_rad = stream.Uniform(-std::numbers::pi, std::numbers::pi);
  scenario.start.position_m = {x_m, y_m, scene.Ground().HeightAt(x_m, y_m) + height_m};
  scenario.start.yaw_rad =
      mission.start_yaw == StartYaw::kDrawn ? yaw_rad : mission.start_yaw_deg * std::numbers::pi / 180.0;
  return scenario;
}

int PlacesInPlay(const world::Scene& scene, const MissionConfig& mission) {
  return static_cast<int>(
      InPlay(scene.Sites(), mission.sites, "mission.sites", scene.Name()).size() *
      InPlay(scene.BaseStations(), mission.base_stations, "mission.base_stations", scene.Name()).size());
}

Conditions DrawConditions(const Config& config, std::uint64_t seed, std::uint32_t scenario,
                          std::uint32_t timestep) {
  Conditions conditions;
  conditions.cpu_hz = Stream(seed, scenario, Purpose::kCpu, timestep)
                          .Uniform(config.cpu.frequency_min_hz, config.cpu.frequency_max_hz);
  conditions.bandwidth_hz = Stream(seed, scenario, Purpose::kBandwidth, timestep)
                                .Uniform(config.radio.bandwidth_min_hz, config.radio.bandwidth_max_hz);
  conditions.shadowing_db =
      config.radio.shadowing_sigma_db * Stream(seed, scenario, Purpose::kShadowing, timestep).Normal();
  return conditions;
}

}  // namespace ed3r::mission
