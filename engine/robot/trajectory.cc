#include "engine/robot/trajectory.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/core/check.h"

namespace ed3r::robot {
namespace {

struct Ramp {
  double peak_speed = 0.0;
  double jerk_s = 0.0;      // each of the two jerk phases
  double constant_s = 0.0;  // at full acceleration
  double Seconds() const { return 2.0 * jerk_s + constant_s; }
};

// From rest to a speed as fast as possible.
Ramp RampTo(double speed, const MotionLimits& limits) {
  const double full = limits.acceleration_mps2 * limits.acceleration_mps2 / limits.jerk_mps3;
  if (speed >= full)
    return {speed, limits.acceleration_mps2 / limits.jerk_mps3,
            speed / limits.acceleration_mps2 - limits.acceleration_mps2 / limits.jerk_mps3};
  return {speed, std::sqrt(speed / limits.jerk_mps3), 0.0};
}

// The ramp whose way up and way down together cover the length: peak * Seconds() = length.
Ramp RampOver(double length, const MotionLimits& limits) {
  const double a = limits.acceleration_mps2;
  const double full = a * a / limits.jerk_mps3;
  const double trapezoid = 0.5 * (std::sqrt(full * full + 4.0 * length * a) - full);
  if (trapezoid >= full) return RampTo(trapezoid, limits);
  return RampTo(std::cbrt(0.25 * length * length * limits.jerk_mps3), limits);
}

// The three phases of a braking: to the peak deceleration, held there, back to none.
struct Braking {
  double first_s, first_jerk;
  double hold_s;
  double last_s, last_jerk;
};

Braking BrakingFrom(const ProfilePoint& from, const MotionLimits& limits) {
  const double jerk = limits.jerk_mps3;
  const double speed = std::max(from.speed, 0.0);
  const double ramped = from.acceleration * from.acceleration / (2.0 * jerk);
  if (from.acceleration < 0.0 && speed <= ramped) {
    // It brakes so hard already that it must let go now: linearly, to end at rest.
    const double seconds = 2.0 * speed / -from.acceleration;
    return {0.0, 0.0, 0.0, seconds, seconds > 0.0 ? -from.acceleration / seconds : 0.0};
  }
  const double reach = speed + ramped;  // the speed at which the acceleration is, or was, none on this course
  const double peak = std::min(limits.acceleration_mps2, std::sqrt(reach * jerk));
  const double let_go = peak * peak / (2.0 * jerk);
  return {std::max(from.acceleration + peak, 0.0) / jerk, -jerk,
          std::max(reach - 2.0 * let_go, 0.0) / std::max(peak, 1e-9), peak / jerk, jerk};
}

}  // namespace

Profile::Profile(double length, const MotionLimits& limits) : limits_(limits) {
  ED3R_CHECK(limits.smoothing_s > 0.0, "motion must be smoothed");
  ED3R_CHECK(length >= 0.0, fmt::format("length {}", length));
  if (length == 0.0) {
    limits_.smoothing_s = 0.0;
    return;
  }
  Ramp ramp = RampTo(limits.speed_mps, limits);
  double cruise_s = 0.0;
  if (ramp.peak_speed * ramp.Seconds() <= length)
    cruise_s = length / ramp.peak_speed - ramp.Seconds();
  else
    ramp = RampOver(length, limits);
  const double jerk = limits.jerk_mps3;
  Append(ramp.jerk_s, jerk);
  Append(ramp.constant_s, 0.0);
  Append(ramp.jerk_s, -jerk);
  Append(cruise_s, 0.0);
  Append(ramp.jerk_s, -jerk);
  Append(ramp.constant_s, 0.0);
  Append(ramp.jerk_s, jerk);
  SetEnd();
  end_position_ = length;  // without the rounding of seven phases
}

Profile::Node Profile::Advance(const Node& from, double t) {
  const ProfilePoint& p = from.point;
  Node node;
  node.point.jerk = p.jerk;
  node.point.acceleration = p.acceleration + p.jerk * t;
  node.point.speed = p.speed + t * (p.acceleration + t * p.jerk / 2.0);
  node.point.position = p.position + t * (p.speed + t * (p.acceleration / 2.0 + t * p.jerk / 6.0));
  node.position_integral =
      from.position_integral +
      t * (p.position + t * (p.speed / 2.0 + t * (p.acceleration / 6.0 + t * p.jerk / 24.0)));
  return node;
}

Profile::Node Profile::NodeAt(double time_s) const {
  if (time_s <= 0.0) return {};
  if (time_s >= front_duration_s_)
    return {{.position = end_position_}, end_integral_ + end_position_ * (time_s - front_duration_s_)};
  int i = count_ - 1;
  while (phases_[i].start_s > time_s) --i;
  return Advance(phases_[i].start, time_s - phases_[i].start_s);
}

ProfilePoint Profile::FrontAt(double time_s) const { return NodeAt(time_s).point; }

ProfilePoint Profile::At(double time_s) const {
  if (time_s >= DurationS()) return {.position = end_position_};
  const Node now = NodeAt(time_s);
  const Node before = NodeAt(time_s - limits_.smoothing_s);
  const double per_s = 1.0 / limits_.smoothing_s;
  return {.position = per_s * (now.position_integral - before.position_integral),
          .speed = per_s * (now.point.position - before.point.position),
          .acceleration = per_s * (now.point.speed - before.point.speed),
          .jerk = per_s * (now.point.acceleration - before.point.acceleration),
          .snap = per_s * (now.point.jerk - before.point.jerk)};
}

double Profile::FrontJerkAt(double time_s) const {
  if (time_s <= 0.0 || time_s >= front_duration_s_) return 0.0;
  int i = count_ - 1;
  while (phases_[i].start_s > time_s) --i;
  return phases_[i].start.point.jerk;
}

double Profile::SnapAt(double time_s) const {
  if (time_s >= DurationS()) return 0.0;
  return 1.0 / limits_.smoothing_s * (FrontJerkAt(time_s) - FrontJerkAt(time_s - limits_.smoothing_s));
}

void Profile::Append(double seconds, double jerk) {
  if (seconds <= 0.0) return;
  ED3R_CHECK(count_ < kMaxPhases, "too many phases");
  Node start;
  if (count_ > 0) {
    const Phase& last = phases_[count_ - 1];
    start = Advance(last.start, front_duration_s_ - last.start_s);
  }
  start.point.jerk = jerk;
  phases_[count_++] = {front_duration_s_, start};
  front_duration_s_ += seconds;
}

void Profile::SetEnd() {
  Node end;
  if (count_ > 0) {
    const Phase& last = phases_[count_ - 1];
    end = Advance(last.start, front_duration_s_ - last.start_s);
  }
  end_position_ = end.point.position;
  end_integral_ = end.position_integral;
}

double Profile::BrakingDistance(const ProfilePoint& front) const {
  const Braking braking = BrakingFrom(front, limits_);
  Node node{front, 0.0};
  node.point.jerk = braking.first_jerk;
  node = Advance(node, braking.first_s);
  node.point.jerk = 0.0;
  node = Advance(node, braking.hold_s);
  node.point.jerk = braking.last_jerk;
  return Advance(node, braking.last_s).point.position - front.position;
}

void Profile::BrakeAt(double time_s) {
  if (time_s >= front_duration_s_) return;
  const Braking braking = BrakingFrom(FrontAt(time_s), limits_);
  while (count_ > 0 && phases_[count_ - 1].start_s >= time_s) --count_;
  front_duration_s_ = std::max(time_s, 0.0);
  Append(braking.first_s, braking.first_jerk);
  Append(braking.hold_s, 0.0);
  Append(braking.last_s, braking.last_jerk);
  SetEnd();
}

}  // namespace ed3r::robot
