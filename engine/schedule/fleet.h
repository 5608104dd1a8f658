// Missions that are stepped side by side: what a learner or a program that decides for many robots at once works on.
//
//   fleet.Move(commands)      stage 1 of every row; fills Robot()
//   fleet.Detect(executions)  stage 2; fills Controller(), rewards and the rest
//
// Row i is one mission at a time, the n-th of which is `task(i, n)`; where there is none, the row retires. A row depends on its tasks and its actions alone:
// not on the number of rows, the threads, or what the other rows do. All memory of a step is made when the fleet is.
//
// Threads: a fleet is used by one thread, and uses `threads` OpenMP threads itself.
#pragma once

#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "engine/mission/mission_stepper.h"
#include "engine/rfnn/features.h"

namespace ed3r::schedule {

// What happens to a row whose mission has ended, as Gymnasium names it: its next step begins the next mission and nothing
// else; the step that ends it does; or nothing does, and it waits for Reset.
enum class Autoreset { kNextStep, kSameStep, kDisabled };

inline constexpr int kCommandValues = 5;  // dx_m, dy_m, dz_m (east, north, up), turn_rad, tilt_rad

// What a row's last timestep came to. Kept by column, so that each is one array.
struct FleetColumns {
  explicit FleetColumns(std::size_t rows);

  std::vector<float> controller;  // rows x kRcStates: what the RC sees, as its network (rfnn/features.h)
  std::vector<float> robot;       // rows x kRobotStates: what the robot saw after the move
  std::vector<float>
      ranges;  // rows x 3: largest axis_m, turn_rad and width of the tilt interval of the next command
  std::vector<std::uint8_t> hovers;  // the Algorithm hovers next: the next command is not asked for
  std::vector<double> reward;        // Eq. 21
  std::vector<std::uint8_t> terminated, truncated;
  std::vector<std::uint8_t> begun;  // the step began a mission and flew nothing (kNextStep)
  // The timestep is in the mission's record: the battery paid it. What the last timestep of a depleted battery would have
  // come to is not: execution, scs, times and energies are then as of no timestep, so that sums over steps are the record's.
  std::vector<std::uint8_t> paid;
  // -1: no mission, none ended, none executed.
  std::vector<std::int64_t> mission, timestep, outcome, execution;
  std::vector<double> scs, duration_s, movement_j, sensing_j, computation_j, transmission_j, total_j,
      battery_j;

  // Row `from` of `other` as row `to`.
  void CopyRow(const FleetColumns& other, std::size_t from, std::size_t to);
};

class Fleet {
 public:
  using TaskFn = std::function<std::optional<mission::MissionTask>(std::size_t row, std::int64_t nth)>;
  // Receives each mission that has ended, or nothing for one that mission.max_timesteps cut short. Called by one thread,
  // in the order of rows.
  using RecordFn =
      std::function<void(const mission::MissionTask& task, std::optional<mission::MissionRecord> record)>;

  // `rows` missions; none has begun before Reset. ThreadsFor(threads).
  Fleet(std::size_t rows, TaskFn task, int threads, Autoreset autoreset);

  void OnRecord(RecordFn on_record) { on_record_ = std::move(on_record); }

  std::size_t rows() const { return rows_.size(); }

  // Begins the next mission of every row, or of those that `mask` marks; of those that `from_first` marks too, the first.
  void Reset(std::span<const std::uint8_t> mask = {}, std::span<const std::uint8_t> from_first = {});

  // commands: rows x kCommandValues, executions: rows. Rows without a mission under way take no notice of theirs.
  // Throws UserError for a command that is not finite or an execution that is none, before anything moves; what a mission
  // throws, of the first row that does.
  void Move(std::span<const float> commands);
  void Detect(std::span<const std::int64_t> executions);

  // Ends every row without a result, so that what the tasks refer to need not outlive this any longer.
  void Retire();

  // As of the last step or reset, and for rows that kSameStep has begun anew, as of the end of the mission before.
  const FleetColumns& Now() const { return now_; }
  const FleetColumns& Final() const { return final_; }

 private:
  struct Row {
    std::optional<mission::MissionTask> task;
    std::unique_ptr<mission::MissionStepper> mission;  // none: never begun
    std::int64_t next = 0;                             // number of the mission that begins next
    bool moved = false;
    bool over = false;      // ended or truncated
    bool recorded = false;  // OnRecord knows of it
  };
  void ForEachRow(const std::function<void(std::size_t)>& body);
  void Begin(std::size_t row);
  void DetectRow(std::size_t row, agents::Execution execution);
  void ShowController(std::size_t row);
  void RecordEnded();
  void BeginAgain();
  bool UnderWay(std::size_t row) const { return rows_[row].mission != nullptr && !rows_[row].over; }

  std::vector<Row> rows_;
  const TaskFn task_;
  RecordFn on_record_;
  const int threads_;
  const Autoreset autoreset_;
  FleetColumns now_, final_;
  const FleetColumns nothing_;  // one row of initial values
  std::vector<std::exception_ptr> errors_;
};

}  // namespace ed3r::schedule
