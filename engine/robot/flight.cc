#include "engine/robot/flight.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "engine/core/check.h"
#include "engine/robot/airframe.h"
#include "engine/robot/controller.h"
#include "engine/robot/lidar.h"
#include "engine/robot/rotors.h"
#include "engine/robot/trajectory.h"
#include "engine/robot/wind.h"
#include "engine/world/flight_world.h"

namespace ed3r {
namespace {

constexpr double kStepS = FlightWorld::kStepS;
constexpr double kNothingM = 1e-3;    // a shorter leg is not flown
constexpr double kNothingRad = 1e-3;  // likewise a turn
constexpr double kLeastHopM = 0.1;    // a leg with less room is not begun
constexpr double kSettledM = 0.05;    // plus this many seconds of gust:
constexpr double kSettledGustS = 0.03;
constexpr double kSettledMps = 0.10;
constexpr double kSettledMpsPerGust = 0.10;
constexpr double kSettledRad = std::numbers::pi / 180.0;
constexpr double kSettledRadps = 0.1;
// Around the robot inside the LiDARs' tube: for tracking error, the parts of a tree that fit between two
// rays, and the 4 cm by which Bullet thickens the scene; gusts push the robot further off its line.
constexpr double kTubeMarginM = 0.20;
constexpr double kTubeMarginGustS = 0.10;

Airframe FlyableAirframe(const Config& config) {
  const std::string problem = CheckFlyable(config);
  if (!problem.empty()) throw UserError(problem);
  return Airframe(config);
}

double TubeMarginM(const EnvironmentConfig& environment) {
  return kTubeMarginM + kTubeMarginGustS * environment.gust_mps;
}

int StepsPer(double rate_hz) { return std::max(1, static_cast<int>(std::lround(1.0 / (rate_hz * kStepS)))); }

}  // namespace

struct Flight::Impl {
  Impl(const Scene& the_scene, const Config& the_config, const Pose& start, std::uint64_t the_seed,
       std::uint32_t the_scenario)
      : scene(the_scene),
        config(the_config),
        seed(the_seed),
        scenario(the_scenario),
        airframe(FlyableAirframe(config)),
        envelope(EnvelopeOf(airframe, config)),
        world(scene.Geometry(), {airframe.mass_kg, airframe.size_m, airframe.inertia_kgm2},
              airframe.gravity_mps2),
        rotors(airframe),
        controller(airframe, envelope.tilt_max_rad),
        lidars(scene.Geometry(), airframe.BoundingRadiusM() + TubeMarginM(config.environment),
               config.sensing.lidar_range_m),
        scan_every(StepsPer(config.sensing.lidar_rate_hz)),
        trace_every(StepsPer(kTraceHz)),
        pose(start) {}

  struct LegResult {
    double seconds = 0.0;
    double displacement_m = 0.0;  // along the leg
    bool halted = false;
  };

  FlownMove Execute(const MotionCommand& command, std::uint32_t the_timestep);
  Eigen::Vector3d Target(const Eigen::Vector3d& displacement_m) const;
  void TakeOver(std::uint32_t the_timestep, double turn_rad);
  LegResult FlyLeg(const Eigen::Vector3d& direction, double length_m, const MotionLimits& limits,
                   double stand_off_m);
  double FinishTurn();
  void StepPhysics(const FlightReference& reference);
  void AddTurn(FlightReference& reference) const;
  bool SettledAt(const Eigen::Vector3d& position_m) const;
  bool TurnSettled() const;
  void Record() const;

  const Scene& scene;
  const Config config;
  const std::uint64_t seed;
  const std::uint32_t scenario;
  const Airframe airframe;
  const FlightEnvelope envelope;
  FlightWorld world;
  Rotors rotors;
  FlightController controller;
  const LidarBundle lidars;
  const int scan_every;
  const int trace_every;
  TraceSink* trace = nullptr;

  Pose pose;
  std::int64_t physics_steps = 0;
  std::int64_t scans = 0;

