#include "studies/tables/names.h"

#include "studies/paper/arms.h"

namespace ed3r::tables {
std::string ArmLabel(std::string_view name) {
  if (const paper::PaperArm* arm = paper::FindPaperArm(name)) return std::string(arm->label);
  if (paper::IsP85Name(name)) return ArmLabel(paper::ArmOfP85Name(name)) + ", P85";
  if (name == "ed3r") return "ED³R";  // the strategy, whatever its threshold
  return std::string(name);
}

}  // namespace ed3r::tables
