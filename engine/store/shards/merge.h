// Many stores into one: shards of a sweep, flown on different machines.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "engine/store/recipe.h"

namespace ed3r::store {

struct MergeSummary {
  std::int64_t added = 0;    // missions copied
  std::int64_t present = 0;  // missions that were there already, identical
  std::int64_t failed = 0;   // failed missions in the result
};

// Copies all missions of `dirs` into `out`, which is made when missing and may be one of them. Sessions and
// timings come along; a failure counts only where no store has the mission. Doing it again changes nothing.
// Stores of a plan that others', or `out`, have grown from are taken along; `out` gets the one that has grown most.
// UserError when they are of different runs or code (common_run.h), a directory is missing, or two stores hold different records
// of one mission; `out` is then as it was before.
MergeSummary MergeStores(const std::string& out, const std::vector<std::string>& dirs,
                         OtherCode other_code = OtherCode::kRefuse);

}  // namespace ed3r::store
