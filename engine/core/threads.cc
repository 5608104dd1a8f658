#include "engine/core/threads.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstddef>
#include <exception>
#include <mutex>
#include <vector>

namespace ed3r {
namespace {

// Makes `count` threads that are there at once; returns how many there were, and why there were no more.
int MakeAndEnd(int count, std::error_code& why) {
  std::vector<std::thread> made;
  made.reserve(static_cast<std::size_t>(count));
  std::mutex all_made;
  {
    const std::lock_guard lock(all_made);
    try {
      while (static_cast<int>(made.size()) < count)
        made.emplace_back([&] { const std::lock_guard wait(all_made); });
    } catch (const std::system_error& error) {
      why = error.code();
    }
  }
  for (std::thread& thread : made) thread.join();
  return static_cast<int>(made.size());
}

void WithNewTeam(int threads, const std::function<void()>& region) {
  std::exception_ptr error;
  NewThread([&] {
    try {
      WithTeam(threads, region);
    } catch (...) {
      error = std::current_exception();
    }
  }).join();
  if (error) std::rethrow_exception(error);
}

}  // namespace

int PossibleThreads(int wanted) {
  std::error_code ignored;
  return wanted <= 1 ? 1 : 1 + MakeAndEnd(wanted - 1, ignored);
}

void WithTeam(int threads, const std::function<void()>& region) {
  // libgomp keeps the team of a thread for its next region.
  thread_local int team = 1;
  thread_local pid_t team_of = 0;
  if (team > 1 && team_of != getpid()) return WithNewTeam(threads, region);
  if (threads > team) {
    std::error_code why;
    const int made = team + MakeAndEnd(threads - team, why);
    if (made < threads)
      throw std::system_error(
          why, fmt::format("{} of {} threads can be made, see ulimit -u or ask for fewer", made, threads));
  }
  if (threads > 1) {  // of a team it ends those that the region has no use for; one thread alone leaves it be
    team = threads;
    team_of = getpid();
  }
  region();
}

}  // namespace ed3r
