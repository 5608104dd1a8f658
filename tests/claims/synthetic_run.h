// Arms whose truth is known: every mission is a success of a given mean energy, noise shared between arms.
#pragma once

#include <string>
#include <vector>

#include "engine/core/random.h"
#include "studies/metrics/arm.h"

namespace ed3r::claims {

struct SyntheticArm {
  std::string name;
  double energy_kj = 20;
  double failures = 0;  // share of missions that end on a false positive
  double luck = 0;      // a network's mean energy is energy_kj x (1 + luck x its deviation), see below
  bool has_networks = true;
  double reliable_scs = 0.9;
};

struct SyntheticDesign {
  int missions = 280, networks = 5, places = 28;
  double own_noise = 0.05;  // of an arm, besides the noise that all arms share
};

// Deviations of the networks, symmetric, so that five networks' mean is as wanted.
inline double LuckOf(int network, int networks) {
  return networks < 2 ? 0 : 2.0 * network / (networks - 1) - 1;
}

inline metrics::ArmData MakeArm(const SyntheticArm& wanted, const SyntheticDesign& design = {}) {
  metrics::ArmData arm{.stage = "online", .name = wanted.name, .missions = {}};
  std::uint64_t seed = 5;
  for (const char c : wanted.name) seed = 31 * seed + static_cast<unsigned char>(c);
  for (int i = 0; i < design.missions; ++i) {
    Stream shared(1, static_cast<std::uint32_t>(i), Purpose::kScenario);
    Stream own(seed, static_cast<std::uint32_t>(i), Purpose::kScenario);
    mission::MissionRecord m;
    m.scenario = i;
    m.site = i % 14, m.base_station = i % design.places / 14;
    const int network = i / design.places % design.networks;
    if (wanted.has_networks) m.network = network;
    const double hardness = 0.5 + shared.Uniform();
    const double luck = 1 + wanted.luck * LuckOf(network, design.networks);
    m.total_j = m.movement_j = 1000 * wanted.energy_kj * luck * (hardness + design.own_noise * own.Normal());
    m.duration_s = m.total_j / 130;
    m.timesteps = 10, m.full_local = 10;
    m.reliable_timesteps = 2, m.reliable_scs_sum = 2 * wanted.reliable_scs;
    m.outcome = static_cast<std::int64_t>(own.Uniform() < wanted.failures ? mission::Outcome::kFalsePositive
                                                                          : mission::Outcome::kSuccess);
    arm.missions.push_back(m);
  }
  return arm;
}

}  // namespace ed3r::claims
