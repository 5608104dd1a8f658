// What tells arms of a stage apart: the name and, where the sweep has top-level axes, the variant that flies it.
// Plans, stores and tables write both as one text, which is made and read here alone. Pure, any thread.
#pragma once

#include <string>
#include <string_view>

namespace ed3r::sweep {

struct ArmId {
  std::string name;     // "ed3r-75"
  std::string variant;  // "heavy"; "" without variants

  // "ed3r-75@heavy", "ed3r-75"
  std::string Text() const { return variant.empty() ? name : name + kMark + variant; }

  // Of such a text. Names have no mark (arm_name.h).
  static ArmId Of(std::string_view text) {
    const std::size_t mark = text.find(kMark);
    if (mark == std::string_view::npos) return {std::string(text), ""};
    return {std::string(text.substr(0, mark)), std::string(text.substr(mark + 1))};
  }

  bool operator==(const ArmId&) const = default;

  static constexpr char kMark = '@';
};

}  // namespace ed3r::sweep
