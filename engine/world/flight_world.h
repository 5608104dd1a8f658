// The Bullet world of one mission: the shared static geometry and the robot as one rigid body.
//
// A fresh world per mission is what makes Bullet reproducible; it is built lean (two bodies, pools of 16, a
// broadphase for two proxies), because a default world costs a thousand times more to make than to step.
// Threads: one mission, one world, one thread; worlds in different threads may share one StaticGeometry.
// Units: SI; Bullet works in single precision inside, so a position at 500 m is good to 0.03 mm.
// Errors: a state that is not finite throws InternalError.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>

#include "engine/world/geometry.h"

namespace ed3r::world {

struct RigidBodySpec {
  double mass_kg = 1.0;
  Eigen::Vector3d size_m = Eigen::Vector3d::Constant(0.3);         // box, full extents
  Eigen::Vector3d inertia_kgm2 = Eigen::Vector3d::Constant(0.01);  // principal, body axes
};

struct RigidBodyState {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Quaterniond attitude = Eigen::Quaterniond::Identity();  // body to world
  Eigen::Vector3d velocity_mps = Eigen::Vector3d::Zero();
  Eigen::Vector3d rate_radps = Eigen::Vector3d::Zero();  // body axes
};

class FlightWorld {
 public:
  FlightWorld(const StaticGeometry& geometry, const RigidBodySpec& robot, double gravity_mps2, double step_s);
  ~FlightWorld();
  FlightWorld(const FlightWorld&) = delete;
  FlightWorld& operator=(const FlightWorld&) = delete;

  void SetState(const RigidBodyState& state);
  RigidBodyState State() const;

  // One step of step_s under gravity, a force in world axes and a torque in body axes.
  void Step(const Eigen::Vector3d& force_world_n, const Eigen::Vector3d& torque_body_nm);

  // Steps so far in which the robot touched ground or tree.
  int ContactSteps() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace ed3r::world
