#include "engine/mission/mission.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/agents/remote_controller.h"
#include "engine/agents/reward.h"
#include "engine/agents/robot_agent.h"
#include "engine/core/check.h"
#include "engine/core/interrupt.h"
#include "engine/mission/accounts.h"
#include "engine/mission/invariants.h"
#include "engine/mission/scenario.h"
#include "engine/perception/pixels/pixel_sensor.h"
#include "engine/perception/sensor.h"
#include "engine/radio/link.h"
#include "engine/robot/ledger.h"

namespace ed3r {
namespace {

// What stage 2 needs to know once the robot has arrived.
struct Arrival {
  Conditions conditions;
  double rc_distance_m = 0.0;
  Link link;
};

AgentContext AgentsOf(const MissionTask& task, const Strategy& strategy) {
  return {task.config,
          strategy,
          task.networks,
          task.scene.SizeM(),
          task.seed,
          task.scenario,
          EpsilonOfMission(task.config.agents, strategy, task.mission)};
}

std::unique_ptr<Sensor> SensorOf(const MissionTask& task, const Scenario& scenario) {
  const SensorScenario seen{scenario.site, task.seed, task.scenario};
  if (task.config.perception.tier == PerceptionTier::kProfile)
    return MakeProfileSensor(task.scene, task.config, seen);
  ED3R_CHECK(task.pixels != nullptr, "the pixel tier needs its detectors");
  return MakePixelSensor(*task.pixels, task.config, seen);
}

class Mission {
 public:
  explicit Mission(const MissionTask& task)
      : task_(task),
        config_(task.config),
        scenario_(DealScenario(task.scene, task.config.mission, task.seed, task.scenario)),
        strategy_(FindStrategy(task.config.mission.strategy)),
        antenna_m_(task.scene.BaseStations()[static_cast<std::size_t>(scenario_.base_station)].antenna_m),
        power_(MovementPowerOf(config_.robot, config_.environment, config_.energy)),
        flight_(task.scene, config_, scenario_.start, task.seed, task.scenario),
        controller_(AgentsOf(task, strategy_)),
        robot_(AgentsOf(task, strategy_)),
        sensor_(SensorOf(task, scenario_)),
        battery_j_(config_.robot.BatteryJ()) {
    flight_.SetTrace(task.trace);
  }

  MissionRecord Fly();

 private:
  RcView ControllerView() const;
  Arrival Arrive(std::uint32_t k) const;
  RobotView OnboardView(const Arrival& arrival) const;
  void Detect(const ExecutionDecision& execution, TimestepRecord& step) const;
  StepTime TimeOf(const FlownMove& move, const Arrival& arrival, Execution execution) const;
  DeviceEnergy DevicesOf(const Arrival& arrival, Execution execution) const;
  ComputationCost OnboardCost(Execution execution, double cpu_hz) const;
  CandidateTrace* CandidatesAt(std::uint32_t k) const;
  void Probe(std::uint32_t k, const RcView& rc_view, const MotionDecision& motion,
             const RobotView& robot_view, const ExecutionDecision& execution);
  MissionRecord Close(Outcome outcome);
  Outcome OutcomeOfCompletion() const;

