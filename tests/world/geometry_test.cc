#include "engine/world/geometry.h"

#include <BulletCollision/BroadphaseCollision/btBroadphaseProxy.h>
#include <BulletCollision/CollisionShapes/btBvhTriangleMeshShape.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <map>
#include <thread>
#include <utility>
#include <vector>

#include "engine/core/check.h"
#include "engine/core/random.h"
#include "engine/world/bake.h"
#include "tests/world/scene_builder.h"

namespace ed3r::world {
namespace {

using Eigen::Vector3d;

double Hills(double x_m, double y_m) {
  return 20.0 + 8.0 * std::sin(0.07 * x_m) + 5.0 * std::cos(0.11 * y_m + 0.03 * x_m);
}

double Wall(double x_m, double) { return x_m == 50.0 ? 30.0 : 0.0; }

TriangleMesh OneTriangle() {
  return {.vertices_m = {{0, 0, 0}, {10, 0, 0}, {0, 10, 0}}, .triangles = {{0, 1, 2}}};
}

TEST(Terrain, HeightEqualsARayStraightDown) {
  const Scene scene(PartsOf(101, 2.0, Hills));
  Stream stream(7, 0, Purpose::kWorld);
  for (int i = 0; i < 20000; ++i) {
    // A quarter of the points lie on nodes and on cell edges, where a ray could slip between triangles.
    double x = stream.Uniform(0.0, 200.0);
    double y = stream.Uniform(0.0, 200.0);
    if (i % 4 == 0) x = std::floor(x / 2.0) * 2.0;
    if (i % 8 == 0) y = std::floor(y / 2.0) * 2.0;
    const double distance_m = scene.Geometry().Distance({x, y, 100.0}, -Vector3d::UnitZ(), 200.0);
    ASSERT_NEAR(100.0 - distance_m, scene.Ground().HeightAt(x, y), 1e-3) << x << " " << y;
  }
}

TEST(Terrain, SplitsCellsFromSouthWestToNorthEast) {
  Terrain cell{.columns = 2, .rows = 2, .cell_m = 2.0, .height_m = {0, 4, 8, 0}};
  EXPECT_DOUBLE_EQ(cell.HeightAt(1.0, 1.0), 0.0);  // the diagonal joins two zeros
  EXPECT_DOUBLE_EQ(cell.HeightAt(1.5, 0.5), 2.0);
  EXPECT_DOUBLE_EQ(cell.HeightAt(0.5, 1.5), 4.0);
}

TEST(Geometry, ACubeIsClearWhereNoSurfaceCrossesIt) {
  const StaticGeometry geometry(OneTriangle());
  EXPECT_TRUE(geometry.Clear({2, 2, 1.5}, 1.0));
  EXPECT_FALSE(geometry.Clear({2, 2, 0.9}, 1.0));
  EXPECT_FALSE(geometry.Clear({2, 2, -0.9}, 1.0));
  EXPECT_TRUE(geometry.Clear({-1.5, 2, 0}, 1.0));
  EXPECT_FALSE(geometry.Clear({-0.9, 2, 0}, 1.0));
}

TEST(Terrain, ClampsPositionsOutside) {
  const Scene scene(PartsOf(11, 2.0, Hills));
  EXPECT_EQ(scene.Ground().HeightAt(-50.0, 7.0), scene.Ground().HeightAt(0.0, 7.0));
  EXPECT_EQ(scene.Ground().HeightAt(99.0, 99.0), scene.Ground().HeightAt(20.0, 20.0));
}

TEST(StaticGeometry, DistanceIsInfiniteBeyondRange) {
  const StaticGeometry geometry(OneTriangle());
  EXPECT_DOUBLE_EQ(geometry.Distance({1, 1, 5}, -Vector3d::UnitZ(), 5.5), 5.0);
  EXPECT_EQ(geometry.Distance({1, 1, 5}, -Vector3d::UnitZ(), 4.5), std::numeric_limits<double>::infinity());
  EXPECT_EQ(geometry.Distance({1, 1, 5}, Vector3d::UnitZ(), 100), std::numeric_limits<double>::infinity());
  EXPECT_DOUBLE_EQ(geometry.Distance({1, 1, -5}, Vector3d::UnitZ(), 100), 5.0);  // from behind as well
}

TEST(StaticGeometry, GrazingRaysStayWithinTheTriangle) {
  // All of these meet the triangle 5 m along; the flatter, the less the plane says about where.
  const StaticGeometry geometry(OneTriangle());
  for (const double drop : {1e-2, 1e-3, 1e-4, 1e-5, 1e-6}) {
    const Vector3d direction = Vector3d(1.0, 0.0, -drop).normalized();
    const double distance_m = geometry.Distance({-1, 1, 5 * drop}, direction, 100);
    EXPECT_GE(distance_m, 1.0 - 1e-6) << drop;
    EXPECT_LE(distance_m, 11.0 + 1e-6) << drop;
  }
  EXPECT_NEAR(geometry.Distance({-1, 1, 0.05}, Vector3d(1, 0, -0.01).normalized(), 100),
              5.0 * std::sqrt(1.0001), 1e-9);
}

TEST(StaticGeometry, AnswersAreTheSameFromManyThreads) {
  const Scene scene(PartsOf(101, 2.0, Hills));
  const auto answers = [&] {
    Stream stream(3, 0, Purpose::kWorld);
    std::vector<double> distances;
    for (int i = 0; i < 5000; ++i) {
      const Vector3d origin(stream.Uniform(0, 200), stream.Uniform(0, 200), stream.Uniform(20, 60));
      const Vector3d to(stream.Uniform(0, 200), stream.Uniform(0, 200), stream.Uniform(0, 40));
      distances.push_back(scene.Geometry().Distance(origin, (to - origin).normalized(), 150.0));
      distances.push_back(scene.Geometry().Occluded(origin, to));
    }
    return distances;
  };
  const std::vector<double> alone = answers();
  std::vector<std::vector<double>> together(4);
  std::vector<std::thread> threads;
  for (auto& result : together) threads.emplace_back([&] { result = answers(); });
  for (std::thread& thread : threads) thread.join();
  for (const auto& result : together) EXPECT_EQ(result, alone);
}

TEST(StaticGeometry, AWallHidesWhatIsBehindIt) {
  const Scene scene(PartsOf(51, 2.0, Wall));
  const StaticGeometry& geometry = scene.Geometry();
  EXPECT_TRUE(geometry.Occluded({10, 50, 5}, {90, 50, 5}));
  EXPECT_TRUE(geometry.Occluded({90, 50, 5}, {10, 50, 5}));
  EXPECT_FALSE(geometry.Occluded({10, 50, 31}, {90, 50, 31}));
  EXPECT_FALSE(geometry.Occluded({10, 50, 5}, {40, 50, 5}));
  EXPECT_TRUE(geometry.Occluded({10, 50, 29}, {90, 50, 29}));
}

TEST(StaticGeometry, OcclusionStopsOneCentimetreShort) {
  const StaticGeometry geometry(OneTriangle());
  EXPECT_FALSE(geometry.Occluded({1, 1, 5}, {1, 1, 0.0}));
  EXPECT_FALSE(geometry.Occluded({1, 1, 5}, {1, 1, -0.009}));
  EXPECT_TRUE(geometry.Occluded({1, 1, 5}, {1, 1, -0.011}));
  EXPECT_FALSE(geometry.Occluded({1, 1, 0.005}, {1, 1, -0.005}));
  EXPECT_FALSE(geometry.Occluded({1, 1, 0}, {1, 1, 0}));
}

TEST(StaticGeometry, BulletSharesTheTriangles) {
  const Scene scene(PartsOf(3, 2.0, Hills));
  btCollisionShape* shape = scene.Geometry().Shape();
  ASSERT_EQ(shape->getShapeType(), TRIANGLE_MESH_SHAPE_PROXYTYPE);
  struct Counter : btTriangleCallback {
    void processTriangle(btVector3* corners, int, int) override {
      ++triangles;
      // Counter-clockwise from above, as contacts expect.
      EXPECT_GT((corners[1] - corners[0]).cross(corners[2] - corners[0]).z(), 0.0f);
    }
    int triangles = 0;
  } counter;
  static_cast<btBvhTriangleMeshShape*>(shape)->processAllTriangles(&counter, {-1, -1, -100}, {9, 9, 100});
  EXPECT_EQ(counter.triangles, 8);
}

TEST(StaticGeometry, RefusesBrokenMeshes) {
  EXPECT_THROW(StaticGeometry(TriangleMesh{}), InternalError);
  TriangleMesh bad_index = OneTriangle();
  bad_index.triangles[0].z() = 3;
  EXPECT_THROW(StaticGeometry(std::move(bad_index)), InternalError);
  TriangleMesh not_finite = OneTriangle();
  not_finite.vertices_m[0].x() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(StaticGeometry(std::move(not_finite)), InternalError);
}

class OneTree : public ::testing::Test {
 protected:
  static constexpr Tree kTree = {.x_m = 30,
                                 .y_m = 40,
                                 .ground_m = 12,
                                 .height_m = 20,
                                 .trunk_radius_m = 0.3,
                                 .crown_radius_m = 3,
                                 .crown_depth_m = 12};
  const Scene scene{PartsOf(41, 2.0, [](double, double) { return 12.0; }, {kTree})};
  const StaticGeometry& geometry = scene.Geometry();
};

TEST_F(OneTree, IsHitAtItsHeight) {
  EXPECT_NEAR(geometry.Distance({30, 40, 100}, -Vector3d::UnitZ(), 200), 100 - 32, 1e-5);
  EXPECT_NEAR(geometry.Distance({50, 60, 100}, -Vector3d::UnitZ(), 200), 100 - 12, 1e-5);
}

TEST_F(OneTree, CrownFillsTheTopAndTheTrunkStandsBelow) {
  // East of the tree, level rays to the west: the crown's widest ring, then the bare trunk.
  EXPECT_NEAR(geometry.Distance({40, 40, 20 + 0.3 * 12}, -Vector3d::UnitX(), 30), 10 - 3, 1e-4);
  EXPECT_NEAR(geometry.Distance({40, 40, 16}, -Vector3d::UnitX(), 30), 10 - 0.3, 1e-4);
  EXPECT_TRUE(geometry.Occluded({40, 40, 16}, {20, 40, 16}));
  EXPECT_FALSE(geometry.Occluded({40, 40.5, 16}, {20, 40.5, 16}));
  EXPECT_FALSE(geometry.Occluded({40, 40, 32.1}, {20, 40, 32.1}));
}

TEST_F(OneTree, IsClosed) {
  // Every edge of a closed surface is used once in each direction.
  const TriangleMesh& mesh = geometry.Mesh();
  const std::size_t terrain_triangles = mesh.triangles.size() - kTrianglesPerTree;
  EXPECT_EQ(terrain_triangles, 2u * 40 * 40);
  std::map<std::pair<int, int>, int> uses;
  for (std::size_t i = terrain_triangles; i < mesh.triangles.size(); ++i)
    for (int k = 0; k < 3; ++k) ++uses[{mesh.triangles[i][k], mesh.triangles[i][(k + 1) % 3]}];
  for (const auto& [edge, count] : uses) {
    EXPECT_EQ(count, 1);
    EXPECT_EQ(uses.count({edge.second, edge.first}), 1u);
  }
}

TEST_F(OneTree, FacesOutwards) {
  // The volume enclosed by outward faces is positive and near that of the trunk's prism and the crown.
  const TriangleMesh& mesh = geometry.Mesh();
  double volume_m3 = 0.0;
  const Vector3d centre(30, 40, 20);
  for (std::size_t i = mesh.triangles.size() - kTrianglesPerTree; i < mesh.triangles.size(); ++i) {
    const Eigen::Vector3i& t = mesh.triangles[i];
    const Vector3d a = mesh.vertices_m[t[0]].cast<double>() - centre;
    const Vector3d b = mesh.vertices_m[t[1]].cast<double>() - centre;
    const Vector3d c = mesh.vertices_m[t[2]].cast<double>() - centre;
    volume_m3 += a.dot(b.cross(c)) / 6.0;
  }
  const double hexagon = 1.5 * std::sqrt(3.0);  // area of the unit hexagon
  const double pentagon = 2.5 * std::sin(2.0 * 3.14159265358979 / 5.0);
  const double crown = hexagon * 9.0 * 12.0 * (0.3 / 3 + 0.35 * (1 + 0.6 + 0.36) / 3 + 0.35 * 0.36 / 3);
  const double trunk = pentagon * 0.09 * (8.0 + 0.2 * 12.0 + 1.0);
  EXPECT_NEAR(volume_m3, crown + trunk, 1e-3 * crown);
}

}  // namespace
}  // namespace ed3r::world
