#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "engine/app/commands.h"
#include "engine/core/files/file.h"
#include "engine/world/map_picture.h"
#include "engine/world/measures.h"
#include "engine/world/scene.h"
#include "engine/world/world_file.h"

namespace ed3r::app {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::string file;
  std::string picture;
  bool json = false;
};

const char* Use(bool known) { return known ? "known" : "unseen"; }

void PrintSites(const world::Scene& scene, const world::WorldMeasures& measures) {
  std::size_t width = 4;
  for (const world::SiteMeasure& site : measures.sites) width = std::max(width, site.name.size());
  fmt::print("{:<{}}  {:<6}  {:>6}  {:>6}  {:>6}  {:>8}  {:>7}  {:>11}  {:>12}\n", "site", width, "use",
             "x m", "y m", "z m", "distance", "bearing", "sight_start", "sight_around");
  for (std::size_t i = 0; i < measures.sites.size(); ++i) {
    const world::SiteMeasure& site = measures.sites[i];
    const Eigen::Vector3d& at_m = scene.Sites()[i].base_m;
    fmt::print("{:<{}}  {:<6}  {:6.1f}  {:6.1f}  {:6.1f}  {:6.1f} m  {:5.0f} °  {:11.2f}  {:12.2f}\n",
               site.name, width, Use(site.known), at_m.x(), at_m.y(), at_m.z(), site.distance_m,
               site.bearing_deg, site.sight_start, site.sight_around);
  }
}

void PrintSpread(const char* which, const world::SiteSpread& spread) {
  if (spread.sites == 0) return;
  fmt::print(
      "{:<6} sites: {:>3}, sight_around mean {:.2f}, coefficient of variation {:.2f}; "
      "{:.0f} .. {:.0f} m from the start, mean {:.0f} m\n",
      which, spread.sites, spread.sight_mean, spread.sight_variation, spread.distance_min_m,
      spread.distance_max_m, spread.distance_mean_m);
}

void Describe(const world::Scene& scene, const world::WorldMeasures& measures) {
  const Eigen::Vector3d& size_m = scene.SizeM();
  const auto [lowest, highest] =
      std::minmax_element(scene.Ground().height_m.begin(), scene.Ground().height_m.end());
  fmt::print("{}: {:g} x {:g} x {:g} m, ground {:.1f} .. {:.1f} m, {} trees, fingerprint {}\n", scene.Name(),
             size_m.x(), size_m.y(), size_m.z(), *lowest, *highest, scene.Trees().size(),
             scene.Fingerprint().substr(0, 16));
  const world::StartArea& start = scene.Start();
  for (const std::string& note : scene.Notes()) fmt::print("{}\n", note);
  fmt::print("start: disc of {:g} m around ({:g}, {:g}), {:g} .. {:g} m above ground\n\n", start.radius_m,
             start.x_m, start.y_m, start.height_min_m, start.height_max_m);
  PrintSites(scene, measures);
  fmt::print("\n");
  PrintSpread("known", measures.known);
  PrintSpread("unseen", measures.unseen);
  PrintSpread("all", measures.all);
  for (std::size_t i = 0; i < measures.base_stations.size(); ++i) {
    const world::StationMeasure& station = measures.base_stations[i];
    const Eigen::Vector3d& at_m = scene.BaseStations()[i].antenna_m;
    fmt::print(
        "base station {} ({}): ({:.1f}, {:.1f}, {:.1f}) m, {:.1f} m from the start, bearing {:.0f} °\n",
        station.name, Use(station.known), at_m.x(), at_m.y(), at_m.z(), station.distance_m,
        station.bearing_deg);
  }
}

Json JsonOf(const world::SiteSpread& spread) {
  return {{"sites", spread.sites},
          {"sight_around_mean", spread.sight_mean},
          {"sight_around_variation", spread.sight_variation},
          {"distance_min_m", spread.distance_min_m},
          {"distance_mean_m", spread.distance_mean_m},
          {"distance_max_m", spread.distance_max_m}};
}

Json JsonOf(const Eigen::Vector3d& at_m) { return {at_m.x(), at_m.y(), at_m.z()}; }

Json JsonOf(const world::Scene& scene, const world::WorldMeasures& measures) {
  Json json = {{"name", scene.Name()},
               {"fingerprint", scene.Fingerprint()},
               {"size_m", JsonOf(scene.SizeM())},
               {"trees", scene.Trees().size()},
               {"notes", scene.Notes()},
               {"start_height_m", {measures.start_height_min_m, measures.start_height_max_m}},
               {"sites", Json::array()},
               {"base_stations", Json::array()},
               {"known", JsonOf(measures.known)},
               {"unseen", JsonOf(measures.unseen)},
               {"all", JsonOf(measures.all)}};
  for (std::size_t i = 0; i < measures.sites.size(); ++i) {
    const world::SiteMeasure& site = measures.sites[i];
    json["sites"].push_back({{"name", site.name},
                             {"known", site.known},
                             {"at_m", JsonOf(scene.Sites()[i].base_m)},
                             {"distance_m", site.distance_m},
                             {"bearing_deg", site.bearing_deg},
                             {"sight_start", site.sight_start},
                             {"sight_around", site.sight_around}});
  }
  for (std::size_t i = 0; i < measures.base_stations.size(); ++i) {
    const world::StationMeasure& station = measures.base_stations[i];
    json["base_stations"].push_back({{"name", station.name},
                                     {"known", station.known},
                                     {"at_m", JsonOf(scene.BaseStations()[i].antenna_m)},
                                     {"distance_m", station.distance_m},
                                     {"bearing_deg", station.bearing_deg}});
  }
  return json;
}

}  // namespace

Command AddWorld(Program& program) {
  auto options = std::make_shared<Options>();
  CommandLine parser = program.AddCommand(
      "world", "Builds a world file, says what is in it, measures its sites and draws its map");
  parser.Option("FILE", options->file, "World file (YAML)").Required();
  parser.Option("--picture", options->picture, "Draw the map (relief, trees, sites, stations) to this PNG");
  parser.Flag("--json", options->json, "Print JSON");
  return {parser, [options] {
            if (!options->picture.empty())
              CheckNoInput(options->picture, world::FilesOf(world::ReadWorldFile(options->file)),
                           "--picture");
            const std::shared_ptr<const world::Scene> scene = world::Scene::Load(options->file);
            const world::WorldMeasures measures = world::MeasureWorld(*scene);
            if (options->json)
              fmt::print("{}\n", JsonOf(*scene, measures).dump(2));
            else
              Describe(*scene, measures);
            if (!options->picture.empty()) {
              world::WriteMapPicture(*scene, options->picture);
              if (!options->json) fmt::print("map: {}\n", options->picture);
            }
            return kDone;
          }};
}

}  // namespace ed3r::app
