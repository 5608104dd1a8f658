#include "engine/core/interrupt.h"

#include <unistd.h>

#include <csignal>
#include <string_view>

namespace ed3r {
namespace {

std::atomic<bool> interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may not lock");

std::atomic<int> status_when_ended{0};

void OnSignal(int) { interrupted.store(true); }

void OnSignalAtOnce(int) {
  constexpr std::string_view kLine = "ed3r: interrupted\n";
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, kLine.data(), kLine.size());
  _exit(status_when_ended.load());
}

void Install(void (*handler)(int), unsigned flags) {
  struct sigaction action = {};
  action.sa_handler = handler;
  action.sa_flags = static_cast<int>(flags);
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

}  // namespace

std::atomic<bool>& InterruptFlag() { return interrupted; }

void EndOnInterrupt(int status) {
  status_when_ended.store(status);
  Install(OnSignalAtOnce, SA_RESTART);
}

// SA_RESTART: the flag is polled, so no system call of a library needs to see EINTR.
void InstallInterruptHandler() { Install(OnSignal, SA_RESETHAND | SA_RESTART); }

}  // namespace ed3r
