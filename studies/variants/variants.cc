#include "studies/variants/variants.h"

#include <algorithm>

#include "engine/sweep/arm_id.h"
#include "studies/paper/claims.h"

namespace ed3r::variants {
namespace {

void AddChanges(const claims::ClaimStudy& base, const claims::ClaimStudy& here, const std::string& variant,
                std::vector<VerdictChange>& changes) {
  for (std::size_t i = 0; i < base.claims.size(); ++i) {
    const claims::Verdict was = base.claims[i].all.verdict, is = here.claims[i].all.verdict;
    const bool luck =
        base.claims[i].luck == claims::Luck::kWithin || here.claims[i].luck == claims::Luck::kWithin;
    if (was != is) changes.push_back({base.claims[i].claim.id, variant, was, is, luck});
  }
}

// As in report.json: STAGE/ARM where several stages have an arm of the name.
std::string NameAmong(const std::vector<metrics::ArmData>& arms, const metrics::ArmData& arm) {
  const auto uses = std::count_if(arms.begin(), arms.end(),
                                  [&](const metrics::ArmData& other) { return other.name == arm.name; });
  return uses > 1 ? arm.stage + '/' + arm.name : arm.name;
}

}  // namespace

std::vector<std::string> VariantsOf(std::span<const metrics::ArmData> arms) {
  std::vector<std::string> variants;
  for (const metrics::ArmData& arm : arms) {
    const std::string variant = sweep::ArmId::Of(arm.name).variant;
    if (!variant.empty() && std::find(variants.begin(), variants.end(), variant) == variants.end())
      variants.push_back(variant);
  }
  return variants;
}

std::vector<metrics::ArmData> ArmsOfVariant(std::span<const metrics::ArmData> arms,
                                            const std::string& variant) {
  std::vector<metrics::ArmData> own;
  for (const metrics::ArmData& arm : arms) {
    const sweep::ArmId id = sweep::ArmId::Of(arm.name);
    if (id.variant != variant) continue;
    own.push_back(arm);
    own.back().name = id.name;
  }
  return own;
}

bool VerdictChange::Contradicts() const {
  if (within_luck) return false;
  return (claims::Holds(base) && here == claims::Verdict::kDiffers) ||
         (base == claims::Verdict::kDiffers && claims::Holds(here));
}

std::vector<metrics::ArmData> AsVariant(std::vector<metrics::ArmData> arms, const std::string& variant) {
  for (metrics::ArmData& arm : arms) arm.name = sweep::ArmId{arm.name, variant}.Text();
  return arms;
}

VariantStudy CompareVariants(std::span<const metrics::ArmData> arms, Verdicts verdicts) {
  VariantStudy study;
  study.variants = VariantsOf(arms);
  if (study.variants.empty()) return study;
  const std::vector<metrics::ArmData> base = ArmsOfVariant(arms, study.variants.front());
  for (const std::string& variant : study.variants) {
    const std::vector<metrics::ArmData> here = ArmsOfVariant(arms, variant);
    if (verdicts == Verdicts::kJudged) {
      study.verdicts.push_back(claims::JudgeClaims(paper::PaperClaims(), here));
      AddChanges(study.verdicts.front(), study.verdicts.back(), variant, study.changes);
    }
    if (variant == study.variants.front()) continue;
    for (const metrics::ArmData& arm : base) {
      const auto other = std::find_if(here.begin(), here.end(), [&](const metrics::ArmData& candidate) {
        return candidate.stage == arm.stage && candidate.name == arm.name;
      });
      if (other == here.end()) continue;
      for (const char* metric : kComparedMetrics)
        study.differences.push_back(
            {DifferenceOf(arm, *other, metric), NameAmong(base, arm), variant, metric});
    }
  }
  return study;
}

}  // namespace ed3r::variants
