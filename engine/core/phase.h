// What a thread is at, for whoever wants to know where the time of a run goes ('ed3r run --profile').
//
// A mark is a store to thread-local memory: it reads no clock and nothing reads it back into a mission, so that missions
// stay pure functions and marks may stand in a loop of a microsecond. Who looks at them: schedule/phase_sampler.h.
// Threads: marks are of the thread that sets them; LookAtThreads() may be called from any.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string_view>

namespace ed3r {

enum class Phase : std::uint8_t {
  kOther,
  kMission,     // of a mission, what is none of the following
  kPhysics,     // Bullet's steps
  kControl,     // trajectory, controller, rotors, drag, wind
  kLidar,       // rays ahead of the robot
  kDecision,    // at the RC and on board
  kPerception,  // what the camera sees, and the detectors
  kTraining,
  kStore,
  kWaiting,  // for the others
};

inline constexpr std::array<std::string_view, 10> kPhaseNames = {
    "other",     "rest of the mission", "physics",  "control", "LiDAR",
    "decisions", "perception",          "training", "store",   "waiting"};
inline constexpr std::size_t kPhases = kPhaseNames.size();

// Of this thread. Written by it alone, read by a sampler.
inline constinit thread_local std::atomic<Phase> current_phase{Phase::kOther};

// The thread is at `phase` as long as this lives, and then again at what it was at before.
class InPhase {
 public:
  explicit InPhase(Phase phase) noexcept : before_(current_phase.load(std::memory_order_relaxed)) {
    current_phase.store(phase, std::memory_order_relaxed);
  }
  ~InPhase() { current_phase.store(before_, std::memory_order_relaxed); }
  InPhase(const InPhase&) = delete;
  InPhase& operator=(const InPhase&) = delete;

 private:
  Phase before_;
};

// The calling thread is watched as long as this lives. Cheap: a lock to begin and one to end.
class WatchedThread {
 public:
  WatchedThread();
  ~WatchedThread();
  WatchedThread(const WatchedThread&) = delete;
  WatchedThread& operator=(const WatchedThread&) = delete;
};

// What each watched thread is at now.
void LookAtThreads(const std::function<void(Phase)>& see);

}  // namespace ed3r
