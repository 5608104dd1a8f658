#include "engine/schedule/scheduler.h"

#include <fmt/format.h>
#include <omp.h>

#include <utility>

#include "engine/core/check.h"
#include "engine/core/interrupt.h"
#include "engine/schedule/recorder.h"
#include "engine/store/records.h"

namespace ed3r {
namespace {

constexpr int kMostThreads = 4096;

// Flies one mission. Nothing when it was interrupted: a record that came back after the stop may be cut
// short, so it is not trusted.
std::optional<Finished> FlyOne(const FlyFn& fly, const RunId& id, const std::atomic<bool>& stop) {
  Finished finished{.id = id, .record = std::nullopt, .failure = "", .wall_s = 0};
  const auto begin = std::chrono::steady_clock::now();
  try {
    finished.record = fly(id, stop);
    CheckStorable(*finished.record);
  } catch (const Interrupted&) {
    return std::nullopt;
  } catch (const std::exception& error) {
    finished.record.reset();
    finished.failure = error.what();
  } catch (...) {
    finished.failure = "an exception of unknown type";
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

RunSummary RunMissions(const std::vector<RunId>& todo, const FlyFn& fly, ResultStore& store,
                       const ScheduleOptions& options) {
  const int threads = ThreadsFor(options.threads);
  // A library may have allowed OpenMP to give fewer threads on a loaded machine (OpenCV does); forbid it, and
  // look at what was given.
  omp_set_dynamic(0);
  int given = 0;
  Recorder recorder(store, options, static_cast<std::int64_t>(todo.size()),
                    4 * static_cast<std::size_t>(threads));
  const auto missions = static_cast<std::int64_t>(todo.size());
#pragma omp parallel num_threads(threads) default(shared)
  {
#pragma omp single
    {
      given = omp_get_num_threads();
      if (given != threads) recorder.Stop();
    }
#pragma omp for schedule(dynamic, 1)
    for (std::int64_t i = 0; i < missions; ++i) {
      if (recorder.stop().load()) continue;
      if (auto finished = FlyOne(fly, todo[static_cast<std::size_t>(i)], recorder.stop()))
        recorder.Offer(std::move(*finished));
    }
  }
  if (given != threads)
    throw UserError(
        fmt::format("OpenMP gives {} of {} threads: see OMP_THREAD_LIMIT, or ask for fewer with --threads",
                    given, threads));
  RunSummary summary = recorder.Finish();
  summary.threads = given;
  summary.dropped = missions - summary.stored - summary.failed;
  summary.interrupted = summary.dropped > 0 || (options.stop != nullptr && options.stop->load());
  return summary;
}

}  // namespace ed3r