  // Of the command in flight.
  std::uint32_t timestep = 0;
  std::int64_t steps = 0;
  double path_m = 0.0;
  RigidBodyState state;
  Eigen::Vector3d anchor_m = Eigen::Vector3d::Zero();  // where the reference rests between legs
  Profile turn;
  double turn_sign = 1.0;
  std::optional<Wind> wind;
};

// Clamps towards the box, but never pushes a robot that stands in the margin further than it asked to go.
Eigen::Vector3d Flight::Impl::Target(const Eigen::Vector3d& displacement_m) const {
  const Eigen::Vector3d low = pose.position_m.cwiseMin(Eigen::Vector3d(kBoxMarginM, kBoxMarginM, 0.0));
  const Eigen::Vector3d high =
      pose.position_m.cwiseMax(scene.SizeM() - Eigen::Vector3d::Constant(kBoxMarginM));
  return (pose.position_m + displacement_m).cwiseMax(low).cwiseMin(high);
}

// From the hover between commands to controlled flight.
void Flight::Impl::TakeOver(std::uint32_t the_timestep, double turn_rad) {
  timestep = the_timestep;
  steps = 0;
  path_m = 0.0;
  wind.emplace(config.environment, seed, scenario, timestep);
  const FlightController::Hover hover =
      controller.StartHover(airframe.DragN(-wind->VelocityMps()), pose.yaw_rad);
  rotors.Settle(hover.wrench);
  state = {.position_m = pose.position_m, .attitude = hover.attitude};
  world.SetState(state);
  state = world.State();
  anchor_m = pose.position_m;
  turn_sign = turn_rad < 0.0 ? -1.0 : 1.0;
  turn = Profile(std::abs(turn_rad) > kNothingRad ? std::abs(turn_rad) : 0.0, envelope.yaw);
  Record();
}

void Flight::Impl::AddTurn(FlightReference& reference) const {
  const ProfilePoint point = turn.At(steps * kStepS);
  reference.yaw_rad = pose.yaw_rad + turn_sign * point.position;
  reference.yaw_rate_radps = turn_sign * point.speed;
  reference.yaw_acceleration_radps2 = turn_sign * point.acceleration;
}

void Flight::Impl::StepPhysics(const FlightReference& reference) {
  const Wrench wrench = rotors.Step(controller.Step(state, reference));
  wind->Step();
  const Eigen::Vector3d lift_n = state.attitude * Eigen::Vector3d(0.0, 0.0, wrench.thrust_n);
  world.Step(lift_n + airframe.DragN(state.velocity_mps - wind->VelocityMps()), wrench.torque_nm);
  state = world.State();
  ++steps;
  ++physics_steps;
  path_m += kStepS * state.velocity_mps.norm();
  if (steps % trace_every == 0) Record();
}

void Flight::Impl::Record() const {
  if (trace == nullptr) return;
  trace->Record({timestep, steps * kStepS, state.position_m, state.velocity_mps, YawOf(state.attitude)});
}

bool Flight::Impl::SettledAt(const Eigen::Vector3d& position_m) const {
  const double gust_mps = config.environment.gust_mps;
  return (state.position_m - position_m).norm() < kSettledM + kSettledGustS * gust_mps &&
         state.velocity_mps.norm() < kSettledMps + kSettledMpsPerGust * gust_mps;
}

bool Flight::Impl::TurnSettled() const {
  if (steps * kStepS < turn.DurationS()) return false;
  const double wanted_rad = pose.yaw_rad + turn_sign * turn.Length();
  const double error_rad = std::remainder(YawOf(state.attitude) - wanted_rad, 2.0 * std::numbers::pi);
  return std::abs(error_rad) < kSettledRad && std::abs(state.rate_radps.z()) < kSettledRadps;
}

Flight::Impl::LegResult Flight::Impl::FlyLeg(const Eigen::Vector3d& direction, double length_m,
                                             const MotionLimits& limits, double stand_off_m) {
  if (length_m < kNothingM) return {};
  std::optional<LegWatch> watch;
  if (config.agents.obstacle_avoidance) {
    watch.emplace(lidars, LegWatch::Rule{stand_off_m, 0.5 * TubeMarginM(config.environment)}, anchor_m,
                  direction);
    ++scans;
    if (watch->RestLimitM() < std::min(length_m, kLeastHopM)) return {.halted = true};
  }

  Profile profile(length_m, limits);
  LegResult result;
  for (int step = 0;; ++step) {
    const double time_s = step * kStepS;
    if (watch && !result.halted) {
      const ProfilePoint front = profile.FrontAt(time_s);
      const double stop_m = front.position + profile.BrakingDistance(front) + front.speed * kStepS;
      if (step % scan_every == 0)
        watch->Tick(state.position_m, std::min(length_m, stop_m + front.speed * scan_every * kStepS));
      if (watch->RestLimitM() < std::min(length_m, stop_m)) {
        profile.BrakeAt(time_s);
        result.halted = true;
      }
    }
    const ProfilePoint now = profile.At(time_s);
    const bool arrived = time_s >= profile.DurationS();
    const Eigen::Vector3d end_m = anchor_m + profile.Length() * direction;
    const bool late = time_s >= profile.DurationS() + kSettleLimitS;
    if ((arrived && SettledAt(end_m)) || late) {
      result.seconds = time_s;
      result.displacement_m = (state.position_m - anchor_m).dot(direction);
      anchor_m = late ? state.position_m : end_m;
      return result;
    }
    FlightReference reference{.position_m = anchor_m + now.position * direction,
                              .velocity_mps = now.speed * direction,
                              .acceleration_mps2 = now.acceleration * direction,
                              .jerk_mps3 = now.jerk * direction,
                              .snap_mps4 = now.snap * direction};
    AddTurn(reference);
    StepPhysics(reference);
  }
}

double Flight::Impl::FinishTurn() {
  if (turn.Length() == 0.0) return 0.0;
  const double limit_s = std::max(turn.DurationS(), steps * kStepS) + kSettleLimitS;
  const std::int64_t first = steps;
  while (!TurnSettled() && steps * kStepS < limit_s) {
    FlightReference reference{.position_m = anchor_m};
    AddTurn(reference);
    StepPhysics(reference);
  }
  return static_cast<double>(steps - first) * kStepS;
}

FlownMove Flight::Impl::Execute(const MotionCommand& command, std::uint32_t the_timestep) {
  FlownMove move;
  move.end = pose;
  if (command.hover) return move;
  ED3R_CHECK(command.displacement_m.allFinite() && std::isfinite(command.turn_rad), "command is not finite");

  const Eigen::Vector3d way_m = Target(command.displacement_m) - pose.position_m;
  const int contacts_before = world.ContactSteps();
  TakeOver(the_timestep, command.turn_rad);
  LegResult across, upright;
  const auto fly_across = [&] {
    const Eigen::Vector3d flat_m(way_m.x(), way_m.y(), 0.0);
    across =
        FlyLeg(flat_m.normalized(), flat_m.norm(), envelope.horizontal, HorizontalStandOffM(config.robot));
  };
  const auto fly_upright = [&] {
    const Eigen::Vector3d direction(0.0, 0.0, way_m.z() < 0.0 ? -1.0 : 1.0);
    upright = FlyLeg(direction, std::abs(way_m.z()), envelope.vertical, VerticalStandOffM(config.robot));
  };
  const bool vertical_first = config.energy.move_order == MoveOrder::kVerticalFirst;
  if (vertical_first) fly_upright();
  fly_across();
  if (!vertical_first) fly_upright();
  double excess_s = FinishTurn();
  if (steps % trace_every != 0) Record();

  if (config.energy.move_time == MoveTime::kNominal) {
    across.seconds = std::abs(across.displacement_m) / config.robot.speed_mps;
    upright.seconds = std::abs(upright.displacement_m) / config.robot.speed_mps;
    excess_s = std::max(0.0, turn.Length() / envelope.yaw.speed_mps - across.seconds - upright.seconds);
  }
  if (steps > 0) {
    pose.position_m = state.position_m;
    pose.yaw_rad = YawOf(state.attitude);
  }
  pose.tilt_rad = command.tilt_rad;
  move.end = pose;
  move.horizontal_s = across.seconds;
  (way_m.z() < 0.0 ? move.descent_s : move.ascent_s) = upright.seconds;
  move.hovering_s = excess_s;
  move.distance_m = path_m;
  move.halted = across.halted || upright.halted;
  move.contact_steps = world.ContactSteps() - contacts_before;
  return move;
}

Flight::Flight(const Scene& scene, const Config& config, const Pose& start, std::uint64_t seed,
               std::uint32_t scenario)
    : impl_(std::make_unique<Impl>(scene, config, start, seed, scenario)) {}

Flight::~Flight() = default;

FlownMove Flight::Execute(const MotionCommand& command, std::uint32_t timestep) {
  return impl_->Execute(command, timestep);
}

const Pose& Flight::CurrentPose() const { return impl_->pose; }

void Flight::SetTrace(TraceSink* sink) { impl_->trace = sink; }

std::int64_t Flight::PhysicsSteps() const { return impl_->physics_steps; }

std::int64_t Flight::LidarScans() const { return impl_->scans; }

}  // namespace ed3r
