// Threads where a machine gives no more of them (ulimit -u, a container's limit), and after a fork.
#pragma once

#include <functional>
#include <system_error>
#include <thread>
#include <utility>

namespace ed3r {

// A thread that runs `work`; std::system_error, which says that it is a thread that cannot be made.
template <class Thread = std::thread, class Work>
Thread NewThread(Work work) {
  try {
    return Thread(std::move(work));
  } catch (const std::system_error& error) {
    throw std::system_error(error.code(), "a thread cannot be made, see ulimit -u");
  }
}

// How many threads, the calling one among them, can be there at once: `wanted` or fewer.
int PossibleThreads(int wanted);

// Calls `region`, which holds one OpenMP region of `threads` threads; every such region stands in one.
// std::system_error, and no call, where they cannot be made: OpenMP would end the process. In a process that was forked
// from one whose team it had, OpenMP would wait for that team for ever: the region then has a new one.
void WithTeam(int threads, const std::function<void()>& region);

}  // namespace ed3r
