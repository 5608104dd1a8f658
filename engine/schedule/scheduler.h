// Flies missions on all cores and stores them as they finish. Knows nothing of Bullet: a mission is a
// function from its number to its record.
//
//   OpenMP threads       fly, each taking the next mission when it is free
//        | bounded queue of finished missions
//   one writer thread    stores, commits twice a second, shows the progress line, watches for Ctrl-C
//
// Results do not depend on the number of threads or on the order, because a mission depends on its number
// alone and the store brings the records into canonical order.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

#include "engine/mission/record.h"
#include "engine/store/store.h"

namespace ed3r::schedule {

// Flies one mission; called by many threads at once. `stop` becomes true when nobody wants the result any
// more (Ctrl-C, a full disk): throw Interrupted (engine/core/interrupt.h) then. Any other exception makes the
// mission a failed one.
using FlyFn = std::function<mission::MissionRecord(const sweep::RunId& id, const std::atomic<bool>& stop)>;

struct ScheduleOptions {
  int threads = 0;                          // 0: one per processor that this process may use
  const std::atomic<bool>* stop = nullptr;  // usually &InterruptFlag()
  bool quiet = false;                       // no progress line
  std::FILE* progress = stderr;             // shown only if it is a terminal
  std::string label = {};                   // of the progress line
  std::int64_t stored_before = 0;           // for the progress line: missions of `label` stored already
  std::chrono::milliseconds commit_every{500};
};

struct RunSummary {
  std::int64_t stored = 0;
  std::int64_t failed = 0;
  std::int64_t dropped = 0;  // in flight or not begun when it was interrupted
  bool interrupted = false;
  int threads = 0;
  double wall_s = 0;
  double simulated_s = 0;  // of the missions stored
};

inline constexpr int kMostThreads = 4096;

// The number of threads that ScheduleOptions::threads stands for. UserError when it is negative or beyond
// kMostThreads.
int ThreadsFor(int asked);

// Flies `todo` in this order, threads taking turns. A mission that throws becomes a failed one and the rest
// goes on. Returns when all is committed. Throws the store's error, once, when the store fails: missions
// committed before are kept. UserError when OpenMP gives fewer threads than asked.
RunSummary RunMissions(const std::vector<sweep::RunId>& todo, const FlyFn& fly, store::ResultStore& store,
                       const ScheduleOptions& options = {});

}  // namespace ed3r::schedule
