// Which figures a run can have: the counterparts of the paper's, and ours. Decided by what was flown; how they look is
// decided by scripts/plot.py.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "studies/figures/run_source.h"
#include "studies/metrics/arm.h"

namespace ed3r::figures {

// One figure: file FILES/ID.png and .svg. `kind` is the drawing: overview | insights | decisions | pareto | sites |
// convergence | map | variants.
struct FigureSpec {
  std::string id, kind, title, caption;
  std::vector<std::size_t> arms;     // into the run's arms, in drawing order
  std::vector<std::size_t> warmups;  // likewise; overview only
};

// Arms without missions are in no figure. Three figures (overview, insights, decisions) for each group of arms: the
// paper's thresholds, ablations and baselines where two arms of one at least flew in one stage; then the arms that none
// of these holds, stage by stage, at most kGroupArms in one figure and kMostGroups such groups; warm-ups only where
// nothing else was flown. `plans` tells warm-ups and strategies; an arm without a plan is none.
std::vector<FigureSpec> ListFigures(std::span<const metrics::ArmData> arms, std::span<const ArmPlan> plans,
                                    std::size_t shown_missions);

inline constexpr std::size_t kGroupArms = 9;
inline constexpr std::size_t kMostGroups = 4;

// Missions of an arm from which its convergence is drawn: two points of the curve at least.
inline constexpr std::size_t kConvergenceStart = 100;

// What variants change: for a sweep that has them, beside the figures of its first variant.
FigureSpec VariantFigure(const std::string& first_variant);

// The plan of an arm, or null.
const ArmPlan* PlanOf(std::span<const ArmPlan> plans, const metrics::ArmData& arm);

}  // namespace ed3r::figures
