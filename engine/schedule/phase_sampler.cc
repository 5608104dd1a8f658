#include "engine/schedule/phase_sampler.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <numeric>
#include <vector>

#include "engine/core/threads.h"

namespace ed3r::schedule {
namespace {

// Not a divisor of anything that a run does regularly, such as its commits and progress lines.
constexpr std::chrono::microseconds kInterval{4973};

}  // namespace

double PhaseTimes::Total() const { return std::accumulate(seconds.begin(), seconds.end(), 0.0); }

std::string PhaseTimes::Text() const {
  const double total = Total();
  if (total <= 0) return "";
  std::vector<std::size_t> order(kPhases);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return seconds[a] > seconds[b]; });
  std::string text;
  for (const std::size_t phase : order)
    if (seconds[phase] > 0)
      text += fmt::format("{} {:.1f} %, ", kPhaseNames[phase], 100.0 * seconds[phase] / total);
  return text + fmt::format("of {:.1f} thread seconds", total);
}

PhaseSampler::PhaseSampler()
    : thread_(NewThread<std::jthread>([this](const std::stop_token& stop) { Loop(stop); })) {}

PhaseSampler::~PhaseSampler() = default;

PhaseTimes PhaseSampler::Finish() {
  thread_.request_stop();
  thread_.join();
  return times_;
}

void PhaseSampler::Loop(const std::stop_token& stop) {
  using Clock = std::chrono::steady_clock;
  Clock::time_point last = Clock::now();
  while (!stop.stop_requested()) {
    std::this_thread::sleep_for(kInterval);
    // The time since the last look, so that a late one counts for what it stands for.
    const Clock::time_point now = Clock::now();
    const double passed_s = std::chrono::duration<double>(now - last).count();
    last = now;
    LookAtThreads([&](Phase phase) { times_.seconds[static_cast<std::size_t>(phase)] += passed_s; });
  }
}

}  // namespace ed3r::schedule
