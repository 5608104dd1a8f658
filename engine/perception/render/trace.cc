#include "engine/perception/render/trace.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/core/check.h"
#include "engine/perception/view.h"
#include "engine/world/bake.h"

namespace ed3r::perception {
namespace {

constexpr double kRangeM = 2000.0;  // beyond any diagonal of an area
constexpr int kBlock = 4;  // rays go in blocks of 4 x 4: what a packet of 16 meets lies close together
constexpr float kShadowLiftM = 0.05f;
constexpr float kShadowRangeM = 600.0f;

// Grid positions in the order of the blocks.
std::vector<std::uint32_t> BlockOrder(const PixelGrid& grid) {
  std::vector<std::uint32_t> order;
  order.reserve(grid.Pixels());
  for (int top = 0; top < grid.Rows(); top += kBlock)
    for (int left = 0; left < grid.Columns(); left += kBlock)
      for (int row = top; row < std::min(top + kBlock, grid.Rows()); ++row)
        for (int column = left; column < std::min(left + kBlock, grid.Columns()); ++column)
          order.push_back(static_cast<std::uint32_t>(row * grid.Columns() + column));
  return order;
}

void SetDirections(SensingTrace& trace, const Camera& camera) {
  const PixelGrid& grid = trace.grid;
  const double pixel = 2.0 * camera.HalfWidth() / grid.width_px;  // at unit depth
  trace.pixel_rad = static_cast<float>(pixel);
  const Eigen::Vector3f right = (pixel * camera.Right()).cast<float>(),
                        down = (pixel * camera.Down()).cast<float>();
  const Eigen::Vector3f forward = camera.Forward().cast<float>();
  std::size_t i = 0;
  for (int row = 0; row < grid.Rows(); ++row) {
    const float below =
        static_cast<float>(row - grid.margin_px) + 0.5f - 0.5f * static_cast<float>(grid.height_px);
    for (int column = 0; column < grid.Columns(); ++column, ++i) {
      const float beside =
          static_cast<float>(column - grid.margin_px) + 0.5f - 0.5f * static_cast<float>(grid.width_px);
      const Eigen::Vector3f ray = forward + beside * right + below * down;
      trace.direction[i] = ray / ray.norm();
    }
  }
}

// A crown's own normal: that of a rounded body, so that six flat sides look like foliage.
Eigen::Vector3f CrownNormal(const world::Tree& tree, const Eigen::Vector3f& point_m) {
  const float middle_m = static_cast<float>(tree.ground_m + tree.height_m - 0.65 * tree.crown_depth_m);
  const float width = 1.0f / static_cast<float>(tree.crown_radius_m);
  const float depth = 2.0f / static_cast<float>(tree.crown_depth_m);
  const Eigen::Vector3f outward((point_m.x() - static_cast<float>(tree.x_m)) * width,
                                (point_m.y() - static_cast<float>(tree.y_m)) * width,
                                (point_m.z() - middle_m) * depth + 0.15f);
  return outward / std::max(1e-3f, outward.norm());
}

Eigen::Vector3f TrunkNormal(const world::Tree& tree, const Eigen::Vector3f& point_m) {
  const Eigen::Vector3f outward(point_m.x() - static_cast<float>(tree.x_m),
                                point_m.y() - static_cast<float>(tree.y_m), 0.0f);
  return outward / std::max(1e-3f, outward.norm());
}

}  // namespace

TraceScene::TraceScene(const world::Scene& scene) : scene_(scene) {
  const world::Terrain& ground = scene.Ground();
  terrain_triangles_ = static_cast<unsigned>(2 * (ground.columns - 1) * (ground.rows - 1));
  const auto height = [&](int column, int row) {
    column = std::clamp(column, 0, ground.columns - 1);
    row = std::clamp(row, 0, ground.rows - 1);
    return ground.height_m[static_cast<std::size_t>(row) * ground.columns + column];
  };
  const float run_m = static_cast<float>(2.0 * ground.cell_m);
  node_normal_.reserve(ground.height_m.size());
  double border_sum_m = 0.0;
  int border_nodes = 0;
  for (int row = 0; row < ground.rows; ++row)
    for (int column = 0; column < ground.columns; ++column) {
      const Eigen::Vector3f up((height(column - 1, row) - height(column + 1, row)) / run_m,
                               (height(column, row - 1) - height(column, row + 1)) / run_m, 1.0f);
      node_normal_.push_back(up / up.norm());
      if (row > 0 && row + 1 < ground.rows && column > 0 && column + 1 < ground.columns) continue;
      border_sum_m += height(column, row);
      ++border_nodes;
    }
  far_ground_m_ = static_cast<float>(border_sum_m / border_nodes) - 10.0f;
}

SensingTrace TraceScene::Trace(const robot::Pose& pose, const SensingConfig& sensing, const PixelGrid& grid,
                               const Ambience& ambience, std::span<const Prop> props) const {
  ED3R_CHECK(grid.width_px > 0 && grid.height_px > 0 && grid.margin_px >= 0, "an empty picture");
  SensingTrace trace;
  trace.grid = grid;
  trace.camera_m = pose.position_m.cast<float>();
  const std::size_t pixels = grid.Pixels();
  trace.direction.resize(pixels);
  trace.distance_m.resize(pixels);
  trace.normal.resize(pixels, Eigen::Vector3f::UnitZ());
  trace.material.resize(pixels, Material::kSky);
  trace.item.resize(pixels, -1);
  trace.sunlit.resize(pixels, 0);
  SetDirections(trace, Camera(pose, sensing));

  const std::vector<std::uint32_t> order = BlockOrder(grid);
  std::vector<Eigen::Vector3f> rays(pixels);
  std::vector<world::SurfaceHit> hits(pixels);
  for (std::size_t k = 0; k < pixels; ++k) rays[k] = trace.direction[order[k]];
  scene_.Geometry().FirstHits(pose.position_m, rays, kRangeM, hits);
  for (std::size_t k = 0; k < pixels; ++k) {
    const std::size_t i = order[k];
    trace.distance_m[i] = hits[k].distance_m;
    if (hits[k].triangle == world::SurfaceHit::kNone)
      AddFarGround(trace, i);
    else
      Identify(trace, i, hits[k].triangle);
  }
  AddProps(trace, props);
  AddSun(trace, order, ambience.to_sun);
  return trace;
}

void TraceScene::Identify(SensingTrace& trace, std::size_t pixel, unsigned triangle) const {
  const Eigen::Vector3f point_m = trace.PointM(pixel);
  if (triangle < terrain_triangles_) {
    trace.material[pixel] = Material::kTerrain;
    trace.normal[pixel] = GroundNormal(point_m.x(), point_m.y());
    return;
  }
  const unsigned after = triangle - terrain_triangles_;
  const unsigned index = after / world::kTrianglesPerTree;
  const world::Tree& tree = scene_.Trees()[index];
  const bool trunk = after % world::kTrianglesPerTree < world::kTrunkTriangles;
  trace.item[pixel] = static_cast<std::int32_t>(index);
  trace.material[pixel] = trunk ? Material::kTrunk : Material::kCrown;
  trace.normal[pixel] = trunk ? TrunkNormal(tree, point_m) : CrownNormal(tree, point_m);
}

void TraceScene::AddFarGround(SensingTrace& trace, std::size_t pixel) const {
  const float fall = -trace.direction[pixel].z();
  const float above_m = trace.camera_m.z() - far_ground_m_;
  if (fall <= 1e-4f || above_m <= 0.0f) return;
  trace.material[pixel] = Material::kFarGround;
  trace.distance_m[pixel] = above_m / fall;
}

void TraceScene::AddProps(SensingTrace& trace, std::span<const Prop> props) const {
  PropHit hit;
  const Eigen::Vector3f axis = trace.direction[trace.grid.Pixels() / 2 + trace.grid.Columns() / 2];
  float cone_cos = 1.0f;
  for (const std::size_t corner :
       {std::size_t{0}, static_cast<std::size_t>(trace.grid.Columns()) - 1,
        trace.grid.Pixels() - static_cast<std::size_t>(trace.grid.Columns()), trace.grid.Pixels() - 1})
    cone_cos = std::min(cone_cos, axis.dot(trace.direction[corner]));
  for (std::size_t p = 0; p < props.size(); ++p) {
    const Prop& prop = props[p];
    if (!prop.Solid()) continue;
    const Eigen::Vector3f towards = prop.position_m - trace.camera_m;
    const float distance2 = towards.squaredNorm(), radius2 = prop.radius_m * prop.radius_m;
    // Outside the cone around the picture no ray can come near.
    if (towards.dot(axis) < cone_cos * std::sqrt(distance2) - 1.5f * prop.radius_m) continue;
    for (std::size_t i = 0; i < trace.direction.size(); ++i) {
      const float along = towards.dot(trace.direction[i]);
      if (along < 0.0f || distance2 - along * along > radius2) continue;
      if (!MeetsProp(prop, trace.camera_m, trace.direction[i], hit) || hit.distance_m >= trace.distance_m[i])
        continue;
      trace.distance_m[i] = hit.distance_m;
      trace.normal[i] = hit.normal;
      trace.material[i] = Material::kProp;
      trace.item[i] = static_cast<std::int32_t>(2 * p + (hit.top ? 1 : 0));
    }
  }
}

void TraceScene::AddSun(SensingTrace& trace, const std::vector<std::uint32_t>& order,
                        const Eigen::Vector3f& to_sun) const {
  std::vector<std::uint32_t> asked;
  std::vector<Eigen::Vector3f> points_m;
  asked.reserve(order.size());
  points_m.reserve(order.size());
  for (const std::uint32_t i : order) {
    if (trace.material[i] == Material::kSky) continue;
    if (trace.material[i] == Material::kFarGround) {
      trace.sunlit[i] = 1;
      continue;
    }
    // Leaves let light through around the edge between day and night of a crown: a wider range is asked there.
    const float facing = trace.normal[i].dot(to_sun);
    if (facing < (trace.material[i] == Material::kCrown ? -0.3f : 0.0f)) continue;
    asked.push_back(i);
    // Crowns shade themselves by their normal; the ray starts outside the one that it lights.
    const float lift_m =
        trace.material[i] == Material::kCrown
            ? 1.2f *
                  static_cast<float>(scene_.Trees()[static_cast<std::size_t>(trace.item[i])].crown_radius_m)
            : kShadowLiftM;
    points_m.push_back(trace.PointM(i) + lift_m * trace.normal[i]);
  }
  std::vector<std::uint8_t> hidden(asked.size());
  scene_.Geometry().HiddenTowards(points_m, to_sun, kShadowRangeM, hidden);
  for (std::size_t k = 0; k < asked.size(); ++k) trace.sunlit[asked[k]] = hidden[k] ? 0 : 1;
}

Eigen::Vector3f TraceScene::GroundNormal(float x_m, float y_m) const {
  const world::Terrain& ground = scene_.Ground();
  const float cell = 1.0f / static_cast<float>(ground.cell_m);
  const float x = std::clamp(x_m * cell, 0.0f, static_cast<float>(ground.columns - 1) - 0.001f);
  const float y = std::clamp(y_m * cell, 0.0f, static_cast<float>(ground.rows - 1) - 0.001f);
  const int column = static_cast<int>(x), row = static_cast<int>(y);
  const float fx = x - static_cast<float>(column), fy = y - static_cast<float>(row);
  const Eigen::Vector3f* south =
      node_normal_.data() + static_cast<std::size_t>(row) * ground.columns + column;
  const Eigen::Vector3f* north = south + ground.columns;
  const Eigen::Vector3f normal =
      (1 - fy) * ((1 - fx) * south[0] + fx * south[1]) + fy * ((1 - fx) * north[0] + fx * north[1]);
  return normal / normal.norm();
}

}  // namespace ed3r::perception
