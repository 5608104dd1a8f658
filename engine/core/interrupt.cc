#include "engine/core/interrupt.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <string_view>

#include "engine/core/temporary.h"

namespace ed3r {
namespace {

// SIGXCPU and SIGUSR2 are Grid Engine's notices; the first is also what 'ulimit -t' sends.
constexpr std::array<int, 5> kBatchSignals = {SIGTERM, SIGHUP, SIGUSR1, SIGUSR2, SIGXCPU};
// Batch systems kill after their grace time, commonly from five seconds on.
constexpr unsigned kPatience_s = 4;

std::atomic<bool> interrupted{false}, alarm_set{false};
std::atomic<int> first_signal{0};
std::atomic<int> status_interrupted{0}, status_requeue{0};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free,
              "a signal handler may not lock");

void Keep(int signal) {
  int none = 0;
  first_signal.compare_exchange_strong(none, signal);
}

void Say(std::string_view line) {
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, line.data(), line.size());
}

void OnSignalAtOnce(int signal) {
  RemoveTemporaries();
  if (signal == SIGINT) {
    Say("ed3r: interrupted\n");
    _exit(status_interrupted.load());
  }
  Say("ed3r: ended by ");
  Say(SignalName(signal));
  Say("; the same command continues\n");
  _exit(status_requeue.load());
}

void OnInterrupt(int signal) {
  Keep(signal);
  interrupted.store(true);
}

void OnBatchSignal(int signal) {
  Keep(signal);
  interrupted.store(true);
  // Once: a signal that is repeated would put the end off for ever.
  if (!alarm_set.exchange(true)) alarm(kPatience_s);
}

// What is committed is as safe as under kill -9.
void OnAlarm(int) { OnSignalAtOnce(first_signal.load()); }

// SA_RESTART: the flag is polled, so no system call of a library needs to see EINTR.
void Handle(int signal, void (*handler)(int), unsigned flags) {
  struct sigaction action = {};
  action.sa_handler = handler;
  action.sa_flags = static_cast<int>(flags | SA_RESTART);
  sigemptyset(&action.sa_mask);
  sigaction(signal, &action, nullptr);
}

void HandleBatchSignals(void (*handler)(int)) {
  for (const int signal : kBatchSignals) {
    struct sigaction before = {};
    sigaction(signal, nullptr, &before);
    if (signal == SIGHUP && before.sa_handler == SIG_IGN) continue;
    Handle(signal, handler, 0);
  }
}

}  // namespace

std::atomic<bool>& InterruptFlag() { return interrupted; }

int InterruptSignal() { return first_signal.load(); }

bool AsksRequeue(int signal) {
  return std::find(kBatchSignals.begin(), kBatchSignals.end(), signal) != kBatchSignals.end();
}

const char* SignalName(int signal) {
  switch (signal) {
    case SIGINT:
      return "SIGINT";
    case SIGTERM:
      return "SIGTERM";
    case SIGHUP:
      return "SIGHUP";
    case SIGUSR1:
      return "SIGUSR1";
    case SIGUSR2:
      return "SIGUSR2";
    case SIGXCPU:
      return "SIGXCPU";
    default:
      return "a signal";
  }
}

void EndOnInterrupt(EndStatus status) {
  status_interrupted.store(status.interrupted);
  status_requeue.store(status.requeue);
  Handle(SIGINT, OnSignalAtOnce, 0);
  HandleBatchSignals(OnSignalAtOnce);
}

void InstallInterruptHandler() {
  Handle(SIGALRM, OnAlarm, 0);
  Handle(SIGINT, OnInterrupt, SA_RESETHAND);
  HandleBatchSignals(OnBatchSignal);
}

}  // namespace ed3r
