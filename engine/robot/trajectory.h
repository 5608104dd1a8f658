// Reference motion along one axis that a quadrotor can follow: from rest to rest with limited speed,
// acceleration and jerk, and with the jerk averaged over MotionLimits::smoothing_s. The tilt follows the
// acceleration, so that jerk is a rate of turn and its change an angular acceleration: both must be finite.
//
// The front is the motion before the averaging, piecewise constant in jerk; decisions (braking) are taken on
// it. The smoothed motion is its mean over the last smoothing_s: it starts with the front, ends smoothing_s
// later and rests at the same place. Units are those of the axis (m or rad). A value; no allocation.
#pragma once

#include <array>

#include "engine/robot/airframe.h"

namespace ed3r::robot {

struct ProfilePoint {
  double position = 0.0;
  double speed = 0.0;
  double acceleration = 0.0;
  double jerk = 0.0;
  double snap = 0.0;  // of the smoothed motion; 0 on the front
};

class Profile {
 public:
  Profile() = default;  // at rest at 0

  // Over a length >= 0, as fast as the limits allow: up to seven phases.
  Profile(double length, const MotionLimits& limits);

  // The smoothed motion; before 0 at rest at the start, from DurationS() on at rest at the end.
  ProfilePoint At(double time_s) const;

  // At(time_s).snap, alone.
  double SnapAt(double time_s) const;

  ProfilePoint FrontAt(double time_s) const;

  double DurationS() const { return front_duration_s_ + limits_.smoothing_s; }
  double Length() const { return end_position_; }

  // Distance from a point of the front to rest under the fastest braking that the limits allow.
  double BrakingDistance(const ProfilePoint& front) const;

  // Replaces all of the front after time_s by the fastest braking.
  void BrakeAt(double time_s);

 private:
  // A point of the front, and the integral of position up to it, which makes averages a difference.
  struct Node {
    ProfilePoint point;
    double position_integral = 0.0;
  };
  struct Phase {
    double start_s = 0.0;
    Node start;  // its jerk holds for the whole phase
  };

  static Node Advance(const Node& from, double seconds);
  Node NodeAt(double time_s) const;
  double FrontJerkAt(double time_s) const;
  void Append(double seconds, double jerk);
  void SetEnd();

  static constexpr int kMaxPhases = 10;  // a braking keeps at most seven phases and adds at most three
  MotionLimits limits_;
  std::array<Phase, kMaxPhases> phases_ = {};
  int count_ = 0;
  double front_duration_s_ = 0.0;
  double end_position_ = 0.0;
  double end_integral_ = 0.0;
};

}  // namespace ed3r::robot
