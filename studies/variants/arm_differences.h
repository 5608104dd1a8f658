// The arms of a stage beside each other: each minus one of them, over the scenarios that both flew. For studies with arms
// that the paper does not have (own strategies, own networks), of which its claims say nothing. Pure functions, any thread.
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "studies/metrics/arm.h"
#include "studies/variants/paired.h"

namespace ed3r::variants {

struct ArmDifference : PairedDifference {
  std::string stage, arm, minus, metric;
  double p_holm = 1.0;  // p after Holm's correction for all differences told that have one; else NaN

  // Beyond chance, whatever the number of arms and metrics that were looked at.
  bool Certain() const { return p_holm < 0.05 && !OneNetwork(); }
};

// Every other arm of a stage minus the one called `reference`; where none is given minus `rbs`, or, where the stage has none
// that flew, minus its first one: all of
// kComparedMetrics, by stage and arm in the order given. Left out are arms without a scenario in common and those whose
// scenarios are others (SameScenarios).
std::vector<ArmDifference> CompareArms(std::span<const metrics::ArmData> arms,
                                       std::string_view reference = {});

// The arms that it leaves out for their scenarios, and those of other worlds, in sentences.
std::vector<std::string> ArmPairingNotes(std::span<const metrics::ArmData> arms);

// A table of each stage, in lines of at most kTerminalWidth characters; "" without differences.
std::string ArmDifferenceText(std::span<const ArmDifference> differences);

// Columns stage,arm,minus,metric,base,difference,lo,hi,p,p_holm,pairs,base_networks,networks.
std::string ArmDifferenceCsv(std::span<const ArmDifference> differences);

// A list of objects with those keys and "certain".
nlohmann::ordered_json ArmDifferenceJson(std::span<const ArmDifference> differences);

}  // namespace ed3r::variants
