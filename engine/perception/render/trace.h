// One look at the solid world: what each pixel of a sensing period meets, before any light is computed.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "engine/config/robot.h"
#include "engine/perception/render/ambience.h"
#include "engine/perception/render/props.h"
#include "engine/robot/motion.h"
#include "engine/world/scene.h"

namespace ed3r::perception {

enum class Material : std::uint8_t { kSky, kFarGround, kTerrain, kTrunk, kCrown, kProp };

// The pixel grid of a trace: the picture and a margin around it, from which frames are cut as the camera sways.
struct PixelGrid {
  int width_px = 0, height_px = 0, margin_px = 0;

  int Columns() const { return width_px + 2 * margin_px; }
  int Rows() const { return height_px + 2 * margin_px; }
  std::size_t Pixels() const {
    return static_cast<std::size_t>(Columns()) * static_cast<std::size_t>(Rows());
  }
  // Whether grid position (column, row) lies in the picture of a camera at rest.
  bool InPicture(int column, int row) const {
    return column >= margin_px && column < margin_px + width_px && row >= margin_px &&
           row < margin_px + height_px;
  }
};

// Deferred-shading buffers, row by row from the top, one entry per pixel of the grid.
struct SensingTrace {
  PixelGrid grid;
  Eigen::Vector3f camera_m;
  float pixel_rad = 0.0f;                  // angle between neighbouring pixels at the picture's middle
  std::vector<Eigen::Vector3f> direction;  // unit
  std::vector<float> distance_m;           // +infinity for the sky
  std::vector<Eigen::Vector3f> normal;     // unit, of the smooth surface; meaningless for the sky
  std::vector<Material> material;
  std::vector<std::int32_t> item;    // tree or prop; -1 for none
  std::vector<std::uint8_t> sunlit;  // 1 where nothing stands between the surface and the sun

  Eigen::Vector3f PointM(std::size_t i) const { return camera_m + distance_m[i] * direction[i]; }
};

// What tracing needs to know of a scene beyond its geometry. Built once per scene; threads may share it.
class TraceScene {
 public:
  explicit TraceScene(const world::Scene& scene);

  // sensing gives the field of view, the grid its size; the picture's middle is the optical axis. The height of the
  // picture follows from its pixels being square.
  SensingTrace Trace(const robot::Pose& pose, const SensingConfig& sensing, const PixelGrid& grid,
                     const Ambience& ambience, std::span<const Prop> props) const;

  const world::Scene& World() const { return scene_; }

 private:
  void Identify(SensingTrace& trace, std::size_t pixel, unsigned triangle) const;
  void AddFarGround(SensingTrace& trace, std::size_t pixel) const;
  void AddProps(SensingTrace& trace, std::span<const Prop> props) const;
  void AddSun(SensingTrace& trace, const std::vector<std::uint32_t>& order,
              const Eigen::Vector3f& to_sun) const;
  Eigen::Vector3f GroundNormal(float x_m, float y_m) const;

  const world::Scene& scene_;
  unsigned terrain_triangles_;
  float far_ground_m_;                        // height of the land beyond the area
  std::vector<Eigen::Vector3f> node_normal_;  // of the terrain, as its nodes lie
};

}  // namespace ed3r::perception
