// What the variants of a study change, compared with its first one: for sensitivity studies (one reading of the paper at
// a time) and for the same missions flown twice (two perception tiers), also by runs flown apart.
//
// Arms of a variant are called ARM@VARIANT (engine/sweep/plan.h). The same arm of two variants meets the same scenarios,
// so differences are paired by scenario. Pure functions, any thread.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "studies/claims/verdicts.h"
#include "studies/metrics/arm.h"
#include "studies/metrics/metrics.h"
#include "studies/variants/paired.h"

namespace ed3r::variants {

// Of one arm, in a variant minus the same in the first variant.
struct VariantDifference : PairedDifference {
  std::string arm;  // STAGE/ARM where several stages have one of the name
  std::string variant, metric;
};

// A claim of the paper that is judged otherwise than in the first variant.
struct VerdictChange {
  std::string claim, variant;
  claims::Verdict base, here;
  bool within_luck = false;  // the one that differs does so within the luck of one experiment (JudgedClaim)

  // One run has the claim hold, in size or at least in direction, the other has it differ beyond luck.
  bool Contradicts() const;
};

struct VariantStudy {
  std::vector<std::string>
      variants;  // as flown, the first is what the others are compared with; empty: no variants
  std::vector<VariantDifference> differences;  // by variant, then arm, then metric: all of kComparedMetrics
  std::vector<claims::ClaimStudy> verdicts;    // one per variant; none where they are left out
  std::vector<VerdictChange> changes;
  bool same_draws =
      true;  // false for runs of different seeds: a scenario is then another draw at the same places
};

// Names of the variants among the arms, in their order; empty where no arm has one.
std::vector<std::string> VariantsOf(std::span<const metrics::ArmData> arms);

// The arms of one variant, under their own names.
std::vector<metrics::ArmData> ArmsOfVariant(std::span<const metrics::ArmData> arms,
                                            const std::string& variant);

// The same arms as a variant of that name: for runs that are compared though they were flown apart.
std::vector<metrics::ArmData> AsVariant(std::vector<metrics::ArmData> arms, const std::string& variant);

// Whether the paper's claims are judged in every variant.
enum class Verdicts { kJudged, kLeftOut };

// Nothing is compared, and `variants` is empty, where the arms have no variants.
VariantStudy CompareVariants(std::span<const metrics::ArmData> arms, Verdicts verdicts);

// Of every arm in every variant (ARM@VARIANT): the means of all of kComparedMetrics with their intervals, for a terminal of
// kTerminalWidth characters.
std::string VariantValuesText(std::span<const metrics::ArmMetrics> arms);

// Differences, how many verdicts change (of two variants: which), and the sides of orders and comparisons, in lines of at most kTerminalWidth characters; empty without variants.
std::string VariantText(const VariantStudy& study);

// Columns arm,variant,metric,base,difference,lo,hi,pairs,base_networks,networks.
std::string DifferenceCsv(const VariantStudy& study);

// Columns claim,strategy,metric,kind,compared,holds,variants,VARIANT...: in how many variants the claim holds, of those that
// measure it, and its verdict in each, "differs (luck)" where one network may differ so.
std::string VariantVerdictCsv(const VariantStudy& study);

}  // namespace ed3r::variants
