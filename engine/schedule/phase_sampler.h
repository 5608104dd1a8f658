// Where the time of a run goes: looks every five milliseconds at what each watched thread is at (core/phase.h).
//
// Sampling costs the watched threads nothing but their marks, and no phase is too short for it: a step of a microsecond
// that happens often is seen as often as it takes. A share p of n samples is known to about +-2 sqrt(p (1 - p) / n).
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <thread>

#include "engine/core/phase.h"

namespace ed3r::schedule {

// Thread-seconds by phase: wall time, summed over the watched threads.
struct PhaseTimes {
  std::array<double, kPhases> seconds{};

  double Total() const;
  // "physics 38.2 %, control 30.1 %, ..., largest first, of 71.3 thread seconds"; "" where nothing was seen.
  std::string Text() const;
};

// Samples from its making until Finish().
// Threads: made and finished by one thread; any threads may be watched meanwhile.
class PhaseSampler {
 public:
  PhaseSampler();
  ~PhaseSampler();
  PhaseTimes Finish();

 private:
  void Loop(const std::stop_token& stop);

  PhaseTimes times_;
  std::jthread thread_;  // last: it uses all of the above
};

}  // namespace ed3r::schedule
