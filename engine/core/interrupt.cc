#include "engine/core/interrupt.h"

#include <csignal>

namespace ed3r {
namespace {

std::atomic<bool> interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may not lock");

void OnSignal(int) { interrupted.store(true); }

}  // namespace

std::atomic<bool>& InterruptFlag() { return interrupted; }

void InstallInterruptHandler() {
  struct sigaction action = {};
  action.sa_handler = OnSignal;
  // SA_RESTART: the flag is polled, so no system call of a library needs to see EINTR.
  action.sa_flags = static_cast<int>(SA_RESETHAND | SA_RESTART);
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

}  // namespace ed3r
