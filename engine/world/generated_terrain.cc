#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "engine/world/noise.h"
#include "engine/world/terrain.h"

namespace ed3r::world {
namespace {

// Streams of kWorld are told apart by their scenario: 0 terrain, 1 forest.
constexpr std::uint32_t kTerrainStream = 0;

constexpr double kSpurSizeM = 70.0;
constexpr double kSaddleSizeM = 120.0;
constexpr double kRoughSizeM = 26.0;
constexpr double kBendSizeM = 130.0;

double DistanceToSegment(const Eigen::Vector2d& point, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d along = b - a;
  const double length2 = along.squaredNorm();
  const double t = length2 > 0.0 ? std::clamp((point - a).dot(along) / length2, 0.0, 1.0) : 0.0;
  return (point - a - t * along).norm();
}

double DistanceToLine(const Eigen::Vector2d& point, const std::vector<Eigen::Vector2d>& line) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i + 1 < line.size(); ++i)
    nearest = std::min(nearest, DistanceToSegment(point, line[i], line[i + 1]));
  return nearest;
}

// Cross-section of a ridge: 1 at the crest, which is an edge, steepest on the upper flank, 0 and level at the
// foot (t = 1).
double Profile(double t) { return t >= 1.0 ? 0.0 : (1.0 - t) * (1.0 - t) * (1.0 + t); }

class Landscape {
 public:
  Landscape(const GeneratedTerrainSpec& spec, Stream& stream)
      : spec_(spec),
        bend_x_(stream),
        bend_y_(stream),
        hills_(stream),
        spurs_(stream),
        saddles_(stream),
        rough_(stream) {}

  double HeightAt(double x_m, double y_m) const {
    const Eigen::Vector2d bent(x_m + spec_.bend_m * bend_x_.Fractal(x_m / kBendSizeM, y_m / kBendSizeM, 3),
                               y_m + spec_.bend_m * bend_y_.Fractal(x_m / kBendSizeM, y_m / kBendSizeM, 3));
    const Eigen::Vector2d in_hills = bent / spec_.hills_size_m;
    const double hills = spec_.hills_height_m * (0.5 + 0.5 * hills_.Fractal(in_hills.x(), in_hills.y(), 4));
    const double rough = spec_.roughness_m * rough_.Fractal(x_m / kRoughSizeM, y_m / kRoughSizeM, 3, 0.6);
    return hills + RidgesAt(bent) + rough;
  }

 private:
  double RidgesAt(const Eigen::Vector2d& bent) const {
    // Ridged noise: 1 along the lines where the noise is 0, which become the spurs.
    const double line = 1.0 - std::abs(spurs_.Fractal(bent.x() / kSpurSizeM, bent.y() / kSpurSizeM, 3));
    const double saddle = 0.5 + 0.5 * saddles_.Fractal(bent.x() / kSaddleSizeM, bent.y() / kSaddleSizeM, 2);
    double highest = 0.0;
    for (const RidgeSpec& ridge : spec_.ridges) {
      const double t = DistanceToLine(bent, ridge.crest_m) / ridge.half_width_m;
      const double cut = 1.0 + spec_.spurs * (1.0 - line * line);
      highest = std::max(highest, ridge.height_m * (1.0 - spec_.saddles * saddle) * Profile(t * cut));
    }
    return highest;
  }

  const GeneratedTerrainSpec& spec_;
  GradientNoise bend_x_, bend_y_, hills_, spurs_, saddles_, rough_;
};

}  // namespace

Terrain GenerateTerrain(const GeneratedTerrainSpec& spec, const Eigen::Vector3d& size_m, double cell_m,
                        std::uint64_t seed) {
  Stream stream(seed, kTerrainStream, Purpose::kWorld);
  const Landscape landscape(spec, stream);
  Terrain terrain = FlatTerrain(size_m, cell_m);
  for (int row = 0; row < terrain.rows; ++row)
    for (int column = 0; column < terrain.columns; ++column)
      terrain.height_m[static_cast<std::size_t>(row) * terrain.columns + column] =
          static_cast<float>(landscape.HeightAt(column * cell_m, row * cell_m));
  PutLowestAtZero(terrain);
  return terrain;
}

}  // namespace ed3r::world
