// Ctrl-C and the signals of batch systems: a flag that long work looks at, and the exception by which a mission in flight
// gives up.
//
// SIGINT is a person who wants the program to end. SIGTERM, SIGHUP, SIGUSR1, SIGUSR2 and SIGXCPU are a batch system's notice
// (preemption, a limit of time or processor time, a node that goes down): the process ends within seconds, and its status
// says that the same command continues.
#pragma once

#include <atomic>
#include <exception>

namespace ed3r {

// Thrown by a mission that saw the stop flag. Not a failure: the mission is dropped and flown another time.
class Interrupted : public std::exception {
 public:
  const char* what() const noexcept override { return "interrupted"; }
};

// Exit statuses by what the signal asks for.
struct EndStatus {
  int interrupted;  // SIGINT
  int requeue;      // a batch system's signals
};

// True once one of the signals has arrived (and InstallInterruptHandler was called before).
// One flag per process; lock-free, so that the signal handler may set it.
std::atomic<bool>& InterruptFlag();

// The first of the signals that has arrived, 0 before that.
int InterruptSignal();
// Whether it is a batch system's.
bool AsksRequeue(int signal);
// "SIGTERM", for messages.
const char* SignalName(int signal);

// For the time before work that looks at the flag begins: the signals end the process with one line on standard error and
// their status, after what is temporary (core/temporary.h) is removed. SIGHUP stays ignored where it was (nohup).
void EndOnInterrupt(EndStatus status);

// The signals set the flag from now on. A second Ctrl-C ends the process at once. A batch system's first signal lets the process
// live for four seconds more: whatever does not look at the flag in that time is ended in its midst, as by a kill, with a
// line and the status of EndOnInterrupt.
void InstallInterruptHandler();

}  // namespace ed3r
