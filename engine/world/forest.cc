#include "engine/world/forest.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/core/random.h"
#include "engine/world/files/stem_map.h"
#include "engine/world/noise.h"

namespace ed3r::world {
namespace {

// Streams of kWorld are told apart by their scenario: 0 terrain, 1 forest. In the forest, timestep 0 is for
// the noise, timestep 1 + i for the i-th place of a tree.
constexpr std::uint32_t kForestStream = 1;

constexpr double kJitter = 0.75;      // of the spacing
constexpr double kStandSizeM = 60.0;  // trees within are of similar age
constexpr double kMinTrunkRadiusM = 0.15;
constexpr double kTrunkPerHeight = 0.011;

class Site {
 public:
  Site(const ForestSpec& spec, const Eigen::Vector3d& size_m, const Terrain& terrain,
       const std::vector<ClearDisc>& clear)
      : spec_(spec), size_m_(size_m), terrain_(terrain), clear_(clear) {}

  bool MayStand(double x_m, double y_m, double crown_radius_m) const {
    if (x_m < crown_radius_m || y_m < crown_radius_m || x_m > size_m_.x() - crown_radius_m ||
        y_m > size_m_.y() - crown_radius_m)
      return false;
    for (const ClearDisc& disc : clear_) {
      const double dx = x_m - disc.x_m;
      const double dy = y_m - disc.y_m;
      const double reach_m = disc.radius_m + crown_radius_m;
      if (dx * dx + dy * dy <= reach_m * reach_m) return false;
    }
    return SlopeSquared(x_m, y_m) <= spec_.slope_max * spec_.slope_max;
  }

  double GroundAt(double x_m, double y_m) const { return terrain_.HeightAt(x_m, y_m); }

 private:
  double SlopeSquared(double x_m, double y_m) const {
    constexpr double kHalfBaseM = 2.0;
    const double east =
        (GroundAt(x_m + kHalfBaseM, y_m) - GroundAt(x_m - kHalfBaseM, y_m)) / (2 * kHalfBaseM);
    const double north =
        (GroundAt(x_m, y_m + kHalfBaseM) - GroundAt(x_m, y_m - kHalfBaseM)) / (2 * kHalfBaseM);
    return east * east + north * north;
  }

