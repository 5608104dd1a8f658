#include "engine/world/geometry.h"

#include <BulletCollision/CollisionShapes/btBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btTriangleIndexVertexArray.h>
#include <embree3/rtcore.h>
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <new>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>

#include "engine/core/check.h"

namespace ed3r::world {
namespace {

constexpr double kOcclusionMarginM = 0.01;

// Both libraries read these buffers in place.
static_assert(sizeof(Eigen::Vector3f) == 3 * sizeof(float) && sizeof(Eigen::Vector3i) == 3 * sizeof(int));
static_assert(std::is_same_v<btScalar, float>, "Bullet must be built in single precision");

void CheckMesh(const TriangleMesh& mesh) {
  ED3R_CHECK(!mesh.vertices_m.empty() && !mesh.triangles.empty(), "empty mesh");
  ED3R_CHECK(mesh.triangles.size() <= StaticGeometry::kMaxTriangles,
             fmt::format("{} triangles", mesh.triangles.size()));
  for (const Eigen::Vector3f& vertex : mesh.vertices_m)
    ED3R_CHECK(vertex.allFinite(), "a vertex is not finite");
  const int vertices = static_cast<int>(mesh.vertices_m.size());
  for (const Eigen::Vector3i& triangle : mesh.triangles)
    ED3R_CHECK(triangle.minCoeff() >= 0 && triangle.maxCoeff() < vertices,
               fmt::format("triangle ({}, {}, {}) of {} vertices", triangle.x(), triangle.y(), triangle.z(),
                           vertices));
}

struct SceneDeleter {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using ScenePtr = std::unique_ptr<std::remove_pointer_t<RTCScene>, SceneDeleter>;

// No memory is nobody's mistake.
void CheckEmbree(RTCError error, const std::string& where) {
  if (error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
  ED3R_CHECK(error == RTC_ERROR_NONE, fmt::format("Embree error {}{}", static_cast<int>(error), where));
}

RTCDevice MakeDevice() {
  // One build thread: missions already use every core, and a build in tasks may order its tree differently.
  const std::string config = fmt::format("isa={},threads=1", RayInstructionSet());
  const RTCDevice device = rtcNewDevice(config.c_str());
  if (device == nullptr) CheckEmbree(rtcGetDeviceError(nullptr), fmt::format(" for '{}'", config));
  return device;
}

// One for the process, never given back: a device that goes takes its limit of threads with it, and the library beneath then
// makes threads for nothing, or ends the process where it cannot.
RTCDevice TheDevice() {
  static const RTCDevice device = MakeDevice();
  return device;
}

ScenePtr MakeScene(RTCDevice device, const TriangleMesh& mesh) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, mesh.vertices_m.data(),
                             0, sizeof(Eigen::Vector3f), mesh.vertices_m.size());
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.triangles.data(), 0,
                             sizeof(Eigen::Vector3i), mesh.triangles.size());
  rtcCommitGeometry(geometry);
  ScenePtr scene(rtcNewScene(device));
  // Robust: a ray straight down onto an edge of the terrain must not slip between its two triangles.
  rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(scene.get(), RTC_BUILD_QUALITY_HIGH);
  rtcAttachGeometry(scene.get(), geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene.get());
  CheckEmbree(rtcGetDeviceError(device), "");
  return scene;
}

void SetRay(RTCRay& ray, const Eigen::Vector3d& origin_m, const Eigen::Vector3d& direction, double near_m,
            double far_m) {
  ray.org_x = static_cast<float>(origin_m.x());
  ray.org_y = static_cast<float>(origin_m.y());
  ray.org_z = static_cast<float>(origin_m.z());
  ray.dir_x = static_cast<float>(direction.x());
  ray.dir_y = static_cast<float>(direction.y());
  ray.dir_z = static_cast<float>(direction.z());
  ray.tnear = static_cast<float>(near_m);
  ray.tfar = static_cast<float>(far_m);
  ray.time = 0.0f;
  ray.mask = ~0u;
  ray.id = 0;
  ray.flags = 0;
}

constexpr std::size_t kPacket = 16;

void SetRay(RTCRay16& packet, std::size_t i, const Eigen::Vector3f& origin_m,
            const Eigen::Vector3f& direction, float range_m) {
  packet.org_x[i] = origin_m.x();
  packet.org_y[i] = origin_m.y();
  packet.org_z[i] = origin_m.z();
  packet.dir_x[i] = direction.x();
  packet.dir_y[i] = direction.y();
  packet.dir_z[i] = direction.z();
  packet.tnear[i] = 0.0f;
  packet.tfar[i] = range_m;
  packet.time[i] = 0.0f;
  packet.mask[i] = ~0u;
  packet.id[i] = 0;
  packet.flags[i] = 0;
}

}  // namespace

