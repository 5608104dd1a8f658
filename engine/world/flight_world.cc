#include "engine/world/flight_world.h"

#include <BulletCollision/BroadphaseCollision/btSimpleBroadphase.h>
#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>
#include <BulletCollision/CollisionDispatch/btDefaultCollisionConfiguration.h>
#include <BulletCollision/CollisionDispatch/btSimulationIslandManager.h>
#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>
#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <algorithm>
#include <cmath>
#include <mutex>

#include "engine/core/check.h"
#include "engine/world/free_body.h"

namespace ed3r::world {
namespace {

// Bullet counts bodies and manifolds in unguarded globals that nothing reads: worlds are made, take their
// first step (which makes the manifold) and are destroyed one at a time.
std::mutex& WorldMutex() {
  static std::mutex mutex;
  return mutex;
}

constexpr int kPoolSize = 16;
// Contacts are an exception that is counted; they need a plausible answer, not a precise one.
constexpr int kSolverIterations = 4;
// Rounding of the box inside which GJK finds contacts; Bullet's default of 4 cm suits larger bodies.
constexpr double kCollisionMarginM = 0.005;
// In air that is known to be clear a step moves the body and asks nothing of the scene. What is known is a cube
// around the place where Bullet's tree of triangles was last asked, as wide as the robot in any attitude plus
// the first of these; near surfaces the second, and there the question is put again after that way.
constexpr float kClearAirM = 1.0f;
constexpr float kAskAgainM = 0.25f;
// Of contacts, beyond the hull. It exceeds a step's way (12 cm at 120 steps a second and the fastest that the parameters
// allow) and Bullet's margins (5 cm) together.
constexpr double kReachM = 0.2;
// The static body's bounds reach beyond every flight, so that the pair (robot, scene) is made once and kept.
constexpr float kForeverM = 1e6f;

btVector3 ToBullet(const Eigen::Vector3d& v) {
  return btVector3(static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z()));
}

Eigen::Vector3d FromBullet(const btVector3& v) { return {v.x(), v.y(), v.z()}; }

btDefaultCollisionConstructionInfo SmallPools() {
  btDefaultCollisionConstructionInfo info;
  info.m_defaultMaxPersistentManifoldPoolSize = kPoolSize;
  info.m_defaultMaxCollisionAlgorithmPoolSize = kPoolSize;
  return info;
}

// The static object is its own class of one: it never moves, and its bounds are not its shape's.
class SceneBody : public btCollisionObject {
 public:
  explicit SceneBody(btCollisionShape* shape) {
    setCollisionShape(shape);
    setCollisionFlags(getCollisionFlags() | btCollisionObject::CF_STATIC_OBJECT);
    setActivationState(ISLAND_SLEEPING);
  }
};

}  // namespace

struct FlightWorld::Impl {
  Impl(const StaticGeometry& the_geometry, const RigidBodySpec& robot, double gravity_mps2, double the_step_s)
      : geometry(the_geometry),
        step_s(static_cast<float>(the_step_s)),
        hull_radius_m(0.5 * robot.size_m.norm()),
        configuration(SmallPools()),
        dispatcher(&configuration),
        broadphase(/*maxProxies=*/4),
        world(&dispatcher, &broadphase, &solver, &configuration),
        scene(geometry.Shape()),
        box(ToBullet(0.5 * robot.size_m)),
        body(BodyInfo(robot)),
        flying(FlyingAs(body, gravity_mps2, step_s)) {
    world.setGravity(btVector3(0, 0, static_cast<float>(-gravity_mps2)));
    world.getSolverInfo().m_numIterations = kSolverIterations;
    world.getSimulationIslandManager()->setSplitIslands(false);  // one body: nothing to split
    world.setForceUpdateAllAabbs(false);
    // No continuous collision detection: at 120 steps a second one moves the robot 4 cm at cruise (12 cm at the
    // fastest that the parameters allow), a fraction of its size.
    world.getDispatchInfo().m_useContinuous = false;

    const int everything = btBroadphaseProxy::AllFilter;
    world.addCollisionObject(&scene, btBroadphaseProxy::StaticFilter, btBroadphaseProxy::DefaultFilter);
    broadphase.setAabb(scene.getBroadphaseHandle(), btVector3(-kForeverM, -kForeverM, -kForeverM),
                       btVector3(kForeverM, kForeverM, kForeverM), &dispatcher);
    body.setActivationState(DISABLE_DEACTIVATION);
    world.addRigidBody(&body, btBroadphaseProxy::DefaultFilter, everything);
  }

  ~Impl() {
    world.removeRigidBody(&body);
    world.removeCollisionObject(&scene);
  }

  btRigidBody::btRigidBodyConstructionInfo BodyInfo(const RigidBodySpec& robot) {
    const double smallest_m = robot.size_m.minCoeff();
    box.setMargin(static_cast<float>(std::min(kCollisionMarginM, 0.1 * smallest_m)));
    btRigidBody::btRigidBodyConstructionInfo info(static_cast<float>(robot.mass_kg), nullptr, &box,
                                                  ToBullet(robot.inertia_kgm2));
    info.m_restitution = 0.0f;
    return info;
  }

