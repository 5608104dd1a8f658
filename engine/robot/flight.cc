#include "engine/robot/flight.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "engine/core/check.h"
#include "engine/core/phase.h"
#include "engine/robot/airframe.h"
#include "engine/robot/controller.h"
#include "engine/robot/lidar.h"
#include "engine/robot/rotors.h"
#include "engine/robot/trajectory.h"
#include "engine/robot/wind.h"
#include "engine/world/flight_world.h"

namespace ed3r::robot {
namespace {

constexpr double kNothingM = 1e-3;    // a shorter leg is not flown
constexpr double kNothingRad = 1e-3;  // likewise a turn
constexpr double kLeastHopM = 0.1;    // a leg with less room is not begun
constexpr double kSettledM = 0.05;    // plus this many seconds of gust:
constexpr double kSettledGustS = 0.03;
constexpr double kSettledMps = 0.10;
constexpr double kSettledMpsPerGust = 0.10;
constexpr double kSettledRad = std::numbers::pi / 180.0;
constexpr double kSettledRadps = 0.1;

Airframe FlyableAirframe(const Config& config) {
  const std::string problem = CheckFlyable(config);
  if (!problem.empty()) throw UserError(problem);
  return Airframe(config);
}

// Steps from one beat of `rate_hz` to the next.
int StepsPer(double rate_hz, double step_s) {
  return std::max(1, static_cast<int>(std::lround(1.0 / (rate_hz * step_s))));
}

// Where along the leg the robot would rest if it braked one step after a time.
double RestPoint(const Profile& profile, double time_s, double step_s) {
  const ProfilePoint front = profile.FrontAt(time_s);
  return front.position + profile.BrakingDistance(front) + front.speed * step_s;
}

}  // namespace

struct Flight::Impl {
  Impl(const world::Scene& the_scene, const Config& the_config, const Pose& start, std::uint64_t the_seed,
       std::uint32_t the_scenario)
      : scene(the_scene),
        config(the_config),
        seed(the_seed),
        scenario(the_scenario),
        step_s(1.0 / config.mission.physics_hz),
        airframe(FlyableAirframe(config)),
        envelope(EnvelopeOf(airframe, config)),
        world(scene.Geometry(), {airframe.mass_kg, airframe.size_m, airframe.inertia_kgm2},
              airframe.gravity_mps2, step_s),
        rotors(airframe, step_s),
        controller(airframe, envelope.tilt_max_rad, step_s),
        lidars(scene.Geometry(), airframe.BoundingRadiusM() + TubeMarginM(config.environment),
               config.sensing.lidar_range_m),
        scan_every(StepsPer(config.sensing.lidar_rate_hz, step_s)),
        trace_every(StepsPer(kTraceHz, step_s)),
        pose(start) {}

  struct Leg {
    Eigen::Vector3d direction;
    double length_m;
    MotionLimits limits;
    double stand_off_m;
  };
  struct LegResult {
    double seconds = 0.0;
    double displacement_m = 0.0;  // along the leg
    bool halted = false;
  };

  FlownMove Execute(const MotionCommand& command, std::uint32_t the_timestep);
  Eigen::Vector3d Target(const Eigen::Vector3d& displacement_m) const;
  void TakeOver(std::uint32_t the_timestep, double turn_rad);
  bool MustBrake(LegWatch& watch, const Profile& profile, int step) const;
  LegResult FlyLeg(const Leg& leg);
  double FinishTurn();
  void Bill(const LegResult& across, const LegResult& up_or_down, bool down, double excess_s,
            FlownMove& move) const;
  void StepPhysics(const FlightReference& reference);
  FlightReference ReferenceAt(const Eigen::Vector3d& start_m, const Eigen::Vector3d& direction,
                              const ProfilePoint& along) const;
  bool SettledAt(const Eigen::Vector3d& position_m) const;
  bool TurnSettled() const;
  void Record() const;