std::string_view RayInstructionSet() {
  static const bool has_avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  return has_avx2 ? "avx2" : "sse2";
}

struct StaticGeometry::Impl {
  explicit Impl(TriangleMesh m)
      : mesh(PadForEmbree(std::move(m))),
        scene(MakeScene(TheDevice(), mesh)),
        bullet_mesh(static_cast<int>(mesh.triangles.size()), mesh.triangles.data()->data(),
                    sizeof(Eigen::Vector3i), static_cast<int>(mesh.vertices_m.size()),
                    mesh.vertices_m.data()->data(), sizeof(Eigen::Vector3f)) {}

  // Bullet's tree takes a third of a world's loading, and only flights ask for it: it is made once, by the first thread that does.
  btBvhTriangleMeshShape& Shape() {
    std::call_once(shape_made, [this] { shape.emplace(&bullet_mesh, /*useQuantizedAabbCompression=*/true); });
    return *shape;
  }

  // Embree reads vertices in blocks of 16 bytes: the last one needs memory behind it.
  static TriangleMesh PadForEmbree(TriangleMesh m) {
    CheckMesh(m);
    m.vertices_m.reserve(m.vertices_m.size() + 1);
    return m;
  }

  // Where the ray meets the plane of a triangle that Embree says it hits. Embree's own distance contains an
  // approximate reciprocal that differs between makers of CPUs. At a grazing angle the plane's answer is
  // ill-conditioned, so it is kept within the triangle's extent along the ray.
  double DistanceToTriangle(unsigned index, const Eigen::Vector3d& origin_m,
                            const Eigen::Vector3d& direction) const {
    const Eigen::Vector3i& corners = mesh.triangles[index];
    const Eigen::Vector3d a = mesh.vertices_m[corners[0]].cast<double>() - origin_m;
    const Eigen::Vector3d b = mesh.vertices_m[corners[1]].cast<double>() - origin_m;
    const Eigen::Vector3d c = mesh.vertices_m[corners[2]].cast<double>() - origin_m;
    const double along[] = {a.dot(direction), b.dot(direction), c.dot(direction)};
    const auto [nearest, farthest] = std::minmax_element(std::begin(along), std::end(along));
    const Eigen::Vector3d normal = (b - a).cross(c - a);
    const double slope = normal.dot(direction);
    const double distance = slope != 0.0 ? normal.dot(a) / slope : *nearest;
    return std::clamp(distance, *nearest, *farthest);
  }

  TriangleMesh mesh;
  ScenePtr scene;
  btTriangleIndexVertexArray bullet_mesh;
  std::once_flag shape_made;
  std::optional<btBvhTriangleMeshShape> shape;
};

StaticGeometry::StaticGeometry(TriangleMesh mesh) : impl_(std::make_unique<Impl>(std::move(mesh))) {}

StaticGeometry::~StaticGeometry() = default;

double StaticGeometry::Distance(const Eigen::Vector3d& origin_m, const Eigen::Vector3d& direction,
                                double range_m) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit hit;
  SetRay(hit.ray, origin_m, direction, 0.0, range_m);
  hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  hit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(impl_->scene.get(), &context, &hit);
  if (hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::numeric_limits<double>::infinity();
  return std::clamp(impl_->DistanceToTriangle(hit.hit.primID, origin_m, direction), 0.0, range_m);
}