  // What Bullet makes of the same numbers.
  static FreeBodySpec FlyingAs(const btRigidBody& body, double gravity_mps2, float step_s) {
    return {.inverse_mass_pkg = body.getInvMass(),
            .gravity_n = btVector3(0, 0, static_cast<float>(-gravity_mps2)) * (1.0f / body.getInvMass()),
            .inertia_kgm2 = body.getLocalInertia(),
            .inverse_inertia = body.getInvInertiaDiagLocal(),
            .step_s = step_s};
  }

  // Whether no surface can be touched in the coming step.
  bool InClearAir() {
    const btVector3& at_m = flying.Pose().getOrigin();
    const btVector3 moved_m = (at_m - asked_at_m).absolute();
    if (std::max({moved_m.x(), moved_m.y(), moved_m.z()}) < ask_after_m) return clear;
    const bool was_clear = clear;
    asked_at_m = at_m;
    ask_after_m = kClearAirM;
    clear = geometry.Clear(FromBullet(at_m), hull_radius_m + kReachM + kClearAirM);
    if (!clear) {
      ask_after_m = kAskAgainM;
      clear = geometry.Clear(FromBullet(at_m), hull_radius_m + kReachM + kAskAgainM);
    }
    // Contacts that Bullet remembers from before are over.
    if (clear && !was_clear)
      for (int i = 0; i < dispatcher.getNumManifolds(); ++i)
        dispatcher.getManifoldByIndexInternal(i)->clearManifold();
    return clear;
  }

  // One step in which Bullet looks for contacts.
  void StepWatched(const btVector3& force_n, const btVector3& torque_nm) {
    body.setLinearVelocity(flying.VelocityMps());
    body.setAngularVelocity(flying.RateRadps());
    body.proceedToTransform(flying.Pose());
    body.applyCentralForce(force_n);
    body.applyTorque(torque_nm);
    std::unique_lock<std::mutex> lock;
    if (!stepped) lock = std::unique_lock(WorldMutex());
    stepped = true;
    world.stepSimulation(step_s, /*maxSubSteps=*/0);
    flying.Set(body.getWorldTransform(), body.getLinearVelocity(), body.getAngularVelocity());
    if (Touching()) ++contact_steps;
  }

  bool Touching() {
    for (int i = 0; i < dispatcher.getNumManifolds(); ++i) {
      const btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal(i);
      for (int k = 0; k < manifold.getNumContacts(); ++k)
        if (manifold.getContactPoint(k).getDistance() <= 0.0f) return true;
    }
    return false;
  }

  const StaticGeometry& geometry;
  const float step_s;
  const double hull_radius_m;
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher;
  btSimpleBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world;
  SceneBody scene;
  btBoxShape box;
  btRigidBody body;
  FreeBody flying;  // where the robot is; the body above follows it when Bullet is asked
  int contact_steps = 0;
  bool stepped = false;
  // The last question about clear air, its answer, and the way after which it is put again: 0 where none was put.
  bool clear = false;
  float ask_after_m = 0.0f;
  btVector3 asked_at_m{0, 0, 0};
};

FlightWorld::FlightWorld(const StaticGeometry& geometry, const RigidBodySpec& robot, double gravity_mps2,
                         double step_s) {
  const std::lock_guard lock(WorldMutex());
  impl_ = std::make_unique<Impl>(geometry, robot, gravity_mps2, step_s);
}

FlightWorld::~FlightWorld() {
  const std::lock_guard lock(WorldMutex());
  impl_.reset();
}

void FlightWorld::SetState(const RigidBodyState& state) {
  const Eigen::Quaternionf q = state.attitude.cast<float>();
  impl_->flying.Set(btTransform(btQuaternion(q.x(), q.y(), q.z(), q.w()), ToBullet(state.position_m)),
                    ToBullet(state.velocity_mps), ToBullet(state.attitude * state.rate_radps));
  impl_->ask_after_m = 0.0f;
  impl_->clear = false;
}

RigidBodyState FlightWorld::State() const {
  const FreeBody& body = impl_->flying;
  const btQuaternion& q = body.Attitude();
  RigidBodyState state;
  state.position_m = FromBullet(body.Pose().getOrigin());
  state.attitude = Eigen::Quaterniond(q.w(), q.x(), q.y(), q.z());
  state.velocity_mps = FromBullet(body.VelocityMps());
  state.rate_radps = state.attitude.conjugate() * FromBullet(body.RateRadps());
  ED3R_CHECK(state.position_m.allFinite() && state.velocity_mps.allFinite() && state.rate_radps.allFinite(),
             "the robot's state is not finite");
  return state;
}

void FlightWorld::Step(const Eigen::Vector3d& force_world_n, const Eigen::Vector3d& torque_body_nm) {
  const btVector3 force_n = ToBullet(force_world_n);
  const btVector3 torque_nm = impl_->flying.Pose().getBasis() * ToBullet(torque_body_nm);
  if (impl_->InClearAir())
    impl_->flying.Step(force_n, torque_nm);
  else
    impl_->StepWatched(force_n, torque_nm);
}

int FlightWorld::ContactSteps() const { return impl_->contact_steps; }

}  // namespace ed3r::world
