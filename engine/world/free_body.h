// A rigid body that nothing touches, stepped as Bullet steps it: semi-implicit Euler, the gyroscopic torque by one implicit
// Newton step in body axes, the attitude by the exponential map. Every sum is taken in Bullet's order and precision, so that a
// body may change between this and a Bullet world at any step and moves by the same bits (flight_world_test.cc). What Bullet
// does in calls through its library, and three times from one attitude, is here done once and in line.
// Units: SI. Threads: a value.
#pragma once

#include <LinearMath/btMatrix3x3.h>
#include <LinearMath/btQuaternion.h>
#include <LinearMath/btTransform.h>
#include <LinearMath/btVector3.h>

namespace ed3r::world {

// What does not change while it flies.
struct FreeBodySpec {
  btScalar inverse_mass_pkg = 1;
  btVector3 gravity_n{0, 0, 0};
  btVector3 inertia_kgm2{1, 1, 1};  // principal, body axes
  btVector3 inverse_inertia{1, 1, 1};
  btScalar step_s = 0;
};

class FreeBody {
 public:
  explicit FreeBody(const FreeBodySpec& spec) : spec_(spec) { pose_.setIdentity(); }

  void Set(const btTransform& pose, const btVector3& velocity_mps, const btVector3& rate_radps) {
    velocity_mps_ = velocity_mps;
    rate_radps_ = rate_radps;
    SetPose(pose);
  }

  const btTransform& Pose() const { return pose_; }
  const btQuaternion& Attitude() const { return attitude_; }  // of the pose
  const btVector3& VelocityMps() const { return velocity_mps_; }
  const btVector3& RateRadps() const { return rate_radps_; }  // world axes

  // One step under gravity, a force and a torque in world axes.
  void Step(const btVector3& force_n, const btVector3& torque_nm) {
    const btVector3 push = (force_n + spec_.gravity_n) * spec_.inverse_mass_pkg * spec_.step_s;
    btVector3 spin = torque_nm * inverse_inertia_world_ * spec_.step_s;
    spin += GyroscopicChange();
    velocity_mps_ += push;
    rate_radps_ += spin;
    Move();
  }

 private:
  void SetPose(const btTransform& pose) {
    pose_ = pose;
    attitude_ = pose.getRotation();
    inverse_inertia_world_ = pose.getBasis().scaled(spec_.inverse_inertia) * pose.getBasis().transpose();
  }

  // Of the rate in a step. With the momentum L = I w in body axes, the rate w' at the end solves
  // I (w' - w) + h w' x I w' = 0; the Newton step from w takes the residual h w x L and its derivative
  // I + h ([w] I - [L]), where [v] is the matrix of the cross product with v.
  btVector3 GyroscopicChange() const {
    const btVector3& i = spec_.inertia_kgm2;
    const btScalar h = spec_.step_s;
    const btVector3 w = quatRotate(attitude_.inverse(), rate_radps_);
    const btVector3 l = i * w;
    const btMatrix3x3 derivative(i.x(), (l.z() - w.z() * i.y()) * h, (w.y() * i.z() - l.y()) * h,  //
                                 (w.z() * i.x() - l.z()) * h, i.y(), (l.x() - w.x() * i.z()) * h,  //
                                 (l.y() - w.y() * i.x()) * h, (w.x() * i.y() - l.x()) * h, i.z());
    return quatRotate(attitude_, w - derivative.solve33(h * w.cross(l))) - rate_radps_;
  }

  void Move() {
    constexpr btScalar kMostTurnRad = 0.5f * SIMD_HALF_PI;  // in a step
    constexpr btScalar kSmallRadps = 0.001f;                // below it a series for the sine over the angle
    const btScalar h = spec_.step_s, half = 0.5f;
    const btScalar square = rate_radps_.length2();
    btScalar rate = square > SIMD_EPSILON ? btSqrt(square) : 0.0f;
    if (rate * h > kMostTurnRad) rate = kMostTurnRad / h;
    const btScalar share = rate < kSmallRadps ? half * h - h * h * h * 0.020833333333f * rate * rate
                                              : btSin(half * rate * h) / rate;
    const btVector3 axis = rate_radps_ * share;
    btQuaternion attitude = btQuaternion(axis.x(), axis.y(), axis.z(), btCos(rate * h * half)) * attitude_;
    attitude.safeNormalize();
    btTransform next(pose_.getBasis(), pose_.getOrigin() + velocity_mps_ * h);
    if (attitude.length2() > SIMD_EPSILON) next.setRotation(attitude);
    SetPose(next);
  }

  FreeBodySpec spec_;
  btTransform pose_;
  btQuaternion attitude_ = btQuaternion::getIdentity();
  btMatrix3x3 inverse_inertia_world_;
  btVector3 velocity_mps_{0, 0, 0}, rate_radps_{0, 0, 0};
};

}  // namespace ed3r::world
