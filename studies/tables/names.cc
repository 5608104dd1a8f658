#include "studies/tables/names.h"

#include <utility>

namespace ed3r {
namespace {

constexpr std::pair<std::string_view, std::string_view> kLabels[] = {
    {"warmup", "Warm-up"},
    {"warmup-ecd2r", "Warm-up ECD²R"},
    {"ed3r", "ED³R"},
    {"ed3r-65", "ED³R-65"},
    {"ed3r-75", "ED³R-75"},
    {"ed3r-85", "ED³R-85"},
    {"ablation-1", "Ablation 1"},
    {"ablation-2", "Ablation 2"},
    {"ablation-3", "Ablation 3"},
    {"ablation-4", "Ablation 4"},
    {"ecd2r", "ECD²R"},
    {"rbs", "RBS"},
    {"ed3r-p85", "ED³R-75, P85"},
};
constexpr std::string_view kP85Ending = "-p85";

}  // namespace

std::string ArmLabel(std::string_view name) {
  for (const auto& [key, label] : kLabels)
    if (key == name) return std::string(label);
  if (name.size() > kP85Ending.size() && name.ends_with(kP85Ending))
    return ArmLabel(name.substr(0, name.size() - kP85Ending.size())) + ", P85";
  return std::string(name);
}

}  // namespace ed3r
