// Ctrl-C: a flag that long work looks at, and the exception by which a mission in flight gives up.
#pragma once

#include <atomic>
#include <exception>

namespace ed3r {

// Thrown by a mission that saw the stop flag. Not a failure: the mission is dropped and flown another time.
class Interrupted : public std::exception {
 public:
  const char* what() const noexcept override { return "interrupted"; }
};

// True once SIGINT or SIGTERM has arrived (and InstallInterruptHandler was called before).
// One flag per process; lock-free, so that the signal handler may set it.
std::atomic<bool>& InterruptFlag();

// For the time before work that looks at the flag begins: SIGINT and SIGTERM end the process with one line on standard
// error and this status.
void EndOnInterrupt(int status);

// SIGINT and SIGTERM (Slurm's notice before a time limit) set the flag. The handler serves once per signal:
// a second Ctrl-C ends the process at once.
void InstallInterruptHandler();

}  // namespace ed3r