  const world::Scene& scene;
  const Config config;
  const std::uint64_t seed;
  const std::uint32_t scenario;
  const double step_s;
  const Airframe airframe;
  const FlightEnvelope envelope;
  world::FlightWorld world;
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
  world::RigidBodyState state;
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
  wind.emplace(config.environment, seed, scenario, timestep, step_s);
  const FlightController::Hover hover = controller.StartHover(wind->VelocityMps(), pose.yaw_rad);
  rotors.Settle(hover.wrench);
  state = {.position_m = pose.position_m, .attitude = hover.attitude};
  world.SetState(state);
  state = world.State();
  anchor_m = pose.position_m;
  turn_sign = turn_rad < 0.0 ? -1.0 : 1.0;
  turn = Profile(std::abs(turn_rad) > kNothingRad ? std::abs(turn_rad) : 0.0, envelope.yaw);
  Record();
}

FlightReference Flight::Impl::ReferenceAt(const Eigen::Vector3d& start_m, const Eigen::Vector3d& direction,
                                          const ProfilePoint& along) const {
  const ProfilePoint heading = turn.At(steps * step_s);
  return {.position_m = start_m + along.position * direction,
          .velocity_mps = along.speed * direction,
          .acceleration_mps2 = along.acceleration * direction,
          .jerk_mps3 = along.jerk * direction,
          .snap_mps4 = along.snap * direction,
          .yaw_rad = pose.yaw_rad + turn_sign * heading.position,
          .yaw_rate_radps = turn_sign * heading.speed,
          .yaw_acceleration_radps2 = turn_sign * heading.acceleration};
}

void Flight::Impl::StepPhysics(const FlightReference& reference) {
  const Wrench wrench = rotors.Step(controller.Step(state, reference));
  wind->Step();
  const Eigen::Vector3d lift_n = state.attitude * Eigen::Vector3d(0.0, 0.0, wrench.thrust_n);
  const Eigen::Vector3d force_n = lift_n + airframe.DragN(state.velocity_mps - wind->VelocityMps());
  {
    const InPhase physics(Phase::kPhysics);
    world.Step(force_n, wrench.torque_nm);
    state = world.State();
  }
  ++steps;
  ++physics_steps;
  path_m += step_s * state.velocity_mps.norm();
  if (steps % trace_every == 0) Record();
}

void Flight::Impl::Record() const {
  if (trace == nullptr) return;
  trace->Record({timestep, steps * step_s, state.position_m, state.velocity_mps, YawOf(state.attitude)});
}

bool Flight::Impl::SettledAt(const Eigen::Vector3d& position_m) const {
  const double gust_mps = config.environment.gust_mps;
  return (state.position_m - position_m).norm() < kSettledM + kSettledGustS * gust_mps &&
         state.velocity_mps.norm() < kSettledMps + kSettledMpsPerGust * gust_mps;
}

bool Flight::Impl::TurnSettled() const {
  if (steps * step_s < turn.DurationS()) return false;
  const double wanted_rad = pose.yaw_rad + turn_sign * turn.Length();
  const double error_rad = std::remainder(YawOf(state.attitude) - wanted_rad, 2.0 * std::numbers::pi);
  return std::abs(error_rad) < kSettledRad && std::abs(state.rate_radps.z()) < kSettledRadps;
}

// The safety rule at one step of a leg: looks when the LiDARs do, and compares. Most legs end within what was seen: where the
// robot would rest is asked only where it matters.
bool Flight::Impl::MustBrake(LegWatch& watch, const Profile& profile, int step) const {
  if (step % scan_every == 0) {
    double wanted_m = profile.Length();
    if (watch.OutOfSight(wanted_m))
      wanted_m = std::min(wanted_m, RestPoint(profile, (step + scan_every) * step_s, step_s));
    watch.Tick(state.position_m, wanted_m);
  }
  return watch.RestLimitM() < profile.Length() &&
         watch.RestLimitM() < RestPoint(profile, step * step_s, step_s);
}

Flight::Impl::LegResult Flight::Impl::FlyLeg(const Leg& leg) {
  if (leg.length_m < kNothingM) return {};
  std::optional<LegWatch> watch;
  if (config.agents.obstacle_avoidance) {
    watch.emplace(lidars, LegWatch::Rule{leg.stand_off_m, 0.5 * TubeMarginM(config.environment)}, anchor_m,
                  leg.direction);
    if (watch->RestLimitM() < std::min(leg.length_m, kLeastHopM)) {
      scans += watch->Scans();
      return {.halted = true};
    }
  }

  LegResult result;
  const Eigen::Vector3d start_m = anchor_m;
  Profile profile(leg.length_m, leg.limits);
  for (int step = 0;; ++step) {
    const double time_s = step * step_s;
    const bool under_way = time_s < profile.DurationS();
    if (watch && under_way && !result.halted && MustBrake(*watch, profile, step)) {
      profile.BrakeAt(time_s);
      result.halted = true;
    }
    anchor_m = start_m + profile.Length() * leg.direction;
    const bool late = time_s >= profile.DurationS() + kSettleLimitS;
    if (late) anchor_m = state.position_m;
    if (late || (time_s >= profile.DurationS() && SettledAt(anchor_m))) {
      result.seconds = time_s;
      break;
    }
    ProfilePoint along = profile.At(time_s);
    along.snap = profile.SnapAt(time_s + kRotorLagS);
    StepPhysics(ReferenceAt(start_m, leg.direction, along));
  }
  result.displacement_m = std::abs((state.position_m - start_m).dot(leg.direction));
  if (watch) scans += watch->Scans();
  return result;
}

double Flight::Impl::FinishTurn() {
  if (turn.Length() == 0.0) return 0.0;
  const std::int64_t first = steps;
  const double limit_s = std::max(turn.DurationS(), steps * step_s) + kSettleLimitS;
  while (!TurnSettled() && steps * step_s < limit_s)
    StepPhysics(ReferenceAt(anchor_m, Eigen::Vector3d::Zero(), {}));
  return static_cast<double>(steps - first) * step_s;
}

FlownMove Flight::Impl::Execute(const MotionCommand& command, std::uint32_t the_timestep) {
  FlownMove move;
  move.end = pose;
  if (command.hover) return move;
  const InPhase control(Phase::kControl);
  ED3R_CHECK(command.displacement_m.allFinite() && std::isfinite(command.turn_rad), "command is not finite");

  const Eigen::Vector3d way_m = Target(command.displacement_m) - pose.position_m;
  const Eigen::Vector3d flat_m(way_m.x(), way_m.y(), 0.0);
  const Leg flat = {flat_m.normalized(), flat_m.norm(), envelope.horizontal,
                    HorizontalStandOffM(config.robot)};
  const Leg upright = {Eigen::Vector3d(0.0, 0.0, way_m.z() < 0.0 ? -1.0 : 1.0), std::abs(way_m.z()),
                       envelope.vertical, VerticalStandOffM(config.robot)};
  const bool vertical_first = config.energy.move_order == MoveOrder::kVerticalFirst;
  const int contacts_before = world.ContactSteps();

  TakeOver(the_timestep, command.turn_rad);
  const LegResult first = FlyLeg(vertical_first ? upright : flat);
  const LegResult second = FlyLeg(vertical_first ? flat : upright);
  const double excess_s = FinishTurn();
  if (steps % trace_every != 0) Record();

  const LegResult& across = vertical_first ? second : first;
  const LegResult& up_or_down = vertical_first ? first : second;
  Bill(across, up_or_down, way_m.z() < 0.0, excess_s, move);
  if (steps > 0) {
    pose.position_m = state.position_m;
    pose.yaw_rad = YawOf(state.attitude);
  }
  pose.tilt_rad = command.tilt_rad;
  move.end = pose;
  move.distance_m = path_m;
  move.course = flat.direction.head<2>();
  move.halted = across.halted || up_or_down.halted;
  move.contact_steps = world.ContactSteps() - contacts_before;
  return move;
}

// Times by movement type (Eq. 2): as flown, or as distance / speed (energy.move_time, R4).
void Flight::Impl::Bill(const LegResult& across, const LegResult& up_or_down, bool down, double excess_s,
                        FlownMove& move) const {
  double across_s = across.seconds;
  double upright_s = up_or_down.seconds;
  if (config.energy.move_time == MoveTime::kNominal) {
    across_s = across.displacement_m / config.robot.speed_mps;
    upright_s = up_or_down.displacement_m / config.robot.speed_mps;
    excess_s = std::max(0.0, turn.Length() / envelope.yaw.speed_mps - across_s - upright_s);
  }
  move.horizontal_s = across_s;
  (down ? move.descent_s : move.ascent_s) = upright_s;
  move.hovering_s = excess_s;
}

Flight::Flight(const world::Scene& scene, const Config& config, const Pose& start, std::uint64_t seed,
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

}  // namespace ed3r::robot
