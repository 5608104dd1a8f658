#include "engine/core/phase.h"

#include <algorithm>
#include <mutex>
#include <vector>

namespace ed3r {
namespace {

struct Watched {
  std::mutex lock;
  std::vector<const std::atomic<Phase>*> threads;
};

Watched& AllWatched() {
  static Watched watched;
  return watched;
}

constinit thread_local int times_watched = 0;

}  // namespace

WatchedThread::WatchedThread() {
  if (times_watched++ > 0) return;
  Watched& all = AllWatched();
  const std::lock_guard lock(all.lock);
  all.threads.push_back(&current_phase);
}

WatchedThread::~WatchedThread() {
  if (--times_watched > 0) return;
  Watched& all = AllWatched();
  const std::lock_guard lock(all.lock);
  all.threads.erase(std::find(all.threads.begin(), all.threads.end(), &current_phase));
}

void LookAtThreads(const std::function<void(Phase)>& see) {
  Watched& all = AllWatched();
  const std::lock_guard lock(all.lock);
  for (const std::atomic<Phase>* thread : all.threads) see(thread->load(std::memory_order_relaxed));
}

}  // namespace ed3r
