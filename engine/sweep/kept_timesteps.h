// Which missions of a stage keep their timesteps in the store: `store: {timesteps: none}` of a sweep. A mission's record is
// always stored, with a checksum of the timesteps that it had: what is kept changes no digest.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "engine/config/field.h"

namespace ed3r::sweep {

enum class KeptTimesteps { kAll, kFailed, kNone };  // kFailed: of missions that end in anything but a success

}  // namespace ed3r::sweep

namespace ed3r {

template <>
struct EnumNames<sweep::KeptTimesteps> {
  static constexpr EnumName<sweep::KeptTimesteps> kNames[] = {{sweep::KeptTimesteps::kAll, "all"},
                                                              {sweep::KeptTimesteps::kFailed, "failed"},
                                                              {sweep::KeptTimesteps::kNone, "none"}};
};

}  // namespace ed3r

namespace ed3r::sweep {

// None for another word.
std::optional<KeptTimesteps> KeptTimestepsOf(std::string_view word);

// By stage, out of SweepPlan::CanonicalText(), without reading its arms, of which there may be thousands. UserError for a
// word that this version does not know.
std::vector<KeptTimesteps> ReadKeptTimesteps(std::string_view plan_text);

}  // namespace ed3r::sweep
