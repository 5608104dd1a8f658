#include "kernels/bench/paired.h"

#include <sched.h>
#include <time.h>

#include <algorithm>
#include <cstdio>

namespace ed3r::bench {
namespace {

// Time that this thread ran: on a shared machine a preempted sample must not count the others' work.
double ThreadSeconds() {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double SecondsOf(const Contender& contender, int repeats) {
  const double start = ThreadSeconds();
  for (int k = 0; k < repeats; ++k) contender.run();
  return (ThreadSeconds() - start) / repeats;
}

int RepeatsFor(const Contender& contender, double sample_s) {
  contender.run();
  int repeats = 1;
  while (SecondsOf(contender, repeats) * repeats < sample_s) repeats *= 2;
  return repeats;
}

double Median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
  return values[values.size() / 2];
}

}  // namespace

std::vector<Timing> RunPaired(const std::vector<Contender>& contenders, int rounds, double sample_s) {
  const std::size_t n = contenders.size();
  std::vector<int> repeats;
  for (const Contender& c : contenders) repeats.push_back(RepeatsFor(c, sample_s));
  std::vector<std::vector<double>> seconds(n, std::vector<double>(rounds));
  for (int round = 0; round < rounds; ++round)
    for (std::size_t k = 0; k < n; ++k) {
      const std::size_t c = (k + round) % n;  // nobody is always first
      seconds[c][round] = SecondsOf(contenders[c], repeats[c]);
    }
  std::vector<Timing> timings(n);
  for (std::size_t c = 0; c < n; ++c) {
    std::vector<double> ratios, shares;
    for (int round = 0; round < rounds; ++round) {
      ratios.push_back(seconds[c][round] / seconds[0][round]);
      shares.push_back(contenders[c].flops / seconds[c][round] /
                       (contenders[n - 1].flops / seconds[n - 1][round]));
    }
    const double s = Median(seconds[c]);
    timings[c] = {s * 1e6, contenders[c].flops / s * 1e-9, Median(ratios), Median(shares)};
  }
  return timings;
}

void PrintTable(const std::string& title, const std::vector<Contender>& contenders,
                const std::vector<Timing>& timings) {
  std::printf("\n%s\n  %-22s %10s %10s %9s %8s\n", title.c_str(), "what", "us", "GFLOP/s", "of peak",
              "ratio");
  for (std::size_t c = 0; c + 1 < contenders.size(); ++c)
    std::printf("  %-22s %10.2f %10.1f %9.2f %8.2f\n", contenders[c].name.c_str(), timings[c].us,
                timings[c].gflops, timings[c].of_peak, timings[c].ratio);
  std::printf("  %-22s %10s %10.1f %9.2f\n", contenders.back().name.c_str(), "", timings.back().gflops, 1.0);
}

void PinToThisCore() {
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(sched_getcpu(), &set);
  sched_setaffinity(0, sizeof set, &set);
}

}  // namespace ed3r::bench
