#include "studies/paper/arms.h"

#include <algorithm>

namespace ed3r {
namespace {

constexpr PaperArm kArms[] = {
    {.name = "warmup", .label = "Warm-up", .strategy = "random", .warmup = true},
    {.name = "warmup-ecd2r", .label = "Warm-up ECD²R", .strategy = "random-offload", .warmup = true},
    {.name = "ed3r-65", .label = "ED³R-65", .strategy = "ed3r", .eta_min = 0.65, .learns = true},
    {.name = "ed3r-75", .label = "ED³R-75", .strategy = "ed3r", .learns = true},
    {.name = "ed3r-85", .label = "ED³R-85", .strategy = "ed3r", .eta_min = 0.85, .learns = true},
    {.name = "ablation-1", .label = "Ablation 1", .strategy = "ablation-1", .learns = true},
    {.name = "ablation-2", .label = "Ablation 2", .strategy = "ablation-2", .learns = true},
    {.name = "ablation-3", .label = "Ablation 3", .strategy = "ablation-3", .learns = true},
    {.name = "ablation-4", .label = "Ablation 4", .strategy = "ablation-4", .learns = true},
    {.name = "ecd2r", .label = "ECD²R", .strategy = "ecd2r", .learns = true},
    {.name = "rbs", .label = "RBS", .strategy = "rbs"},
};

template <class Fits>
const PaperArm* FindArm(const Fits& fits) {
  const auto found = std::find_if(std::begin(kArms), std::end(kArms), fits);
  return found == std::end(kArms) ? nullptr : found;
}

}  // namespace

std::span<const PaperArm> PaperArms() { return kArms; }

const PaperArm* FindPaperArm(std::string_view name) {
  return FindArm([&](const PaperArm& arm) { return arm.name == name; });
}

const PaperArm* FindPaperWarmup(std::string_view strategy) {
  return FindArm([&](const PaperArm& arm) { return arm.warmup && arm.strategy == strategy; });
}

}  // namespace ed3r
