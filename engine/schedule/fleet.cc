#include "engine/schedule/fleet.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <utility>

#include "engine/agents/features.h"
#include "engine/core/check.h"
#include "engine/mission/accounts.h"
#include "engine/schedule/parallel_for.h"
#include "engine/schedule/scheduler.h"

namespace ed3r::schedule {
namespace {

template <class Values>
void Show(const Values& values, std::size_t row, std::vector<float>& column) {
  std::transform(values.begin(), values.end(),
                 column.begin() + static_cast<std::ptrdiff_t>(row * values.size()),
                 [](double value) { return static_cast<float>(value); });
}

robot::MotionCommand CommandOf(std::span<const float> values) {
  return {.displacement_m = {values[0], values[1], values[2]}, .turn_rad = values[3], .tilt_rad = values[4]};
}

template <class Value>
void CopyValues(const std::vector<Value>& from, std::size_t from_row, std::vector<Value>& to,
                std::size_t to_row, std::size_t width = 1) {
  std::copy_n(from.begin() + static_cast<std::ptrdiff_t>(from_row * width), width,
              to.begin() + static_cast<std::ptrdiff_t>(to_row * width));
}

}  // namespace

FleetColumns::FleetColumns(std::size_t rows)
    : controller(rows * rfnn::kRcStates),
      robot(rows * rfnn::kRobotStates),
      ranges(rows * 3),
      hovers(rows),
      reward(rows),
      terminated(rows),
      truncated(rows),
      begun(rows),
      paid(rows),
      mission(rows, -1),
      timestep(rows),
      outcome(rows, -1),
      execution(rows, -1),
      scs(rows),
      duration_s(rows),
      movement_j(rows),
      sensing_j(rows),
      computation_j(rows),
      transmission_j(rows),
      total_j(rows),
      battery_j(rows) {}

void FleetColumns::CopyRow(const FleetColumns& other, std::size_t from, std::size_t to) {
  CopyValues(other.controller, from, controller, to, rfnn::kRcStates);
  CopyValues(other.robot, from, robot, to, rfnn::kRobotStates);
  CopyValues(other.ranges, from, ranges, to, 3);
  for (auto column : {&FleetColumns::hovers, &FleetColumns::terminated, &FleetColumns::truncated,
                      &FleetColumns::begun, &FleetColumns::paid})
    CopyValues(other.*column, from, this->*column, to);
  for (auto column :
       {&FleetColumns::mission, &FleetColumns::timestep, &FleetColumns::outcome, &FleetColumns::execution})
    CopyValues(other.*column, from, this->*column, to);
  for (auto column : {&FleetColumns::reward, &FleetColumns::scs, &FleetColumns::duration_s,
                      &FleetColumns::movement_j, &FleetColumns::sensing_j, &FleetColumns::computation_j,
                      &FleetColumns::transmission_j, &FleetColumns::total_j, &FleetColumns::battery_j})
    CopyValues(other.*column, from, this->*column, to);
}

Fleet::Fleet(std::size_t rows, TaskFn task, int threads, Autoreset autoreset)
    : rows_(rows),
      task_(std::move(task)),
      threads_(std::min(ThreadsFor(threads), static_cast<int>(std::max<std::size_t>(rows, 1)))),
      autoreset_(autoreset),
      now_(rows),
      final_(rows),
      nothing_(1),
      errors_(rows) {}

// Every row is stepped, whatever another throws; then the first error is thrown.
void Fleet::ForEachRow(const std::function<void(std::size_t)>& body) {
  ParallelFor(threads_, static_cast<std::int64_t>(rows_.size()), [&](std::int64_t i) {
    const auto row = static_cast<std::size_t>(i);
    try {
      body(row);
    } catch (...) {
      errors_[row] = std::current_exception();
    }
  });
  for (std::exception_ptr& error : errors_)
    if (error) {
      const std::exception_ptr first = std::exchange(error, nullptr);
      std::fill(errors_.begin(), errors_.end(), nullptr);
      std::rethrow_exception(first);
    }
}

void Fleet::Reset(std::span<const std::uint8_t> mask, std::span<const std::uint8_t> from_first) {
  ED3R_CHECK(mask.empty() || mask.size() == rows_.size(), "a mask of another size");
  ED3R_CHECK(from_first.empty() || from_first.size() == rows_.size(), "marks of another size");
  ForEachRow([&](std::size_t row) {
    if (!mask.empty() && mask[row] == 0) return;
    if (!from_first.empty() && from_first[row] != 0) rows_[row].next = 0;
    Begin(row);
  });
}

void Fleet::Retire() {
  for (Row& row : rows_) {
    row.mission.reset();
    row.task.reset();
  }
}

void Fleet::Begin(std::size_t row) {
  Row& r = rows_[row];
  r.mission.reset();  // before the task that it refers to
  r.task.reset();
  r.moved = r.over = r.recorded = false;
  now_.CopyRow(nothing_, 0, row);
  const std::optional<mission::MissionTask> task = task_(row, r.next);
  if (!task) return;
  ++r.next;
  r.task.emplace(*task);
  r.mission = std::make_unique<mission::MissionStepper>(*r.task);
  now_.mission[row] = r.task->mission;
  now_.battery_j[row] = r.task->config.robot.BatteryJ();
  ShowController(row);
}

void Fleet::ShowController(std::size_t row) {
  const mission::MissionStepper& mission = *rows_[row].mission;
  Show(agents::StateOf(mission.ControllerSees()), row, now_.controller);
  const agents::CompletionOrder& order = mission.Order();
  Show(std::array{order.ranges.axis_m, order.ranges.yaw_rad, order.ranges.tilt_rad}, row, now_.ranges);
  now_.hovers[row] = order.hover;
  now_.timestep[row] = mission.Timestep();
}

void Fleet::Move(std::span<const float> commands) {
  ED3R_CHECK(commands.size() == rows_.size() * kCommandValues, "commands of another size");
  for (std::size_t i = 0; i < commands.size(); ++i)
    if (!std::isfinite(commands[i]) && UnderWay(i / kCommandValues))
      throw UserError(fmt::format("commands[{}, {}]: {} is not allowed; allowed: finite numbers",
                                  i / kCommandValues, i % kCommandValues, commands[i]));
  ForEachRow([&](std::size_t row) {
    if (!UnderWay(row)) return;
    ED3R_CHECK(!rows_[row].moved, "moved twice");
    mission::MissionStepper& mission = *rows_[row].mission;
    mission.Move(CommandOf(commands.subspan(row * kCommandValues, kCommandValues)));
    rows_[row].moved = true;
    Show(agents::StateOf(mission.RobotSees()), row, now_.robot);
  });
}

void Fleet::Detect(std::span<const std::int64_t> executions) {
  ED3R_CHECK(executions.size() == rows_.size(), "executions of another size");
  for (std::size_t row = 0; row < rows_.size(); ++row)
    if (UnderWay(row) && (executions[row] < 0 || executions[row] >= std::int64_t{agents::kExecutions.size()}))
      throw UserError(
          fmt::format("executions[{}]: {} is not allowed; allowed: 0 offload | 1 full | 2 quantized", row,
                      executions[row]));
  ForEachRow([&](std::size_t row) {
    if (UnderWay(row)) {
      DetectRow(row, static_cast<agents::Execution>(executions[row]));
    } else if (rows_[row].over && autoreset_ == Autoreset::kNextStep) {
      Begin(row);
      now_.begun[row] = 1;
    }
  });
  RecordEnded();
  if (autoreset_ == Autoreset::kSameStep) BeginAgain();
}

void Fleet::DetectRow(std::size_t row, agents::Execution execution) {
  Row& r = rows_[row];
  ED3R_CHECK(r.moved, "detected before it moved");
  r.mission->Detect(execution);
  r.moved = false;
  const std::optional<mission::Outcome> outcome = r.mission->Result();
  const bool paid = outcome != mission::Outcome::kBatteryDepleted;
  const mission::TimestepRecord& last = r.mission->LastStep();
  const mission::TimestepRecord step = paid ? last : mission::TimestepRecord{};
  now_.begun[row] = 0;
  now_.paid[row] = paid;
  now_.reward[row] = last.reward;
  now_.terminated[row] = outcome.has_value();
  now_.truncated[row] = r.mission->AtLimit();
  now_.outcome[row] = outcome ? static_cast<std::int64_t>(*outcome) : -1;
  now_.execution[row] = paid ? step.execution : -1;
  now_.scs[row] = step.scs;
  now_.duration_s[row] = mission::DurationS(step);
  now_.movement_j[row] = mission::MovementJ(step);
  now_.sensing_j[row] = step.sensing_j;
  now_.computation_j[row] = step.computation_j;
  now_.transmission_j[row] = step.transmission_j;
  now_.total_j[row] = step.total_j;
  now_.battery_j[row] = last.battery_j;
  r.over = now_.terminated[row] != 0 || now_.truncated[row] != 0;
  ShowController(row);
}

void Fleet::RecordEnded() {
  if (!on_record_) return;
  for (std::size_t row = 0; row < rows_.size(); ++row) {
    Row& r = rows_[row];
    if (r.mission == nullptr || !r.over || r.recorded) continue;
    r.recorded = true;
    on_record_(*r.task, r.mission->Ended() ? std::optional(r.mission->Record()) : std::nullopt);
  }
}

void Fleet::BeginAgain() {
  ForEachRow([&](std::size_t row) {
    if (!rows_[row].over) return;
    final_.CopyRow(now_, row, row);
    Begin(row);
    // What the step came to stays; what is seen is of the mission that begins.
    now_.reward[row] = final_.reward[row];
    now_.terminated[row] = final_.terminated[row];
    now_.truncated[row] = final_.truncated[row];
  });
}

}  // namespace ed3r::schedule
