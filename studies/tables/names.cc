#include "studies/tables/names.h"

#include <utility>

#include "studies/paper/arms.h"

namespace ed3r {
namespace {

// Of names that are none of the paper's arms.
constexpr std::pair<std::string_view, std::string_view> kLabels[] = {
    {"ed3r", "ED³R"},
    {"ed3r-p85", "ED³R-75, P85"},
};
constexpr std::string_view kP85Ending = "-p85";

}  // namespace

std::string ArmLabel(std::string_view name) {
  if (const PaperArm* arm = FindPaperArm(name)) return std::string(arm->label);
  for (const auto& [key, label] : kLabels)
    if (key == name) return std::string(label);
  if (name.size() > kP85Ending.size() && name.ends_with(kP85Ending))
    return ArmLabel(name.substr(0, name.size() - kP85Ending.size())) + ", P85";
  return std::string(name);
}

}  // namespace ed3r
