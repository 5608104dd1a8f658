// Paired measurements: in every round each contender runs once, one after the other on the same core, so that
// a busy machine slows all of them alike; what counts is the median of the rounds' ratios.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace ed3r::bench {

struct Contender {
  std::string name;
  std::function<void()> run;
  double flops = 0;  // of one run
};

struct Timing {
  double us = 0;       // median time of one run
  double gflops = 0;   // from that median
  double ratio = 0;    // median over the rounds of its time / the first contender's time
  double of_peak = 0;  // median over the rounds of its GFLOP/s / the last contender's GFLOP/s
};

// The first contender is the one compared with the others, the last one the FMA peak. Each sample repeats a
// contender for at least `sample_s` seconds.
std::vector<Timing> RunPaired(const std::vector<Contender>& contenders, int rounds, double sample_s);

void PrintTable(const std::string& title, const std::vector<Contender>& contenders,
                const std::vector<Timing>& timings);

// Keeps this thread on the core it runs on.
void PinToThisCore();

}  // namespace ed3r::bench
