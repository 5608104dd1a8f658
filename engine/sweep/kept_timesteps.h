// Which missions of a stage keep their timesteps in the store: `store: {timesteps: none}` of a sweep. A mission's record is
// always stored, with a checksum of the timesteps that it had: what is kept changes no digest.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "engine/config/field.h"

namespace ed3r {

enum class KeptTimesteps { kAll, kFailed, kNone };  // kFailed: of missions that end in anything but a success
template <>
struct EnumNames<KeptTimesteps> {
  static constexpr EnumName<KeptTimesteps> kNames[] = {
      {KeptTimesteps::kAll, "all"}, {KeptTimesteps::kFailed, "failed"}, {KeptTimesteps::kNone, "none"}};
};

// None for another word.
std::optional<KeptTimesteps> KeptTimestepsOf(std::string_view word);

// By stage, out of SweepPlan::CanonicalText(), without reading its arms, of which there may be thousands. UserError for a
// word that this version does not know.
std::vector<KeptTimesteps> ReadKeptTimesteps(std::string_view plan_text);

}  // namespace ed3r
