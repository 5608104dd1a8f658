// Two arms that met the same scenarios, compared: for the variants of a study, for runs (ed3r compare) and for the arms of
// a stage. Pure functions, any thread.
#pragma once

#include <limits>
#include <string_view>

#include "studies/metrics/arm.h"

namespace ed3r::variants {

// Metrics whose differences are told.
inline constexpr const char* kComparedMetrics[] = {"total_energy_kj", "msr_pct", "duration_mean_min"};

// One metric of one arm minus the same of another: mean over scenarios that both flew, with a 95 % interval (Student's t) and
// the p-value of "there is no difference" that goes with it. Where trained networks flew, more than one, the interval is at least
// as wide as t over the networks' own differences: of both arms where each network of one met one of the other alone, of the
// one arm that has any; as Welch's t between the two sets of networks otherwise. p is then the larger one. With a single network on either side the luck of training
// is in neither, and Certain() never holds. Where every pair differs by the same, p is that of the sign test, 2^(1 - pairs).
struct PairedDifference {
  double base = 0.0;  // the metric's mean in the first arm, over the pairs
  double difference = 0.0, lo = 0.0, hi = 0.0;
  double p = std::numeric_limits<double>::quiet_NaN();  // NaN, as lo and hi, under two pairs
  int pairs = 0;
  int base_networks = 0, networks = 0;  // trained ones that flew the pairs; 0 for an arm that asks none

  bool OneNetwork() const { return base_networks == 1 || networks == 1; }
  bool Certain() const { return (lo > 0.0 || hi < 0.0) && !OneNetwork(); }
};

// `other` minus `base`; pairs are missions of one scenario number.
PairedDifference DifferenceOf(const metrics::ArmData& base, const metrics::ArmData& other,
                              std::string_view metric);

// Whether missions of one scenario number began at the same place, for the same fire: in arms of other worlds or sites they
// do not. True where the arms share no scenario.
bool SameScenarios(const metrics::ArmData& a, const metrics::ArmData& b);

// Scenario numbers that both flew.
std::size_t ScenariosInCommon(const metrics::ArmData& a, const metrics::ArmData& b);

// Whether not even the shorter one's are all in common: one may have flown on, as a precision asks.
bool FewInCommon(const metrics::ArmData& a, const metrics::ArmData& b);

// Whether they were flown in worlds of other content: a place of one number may then lie elsewhere.
bool OtherWorlds(const metrics::ArmData& a, const metrics::ArmData& b);

}  // namespace ed3r::variants
