#include "engine/agents/context.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

namespace ed3r::agents {
namespace {

// Steps by the golden ratio leave the most even gaps however many there are; coprime, so that each number comes once.
int SpreadNumber(int mission, int count) {
  constexpr double kGolden = 0.6180339887498949;
  int step = static_cast<int>(std::lround(kGolden * count));
  while (std::gcd(step, count) != 1) ++step;
  return static_cast<int>(static_cast<std::int64_t>(mission) * step % count);
}

}  // namespace

double EpsilonOfMission(const AgentsConfig& agents, int mission) {
  const int number = agents.epsilon_missions > 0 ? SpreadNumber(mission, agents.epsilon_missions) : mission;
  return std::max(agents.epsilon_min, std::pow(agents.epsilon_decay, number));
}

}  // namespace ed3r::agents
