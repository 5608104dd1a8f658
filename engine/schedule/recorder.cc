#include "engine/schedule/recorder.h"

#include "engine/core/threads.h"

namespace ed3r::schedule {
namespace {

// How long the thread sleeps at most: the delay with which Ctrl-C reaches the missions in flight.
constexpr std::chrono::milliseconds kTick{50};

double Seconds(std::chrono::steady_clock::duration duration) {
  return std::chrono::duration<double>(duration).count();
}

}  // namespace

Recorder::Recorder(store::ResultStore& store, const ScheduleOptions& options, std::int64_t todo,
                   std::size_t capacity)
    : store_(store), options_(options), queue_(capacity), line_(options.progress, options.quiet) {
  progress_.label = options.label;
  progress_.stored_before = options.stored_before;
  progress_.total = options.stored_before + todo;
  thread_ = NewThread([this] { Loop(); });
}

Recorder::~Recorder() {
  queue_.Close();
  if (thread_.joinable()) thread_.join();
}

void Recorder::Abandon(const std::exception_ptr& error) {
  const std::lock_guard lock(abandoning_);
  if (!abandoned_) abandoned_ = error;
  stop_ = true;
}

RunSummary Recorder::Finish() {
  queue_.Close();
  thread_.join();
  if (error_) std::rethrow_exception(error_);
  if (abandoned_) std::rethrow_exception(abandoned_);
  return {.stored = progress_.stored,
          .failed = progress_.failed,
          .wall_s = Seconds(Clock::now() - begin_),
          .simulated_s = progress_.simulated_s};
}

void Recorder::Loop() {
  using Result = BoundedQueue<Finished>::Result;
  try {
    Finished finished;
    for (Result result = Result::kNothingYet; result != Result::kEnd;) {
      result = queue_.Pop(finished, kTick);
      if (result == Result::kItem) Store(finished);
      if (options_.stop != nullptr && options_.stop->load()) stop_ = true;
      CommitWhenDue();
      ShowProgress();
    }
    store_.Commit();
  } catch (...) {
    error_ = std::current_exception();
    stop_ = true;
    queue_.Close();
  }
  line_.Clear();
}

void Recorder::Store(const Finished& finished) {
  const WatchedThread watched;
  const InPhase storing(Phase::kStore);
  if (finished.record) {
    store_.Put(finished.id, *finished.record, finished.wall_s);
    ++progress_.stored;
    progress_.simulated_s += finished.record->duration_s;
  } else {
    store_.PutFailure(finished.id, finished.failure);
    ++progress_.failed;
  }
  if (!oldest_uncommitted_) oldest_uncommitted_ = Clock::now();
}

void Recorder::CommitWhenDue() {
  if (!oldest_uncommitted_ || Clock::now() - *oldest_uncommitted_ < options_.commit_every) return;
  const WatchedThread watched;
  const InPhase storing(Phase::kStore);
  store_.Commit();
  oldest_uncommitted_.reset();
}

void Recorder::ShowProgress() {
  progress_.elapsed_s = Seconds(Clock::now() - begin_);
  line_.Show(progress_);
}

}  // namespace ed3r::schedule
