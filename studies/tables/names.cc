#include "studies/tables/names.h"

#include "studies/paper/arms.h"

namespace ed3r {
std::string ArmLabel(std::string_view name) {
  if (const PaperArm* arm = FindPaperArm(name)) return std::string(arm->label);
  if (IsP85Name(name)) return ArmLabel(ArmOfP85Name(name)) + ", P85";
  if (name == "ed3r") return "ED³R";  // the strategy, whatever its threshold
  return std::string(name);
}

}  // namespace ed3r
