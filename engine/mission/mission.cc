#include "engine/mission/mission.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/agents/remote_controller.h"
#include "engine/agents/reward.h"
#include "engine/agents/robot_agent.h"
#include "engine/core/check.h"
#include "engine/core/interrupt.h"
#include "engine/core/phase.h"
#include "engine/mission/accounts.h"
#include "engine/mission/invariants.h"
#include "engine/mission/scenario.h"
#include "engine/perception/pixels/pixel_sensor.h"
#include "engine/perception/sensor.h"
#include "engine/radio/link.h"
#include "engine/robot/ledger.h"

namespace ed3r::mission {
namespace {

// Room for the timesteps of all but one mission in a thousand, so that flying on allocates nothing.
constexpr std::size_t kUsualTimesteps = 96;

std::unique_ptr<perception::Sensor> SensorOf(const MissionTask& task, const Scenario& scenario) {
  const perception::SensorScenario seen{scenario.site, task.seed, task.scenario};
  if (task.config.perception.tier == PerceptionTier::kProfile)
    return perception::MakeProfileSensor(task.scene, task.config, seen);
  ED3R_CHECK(task.pixels != nullptr, "the pixel tier needs its detectors");
  return perception::MakePixelSensor(*task.pixels, task.config, seen);
}

agents::CandidateTrace* CandidatesAt(const MissionTask& task, std::uint32_t k) {
  return task.probe != nullptr && task.probe->timestep == k ? &task.probe->candidates : nullptr;
}

void Probe(const MissionTask& task, std::uint32_t k, const agents::RcView& rc_view,
           const agents::MotionDecision& motion, const agents::RobotView& robot_view,
           const agents::ExecutionDecision& execution, agents::RobotAgent& robot) {
  if (task.probe == nullptr || task.probe->timestep != k) return;
  task.probe->reached = true;
  task.probe->rc_view = rc_view;
  task.probe->motion = motion;
  task.probe->robot_view = robot_view;
  task.probe->execution = execution;
  task.probe->robot_rewards = robot.PredictAll(robot_view);
}

}  // namespace

MissionRecord FlyMission(const MissionTask& task) {
  Mission mission(task);
  agents::RemoteController controller(mission.Agents());
  agents::RobotAgent robot(mission.Agents());
  while (!mission.Ended()) {
    const std::uint32_t k = mission.Timestep();
    if (task.stop != nullptr && task.stop->load(std::memory_order_relaxed)) throw Interrupted();
    if (k > static_cast<std::uint32_t>(task.config.mission.max_timesteps))
      throw BrokenInvariant(Invariant::kMissionEnds, fmt::format("the mission does not end: timestep {}", k));

    const agents::RcView rc_view = mission.ControllerView();
    const agents::MotionDecision motion =
        controller.ChooseMotion(rc_view, k, CandidatesAt(task, k));  // stage 1, at the RC
    if (motion.complete) {
      mission.Complete();
      break;
    }
    mission.Execute(motion);

    const agents::RobotView robot_view = mission.OnboardView();
    const agents::ExecutionDecision execution =
        robot.ChooseExecution(robot_view, motion.epsilon, k);  // stage 2, on board
    Probe(task, k, rc_view, motion, robot_view, execution, robot);
    mission.Detect(execution);
  }
  return mission.Record();
}

Mission::Mission(const MissionTask& task)
    : task_(task),
      config_(task.config),
      scenario_(DealScenario(task.scene, task.config.mission, task.seed, task.scenario)),
      antenna_m_(task.scene.BaseStations()[static_cast<std::size_t>(scenario_.base_station)].antenna_m),
      power_(robot::MovementPowerOf(config_.robot, config_.environment, config_.energy)),
      flight_(task.scene, config_, scenario_.start, task.seed, task.scenario),
      sensor_(SensorOf(task, scenario_)),
      battery_j_(config_.robot.BatteryJ()) {
  flight_.SetTrace(task.trace);
  steps_.reserve(kUsualTimesteps);
}

agents::AgentContext Mission::Agents() const {
  return {config_,
          agents::FindStrategy(config_.mission.strategy),
          task_.networks,
          task_.scene.SizeM(),
          task_.seed,
          task_.scenario,
          agents::EpsilonOfMission(config_.agents, task_.mission)};
}

void Mission::Execute(const agents::MotionDecision& motion) {
  ED3R_CHECK(!Ended() && stage_ == Stage::kMotion, "a motion in place of a detection");
  motion_ = motion;
  move_ = flight_.Execute(motion.command, k_);
  if (!motion.command.hover) view_begin_ = k_;
  arrival_.conditions = DrawConditions(config_, task_.seed, task_.scenario, k_);
  arrival_.rc_distance_m = (flight_.CurrentPose().position_m - antenna_m_).norm();
  arrival_.link = radio::EvaluateLink(config_.radio, arrival_.rc_distance_m, arrival_.conditions.bandwidth_hz,
                                      arrival_.conditions.shadowing_db);
  stage_ = Stage::kExecution;
}

void Mission::Complete() {
  ED3R_CHECK(!Ended() && stage_ == Stage::kMotion, "a mission is completed by the RC");
  outcome_ = OutcomeOfCompletion();
}

void Mission::Detect(const agents::ExecutionDecision& execution) {
  ED3R_CHECK(!Ended() && stage_ == Stage::kExecution, "a detection in place of a motion");
  last_ = OpenStep(k_, motion_, move_, execution);
  RecordLink(arrival_.conditions, arrival_.rc_distance_m, arrival_.link, last_);
  Sense(execution.execution);
  const robot::StepTime time = TimeOf(execution.execution);
  const robot::MovementPower power = PowerOfMove();
  const robot::StepEnergy energy = robot::Charge(power, time, DevicesOf(execution.execution));
  last_.reward = agents::Reward(config_.agents, energy.TotalJ(), last_.scs, battery_j_);
  if (energy.TotalJ() > battery_j_) {  // Eq. 14; R8
    RecordLedger(time, energy, battery_j_, last_);
    outcome_ = Outcome::kBatteryDepleted;
    return;
  }
  battery_j_ -= energy.TotalJ();
  distance_m_ += move_.distance_m;
  RecordLedger(time, energy, battery_j_, last_);
  steps_.push_back(last_);
  if (robot::BillsWind(config_.environment, config_.energy)) horizontal_w_.push_back(power.horizontal_w);
  ++k_;
  stage_ = Stage::kMotion;
}

agents::RcView Mission::ControllerView() const {
  agents::RcView view;
  view.pose = flight_.CurrentPose();
  view.rc_distance_m = (view.pose.position_m - antenna_m_).norm();
  if (!steps_.empty()) {
    view.previous_scs = steps_.back().scs;
    view.previous_energy_j = steps_.back().total_j;
  }
  return view;
}

agents::RobotView Mission::OnboardView() const {
  ED3R_CHECK(!Ended() && stage_ == Stage::kExecution, "the robot has not arrived");
  const agents::RcView before = ControllerView();
  agents::RobotView view;
  view.yaw_rad = before.pose.yaw_rad;
  view.tilt_rad = before.pose.tilt_rad;
  view.battery_ratio = battery_j_ / config_.robot.BatteryJ();                  // Eq. 19
  view.cpu_ratio = arrival_.conditions.cpu_hz / config_.cpu.frequency_max_hz;  // Eq. 20
  view.rc_distance_m = arrival_.rc_distance_m;
  view.bandwidth_hz = arrival_.conditions.bandwidth_hz;
  view.rate_bps = arrival_.link.rate_bps;
  view.previous_scs = before.previous_scs;
  view.previous_energy_j = before.previous_energy_j;
  view.rate_ratio = arrival_.link.rate_bps / radio::LargestRateBps(config_.radio);
  return view;
}

void Mission::Sense(agents::Execution execution) {
  // The RC runs the Full model only.
  const perception::DetectionModel model = execution == agents::Execution::kQuantized
                                               ? perception::DetectionModel::kQuantized
                                               : perception::DetectionModel::kFull;
  const InPhase perceiving(Phase::kPerception);
  const perception::Detection seen = sensor_->Sense(flight_.CurrentPose(), model, k_, view_begin_);
  last_.confidence_mean = seen.score.mean;
  last_.confidence_sd = seen.score.standard_deviation;
  last_.scs = seen.score.scs;
  last_.fire_only_scs = seen.fire_only_scs;
  last_.fire_share = seen.fire_share;
  last_.smoke_share = seen.smoke_share;
  last_.fire_in_view = seen.fire_in_view ? 1 : 0;
}

robot::ComputationCost Mission::OnboardCost(agents::Execution execution) const {
  if (execution == agents::Execution::kOffload) return {};
  const double gflop =
      execution == agents::Execution::kFull ? config_.cpu.full_gflop : config_.cpu.quantized_gflop;
  return robot::Computation(config_.cpu, config_.sensing, gflop, arrival_.conditions.cpu_hz);
}

robot::StepTime Mission::TimeOf(agents::Execution execution) const {
  robot::StepTime time;
  time.horizontal_s = move_.horizontal_s;
  time.ascent_s = move_.ascent_s;
  time.descent_s = move_.descent_s;
  time.turning_s = move_.hovering_s;
  time.sensing_s = config_.sensing.period_s;
  time.computing_s = OnboardCost(execution).time_s;
  if (execution == agents::Execution::kOffload)
    time.transmitting_s = radio::TransmissionTimeS(robot::PayloadByte(config_.sensing), arrival_.link);
  return time;
}

robot::DeviceEnergy Mission::DevicesOf(agents::Execution execution) const {
  robot::DeviceEnergy devices;
  devices.sensing_j = robot::SensingEnergyJ(config_.sensing);
  devices.computation_j = OnboardCost(execution).energy_j;
  if (execution == agents::Execution::kOffload)
    devices.transmission_j = radio::TransmissionEnergyJ(robot::PayloadByte(config_.sensing), arrival_.link);
  return devices;
}

// A completion is true when flame and smoke in view alone would have reached it (R16).
Outcome Mission::OutcomeOfCompletion() const {
  const auto patience = static_cast<std::size_t>(config_.agents.completion_patience);
  ED3R_CHECK(steps_.size() >= patience, "completed before the patience ran out");
  const bool real =
      std::all_of(steps_.end() - static_cast<std::ptrdiff_t>(patience), steps_.end(),
                  [&](const TimestepRecord& step) { return step.fire_only_scs >= config_.agents.eta_min; });
  return real ? Outcome::kSuccess : Outcome::kFalsePositive;
}

robot::MovementPower Mission::PowerOfMove() const {
  if (!robot::BillsWind(config_.environment, config_.energy)) return power_;
  return robot::MovementPowerOf(config_.robot, config_.environment, config_.energy, move_.course);
}

MissionRecord Mission::Record() {
  ED3R_CHECK(Ended(), "the mission has not ended");
  MissionRecord record;
  record.scenario = scenario_.number;
  record.network = task_.network_seed;
  record.site = scenario_.site;
  record.base_station = scenario_.base_station;
  record.site_known = task_.scene.Sites()[static_cast<std::size_t>(scenario_.site)].known;
  record.base_station_known =
      task_.scene.BaseStations()[static_cast<std::size_t>(scenario_.base_station)].known;
  record.outcome = static_cast<std::int64_t>(*outcome_);
  record.start_x_m = scenario_.start.position_m.x();
  record.start_y_m = scenario_.start.position_m.y();
  record.start_z_m = scenario_.start.position_m.z();
  record.start_yaw_rad = scenario_.start.yaw_rad;
  record.start_rc_distance_m = (scenario_.start.position_m - antenna_m_).norm();
  record.battery_left_j = battery_j_;
  record.steps = std::move(steps_);
  SumSteps(config_.agents.eta_min, record);
  record.distance_m = distance_m_;
  CheckInvariants(record, {.power = power_,
                           .battery_j = config_.robot.BatteryJ(),
                           .scene = task_.scene,
                           .gust_mps = config_.environment.gust_mps,
                           .horizontal_w = horizontal_w_});
  return record;
}

}  // namespace ed3r::mission