  const MissionTask& task_;
  const Config& config_;
  const Scenario scenario_;
  const Strategy& strategy_;
  const Eigen::Vector3d antenna_m_;
  const MovementPower power_;
  Flight flight_;
  RemoteController controller_;
  RobotAgent robot_;
  const std::unique_ptr<Sensor> sensor_;
  double battery_j_;  // beta_k
  double distance_m_ = 0.0;
  std::uint32_t view_begin_ = 1;  // the timestep in which the robot came to where it is
  std::vector<TimestepRecord> steps_;
};

MissionRecord Mission::Fly() {
  for (std::uint32_t k = 1;; ++k) {
    if (task_.stop != nullptr && task_.stop->load(std::memory_order_relaxed)) throw Interrupted();
    if (k > static_cast<std::uint32_t>(config_.mission.max_timesteps))
      throw BrokenInvariant(Invariant::kMissionEnds, fmt::format("the mission does not end: timestep {}", k));

    const RcView rc_view = ControllerView();
    const MotionDecision motion =
        controller_.ChooseMotion(rc_view, k, CandidatesAt(k));  // stage 1, at the RC
    if (motion.complete) return Close(OutcomeOfCompletion());
    const FlownMove move = flight_.Execute(motion.command, k);
    if (!motion.command.hover) view_begin_ = k;

    const Arrival arrival = Arrive(k);
    const RobotView robot_view = OnboardView(arrival);
    const ExecutionDecision execution =
        robot_.ChooseExecution(robot_view, motion.epsilon, k);  // stage 2, on board
    Probe(k, rc_view, motion, robot_view, execution);

    TimestepRecord step = OpenStep(k, motion, move, execution);
    RecordLink(arrival.conditions, arrival.rc_distance_m, arrival.link, step);
    Detect(execution, step);
    const StepTime time = TimeOf(move, arrival, execution.execution);
    const StepEnergy energy = Charge(power_, time, DevicesOf(arrival, execution.execution));
    if (energy.TotalJ() > battery_j_) return Close(Outcome::kBatteryDepleted);  // Eq. 14; R8

    step.reward = Reward(config_.agents, energy.TotalJ(), step.scs, battery_j_);
    battery_j_ -= energy.TotalJ();
    distance_m_ += move.distance_m;
    RecordLedger(time, energy, battery_j_, step);
    steps_.push_back(step);
  }
}

RcView Mission::ControllerView() const {
  RcView view;
  view.pose = flight_.CurrentPose();
  view.rc_distance_m = (view.pose.position_m - antenna_m_).norm();
  if (!steps_.empty()) {
    view.previous_scs = steps_.back().scs;
    view.previous_energy_j = steps_.back().total_j;
  }
  return view;
}

Arrival Mission::Arrive(std::uint32_t k) const {
  Arrival arrival;
  arrival.conditions = DrawConditions(config_, task_.seed, task_.scenario, k);
  arrival.rc_distance_m = (flight_.CurrentPose().position_m - antenna_m_).norm();
  arrival.link = EvaluateLink(config_.radio, arrival.rc_distance_m, arrival.conditions.bandwidth_hz,
                              arrival.conditions.shadowing_db);
  return arrival;
}

RobotView Mission::OnboardView(const Arrival& arrival) const {
  const RcView before = ControllerView();
  RobotView view;
  view.yaw_rad = before.pose.yaw_rad;
  view.tilt_rad = before.pose.tilt_rad;
  view.battery_ratio = battery_j_ / config_.robot.BatteryJ();                 // Eq. 19
  view.cpu_ratio = arrival.conditions.cpu_hz / config_.cpu.frequency_max_hz;  // Eq. 20
  view.rc_distance_m = arrival.rc_distance_m;
  view.bandwidth_hz = arrival.conditions.bandwidth_hz;
  view.rate_bps = arrival.link.rate_bps;
  view.previous_scs = before.previous_scs;
  view.previous_energy_j = before.previous_energy_j;
  view.rate_ratio = arrival.link.rate_bps / LargestRateBps(config_.radio);
  return view;
}

void Mission::Detect(const ExecutionDecision& execution, TimestepRecord& step) const {
  // The RC runs the Full model only.
  const DetectionModel model =
      execution.execution == Execution::kQuantized ? DetectionModel::kQuantized : DetectionModel::kFull;
  const Detection seen =
      sensor_->Sense(flight_.CurrentPose(), model, static_cast<std::uint32_t>(step.k), view_begin_);
  step.confidence_mean = seen.score.mean;
  step.confidence_sd = seen.score.standard_deviation;
  step.scs = seen.score.scs;
  step.fire_only_scs = seen.fire_only_scs;
  step.fire_share = seen.fire_share;
  step.smoke_share = seen.smoke_share;
  step.fire_in_view = seen.fire_in_view ? 1 : 0;
}

ComputationCost Mission::OnboardCost(Execution execution, double cpu_hz) const {
  if (execution == Execution::kOffload) return {};
  const double gflop = execution == Execution::kFull ? config_.cpu.full_gflop : config_.cpu.quantized_gflop;
  return Computation(config_.cpu, config_.sensing, gflop, cpu_hz);
}

StepTime Mission::TimeOf(const FlownMove& move, const Arrival& arrival, Execution execution) const {
  StepTime time;
  time.horizontal_s = move.horizontal_s;
  time.ascent_s = move.ascent_s;
  time.descent_s = move.descent_s;
  time.turning_s = move.hovering_s;
  time.sensing_s = config_.sensing.period_s;
  time.computing_s = OnboardCost(execution, arrival.conditions.cpu_hz).time_s;
  if (execution == Execution::kOffload)
    time.transmitting_s = TransmissionTimeS(PayloadByte(config_.sensing), arrival.link);
  return time;
}

DeviceEnergy Mission::DevicesOf(const Arrival& arrival, Execution execution) const {
  DeviceEnergy devices;
  devices.sensing_j = SensingEnergyJ(config_.sensing);
  devices.computation_j = OnboardCost(execution, arrival.conditions.cpu_hz).energy_j;
  if (execution == Execution::kOffload)
    devices.transmission_j = TransmissionEnergyJ(PayloadByte(config_.sensing), arrival.link);
  return devices;
}

CandidateTrace* Mission::CandidatesAt(std::uint32_t k) const {
  return task_.probe != nullptr && task_.probe->timestep == k ? &task_.probe->candidates : nullptr;
}

void Mission::Probe(std::uint32_t k, const RcView& rc_view, const MotionDecision& motion,
                    const RobotView& robot_view, const ExecutionDecision& execution) {
  if (task_.probe == nullptr || task_.probe->timestep != k) return;
  task_.probe->reached = true;
  task_.probe->rc_view = rc_view;
  task_.probe->motion = motion;
  task_.probe->robot_view = robot_view;
  task_.probe->execution = execution;
  task_.probe->robot_rewards = robot_.PredictAll(robot_view);
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

MissionRecord Mission::Close(Outcome outcome) {
  MissionRecord record;
  record.scenario = scenario_.number;
  record.network = task_.network_seed;
  record.site = scenario_.site;
  record.base_station = scenario_.base_station;
  record.site_known = task_.scene.Sites()[static_cast<std::size_t>(scenario_.site)].known;
  record.base_station_known =
      task_.scene.BaseStations()[static_cast<std::size_t>(scenario_.base_station)].known;
  record.outcome = static_cast<std::int64_t>(outcome);
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
                           .gust_mps = config_.environment.gust_mps});
  return record;
}

}  // namespace

MissionRecord FlyMission(const MissionTask& task) { return Mission(task).Fly(); }

}  // namespace ed3r
