#include "studies/paper/arms.h"

#include <algorithm>

#include "engine/core/check.h"

namespace ed3r::paper {
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

constexpr std::string_view kThresholds[] = {"ed3r-65", "ed3r-75", "ed3r-85"};
constexpr std::string_view kAblations[] = {"ed3r-75", "ablation-1", "ablation-2", "ablation-3", "ablation-4"};
constexpr std::string_view kBaselines[] = {"ed3r-75", "ecd2r", "rbs"};
constexpr PaperComparison kComparisons[] = {
    {"thresholds", kThresholds}, {"ablations", kAblations}, {"baselines", kBaselines}};

constexpr std::string_view kP85Ending = "-p85";
constexpr std::string_view kP85OfEd3r = "ed3r-p85";
constexpr std::string_view kEd3rOfP85 = "ed3r-75";

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

std::span<const PaperComparison> PaperComparisons() { return kComparisons; }

std::span<const std::string_view> ArmsOfComparison(std::string_view id) {
  for (const PaperComparison& comparison : kComparisons)
    if (comparison.id == id) return comparison.arms;
  ED3R_CHECK(false, std::string(id));
  return {};
}

std::string P85Name(std::string_view arm) {
  return arm == kEd3rOfP85 ? std::string(kP85OfEd3r) : std::string(arm) + std::string(kP85Ending);
}

bool IsP85Name(std::string_view name) {
  return name.size() > kP85Ending.size() && name.ends_with(kP85Ending);
}

std::string_view ArmOfP85Name(std::string_view name) {
  if (name == kP85OfEd3r) return kEd3rOfP85;
  return IsP85Name(name) ? name.substr(0, name.size() - kP85Ending.size()) : name;
}

const PaperArm* FindPaperWarmup(std::string_view strategy) {
  return FindArm([&](const PaperArm& arm) { return arm.warmup && arm.strategy == strategy; });
}

}  // namespace ed3r::paper