bool StaticGeometry::Occluded(const Eigen::Vector3d& from_m, const Eigen::Vector3d& to_m) const {
  const Eigen::Vector3d path = to_m - from_m;
  const double length_m = path.norm();
  if (length_m <= 2.0 * kOcclusionMarginM) return false;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRay ray;
  SetRay(ray, from_m, path / length_m, kOcclusionMarginM, length_m - kOcclusionMarginM);
  rtcOccluded1(impl_->scene.get(), &context, &ray);
  return ray.tfar < 0.0f;
}

void StaticGeometry::FirstHits(const Eigen::Vector3d& origin_m, std::span<const Eigen::Vector3f> directions,
                               double range_m, std::span<SurfaceHit> hits) const {
  ED3R_CHECK(hits.size() == directions.size(), "one hit per ray");
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  RTCRayHit16 packet;
  for (std::size_t first = 0; first < directions.size(); first += kPacket) {
    const std::size_t count = std::min(kPacket, directions.size() - first);
    alignas(64) int valid[kPacket];
    for (std::size_t i = 0; i < kPacket; ++i) {
      valid[i] = i < count ? -1 : 0;
      SetRay(packet.ray, i, origin_m.cast<float>(), directions[first + std::min(i, count - 1)],
             static_cast<float>(range_m));
      packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
      packet.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    }
    rtcIntersect16(valid, impl_->scene.get(), &context, &packet);
    for (std::size_t i = 0; i < count; ++i) {
      SurfaceHit& hit = hits[first + i];
      hit = {SurfaceHit::kNone, std::numeric_limits<float>::infinity()};
      if (packet.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
      hit.triangle = packet.hit.primID[i];
      const double distance_m =
          impl_->DistanceToTriangle(hit.triangle, origin_m, directions[first + i].cast<double>());
      hit.distance_m = static_cast<float>(std::clamp(distance_m, 0.0, range_m));
    }
  }
}

void StaticGeometry::HiddenTowards(std::span<const Eigen::Vector3f> points_m,
                                   const Eigen::Vector3f& direction, double range_m,
                                   std::span<std::uint8_t> hidden) const {
  ED3R_CHECK(hidden.size() == points_m.size(), "one answer per point");
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  RTCRay16 packet;
  for (std::size_t first = 0; first < points_m.size(); first += kPacket) {
    const std::size_t count = std::min(kPacket, points_m.size() - first);
    alignas(64) int valid[kPacket];
    for (std::size_t i = 0; i < kPacket; ++i) {
      valid[i] = i < count ? -1 : 0;
      SetRay(packet, i, points_m[first + std::min(i, count - 1)], direction, static_cast<float>(range_m));
    }
    rtcOccluded16(valid, impl_->scene.get(), &context, &packet);
    for (std::size_t i = 0; i < count; ++i) hidden[first + i] = packet.tfar[i] < 0.0f ? 1 : 0;
  }
}

bool StaticGeometry::Clear(const Eigen::Vector3d& centre_m, double half_side_m) const {
  struct AnyTriangle final : btTriangleCallback {
    bool found = false;
    void processTriangle(btVector3*, int, int) override { found = true; }
  } any;
  const Eigen::Vector3f low = (centre_m.array() - half_side_m).cast<float>();
  const Eigen::Vector3f high = (centre_m.array() + half_side_m).cast<float>();
  impl_->Shape().processAllTriangles(&any, btVector3(low.x(), low.y(), low.z()),
                                     btVector3(high.x(), high.y(), high.z()));
  return !any.found;
}

btCollisionShape* StaticGeometry::Shape() const { return &impl_->Shape(); }

const TriangleMesh& StaticGeometry::Mesh() const { return impl_->mesh; }

}  // namespace ed3r::world