  const ForestSpec& spec_;
  const Eigen::Vector3d& size_m_;
  const Terrain& terrain_;
  const std::vector<ClearDisc>& clear_;
};

double Between(const Eigen::Vector2d& interval, double share) {
  return interval.x() + share * (interval.y() - interval.x());
}

// One tree per cell of a grid, moved within it: evenly spread without rows.
std::vector<Tree> Generate(const GeneratedForestSpec& spec, const Eigen::Vector3d& size_m, const Site& site,
                           std::uint64_t seed) {
  Stream noise_stream(seed, kForestStream, Purpose::kWorld);
  const GradientNoise clearings(noise_stream);
  const GradientNoise stands(noise_stream);
  const int columns = static_cast<int>(size_m.x() / spec.spacing_m) + 1;
  const int rows = static_cast<int>(size_m.y() / spec.spacing_m) + 1;
  std::vector<Tree> trees;
  for (int cell = 0; cell < columns * rows; ++cell) {
    Stream stream(seed, kForestStream, Purpose::kWorld, 1 + static_cast<std::uint32_t>(cell));
    const int column = cell % columns;
    const int row = cell / columns;
    const double x_m = (column + 0.5 + kJitter * (stream.Uniform() - 0.5)) * spec.spacing_m;
    const double y_m = (row + 0.5 + kJitter * (stream.Uniform() - 0.5)) * spec.spacing_m;
    // The noise is roughly uniform over [-0.6, 0.6]; the draw softens the edges of clearings.
    const double openness =
        0.5 + clearings.Fractal(x_m / spec.clearing_size_m, y_m / spec.clearing_size_m, 2) / 1.2;
    if (openness + 0.15 * (stream.Uniform() - 0.5) > spec.cover) continue;
    const double stand = 0.5 + stands.Fractal(x_m / kStandSizeM, y_m / kStandSizeM, 2) / 1.2;
    const double vigour = std::clamp(0.5 * stand + 0.5 * stream.Uniform(), 0.0, 1.0);
    Tree tree;
    tree.x_m = x_m;
    tree.y_m = y_m;
    tree.height_m = Between(spec.height_m, vigour);
    tree.crown_radius_m = Between(spec.crown_radius_m, 0.65 * vigour + 0.35 * stream.Uniform());
    tree.crown_depth_m = tree.height_m * stream.Uniform(0.55, 0.8);
    tree.trunk_radius_m =
        std::max(kMinTrunkRadiusM, kTrunkPerHeight * tree.height_m * stream.Uniform(0.85, 1.15));
    if (!site.MayStand(x_m, y_m, tree.crown_radius_m)) continue;
    tree.ground_m = site.GroundAt(x_m, y_m);
    trees.push_back(tree);
  }
  return trees;
}

StemMap CropStand(const StemMapSpec& spec) {
  StemMap map = ReadStemMap(spec);
  const Eigen::Vector2d extent_m = spec.extent_m.value_or(map.size_m - spec.offset_m);
  constexpr double kRoundingM = 1e-6;
  const Eigen::Vector2d needed_m = spec.offset_m + extent_m;
  if (extent_m.minCoeff() <= 0.0 || (map.size_m - needed_m).minCoeff() < -kRoundingM)
    FailAt(spec.file_place,
           fmt::format("forest.stem_map: '{}' is too small: offset_m + extent_m = [{:g}, {:g}] m; "
                       "the stand measures [{:g}, {:g}] m",
                       spec.file, needed_m.x(), needed_m.y(), map.size_m.x(), map.size_m.y()));
  const auto outside = [&](const Stem& stem) {
    const double x_m = stem.x_m - spec.offset_m.x();
    const double y_m = stem.y_m - spec.offset_m.y();
    return x_m < 0.0 || y_m < 0.0 || x_m >= extent_m.x() || y_m >= extent_m.y();
  };
  std::erase_if(map.stems, outside);
  if (map.stems.empty())
    FailAt(spec.file_place,
           fmt::format("forest.stem_map: no tree of '{}' stands within offset_m and extent_m", spec.file));
  for (Stem& stem : map.stems) {
    stem.x_m -= spec.offset_m.x();
    stem.y_m -= spec.offset_m.y();
  }
  map.size_m = extent_m;
  return map;
}

// Tiles the stand over the area; every other tile is mirrored, so that its edges meet themselves.
std::vector<Tree> Tile(const StemMapSpec& spec, const Eigen::Vector3d& size_m, const Site& site,
                       std::uint64_t seed, std::vector<std::string>* notes) {
  const StemMap map = CropStand(spec);
  if (notes != nullptr) notes->insert(notes->end(), map.notes.begin(), map.notes.end());
  const int columns = static_cast<int>(std::ceil(size_m.x() / map.size_m.x()));
  const int rows = static_cast<int>(std::ceil(size_m.y() / map.size_m.y()));
  std::vector<Tree> trees;
  std::uint32_t place = 0;
  for (int tile = 0; tile < columns * rows; ++tile) {
    const int column = tile % columns;
    const int row = tile / columns;
    for (const Stem& stem : map.stems) {
      Stream stream(seed, kForestStream, Purpose::kWorld, ++place);
      const double in_x_m = column % 2 == 0 ? stem.x_m : map.size_m.x() - stem.x_m;
      const double in_y_m = row % 2 == 0 ? stem.y_m : map.size_m.y() - stem.y_m;
      Tree tree;
      tree.x_m = column * map.size_m.x() + in_x_m;
      tree.y_m = row * map.size_m.y() + in_y_m;
      tree.height_m = spec.height_scale * stem.height_m;
      tree.crown_radius_m = spec.crown_scale * stem.crown_radius_m;
      tree.crown_depth_m = spec.height_scale * stem.crown_depth_m;
      tree.trunk_radius_m = std::max(kMinTrunkRadiusM, spec.height_scale * stem.trunk_radius_m);
      if (tree.height_m < spec.min_height_m || stream.Uniform() >= spec.keep) continue;
      if (!site.MayStand(tree.x_m, tree.y_m, tree.crown_radius_m)) continue;
      tree.ground_m = site.GroundAt(tree.x_m, tree.y_m);
      trees.push_back(tree);
    }
  }
  if (trees.empty() && notes != nullptr)
    notes->push_back(
        fmt::format("stem map: none of its {} trees stands in this world (the stand's part of {:.0f} x "
                    "{:.0f} m, laid over {:.0f} x "
                    "{:.0f} m; clearings, slope_max, min_height_m, keep)",
                    map.stems.size(), map.size_m.x(), map.size_m.y(), size_m.x(), size_m.y()));
  return trees;
}

}  // namespace

std::vector<Tree> PlantForest(const ForestSpec& spec, const Eigen::Vector3d& size_m, const Terrain& terrain,
                              const std::vector<ClearDisc>& clear, std::uint64_t seed,
                              std::vector<std::string>* notes) {
  const Site site(spec, size_m, terrain, clear);
  return spec.stem_map ? Tile(*spec.stem_map, size_m, site, seed, notes)
                       : Generate(*spec.generated, size_m, site, seed);
}

}  // namespace ed3r::world
