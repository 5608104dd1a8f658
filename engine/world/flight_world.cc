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
// this; near surfaces the question is put again after a shorter way. It exceeds a step's way (12 cm at 120
// steps a second and the fastest that the parameters allow) and Bullet's margins (5 cm).
constexpr float kClearAirM = 1.0f;
constexpr float kAskAgainM = 0.25f;
constexpr double kReachM = 0.2;  // of contacts, beyond the hull
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
        body(BodyInfo(robot)) {
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

  // Whether no surface can be touched in the coming step.
  bool InClearAir() {
    const btVector3& at_m = body.getWorldTransform().getOrigin();
    const btVector3 moved_m = (at_m - asked_at_m).absolute();
    const float farthest_m = std::max({moved_m.x(), moved_m.y(), moved_m.z()});
    if (asked && farthest_m < (clear ? kClearAirM : kAskAgainM)) return clear;
    const bool was_clear = asked && clear;
    asked = true;
    asked_at_m = at_m;
    clear = geometry.Clear(FromBullet(at_m), hull_radius_m + kReachM + kClearAirM);
    // Contacts that Bullet remembers from before are over.
    if (clear && !was_clear)
      for (int i = 0; i < dispatcher.getNumManifolds(); ++i)
        dispatcher.getManifoldByIndexInternal(i)->clearManifold();
    return clear;
  }

  // What stepSimulation does to a body that nothing touches, operation by operation (forces as the constraint
  // solver's external impulses), so that both ways give the same bits.
  void StepFreely() {
    body.applyGravity();
    const btVector3 push = body.getTotalForce() * body.getInvMass() * step_s;
    btVector3 spin = body.getTotalTorque() * body.getInvInertiaTensorWorld() * step_s;
    spin += body.computeGyroscopicImpulseImplicit_Body(step_s);
    body.setLinearVelocity(body.getLinearVelocity() + push);
    body.setAngularVelocity(body.getAngularVelocity() + spin);
    btTransform next;
    body.predictIntegratedTransform(step_s, next);
    body.proceedToTransform(next);
    body.clearForces();
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
  int contact_steps = 0;
  bool stepped = false;
  // The last question about clear air, and its answer.
  bool asked = false;
  bool clear = false;
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
  btRigidBody& body = impl_->body;
  const Eigen::Quaternionf q = state.attitude.cast<float>();
  const btTransform pose(btQuaternion(q.x(), q.y(), q.z(), q.w()), ToBullet(state.position_m));
  body.setWorldTransform(pose);
  body.setInterpolationWorldTransform(pose);
  body.setLinearVelocity(ToBullet(state.velocity_mps));
  body.setAngularVelocity(ToBullet(state.attitude * state.rate_radps));
  body.updateInertiaTensor();
  body.clearForces();
  impl_->asked = false;
}

RigidBodyState FlightWorld::State() const {
  const btRigidBody& body = impl_->body;
  const btQuaternion q = body.getWorldTransform().getRotation();
  RigidBodyState state;
  state.position_m = FromBullet(body.getWorldTransform().getOrigin());
  state.attitude = Eigen::Quaterniond(q.w(), q.x(), q.y(), q.z());
  state.velocity_mps = FromBullet(body.getLinearVelocity());
  state.rate_radps = state.attitude.conjugate() * FromBullet(body.getAngularVelocity());
  ED3R_CHECK(state.position_m.allFinite() && state.velocity_mps.allFinite() && state.rate_radps.allFinite(),
             "the robot's state is not finite");
  return state;
}

void FlightWorld::Step(const Eigen::Vector3d& force_world_n, const Eigen::Vector3d& torque_body_nm) {
  btRigidBody& body = impl_->body;
  body.applyCentralForce(ToBullet(force_world_n));
  body.applyTorque(body.getWorldTransform().getBasis() * ToBullet(torque_body_nm));
  if (impl_->InClearAir()) {
    impl_->StepFreely();
    return;
  }
  std::unique_lock<std::mutex> lock;
  if (!impl_->stepped) lock = std::unique_lock(WorldMutex());
  impl_->stepped = true;
  impl_->world.stepSimulation(impl_->step_s, /*maxSubSteps=*/0);
  if (impl_->Touching()) ++impl_->contact_steps;
}

int FlightWorld::ContactSteps() const { return impl_->contact_steps; }

}  // namespace ed3r::world
