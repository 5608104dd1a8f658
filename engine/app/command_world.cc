#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "engine/app/commands.h"
#include "engine/world/map_picture.h"
#include "engine/world/scene.h"

namespace ed3r {
namespace {

struct Options {
  std::string file;
  std::string picture;
};

void Describe(const Scene& scene) {
  const Eigen::Vector3d& size_m = scene.SizeM();
  const auto [lowest, highest] =
      std::minmax_element(scene.Ground().height_m.begin(), scene.Ground().height_m.end());
  fmt::print("{}: {:g} x {:g} x {:g} m, ground {:.1f} .. {:.1f} m, {} trees, fingerprint {}\n", scene.Name(),
             size_m.x(), size_m.y(), size_m.z(), *lowest, *highest, scene.Trees().size(),
             scene.Fingerprint().substr(0, 16));
  const StartArea& start = scene.Start();
  fmt::print("start: disc of {:g} m around ({:g}, {:g}), {:g} .. {:g} m above ground\n", start.radius_m,
             start.x_m, start.y_m, start.height_min_m, start.height_max_m);
  for (const FireSite& site : scene.Sites())
    fmt::print("  site {:<16} ({:5.1f}, {:5.1f}, {:5.1f}) m  {:5.1f} m from the start  {}\n", site.name,
               site.base_m.x(), site.base_m.y(), site.base_m.z(),
               std::hypot(site.base_m.x() - start.x_m, site.base_m.y() - start.y_m),
               site.known ? "known" : "unseen");
  for (const BaseStation& station : scene.BaseStations())
    fmt::print("  base station {:<8} ({:5.1f}, {:5.1f}, {:5.1f}) m  {}\n", station.name,
               station.antenna_m.x(), station.antenna_m.y(), station.antenna_m.z(),
               station.known ? "known" : "unseen");
}

}  // namespace

Command AddWorld(CLI::App& program) {
  auto options = std::make_shared<Options>();
  CLI::App* parser =
      program.add_subcommand("world", "Builds a world file, says what is in it and draws its map");
  parser->add_option("FILE", options->file, "World file (YAML)")->required();
  parser
      ->add_option("--picture", options->picture, "Draw the map (relief, trees, sites, stations) to this PNG")
      ->check(NotEmpty());
  return {parser, [options] {
            const std::shared_ptr<const Scene> scene = Scene::Load(options->file);
            Describe(*scene);
            if (!options->picture.empty()) {
              WriteMapPicture(*scene, options->picture);
              fmt::print("map: {}\n", options->picture);
            }
            return kDone;
          }};
}

}  // namespace ed3r
