// The solid part of a scene (terrain and trees baked into one triangle mesh), built once and shared read-only
// by all missions: as a Bullet shape that the robot can touch, and as an Embree scene that rays can ask.
//
// Frame: x east, y north, z up, metres; the origin is the south-west corner at the lowest ground.
// Threads: immutable after construction; every const member may be called from any thread.
// Determinism: Embree is pinned to one instruction set and only says which triangle a ray meets; the distance
// is computed here in double precision. So a ray's answer does not depend on the CPU.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

class btCollisionShape;

namespace ed3r::world {

struct TriangleMesh {
  std::vector<Eigen::Vector3f> vertices_m;
  std::vector<Eigen::Vector3i> triangles;  // counter-clockwise seen from outside (terrain: from above)
};

// Name of the instruction set that rays use: "avx2" on every x86-64-v3 machine, newer ones included; "sse2"
// on older ones, where rays that graze an edge may answer differently.
std::string_view RayInstructionSet();

// What a camera ray met. The triangle is an index into TriangleMesh::triangles.
struct SurfaceHit {
  static constexpr unsigned kNone = ~0u;
  unsigned triangle = kNone;
  float distance_m = 0.0f;  // +infinity where nothing was met
};

class StaticGeometry {
 public:
  // Bullet's quantized tree keeps a triangle's index in 21 bits.
  static constexpr std::size_t kMaxTriangles = (std::size_t{1} << 21) - 1;

  // Throws InternalError for a mesh that is empty or too large, or has a bad index.
  explicit StaticGeometry(TriangleMesh mesh);
  ~StaticGeometry();
  StaticGeometry(const StaticGeometry&) = delete;
  StaticGeometry& operator=(const StaticGeometry&) = delete;

  // Distance along a unit direction to the first surface, or +infinity when there is none within range_m.
  double Distance(const Eigen::Vector3d& origin_m, const Eigen::Vector3d& direction, double range_m) const;

  // Whether a surface lies between two points (1 cm short of either end).
  bool Occluded(const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m) const;

  // The first surface along each ray of a camera, which all start at one point: triangle and distance along the
  // unit direction. Fast where 16 neighbours in the list point nearly the same way.
  void FirstHits(const Eigen::Vector3d& origin_m, std::span<const Eigen::Vector3f> directions, double range_m,
                 std::span<SurfaceHit> hits) const;

  // Whether a surface lies within range_m of each point along one unit direction: 1 hidden, 0 free.
  void HiddenTowards(std::span<const Eigen::Vector3f> points_m, const Eigen::Vector3f& direction,
                     double range_m, std::span<std::uint8_t> hidden) const;

  // Whether a cube around a point, half_side_m to each side, is free of surfaces. May say no where one is a
  // little outside of it.
  bool Clear(const Eigen::Vector3d& centre_m, double half_side_m) const;

  // The static shape for a Bullet world; owned by this object. Bullet does not modify it while stepping.
  btCollisionShape* Shape() const;

  const TriangleMesh& Mesh() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace ed3r::world
