// The one thread that touches the store while missions fly.
#pragma once

#include <atomic>
#include <chrono>
#include <exception>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "engine/core/phase.h"
#include "engine/core/progress.h"
#include "engine/mission/record.h"
#include "engine/schedule/bounded_queue.h"
#include "engine/schedule/scheduler.h"
#include "engine/store/store.h"

namespace ed3r::schedule {

// A mission that came to its end: a record, or what went wrong.
struct Finished {
  sweep::RunId id;
  std::optional<mission::MissionRecord> record;
  store::Failure failure;
  double wall_s = 0;
};

// Threads: Offer() and stop() from any thread; the rest from the one that made it.
class Recorder {
 public:
  // Starts the thread. `todo` is the number of missions that may come.
  Recorder(store::ResultStore& store, const ScheduleOptions& options, std::int64_t todo,
           std::size_t capacity);
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  // Hands a mission over; waits while the queue is full. It is dropped when the store has failed.
  void Offer(Finished finished) {
    const InPhase waiting(Phase::kWaiting);
    queue_.Push(std::move(finished));
  }

  // Ends the run: Finish() commits what has been offered and throws this, unless another error came first.
  void Abandon(const std::exception_ptr& error);

  // True from the moment on when missions need not be flown any more.
  const std::atomic<bool>& stop() const { return stop_; }

  // Ends the thread; everything offered is committed then. Throws what the store threw.
  // Fills stored, failed, simulated_s and wall_s.
  RunSummary Finish();

 private:
  using Clock = std::chrono::steady_clock;

  void Loop();
  void Store(const Finished& finished);
  void CommitWhenDue();
  void ShowProgress();

  store::ResultStore& store_;
  const ScheduleOptions options_;
  BoundedQueue<Finished> queue_;
  std::atomic<bool> stop_{false};
  std::mutex abandoning_;
  std::exception_ptr abandoned_;
  const Clock::time_point begin_ = Clock::now();

  // Of the thread alone, until it has ended.
  ProgressLine line_;
  ProgressState progress_;
  std::optional<Clock::time_point> oldest_uncommitted_;
  std::exception_ptr error_;

  std::thread thread_;  // last: it uses all of the above
};

}  // namespace ed3r::schedule
