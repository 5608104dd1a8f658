#include "engine/schedule/scheduler.h"

#include <fmt/format.h>
#include <omp.h>

#include <exception>
#include <new>
#include <utility>

#include "engine/core/check.h"
#include "engine/core/interrupt.h"
#include "engine/core/phase.h"
#include "engine/mission/invariants.h"
#include "engine/perception/vision/frame_detector.h"
#include "engine/schedule/parallel_for.h"
#include "engine/schedule/recorder.h"
#include "engine/store/records.h"

namespace ed3r::schedule {
namespace {

constexpr std::size_t kQueuedPerThread = 4;  // finished missions that may wait for the writer

// Kinds are words, kept with the results: append, never rename.
store::Failure FailureOf(const std::exception_ptr& thrown) {
  try {
    std::rethrow_exception(thrown);
  } catch (const mission::BrokenInvariant& error) {
    return {std::string(NameOf(error.Which())), error.what()};
  } catch (const InternalError& error) {
    return {"broken-check", error.what()};
  } catch (const perception::DetectorError& error) {
    return {"detector-answer", error.what()};
  } catch (const UserError& error) {
    return {"bad-input", error.what()};
  } catch (const std::bad_alloc&) {
    return {"out-of-memory", "there was not enough memory"};
  } catch (const std::exception& error) {
    return {"exception", error.what()};
  } catch (...) {
    return {"exception", "an exception of unknown type"};
  }
}

// Flies one mission. Nothing when it was interrupted: a record that came back after the stop may be cut
// short, so it is not trusted.
std::optional<Finished> FlyOne(const FlyFn& fly, const sweep::RunId& id, const std::atomic<bool>& stop) {
  Finished finished{.id = id, .record = std::nullopt, .failure = {}, .wall_s = 0};
  const auto begin = std::chrono::steady_clock::now();
  const InPhase mission(Phase::kMission);
  try {
    finished.record = fly(id, stop);
    store::CheckStorable(*finished.record);
  } catch (const Interrupted&) {
    return std::nullopt;
  } catch (...) {
    finished.record.reset();
    finished.failure = FailureOf(std::current_exception());
  }
  if (stop.load()) return std::nullopt;
  finished.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return finished;
}

}  // namespace

int ThreadsFor(int asked) {
  if (asked < 0 || asked > kMostThreads)
    throw UserError(fmt::format("--threads: {} is not in 0..{} (0: all processors)", asked, kMostThreads));
  return asked > 0 ? asked : omp_get_num_procs();
}

RunSummary RunMissions(const std::vector<sweep::RunId>& todo, const FlyFn& fly, store::ResultStore& store,
                       const ScheduleOptions& options) {
  const int threads = ThreadsFor(options.threads);
  const auto missions = static_cast<std::int64_t>(todo.size());
  Recorder recorder(store, options, missions, kQueuedPerThread * static_cast<std::size_t>(threads));
  ParallelFor(threads, missions, [&](std::int64_t i) {
    if (recorder.stop().load()) return;
    const WatchedThread watched;
    try {
      if (auto finished = FlyOne(fly, todo[static_cast<std::size_t>(i)], recorder.stop()))
        recorder.Offer(std::move(*finished));
    } catch (...) {  // not of the mission: there is no memory to hand it over
      recorder.Abandon(std::current_exception());
    }
  });
  RunSummary summary = recorder.Finish();
  summary.threads = threads;
  summary.dropped = missions - summary.stored - summary.failed;
  summary.interrupted = summary.dropped > 0 || (options.stop != nullptr && options.stop->load());
  return summary;
}

}  // namespace ed3r::schedule
